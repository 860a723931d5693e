/* The face table, the averages and the level tables, each read when it is first needed. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdio.h>

void slvi_ptx_unpack_record(const uint8_t *record, bool triangle, slv_ptx_face *out) {
    memset(out, 0, sizeof *out);
    out->res = (slv_res){(int8_t)record[0], (int8_t)record[1]};
    out->flags = record[3];
    for (unsigned edge = 0; edge < 4; edge++) {
        bool missing = triangle && edge == 3;
        out->adjacency.face[edge] =
            missing ? SLV_BOUNDARY : (int32_t)ptx_get_u32(record + 4 + 4 * edge);
        out->adjacency.edge[edge] = missing ? 0 : record[2] >> (2 * edge) & 3;
    }
}

void slvi_ptx_pack_record(const slv_ptx_face *face, uint8_t *record) {
    record[0] = (uint8_t)face->res.u;
    record[1] = (uint8_t)face->res.v;
    record[2] = 0;
    record[3] = face->flags;
    for (unsigned edge = 0; edge < 4; edge++) {
        record[2] |= (uint8_t)((face->adjacency.edge[edge] & 3) << (2 * edge));
        ptx_put_u32(record + 4 + 4 * edge, (uint32_t)face->adjacency.face[edge]);
    }
}

static bool is_lost(const slv_ptx *ptx, int32_t there) {
    return (uint32_t)there + 1 > ptx->info.nfaces; /* a boundary, -1, becomes 0 */
}

slv_ptx_face slvi_ptx_face_at(const slv_ptx *ptx, uint32_t face) {
    slv_ptx_face out;
    slvi_ptx_unpack_record(ptx->tables->records + (size_t)face * PTX_FACE_INFO_SIZE,
                           ptx->info.mesh_type == SLV_PTX_TRIANGLE, &out);
    for (unsigned edge = 0; ptx->lenient && edge < 4; edge++)
        if (is_lost(ptx, out.adjacency.face[edge])) {
            out.adjacency.face[edge] = SLV_BOUNDARY;
            out.adjacency.edge[edge] = 0;
        }
    return out;
}

bool slvi_ptx_edge_is_lost(const slv_ptx *ptx, uint32_t face, unsigned edge, int32_t *to) {
    slv_ptx_face f;
    slvi_ptx_unpack_record(ptx->tables->records + (size_t)face * PTX_FACE_INFO_SIZE,
                           ptx->info.mesh_type == SLV_PTX_TRIANGLE, &f);
    *to = f.adjacency.face[edge];
    return is_lost(ptx, *to);
}

/* Whether nothing in a record is impossible; written so that it costs little for a million. */
static bool record_is_sound(const uint8_t *record, bool triangle, uint32_t nfaces) {
    uint32_t sound = (record[0] <= SLV_MAX_LOG2_RES) & (record[1] <= SLV_MAX_LOG2_RES) &
                     (!triangle | (record[0] == record[1]));
    /* a boundary, -1, becomes 0 */
    for (unsigned edge = 0; edge < 3; edge++)
        sound &= ptx_get_u32(record + 4 + 4 * edge) + 1 <= nfaces;
    return sound & (triangle | (ptx_get_u32(record + 16) + 1 <= nfaces));
}

slv_result slvi_ptx_check_record(const slv_ptx *ptx, uint32_t face, const uint8_t *record) {
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    slv_ptx_face f;
    if (record_is_sound(record, triangle, ptx->info.nfaces))
        return SLV_OK;
    slvi_ptx_unpack_record(record, triangle, &f);
    if (f.res.u < 0 || f.res.v < 0 || f.res.u > SLV_MAX_LOG2_RES || f.res.v > SLV_MAX_LOG2_RES)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: face %u: a resolution of 2^%d x 2^%d, where 2^0 to 2^%d is possible",
                         ptx->name, face, f.res.u, f.res.v, SLV_MAX_LOG2_RES);
    if (triangle && f.res.u != f.res.v)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: face %u: a triangle of 2^%d x 2^%d texels is not square", ptx->name,
                         face, f.res.u, f.res.v);
    unsigned edge = 0;
    if (ptx->lenient)
        return SLV_OK;
    while (edge < 3 && !is_lost(ptx, f.adjacency.face[edge]))
        edge++;
    return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                     "%s: face %u edge %u: the adjacent face is %d, but there are %u faces",
                     ptx->name, face, edge, f.adjacency.face[edge], ptx->info.nfaces);
}

