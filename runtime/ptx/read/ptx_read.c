/* Opening a file: the header, then every table that it points to. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"
#include "base/memory.h"

static slv_result parse_header(slv_ptx *ptx, const uint8_t *header) {
    slv_ptx_info *info = &ptx->info;
    uint32_t version = ptx_get_u32(header + 4), mesh_type = ptx_get_u32(header + 8);
    uint32_t type = ptx_get_u32(header + 12), nfaces = ptx_get_u32(header + 24);
    const char *name = ptx->name;
    if (version != 1)
        return slvi_fail(&ptx->env, SLV_ERROR_UNSUPPORTED,
                         "%s: version %u of the format; only version 1 is known", name, version);
    if (mesh_type > SLV_PTX_QUAD)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: unknown mesh type %u (0 is triangles, 1 quads)", name, mesh_type);
    if (type > SLV_TYPE_FLOAT)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: unknown data type %u", name, type);
    if (nfaces > INT32_MAX)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: claims %u faces", name, nfaces);
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
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: has no channels", name);
    if (info->nlevels < 1 || info->nlevels > PTX_MAX_LEVELS)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: claims %u levels, 1 to %d are possible",
                         name, info->nlevels, PTX_MAX_LEVELS);
    if (ptx_get_u32(header + 40) != info->nlevels * PTX_LEVEL_INFO_SIZE)
        return slvi_fail(
            &ptx->env, SLV_ERROR_FORMAT, "%s: its level list has %u bytes, %u levels need %u", name,
            ptx_get_u32(header + 40), info->nlevels, info->nlevels * PTX_LEVEL_INFO_SIZE);
    return SLV_OK;
}

static slv_result parse_extended_header(slv_ptx *ptx, const uint8_t *extended) {
    uint32_t u = ptx_get_u16(extended), v = ptx_get_u16(extended + 4);
    uint32_t filter = ptx_get_u16(extended + 6);
    if (u > SLV_BORDER_PERIODIC || v > SLV_BORDER_PERIODIC || filter > SLV_EDGE_FILTER_TANVEC)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: unknown border mode or edge filter (u %u, v %u, filter %u)",
                         ptx->name, u, v, filter);
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
        result = slvi_ptx_read_zip(ptx, inflater, "metadata", position, small_zipped, small_size,
                                   &bytes);
        if (!result)
            result = slvi_ptx_meta_parse(ptx, "metadata", bytes, small_size);
        slvi_free(bytes);
    }
    if (result)
        return result;
    uint64_t large_position = position;
    if (!advance(ptx, &large_position, small_zipped) ||
        !advance(ptx, &large_position, PTX_BARRIER_SIZE))
        return slvi_fail(
            &ptx->env, SLV_ERROR_FORMAT,
            "%s: truncated: the metadata at offset %llu is %u bytes, but the file ends "
            "at %llu",
            ptx->name, (unsigned long long)position, small_zipped,
            (unsigned long long)ptx->source.size);
    position = large_position;
    uint64_t data_position = position, summed = position;
    if (!advance(ptx, &data_position, large_zipped))
        return slvi_ptx_read_bytes(&ptx->env, ptx, "table of large metadata", position,
                                   large_zipped, NULL);
    summed = data_position;
    if (!advance(ptx, &summed, large_data))
        return slvi_ptx_read_bytes(&ptx->env, ptx, "large metadata", data_position, large_data,
                                   NULL);
    if (large_size) {
        bytes = NULL;
        result = slvi_ptx_read_zip(ptx, inflater, "table of large metadata", position, large_zipped,
                                   large_size, &bytes);
        if (!result)
            result = slvi_ptx_meta_read_large(ptx, bytes, large_size, data_position, summed);
        slvi_free(bytes);
    }
    if (result)
        return result;

    /* Files without metadata lack the barrier that the sum counts, so their edits begin before it.
     */
    uint64_t start = summed, earliest = any_meta ? summed : summed - PTX_BARRIER_SIZE;
    ptx->edit_position = ptx->edit_end = summed;
    if (edit_position) {
        if (edit_position >= earliest)
            start = edit_position;
        if (!edit_size)
            return SLV_OK;
        ptx->edit_position = start;
        if (start > ptx->source.size || edit_size > ptx->source.size - start)
            return slvi_ptx_read_bytes(&ptx->env, ptx, "edit section", start, edit_size, NULL);
        edit_end = start + edit_size;
    }
    return slvi_ptx_read_edits(ptx, inflater, start, edit_end, edit_position == 0);
}

