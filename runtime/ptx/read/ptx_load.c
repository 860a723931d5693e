/* From a file to the library's own objects. */
#include "ptx/read/ptx_texels.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "mesh/mesh_data.h"

#include <selvage/subface.h>

/* Blocks of consecutive faces follow each other. */
#define READ_AHEAD (1 << 18)

struct visit {
    const slv_env *env;
    const slv_ptx *ptx;
    slv_ptx_visit_fn visit;
    void *user;
    const uint32_t *faces; /* NULL: all */
    uint32_t nfaces;
    const slv_res *res; /* at which faces are read; NULL: their own */
    ptx_errors errors;
    slvi_steps *steps; /* NULL: nobody is told */
};

static slv_res res_of(const struct visit *visit, uint32_t face, const slv_ptx_face *f) {
    if (ptx_is_one_texel(f))
        return (slv_res){0, 0};
    return visit->res ? visit->res[face] : f->res;
}

/* Reductions of a file are multiplied by alpha, texels and means are not. */
static void as_painted(const slv_ptx *ptx, const slv_ptx_face *f, slv_res res, void *texels) {
    bool reduced = res.u != f->res.u || res.v != f->res.v, mean = res.u == 0 && res.v == 0;
    if (reduced && !mean && !ptx->premultiply)
        slv_ptx_unmultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel, texels,
                           ptx_texel_count(res));
}

static slv_result visit_range(void *user, uint64_t first, uint64_t end) {
    struct visit *visit = user;
    const slv_ptx *ptx = visit->ptx;
    ptx_range_log log;
    slv_env env = slvi_ptx_range_env(visit->env, &visit->errors, first, &log);
    ptx_scratch scratch = {.env = &env, .read_ahead = READ_AHEAD};
    ptx_buffer texels = {0};
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        uint32_t face = visit->faces ? visit->faces[i] : (uint32_t)i;
        slv_ptx_face f = slvi_ptx_face_at(ptx, face);
        slv_res res = res_of(visit, face, &f);
        if ((result = slvi_ptx_scratch_reserve(&scratch, ptx, &texels,
                                               ptx_texel_count(res) * ptx->pixel_size)) ||
            (result = slvi_ptx_read_face_with(ptx, &scratch, face, res, texels.bytes)))
            break;
        as_painted(ptx, &f, res, texels.bytes);
        result = visit->visit(visit->user, &env, face, &f, texels.bytes);
    }
    slvi_free(texels.bytes);
    slvi_ptx_scratch_free(&scratch);
    return result ? result : slvi_steps_add(visit->steps, &env, ptx->name, end - first);
}

/* Refuses before any memory is spent on them texels that cannot be there, or are more than allowed:
 * together if `all`, else each for itself. */
static slv_result check_sizes(const struct visit *visit, bool all, uint64_t *total) {
    const slv_env *env = visit->env;
    const slv_ptx *ptx = visit->ptx;
    uint64_t limit = slvi_env_or_default(env).max_bytes;
    *total = 0;
    for (uint32_t i = 0; i < visit->nfaces; i++) {
        uint32_t face = visit->faces ? visit->faces[i] : i;
        slv_ptx_face f = slvi_ptx_face_at(ptx, face);
        if (!ptx_is_one_texel(&f) && !ptx->salvage && !visit->res &&
            !slvi_ptx_face_is_plausible(ptx, face, &f))
            return slvi_fail(env, SLV_ERROR_FORMAT,
                             "%s: face %u: its texels do not fit into the bytes that it has",
                             ptx->name, face);
        uint64_t bytes = ptx_texel_count(res_of(visit, face, &f)) * ptx->pixel_size;
        if (bytes > limit || (all && *total > limit - bytes))
            return slvi_fail(env, SLV_ERROR_LIMIT,
                             "%s: face %u: with it the texels pass the limit of %llu bytes",
                             ptx->name, face, (unsigned long long)limit);
        *total += bytes;
    }
    return SLV_OK;
}

/* What must be there; of a file opened for salvage most can be missing. */
static uint64_t texel_parts(const slv_ptx *ptx) {
    return ptx->salvage ? PTX_FACES : PTX_FACES | PTX_CONSTANTS | PTX_LEVEL(0);
}

static slv_result visit_all(struct visit *visit, uint64_t total) {
    uint32_t nfaces = visit->nfaces;
    uint64_t grain = nfaces / (total / (1 << 20) + 1) + 1;
    if (grain > nfaces / 16 + 1)
        grain = nfaces / 16 + 1;
    return slvi_ptx_parallel_for(visit->env, &visit->errors, nfaces, grain, visit_range, visit);
}

