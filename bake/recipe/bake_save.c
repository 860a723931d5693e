/* From a source to a .ptx: block after block of faces, so that no more than a block is in memory.
 */
#include "recipe/encode.h"
#include "recipe/plan.h"
#include "source/holes.h"
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <selvage/ptx_writer.h>

#include <pthread.h>
#include <string.h>

#define DEFAULT_MEMORY (UINT64_C(64) << 20)
enum { BAND_TEXELS = 1 << 14, BAND_COST = 1 << 18, MAP_CHANNELS = 3 };

/* What a thread bakes at once of a face, hearing no interrupt meanwhile: rows, or a part of one. */
typedef struct band {
    uint32_t face;
    slv_rect rect;
    uint64_t at; /* of its first texel, in the block */
} band;

typedef struct bake {
    const slv_bake_source *source;
    const slv_mesh *mesh;
    const slv_bake_job *job;
    const slv_res *res;
    slv_env env; /* its log is serialised */
    encoder encoder;
    size_t texel_size;
    slv_ptx_writer *writer, *map;
    slvi_steps steps;
    uint64_t total; /* texels */
    uint8_t map_colors[SLV_BAKE_MISSES][MAP_CHANNELS];

    /* the block */
    uint32_t first, end;
    uint64_t *offsets; /* of each face in it, and one past the last */
    band *bands;
    uint32_t nbands;
    uint8_t *texels, *misses;
    pthread_mutex_t lock;
    slv_bake_report *report;
} bake;

static uint64_t texels_of(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

/* ---- a block ---- */

static slv_result bake_bands(void *user, uint64_t first, uint64_t end) {
    bake *b = user;
    float *values = NULL;
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        const band *now = &b->bands[i];
        slv_rect rect = now->rect;
        uint64_t count = (uint64_t)rect.width * rect.height;
        if ((result = slvi_alloc_plain(&b->env, "bake: values", count,
                                       b->encoder.nchannels * sizeof *values, &values)) ||
            (result = slv_bake_evaluate(b->source, &b->env, now->face, b->res[now->face], rect,
                                        values, b->misses + now->at)))
            break;
        slvi_encoder_run(&b->encoder, values, count, b->texels + now->at * b->texel_size);
        result = slvi_steps_add(&b->steps, &b->env, "bake", count);
        slvi_free(values);
        values = NULL;
    }
    slvi_free(values);
    return result;
}

static slv_result fill_holes(const bake *b, slv_res res, const uint8_t *misses, uint8_t *texels) {
    uint64_t count = texels_of(res);
    float *values = NULL;
    slv_result result = slvi_alloc_plain(&b->env, "bake: values", count,
                                         b->encoder.nchannels * sizeof *values, &values);
    if (result)
        return result;
    slvi_encoder_undo(&b->encoder, texels, count, values);
    if (!(result = slvi_holes_fill(&b->env, b->encoder.nchannels, 1u << res.u, 1u << res.v, misses,
                                   values)))
        slvi_encoder_run(&b->encoder, values, count, texels);
    slvi_free(values);
    return result;
}

