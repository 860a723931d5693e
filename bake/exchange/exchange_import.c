/* A .ptx out of images: one a face, or one that has all. */
#include "exchange/import.h"
#include "exchange/index.h"

#include <stdio.h>
#include <string.h>

struct import {
    const slv_env *env;
    const slv_exchange *exchange;
    const char *index;
    const json_t *faces;
    const slv_ptx_writer_params *source;
    slv_texture_encoding encoding;
    slv_image *images; /* one a group */
    bool sheet;
    float *values;
    void *texels;
    size_t capacity;
    slvi_import_loss dropped, added; /* alpha */
    slvi_import_loss unsaid;         /* what the colours are */
};

/* From what a picture holds to what the texture does. */
static void decode_picture(struct import *m, const char *path, uint32_t group, slv_image *image) {
    int32_t alpha = m->source->alpha_channel - (int32_t)(group * SLVI_INDEX_GROUP);
    slv_texture_encoding encoding = image->encoding;
    if (image->encoding_is_assumed && m->exchange->images_encoding == SLV_TEXTURE_LINEAR) {
        encoding = SLV_TEXTURE_LINEAR;
        slvi_import_note(&m->unsaid, path);
    }
    slvi_exchange_change(encoding, m->encoding, image->nchannels,
                         m->source->alpha_channel < 0 ? SLV_NO_ALPHA : alpha, image->pixels,
                         (uint64_t)image->width * image->height);
}

static slv_result load_images(struct import *m, const json_t *names, const char *what) {
    uint32_t nchannels = m->source->nchannels;
    slv_result result = SLV_OK;
    for (uint32_t group = 0; group < slvi_index_groups(nchannels) && !result; group++) {
        const char *name = json_string_value(json_array_get(names, group));
        slv_image *image = &m->images[group];
        char path[2200];
        slv_image_free(image);
        if (!name)
            return slvi_fail(m->env, SLV_ERROR_FORMAT, "%s: %s: image %u of %u is missing",
                             m->index, what, group, slvi_index_groups(nchannels));
        if (snprintf(path, sizeof path, "%s%s", name[0] == '/' ? "" : m->exchange->index_folder,
                     name) >= (int)sizeof path)
            return slvi_fail(m->env, SLV_ERROR_FORMAT, "%s: %s: the name of an image is too long",
                             m->index, what);
        result = slv_image_load(m->env, path, image);
        if (!result)
            result = slvi_import_fit(m->env, path, slvi_index_group_size(nchannels, group), image,
                                     &m->dropped, &m->added);
        if (!result)
            decode_picture(m, path, group, image);
        if (!result && group &&
            (image->width != m->images[0].width || image->height != m->images[0].height))
            result =
                slvi_fail(m->env, SLV_ERROR_MISMATCH,
                          "%s: is %u x %u, the image of the first channels %u x %u", path,
                          image->width, image->height, m->images[0].width, m->images[0].height);
    }
    return result;
}

static slv_result reserve(struct import *m, size_t count) {
    slv_result result;
    if (count <= m->capacity)
        return SLV_OK;
    slvi_free(m->values);
    slvi_free(m->texels);
    m->capacity = 0;
    m->values = m->texels = NULL;
    if ((result = slvi_alloc_plain(m->env, m->index, count, sizeof *m->values, &m->values)) ||
        (result =
             slvi_alloc_plain(m->env, m->index, count, slv_type_size(m->source->type), &m->texels)))
        return result;
    m->capacity = count;
    return SLV_OK;
}

/* A rectangle of the images as the texels of a face. */
static slv_result take(struct import *m, slv_res res, uint32_t x, uint32_t y) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, nchannels = m->source->nchannels;
    slv_result result = reserve(m, w * h * nchannels);
    if (result)
        return result;
    for (uint32_t group = 0; group < slvi_index_groups(m->source->nchannels); group++) {
        const slv_image *image = &m->images[group];
        size_t n = slvi_index_group_size(m->source->nchannels, group);
        for (size_t i = 0; i < w * h; i++) {
            const float *from =
                image->pixels + ((y + h - 1 - i / w) * image->width + x + i % w) * image->nchannels;
            float *to = m->values + i * nchannels + group * SLVI_INDEX_GROUP;
            memcpy(to, from, n * sizeof *to);
        }
    }
    slv_type_from_float(m->source->type, m->values, w * h * nchannels, m->texels);
    return SLV_OK;
}

/* The face's own picture decides how large it is; one texel is a constant face of the index's size.
 */