const ptx_edit *slvi_ptx_find_edit(const slv_ptx *ptx, uint32_t face) {
    uint32_t low = 0, high = ptx->nedits;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (ptx->edits[middle].face == face)
            return &ptx->edits[middle];
        if (ptx->edits[middle].face < face)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

/* Reduced faces are stored finest first: a stable sort by the smaller side, constant faces last but
 * for 1x1. */
void slvi_ptx_rank_faces(const uint8_t *records, uint32_t nfaces, uint32_t *ranks) {
    uint32_t next[SLV_MAX_LOG2_RES + 1] = {0}, total = 0;
    for (uint32_t pass = 0; pass < 2; pass++) {
        const uint8_t *record = records;
        for (uint32_t face = 0; face < nfaces; face++, record += PTX_FACE_INFO_SIZE) {
            unsigned key = record[0] < record[1] ? record[0] : record[1];
            if (record[3] & SLV_FACE_CONSTANT)
                key = 1;
            if (pass)
                ranks[face] = next[key]++;
            else
                next[key]++;
        }
        for (int key = SLV_MAX_LOG2_RES; !pass && key >= 0; key--) {
            uint32_t count = next[key];
            next[key] = total;
            total += count;
        }
    }
}

static slv_result load_faces(const slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                             uint64_t *loaded) {
    ptx_tables *tables = ptx->tables;
    uint32_t nfaces = ptx->info.nfaces, *ranks = NULL;
    uint8_t *records = NULL;
    slv_result result =
        slvi_ptx_read_zip(ptx, inflater, "face table", tables->faces_position, tables->faces_zipped,
                          (uint64_t)nfaces * PTX_FACE_INFO_SIZE, &records);
    for (uint32_t face = 0; !result && face < nfaces; face++) {
        uint8_t *record = records + (size_t)face * PTX_FACE_INFO_SIZE;
        record[3] &= SLV_FACE_CONSTANT | SLV_FACE_NEIGHBOURS_CONSTANT | SLV_FACE_SUBFACE;
        result = slvi_ptx_check_record(ptx, face, record);
    }
    /* the order of reductions is that of before any edit */
    if (!result && ptx->info.nlevels > 1 && ptx->nedits &&
        !(result = slvi_alloc(&ptx->env, ptx->name, nfaces, sizeof *ranks, &ranks)))
        slvi_ptx_rank_faces(records, nfaces, ranks);
    if (result) {
        slvi_free(records);
        return result;
    }
    for (uint32_t i = 0; i < ptx->nedits; i++)
        memcpy(records + (size_t)ptx->edits[i].face * PTX_FACE_INFO_SIZE, ptx->edits[i].record,
               PTX_FACE_INFO_SIZE);
    tables->records = records;
    *loaded |= PTX_FACES;
    if (ranks) {
        tables->ranks = ranks;
        *loaded |= PTX_RANKS;
    }
    return SLV_OK;
}

static slv_result load_constants(const slv_ptx *ptx, struct libdeflate_decompressor *inflater) {
    ptx_tables *tables = ptx->tables;
    uint8_t *constants = NULL;
    slv_result result = slvi_ptx_read_zip(ptx, inflater, "constant data",
                                          tables->constants_position, tables->constants_zipped,
                                          (uint64_t)ptx->info.nfaces * ptx->pixel_size, &constants);
    if (result)
        return result;
    for (uint32_t i = 0; i < ptx->nedits; i++)
        memcpy(constants + ptx->edits[i].face * ptx->pixel_size,
               ptx->edit_values + ptx->edits[i].turn * ptx->pixel_size, ptx->pixel_size);
    if (ptx->premultiply)
        slv_ptx_premultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel, constants,
                            ptx->info.nfaces);
    tables->constants = constants;
    return SLV_OK;
}

static slv_result load_ranks(const slv_ptx *ptx) {
    uint32_t *ranks = NULL;
    slv_result result = slvi_alloc(&ptx->env, ptx->name, ptx->info.nfaces, sizeof *ranks, &ranks);
    if (result)
        return result;
    slvi_ptx_rank_faces(ptx->tables->records, ptx->info.nfaces, ranks);
    ptx->tables->ranks = ranks;
    return SLV_OK;
}

static slv_result load_level(const slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                             uint32_t index) {
    ptx_level *level = &ptx->tables->levels[index];
    uint32_t *headers = NULL;
    uint64_t *positions = NULL;
    char what[32];
    snprintf(what, sizeof what, "table of level %u", index);
    slv_result result = slvi_ptx_read_zip(ptx, inflater, what, level->position, level->zipped,
                                          (uint64_t)level->nfaces * 4, &headers);
    if (!result)
        result = slvi_alloc(&ptx->env, ptx->name, level->nfaces / PTX_POSITION_STEP + 1,
                            sizeof *positions, &positions);
    uint64_t at = level->position + level->zipped, end = level->position + level->size;
    for (uint32_t i = 0; !result && i < level->nfaces; i++) {
        uint32_t block = PTX_BLOCK_SIZE(headers[i]);
        if (i % PTX_POSITION_STEP == 0)
            positions[i / PTX_POSITION_STEP] = at;
        if (block > end - at)
            result = slvi_fail(
                &ptx->env, SLV_ERROR_FORMAT,
                "%s: level %u, block %u: %u bytes at offset %llu go beyond the level's end at %llu",
                ptx->name, index, i, block, (unsigned long long)at, (unsigned long long)end);
        at += block;
    }
    if (result) {
        slvi_free(headers);
        slvi_free(positions);
        return result;
    }
    level->headers = headers;
    level->positions = positions;
    return SLV_OK;
}

