/* A store as a source. */
#include "base/log.h"
#include "base/memory.h"
#include "texture/neighbourhood.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"

#include <string.h>

typedef struct texture_source {
    slv_env env; /* its log is serialised: any thread may read */
    slv_parallel_log *log;
    const slv_texture *texture;
    const slv_adjacency *adjacency; /* or NULL */
    slv_source_desc desc;
    char *name;
    size_t texel_size;
} texture_source;

static slv_result describe(void *user, slv_source_desc *out) {
    const texture_source *source = user;
    *out = source->desc;
    return SLV_OK;
}

/* A face, but for what lies around it. */
static slv_source_face find_face(const void *user, uint32_t index) {
    const texture_source *source = user;
    slv_source_face out = {
        .res = slv_texture_get_desc(source->texture)->res[index],
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
    if (slv_texture_is_constant(source->texture, index))
        out.flags |= SLV_FACE_CONSTANT;
    if (source->adjacency) {
        out.adjacency = slv_adjacency_faces(source->adjacency)[index];
        if (slv_adjacency_is_subface(source->adjacency, (int32_t)index))
            out.flags |= SLV_FACE_SUBFACE;
    }
    return out;
}

static bool has_same_value(const void *user, uint32_t face, uint32_t other) {
    const texture_source *source = user;
    return slv_texture_is_constant(source->texture, other) &&
           memcmp(slv_texture_texels(source->texture, face),
                  slv_texture_texels(source->texture, other), source->texel_size) == 0;
}

static slv_result face(void *user, uint32_t index, slv_source_face *out) {
    const texture_source *source = user;
    if (index >= source->desc.nfaces)
        return slvi_fail(&source->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces",
                         source->name, (unsigned)index, (unsigned)source->desc.nfaces);
    const slv_neighbourhood around = {source, find_face, has_same_value, false,
                                      source->desc.border_u == SLV_BORDER_CLAMP &&
                                          source->desc.border_v == SLV_BORDER_CLAMP};
    *out = find_face(source, index);
    if (slvi_neighbourhood_is_constant(&around, index))
        out->flags |= SLV_FACE_NEIGHBOURS_CONSTANT;
    return SLV_OK;
}

static const slv_source_fns texture_fns;

static slv_result read_rect(void *user, uint32_t index, slv_res res, slv_rect rect, void *out) {
    texture_source *source = user;
    const slv_source self = {&texture_fns, source};
    const slv_texture *texture = source->texture;
    size_t size = source->texel_size, row = rect.width * size;
    slv_source_face found;
    slv_result result = slv_source_check(&source->env, &self, index, res, rect, &found);
    if (result)
        return result;
    const unsigned char *texels = slv_texture_texels(texture, index);
    if (slv_texture_is_constant(texture, index)) {
        slvi_fill_texels(out, texels, size, (uint64_t)rect.width * rect.height);
        return SLV_OK;
    }
    if (res.u != found.res.u || res.v != found.res.v)
        return slv_source_reduce(&source->env, &self, index, res, rect, out);
    for (uint32_t y = 0; y < rect.height; y++)
        memcpy((unsigned char *)out + y * row,
               texels + (((size_t)(rect.y + y) << res.u) + rect.x) * size, row);
    return SLV_OK;
}

static uint64_t version(void *user) {
    const texture_source *source = user;
    return slv_texture_version(source->texture);
}

static slv_result visit_whole(const texture_source *source, uint32_t index, slv_visit_rect visit,
                              void *visitor) {
    slv_res res = slv_texture_get_desc(source->texture)->res[index];
    return visit(visitor, index, (slv_rect){0, 0, 1u << res.u, 1u << res.v});
}

/* All faces that share a vertex with one. */
static slv_result visit_around(const texture_source *source, uint32_t index, slv_visit_rect visit,
                               void *visitor) {
    slv_result result = SLV_OK;
    for (unsigned corner = 0; corner < 4; corner++) {
        slv_ring ring = slv_adjacency_ring(source->adjacency, (int32_t)index, corner, NULL);
        for (uint32_t i = 0; !result && i < ring.count; i++)
            result = visit_whole(source, (uint32_t)ring.corners[i].face, visit, visitor);
    }
    for (unsigned edge = 0; edge < 4; edge++) {
        slv_neighbour across[2];
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)index, edge, across);
        for (uint32_t i = 0; !result && i < count; i++)
            result = visit_whole(source, (uint32_t)across[i].face, visit, visitor);
    }
    return result;
}

struct change_visit {
    const texture_source *source;
    slv_visit_rect visit;
    void *visitor;
};

static slv_result visit_change(void *user, uint32_t index, slv_rect rect, bool constancy) {
    const struct change_visit *to = user;
    slv_result result = to->visit(to->visitor, index, rect);
    /* they may have lost, or got, the flag that says what lies around them */
    if (!result && constancy && to->source->adjacency)
        result = visit_around(to->source, index, to->visit, to->visitor);
    return result;
}

static slv_result changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    const texture_source *source = user;
    struct change_visit to = {source, visit, visitor};
    return slvi_texture_visit_changes(source->texture, since, visit_change, &to);
}

static void close_source(void *user) {
    texture_source *source = user;
    slvi_free(source->name);
    slvi_parallel_env_end(source->log);
    slvi_free(source);
}

static const slv_source_fns texture_fns = {.describe = describe,
                                           .face = face,
                                           .read = read_rect,
                                           .version = version,
                                           .changed = changed,
                                           .close = close_source};

slv_result slv_texture_as_source(const slv_env *env, const slv_texture *texture,
                                 const slv_adjacency *adjacency,
                                 const slv_texture_source_params *params, slv_source *out) {
    static const slv_texture_source_params defaults = {0};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    const slv_texture_source_params *p = params ? params : &defaults;
    const char *name = p->name ? p->name : "texture";
    texture_source *source = NULL;
    *out = (slv_source){0};
    if (adjacency && slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: has %u faces, the adjacency %u", name,
                         (unsigned)desc->nfaces, (unsigned)slv_adjacency_face_count(adjacency));
    slv_result result = slvi_alloc(env, name, 1, sizeof *source, &source);
    if (result)
        return result;
    if ((result = slvi_parallel_env_begin(env, &source->log, &source->env)) ||
        (result = slvi_alloc(env, name, strlen(name) + 1, 1, &source->name))) {
        close_source(source);
        return result;
    }
    memcpy(source->name, name, strlen(name) + 1);
    source->texture = texture;
    source->adjacency = adjacency;
    source->texel_size = slv_type_size(desc->type) * desc->nchannels;
    source->desc = (slv_source_desc){.name = source->name,
                                     .nfaces = desc->nfaces,
                                     .type = desc->type,
                                     .nchannels = desc->nchannels,
                                     .alpha_channel = desc->alpha_channel,
                                     .border_u = p->border_u,
                                     .border_v = p->border_v,
                                     .edge_filter = p->edge_filter};
    *out = (slv_source){&texture_fns, source};
    return SLV_OK;
}
