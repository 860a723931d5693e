/* The keys of a script's lines that say how paint is laid: inks, masks and symmetry. */
#include "script/script_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

/* Images that a script may name, all together. */
#define MOST_PIXELS (UINT64_C(1) << 28)

static slv_result wrong(const slvi_reading *r, const char *key, const char *expected) {
    return slvi_script_wrong(r, key, expected);
}

/* Colours divided by alpha: an OpenEXR file has them multiplied. */
static void unmultiply(slv_image *image) {
    uint32_t n = image->nchannels;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        float *p = image->pixels + i * n, alpha = p[n - 1];
        for (uint32_t c = 0; alpha > 0 && c + 1 < n; c++)
            p[c] /= alpha;
    }
}

/* The image of a name, read when it is first asked for. */
static slv_result image_of(const slvi_reading *r, const char *name, const slv_image **out) {
    slv_script *s = r->script;
    char *path = NULL, *key = NULL;
    slv_image *image = NULL;
    slv_result result;
    for (uint32_t i = 0; i < s->nimages; i++)
        if (strcmp(s->images[i].key, name) == 0) {
            *out = s->images[i].image;
            return SLV_OK;
        }
    if ((result = slvi_script_path(s, name, &path)) ||
        (result = slvi_script_copy(&s->env, name, &key)) ||
        (result = slvi_alloc(&s->env, "script", 1, sizeof *image, &image)) ||
        (result = slv_image_load(&s->env, path, image)) ||
        (result =
             slvi_grow(&s->env, "script", (uint64_t)s->nimages + 1, sizeof *s->images, &s->images)))
        goto done;
    s->pixels += (uint64_t)image->width * image->height;
    if (s->pixels > MOST_PIXELS) {
        s->pixels -= (uint64_t)image->width * image->height;
        result =
            slvi_fail(&s->env, SLV_ERROR_LIMIT, "%s: line %llu: %s: more than %llu pixels", s->name,
                      (unsigned long long)r->number, path, (unsigned long long)MOST_PIXELS);
        goto done;
    }
    if ((image->nchannels == 2 || image->nchannels == 4) &&
        slv_image_format_of_name(path) == SLV_IMAGE_EXR)
        unmultiply(image);
    s->images[s->nimages++] = (slvi_script_image){key, image};
    *out = image;
    key = NULL;
    image = NULL;
done:
    if (image)
        slv_image_free(image);
    slvi_free(image);
    slvi_free(key);
    slvi_free(path);
    return result;
}

void slvi_script_free_images(slv_script *script) {
    for (uint32_t i = 0; i < script->nimages; i++) {
        slvi_free(script->images[i].key);
        slv_image_free(script->images[i].image);
        slvi_free(script->images[i].image);
    }
    slvi_free(script->images);
}

/* An optional number of an object. */
static bool get(json_t *value, const char *key, double low, double high, float *out) {
    json_t *entry = json_object_get(value, key);
    return !entry || slvi_script_number(entry, low, high, out);
}

static bool get_flag(json_t *value, const char *key, bool *out) {
    json_t *entry = json_object_get(value, key);
    *out = json_is_true(entry);
    return !entry || json_is_boolean(entry);
}

/* null takes the ink away again. */
static bool is_none(const slvi_reading *r, json_t *value) {
    if (json_is_null(value))
        r->line->lay.ink = (slv_ink){0};
    return json_is_null(value);
}

slv_result slvi_script_read_stamp(slvi_reading *r, const char *key, json_t *value) {
    static const char *const known[] = {"file", "angle", "legible"};
    const char *file =
        json_string_value(json_is_object(value) ? json_object_get(value, "file") : value);
    slv_ink *ink = &r->line->lay.ink;
    if (is_none(r, value))
        return SLV_OK;
    *ink = (slv_ink){.kind = SLV_INK_STAMP};
    if (!file || (json_is_object(value) && (!slvi_script_knows(value, known, 3) ||
                                            !get(value, "angle", -36000, 36000, &ink->angle) ||
                                            !get_flag(value, "legible", &ink->legible))))
        return wrong(r, key, "the name of an image, or an object with file, angle and legible");
    return image_of(r, file, &ink->image);
}