uint64_t slvi_ptx_block_position(const ptx_level *level, uint32_t index) {
    uint32_t i = index - index % PTX_POSITION_STEP;
    uint64_t at = level->positions[i / PTX_POSITION_STEP];
    for (; i < index; i++)
        at += PTX_BLOCK_SIZE(level->headers[i]);
    return at;
}

slv_result slvi_ptx_load_parts(const slv_ptx *ptx, uint64_t parts) {
    ptx_tables *tables = ptx->tables;
    slv_result result = SLV_OK;
    pthread_mutex_lock(&tables->lock);
    uint64_t loaded = atomic_load_explicit(&tables->ready, memory_order_relaxed);
    struct libdeflate_decompressor *inflater = libdeflate_alloc_decompressor();
    if (parts & tables->lost)
        result = SLV_ERROR_FORMAT; /* of which the opening has told */
    else if (!inflater)
        result = slvi_fail(&ptx->env, SLV_ERROR_MEMORY, "%s: no memory to unpack it", ptx->name);
    if (parts & PTX_RANKS)
        parts |= PTX_FACES;
    if (!result && (parts & ~loaded & PTX_FACES))
        result = load_faces(ptx, inflater, &loaded);
    if (!result && (parts & ~loaded & PTX_CONSTANTS) && !(result = load_constants(ptx, inflater)))
        loaded |= PTX_CONSTANTS;
    if (!result && (parts & ~loaded & PTX_RANKS) && !(result = load_ranks(ptx)))
        loaded |= PTX_RANKS;
    for (uint32_t i = 0; !result && i < ptx->info.nlevels; i++)
        if ((parts & ~loaded & PTX_LEVEL(i)) && !(result = load_level(ptx, inflater, i)))
            loaded |= PTX_LEVEL(i);
    libdeflate_free_decompressor(inflater);
    atomic_store_explicit(&tables->ready, loaded, memory_order_release);
    pthread_mutex_unlock(&tables->lock);
    return result;
}

slv_result slvi_ptx_salvage_tables(slv_ptx *ptx) {
    uint64_t parts[PTX_MAX_LEVELS + 2] = {PTX_CONSTANTS, PTX_RANKS};
    slv_result result = ptx_need(ptx, PTX_FACES);
    ptx_kept_line line;
    slv_env env = ptx->env;
    for (uint32_t i = 0; i < ptx->info.nlevels; i++)
        parts[2 + i] = PTX_LEVEL(i);
    for (uint32_t i = 0; i < ptx->info.nlevels + 2 && !result; i++) {
        ptx->env = slvi_ptx_keep_line(&env, &line);
        result = ptx_need(ptx, parts[i]);
        ptx->env = env;
        if (ptx_goes_on(ptx, result)) {
            ptx->tables->lost |= parts[i];
            slvi_logf(&env, SLV_LOG_WARNING, "%s; it is left out", line.text);
            result = SLV_OK;
        } else if (result) {
            slvi_fail(&env, result, "%s", line.text);
        }
    }
    return result;
}

static uint64_t all_parts(const slv_ptx *ptx) {
    uint64_t parts = PTX_FACES | PTX_CONSTANTS | (ptx->info.nlevels > 1 ? PTX_RANKS : 0);
    for (uint32_t i = 0; i < ptx->info.nlevels; i++)
        parts |= PTX_LEVEL(i);
    return parts;
}

slv_result slv_ptx_load_tables(const slv_ptx *ptx) {
    slv_result result = ptx_need(ptx, ptx->salvage ? PTX_FACES : all_parts(ptx));
    const slv_ptx_meta *meta;
    for (uint32_t i = 0; !result && i < ptx->info.nmeta; i++)
        result = slv_ptx_load_meta(ptx, i, &meta);
    return result;
}

const void *slv_ptx_get_averages(const slv_ptx *ptx) {
    return ptx_need(ptx, PTX_CONSTANTS) ? NULL : ptx->tables->constants;
}

slv_result slv_ptx_load_averages(const slv_ptx *ptx, const void **out) {
    slv_result result = ptx_need(ptx, PTX_CONSTANTS);
    *out = result ? NULL : ptx->tables->constants;
    return result;
}

