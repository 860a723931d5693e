/* From a source to a .ptx: block after block of faces, so that no more than a block is in memory.
 */
#include "recipe/bake_data.h"
#include "recipe/plan.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

#define DEFAULT_MEMORY (UINT64_C(64) << 20)

static slv_result bake_blocks(bake *b) {
    uint32_t first, end;
    slv_result result = SLV_OK;
    while (!result && slvi_bake_next_block(b, &first, &end)) {
        if ((result = slvi_bake_begin_block(b, first, end)) ||
            (result = slvi_bake_evaluate_block(b)) || (result = slvi_bake_part_keep(b)))
            break;
        result = slvi_bake_write_block(b);
    }
    return result;
}

/* ---- the file ---- */

static slv_result note_encoding(slv_ptx_writer *writer, slv_type type,
                                slv_texture_encoding encoding) {
    if (encoding == slv_type_encoding(type))
        return SLV_OK;
    const char *name = slv_texture_encoding_name(encoding);
    const slv_ptx_meta meta = {SLV_PTX_ENCODING_KEY, SLV_META_STRING, (uint32_t)strlen(name), name};
    return slv_ptx_writer_set_meta(writer, &meta);
}

static slv_ptx_seams seams_of(const bake *b) {
    if (b->job->seams_given)
        return b->job->seams;
    if (b->source->apart)
        return SLV_PTX_SEAMS_PLAIN;
    return b->job->max_error > 0 || b->job->least_error ? SLV_PTX_SEAMS_REDUCTIONS
                                                        : SLV_PTX_SEAMS_ALL;
}

static slv_result begin_file(bake *b, const char *path, slv_ptx_writer_params params,
                             slv_texture_encoding encoding, slv_ptx_writer **out) {
    params.mesh_type = SLV_PTX_QUAD;
    params.nfaces = b->source->nfaces;
    params.no_reductions = b->job->no_reductions;
    params.compression = b->job->compression;
    params.seams = out == &b->writer ? seams_of(b) : SLV_PTX_SEAMS_PLAIN;
    params.memory = b->job->memory ? b->job->memory : DEFAULT_MEMORY;
    slv_result result = slv_ptx_writer_create(&b->env, path, &params, out);
    if (!result && !(result = slv_ptx_writer_set_mesh(*out, b->mesh)))
        result = note_encoding(*out, params.type, encoding);
    return result;
}

/* The writer's own progress behind that of the texels: an eighth as long. */
static bool report_writing(void *user, uint64_t done, uint64_t total) {
    const bake *b = user;
    uint64_t more = b->total / 8 + 1;
    uint64_t so_far = total ? (uint64_t)((double)more * (double)done / (double)total) : more;
    return !b->job->progress.report ||
           b->job->progress.report(b->job->progress.user,
                                   b->total + (so_far < more ? so_far : more), b->total + more);
}

static bool report_texels(void *user, uint64_t done, uint64_t total) {
    const bake *b = user;
    (void)total;
    return b->job->progress.report(b->job->progress.user, done, b->total + b->total / 8 + 1);
}

static slv_result open_files(bake *b, const char *path) {
    const slv_bake_source_desc *desc = &b->source->desc;
    slv_ptx_writer_params params = {.type = b->report->type,
                                    .nchannels = desc->nchannels,
                                    .alpha_channel = desc->alpha_channel,
                                    .progress = {report_writing, b}};
    slv_result result = begin_file(b, path, params, b->report->encoding, &b->writer);
    if (result || !b->job->miss_map)
        return result;
    for (int i = 0; i < SLV_BAKE_MISSES; i++) {
        float rgb[BAKE_MAP_CHANNELS];
        slv_bake_miss_color((slv_bake_miss)i, rgb);
        slv_type_from_float(SLV_TYPE_U8, rgb, BAKE_MAP_CHANNELS, b->map_colors[i]);
    }
    params = (slv_ptx_writer_params){.nchannels = BAKE_MAP_CHANNELS, .alpha_channel = SLV_NO_ALPHA};
    return begin_file(b, b->job->miss_map, params, SLV_TEXTURE_SRGB, &b->map);
}

static bool in_team(const slv_bake_job *job) {
    return job->team && job->team->count > 1;
}