slv_result slvi_script_read_image(slvi_reading *r, const char *key, json_t *value) {
    static const char *const known[] = {"file", "at", "width", "angle"};
    const char *file =
        json_string_value(json_is_object(value) ? json_object_get(value, "file") : value);
    slv_ink *ink = &r->line->lay.ink;
    json_t *at = json_object_get(value, "at");
    float place[2] = {0};
    if (is_none(r, value))
        return SLV_OK;
    *ink = (slv_ink){.kind = SLV_INK_IMAGE};
    r->line->image_at = at != NULL;
    if (!file || (at && !slvi_script_numbers(at, 2, 2, place)) ||
        (json_is_object(value) &&
         (!slvi_script_knows(value, known, 4) || !get(value, "width", 1e-3, 1e6, &ink->size) ||
          !get(value, "angle", -36000, 36000, &ink->angle))))
        return wrong(r, key,
                     "the name of an image, or an object with file, at [x, y], width and angle");
    ink->x = place[0];
    ink->y = place[1];
    return image_of(r, file, &ink->image);
}

slv_result slvi_script_read_gradient(slvi_reading *r, const char *key, json_t *value) {
    static const char *const known[] = {"from", "to", "color", "radial"};
    slv_ink *ink = &r->line->lay.ink;
    json_t *color = json_object_get(value, "color");
    if (is_none(r, value))
        return SLV_OK;
    *ink = (slv_ink){.kind = SLV_INK_GRADIENT};
    for (int c = 0; c < SLV_PAINT_CHANNELS; c++)
        ink->color[c] = 1;
    if (!slvi_script_knows(value, known, 4) ||
        !slvi_script_numbers(json_object_get(value, "from"), 3, 3, ink->from) ||
        !slvi_script_numbers(json_object_get(value, "to"), 3, 3, ink->to) ||
        !slvi_script_numbers(color, 1, SLV_PAINT_CHANNELS, ink->color) ||
        !get_flag(value, "radial", &ink->radial))
        return wrong(r, key,
                     "an object with two places, from and to, the color at the second, and "
                     "perhaps radial");
    for (size_t c = json_array_size(color); c < 3; c++)
        ink->color[c] = 0;
    return SLV_OK;
}

slv_result slvi_script_read_clone(slvi_reading *r, const char *key, json_t *value) {
    slv_ink *ink = &r->line->lay.ink;
    float v[3];
    if (is_none(r, value))
        return SLV_OK;
    *ink = (slv_ink){.kind = SLV_INK_CLONE};
    json_t *first = json_array_get(value, 0);
    if (!slvi_script_numbers(value, 3, 3, v) || !json_is_integer(first) ||
        json_integer_value(first) < 0 || (uint64_t)json_integer_value(first) >= r->script->nfaces ||
        !(v[1] >= 0 && v[1] <= 1) || !(v[2] >= 0 && v[2] <= 1))
        return wrong(r, key, "[face, u, v]");
    ink->source = (slv_surface_point){(int32_t)json_integer_value(first), v[1], v[2]};
    return SLV_OK;
}

/* What there is less of than was asked for. */
static slv_result too_large(const slvi_reading *r, const char *key, const char *what, double number,
                            unsigned count) {
    return slvi_fail(&r->script->env, SLV_ERROR_FORMAT,
                     "%s: line %llu: %s: there is no %s %g, they are 0 to %u", r->script->name,
                     (unsigned long long)r->number, key, what, number, count - 1);
}

/* Faces that a mask names, in bytes of the line's. */
static slv_result read_faces(slvi_reading *r, const char *key, json_t *list) {
    slv_script *s = r->script;
    json_t *entry;
    size_t i;
    if (!json_is_array(list))
        return wrong(r, key, "faces as a list of their numbers");
    memset(s->line_faces, 0, s->nfaces);
    json_array_foreach(list, i, entry) {
        json_int_t face = json_integer_value(entry);
        if (!json_is_integer(entry))
            return wrong(r, key, "faces as a list of their numbers");
        if (face < 0 || (uint64_t)face >= s->nfaces)
            return too_large(r, key, "face", (double)face, s->nfaces);
        s->line_faces[face] = 1;
    }
    r->line->lay.mask.faces = s->line_faces;
    return SLV_OK;
}