slv_result slv_ptx_visit_some_faces(const slv_env *env, const slv_ptx *ptx, const uint32_t *faces,
                                    uint32_t nfaces, slv_ptx_visit_fn visit, void *user) {
    uint64_t total;
    struct visit v = {
        .env = env, .ptx = ptx, .visit = visit, .user = user, .faces = faces, .nfaces = nfaces};
    slv_result result = ptx_need(ptx, texel_parts(ptx));
    for (uint32_t i = 0; faces && i < nfaces && !result; i++)
        if (faces[i] >= ptx->info.nfaces || (i && faces[i] <= faces[i - 1]))
            result = slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: face %u is not there, or not in order",
                               ptx->name, faces[i]);
    if (result || (result = check_sizes(&v, false, &total)))
        return result;
    return visit_all(&v, total);
}

slv_result slv_ptx_visit_faces(const slv_env *env, const slv_ptx *ptx, slv_ptx_visit_fn visit,
                               void *user) {
    return slv_ptx_visit_some_faces(env, ptx, NULL, ptx->info.nfaces, visit, user);
}

static slv_result store_face(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    slv_texture *texture = user;
    (void)env;
    return ptx_is_one_texel(info) ? slv_texture_set_constant(texture, face, texels)
                                  : slv_texture_set_face(texture, face, texels);
}

static slv_result check_res(const slv_env *env, const slv_ptx *ptx, const slv_res *res) {
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    for (uint32_t face = 0; face < ptx->info.nfaces; face++) {
        slv_res own = slvi_ptx_face_at(ptx, face).res, at = res[face];
        if (at.u < 0 || at.v < 0 || at.u > own.u || at.v > own.v || (triangle && at.u != at.v))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "%s: face %u: has 2^%d x 2^%d texels, which do not reduce to 2^%d x "
                             "2^%d",
                             ptx->name, face, own.u, own.v, at.u, at.v);
    }
    return SLV_OK;
}

static slv_result load_texture(const slv_env *env, const slv_ptx *ptx, const slv_res *res,
                               slv_texture **out) {
    slv_res *own = NULL;
    slv_texture *texture = NULL;
    uint64_t total;
    slvi_steps steps;
    *out = NULL;
    slv_result result = ptx_need(ptx, texel_parts(ptx));
    struct visit visit = {.env = env,
                          .ptx = ptx,
                          .visit = store_face,
                          .nfaces = ptx->info.nfaces,
                          .res = res,
                          .steps = &steps};
    slvi_steps_begin(&steps, ptx->progress, ptx->info.nfaces);
    if (result || (res && (result = check_res(env, ptx, res))) ||
        (result = check_sizes(&visit, true, &total)) ||
        (!res && (result = slvi_alloc(env, ptx->name, ptx->info.nfaces, sizeof *own, &own))))
        goto done;
    for (uint32_t face = 0; own && face < ptx->info.nfaces; face++)
        own[face] = slvi_ptx_face_at(ptx, face).res;
    slv_texture_desc desc = {.nfaces = ptx->info.nfaces,
                             .type = ptx->info.type,
                             .nchannels = ptx->info.nchannels,
                             .alpha_channel = ptx->info.alpha_channel,
                             .res = res ? res : own};
    if ((result = slvi_ptx_stated_encoding(ptx, &desc.encoding)) ||
        (result = slv_texture_create(env, &desc, &texture)))
        goto done;
    visit.user = texture;
    if ((result = visit_all(&visit, total)))
        goto done;
    *out = texture;
    texture = NULL;
done:
    slvi_steps_end(&steps);
    slv_texture_destroy(texture);
    slvi_free(own);
    return result;
}

slv_result slv_ptx_load_texture_at(const slv_env *env, const slv_ptx *ptx, const slv_res *res,
                                   slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load_texture(&own, ptx, res, out));
}

slv_result slv_ptx_load_texture(const slv_env *env, const slv_ptx *ptx, slv_texture **out) {
    return slv_ptx_load_texture_at(env, ptx, NULL, out);
}

static slv_result load_adjacency(const slv_env *env, const slv_ptx *ptx, slv_adjacency **out) {
    slv_face_adjacency *records = NULL;
    uint8_t *flags = NULL;
    *out = NULL;
    slv_result result = ptx_need(ptx, PTX_FACES);
    if (!result)
        result = slvi_alloc(env, ptx->name, ptx->info.nfaces, sizeof *records, &records);
    if (!result)
        result = slvi_alloc(env, ptx->name, ptx->info.nfaces, 1, &flags);
    for (uint32_t face = 0; !result && face < ptx->info.nfaces; face++) {
        slv_ptx_face f = slvi_ptx_face_at(ptx, face);
        records[face] = f.adjacency;
        flags[face] = f.flags & SLV_FACE_SUBFACE;
    }
    if (!result)
        result = ptx->info.mesh_type == SLV_PTX_TRIANGLE
                     ? slv_adjacency_create_triangles(env, ptx->info.nfaces, records, out)
                     : slv_adjacency_create(env, ptx->info.nfaces, records, flags, out);
    slvi_free(records);
    slvi_free(flags);
    return result;
}

