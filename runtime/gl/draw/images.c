/* Images by texture coordinates: their levels, and which faces each of them is on. */
#include "gl/draw/images.h"

#include "gl/store/format.h"
#include "gl/store/tables.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/half.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SQUARES = 64 }; /* a face's: one on more of them is drawn without an image */
#define NOWHERE INT64_MIN

/* ---- levels ---- */

typedef struct level {
    const slv_uv_images *images; /* of level 0, which is read as it is needed */
    uint32_t tile, width, height;
    float *pixels; /* of others */
} level;

static void read_row(const level *l, uint32_t y, float *rgba) {
    if (l->pixels)
        memcpy(rgba, l->pixels + (size_t)y * l->width * 4, (size_t)l->width * 4 * sizeof *rgba);
    else
        l->images->pixels(l->images->user, l->tile, 0, y, l->width, rgba);
}

/* Which texels of a longer row texel `i` of `to` lies on, and how much of each. */
static uint32_t spans(uint32_t from, uint32_t to, uint32_t i, uint32_t *first, float weights[3]) {
    double begin = (double)i * from / to, end = (double)(i + 1) * from / to;
    uint32_t count = 0;
    *first = (uint32_t)begin;
    for (uint32_t k = *first; k < from && (double)k < end - 1e-9 && count < 3; k++, count++)
        weights[count] = (float)((fmin(k + 1.0, end) - fmax((double)k, begin)) / (end - begin));
    return count;
}

/* The next level: each texel the mean over its own area, also where a side is odd. `row` has room
 * for a row of the level. */
static slv_result reduce(const slv_env *env, const level *from, float *row, level *out) {
    uint32_t w = from->width > 1 ? from->width / 2 : 1, h = from->height > 1 ? from->height / 2 : 1;
    *out = (level){.width = w, .height = h};
    slv_result result =
        slvi_alloc(env, "image levels", (uint64_t)w * h, 4 * sizeof(float), &out->pixels);
    for (uint32_t y = 0; !result && y < h; y++) {
        uint32_t top, rows;
        float across[3], down[3], *to = out->pixels + (size_t)y * w * 4;
        rows = spans(from->height, h, y, &top, down);
        for (uint32_t j = 0; j < rows; j++) {
            read_row(from, top + j, row);
            for (uint32_t x = 0; x < w; x++) {
                uint32_t left, count = spans(from->width, w, x, &left, across);
                for (uint32_t i = 0; i < count; i++)
                    for (uint32_t c = 0; c < 4; c++)
                        to[4 * x + c] += down[j] * across[i] * row[4 * (size_t)(left + i) + c];
            }
        }
    }
    return result;
}

/* A row in 8 bits in place of its floats. */
static void narrow_row(const uint8_t *srgb, uint32_t count, const float *rgba, uint8_t *out) {
    for (uint32_t i = 0; i < 4 * count; i++) {
        float value = rgba[i] > 0 ? rgba[i] < 1 ? rgba[i] : 1 : 0;
        out[i] =
            srgb && i % 4 < 3 ? srgb[slv_half_from_float(value)] : (uint8_t)(255 * value + 0.5f);
    }
}

static slv_result upload(const slv_gl_images *made, const slv_env *env, const level *l,
                         GLint number, GLuint texture, bool narrow, float *row) {
    const slv_gl_api *api = &made->gl->api;
    for (uint32_t y = 0; y < l->height; y++) {
        read_row(l, y, row);
        if (narrow)
            narrow_row(made->srgb, l->width, row, (uint8_t *)row);
        api->TextureSubImage3D(texture, number, 0, (GLint)y, 0, (GLsizei)l->width, 1, 1, GL_RGBA,
                               narrow ? GL_UNSIGNED_BYTE : GL_FLOAT, row);
    }
    return slvi_gl_check(made->gl, env, "an image");
}