static uint64_t table_bytes(const slv_ptx *ptx, uint64_t parts, bool all) {
    uint64_t nfaces = ptx->info.nfaces, edit = sizeof *ptx->edits + ptx->pixel_size;
    uint64_t bytes = sizeof *ptx + sizeof *ptx->tables + strlen(ptx->name) + 1 +
                     ptx->edit_capacity * edit + slvi_ptx_meta_bytes(ptx, all);
    if (parts & PTX_FACES)
        bytes += nfaces * PTX_FACE_INFO_SIZE;
    if (parts & PTX_CONSTANTS)
        bytes += nfaces * ptx->pixel_size;
    if (parts & PTX_RANKS)
        bytes += nfaces * sizeof *ptx->tables->ranks;
    for (uint32_t i = 0; i < ptx->info.nlevels; i++)
        if (parts & PTX_LEVEL(i))
            bytes += 4 * (uint64_t)ptx->level_faces[i] +
                     8 * (uint64_t)(ptx->level_faces[i] / PTX_POSITION_STEP + 1);
    return bytes;
}

uint64_t slv_ptx_table_bytes(const slv_ptx *ptx) {
    return table_bytes(ptx, atomic_load_explicit(&ptx->tables->ready, memory_order_acquire), false);
}

uint64_t slv_ptx_full_table_bytes(const slv_ptx *ptx) {
    return table_bytes(ptx, all_parts(ptx), true);
}

slv_result slvi_ptx_read_levels(slv_ptx *ptx, const uint8_t *header, uint64_t position) {
    uint8_t records[PTX_MAX_LEVELS * PTX_LEVEL_INFO_SIZE];
    uint32_t nlevels = ptx->info.nlevels, nfaces = ptx->info.nfaces;
    ptx_tables *tables = ptx->tables;
    tables->faces_position = position;
    tables->faces_zipped = ptx_get_u32(header + 32);
    tables->constants_position = position + tables->faces_zipped;
    tables->constants_zipped = ptx_get_u32(header + 36);
    struct {
        const char *what;
        uint64_t position, zipped, size;
    } parts[2] = {{"face table", tables->faces_position, tables->faces_zipped,
                   (uint64_t)nfaces * PTX_FACE_INFO_SIZE},
                  {"constant data", tables->constants_position, tables->constants_zipped,
                   (uint64_t)nfaces * ptx->pixel_size}};
    for (size_t i = 0; i < 2; i++) {
        uint64_t end = ptx->source.size;
        if (parts[i].position > end || parts[i].zipped > end - parts[i].position)
            return slvi_ptx_read_bytes(&ptx->env, ptx, parts[i].what, parts[i].position,
                                       parts[i].zipped, NULL);
        if (!slvi_ptx_zip_is_plausible(parts[i].zipped, parts[i].size))
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: the %s at offset %llu claims %llu bytes packed into %llu",
                             ptx->name, parts[i].what, (unsigned long long)parts[i].position,
                             (unsigned long long)parts[i].size,
                             (unsigned long long)parts[i].zipped);
    }
    uint64_t list = tables->constants_position + tables->constants_zipped;
    slv_result result = slvi_ptx_read_bytes(&ptx->env, ptx, "level list", list,
                                            (uint64_t)nlevels * PTX_LEVEL_INFO_SIZE, records);
    if (result)
        return result;
    uint64_t size = ptx_get_u64(header + 48);
    position = list + (uint64_t)nlevels * PTX_LEVEL_INFO_SIZE;
    bool whole = position <= ptx->source.size && size <= ptx->source.size - position;
    /* of a file that is cut short, what is there can be read */
    if (!whole && (!ptx->salvage || size > INT64_MAX - position))
        return slvi_ptx_read_bytes(&ptx->env, ptx, "level data", position, size, NULL);
    uint64_t end = position + size;
    for (uint32_t i = 0; i < nlevels; i++) {
        const uint8_t *record = records + (size_t)i * PTX_LEVEL_INFO_SIZE;
        ptx_level *level = &tables->levels[i];
        level->position = position;
        level->size = ptx_get_u64(record);
        level->zipped = ptx_get_u32(record + 8);
        level->nfaces = ptx_get_u32(record + 12);
        if (i == 0 ? level->nfaces != nfaces : level->nfaces > nfaces)
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: level %u has %u faces, the file has %u", ptx->name, i,
                             level->nfaces, nfaces);
        if (level->size > end - position || level->zipped > level->size)
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: level %u: %llu bytes with a table of %u at offset %llu, but the "
                             "levels end at %llu",
                             ptx->name, i, (unsigned long long)level->size, level->zipped,
                             (unsigned long long)position, (unsigned long long)end);
        ptx->level_faces[i] = level->nfaces;
        ptx->level_bytes[i] = level->size;
        position += level->size;
    }
    return SLV_OK;
}
