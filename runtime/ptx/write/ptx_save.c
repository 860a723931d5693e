/* Whole files at once: from a store, and from another file. */
#include "ptx/write/ptx_write.h"

struct save {
    const slv_env *env;
    const slv_texture *texture;
    slv_ptx_writer *writer;
    ptx_errors errors;
};

static slv_result save_faces(void *user, uint64_t first, uint64_t end) {
    struct save *save = user;
    ptx_range_log log;
    slv_env env = slvi_ptx_range_env(save->env, &save->errors, first, &log);
    const slv_texture_desc *desc = slv_texture_get_desc(save->texture);
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        uint32_t face = (uint32_t)i;
        slv_ptx_face info = {
            .res = desc->res[face],
            .flags = slv_texture_is_constant(save->texture, face) ? SLV_FACE_CONSTANT : 0,
            .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
        result = slvi_ptx_writer_put(save->writer, &env, face, &info,
                                     slv_texture_texels(save->texture, face));
        if (!result)
            result = slvi_steps_add(&save->writer->steps, &env, save->writer->path, 1);
    }
    return result;
}

static bool is_geometry(const char *key) {
    return key && (!strcmp(key, "PtexFaceVertCounts") || !strcmp(key, "PtexFaceVertIndices") ||
                   !strcmp(key, "PtexVertPositions"));
}

static slv_result save_encoding(const struct save *save, const slv_ptx_write_params *params) {
    const slv_texture_desc *desc = slv_texture_get_desc(save->texture);
    const char *name = slv_texture_encoding_name(desc->encoding);
    const slv_ptx_meta meta = {.key = SLV_PTX_ENCODING_KEY,
                               .type = SLV_META_STRING,
                               .count = (uint32_t)strlen(name),
                               .values = name};
    bool follows =
        desc->encoding == SLV_TEXTURE_AUTO || desc->encoding == slv_type_encoding(desc->type) ||
        (desc->encoding == SLV_TEXTURE_DATA && params->edge_filter == SLV_EDGE_FILTER_TANVEC);
    return follows ? SLV_OK : slv_ptx_writer_set_meta(save->writer, &meta);
}

static slv_result save_rest(const struct save *save, const slv_adjacency *adjacency,
                            const slv_ptx_write_params *params) {
    slv_result result = save_encoding(save, params);
    if (!result && adjacency)
        result = slv_ptx_writer_set_adjacency(save->writer, adjacency);
    if (!result && params->mesh)
        result = slvi_ptx_writer_set_geometry(save->writer, params->mesh);
    for (uint32_t i = 0; !result && i < params->nmeta; i++)
        if (!params->mesh || !is_geometry(params->meta[i].key))
            result = slv_ptx_writer_set_meta(save->writer, &params->meta[i]);
    return result;
}

slv_result slv_ptx_save(const slv_env *env, const char *path, const slv_texture *texture,
                        const slv_adjacency *adjacency, const slv_ptx_write_params *params) {
    static const slv_ptx_write_params defaults = {0};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    struct save save = {.env = env, .texture = texture};
    params = params ? params : &defaults;
    slv_ptx_writer_params own = {.mesh_type = SLV_PTX_QUAD,
                                 .type = desc->type,
                                 .nchannels = desc->nchannels,
                                 .alpha_channel = desc->alpha_channel,
                                 .nfaces = desc->nfaces,
                                 .border_u = params->border_u,
                                 .border_v = params->border_v,
                                 .edge_filter = params->edge_filter,
                                 .no_reductions = params->no_reductions,
                                 .compression = params->compression,
                                 .progress = params->progress,
                                 .output = params->output,
                                 .seams = params->seams};
    slv_result result = slv_ptx_writer_create(env, path, &own, &save.writer);
    if (result)
        return result;
    save.writer->steps.total *= 2;
    uint64_t grain = desc->nfaces / (slv_texture_bytes(texture) / (1 << 20) + 1) + 1;
    if (!(result = save_rest(&save, adjacency, params)) &&
        !(result =
              slvi_ptx_parallel_for(env, &save.errors, desc->nfaces, grain, save_faces, &save)))
        result = slv_ptx_writer_finish(save.writer);
    slv_ptx_writer_destroy(save.writer);
    return result;
}

static slv_result copy_face(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                            void *texels) {
    slv_ptx_writer *writer = user;
    slv_result result = slvi_ptx_writer_put(writer, env, face, info, texels);
    return result ? result : slvi_steps_add(&writer->steps, env, writer->path, 1);
}

slv_result slvi_ptx_copy(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                         const char *path, const slv_ptx_writer_params *params) {
    slv_ptx_writer *writer = NULL;
    /* reductions are made anew: those of the file may be damaged */
    slv_result result = ptx_need(ptx, PTX_FACES);
    if (result)
        return result;
    slv_ptx_writer_params own = slv_ptx_writer_params_like(ptx);
    if (params) {
        own.no_reductions |= params->no_reductions;
        own.compression = params->compression;
        own.sync = params->sync;
        own.memory = params->memory;
        own.progress = params->progress;
        own.output = params->output;
        own.seams = params->seams;
    }
    if ((result = slv_ptx_writer_create(env, path, &own, &writer)))
        return result;
    writer->steps.total *= 2;
    for (uint32_t i = 0; !result && i < ptx->info.nmeta; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(ptx, i, &meta)))
            result = slv_ptx_writer_set_meta(writer, meta);
    }
    if (!result && mesh)
        result = slv_ptx_writer_set_mesh(writer, mesh);
    if (!result && !(result = slv_ptx_visit_faces(env, ptx, copy_face, writer)))
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

slv_result slv_ptx_rewrite(const slv_env *env, const slv_ptx *ptx, const char *path,
                           const slv_ptx_writer_params *params) {
    return slvi_ptx_copy(env, ptx, NULL, path, params);
}