/* Of a file opened for salvage what is behind the levels is left out if it cannot be read. */
static slv_result read_tail_anyway(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                                   const uint8_t *header, const uint8_t *extended,
                                   uint64_t position) {
    ptx_kept_line line;
    slv_env env = ptx->env;
    if (!ptx->salvage)
        return read_tail(ptx, inflater, header, extended, position);
    ptx->env = slvi_ptx_keep_line(&env, &line);
    slv_result result = read_tail(ptx, inflater, header, extended, position);
    ptx->env = env;
    if (ptx_goes_on(ptx, result)) {
        ptx->nleft_out++;
        slvi_logf(&env, SLV_LOG_WARNING, "%s; what follows is left out", line.text);
        result = SLV_OK;
    } else if (result) {
        return slvi_fail(&env, result, "%s", line.text);
    }
    return slvi_ptx_meta_salvage(ptx);
}

static slv_result read_all(slv_ptx *ptx) {
    uint8_t header[PTX_HEADER_SIZE] = {0}, extended[PTX_EXTENDED_HEADER_SIZE] = {0};
    struct libdeflate_decompressor *inflater = NULL;
    uint64_t available = ptx->source.size < sizeof header ? ptx->source.size : sizeof header;
    slv_result result = slvi_ptx_read_bytes(&ptx->env, ptx, "header", 0, available, header);
    if (result)
        return result;
    if (available < 4 || memcmp(header, "Ptex", 4) != 0)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: not a .ptx file: it does not begin with \"Ptex\"", ptx->name);
    if (available < sizeof header)
        return slvi_ptx_read_bytes(&ptx->env, ptx, "header", 0, sizeof header, header);
    if ((result = parse_header(ptx, header)))
        return result;
    uint32_t extended_size = ptx_get_u32(header + 28);
    uint64_t position = PTX_HEADER_SIZE + (uint64_t)extended_size;
    if ((result = slvi_ptx_read_bytes(
             &ptx->env, ptx, "extended header", PTX_HEADER_SIZE,
             extended_size < sizeof extended ? extended_size : sizeof extended, extended)) ||
        (result = parse_extended_header(ptx, extended)))
        return result;
    inflater = libdeflate_alloc_decompressor();
    if (!inflater)
        return slvi_fail(&ptx->env, SLV_ERROR_MEMORY, "%s: no memory to unpack it", ptx->name);
    result = slvi_ptx_read_levels(ptx, header, position);
    /* the tables are within the file, so these sums cannot overflow */
    position += (uint64_t)ptx_get_u32(header + 32) + ptx_get_u32(header + 36) +
                ptx_get_u32(header + 40) + ptx_get_u64(header + 48);
    if (!result && ptx->salvage)
        result = slvi_alloc(&ptx->env, ptx->name, ptx->info.nfaces, sizeof *ptx->salvaged,
                            &ptx->salvaged);
    if (!result)
        result = read_tail_anyway(ptx, inflater, header, extended, position);
    if (!result)
        result = slvi_ptx_meta_finish(ptx);
    if (!result && ptx->salvage)
        result = slvi_ptx_salvage_tables(ptx);
    libdeflate_free_decompressor(inflater);
    return result;
}