static slv_result take_picture(struct import *m, uint32_t face, const json_t *item,
                               slv_ptx_face *info) {
    char what[32];
    snprintf(what, sizeof what, "face %u", face);
    slv_result result = load_images(m, json_object_get(item, "images"), what);
    if (result)
        return result;
    int u = slv_res_log2(m->images[0].width), v = slv_res_log2(m->images[0].height);
    if (u < 0 || v < 0 || (m->source->mesh_type == SLV_PTX_TRIANGLE && u != v))
        return slvi_fail(m->env, SLV_ERROR_MISMATCH,
                         "%s: face %u: its image is %u x %u, which is not %s", m->index, face,
                         m->images[0].width, m->images[0].height,
                         u < 0 || v < 0 ? "made of powers of two" : "square");
    slv_res res = {(int8_t)u, (int8_t)v};
    info->flags &= (uint8_t)~SLV_FACE_CONSTANT;
    if (u == 0 && v == 0)
        info->flags |= SLV_FACE_CONSTANT;
    else
        info->res = res;
    return take(m, res, 0, 0);
}

static slv_result take_from_sheet(struct import *m, uint32_t face, const json_t *item,
                                  slv_ptx_face *info) {
    slv_res res = info->flags & SLV_FACE_CONSTANT ? (slv_res){0, 0} : info->res;
    const json_t *left = json_object_get(item, "x"), *top = json_object_get(item, "y");
    if (!json_is_integer(left) || !json_is_integer(top))
        return slvi_fail(m->env, SLV_ERROR_FORMAT, "%s: face %u: %s is missing, or is no integer",
                         m->index, face, json_is_integer(left) ? "y" : "x");
    json_int_t x = json_integer_value(left), y = json_integer_value(top);
    json_int_t width = m->images[0].width, height = m->images[0].height;
    if (x < 0 || y < 0 || x > width || y > height || (json_int_t)1 << res.u > width - x ||
        (json_int_t)1 << res.v > height - y)
        return slvi_fail(m->env, SLV_ERROR_FORMAT,
                         "%s: face %u: lies outside of the sheet of %lld x %lld", m->index, face,
                         (long long)width, (long long)height);
    return take(m, res, (uint32_t)x, (uint32_t)y);
}

static slv_result import_face(struct import *m, const slvi_exchange_plan *plan,
                              slv_ptx_writer *writer, uint32_t face) {
    const json_t *item = json_array_get(m->faces, face);
    slv_ptx_face info;
    void *own = NULL;
    slv_result result = slvi_index_read_face(m->env, m->index, item, face, m->source, &info);
    if (!result)
        result =
            m->sheet ? take_from_sheet(m, face, item, &info) : take_picture(m, face, item, &info);
    const void *texels = m->texels;
    if (!result && !(result = slvi_exchange_face(m->env, plan, face, &info, &texels, &own)))
        result = slv_ptx_writer_write_face(writer, face, &info, texels);
    slvi_free(own);
    return result;
}

slv_result slvi_exchange_import(const slv_env *env, const slv_exchange *source,
                                const slv_exchange_params *params, const slvi_exchange_plan *plan,
                                const char *path) {
    struct import m = {.env = env,
                       .exchange = source,
                       .index = source->index_path,
                       .faces = json_object_get(source->index, "faces"),
                       .source = &source->params,
                       .encoding = plan->encoding};
    const json_t *sheets = json_object_get(source->index, "images");
    uint32_t ngroups = slvi_index_groups(source->params.nchannels);
    slv_ptx_writer *writer = NULL;
    m.sheet = json_array_size(sheets) > 0;
    slv_result result = slvi_alloc(env, m.index, ngroups, sizeof *m.images, &m.images);
    if (result || (m.sheet && (result = load_images(&m, sheets, "the sheet"))) ||
        (result = slv_ptx_writer_create(env, path, &plan->target, &writer)) ||
        (!params->no_meta &&
         (result = slvi_index_read_meta(env, m.index, source->index, writer))) ||
        (slvi_exchange_needs_note(plan) && (result = slvi_exchange_note_encoding(plan, writer))) ||
        (params->mesh && (result = slv_ptx_writer_set_mesh(writer, params->mesh))))
        goto done;
    for (uint32_t face = 0; face < source->params.nfaces; face++)
        if ((result = slvi_exchange_visited(env, plan, import_face(&m, plan, writer, face))))
            goto done;
    if (!(result = slv_ptx_writer_finish(writer)))
        slvi_import_warn(env, &m.dropped, &m.added, &m.unsaid);
done:
    slv_ptx_writer_destroy(writer);
    for (uint32_t group = 0; m.images && group < ngroups; group++)
        slv_image_free(&m.images[group]);
    slvi_free(m.images);
    slvi_free(m.values);
    slvi_free(m.texels);
    return result;
}
