/* Writing a texture as a new file. */
#include "base/file.h"
#include "ptx/ptx_reduce.h"
#include "ptx/ptx_write.h"

#include <stdlib.h>

#define MAX_STORED_LEVELS (SLV_MAX_LOG2_RES + 1)
#define DEFAULT_COMPRESSION 6

struct save {
    const slv_env *env;
    const char *path;
    const slv_texture *texture;
    const slv_texture_desc *desc;
    const slv_ptx_write_params *params;
    int compression;
    size_t pixel_size;
    slv_ptx_face *faces;
    uint8_t *constants;
    uint32_t *ranks, *order; /* face to place in reduction order, and back */
    uint32_t nlevels, level_faces[MAX_STORED_LEVELS];
    uint32_t *headers[MAX_STORED_LEVELS];
    uint8_t **blocks;  /* each face's blocks of all levels, one after the other */
    uint64_t *cursors; /* how far they are written */
    ptx_errors errors;
};

/* Packs a face's texels and reductions, and finds its average. */
static slv_result pack_face(struct save *save, ptx_packer *packer, uint32_t face) {
    const slv_texture_desc *desc = save->desc;
    slv_res res = desc->res[face];
    const void *texels = slv_texture_texels(save->texture, face);
    uint8_t *average = save->constants + face * save->pixel_size;
    bool premultiply = desc->alpha_channel >= 0;
    uint32_t rank = save->ranks[face];
    slv_result result;
    if (slv_texture_is_constant(save->texture, face)) {
        memcpy(average, texels, save->pixel_size);
        return SLV_OK;
    }
    packer->out.size = packer->work.size = 0;
    if ((result = ptx_pack(packer, face, texels, res, &save->headers[0][face])))
        return result;
    uint64_t count = ptx_texel_count(res);
    bool reduce = save->nlevels > 1 && rank < save->level_faces[1];
    if (premultiply || reduce) {
        uint64_t room = (premultiply ? count : count / 4) * save->pixel_size;
        if ((result = ptx_bytes_reserve(packer->env, packer->path, &packer->work, room)))
            return result;
    }
    if (premultiply) {
        memcpy(packer->work.data, texels, (size_t)count * save->pixel_size);
        texels = packer->work.data;
        ptx_premultiply(desc->type, desc->nchannels, desc->alpha_channel, packer->work.data, count);
    }
    for (uint32_t level = 1; level < save->nlevels && rank < save->level_faces[level]; level++) {
        ptx_halve_both(desc->type, desc->nchannels, res, texels, packer->work.data);
        texels = packer->work.data;
        res = (slv_res){(int8_t)(res.u - 1), (int8_t)(res.v - 1)};
        if ((result = ptx_pack(packer, face, texels, res, &save->headers[level][rank])))
            return result;
    }
    ptx_average(desc->type, desc->nchannels, texels, ptx_texel_count(res), average);
    ptx_unmultiply(desc->type, desc->nchannels, desc->alpha_channel, average, 1);
    result = slv_alloc(packer->env, packer->path, packer->out.size, 1, &save->blocks[face]);
    if (!result)
        memcpy(save->blocks[face], packer->out.data, (size_t)packer->out.size);
    return result;
}

static slv_result pack_faces(void *user, uint64_t first, uint64_t end) {
    struct save *save = user;
    ptx_range_log log;
    slv_env env = ptx_range_env(save->env, &save->errors, first, &log);
    ptx_packer packer = {.env = &env,
                         .path = save->path,
                         .deflater = libdeflate_alloc_compressor(save->compression),
                         .type = save->desc->type,
                         .nchannels = save->desc->nchannels,
                         .pixel_size = save->pixel_size};
    slv_result result = SLV_OK;
    if (!packer.deflater)
        result = slv_fail(&env, SLV_ERROR_MEMORY, "%s: no memory to pack it", save->path);
    for (uint64_t face = first; face < end && !result; face++)
        result = pack_face(save, &packer, (uint32_t)face);
    ptx_packer_free(&packer);
    return result;
}

