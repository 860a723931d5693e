/* Opening a file: the header, then every table that it points to. */
#include "ptx/ptx_file.h"

#include <stdlib.h>

static slv_result parse_header(slv_ptx *ptx, const uint8_t *header) {
    slv_ptx_info *info = &ptx->info;
    uint32_t version = ptx_get_u32(header + 4), mesh_type = ptx_get_u32(header + 8);
    uint32_t type = ptx_get_u32(header + 12), nfaces = ptx_get_u32(header + 24);
    const char *name = ptx->name;
    if (version != 1)
        return slv_fail(&ptx->env, SLV_ERROR_UNSUPPORTED,
                        "%s: version %u of the format; only version 1 is known", name, version);
    if (mesh_type > SLV_PTX_QUAD)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: unknown mesh type %u (0 is triangles, 1 quads)", name, mesh_type);
    if (type > SLV_TYPE_FLOAT)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: unknown data type %u", name, type);
    if (nfaces > INT32_MAX)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: claims %u faces", name, nfaces);
    info->mesh_type = (slv_ptx_mesh_type)mesh_type;
    info->type = (slv_type)type;
    info->nchannels = ptx_get_u16(header + 20);
    info->alpha_channel = (int32_t)ptx_get_u32(header + 16);
    if (info->alpha_channel < 0 || (uint32_t)info->alpha_channel >= info->nchannels)
        info->alpha_channel = SLV_NO_ALPHA;
    info->nfaces = nfaces;
    info->nlevels = ptx_get_u16(header + 22);
    info->minor_version = ptx_get_u32(header + 44);
    info->file_bytes = ptx->source.size;
    ptx->pixel_size = info->nchannels * slv_type_size(info->type);
    if (!info->nchannels)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: has no channels", name);
    if (info->nlevels < 1 || info->nlevels > PTX_MAX_LEVELS)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: claims %u levels, 1 to %d are possible",
                        name, info->nlevels, PTX_MAX_LEVELS);
    if (ptx_get_u32(header + 40) != info->nlevels * PTX_LEVEL_INFO_SIZE)
        return slv_fail(
            &ptx->env, SLV_ERROR_FORMAT, "%s: its level list has %u bytes, %u levels need %u", name,
            ptx_get_u32(header + 40), info->nlevels, info->nlevels * PTX_LEVEL_INFO_SIZE);
    return SLV_OK;
}

static slv_result parse_extended_header(slv_ptx *ptx, const uint8_t *extended) {
    uint32_t u = ptx_get_u16(extended), v = ptx_get_u16(extended + 4);
    uint32_t filter = ptx_get_u16(extended + 6);
    if (u > SLV_BORDER_PERIODIC || v > SLV_BORDER_PERIODIC || filter > SLV_EDGE_FILTER_TANVEC)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: unknown border mode or edge filter (u %u, v %u, filter %u)", ptx->name,
                        u, v, filter);
    ptx->info.border_u = (slv_border_mode)u;
    ptx->info.border_v = (slv_border_mode)v;
    ptx->info.edge_filter = (slv_edge_filter)filter;
    return SLV_OK;
}

/* Moves a position over a section; false if the sum leaves the file, barrier and empty sections
 * allowed for. */
static bool advance(const slv_ptx *ptx, uint64_t *position, uint64_t size) {
    uint64_t furthest = ptx->source.size + PTX_BARRIER_SIZE;
    if (*position > furthest || size > furthest - *position)
        return false;
    *position += size;
    return true;
}

/* Everything behind the levels. */
static slv_result read_tail(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                            const uint8_t *header, const uint8_t *extended, uint64_t position) {
    uint32_t small_zipped = ptx_get_u32(header + 56), small_size = ptx_get_u32(header + 60);
    uint32_t large_zipped = ptx_get_u32(extended + 8), large_size = ptx_get_u32(extended + 12);
    uint64_t large_data = ptx_get_u64(extended + 16), edit_size = ptx_get_u64(extended + 24);
    uint64_t edit_position = ptx_get_u64(extended + 32), edit_end = ptx->source.size;
    uint8_t *bytes = NULL;
    slv_result result = SLV_OK;
    bool any_meta = small_zipped || large_zipped;

    if (small_size) {
        result =
            ptx_read_zip(ptx, inflater, "metadata", position, small_zipped, small_size, &bytes);
        if (!result)
            result = ptx_meta_parse(ptx, "metadata", bytes, small_size);
        free(bytes);
    }
    if (result)
        return result;
    uint64_t large_position = position;
    if (!advance(ptx, &large_position, small_zipped) ||
        !advance(ptx, &large_position, PTX_BARRIER_SIZE))
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: truncated: the metadata at offset %llu is %u bytes, but the file ends "
                        "at %llu",
                        ptx->name, (unsigned long long)position, small_zipped,
                        (unsigned long long)ptx->source.size);
    position = large_position;
    uint64_t data_position = position, summed = position;
    if (!advance(ptx, &data_position, large_zipped))
        return ptx_read_bytes(&ptx->env, ptx, "table of large metadata", position, large_zipped,
                              NULL);
    summed = data_position;
    if (!advance(ptx, &summed, large_data))
        return ptx_read_bytes(&ptx->env, ptx, "large metadata", data_position, large_data, NULL);
    if (large_size) {
        bytes = NULL;
        result = ptx_read_zip(ptx, inflater, "table of large metadata", position, large_zipped,
                              large_size, &bytes);
        if (!result)
            result = ptx_meta_read_large(ptx, inflater, bytes, large_size, data_position, summed);
        free(bytes);
    }
    if (result)
        return result;

    /* Files without metadata lack the barrier that the sum counts, so their edits begin before it.
     */
    uint64_t start = summed, earliest = any_meta ? summed : summed - PTX_BARRIER_SIZE;
    if (edit_position) {
        if (edit_position >= earliest)
            start = edit_position;
        if (!edit_size)
            return SLV_OK;
        if (start > ptx->source.size || edit_size > ptx->source.size - start)
            return ptx_read_bytes(&ptx->env, ptx, "edit section", start, edit_size, NULL);
        edit_end = start + edit_size;
    }
    return ptx_read_edits(ptx, inflater, start, edit_end, edit_position == 0);
}