/* The layer that a mask reads, or this one. */
static slv_result read_layer(slvi_reading *r, const char *key, json_t *layer, bool of_mask) {
    slv_script *s = r->script;
    json_int_t id = json_integer_value(layer);
    slv_canvas_desc desc;
    slv_result result = SLV_OK;
    r->line->masked = true;
    r->line->mask_canvas = s->inner;
    if (layer && (!json_is_integer(layer) || id < 1 || id > UINT32_MAX))
        return wrong(r, key, "layer as its id");
    if (layer && !s->params.layer)
        return wrong(r, key, "no layer: there are none here");
    if (layer)
        result = s->params.layer(s->params.user, (uint32_t)id, of_mask, &r->line->mask_canvas);
    if (!result)
        result = r->line->mask_canvas.fns->describe(r->line->mask_canvas.user, &desc);
    if (!result && r->line->lay.mask.channel >= desc.nchannels)
        return too_large(r, key, "channel", r->line->lay.mask.channel, desc.nchannels);
    return result;
}

slv_result slvi_script_read_where(slvi_reading *r, const char *key, json_t *value) {
    static const char *const known[] = {"faces",   "towards", "degrees", "facing",
                                        "channel", "layer",   "mask",    "inverse"};
    slv_mask *mask = &r->line->lay.mask;
    json_t *faces = json_object_get(value, "faces"), *layer = json_object_get(value, "layer"),
           *channel = json_object_get(value, "channel"),
           *towards = json_object_get(value, "towards");
    slv_result result;
    bool of_mask;
    float number = 0;
    *mask = (slv_mask){0};
    r->line->facing = r->line->masked = false;
    if (json_is_null(value))
        return SLV_OK;
    if (!slvi_script_knows(value, known, 8))
        return wrong(r, key,
                     "an object with faces, towards [x, y, z] and degrees, facing, or "
                     "layer, mask, channel and inverse");
    if (!get_flag(value, "facing", &r->line->facing) || !get_flag(value, "mask", &of_mask) ||
        !get_flag(value, "inverse", &mask->inverse))
        return wrong(r, key, "facing, mask and inverse as true or false");
    if (!get(value, "degrees", 1e-3, 180, &mask->degrees))
        return wrong(r, key, "degrees as a number, more than 0 and up to 180");
    if (!get(value, "channel", 0, 65535, &number) || number != floorf(number))
        return wrong(r, key, "channel as its number, from 0 on");
    if (towards &&
        (!slvi_script_numbers(towards, 3, 3, mask->towards) ||
         !(fabsf(mask->towards[0]) + fabsf(mask->towards[1]) + fabsf(mask->towards[2]) > 0)))
        return wrong(r, key, "towards as three numbers, a direction");
    if ((towards != NULL) != (mask->degrees > 0))
        return wrong(r, key, "towards and degrees together");
    mask->channel = (uint32_t)number;
    if (faces && (result = read_faces(r, key, faces)))
        return result;
    return layer || channel ? read_layer(r, key, layer, of_mask) : SLV_OK;
}

/* A face and its edge; `*fine` if they are numbers. */
static slv_result read_edge(const slvi_reading *r, const char *key, json_t *face, json_t *edge,
                            uint32_t *f, unsigned *e, bool *fine) {
    json_int_t a = json_integer_value(face), b = json_integer_value(edge);
    *f = (uint32_t)a;
    *e = (unsigned)b;
    *fine = *fine && json_is_integer(face) && json_is_integer(edge);
    if (*fine && (a < 0 || (uint64_t)a >= r->script->nfaces))
        return too_large(r, key, "face", (double)a, r->script->nfaces);
    return *fine && (b < 0 || b > 3) ? too_large(r, key, "edge", (double)b, 4) : SLV_OK;
}