static slv_result plan(struct save *save, const slv_adjacency *adjacency) {
    const slv_env *env = save->env;
    const slv_texture_desc *desc = save->desc;
    uint32_t nfaces = desc->nfaces;
    slv_result result;
    if ((result = slv_alloc(env, save->path, nfaces, sizeof *save->faces, &save->faces)) ||
        (result = slv_alloc(env, save->path, nfaces, save->pixel_size, &save->constants)) ||
        (result = slv_alloc(env, save->path, nfaces, sizeof *save->ranks, &save->ranks)) ||
        (result = slv_alloc(env, save->path, nfaces, sizeof *save->order, &save->order)) ||
        (result = slv_alloc(env, save->path, nfaces, sizeof *save->blocks, &save->blocks)) ||
        (result = slv_alloc(env, save->path, nfaces, sizeof *save->cursors, &save->cursors)))
        return result;
    save->nlevels = 1;
    save->level_faces[0] = nfaces;
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face *f = &save->faces[face];
        f->res = desc->res[face];
        if (slv_texture_is_constant(save->texture, face))
            f->flags |= SLV_FACE_CONSTANT;
        if (adjacency) {
            f->adjacency = slv_adjacency_faces(adjacency)[face];
            if (slv_adjacency_is_subface(adjacency, (int32_t)face))
                f->flags |= SLV_FACE_SUBFACE;
        } else
            for (unsigned edge = 0; edge < 4; edge++)
                f->adjacency.face[edge] = SLV_BOUNDARY;
        if (save->params->no_reductions || (f->flags & SLV_FACE_CONSTANT))
            continue;
        for (int level = 1; level + 1 < ptx_min_log2(f->res); level++) {
            save->level_faces[level]++;
            if ((uint32_t)level >= save->nlevels)
                save->nlevels = (uint32_t)level + 1;
        }
    }
    ptx_rank_faces(save->faces, nfaces, save->ranks);
    for (uint32_t face = 0; face < nfaces; face++)
        save->order[save->ranks[face]] = face;
    for (uint32_t level = 0; level < save->nlevels; level++)
        if ((result = slv_alloc(env, save->path, save->level_faces[level], sizeof(uint32_t),
                                &save->headers[level])))
            return result;
    return SLV_OK;
}

static slv_result zip_faces(const struct save *save, struct libdeflate_compressor *deflater,
                            ptx_bytes *out, uint32_t *zipped) {
    uint8_t *records = NULL;
    uint32_t nfaces = save->desc->nfaces;
    slv_result result = slv_alloc(save->env, save->path, nfaces, PTX_FACE_INFO_SIZE, &records);
    if (result)
        return result;
    for (uint32_t face = 0; face < nfaces; face++) {
        const slv_ptx_face *f = &save->faces[face];
        uint8_t *record = records + (size_t)face * PTX_FACE_INFO_SIZE;
        record[0] = (uint8_t)f->res.u;
        record[1] = (uint8_t)f->res.v;
        record[3] = f->flags;
        for (unsigned edge = 0; edge < 4; edge++) {
            record[2] |= (uint8_t)((f->adjacency.edge[edge] & 3) << (2 * edge));
            ptx_put_u32(record + 4 + 4 * edge, (uint32_t)f->adjacency.face[edge]);
        }
    }
    result = ptx_bytes_append_zip(save->env, save->path, deflater, out, records,
                                  (uint64_t)nfaces * PTX_FACE_INFO_SIZE, UINT32_MAX, zipped);
    free(records);
    return result;
}

/* The tables of all levels, one after the other, and the list that says how long each level is. */
static slv_result zip_levels(const struct save *save, struct libdeflate_compressor *deflater,
                             ptx_bytes *tables, uint32_t *table_sizes, uint8_t *list,
                             uint64_t *total) {
    *total = 0;
    for (uint32_t level = 0; level < save->nlevels; level++) {
        uint32_t count = save->level_faces[level];
        slv_result result =
            ptx_bytes_append_zip(save->env, save->path, deflater, tables, save->headers[level],
                                 (uint64_t)count * 4, UINT32_MAX, &table_sizes[level]);
        if (result)
            return result;
        uint64_t size = table_sizes[level];
        for (uint32_t i = 0; i < count; i++)
            size += PTX_BLOCK_SIZE(save->headers[level][i]);
        ptx_put_u64(list + level * PTX_LEVEL_INFO_SIZE, size);
        ptx_put_u32(list + level * PTX_LEVEL_INFO_SIZE + 8, table_sizes[level]);
        ptx_put_u32(list + level * PTX_LEVEL_INFO_SIZE + 12, count);
        *total += size;
    }
    return SLV_OK;
}