slv_result slv_ptx_load_adjacency(const slv_env *env, const slv_ptx *ptx, slv_adjacency **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load_adjacency(&own, ptx, out));
}

static const char *const geometry_keys[] = {"PtexFaceVertCounts", "PtexFaceVertIndices",
                                            "PtexVertPositions"};

static slv_result find_geometry(const slv_env *env, const slv_ptx *ptx, const char *key,
                                slv_meta_type type, const slv_ptx_meta **out) {
    ptx_meta *meta = slvi_ptx_meta_lookup(ptx, key);
    if (!meta)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: holds no mesh: it has no metadata %s",
                         ptx->name, key);
    slv_result result = slvi_ptx_meta_load(ptx, meta, out);
    if (result)
        return result;
    if ((*out)->type != type)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: metadata %s has the wrong type", ptx->name,
                         key);
    return SLV_OK;
}

static slv_result load_mesh(const slv_env *env, const slv_ptx *ptx, slv_mesh **out) {
    const slv_ptx_meta *counts = NULL, *indices = NULL, *positions = NULL;
    slv_result result;
    *out = NULL;
    if ((result = find_geometry(env, ptx, geometry_keys[0], SLV_META_INT32, &counts)) ||
        (result = find_geometry(env, ptx, geometry_keys[1], SLV_META_INT32, &indices)) ||
        (result = find_geometry(env, ptx, geometry_keys[2], SLV_META_FLOAT, &positions)))
        return result;
    const int32_t *sizes = counts->values, *verts = indices->values;
    uint64_t nindices = 0, nfaces = 0;
    uint32_t nverts = positions->count / 3;
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    for (uint32_t poly = 0; poly < counts->count; poly++) {
        if (triangle ? sizes[poly] != 3 : sizes[poly] < 3)
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "%s: its mesh has a polygon %u of %d vertices", ptx->name, poly,
                             sizes[poly]);
        nindices += (uint32_t)sizes[poly];
        nfaces += triangle || sizes[poly] == 4 ? 1 : (uint32_t)sizes[poly];
    }
    if (nindices != indices->count)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s: PtexFaceVertCounts adds up to %llu, PtexFaceVertIndices has %u",
                         ptx->name, (unsigned long long)nindices, indices->count);
    if (nfaces != ptx->info.nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: its mesh has %llu faces, its texture %u",
                         ptx->name, (unsigned long long)nfaces, ptx->info.nfaces);
    if (positions->count % 3)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: PtexVertPositions has %u values, not threes",
                         ptx->name, positions->count);
    for (uint32_t i = 0; i < indices->count; i++)
        if (verts[i] < 0 || (uint32_t)verts[i] >= nverts)
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "%s: PtexFaceVertIndices names vertex %d of %u", ptx->name, verts[i],
                             nverts);
    slv_mesh_view view = {.nverts = nverts,
                          .positions = positions->values,
                          .npolys = counts->count,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    float *near = NULL;
    if (slvi_mesh_find_origin(view.positions, verts, indices->count, view.origin)) {
        if ((result = slvi_alloc(env, ptx->name, nverts, 3 * sizeof *near, &near)))
            return result;
        memcpy(near, view.positions, nverts * 3 * sizeof *near);
        slvi_mesh_shift(near, NULL, nverts, view.origin);
        view.positions = near;
    }
    result = slv_mesh_create(env, &view, out);
    slvi_free(near);
    return result;
}

slv_result slv_ptx_load_mesh(const slv_env *env, const slv_ptx *ptx, slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load_mesh(&own, ptx, out));
}

slv_result slv_ptx_find_mesh(const slv_env *env, const slv_ptx *ptx, slv_mesh **out,
                             slv_result *why) {
    ptx_kept_line line;
    slv_env quiet = slvi_ptx_keep_line(env, &line);
    *out = NULL;
    /* what a value cannot be read for is told by the file's own log */
    for (size_t i = 0; i < sizeof geometry_keys / sizeof *geometry_keys; i++) {
        const slv_ptx_meta *entry;
        ptx_meta *meta = slvi_ptx_meta_lookup(ptx, geometry_keys[i]);
        slv_result result = meta ? slvi_ptx_meta_load(ptx, meta, &entry) : SLV_OK;
        if (result)
            return result;
    }
    slv_result loaded = slv_ptx_load_mesh(&quiet, ptx, out);
    if (why)
        *why = loaded;
    if (!loaded || loaded == SLV_ERROR_UNSUPPORTED || loaded == SLV_ERROR_MISMATCH ||
        loaded == SLV_ERROR_FORMAT)
        return SLV_OK;
    return slvi_fail(env, loaded, "%s", line.text);
}