/* The two edges that are each other's images. */
static slv_result read_edges(slvi_reading *r, const char *key, json_t *value, uint32_t face[2],
                             unsigned edge[2]) {
    static const char *const known[] = {"face", "edge", "pair"};
    const slv_adjacency *adjacency =
        slv_paint_surface_adjacency(slv_painter_get_surface(r->script->painter));
    json_t *pair = json_object_get(value, "pair");
    slv_neighbour list[2];
    bool fine = slvi_script_knows(value, known, 3) && (!pair || json_array_size(pair) == 2);
    slv_result result = SLV_OK;
    for (size_t i = 0; pair && fine && i < 2 && !result; i++) {
        json_t *one = json_array_get(pair, i);
        fine = json_array_size(one) == 2;
        result = read_edge(r, key, json_array_get(one, 0), json_array_get(one, 1), &face[i],
                           &edge[i], &fine);
    }
    if (!pair && fine)
        result = read_edge(r, key, json_object_get(value, "face"), json_object_get(value, "edge"),
                           &face[0], &edge[0], &fine);
    if (result)
        return result;
    if (!fine)
        return wrong(r, key,
                     "an object with face and edge, of the middle line, or a pair "
                     "[[face, edge], [face, edge]]");
    if (pair)
        return SLV_OK;
    if (slv_adjacency_neighbours(adjacency, (int32_t)face[0], edge[0], list) != 1)
        return wrong(r, key, "an edge between two faces");
    face[1] = (uint32_t)list[0].face;
    edge[1] = list[0].edge;
    return SLV_OK;
}

slv_result slvi_script_read_symmetry(slvi_reading *r, const char *key, json_t *value) {
    slv_script *s = r->script;
    const slv_adjacency *adjacency =
        slv_paint_surface_adjacency(slv_painter_get_surface(s->painter));
    uint32_t face[2];
    unsigned edge[2];
    slv_result result;
    r->line->lay.symmetry = NULL;
    if (json_is_null(value))
        return SLV_OK;
    if ((result = read_edges(r, key, value, face, edge)))
        return result;
    const uint32_t named[4] = {face[0], edge[0], face[1], edge[1]};
    if (!s->symmetry || memcmp(named, s->symmetry_of, sizeof named) != 0) {
        slv_symmetry *made;
        if ((result = slv_symmetry_create(&s->env, adjacency, face, edge, &made, NULL)))
            return result;
        /* what was set before may still be meant by what comes after */
        slv_symmetry_destroy(s->old_symmetry);
        s->old_symmetry = s->symmetry;
        if (s->set.lay.symmetry && s->set.lay.symmetry != s->old_symmetry)
            s->set.lay.symmetry = NULL;
        s->symmetry = made;
        memcpy(s->symmetry_of, named, sizeof named);
    }
    r->line->lay.symmetry = s->symmetry;
    return SLV_OK;
}

slv_result slvi_script_finish_lay(slvi_reading *r) {
    slvi_line *line = r->line;
    slv_ink *ink = &line->lay.ink;
    const slv_stroke_params *s = &line->stroke;
    line->lay.mask.facing = line->facing ? &s->camera : NULL;
    line->lay.mask.canvas = line->masked ? &line->mask_canvas : NULL;
    if ((ink->kind == SLV_INK_IMAGE || line->facing) && !s->in_picture)
        return wrong(r, ink->kind == SLV_INK_IMAGE ? "image" : "where",
                     "a camera and a size of the picture beside it");
    if (ink->kind != SLV_INK_IMAGE)
        return SLV_OK;
    ink->camera = s->camera;
    ink->width = s->width;
    ink->height = s->height;
    if (!line->image_at) {
        ink->x = 0.5f * (float)s->width;
        ink->y = 0.5f * (float)s->height;
    }
    if (!(ink->size > 0)) /* as large as fits */
        ink->size = fminf((float)s->width,
                          (float)s->height * (float)ink->image->width / (float)ink->image->height);
    return SLV_OK;
}
