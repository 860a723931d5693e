/* Calls of calls_kit.h that have to do with where texels come from: sources, caches, parts of files
 * and streams; and with folders that appear as a whole. */
#ifndef CALLS_SOURCES_H
#define CALLS_SOURCES_H

#include "kit/calls_data.h"

#include <selvage/cache.h>
#include <selvage/displacement.h>
#include <selvage/folder.h>
#include <selvage/source.h>

#include <fcntl.h>
#include <sys/stat.h>

static slv_result visit_rect(void *user, uint32_t face, slv_rect rect) {
    (void)user, (void)face, (void)rect;
    return SLV_OK;
}

/* Of 3 x 3 texels of a byte. */
static void fill_rect(void *user, void *texels, size_t pitch) {
    (void)user;
    for (size_t i = 0; i < 9; i++)
        ((uint8_t *)texels)[i / 3 * pitch + i % 3] = (uint8_t)i;
}

/* Texels of face 0 (16 x 16) and of its reductions, and what a writer of sources calls. */
static slv_result read_source(const slv_env *env, const slv_source *source) {
    static float out[16 * 16 * 4];
    slv_source_face face;
    slv_result result =
        slv_source_check(env, source, 0, (slv_res){3, 4}, (slv_rect){1, 2, 5, 7}, &face);
    if (!result &&
        !(result =
              source->fns->read(source->user, 0, (slv_res){4, 4}, (slv_rect){1, 2, 5, 7}, out)) &&
        !(result =
              source->fns->read(source->user, 0, (slv_res){2, 2}, (slv_rect){0, 0, 3, 3}, out)) &&
        !(result = slv_source_reduce(env, source, 0, (slv_res){1, 3}, (slv_rect){0, 1, 2, 3}, out)))
        result = slv_source_changed(source, 0, visit_rect, NULL);
    return result;
}

static slv_result open_store(const slv_env *env, slv_source *out) {
    return slv_texture_as_source(env, calls.texture, calls.adjacency, NULL, out);
}

static slv_result call_store_source(const slv_env *env) {
    slv_source source = {0};
    slv_result result = open_store(env, &source);
    if (!result)
        result = read_source(env, &source);
    slv_source_close(&source);
    return result;
}

static slv_result call_decoded(const slv_env *env) {
    slv_source source = {0}, light = {0};
    slv_result result = open_store(env, &source);
    if (!result && !(result = slv_source_decode(env, &source, SLV_TEXTURE_SRGB, &light)))
        result = read_source(env, &light);
    slv_source_close(&light);
    return result;
}

static slv_result call_ptx_source(const slv_env *env) {
    slv_ptx *ptx = NULL;
    slv_source source = {0};
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    if (!result && !(result = slv_ptx_as_source(env, ptx, &source)))
        result = read_source(env, &source);
    slv_source_close(&source);
    slv_ptx_close(ptx);
    return result;
}

/* Reads through a cache, forgets, and reads again. */
static slv_result read_cached(const slv_env *env, slv_cache *cache, slv_file_id file) {
    static float out[8 * 8 * 4];
    slv_source source = {0};
    slv_result result = slv_cache_as_source(cache, file, &source);
    if (!result &&
        !(result =
              source.fns->read(source.user, 0, (slv_res){3, 3}, (slv_rect){1, 2, 5, 5}, out)) &&
        !(result = slv_cache_invalidate_face(cache, file, 0, NULL)) &&
        !(result = slv_cache_refresh(cache, 0)) &&
        !(result = source.fns->read(source.user, 0, (slv_res){3, 3}, (slv_rect){0, 0, 2, 2}, out)))
        result = slv_source_changed(&source, 0, visit_rect, NULL);
    (void)env;
    slv_source_close(&source);
    return result;
}

static const slv_cache_open_params calls_capped = {.max_log2_res = 3};

static slv_result call_cached_store(const slv_env *env) {
    slv_cache *cache = NULL;
    slv_source source = {0};
    slv_file_id file = 0;
    slv_result result = slv_cache_create(env, NULL, &cache);
    if (!result && !(result = open_store(env, &source)) &&
        !(result = slv_cache_open_source(cache, &source, &calls_capped, &file)))
        result = read_cached(env, cache, file);
    slv_cache_destroy(cache);
    return result;
}

static slv_result call_cached_ptx(const slv_env *env) {
    slv_cache *cache = NULL;
    slv_file_id file = 0;
    slv_result result = slv_cache_create(env, NULL, &cache);
    if (!result && !(result = slv_cache_open_with(cache, calls.ptx, &calls_capped, &file)))
        result = read_cached(env, cache, file);
    slv_cache_destroy(cache);
    return result;
}

static slv_result visit_some(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    return SLV_OK;
}

static slv_result call_ptx_some(const slv_env *env) {
    static const slv_res res[5] = {{2, 2}, {1, 2}, {1, 1}, {0, 0}, {2, 2}};
    static const uint32_t faces[2] = {1, 3};
    const slv_ptx_open_params params = {.premultiply = true};
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL, *light = NULL;
    slv_texture_encoding encoding;
    slv_result result = slv_ptx_open_with(env, calls.ptx, &params, &ptx);
    if (!result && !(result = slv_ptx_get_encoding(ptx, &encoding)) &&
        !(result = slv_ptx_visit_some_faces(env, ptx, faces, 2, visit_some, NULL)) &&
        !(result = slv_ptx_load_texture_at(env, ptx, res, &texture)))
        result = slv_texture_decode(env, texture, SLV_TEXTURE_SRGB, &light);
    if (!result && light) {
        slv_texture_destroy(light);
        result = slv_texture_widen(env, texture, &light);
    }
    slv_texture_destroy(light);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    return result;
}