static slv_result run(bake *b, const char *path) {
    slv_progress texels = {b->job->progress.report ? report_texels : NULL, b};
    if (in_team(b->job) && b->job->team->rank)
        return slvi_bake_serve(b);
    slv_result result = open_files(b, path);
    slvi_steps_begin(&b->steps, texels, b->total);
    pthread_mutex_init(&b->lock, NULL);
    result = result ? result : slvi_bake_part_open(b);
    if (in_team(b->job))
        result = slvi_bake_lead(b, result);
    else if (!result)
        result = bake_blocks(b);
    pthread_mutex_destroy(&b->lock);
    slvi_steps_end(&b->steps);
    if (!result && b->map)
        result = slv_ptx_writer_finish(b->map);
    if (!result && !(result = slv_ptx_writer_finish(b->writer)))
        slvi_bake_part_remove(b);
    return result;
}

/* Rank 0 finds the resolutions, and the others are told. */
static slv_result plan(bake *b, const slv_env *env, slv_res **res) {
    slv_result result = SLV_OK;
    if (!in_team(b->job) || !b->job->team->rank)
        result = slvi_bake_plan(env, b->mesh, b->source, b->job, &b->encoder, res, b->report);
    else
        result = slvi_alloc(env, "resolutions", b->source->nfaces, sizeof **res, res);
    if (in_team(b->job))
        result = slvi_bake_share_plan(env, b->job, *res, b->source->nfaces, result);
    return result;
}

static slv_result check(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                        const slv_bake_job *job) {
    if (slv_mesh_face_count(mesh) != source->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "bake: the mesh has %u faces, the source %u",
                         slv_mesh_face_count(mesh), source->nfaces);
    if (job->type_given && (unsigned)job->type > SLV_TYPE_FLOAT)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: unknown data type %d", (int)job->type);
    if ((job->max_error > 0 || job->least_error) && job->seams_given &&
        job->seams == SLV_PTX_SEAMS_ALL)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: errors are those of full resolution, which is another once faces "
                         "agree in all levels");
    return SLV_OK;
}

slv_result slv_bake_save(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                         const slv_bake_job *job, const char *path, slv_bake_report *report) {
    static const slv_bake_job none = {0};
    slv_bake_report own;
    slv_res *res = NULL;
    slv_parallel_log *log = NULL;
    bake b = {.source = source, .mesh = mesh, .job = job ? job : &none};
    b.report = report ? report : &own;
    /* a single row of texels belongs to two edges, and could not agree with both neighbours */
    slv_bake_job wider = *b.job;
    if (seams_of(&b) == SLV_PTX_SEAMS_ALL && !wider.uniform) {
        slv_res most = wider.max_res;
        bool bound = wider.max_given || most.u || most.v;
        wider.min_res.u += !wider.min_res.u && !(bound && !most.u);
        wider.min_res.v += !wider.min_res.v && !(bound && !most.v);
        wider.seams = SLV_PTX_SEAMS_ALL;
        wider.seams_given = true;
        b.job = &wider;
    }
    *b.report = (slv_bake_report){.faces = source->nfaces};
    slv_result result = check(env, mesh, source, b.job);
    if (result)
        return result;
    b.report->type = b.job->type_given ? b.job->type : source->desc.type;
    b.report->encoding = source->desc.encoding;
    if (b.report->type != source->desc.type && b.report->encoding != SLV_TEXTURE_DATA)
        b.report->encoding = slv_type_encoding(b.report->type);
    slvi_encoder_begin(&b.encoder, b.report->type, source->desc.nchannels,
                       source->desc.alpha_channel, b.report->encoding == SLV_TEXTURE_SRGB);
    if ((result = plan(&b, env, &res)))
        goto done;
    b.res = res;
    b.total = b.report->texels;
    b.texel_size = slv_type_size(b.report->type) * source->desc.nchannels;
    b.report->bytes = b.total * b.texel_size;
    if ((result = slvi_parallel_env_begin(env, &log, &b.env)) ||
        (result = slvi_alloc(env, "bake: faces", source->nfaces, 1, &b.done)))
        goto done;
    result = run(&b, path);
done:
    slv_ptx_writer_destroy(b.writer);
    slv_ptx_writer_destroy(b.map);
    slvi_bake_part_close(&b);
    slvi_bake_end_block(&b);
    slvi_parallel_env_end(log);
    slvi_free(b.done);
    slvi_free(res);
    return result;
}