static slv_result make_texture(slv_gl_images *made, const slv_env *env, const slv_uv_images *images,
                               uint32_t tile, GLuint *out) {
    const slv_gl_api *api = &made->gl->api;
    level now = {images, tile, images->tiles[tile].width, images->tiles[tile].height, NULL}, next;
    uint32_t longer = now.width > now.height ? now.width : now.height, most = 1;
    float *row = NULL;
    slv_result result;
    if (longer > made->gl->info.max_texture_size)
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "an image of %u x %u pixels: the driver takes %u at most", now.width,
                         now.height, made->gl->info.max_texture_size);
    while (longer >> most)
        most++;
    if ((result = slvi_alloc(env, "pixels", now.width, 4 * sizeof *row, &row)))
        return result;
    api->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, out);
    const GLenum narrow = images->data ? GL_RGBA8 : GL_SRGB8_ALPHA8;
    api->TextureStorage3D(*out, (GLsizei)most,
                          images->narrow ? narrow
                          : images->wide ? GL_RGBA32F
                                         : GL_RGBA16F,
                          (GLsizei)now.width, (GLsizei)now.height, 1);
    for (uint32_t k = 0; k < most && !result; k++) {
        made->bytes += (uint64_t)now.width * now.height *
                       (images->narrow ? 4
                        : images->wide ? 16
                                       : 8);
        if ((result = upload(made, env, &now, (GLint)k, *out, images->narrow, row)) ||
            k + 1 == most)
            break;
        result = reduce(env, &now, row, &next);
        slvi_free(now.pixels);
        now = next;
    }
    slvi_free(now.pixels);
    slvi_free(row);
    return result;
}

static void none_pixel(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                       float *rgba) {
    (void)tile, (void)x, (void)y, (void)count;
    memcpy(rgba, user, 4 * sizeof *rgba);
}

static slv_result make_textures(slv_gl_images *made, const slv_env *env,
                                const slv_uv_images *images) {
    static const slv_uv_tile one = {0, 0, 1, 1};
    const slv_uv_images none = {
        .ntiles = 1, .tiles = &one, .pixels = none_pixel, .user = images->none};
    slv_result result = slvi_alloc(env, "images", (uint64_t)images->ntiles + 1,
                                   sizeof *made->textures, &made->textures);
    if (!result && images->narrow && !images->data &&
        !(result = slvi_alloc_plain(env, "sRGB curve", SLVI_GL_SRGB, 1, &made->srgb)))
        slvi_gl_srgb_fill(made->srgb);
    made->ntextures = result ? 0 : images->ntiles + 1;
    for (uint32_t i = 0; i < images->ntiles && !result; i++)
        if (images->tiles[i].width && images->tiles[i].height)
            result = make_texture(made, env, images, i, &made->textures[i]);
    slvi_free(made->srgb);
    made->srgb = NULL;
    return result ? result : make_texture(made, env, &none, 0, &made->textures[images->ntiles]);
}