static slv_result open_within(const slv_env *env, const char *name, const slv_stream_in *source,
                              const slv_ptx_open_params *params, slv_ptx **out) {
    slv_ptx *ptx = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, name, 1, sizeof *ptx, &ptx);
    if (result) {
        if (source->close)
            source->close(source->user);
        return result;
    }
    ptx->source = *source;
    ptx->premultiply = params && params->premultiply;
    ptx->lenient = params && params->lenient;
    ptx->salvage = params && params->salvage;
    ptx->progress = params ? params->progress : (slv_progress){0};
    atomic_init(&ptx->nsalvaged, 0);
    ptx->info.level_faces = ptx->level_faces;
    ptx->info.level_bytes = ptx->level_bytes;
    if (!(result = slvi_parallel_env_begin(env, &ptx->log, &ptx->env)) &&
        !(result = slvi_alloc(env, name, 1, sizeof *ptx->tables, &ptx->tables))) {
        pthread_mutex_init(&ptx->tables->lock, NULL);
        atomic_init(&ptx->tables->ready, 0);
        result = slvi_alloc(env, name, strlen(name) + 1, 1, &ptx->name);
    }
    if (!result) {
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

static slv_result open_params(const slv_env *env, const char *name, const slv_stream_in *source,
                              const slv_ptx_open_params *params, slv_ptx **out) {
    slv_env own = slvi_budget_begin(env); /* which the file holds from then on */
    return slvi_budget_end(&own, open_within(&own, name, source, params, out));
}

slv_result slv_ptx_open_stream(const slv_env *env, const char *name, const slv_stream_in *source,
                               slv_ptx **out) {
    return open_params(env, name, source, NULL, out);
}

slv_result slv_ptx_open_with(const slv_env *env, const char *path,
                             const slv_ptx_open_params *params, slv_ptx **out) {
    slv_stream_in source;
    *out = NULL;
    if (params && params->source)
        return open_params(env, path, params->source, params, out);
    slv_result result = slvi_ptx_source_open(env, path, &source);
    return result ? result : open_params(env, path, &source, params, out);
}

slv_result slv_ptx_open(const slv_env *env, const char *path, slv_ptx **out) {
    return slv_ptx_open_with(env, path, NULL, out);
}

void slv_ptx_close(slv_ptx *ptx) {
    if (!ptx)
        return;
    if (ptx->source.close)
        ptx->source.close(ptx->source.user);
    if (ptx->tables) {
        for (uint32_t i = 0; i < PTX_MAX_LEVELS; i++) {
            slvi_free(ptx->tables->levels[i].headers);
            slvi_free(ptx->tables->levels[i].positions);
        }
        slvi_free(ptx->tables->records);
        slvi_free(ptx->tables->constants);
        slvi_free(ptx->tables->ranks);
        pthread_mutex_destroy(&ptx->tables->lock);
        slvi_free(ptx->tables);
    }
    slvi_ptx_meta_free(ptx);
    slvi_free(ptx->salvaged);
    slvi_free(ptx->edits);
    slvi_free(ptx->edit_values);
    slvi_free(ptx->name);
    slvi_parallel_env_end(ptx->log);
    slvi_free(ptx);
}

const slv_ptx_info *slv_ptx_get_info(const slv_ptx *ptx) {
    return &ptx->info;
}

const char *slv_ptx_name(const slv_ptx *ptx) {
    return ptx->name;
}

static slv_result check_face(const slv_ptx *ptx, uint32_t face) {
    if (face < ptx->info.nfaces)
        return SLV_OK;
    return slvi_fail(&ptx->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces", ptx->name,
                     face, ptx->info.nfaces);
}

slv_result slv_ptx_get_face(const slv_ptx *ptx, uint32_t face, slv_ptx_face *out) {
    slv_result result = check_face(ptx, face);
    if (result || (result = ptx_need(ptx, PTX_FACES)))
        return result;
    *out = slvi_ptx_face_at(ptx, face);
    return SLV_OK;
}

slv_result slv_ptx_get_block(const slv_ptx *ptx, uint32_t face, uint32_t level,
                             slv_ptx_block *out) {
    memset(out, 0, sizeof *out);
    slv_result result = check_face(ptx, face);
    if (!result && level >= ptx->info.nlevels)
        result = slvi_fail(&ptx->env, SLV_ERROR_ARGUMENT, "%s: level %u: there are %u levels",
                           ptx->name, level, ptx->info.nlevels);
    if (result || (result = ptx_need(ptx, PTX_FACES | PTX_LEVEL(level) | (level ? PTX_RANKS : 0))))
        return result;
    slv_ptx_face f = slvi_ptx_face_at(ptx, face);
    bool edited = f.flags & SLV_FACE_EDITED;
    const ptx_level *table = &ptx->tables->levels[level];
    uint32_t index = level ? ptx->tables->ranks[face] : face, header;
    if ((f.flags & SLV_FACE_CONSTANT) || index >= table->nfaces || (level && edited) ||
        (int)level > ptx_min_log2(f.res))
        return SLV_OK;
    if (edited) {
        const ptx_edit *edit = slvi_ptx_find_edit(ptx, face);
        header = edit->header;
        out->position = edit->position;
    } else {
        header = table->headers[index];
        out->position = slvi_ptx_block_position(table, index);
    }
    out->stored = true;
    out->encoding = (slv_ptx_encoding)PTX_BLOCK_ENCODING(header);
    out->bytes = PTX_BLOCK_SIZE(header);
    out->res = (slv_res){(int8_t)(f.res.u - (int)level), (int8_t)(f.res.v - (int)level)};
    return SLV_OK;
}
