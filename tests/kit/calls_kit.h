/* A call of each public function of libselvage and libselvage-bake that can fail, with all objects
 * that it needs made and destroyed within it: for tests of what every call must do with memory.
 * tests/headers/sweep.sh compares these files with the public headers. */
#ifndef CALLS_KIT_H
#define CALLS_KIT_H

#include "kit/calls_bake.h"
#include "kit/calls_data.h"
#include "kit/calls_document.h"
#include "kit/calls_paint.h"
#include "kit/calls_sources.h"
#include "kit/calls_triangles.h"

#include <selvage/edge_aligned.h>
#include <selvage/file.h>
#include <selvage/filter.h>
#include <selvage/htex.h>
#include <selvage/ptx_check.h>
#include <selvage/ptx_diff.h>
#include <selvage/ptx_resize.h>
#include <selvage/ptx_writer.h>
#include <selvage/reference.h>
#include <selvage/seamless.h>
#include <selvage/threads.h>
#include <selvage/transfer.h>
#include <selvage/wrap.h>

/* ---- meshes and surfaces ---- */

static slv_result call_parse_obj(const slv_env *env) {
    slv_mesh *mesh = NULL;
    slv_mesh_stats stats;
    slv_adjacency *adjacency = NULL;
    slv_face_match matches[CALLS_FACES];
    float *corners = NULL;
    slv_result result = slv_mesh_parse_obj(env, "mesh", calls_obj, sizeof calls_obj - 1, &mesh);
    uint32_t n = result ? 0 : slv_mesh_face_count(mesh);
    if (!result && !(result = slv_mesh_get_stats(env, mesh, &stats)) &&
        !(result = slv_mesh_corners(env, mesh, NULL, &corners)) &&
        !(result = slv_mesh_match_corners(env, n, corners, n, corners, 0.1f, matches)))
        result = slv_mesh_adjacency(env, mesh, &adjacency);
    slv_free(corners);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_parse_ply(const slv_env *env) {
    slv_mesh *mesh = NULL;
    slv_result result = slv_mesh_parse_ply(env, "mesh", calls_ply, sizeof calls_ply - 1, &mesh);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_mesh_file(const slv_env *env) {
    slv_mesh *mesh = NULL, *copy = NULL;
    slv_result result = slv_mesh_load(env, calls.obj, &mesh);
    if (!result && !(result = slv_mesh_create(env, slv_mesh_get_view(mesh), &copy)))
        result = slv_mesh_save_obj(env, copy, calls_path("out.obj"));
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(copy);
    return result;
}

static slv_result call_wrap(const slv_env *env) {
    const slv_wrap_params params = {.map = SLV_WRAP_TORUS};
    slv_mesh *mesh = NULL;
    slv_result result = slv_mesh_wrap(env, calls.mesh, &params, NULL, &mesh);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_adjacency(const slv_env *env) {
    slv_adjacency *adjacency = NULL;
    slv_result result = slv_adjacency_create(env, slv_mesh_face_count(calls.mesh),
                                             slv_adjacency_faces(calls.adjacency),
                                             slv_mesh_face_flags(calls.mesh), &adjacency);
    slv_adjacency_destroy(adjacency);
    return result;
}

static slv_result surface_of(const slv_env *env, slv_scheme scheme) {
    const slv_surface_params params = {.scheme = scheme, .moves = true};
    const slv_surface_point points[2] = {{0, 0.3f, 0.2f}, {4, 0.5f, 0.5f}};
    float positions[3 * 9], normals[3 * 9];
    slv_surface_arrays arrays = {.positions = positions, .normals = normals};
    slv_face_adjacency faces[CALLS_FACES];
    slv_surface *surface = NULL;
    slv_tessellation tessellation = {0};
    slv_result result = slv_surface_create(env, calls.mesh, &params, &surface);
    if (!result && !(result = slv_surface_evaluate(surface, 2, points, &arrays)) &&
        !(result = slv_surface_evaluate_grid(surface, 1, 2, 2, &arrays)) &&
        !(result = slv_surface_osd_adjacency(surface, faces)) &&
        !(result = slv_surface_move(surface, slv_mesh_get_view(calls.mesh)->nverts,
                                    slv_mesh_get_view(calls.mesh)->positions)))
        result = slv_tessellate(env, calls.mesh, surface, calls.adjacency, 4, &tessellation);
    slv_tessellation_free(&tessellation);
    slv_surface_destroy(surface);
    return result;
}

static slv_result call_catmark(const slv_env *env) {
    return surface_of(env, SLV_SCHEME_CATMARK);
}

static slv_result call_bilinear(const slv_env *env) {
    return surface_of(env, SLV_SCHEME_BILINEAR);
}

/* ---- textures and their forms ---- */

static slv_result call_texture(const slv_env *env) {
    const slv_texture_desc *desc = slv_texture_get_desc(calls.texture);
    slv_texture *texture = NULL;
    slv_levels *levels = NULL;
    float border[6 * 6 * 4];
    bool outside;
    slv_result result = slv_texture_create(env, desc, &texture);
    for (uint32_t face = 0; !result && face < desc->nfaces; face++)
        result = slv_texture_set_face(texture, face, slv_texture_texels(calls.texture, face));
    if (!result && !(result = slv_texture_set_constant(texture, 1, "abcd")) &&
        !(result = slv_levels_create(env, texture, &levels)))
        result = slv_border_build(levels, calls.adjacency, 2, 0, 1, 1, border, &outside);
    slv_levels_destroy(levels);
    slv_texture_destroy(texture);
    return result;
}

static slv_result call_edge_aligned(const slv_env *env) {
    slv_edge_aligned *aligned = NULL;
    slv_edge_aligned_error error;
    slv_texture *back = NULL;
    static float samples[17 * 17 * 4];
    slv_result result = slv_edge_aligned_create(env, calls.levels, calls.adjacency, &aligned);
    if (!result &&
        !(result = slv_edge_aligned_build(calls.levels, calls.adjacency, 0, 0, samples)) &&
        !(result = slv_edge_aligned_centred(aligned, 0, 0, samples)) &&
        !(result = slv_edge_aligned_measure(env, aligned, calls.levels, calls.adjacency, &error)))
        result = slv_edge_aligned_to_texture(env, aligned, &back);
    slv_texture_destroy(back);
    slv_edge_aligned_destroy(aligned);
    return result;
}

static slv_result call_htex(const slv_env *env) {
    slv_htex *htex = NULL;
    slv_htex_error error;
    slv_result result = slv_htex_create(env, calls.levels, calls.adjacency, &htex);
    if (!result)
        result = slv_htex_measure(env, htex, calls.levels, calls.adjacency, &error);
    slv_htex_destroy(htex);
    return result;
}

static slv_result call_seamless(const slv_env *env) {
    const slv_ptx_write_params params = {.seams = SLV_PTX_SEAMS_ALL};
    slv_levels *levels = NULL;
    slv_seam_agreement agreement;
    slv_result result = slv_levels_create_seamless(env, calls.texture, calls.adjacency, 1, &levels);
    if (!result)
        slv_levels_agreement(levels, calls.adjacency, 1, &agreement);
    slv_levels_destroy(levels);
    return result
               ? result
               : slv_ptx_save(env, calls_path("out.ptx"), calls.texture, calls.adjacency, &params);
}

/* ---- .ptx ---- */

static slv_result call_ptx_read(const slv_env *env) {
    static unsigned char texels[4 << 8];
    slv_ptx *ptx = NULL;
    slv_ptx_reader *reader = NULL;
    slv_ptx_face face;
    slv_ptx_block block;
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    const slv_ptx_meta *meta;
    const void *averages;
    if (!result && !(result = slv_ptx_load_meta(ptx, 0, &meta)) &&
        !(result = slv_ptx_load_averages(ptx, &averages)) && !(result = slv_ptx_load_tables(ptx)) &&
        !(result = slv_ptx_get_face(ptx, 0, &face)) &&
        !(result = slv_ptx_get_block(ptx, 0, 0, &block)) &&
        !(result = slv_ptx_read_face(ptx, 0, (slv_res){4, 4}, texels)) &&
        !(result = slv_ptx_read_face(ptx, 0, (slv_res){1, 2}, texels)) &&
        !(result = slv_ptx_reader_create(env, ptx, &reader)) &&
        !(result = slv_ptx_reader_read(reader, 1, (slv_res){2, 2}, texels)))
        result =
            slv_ptx_reader_read_tile(reader, 0, (slv_res){3, 3}, (slv_res){1, 1}, 2, 2, texels);
    slv_ptx_reader_destroy(reader);
    slv_ptx_close(ptx);
    return result;
}

static slv_result visit(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                        void *texels) {
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    return SLV_OK;
}

static slv_result call_ptx_load(const slv_env *env) {
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    slv_mesh *mesh = NULL, *found = NULL;
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    if (!result && !(result = slv_ptx_find_mesh(env, ptx, &found, NULL)))
        CHECK_MSG(found, "a mesh that could not be read is taken for none");
    slv_mesh_destroy(found);
    if (!result && !(result = slv_ptx_load_texture(env, ptx, &texture)) &&
        !(result = slv_ptx_load_adjacency(env, ptx, &adjacency)) &&
        !(result = slv_ptx_load_mesh(env, ptx, &mesh)) &&
        !(result = slv_ptx_match_mesh(env, ptx, mesh)))
        result = slv_ptx_visit_faces(env, ptx, visit, NULL);
    slv_mesh_destroy(mesh);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    return result;
}

static slv_result call_ptx_save(const slv_env *env) {
    return slv_ptx_save(env, calls_path("out.ptx"), calls.texture, calls.adjacency,
                        &(slv_ptx_write_params){.mesh = calls.mesh});
}

static slv_result call_ptx_writer(const slv_env *env) {
    static const unsigned char texels[16 * 16 * 2] = {1, 2, 3, 4, 5};
    const slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                          .nchannels = 2,
                                          .alpha_channel = 1,
                                          .nfaces = 5,
                                          .compression = 6,
                                          .memory = 1};
    const slv_ptx_face face = {.res = {4, 4}, .adjacency.face = {-1, -1, -1, -1}};
    const slv_ptx_meta meta = {.key = "k", .type = SLV_META_STRING, .count = 1, .values = "v"};
    slv_ptx_writer *writer = NULL;
    slv_result result = slv_ptx_writer_create(env, calls_path("written.ptx"), &params, &writer);
    if (!result && !(result = slv_ptx_writer_write_face(writer, 2, &face, texels)) &&
        !(result = slv_ptx_writer_set_meta(writer, &meta)) &&
        !(result = slv_ptx_writer_set_adjacency(writer, calls.adjacency)) &&
        !(result = slv_ptx_writer_set_mesh(writer, calls.mesh)))
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

/* The file that is edited is made outside of the call's memory. */
static slv_result call_ptx_edit(const slv_env *env) {
    static const unsigned char texels[4 * 4 * 4] = {1, 2, 3};
    const slv_ptx_face face = {.res = {2, 2}, .adjacency.face = {-1, -1, -1, -1}};
    const slv_ptx_meta meta = {.key = "k", .type = SLV_META_STRING, .count = 1, .values = "v"};
    const char *path = calls_path("edited.ptx");
    slv_ptx_writer *writer = NULL;
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_writer_edit(env, path, NULL, &writer);
    if (!result && !(result = slv_ptx_writer_write_face(writer, 2, &face, texels)) &&
        !(result = slv_ptx_writer_set_meta(writer, &meta)))
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    if (!result && !(result = slv_ptx_open(env, path, &ptx)))
        result = slv_ptx_load_tables(ptx);
    slv_ptx_close(ptx);
    return result;
}

static slv_result call_ptx_rewrite(const slv_env *env) {
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    if (!result && !(result = slv_ptx_rewrite(env, ptx, calls_path("out.ptx"), NULL)))
        result = slv_ptx_repair(env, ptx, calls.mesh, calls_path("out.ptx"), NULL);
    slv_ptx_close(ptx);
    return result;
}

static slv_result call_ptx_check(const slv_env *env) {
    slv_ptx_report *report = NULL;
    const slv_ptx_check_params params = {.mesh = calls.mesh, .seams = true};
    slv_result result = slv_ptx_check(env, calls.ptx, &params, &report);
    for (uint32_t i = 0; !result && i < report->nfindings; i++)
        CHECK_MSG(report->findings[i].kind == SLV_CHECK_SEAMS, "of a sound file: %s",
                  report->findings[i].message);
    slv_ptx_report_destroy(report);
    return result;
}

static slv_result call_ptx_diff(const slv_env *env) {
    slv_ptx *ptx = NULL;
    slv_face_diff differences[CALLS_FACES];
    float texels[256 * 4], resized[64 * 4];
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    if (!result && !(result = slv_ptx_diff(env, ptx, ptx, NULL, differences)) &&
        !(result = slv_ptx_diff_texels(env, ptx, ptx, 0, &differences[0], texels)))
        result =
            slv_ptx_resize(env, SLV_PTX_QUAD, 4, (slv_res){4, 4}, texels, (slv_res){3, 3}, resized);
    slv_ptx_close(ptx);
    return result;
}

/* ---- exchange ---- */

/* Converts a file, and nothing but a whole one counts. */
static slv_result exchange_file(const slv_env *env, const char *from, const char *to,
                                slv_result (*how)(const slv_env *, const slv_exchange *,
                                                  const slv_exchange_params *, const char *,
                                                  slv_exchange_stats *)) {
    const slv_exchange_params params = {.changes = SLV_EXCHANGE_TYPE, .type = SLV_TYPE_U16};
    slv_exchange *source = NULL;
    slv_result result = slv_exchange_open(env, from, &source);
    if (!result)
        result = how(env, source, &params, to, NULL);
    slv_exchange_close(source);
    return result;
}

static slv_result call_convert(const slv_env *env) {
    return exchange_file(env, calls.ptx, calls_path("converted.ptx"), slv_exchange_to_ptx);
}

static slv_result call_folder(const slv_env *env) {
    char folder[sizeof calls.out];
    snprintf(folder, sizeof folder, "%s", calls_path("images"));
    slv_result result = exchange_file(env, calls.ptx, folder, slv_exchange_to_folder);
    return result ? result
                  : exchange_file(env, folder, calls_path("back.ptx"), slv_exchange_to_ptx);
}

static slv_result call_sheet(const slv_env *env) {
    slv_result result =
        exchange_file(env, calls.ptx, calls_path("sheet.png"), slv_exchange_to_sheet);
    char index[sizeof calls.out];
    snprintf(index, sizeof index, "%s", calls_path("sheet.json"));
    return result ? result : exchange_file(env, index, calls_path("back.ptx"), slv_exchange_to_ptx);
}

static slv_result call_merge(const slv_env *env) {
    const char *const paths[] = {calls.ptx, calls.ptx};
    bool geometry = false;
    slv_result result =
        slv_merge(env, paths, 2, NULL, calls_path("merged.ptx"), NULL, &geometry, NULL);
    CHECK_MSG(result || geometry, "geometry that could not be read is taken for none");
    return result;
}

/* What was merged comes apart; and some faces of it. */
static slv_result call_split(const slv_env *env) {
    static const uint32_t faces[] = {0, 1};
    const slv_exchange_params some = {.faces = faces, .nfaces = 2};
    slv_exchange *source = NULL;
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, calls.merged, &ptx);
    if (!result && !(result = slv_split(env, ptx, NULL, calls_path("parts"), NULL)) &&
        !(result = slv_exchange_open_ptx(env, ptx, &source)))
        result = slv_exchange_to_ptx(env, source, &some, calls_path("some.ptx"), NULL);
    slv_exchange_close(source);
    slv_ptx_close(ptx);
    return result;
}

/* ---- the cache ---- */

static slv_result call_sample(const slv_env *env) {
    slv_cache *cache = NULL;
    slv_file_id file = 0;
    slv_ptx_info info;
    float out[8];
    static uint64_t workspace[64];
    CHECK(slv_sample_workspace(2) <= sizeof workspace);
    slv_result result = slv_cache_create(env, NULL, &cache);
    if (!result && !(result = slv_cache_open(cache, calls.ptx, &file)))
        result = slv_cache_get_info(cache, file, &info);
    for (int filter = 0; !result && filter < SLV_FILTER_COUNT; filter++) {
        const slv_filter_params params = {.filter = (slv_filter)filter, .lerp = true};
        const slv_lookup lookups[2] = {
            {.file = file, .face = 0, .u = 0.02f, .v = 0.5f, .uw1 = 0.1f, .vw2 = 0.1f},
            {.file = file, .face = 2, .u = 0.5f, .v = 0.98f, .uw1 = 0.3f, .vw2 = 0.4f}};
        slv_sampler *sampler = NULL;
        result = slv_sampler_create(cache, &params, &sampler);
        if (!result && !(result = slv_sample(sampler, &lookups[0], out)) &&
            !(result = slv_sample_batch(sampler, lookups, 2, out, 4, NULL)))
            result = slv_sample_sorted(sampler, lookups, 2, out, 4, NULL, workspace);
        slv_sampler_destroy(sampler);
        if (!result)
            result = slv_cache_invalidate(cache, file);
    }
    if (!result)
        result = slv_cache_close(cache, file);
    slv_cache_destroy(cache);
    return result;
}

/* ---- images ---- */

static slv_result image_through(const slv_env *env, const char *name, const char *input) {
    slv_image image = {0};
    slv_result result = slv_image_save(env, calls_path(name), &calls.image, NULL);
    if (!result)
        result = slv_image_load(env, input, &image);
    slv_image_free(&image);
    return result;
}

static slv_result call_png(const slv_env *env) {
    void *bytes = NULL;
    size_t size;
    slv_result result = image_through(env, "out.png", calls.png);
    if (!result)
        result = slv_image_encode_png(env, &calls.image, NULL, &bytes, &size);
    slv_free(bytes);
    return result;
}

static slv_result call_exr(const slv_env *env) {
    return image_through(env, "out.exr", calls.exr);
}

/* ---- texts ---- */

static slv_result call_text(const slv_env *env) {
    char *text = NULL;
    size_t size;
    slv_output *output = NULL;
    const char *path = calls_path("out.txt");
    slv_result result = slv_text_load(env, calls.obj, &text, &size);
    if (!result && !(result = slv_output_try(env, path)) &&
        !(result = slv_output_open(env, path, &output))) {
        size_t written = fwrite(text, 1, size, slv_output_stream(output));
        result = slv_output_end(output, SLV_OK);
        CHECK(result || written == size);
    }
    if (!result && !(result = slv_output_open_stream(env, path, &output)))
        result = slv_output_end(output, SLV_OK);
    slv_free(text);
    return result;
}

/* ---- baking ---- */

static slv_result call_transfer(const slv_env *env) {
    slv_transfer_face faces[CALLS_FACES];
    slv_texture *moved = NULL;
    slv_result result =
        slv_transfer(env, calls.mesh, calls.texture, calls.mesh,
                     &(slv_transfer_params){.no_copies = true}, faces, NULL, &moved);
    slv_texture_destroy(moved);
    return result;
}

/* From a file behind a cache, into a sink that keeps nothing. */
static slv_result take_desc(void *user, const slv_texture_desc *desc) {
    (void)user, (void)desc;
    return SLV_OK;
}

static slv_result take_face(void *user, const slv_env *env, uint32_t face, bool constant,
                            const void *texels) {
    (void)user, (void)env, (void)face, (void)constant, (void)texels;
    return SLV_OK;
}

static slv_result call_transfer_from(const slv_env *env) {
    static const slv_transfer_sink sink = {take_desc, take_face, NULL};
    slv_transfer_face faces[CALLS_FACES];
    slv_cache *cache = NULL;
    slv_source source = {0};
    slv_file_id file;
    slv_result result = slv_cache_create(env, NULL, &cache);
    if (!result && !(result = slv_cache_open(cache, calls.ptx, &file)) &&
        !(result = slv_cache_as_source(cache, file, &source)))
        result = slv_transfer_from(env, calls.mesh, &source, calls.mesh, NULL, &sink, faces, NULL);
    slv_source_close(&source);
    slv_cache_destroy(cache);
    return result;
}

static slv_result call_reference(const slv_env *env) {
    const float low[3] = {0, 0, 0}, high[3] = {3, 1, 1};
    const slv_reference_frame frame = {.camera = slv_camera_orbit(low, high, 20, 30, 30, 1),
                                       .width = 16,
                                       .height = 16,
                                       .samples = 2};
    const slv_surface_point point = {0, 0.5f, 0.5f};
    static slv_reference_hit hits[16 * 16];
    slv_reference *reference = NULL;
    slv_image image = {0}, error = {0};
    float rgb[3];
    slv_result result =
        slv_reference_create(env, calls.mesh, calls.surface, calls.texture, calls.adjacency,
                             &(slv_reference_params){.segments = 2}, &reference);
    if (!result && !(result = slv_reference_lookup(reference, 1, &point, rgb)) &&
        !(result = slv_reference_render(reference, env, &frame, &image, &error, NULL)))
        result = slv_reference_trace(reference, env, &frame.camera, 16, 16, hits);
    if (!result)
        result = slv_reference_tessellate(reference, env, calls.mesh, calls.surface,
                                          &(slv_tessellation_params){.segments = 4});
    slv_image_free(&image);
    slv_image_free(&error);
    slv_reference_destroy(reference);
    return result;
}

static slv_result call_threads(const slv_env *env) {
    slv_threads *threads = NULL;
    slv_result result = slv_threads_create(env, &threads);
    slv_threads_destroy(threads);
    return result;
}

typedef struct calls_entry {
    const char *name;
    slv_result (*call)(const slv_env *env);
} calls_entry;

static const calls_entry calls_all[] = {
    {"parse_obj", call_parse_obj},
    {"parse_ply", call_parse_ply},
    {"mesh_file", call_mesh_file},
    {"mesh_cube", call_mesh_cube},
    {"wrap", call_wrap},
    {"adjacency", call_adjacency},
    {"catmark", call_catmark},
    {"bilinear", call_bilinear},
    {"displaced", call_displaced},
    {"triangles", call_triangles},
    {"texture", call_texture},
    {"edge_aligned", call_edge_aligned},
    {"htex", call_htex},
    {"seamless", call_seamless},
    {"ptx_read", call_ptx_read},
    {"ptx_load", call_ptx_load},
    {"ptx_save", call_ptx_save},
    {"ptx_writer", call_ptx_writer},
    {"ptx_edit", call_ptx_edit},
    {"ptx_rewrite", call_ptx_rewrite},
    {"ptx_check", call_ptx_check},
    {"ptx_diff", call_ptx_diff},
    {"convert", call_convert},
    {"folder", call_folder},
    {"sheet", call_sheet},
    {"merge", call_merge},
    {"split", call_split},
    {"sample", call_sample},
    {"png", call_png},
    {"exr", call_exr},
    {"text", call_text},
    {"bake", call_bake},
    {"bake_save", call_bake_save},
    {"bake_recipe", call_bake_recipe},
    {"bake_colors", call_bake_colors},
    {"bake_rays", call_bake_rays},
    {"unbake", call_unbake},
    {"unbake normals", call_unbake_normals},
    {"transfer", call_transfer},
    {"reference", call_reference},
    {"transfer_from", call_transfer_from},
    {"threads", call_threads},
    {"store_source", call_store_source},
    {"decoded", call_decoded},
    {"ptx_source", call_ptx_source},
    {"cached_store", call_cached_store},
    {"cached_ptx", call_cached_ptx},
    {"ptx_some", call_ptx_some},
    {"store_rects", call_store_rects},
    {"streams", call_streams},
    {"folders", call_folders},
    {"blank", call_blank},
    {"dabs", call_dabs},
    {"lay", call_lay},
    {"brush", call_brush},
    {"stroke", call_stroke},
    {"document", call_document},
    {"session", call_session},
    {"session_moves", call_session_moves},
    {"fill", call_fill},
    {"script", call_script},
};
enum { CALLS_COUNT = sizeof calls_all / sizeof *calls_all };

/* Before each run: a file to edit as it was, and a brush. */
static inline void calls_prepare(void) {
    slv_env env = test_env();
    REQUIRE(!slv_ptx_save(&env, calls_path("edited.ptx"), calls.texture, calls.adjacency, NULL));
    calls_prepare_brush();
    calls_prepare_session();
}

/* What a call that fails has said: the last error line, and how many there were. */
static unsigned calls_errors;
static char calls_message[512];

static inline void calls_log(void *user, slv_log_level level, const char *line) {
    (void)user;
    if (level != SLV_LOG_ERROR)
        return;
    calls_errors++;
    snprintf(calls_message, sizeof calls_message, "%s", line);
}

#endif