static slv_result write_level(struct save *save, slv_file_writer *writer, uint32_t level) {
    for (uint32_t i = 0; i < save->level_faces[level]; i++) {
        uint32_t face = level ? save->order[i] : i, size = PTX_BLOCK_SIZE(save->headers[level][i]);
        if (!size)
            continue;
        slv_result result = slv_file_writer_write(save->env, writer,
                                                  save->blocks[face] + save->cursors[face], size);
        if (result)
            return result;
        save->cursors[face] += size;
    }
    return SLV_OK;
}

static slv_result write_file(struct save *save) {
    uint8_t header[PTX_HEADER_SIZE + PTX_EXTENDED_HEADER_SIZE] = {0};
    uint8_t *extended = header + PTX_HEADER_SIZE, list[MAX_STORED_LEVELS * PTX_LEVEL_INFO_SIZE];
    uint32_t faces_zipped = 0, constants_zipped = 0, table_sizes[MAX_STORED_LEVELS];
    uint64_t level_bytes = 0, written_tables = 0;
    const slv_texture_desc *desc = save->desc;
    const slv_ptx_write_params *params = save->params;
    const slv_env *env = save->env;
    ptx_bytes faces = {0}, tables = {0};
    ptx_meta_out meta = {0};
    slv_file_writer writer = {0};
    slv_result result = SLV_OK;
    struct libdeflate_compressor *deflater = libdeflate_alloc_compressor(save->compression);
    if (!deflater) {
        result = slv_fail(env, SLV_ERROR_MEMORY, "%s: no memory to pack it", save->path);
        goto done;
    }
    if ((result = zip_faces(save, deflater, &faces, &faces_zipped)) ||
        (result = ptx_bytes_append_zip(env, save->path, deflater, &faces, save->constants,
                                       (uint64_t)desc->nfaces * save->pixel_size, UINT32_MAX,
                                       &constants_zipped)) ||
        (result = zip_levels(save, deflater, &tables, table_sizes, list, &level_bytes)) ||
        (result = ptx_meta_pack(env, save->path, deflater, params, &meta)))
        goto done;
    uint32_t list_size = save->nlevels * PTX_LEVEL_INFO_SIZE;
    memcpy(header, "Ptex", 4);
    ptx_put_u32(header + 4, 1);
    ptx_put_u32(header + 8, SLV_PTX_QUAD);
    ptx_put_u32(header + 12, desc->type);
    ptx_put_u32(header + 16, (uint32_t)desc->alpha_channel);
    ptx_put_u16(header + 20, desc->nchannels);
    ptx_put_u16(header + 22, save->nlevels);
    ptx_put_u32(header + 24, desc->nfaces);
    ptx_put_u32(header + 28, PTX_EXTENDED_HEADER_SIZE);
    ptx_put_u32(header + 32, faces_zipped);
    ptx_put_u32(header + 36, constants_zipped);
    ptx_put_u32(header + 40, list_size);
    ptx_put_u32(header + 44, 4);
    ptx_put_u64(header + 48, level_bytes);
    ptx_put_u32(header + 56, meta.small_zipped);
    ptx_put_u32(header + 60, meta.small_size);
    ptx_put_u16(extended, params->border_u);
    ptx_put_u16(extended + 4, params->border_v);
    ptx_put_u16(extended + 6, params->edge_filter);
    ptx_put_u32(extended + 8, meta.large_zipped);
    ptx_put_u32(extended + 12, meta.large_size);
    ptx_put_u64(extended + 16, meta.large_data);
    ptx_put_u64(extended + 32,
                sizeof header + faces.size + list_size + level_bytes + meta.bytes.size);
    if ((result = slv_file_writer_open(env, save->path, &writer)) ||
        (result = slv_file_writer_write(env, &writer, header, sizeof header)) ||
        (result = slv_file_writer_write(env, &writer, faces.data, (size_t)faces.size)) ||
        (result = slv_file_writer_write(env, &writer, list, list_size)))
        goto done;
    for (uint32_t level = 0; level < save->nlevels; level++) {
        if ((result = slv_file_writer_write(env, &writer, tables.data + written_tables,
                                            table_sizes[level])) ||
            (result = write_level(save, &writer, level)))
            goto done;
        written_tables += table_sizes[level];
    }
    if (!(result = slv_file_writer_write(env, &writer, meta.bytes.data, (size_t)meta.bytes.size)))
        result = slv_file_writer_commit(env, &writer);
done:
    slv_file_writer_abandon(&writer);
    libdeflate_free_compressor(deflater);
    free(faces.data);
    free(tables.data);
    free(meta.bytes.data);
    return result;
}

