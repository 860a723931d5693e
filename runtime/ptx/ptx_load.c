/* From a file to the library's own objects. */
#include "ptx/ptx_file.h"

#include <stdlib.h>

struct load {
    const slv_env *env;
    const slv_ptx *ptx;
    slv_texture *texture;
    ptx_errors errors;
};

static slv_result load_faces(void *user, uint64_t first, uint64_t end) {
    struct load *load = user;
    const slv_ptx *ptx = load->ptx;
    ptx_range_log log;
    slv_env env = ptx_range_env(load->env, &load->errors, first, &log);
    /* blocks of consecutive faces follow each other */
    ptx_scratch scratch = {.env = &env, .read_ahead = 1 << 18};
    ptx_buffer texels = {0};
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        uint32_t face = (uint32_t)i;
        const slv_ptx_face *f = &ptx->faces[face];
        if ((f->flags & SLV_FACE_CONSTANT) || (f->res.u == 0 && f->res.v == 0)) {
            result = slv_texture_set_constant(load->texture, face,
                                              ptx->constants + face * ptx->pixel_size);
            continue;
        }
        if (!(result = ptx_scratch_reserve(&scratch, ptx, &texels,
                                           ptx_texel_count(f->res) * ptx->pixel_size)) &&
            !(result = ptx_read_face_with(ptx, &scratch, face, f->res, texels.bytes)))
            result = slv_texture_set_face(load->texture, face, texels.bytes);
    }
    free(texels.bytes);
    ptx_scratch_free(&scratch);
    return result;
}

/* Refuses before any store is made for it what could not be read, or is more than allowed. */
static slv_result check_sizes(const slv_env *env, const slv_ptx *ptx, uint64_t *total) {
    uint64_t limit = slv_env_or_default(env).max_bytes;
    *total = 0;
    for (uint32_t face = 0; face < ptx->info.nfaces; face++) {
        const slv_ptx_face *f = &ptx->faces[face];
        if ((f->flags & SLV_FACE_CONSTANT) || (f->res.u == 0 && f->res.v == 0)) {
            *total += ptx->pixel_size;
            continue;
        }
        if (!ptx_face_is_plausible(ptx, face))
            return slv_fail(env, SLV_ERROR_FORMAT,
                            "%s: face %u: its texels do not fit into the %u bytes that it has",
                            ptx->name, face, PTX_BLOCK_SIZE(ptx->levels[0].headers[face]));
        uint64_t bytes = ptx_texel_count(f->res) * ptx->pixel_size;
        if (bytes > limit || *total > limit - bytes)
            return slv_fail(env, SLV_ERROR_LIMIT,
                            "%s: face %u: with it the texels pass the limit of %llu bytes",
                            ptx->name, face, (unsigned long long)limit);
        *total += bytes;
    }
    return SLV_OK;
}

slv_result slv_ptx_load_texture(const slv_env *env, const slv_ptx *ptx, slv_texture **out) {
    slv_res *res = NULL;
    slv_texture *texture = NULL;
    uint64_t total;
    *out = NULL;
    slv_result result = check_sizes(env, ptx, &total);
    if (result || (result = slv_alloc(env, ptx->name, ptx->info.nfaces, sizeof *res, &res)))
        goto done;
    for (uint32_t face = 0; face < ptx->info.nfaces; face++)
        res[face] = ptx->faces[face].res;
    slv_texture_desc desc = {ptx->info.nfaces, ptx->info.type, ptx->info.nchannels,
                             ptx->info.alpha_channel, res};
    if ((result = slv_texture_create(env, &desc, &texture)))
        goto done;
    struct load load = {.env = env, .ptx = ptx, .texture = texture};
    uint64_t grain = ptx->info.nfaces / (total / (1 << 20) + 1) + 1;
    if ((result = ptx_parallel_for(env, &load.errors, ptx->info.nfaces, grain, load_faces, &load)))
        goto done;
    *out = texture;
    texture = NULL;
done:
    slv_texture_destroy(texture);
    free(res);
    return result;
}

