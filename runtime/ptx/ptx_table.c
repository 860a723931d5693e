/* The face table, the constant values and the level tables. */
#include "ptx/ptx_file.h"

#include <stdio.h>
#include <stdlib.h>

slv_result ptx_parse_face(slv_ptx *ptx, uint32_t face, const uint8_t *record, slv_ptx_face *out) {
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    memset(out, 0, sizeof *out);
    out->res = (slv_res){(int8_t)record[0], (int8_t)record[1]};
    out->flags = record[3] & (SLV_FACE_CONSTANT | SLV_FACE_NEIGHBOURS_CONSTANT | SLV_FACE_SUBFACE);
    if (out->res.u < 0 || out->res.v < 0 || out->res.u > SLV_MAX_LOG2_RES ||
        out->res.v > SLV_MAX_LOG2_RES)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: face %u: a resolution of 2^%d x 2^%d, where 2^0 to 2^%d is possible",
                        ptx->name, face, out->res.u, out->res.v, SLV_MAX_LOG2_RES);
    if (triangle && out->res.u != out->res.v)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: face %u: a triangle of 2^%d x 2^%d texels is not square", ptx->name,
                        face, out->res.u, out->res.v);
    for (unsigned edge = 0; edge < 4; edge++) {
        int32_t adjacent = (int32_t)ptx_get_u32(record + 4 + 4 * edge);
        if (triangle && edge == 3)
            adjacent = SLV_BOUNDARY;
        if (adjacent < SLV_BOUNDARY || (adjacent >= 0 && (uint32_t)adjacent >= ptx->info.nfaces))
            return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                            "%s: face %u edge %u: the adjacent face is %d, but there are %u faces",
                            ptx->name, face, edge, adjacent, ptx->info.nfaces);
        out->adjacency.face[edge] = adjacent;
        out->adjacency.edge[edge] = triangle && edge == 3 ? 0 : record[2] >> (2 * edge) & 3;
    }
    return SLV_OK;
}

static slv_result read_faces(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                             uint64_t position, uint64_t zipped) {
    uint8_t *records = NULL;
    uint32_t nfaces = ptx->info.nfaces;
    slv_result result = ptx_read_zip(ptx, inflater, "face table", position, zipped,
                                     (uint64_t)nfaces * PTX_FACE_INFO_SIZE, &records);
    if (!result)
        result = slv_alloc(&ptx->env, ptx->name, nfaces, sizeof *ptx->faces, &ptx->faces);
    for (uint32_t face = 0; !result && face < nfaces; face++)
        result = ptx_parse_face(ptx, face, records + (size_t)face * PTX_FACE_INFO_SIZE,
                                &ptx->faces[face]);
    free(records);
    return result;
}

static slv_result read_level(slv_ptx *ptx, struct libdeflate_decompressor *inflater, uint32_t index,
                             uint64_t position, uint64_t size, uint32_t zipped) {
    ptx_level *level = &ptx->levels[index];
    char what[32];
    snprintf(what, sizeof what, "table of level %u", index);
    slv_result result = ptx_read_zip(ptx, inflater, what, position, zipped,
                                     (uint64_t)level->nfaces * 4, &level->headers);
    if (!result)
        result = slv_alloc(&ptx->env, ptx->name, level->nfaces, sizeof *level->positions,
                           &level->positions);
    if (result)
        return result;
    uint64_t at = position + zipped, end = position + size;
    for (uint32_t i = 0; i < level->nfaces; i++) {
        uint32_t block = PTX_BLOCK_SIZE(level->headers[i]);
        level->positions[i] = at;
        if (block > end - at)
            return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                            "%s: level %u, block %u: %u bytes at offset %llu go beyond the level's "
                            "end at %llu",
                            ptx->name, index, i, block, (unsigned long long)at,
                            (unsigned long long)end);
        at += block;
    }
    return SLV_OK;
}

static slv_result read_levels(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                              uint64_t info_position, uint64_t position, uint64_t size) {
    uint8_t records[PTX_MAX_LEVELS * PTX_LEVEL_INFO_SIZE];
    uint32_t nlevels = ptx->info.nlevels, nfaces = ptx->info.nfaces;
    uint64_t end = position + size;
    slv_result result = ptx_read_bytes(&ptx->env, ptx, "level list", info_position,
                                       (uint64_t)nlevels * PTX_LEVEL_INFO_SIZE, records);
    if (result)
        return result;
    if (position > ptx->source.size || size > ptx->source.size - position)
        return ptx_read_bytes(&ptx->env, ptx, "level data", position, size, NULL);
    if ((result = slv_alloc(&ptx->env, ptx->name, nlevels, sizeof *ptx->levels, &ptx->levels)) ||
        (result =
             slv_alloc(&ptx->env, ptx->name, nlevels, sizeof *ptx->level_faces, &ptx->level_faces)))
        return result;
    ptx->info.level_faces = ptx->level_faces;
    for (uint32_t i = 0; i < nlevels; i++) {
        const uint8_t *record = records + (size_t)i * PTX_LEVEL_INFO_SIZE;
        uint64_t level_size = ptx_get_u64(record);
        uint32_t zipped = ptx_get_u32(record + 8), count = ptx_get_u32(record + 12);
        if (i == 0 ? count != nfaces : count > nfaces)
            return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                            "%s: level %u has %u faces, the file has %u", ptx->name, i, count,
                            nfaces);
        if (level_size > end - position || zipped > level_size)
            return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                            "%s: level %u: %llu bytes with a table of %u at offset %llu, but the "
                            "levels end at %llu",
                            ptx->name, i, (unsigned long long)level_size, zipped,
                            (unsigned long long)position, (unsigned long long)end);
        ptx->levels[i].nfaces = ptx->level_faces[i] = count;
        if ((result = read_level(ptx, inflater, i, position, level_size, zipped)))
            return result;
        position += level_size;
    }
    return SLV_OK;
}

/* Reduced faces are stored finest first: a stable sort by the smaller side, constant faces last but
 * for 1x1. */
void ptx_rank_faces(const slv_ptx_face *faces, uint32_t nfaces, uint32_t *ranks) {
    uint32_t next[SLV_MAX_LOG2_RES + 1] = {0}, total = 0;
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t face = 0; face < nfaces; face++) {
            const slv_ptx_face *f = &faces[face];
            int key = f->flags & SLV_FACE_CONSTANT ? 1 : ptx_min_log2(f->res);
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

slv_result ptx_read_tables(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                           const uint8_t *header, uint64_t position) {
    uint32_t faces_zipped = ptx_get_u32(header + 32), constants_zipped = ptx_get_u32(header + 36);
    uint64_t constants_position = position + faces_zipped;
    uint64_t list_position = constants_position + constants_zipped;
    uint64_t levels_position = list_position + ptx_get_u32(header + 40);
    slv_result result;
    if ((result = read_faces(ptx, inflater, position, faces_zipped)) ||
        (result = ptx_read_zip(ptx, inflater, "constant data", constants_position, constants_zipped,
                               (uint64_t)ptx->info.nfaces * ptx->pixel_size, &ptx->constants)) ||
        (result =
             read_levels(ptx, inflater, list_position, levels_position, ptx_get_u64(header + 48))))
        return result;
    if (ptx->info.nlevels == 1)
        return SLV_OK;
    result = slv_alloc(&ptx->env, ptx->name, ptx->info.nfaces, sizeof *ptx->ranks, &ptx->ranks);
    if (!result)
        ptx_rank_faces(ptx->faces, ptx->info.nfaces, ptx->ranks);
    return result;
}