static slv_result call_store_rects(const slv_env *env) {
    static const slv_res res = {4, 4};
    static const uint8_t texels[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const slv_texture_desc desc = {
        .nfaces = 1, .type = SLV_TYPE_U8, .nchannels = 1, .alpha_channel = 0, .res = &res};
    const slv_rect rect = {1, 1, 3, 3}, all = {0, 0, 2, 4};
    const slv_res other = {1, 2};
    slv_texture *texture = NULL, *light = NULL, *multiplied = NULL;
    slv_levels *levels = NULL, *even = NULL;
    slv_result result = slv_texture_create(env, &desc, &texture);
    if (!result && !(result = slv_texture_set_constant(texture, 0, "a")) &&
        !(result = slv_texture_decode(env, texture, SLV_TEXTURE_SRGB, &light)) &&
        !(result = slv_texture_premultiply(env, texture, SLV_TEXTURE_SRGB, &multiplied)) &&
        !(result = slv_levels_create_even(env, texture, &even)) &&
        !(result = slv_levels_create_over(env, texture, &levels)) &&
        !(result = slv_texture_set_rect(texture, 0, rect, texels)) &&
        !(result = slv_texture_fill_rect(texture, 0, rect, fill_rect, NULL)) &&
        !(result = slv_texture_changed(texture, 1, visit_rect, NULL)) &&
        !(result = slv_texture_decode_rect(env, texture, 0, rect, light)) &&
        !(result = slv_levels_update(levels, texture, 0, rect)) &&
        !(result = slv_texture_set_resolution(texture, 0, other, texels)) &&
        !(result = slv_texture_decode_rect(env, texture, 0, all, light)))
        result = slv_levels_update(levels, texture, 0, all);
    slv_texture_destroy(light);
    slv_texture_destroy(multiplied);
    slv_levels_destroy(levels);
    slv_levels_destroy(even);
    slv_texture_destroy(texture);
    return result;
}

static int read_stream(void *user, uint64_t offset, void *buffer, size_t size) {
    return pread(*(int *)user, buffer, size, (off_t)offset) != (ssize_t)size;
}

static slv_stream_in open_stream(const char *path, int *file) {
    struct stat status;
    *file = open(path, O_RDONLY);
    REQUIRE(*file >= 0 && fstat(*file, &status) == 0);
    return (slv_stream_in){.read = read_stream, .user = file, .size = (uint64_t)status.st_size};
}

static slv_result call_streams(const slv_env *env) {
    int files[3];
    slv_stream_in ptx_in = open_stream(calls.ptx, &files[0]),
                  png_in = open_stream(calls.png, &files[1]),
                  exr_in = open_stream(calls.exr, &files[2]);
    slv_ptx *ptx = NULL;
    slv_image png = {0}, exr = {0};
    slv_result result = slv_ptx_open_stream(env, "stream", &ptx_in, &ptx);
    if (!result && !(result = slv_ptx_load_tables(ptx)) &&
        !(result = slv_image_load_stream(env, "png", &png_in, &png)))
        result = slv_image_load_stream(env, "exr", &exr_in, &exr);
    slv_image_free(&png);
    slv_image_free(&exr);
    slv_ptx_close(ptx);
    for (int i = 0; i < 3; i++)
        close(files[i]);
    return result;
}

/* A file goes into the folder and out with it, whatever comes of that. */
static slv_result fill_folder(slv_folder *folder, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", slv_folder_path(folder), name);
    int file = open(path, O_CREAT | O_WRONLY, 0600);
    REQUIRE(file >= 0);
    test_ignore((slv_result)close(file));
    return slv_folder_end(folder, name, SLV_OK);
}

static slv_result call_folders(const slv_env *env) {
    slv_folder *folder = NULL;
    slv_result result = slv_folder_begin(env, calls_path("made"), &folder);
    if (!result && !(result = fill_folder(folder, "one")) &&
        !(result = slv_folder_begin_beside(env, calls_path("beside"), &folder)))
        result = fill_folder(folder, "beside");
    return result;
}

/* A surface moved by a file, as it stands or with other neighbours. */
static slv_result call_displaced_by(const slv_env *env, const slv_adjacency *adjacency) {
    const slv_displacement_params moved = {.adjacency = adjacency};
    slv_displacement displacement = {.space = SLV_DISPLACE_NORMAL};
    const float low[3] = {0, 0, 0}, high[3] = {3, 1, 1};
    const slv_camera camera = slv_camera_orbit(low, high, 20, 30, 30, 1);
    const slv_tessellation_params params = {
        .displacement = &displacement, .camera = &camera, .width = 16, .height = 16};
    slv_tessellation tessellation = {0};
    slv_cache *cache = NULL;
    slv_file_id file;
    slv_result result = slv_cache_create(env, NULL, &cache);
    if (!result && !(result = slv_cache_open(cache, calls.ptx, &file)) &&
        !(result = slv_displacement_open(cache, file, &moved, &displacement)))
        result = slv_tessellate_with(env, calls.mesh, calls.surface, calls.adjacency, &params,
                                     &tessellation);
    slv_tessellation_free(&tessellation);
    slv_displacement_close(&displacement);
    slv_cache_destroy(cache);
    return result;
}

static slv_result call_displaced(const slv_env *env) {
    slv_result result = call_displaced_by(env, NULL);
    return result ? result : call_displaced_by(env, calls.adjacency);
}

#endif