static slv_ptx_face face_info(slv_res res, bool constant) {
    return (slv_ptx_face){
        .res = res,
        .flags = constant ? SLV_FACE_CONSTANT : 0,
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
}

static slv_result write_map(const bake *b, uint32_t face, const uint8_t *misses) {
    uint64_t count = texels_of(b->res[face]);
    uint8_t *colors = NULL;
    slv_result result = slvi_alloc_plain(&b->env, "bake: miss map", count, MAP_CHANNELS, &colors);
    for (uint64_t i = 0; i < count && !result; i++)
        memcpy(colors + i * MAP_CHANNELS, b->map_colors[misses[i]], MAP_CHANNELS);
    const slv_ptx_face info = face_info(b->res[face], false);
    if (!result)
        result = slv_ptx_writer_write_face(b->map, face, &info, colors);
    slvi_free(colors);
    return result;
}

static slv_result write_face(bake *b, uint32_t face) {
    uint64_t at = b->offsets[face - b->first], count = texels_of(b->res[face]);
    uint64_t misses[SLV_BAKE_MISSES] = {0};
    uint8_t *texels = b->texels + at * b->texel_size, *missed = b->misses + at;
    bool hole = slv_mesh_face_is_hole(b->mesh, (int32_t)face);
    slv_result result = SLV_OK;
    for (uint64_t i = 0; i < count; i++)
        misses[missed[i]]++;
    uint64_t hits = misses[SLV_BAKE_HIT];
    if (hits && hits < count && (result = fill_holes(b, b->res[face], missed, texels)))
        return result;
    bool constant =
        memcmp(texels, texels + b->texel_size, (size_t)(count - 1) * b->texel_size) == 0;
    const slv_ptx_face info = face_info(b->res[face], constant);
    result = slv_ptx_writer_write_face(b->writer, face, &info, texels);
    if (!result && b->map) {
        if (hole)
            memset(missed, SLV_BAKE_HIT, count);
        result = write_map(b, face, missed);
    }
    pthread_mutex_lock(&b->lock);
    b->report->constant_faces += constant;
    for (int i = 0; i < SLV_BAKE_MISSES; i++)
        b->report->misses[hole ? SLV_BAKE_HIT : i] += misses[i];
    pthread_mutex_unlock(&b->lock);
    return result;
}

static slv_result write_faces(void *user, uint64_t first, uint64_t end) {
    bake *b = user;
    slv_result result = SLV_OK;
    for (uint64_t face = first; face < end && !result; face++)
        result = write_face(b, b->first + (uint32_t)face);
    return result;
}

/* Cuts the faces of the block into bands. */
static slv_result cut(bake *b) {
    uint32_t nfaces = b->end - b->first, count = 0, most = BAND_TEXELS;
    slv_result result = SLV_OK;
    if (b->source->cost > BAND_COST / BAND_TEXELS)
        most = b->source->cost < BAND_COST ? BAND_COST / b->source->cost : 1;
    for (int pass = 0; pass < 2 && !result; pass++) {
        count = 0;
        for (uint32_t k = 0; k < nfaces; k++) {
            slv_res res = b->res[b->first + k];
            uint32_t width = 1u << res.u, height = 1u << res.v;
            uint32_t columns = width < most ? width : most, rows = most >> res.u;
            rows = rows ? rows : 1;
            for (uint32_t y = 0; y < height; y += rows)
                for (uint32_t x = 0; x < width; x += columns, count++)
                    if (pass)
                        b->bands[count] = (band){b->first + k,
                                                 {x, y, width - x < columns ? width - x : columns,
                                                  height - y < rows ? height - y : rows},
                                                 b->offsets[k] + ((uint64_t)y << res.u) + x};
        }
        if (!pass)
            result = slvi_alloc_plain(&b->env, "bake: bands", count, sizeof *b->bands, &b->bands);
    }
    b->nbands = count;
    return result;
}

static slv_result bake_block(bake *b) {
    uint32_t nfaces = b->end - b->first;
    slv_result result =
        slvi_alloc_plain(&b->env, "bake: block", nfaces + 1, sizeof *b->offsets, &b->offsets);
    if (result)
        goto done;
    b->offsets[0] = 0;
    for (uint32_t k = 0; k < nfaces; k++)
        b->offsets[k + 1] = b->offsets[k] + texels_of(b->res[b->first + k]);
    if ((result = slvi_alloc_plain(&b->env, "bake: texels", b->offsets[nfaces], b->texel_size,
                                   &b->texels)) ||
        (result = slvi_alloc_plain(&b->env, "bake: misses", b->offsets[nfaces], 1, &b->misses)) ||
        (result = cut(b)) || (result = slvi_parallel_for(&b->env, b->nbands, 1, bake_bands, b)))
        goto done;
    result = slvi_parallel_for(&b->env, nfaces, 1, write_faces, b);
done:
    slvi_free(b->offsets);
    slvi_free(b->texels);
    slvi_free(b->misses);
    slvi_free(b->bands);
    b->offsets = NULL;
    b->texels = b->misses = NULL;
    b->bands = NULL;
    return result;
}

/* Until the faces of a block are as many bytes as may be in memory; one at least. */
static slv_result bake_blocks(bake *b) {
    uint64_t most = b->job->memory ? b->job->memory : DEFAULT_MEMORY;
    slv_result result = SLV_OK;
    for (b->first = 0; b->first < b->source->nfaces && !result; b->first = b->end) {
        uint64_t bytes = 0;
        for (b->end = b->first; b->end < b->source->nfaces; b->end++) {
            uint64_t more = texels_of(b->res[b->end]) * (b->texel_size + 1) + sizeof *b->offsets;
            if (b->end > b->first && bytes + more > most)
                break;
            bytes += more;
        }
        result = bake_block(b);
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
    return b->job->max_error > 0 ? SLV_PTX_SEAMS_REDUCTIONS : SLV_PTX_SEAMS_ALL;
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
        float rgb[MAP_CHANNELS];
        slv_bake_miss_color((slv_bake_miss)i, rgb);
        slv_type_from_float(SLV_TYPE_U8, rgb, MAP_CHANNELS, b->map_colors[i]);
    }
    params = (slv_ptx_writer_params){.nchannels = MAP_CHANNELS, .alpha_channel = SLV_NO_ALPHA};
    return begin_file(b, b->job->miss_map, params, SLV_TEXTURE_SRGB, &b->map);
}

static slv_result run(bake *b, const char *path) {
    slv_progress texels = {b->job->progress.report ? report_texels : NULL, b};
    slv_result result = open_files(b, path);
    if (result)
        return result;
    slvi_steps_begin(&b->steps, texels, b->total);
    pthread_mutex_init(&b->lock, NULL);
    result = bake_blocks(b);
    pthread_mutex_destroy(&b->lock);
    slvi_steps_end(&b->steps);
    if (!result && b->map)
        result = slv_ptx_writer_finish(b->map);
    return result ? result : slv_ptx_writer_finish(b->writer);
}

static slv_result check(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                        const slv_bake_job *job) {
    if (slv_mesh_face_count(mesh) != source->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "bake: the mesh has %u faces, the source %u",
                         slv_mesh_face_count(mesh), source->nfaces);
    if (job->type_given && (unsigned)job->type > SLV_TYPE_FLOAT)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: unknown data type %d", (int)job->type);
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
    if ((result = slvi_bake_plan(env, mesh, source, b.job, &b.encoder, &res, b.report)))
        return result;
    b.res = res;
    b.total = b.report->texels;
    b.texel_size = slv_type_size(b.report->type) * source->desc.nchannels;
    b.report->bytes = b.total * b.texel_size;
    if (!(result = slvi_parallel_env_begin(env, &log, &b.env))) {
        result = run(&b, path);
        slv_ptx_writer_destroy(b.writer);
        slv_ptx_writer_destroy(b.map);
        slvi_parallel_env_end(log);
    }
    slvi_free(res);
    return result;
}