static slv_result check(const struct save *save, const slv_adjacency *adjacency) {
    const slv_texture_desc *desc = save->desc;
    const slv_ptx_write_params *params = save->params;
    if (adjacency && slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slv_fail(save->env, SLV_ERROR_MISMATCH,
                        "%s: the texture has %u faces, the adjacency %u", save->path, desc->nfaces,
                        slv_adjacency_face_count(adjacency));
    if (params->mesh && slv_mesh_face_count(params->mesh) != desc->nfaces)
        return slv_fail(save->env, SLV_ERROR_MISMATCH, "%s: the texture has %u faces, the mesh %u",
                        save->path, desc->nfaces, slv_mesh_face_count(params->mesh));
    if (params->compression < 0 || params->compression > 12)
        return slv_fail(save->env, SLV_ERROR_ARGUMENT, "%s: compression is 1 to 12, not %d",
                        save->path, params->compression);
    if ((unsigned)params->border_u > SLV_BORDER_PERIODIC ||
        (unsigned)params->border_v > SLV_BORDER_PERIODIC ||
        (unsigned)params->edge_filter > SLV_EDGE_FILTER_TANVEC)
        return slv_fail(save->env, SLV_ERROR_ARGUMENT, "%s: unknown border mode or edge filter",
                        save->path);
    return SLV_OK;
}

slv_result slv_ptx_save(const slv_env *env, const char *path, const slv_texture *texture,
                        const slv_adjacency *adjacency, const slv_ptx_write_params *params) {
    static const slv_ptx_write_params defaults = {0};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    struct save save = {.env = env,
                        .path = path,
                        .texture = texture,
                        .desc = desc,
                        .params = params ? params : &defaults,
                        .pixel_size = desc->nchannels * slv_type_size(desc->type)};
    slv_result result = check(&save, adjacency);
    save.compression = save.params->compression ? save.params->compression : DEFAULT_COMPRESSION;
    if (result || (result = plan(&save, adjacency)))
        goto done;
    uint64_t grain = desc->nfaces / (slv_texture_bytes(texture) / (1 << 20) + 1) + 1;
    if ((result = ptx_parallel_for(env, &save.errors, desc->nfaces, grain, pack_faces, &save)))
        goto done;
    ptx_flag_neighbourhoods(save.faces, desc->nfaces, save.constants, save.pixel_size,
                            save.params->border_u == SLV_BORDER_CLAMP &&
                                save.params->border_v == SLV_BORDER_CLAMP);
    result = write_file(&save);
done:
    for (uint32_t face = 0; save.blocks && face < desc->nfaces; face++)
        free(save.blocks[face]);
    for (uint32_t level = 0; level < MAX_STORED_LEVELS; level++)
        free(save.headers[level]);
    free(save.faces);
    free(save.constants);
    free(save.ranks);
    free(save.order);
    free(save.blocks);
    free(save.cursors);
    return result;
}