slv_result slv_ptx_load_adjacency(const slv_env *env, const slv_ptx *ptx, slv_adjacency **out) {
    slv_face_adjacency *records = NULL;
    uint8_t *flags = NULL;
    *out = NULL;
    if (ptx->info.mesh_type == SLV_PTX_TRIANGLE)
        return slv_fail(env, SLV_ERROR_UNSUPPORTED,
                        "%s: is a triangle-mesh texture; adjacency is of quads only", ptx->name);
    slv_result result = slv_alloc(env, ptx->name, ptx->info.nfaces, sizeof *records, &records);
    if (!result)
        result = slv_alloc(env, ptx->name, ptx->info.nfaces, 1, &flags);
    for (uint32_t face = 0; !result && face < ptx->info.nfaces; face++) {
        records[face] = ptx->faces[face].adjacency;
        flags[face] = ptx->faces[face].flags & SLV_FACE_SUBFACE;
    }
    if (!result)
        result = slv_adjacency_create(env, ptx->info.nfaces, records, flags, out);
    free(records);
    free(flags);
    return result;
}

static slv_result find_geometry(const slv_env *env, const slv_ptx *ptx, const char *key,
                                slv_meta_type type, const slv_ptx_meta **out) {
    *out = slv_ptx_find_meta(ptx, key);
    if (!*out)
        return slv_fail(env, SLV_ERROR_UNSUPPORTED, "%s: holds no mesh: it has no metadata %s",
                        ptx->name, key);
    if ((*out)->type != type)
        return slv_fail(env, SLV_ERROR_MISMATCH, "%s: metadata %s has the wrong type", ptx->name,
                        key);
    return SLV_OK;
}

slv_result slv_ptx_load_mesh(const slv_env *env, const slv_ptx *ptx, slv_mesh **out) {
    const slv_ptx_meta *counts, *indices, *positions;
    slv_result result;
    *out = NULL;
    if ((result = find_geometry(env, ptx, "PtexFaceVertCounts", SLV_META_INT32, &counts)) ||
        (result = find_geometry(env, ptx, "PtexFaceVertIndices", SLV_META_INT32, &indices)) ||
        (result = find_geometry(env, ptx, "PtexVertPositions", SLV_META_FLOAT, &positions)))
        return result;
    const int32_t *sizes = counts->values, *verts = indices->values;
    uint64_t nindices = 0, nfaces = 0;
    uint32_t nverts = positions->count / 3;
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    for (uint32_t poly = 0; poly < counts->count; poly++) {
        if (triangle ? sizes[poly] != 3 : sizes[poly] < 3)
            return slv_fail(env, SLV_ERROR_MISMATCH, "%s: its mesh has a polygon %u of %d vertices",
                            ptx->name, poly, sizes[poly]);
        nindices += (uint32_t)sizes[poly];
        nfaces += triangle || sizes[poly] == 4 ? 1 : (uint32_t)sizes[poly];
    }
    if (nindices != indices->count)
        return slv_fail(env, SLV_ERROR_MISMATCH,
                        "%s: PtexFaceVertCounts adds up to %llu, PtexFaceVertIndices has %u",
                        ptx->name, (unsigned long long)nindices, indices->count);
    if (nfaces != ptx->info.nfaces)
        return slv_fail(env, SLV_ERROR_MISMATCH, "%s: its mesh has %llu faces, its texture %u",
                        ptx->name, (unsigned long long)nfaces, ptx->info.nfaces);
    if (positions->count % 3)
        return slv_fail(env, SLV_ERROR_MISMATCH, "%s: PtexVertPositions has %u values, not threes",
                        ptx->name, positions->count);
    for (uint32_t i = 0; i < indices->count; i++)
        if (verts[i] < 0 || (uint32_t)verts[i] >= nverts)
            return slv_fail(env, SLV_ERROR_MISMATCH,
                            "%s: PtexFaceVertIndices names vertex %d of %u", ptx->name, verts[i],
                            nverts);
    slv_mesh_view view = {.nverts = nverts,
                          .positions = positions->values,
                          .npolys = counts->count,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    return slv_mesh_create(env, &view, out);
}
