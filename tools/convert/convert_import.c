#include "convert/convert_index.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct import {
    const slv_env *env;
    const char *index;
    char folder[1024]; /* of the index, with its slash */
    json_t *root;
    const json_t *faces;
    const slv_ptx_writer_params *source;
    slv_image *images; /* one a group */
    bool sheet;
    float *values;
    void *texels;
    size_t capacity;
};

static slv_result load_images(struct import *m, const json_t *names, const char *what) {
    uint32_t nchannels = m->source->nchannels;
    slv_result result = SLV_OK;
    for (uint32_t group = 0; group < index_groups(nchannels) && !result; group++) {
        const char *name = json_string_value(json_array_get(names, group));
        slv_image *image = &m->images[group];
        char path[2200];
        slv_image_free(image);
        if (!name)
            return output_fail(m->env, SLV_ERROR_FORMAT, "%s: %s: image %u of %u is missing",
                               m->index, what, group, index_groups(nchannels));
        if (snprintf(path, sizeof path, "%s%s", name[0] == '/' ? "" : m->folder, name) >=
            (int)sizeof path)
            return output_fail(m->env, SLV_ERROR_FORMAT, "%s: %s: the name of an image is too long",
                               m->index, what);
        result = slv_image_load(m->env, path, image);
        uint32_t needed = index_group_size(nchannels, group);
        if (!result && image->nchannels < needed && image->nchannels != 1)
            result = output_fail(m->env, SLV_ERROR_MISMATCH,
                                 "%s: has %u channels, where %s of %s needs %u", path,
                                 image->nchannels, what, m->index, needed);
        if (!result && group &&
            (image->width != m->images[0].width || image->height != m->images[0].height))
            result =
                output_fail(m->env, SLV_ERROR_MISMATCH,
                            "%s: is %u x %u, the image of the first channels %u x %u", path,
                            image->width, image->height, m->images[0].width, m->images[0].height);
    }
    return result;
}

static slv_result reserve(struct import *m, size_t count, uint32_t face) {
    if (count <= m->capacity)
        return SLV_OK;
    free(m->values);
    free(m->texels);
    m->capacity = 0;
    m->values = malloc(count * sizeof *m->values);
    m->texels = malloc(count * slv_type_size(m->source->type));
    if (!m->values || !m->texels)
        return output_fail(m->env, SLV_ERROR_MEMORY, "face %u: no memory for its texels", face);
    m->capacity = count;
    return SLV_OK;
}

/* A rectangle of the images as the texels of a face. */
static slv_result take(struct import *m, uint32_t face, slv_res res, uint32_t x, uint32_t y) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, nchannels = m->source->nchannels;
    slv_result result = reserve(m, w * h * nchannels, face);
    if (result)
        return result;
    for (uint32_t group = 0; group < index_groups(m->source->nchannels); group++) {
        const slv_image *image = &m->images[group];
        size_t n = index_group_size(m->source->nchannels, group);
        for (size_t i = 0; i < w * h; i++) {
            const float *from =
                image->pixels + ((y + h - 1 - i / w) * image->width + x + i % w) * image->nchannels;
            float *to = m->values + i * nchannels + group * INDEX_GROUP;
            /* a grey picture stands for all channels: programs like to save it that way */
            for (size_t c = 0; c < n; c++)
                to[c] = from[c < image->nchannels ? c : 0];
        }
    }
    slv_type_from_float(m->source->type, m->values, w * h * nchannels, m->texels);
    return SLV_OK;
}

static int log2_of(uint32_t size) {
    for (int log2 = 0; log2 <= SLV_MAX_LOG2_RES; log2++)
        if (size == 1u << log2)
            return log2;
    return -1;
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
    int u = log2_of(m->images[0].width), v = log2_of(m->images[0].height);
    if (u < 0 || v < 0 || (m->source->mesh_type == SLV_PTX_TRIANGLE && u != v))
        return output_fail(m->env, SLV_ERROR_MISMATCH,
                           "%s: face %u: its image is %u x %u, which is not %s", m->index, face,
                           m->images[0].width, m->images[0].height,
                           u < 0 || v < 0 ? "made of powers of two" : "square");
    slv_res res = {(int8_t)u, (int8_t)v};
    info->flags &= (uint8_t)~SLV_FACE_CONSTANT;
    if (u == 0 && v == 0)
        info->flags |= SLV_FACE_CONSTANT;
    else
        info->res = res;
    return take(m, face, res, 0, 0);
}