static void make_sampler(slv_gl_images *made, const slv_uv_images *images, uint32_t anisotropy) {
    const slv_gl_api *api = &made->gl->api;
    const bool u = !images->tiled && images->repeat_u, v = !images->tiled && images->repeat_v;
    uint32_t most = made->gl->info.max_anisotropy;
    api->CreateSamplers(1, &made->sampler);
    api->SamplerParameteri(made->sampler, GL_TEXTURE_WRAP_S, u ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    api->SamplerParameteri(made->sampler, GL_TEXTURE_WRAP_T, v ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    api->SamplerParameteri(made->sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    api->SamplerParameteri(made->sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    made->taps = made->gl->info.software ? (GLint)anisotropy : 1;
    if (anisotropy > 1 && most > 1 && made->taps == 1)
        api->SamplerParameterf(made->sampler, GL_TEXTURE_MAX_ANISOTROPY,
                               (GLfloat)(anisotropy < most ? anisotropy : most));
}

/* ---- batches ---- */

/* A face on a square, in the order of the squares and then of the faces. */
typedef struct placed {
    int64_t square;
    uint32_t face;
} placed;

static int64_t square_of(int64_t u, int64_t v) {
    return v * (INT64_C(1) << 32) + u;
}

static int by_square(const void *a, const void *b) {
    const placed *p = a, *q = b;
    if (p->square != q->square)
        return p->square < q->square ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

/* Writes the squares of a face, if `out` is not NULL; returns how many there are. */
static uint32_t squares_of(const slv_uv_images *images, uint32_t face, placed *out) {
    const float *c = images->texcoords + 8 * (size_t)face;
    double low[2], high[2];
    uint32_t count = 0;
    for (int axis = 0; axis < 2; axis++) {
        low[axis] =
            floor((double)fminf(fminf(c[axis], c[2 + axis]), fminf(c[4 + axis], c[6 + axis])));
        high[axis] =
            ceil((double)fmaxf(fmaxf(c[axis], c[2 + axis]), fmaxf(c[4 + axis], c[6 + axis]))) - 1;
        high[axis] = fmax(low[axis], high[axis]);
    }
    bool nowhere =
        isnan(c[0]) || !(fabs(low[0]) < 1e6 && fabs(low[1]) < 1e6 &&
                         (high[0] - low[0] + 1) * (high[1] - low[1] + 1) <= MOST_SQUARES);
    if (!images->tiled || nowhere) {
        if (out)
            *out = (placed){isnan(c[0]) || images->tiled ? NOWHERE : 0, face};
        return 1;
    }
    for (int64_t v = (int64_t)low[1]; v <= (int64_t)high[1]; v++)
        for (int64_t u = (int64_t)low[0]; u <= (int64_t)high[0]; u++, count++)
            if (out)
                out[count] = (placed){square_of(u, v), face};
    return count;
}

static slv_gl_image_batch batch_at(const slv_gl_images *made, const slv_uv_images *images,
                                   int64_t square) {
    slv_gl_image_batch batch = {.texture = made->textures[images->ntiles], .mode = 2};
    if (square == NOWHERE)
        return batch;
    batch.mode = images->tiled;
    batch.u = (int32_t)(uint32_t)((uint64_t)square & UINT32_MAX);
    batch.v = (int32_t)((square - batch.u) / (INT64_C(1) << 32));
    for (uint32_t i = 0; i < images->ntiles; i++)
        if ((!images->tiled || (images->tiles[i].u == batch.u && images->tiles[i].v == batch.v)) &&
            made->textures[i]) {
            batch.texture = made->textures[i];
            break;
        }
    return batch;
}

static slv_result make_batches(slv_gl_images *made, const slv_env *env,
                               const slv_uv_images *images) {
    placed *list = NULL;
    uint64_t count = 0, at = 0;
    slv_result result;
    for (uint32_t face = 0; face < images->nfaces; face++)
        count += squares_of(images, face, NULL);
    if (count > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "faces on too many images");
    if ((result = slvi_alloc_plain(env, "batches", count, sizeof *list, &list)) ||
        (result = slvi_alloc_plain(env, "batches", count, sizeof *made->batches.faces,
                                   &made->batches.faces)))
        goto done;
    for (uint32_t face = 0; face < images->nfaces; face++)
        at += squares_of(images, face, list + at);
    if (count)
        qsort(list, count, sizeof *list, by_square);
    for (uint64_t i = 0; i < count && !result; i++) {
        made->batches.faces[i] = list[i].face;
        if (i && list[i].square == list[i - 1].square) {
            made->batches.ranges[made->batches.count - 1].count++;
            continue;
        }
        slv_gl_batch_range *range;
        if ((result = slvi_gl_add_batch(env, &made->batches, &range)) ||
            (result = slvi_grow(env, "batches", made->batches.count, sizeof *made->squares,
                                &made->squares)))
            break;
        *range = (slv_gl_batch_range){.first = (uint32_t)i, .count = 1};
        made->squares[made->batches.count - 1] = batch_at(made, images, list[i].square);
    }
done:
    slvi_free(list);
    return result;
}

static slv_result check(const slv_gl *gl, const slv_env *env, const slv_uv_images *images,
                        uint32_t anisotropy) {
    uint64_t bytes = (uint64_t)images->nfaces * 8 * sizeof(float);
    if (!images->ntiles || anisotropy < 1 || anisotropy > 16)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%u images, anisotropy %u: expected 1 to 16",
                         images->ntiles, anisotropy);
    if (bytes > gl->max_storage)
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "the texture coordinates take %llu bytes, the driver's limit is %llu",
                         (unsigned long long)bytes, (unsigned long long)gl->max_storage);
    return SLV_OK;
}

slv_result slv_gl_images_create(slv_gl *gl, const slv_env *env, const slv_uv_images *images,
                                uint32_t anisotropy, slv_gl_images **out) {
    slv_gl_images *made = NULL;
    slv_result result = check(gl, env, images, anisotropy);
    *out = NULL;
    if (result || (result = slvi_gl_need_current(gl, env)) ||
        (result = slvi_alloc(env, "images", 1, sizeof *made, &made)))
        return result;
    made->gl = gl;
    made->serial = ++gl->serial;
    made->nfaces = images->nfaces;
    made->round[0] = images->round_u;
    made->round[1] = images->round_v;
    made->bytes = (uint64_t)images->nfaces * 8 * sizeof(float);
    slv_gl_transfer before = slvi_gl_transfer_begin(gl);
    make_sampler(made, images, anisotropy);
    if ((result = make_textures(made, env, images)) || (result = make_batches(made, env, images)) ||
        (result = slvi_gl_buffer(gl, env, "texture coordinates", images->texcoords,
                                 (uint64_t)images->nfaces * 8 * sizeof(float), &made->corners)) ||
        (result = slvi_gl_shader_with_parts(env, "draw/images.glsl", NULL, &made->lookups)) ||
        (result = slvi_gl_shader_with_parts(env, "draw/images_vertex.glsl", NULL, &made->hand_on)))
        goto done;
    *out = made;
    made = NULL;
done:
    slv_gl_images_destroy(made);
    slvi_gl_transfer_end(gl, &before);
    return result;
}

void slv_gl_images_destroy(slv_gl_images *images) {
    if (!images)
        return;
    slv_gl keeping;
    const slv_gl_api *api = &slvi_gl_for_deleting(images->gl, &keeping)->api;
    GLint storage = 0; /* a driver may unbind it with a table of ours that is still bound */
    api->GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &storage);
    api->DeleteTextures((GLsizei)images->ntextures, images->textures);
    api->DeleteSamplers(1, &images->sampler);
    api->DeleteBuffers(1, &images->corners);
    api->BindBuffer(GL_SHADER_STORAGE_BUFFER, (GLuint)storage);
    slvi_gl_batches_free(&images->batches);
    slvi_free(images->squares);
    slvi_free(images->textures);
    slvi_free(images->lookups);
    slvi_free(images->hand_on);
    slvi_free(images);
}

uint64_t slv_gl_images_bytes(const slv_gl_images *images) {
    return images->bytes;
}

void slvi_gl_images_bind(const slv_gl_images *images) {
    const slv_gl_api *api = &images->gl->api;
    const GLintptr from = 0;
    const GLsizeiptr size = (GLsizeiptr)images->nfaces * 8 * (GLsizeiptr)sizeof(float);
    api->BindSamplers(SLV_GL_FIRST_UNIT, 1, &images->sampler);
    if (size)
        api->BindBuffersRange(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE, 1, &images->corners,
                              &from, &size);
}

void slvi_gl_images_bind_batch(const slv_gl_images *images, uint32_t batch, GLuint program) {
    const slv_gl_api *api = &images->gl->api;
    const slv_gl_image_batch *b = &images->squares[batch];
    api->BindTextures(SLV_GL_FIRST_UNIT, 1, &b->texture);
    api->ProgramUniform1i(program, 28, images->taps);
    api->ProgramUniform2i(program, 29, images->round[0], images->round[1]);
    api->ProgramUniform2f(program, 30, (GLfloat)b->u, (GLfloat)b->v);
    api->ProgramUniform1i(program, 31, b->mode);
}

void slvi_gl_images_unbind(const slv_gl_images *images) {
    images->gl->api.BindSamplers(SLV_GL_FIRST_UNIT, 1, NULL);
}
