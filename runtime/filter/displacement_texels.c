/* Other neighbours for a file of a cache, and triangles as their sub-faces. */
#include "filter/displacement_texels.h"

#include "base/log.h"
#include "base/memory.h"
#include "cache/cache_lookup.h"

#include <selvage/subface.h>
#include <selvage/triangle.h>

#include <string.h>

/* A source with what it was made of. */
typedef struct rewired {
    const slv_env *env;
    slv_source texels;
    slv_res *res; /* of its faces, since asking a cache may fail */
    const slv_adjacency *adjacency;
    slv_adjacency *own;     /* of triangles as their file has them */
    slv_texture *subfaces;  /* of triangles */
    slv_texture *triangles; /* while those are made */
} rewired;

static slv_result describe(void *user, slv_source_desc *out) {
    const rewired *source = user;
    return source->texels.fns->describe(source->texels.user, out);
}

static slv_result face(void *user, uint32_t index, slv_source_face *out) {
    const rewired *source = user;
    if (source->subfaces) /* those know their neighbours */
        return source->texels.fns->face(source->texels.user, index, out);
    if (index >= slv_adjacency_face_count(source->adjacency))
        return slvi_fail(source->env, SLV_ERROR_ARGUMENT, "displacement: there is no face %u",
                         index);
    *out = (slv_source_face){.res = source->res[index],
                             .adjacency = slv_adjacency_faces(source->adjacency)[index]};
    if (slv_adjacency_is_subface(source->adjacency, (int32_t)index))
        out->flags |= SLV_FACE_SUBFACE;
    return SLV_OK;
}

static slv_result read_rect(void *user, uint32_t index, slv_res res, slv_rect rect, void *out) {
    const rewired *source = user;
    return source->texels.fns->read(source->texels.user, index, res, rect, out);
}

static uint64_t version(void *user) {
    const rewired *source = user;
    return slv_source_version(&source->texels);
}

static slv_result changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    const rewired *source = user;
    return slv_source_changed(&source->texels, since, visit, visitor);
}

static void close_rewired(void *user) {
    rewired *source = user;
    slv_source_close(&source->texels);
    slv_texture_destroy(source->triangles);
    slv_texture_destroy(source->subfaces);
    slv_adjacency_destroy(source->own);
    slvi_free(source->res);
    slvi_free(source);
}

static const slv_source_fns rewired_fns = {.describe = describe,
                                           .face = face,
                                           .read = read_rect,
                                           .version = version,
                                           .changed = changed,
                                           .close = close_rewired};

/* All texels of triangles. */
static slv_result read_triangles(rewired *to, const slv_source_desc *from) {
    const slv_source *source = &to->texels;
    const slv_texture_desc desc = {from->nfaces,        from->type, from->nchannels,
                                   from->alpha_channel, to->res,    SLV_TEXTURE_DATA};
    size_t most = 0;
    unsigned char *texels = NULL;
    for (uint32_t f = 0; f < from->nfaces; f++) {
        size_t count = (size_t)1 << (to->res[f].u + to->res[f].v);
        most = count > most ? count : most;
    }
    slv_result result = slv_texture_create(to->env, &desc, &to->triangles);
    if (!result)
        result = slvi_alloc(to->env, from->name, most, slv_type_size(from->type) * from->nchannels,
                            &texels);
    for (uint32_t f = 0; f < from->nfaces && !result; f++) {
        const slv_rect all = {0, 0, 1u << to->res[f].u, 1u << to->res[f].v};
        if (!(result = source->fns->read(source->user, f, to->res[f], all, texels)))
            result = slv_texture_set_face(to->triangles, f, texels);
    }
    slvi_free(texels);
    return result;
}

/* Puts the texture of sub-faces in the place of the triangles. */
static slv_result take_subfaces(rewired *to, const slv_source_desc *from,
                                const slv_face_adjacency *records) {
    const slv_texture_source_params params = {.name = from->name};
    slv_source subfaces = {0};
    slv_result result = SLV_OK;
    if (!to->adjacency) {
        result = slv_adjacency_create_triangles(to->env, from->nfaces, records, &to->own);
        to->adjacency = to->own;
    }
    if (!result && !(result = read_triangles(to, from)) &&
        !(result = slv_triangle_texture(to->env, to->triangles, to->adjacency, SLV_TEXTURE_DATA,
                                        &to->subfaces)))
        result = slv_texture_as_source(to->env, to->subfaces, to->adjacency, &params, &subfaces);
    slv_texture_destroy(to->triangles);
    to->triangles = NULL;
    if (!result) {
        slv_source_close(&to->texels);
        to->texels = subfaces;
    }
    return result;
}

/* What its faces are like. */
static slv_result make(rewired *to, const slv_source_desc *from) {
    const uint64_t nfaces = (from->triangles ? 3 : 1) * (uint64_t)from->nfaces;
    slv_face_adjacency *records = NULL;
    slv_result result;
    if (to->adjacency && slv_adjacency_face_count(to->adjacency) != nfaces)
        return slvi_fail(to->env, SLV_ERROR_MISMATCH,
                         "%s: displaces %llu faces, and the adjacency has %u", from->name,
                         (unsigned long long)nfaces, slv_adjacency_face_count(to->adjacency));
    if (!(result = slvi_alloc(to->env, from->name, from->nfaces, sizeof *to->res, &to->res)))
        result = slvi_alloc(to->env, from->name, from->nfaces, sizeof *records, &records);
    for (uint32_t f = 0; f < from->nfaces && !result; f++) {
        slv_source_face found;
        if (!(result = to->texels.fns->face(to->texels.user, f, &found))) {
            to->res[f] = found.res;
            records[f] = found.adjacency;
        }
    }
    if (!result && from->triangles)
        result = take_subfaces(to, from, records);
    slvi_free(records);
    return result;
}

slv_result slvi_displacement_texels(slv_cache *cache, slv_file_id file,
                                    const slv_adjacency *adjacency, slv_source *out) {
    const slv_env *env = slvi_cache_env(cache);
    slv_source_desc desc = {0};
    rewired *made = NULL;
    *out = (slv_source){0};
    slv_result result = slvi_alloc(env, "displacement", 1, sizeof *made, &made);
    if (result)
        return result;
    *made = (rewired){.env = env, .adjacency = adjacency};
    if (!(result = slv_cache_as_source(cache, file, &made->texels)) &&
        !(result = made->texels.fns->describe(made->texels.user, &desc)))
        result = make(made, &desc);
    if (result)
        close_rewired(made);
    else
        *out = (slv_source){&rewired_fns, made};
    return result;
}