static slv_result take_from_sheet(struct import *m, uint32_t face, const json_t *item,
                                  slv_ptx_face *info) {
    slv_res res = info->flags & SLV_FACE_CONSTANT ? (slv_res){0, 0} : info->res;
    const json_t *left = json_object_get(item, "x"), *top = json_object_get(item, "y");
    if (!json_is_integer(left) || !json_is_integer(top))
        return output_fail(m->env, SLV_ERROR_FORMAT, "%s: face %u: %s is missing, or is no integer",
                           m->index, face, json_is_integer(left) ? "y" : "x");
    json_int_t x = json_integer_value(left), y = json_integer_value(top);
    json_int_t width = m->images[0].width, height = m->images[0].height;
    if (x < 0 || y < 0 || x > width || y > height || (json_int_t)1 << res.u > width - x ||
        (json_int_t)1 << res.v > height - y)
        return output_fail(m->env, SLV_ERROR_FORMAT,
                           "%s: face %u: lies outside of the sheet of %lld x %lld", m->index, face,
                           (long long)width, (long long)height);
    return take(m, face, res, (uint32_t)x, (uint32_t)y);
}

static slv_result import_face(struct import *m, const convert_plan *plan, slv_ptx_writer *writer,
                              uint32_t face) {
    const json_t *item = json_array_get(m->faces, face);
    slv_ptx_face info;
    void *own = NULL;
    slv_result result = index_read_face(m->env, m->index, item, face, m->source, &info);
    if (!result)
        result =
            m->sheet ? take_from_sheet(m, face, item, &info) : take_picture(m, face, item, &info);
    const void *texels = m->texels;
    if (!result && !(result = convert_face(m->env, plan, face, &info, &texels, &own)))
        result = slv_ptx_writer_write_face(writer, face, &info, texels);
    free(own);
    return result;
}

static slv_result open_index(struct import *m, const char *given, char *index, size_t size) {
    struct stat status;
    json_error_t error;
    bool folder = stat(given, &status) == 0 && S_ISDIR(status.st_mode);
    if (snprintf(index, size, "%s%s", given, folder ? "/index.json" : "") >= (int)size)
        return output_fail(m->env, SLV_ERROR_IO, "%s: the name is too long", given);
    snprintf(m->folder, sizeof m->folder, "%s", index);
    char *slash = strrchr(m->folder, '/');
    slash ? (slash[1] = 0) : (m->folder[0] = 0);
    m->index = index;
    errno = 0;
    m->root = json_load_file(index, JSON_REJECT_DUPLICATES, &error);
    int reason = errno;
    if (!m->root && error.line < 0 && reason)
        return output_fail(m->env, SLV_ERROR_IO, "%s: %s", index, strerror(reason));
    if (!m->root)
        return output_fail(m->env, SLV_ERROR_FORMAT, "%s:%d: %s", index, error.line, error.text);
    m->faces = json_object_get(m->root, "faces");
    return SLV_OK;
}

int convert_from_index(const cli_command *command, const slv_env *env,
                       const convert_options *options, const slv_mesh *mesh, const char *given,
                       const char *path, convert_totals *totals, convert_plan *plan) {
    struct import m = {.env = env};
    slv_ptx_writer_params source;
    slv_ptx_writer *writer = NULL;
    char index[1024];
    int code = EXIT_FAILED;
    if (open_index(&m, given, index, sizeof index) ||
        index_read_params(env, index, m.root, &source))
        goto done;
    m.source = &source;
    if ((code = convert_plan_make(command, options, given, &source, totals, plan)))
        goto done;
    code = EXIT_FAILED;
    totals->progress.total = source.nfaces;
    m.images = calloc(index_groups(source.nchannels), sizeof *m.images);
    if (!m.images) {
        output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its images", index);
        goto done;
    }
    const json_t *sheets = json_object_get(m.root, "images");
    m.sheet = json_array_size(sheets) > 0;
    if ((m.sheet && load_images(&m, sheets, "the sheet")) ||
        slv_ptx_writer_create(env, path, &plan->target, &writer) ||
        (!options->no_meta && index_read_meta(env, index, m.root, writer)) ||
        (mesh && slv_ptx_writer_set_mesh(writer, mesh)))
        goto done;
    for (uint32_t face = 0; face < source.nfaces; face++)
        if (import_face(&m, plan, writer, face))
            goto done;
    if (slv_ptx_writer_finish(writer) == SLV_OK)
        code = EXIT_OK;
done:
    slv_ptx_writer_destroy(writer);
    for (uint32_t group = 0; m.images && group < index_groups(source.nchannels); group++)
        slv_image_free(&m.images[group]);
    free(m.images);
    free(m.values);
    free(m.texels);
    json_decref(m.root);
    return code;
}
