/* Actions that give faces more texels, or fewer: by steps, or so many a unit. */
#include "studio/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the studio gives faces: with more a dab could take seconds. What a file has already stays.
 */
enum { MOST_LOG2 = 10, MOST_TEXELS = 1 << 24 };

static int8_t other_size(int8_t size, int by) {
    return (int8_t)MAX(size + MIN(by, MAX(MOST_LOG2 - size, 0)), 0);
}

/* Of the document, when these faces have other sizes; of none: as it is. */
static uint64_t texels_with(const slv_texture_desc *desc, uint32_t count, const uint32_t *faces,
                            const slv_res *res) {
    uint64_t total = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        total += UINT64_C(1) << (desc->res[f].u + desc->res[f].v);
    for (uint32_t i = 0; i < count; i++)
        total += (UINT64_C(1) << (res[i].u + res[i].v)) -
                 (UINT64_C(1) << (desc->res[faces[i]].u + desc->res[faces[i]].v));
    return total;
}

/* Of the document, and of the layer that is painted on: more texels of one alone would not show. */
static void resize(studio_app *app, uint32_t count, const uint32_t *faces, const int *by) {
    slv_layer_info info;
    uint32_t index;
    slv_document *layers = studio_layers_of(app);
    if (!count || !layers || !studio_layer_now(app, &info, &index))
        return;
    const slv_texture_desc *desc = slv_document_get_desc(layers);
    slv_res *res = g_new(slv_res, count), *own = g_new(slv_res, count);
    bool changes = false;
    for (uint32_t i = 0; i < count; i++) {
        const slv_res flat = desc->res[faces[i]], layer = info.res[faces[i]];
        res[i] = (slv_res){other_size(flat.u, by[i]), other_size(flat.v, by[i])};
        own[i] = (slv_res){other_size(layer.u, by[i]), other_size(layer.v, by[i])};
        changes = changes || memcmp(&res[i], &flat, sizeof flat) != 0;
    }
    slv_result result = SLV_OK;
    const uint64_t texels = texels_with(desc, count, faces, res);
    if (!changes) {
        studio_say(app,
                   "These faces have as many texels as they are given here: 1 to 1024 each way.",
                   NULL, NULL);
    } else if (texels > MOST_TEXELS && texels > texels_with(desc, 0, NULL, NULL)) {
        studio_say(
            app, "That would be more than 16 million texels, which could not be painted fluently.",
            NULL, NULL);
    } else if (slv_document_resize_bytes(layers, 0, count, faces, res) > slv_memory_available()) {
        studio_say(app, "There is not enough memory for that many texels.", NULL, NULL);
    } else if (!(result = slv_document_begin(layers, "texels"))) {
        if (!(result = slv_document_resize(layers, 0, count, faces, res)) && !info.props.locked)
            result = slv_document_resize(layers, info.id, count, faces, own);
        if (result)
            slv_document_cancel(layers);
        else
            result = slv_document_end(layers);
    }
    g_free(res);
    g_free(own);
    studio_edited(app, result);
}

static void resize_under(studio_app *app, int by) {
    slv_paint_hit hit;
    if (!studio_face_under(app, &hit))
        return;
    const uint32_t face = (uint32_t)hit.point.face;
    resize(app, 1, &face, &by);
}

/* All faces of a list of numbers by so many steps, or by as many as bring them to a density. */
static void resize_listed(studio_app *app, const char *target, int by, float density) {
    slv_document *layers = studio_layers_of(app);
    const uint32_t nfaces = layers ? slv_document_get_desc(layers)->nfaces : 0;
    GArray *faces = g_array_new(FALSE, FALSE, sizeof(uint32_t)),
           *steps = g_array_new(FALSE, FALSE, sizeof(int));
    int64_t last = -1;
    for (char *end; *target; target = end) {
        const uint32_t face = (uint32_t)strtoul(target, &end, 10);
        if (end == target || face >= nfaces || (int64_t)face <= last)
            break;
        last = face;
        const int step =
            density > 0
                ? (int)lroundf(log2f(density / studio_document_density(&app->document, face)))
                : by;
        if (!step)
            continue;
        g_array_append_val(faces, face);
        g_array_append_val(steps, step);
    }
    resize(app, faces->len, (const uint32_t *)(const void *)faces->data,
           (const int *)(const void *)steps->data);
    g_array_free(faces, TRUE);
    g_array_free(steps, TRUE);
}

void studio_do_texels_more(studio_app *app, const char *target) {
    (void)target;
    resize_under(app, 1);
}

void studio_do_texels_fewer(studio_app *app, const char *target) {
    (void)target;
    resize_under(app, -1);
}

void studio_do_faces_finer(studio_app *app, const char *target) {
    resize_listed(app, target, 1, 0);
}

void studio_do_faces_coarser(studio_app *app, const char *target) {
    resize_listed(app, target, -1, 0);
}

/* The density, then the faces. */
void studio_do_faces_density(studio_app *app, const char *target) {
    char *end;
    const double density = g_ascii_strtod(target, &end);
    if (end != target && density > 0)
        resize_listed(app, end, 0, (float)density);
}

/* What the resolution brush aims for, in texels a unit of the mesh. */
static void aim(studio_app *app, float density) {
    char text[96];
    app->density = density;
    snprintf(text, sizeof text, "The resolution brush gives faces %.4g texels a unit.",
             (double)density);
    studio_say(app, density > 0 ? text : NULL, "Double and Halve Instead", "density-none");
}

void studio_do_density_take(studio_app *app, const char *target) {
    slv_paint_hit hit;
    (void)target;
    if (studio_layers_of(app) && studio_face_under(app, &hit)) {
        aim(app, studio_document_density(&app->document, (uint32_t)hit.point.face));
        app->tool = STUDIO_TEXELS;
    }
}

static void aim_by(studio_app *app, float factor) {
    if (app->density > 0)
        aim(app, app->density * factor);
    else
        studio_say(app, "Ctrl+T takes the texels of the face under the pointer as the aim.", NULL,
                   NULL);
}

void studio_do_density_more(studio_app *app, const char *target) {
    (void)target;
    aim_by(app, 1.41421356f);
}

void studio_do_density_less(studio_app *app, const char *target) {
    (void)target;
    aim_by(app, 0.70710678f);
}

void studio_do_density_none(studio_app *app, const char *target) {
    (void)target;
    aim(app, 0);
}