static slv_result read_all(slv_ptx *ptx) {
    uint8_t header[PTX_HEADER_SIZE] = {0}, extended[PTX_EXTENDED_HEADER_SIZE] = {0};
    struct libdeflate_decompressor *inflater = NULL;
    uint64_t available = ptx->source.size < sizeof header ? ptx->source.size : sizeof header;
    slv_result result = ptx_read_bytes(&ptx->env, ptx, "header", 0, available, header);
    if (result)
        return result;
    if (available < 4 || memcmp(header, "Ptex", 4) != 0)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: not a .ptx file: it does not begin with \"Ptex\"", ptx->name);
    if (available < sizeof header)
        return ptx_read_bytes(&ptx->env, ptx, "header", 0, sizeof header, header);
    if ((result = parse_header(ptx, header)))
        return result;
    uint32_t extended_size = ptx_get_u32(header + 28);
    uint64_t position = PTX_HEADER_SIZE + (uint64_t)extended_size;
    if ((result = ptx_read_bytes(&ptx->env, ptx, "extended header", PTX_HEADER_SIZE,
                                 extended_size < sizeof extended ? extended_size : sizeof extended,
                                 extended)) ||
        (result = parse_extended_header(ptx, extended)))
        return result;
    inflater = libdeflate_alloc_decompressor();
    if (!inflater)
        return slv_fail(&ptx->env, SLV_ERROR_MEMORY, "%s: no memory to unpack it", ptx->name);
    result = ptx_read_tables(ptx, inflater, header, position);
    /* the tables are within the file, so these sums cannot overflow */
    position += (uint64_t)ptx_get_u32(header + 32) + ptx_get_u32(header + 36) +
                ptx_get_u32(header + 40) + ptx_get_u64(header + 48);
    if (!result)
        result = read_tail(ptx, inflater, header, extended, position);
    if (!result)
        result = ptx_meta_finish(ptx);
    libdeflate_free_decompressor(inflater);
    return result;
}

slv_result slv_ptx_open_source(const slv_env *env, const char *name, const slv_ptx_source *source,
                               slv_ptx **out) {
    slv_ptx *ptx = NULL;
    *out = NULL;
    slv_result result = slv_alloc(env, name, 1, sizeof *ptx, &ptx);
    if (result) {
        if (source->close)
            source->close(source->user);
        return result;
    }
    ptx->source = *source;
    if (!(result = slv_parallel_env_begin(env, &ptx->log, &ptx->env)) &&
        !(result = slv_alloc(env, name, strlen(name) + 1, 1, &ptx->name))) {
        memcpy(ptx->name, name, strlen(name) + 1);
        result = read_all(ptx);
    }
    if (result) {
        slv_ptx_close(ptx);
        return result;
    }
    *out = ptx;
    return SLV_OK;
}

slv_result slv_ptx_open(const slv_env *env, const char *path, slv_ptx **out) {
    slv_ptx_source source;
    *out = NULL;
    slv_result result = ptx_source_open(env, path, &source);
    return result ? result : slv_ptx_open_source(env, path, &source, out);
}

void slv_ptx_close(slv_ptx *ptx) {
    if (!ptx)
        return;
    if (ptx->source.close)
        ptx->source.close(ptx->source.user);
    for (uint32_t i = 0; ptx->levels && i < ptx->info.nlevels; i++) {
        free(ptx->levels[i].headers);
        free(ptx->levels[i].positions);
    }
    ptx_meta_free(ptx);
    free(ptx->levels);
    free(ptx->level_faces);
    free(ptx->ranks);
    free(ptx->faces);
    free(ptx->constants);
    free(ptx->name);
    slv_parallel_env_end(ptx->log);
    free(ptx);
}

const slv_ptx_info *slv_ptx_get_info(const slv_ptx *ptx) {
    return &ptx->info;
}

const char *slv_ptx_name(const slv_ptx *ptx) {
    return ptx->name;
}

slv_result slv_ptx_get_face(const slv_ptx *ptx, uint32_t face, slv_ptx_face *out) {
    if (face >= ptx->info.nfaces)
        return slv_fail(&ptx->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces", ptx->name,
                        face, ptx->info.nfaces);
    *out = ptx->faces[face];
    return SLV_OK;
}
