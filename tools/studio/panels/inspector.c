/* The face under the pointer, and what drawing takes. */
#include "studio/studio.h"

#include <math.h>
#include <string.h>

enum { DENSITY_LINE = 3 }; /* of the words about a face */
enum { MOST_LOG2 = 14 };   /* texels of a face whose statistics are shown */

GtkWidget *studio_panel_inspector(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 6);
    GtkWidget **labels[] = {&app->inspector, &app->live};
    for (int i = 0; i < 2; i++) {
        *labels[i] = gtk_label_new("");
        gtk_label_set_xalign(GTK_LABEL(*labels[i]), 0);
        gtk_label_set_wrap(GTK_LABEL(*labels[i]), TRUE);
        gtk_widget_add_css_class(*labels[i], "monospace");
        gtk_box_append(GTK_BOX(box), *labels[i]);
    }
    return box;
}

static void put_texel(GString *text, const slv_texture *texture, const slv_paint_hit *hit) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    uint32_t face = (uint32_t)hit->point.face;
    slv_res res = slv_texture_is_constant(texture, face) ? (slv_res){0, 0} : desc->res[face];
    uint32_t w = 1u << res.u, h = 1u << res.v;
    float *texel = g_new0(float, desc->nchannels);
    slv_texture_fetch(texture, face, MIN((uint32_t)(hit->point.u * (float)w), w - 1),
                      MIN((uint32_t)(hit->point.v * (float)h), h - 1), texel);
    g_string_append(text, "\ntexel");
    for (uint32_t c = 0; c < desc->nchannels && c < 8; c++)
        g_string_append_printf(text, " %.3f", (double)texel[c]);
    g_free(texel);
}

/* Least, mean and greatest value of each channel, of faces that can be gone over while the pointer
 * moves. */
static void put_statistics(GString *text, const slv_texture *texture, uint32_t face) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    const slv_res res = desc->res[face];
    const uint32_t w = 1u << res.u, h = 1u << res.v, n = desc->nchannels;
    if (slv_texture_is_constant(texture, face) || res.u + res.v > MOST_LOG2)
        return;
    float *texel = g_new0(float, n);
    double *sums = g_new0(double, 3 * (size_t)n), *low = sums + n, *high = low + n;
    for (uint32_t i = 0; i < w * h; i++) {
        slv_texture_fetch(texture, face, i % w, i / w, texel);
        for (uint32_t c = 0; c < n; c++) {
            sums[c] += (double)texel[c];
            low[c] = i ? fmin(low[c], (double)texel[c]) : (double)texel[c];
            high[c] = i ? fmax(high[c], (double)texel[c]) : (double)texel[c];
        }
    }
    for (uint32_t c = 0; c < n && c < 4; c++)
        g_string_append_printf(text, "\n%u: %.3f to %.3f, mean %.3f", c, low[c], high[c],
                               sums[c] / ((double)w * h));
    g_free(sums);
    g_free(texel);
}

static void show_face(studio_app *app) {
    slv_paint_hit hit;
    uint32_t width, height;
    slv_camera camera = studio_area_camera(app, &width, &height);
    studio_document *d = &app->document;
    if (!app->pointer_inside ||
        !studio_document_pick(d, &camera, width, height, (float)app->x, (float)app->y, &hit)) {
        gtk_label_set_text(GTK_LABEL(app->inspector), "no face under the pointer");
        return;
    }
    const uint32_t face = (uint32_t)hit.point.face;
    const slv_res res = slv_texture_get_desc(d->texture)->res[face];
    const slv_face_adjacency *a = &slv_adjacency_faces(studio_document_adjacency(d))[face];
    GString *text = g_string_new("");
    g_string_printf(text, "face %u, %u x %u texels%s\nu %.3f v %.3f\nneighbours", face, 1u << res.u,
                    1u << res.v, slv_texture_is_constant(d->texture, face) ? ", constant" : "",
                    (double)hit.point.u, (double)hit.point.v);
    for (int e = 0; e < 4; e++) {
        if (a->face[e] < 0)
            g_string_append(text, " -");
        else
            g_string_append_printf(text, " %d:%u", (int)a->face[e], a->edge[e]);
    }
    g_string_append_printf(text, "\n%.4g texels a unit", (double)studio_document_density(d, face));
    if (app->tool == STUDIO_TEXELS && app->density > 0)
        g_string_append_printf(text, ", aim %.4g", (double)app->density);
    put_texel(text, d->texture, &hit);
    put_statistics(text, d->texture, face);
    g_string_append_printf(text, "\npressure %.2f tilt %.2f %.2f", (double)app->pressure,
                           (double)app->tilt[0], (double)app->tilt[1]);
    gtk_label_set_text(GTK_LABEL(app->inspector), text->str);
    g_string_free(text, TRUE);
}

/* In one line, since the panel may be scrolled away; with the resolution brush the density too. */
static void show_status(studio_app *app) {
    char **words = g_strsplit(gtk_label_get_text(GTK_LABEL(app->inspector)), "\n", -1);
    const bool density = app->tool == STUDIO_TEXELS && g_strv_length(words) > DENSITY_LINE;
    char *text =
        g_strdup_printf("%s%s%s   |   %.1f ms a picture   |   %s", words[0] ? words[0] : "",
                        density ? ", " : "", density ? words[DENSITY_LINE] : "",
                        1e3 * app->stats.seconds, studio_picture_info(app->picture)->renderer);
    gtk_label_set_text(GTK_LABEL(app->status), text);
    g_free(text);
    g_strfreev(words);
}

void studio_panel_inspector_sync(studio_app *app) {
    char text[512], times[64], seams[2][64];
    const studio_picture_stats *s = &app->stats;
    double cpu, gpu;
    if (!app->document.texture || !app->picture)
        return;
    if (app->drag == STUDIO_DRAG_NONE || app->drag == STUDIO_DRAG_TEXELS)
        show_face(app);
    gtk_gl_area_make_current(app->area);
    studio_picture_times(app->picture, &cpu, &gpu);
    studio_log(app, "\"event\":\"times\",\"cpu_ms\":%.3f,\"gpu_ms\":%.3f", 1e3 * cpu, 1e3 * gpu);
    snprintf(times, sizeof times,
             gpu < 0 ? "CPU %.1f ms, GPU not told" : "CPU %.1f ms, GPU %.1f ms", 1e3 * cpu,
             1e3 * gpu);
    for (int side = 0; side < 2; side++)
        studio_seam_words(app, side, seams[side], sizeof seams[side]);
    snprintf(
        text, sizeof text,
        "%s%s%s\n%s\n%.1f ms of texels\n%.1f MB on the GPU, %u draws\n%llu "
        "triangles%s\n%u faces widened%s%s",
        slv_strategy_at(app->look.strategy)->name, app->look.compare != STUDIO_WHOLE ? " and " : "",
        app->look.compare != STUDIO_WHOLE ? slv_strategy_at(app->look.other)->name : "", times,
        1e3 * s->update, (double)s->gpu_bytes / 1e6, s->draws, (unsigned long long)s->triangles,
        app->refined ? ", refined" : "", s->widened, seams[0], seams[1]);
    gtk_label_set_text(GTK_LABEL(app->live), text);
    show_status(app);
}
