/* The seam jump of what is shown, measured while nothing moves: faces after faces, each time as
 * many as take a moment, so that whoever goes on turning or painting does not wait. */
#include "studio/studio.h"

#include <math.h>
#include <string.h>

enum { PAUSE = 1000, SLICE = 12 }; /* milliseconds: of rest before; and of work at once */
enum { FEWEST = 32, MOST = 1 << 16 };

static bool measures(const studio_seam *s, const studio_seam *other) {
    return s->strategy == other->strategy && s->channel == other->channel &&
           s->anisotropy == other->anisotropy && s->other_levels == other->other_levels;
}

/* Of the left side, or of the other one that the look shows beside it; NULL: there is none. */
static studio_seam *seam_of(studio_app *app, int side) {
    const studio_look *look = &app->look;
    studio_seam *s = &app->seams[side];
    const studio_seam wanted = {.strategy = side ? look->other : look->strategy,
                                .channel = look->channel,
                                .anisotropy = look->anisotropy,
                                .other_levels = look->other_levels};
    if (side && look->compare == STUDIO_WHOLE)
        return NULL;
    if (!measures(s, &wanted)) {
        studio_seam *beside = &app->seams[!side]; /* sides may have been exchanged */
        *s = measures(beside, &wanted) ? *beside : wanted;
    }
    return s;
}

/* Until there is something to say, how far it is. */
void studio_seam_words(studio_app *app, int side, char *text, size_t size) {
    const studio_seam *s = seam_of(app, side);
    const uint32_t nfaces = slv_adjacency_face_count(studio_document_adjacency(&app->document));
    if (!s)
        *text = 0;
    else if (s->next < nfaces)
        snprintf(text, size, "\nseam jump: %.0f %% measured", 100.0 * s->next / nfaces);
    else
        snprintf(text, size, "\nseam jump %.2g, mean %.2g", (double)s->found.max,
                 (double)s->found.mean);
}

/* Some faces more; false: it has failed. */
static bool measure(studio_app *app, studio_seam *s, uint32_t nfaces) {
    const slv_gl_seam_params params = {.first_face = s->next,
                                       .nfaces = MIN(app->seam_faces, nfaces - s->next)};
    slv_gl_seam part, *found = &s->found;
    const gint64 start = g_get_monotonic_time();
    gtk_gl_area_make_current(app->area);
    if (studio_failed(app, studio_picture_seam(app->picture, &app->document, &app->look,
                                               s->strategy, &params, &part)))
        return false;
    if (part.nedges && (!found->nedges || part.max > found->max)) {
        found->max = part.max;
        found->face = part.face;
        found->edge = part.edge;
    }
    s->sum += (double)part.mean * part.nedges;
    found->nedges += part.nedges;
    found->mean = found->nedges ? (float)(s->sum / found->nedges) : 0;
    s->next += params.nfaces;
    const gint64 ms = (g_get_monotonic_time() - start) / 1000;
    if (ms > SLICE)
        app->seam_faces = MAX(app->seam_faces / 2, FEWEST);
    else if (2 * ms < SLICE)
        app->seam_faces = MIN(app->seam_faces * 2, MOST);
    return true;
}

static void tell(studio_app *app, const studio_seam *s) {
    const slv_gl_seam *seam = &s->found;
    const char *name = slv_strategy_at(s->strategy)->name;
    char text[256];
    studio_log(app,
               "\"event\":\"seam\",\"strategy\":\"%s\",\"max\":%.6g,\"mean\":%.6g,\"edges\":%u",
               name, (double)seam->max, (double)seam->mean, seam->nedges);
    if (!app->seam_asked)
        return;
    app->seam_asked = false;
    if (seam->nedges)
        snprintf(text, sizeof text,
                 "Seam jump of %s: at most %.4g, %.4g in the mean, over %u edges; the most at face "
                 "%d edge %d",
                 name, (double)seam->max, (double)seam->mean, seam->nedges, seam->face, seam->edge);
    else
        snprintf(text, sizeof text, "No faces share an edge.");
    studio_say(app, text, NULL, NULL);
}

static gboolean work(gpointer user);

static bool is_at_rest(const studio_app *app) {
    return !app->closing && !app->loading && app->picture && app->document.texture &&
           app->refined && app->drag == STUDIO_DRAG_NONE && !app->turntable.count;
}

/* The next picture at rest goes on where this one was. */
static void go_on(studio_app *app, bool failed) {
    app->seam_work = 0;
    if (is_at_rest(app) && !failed)
        app->seam_work = g_idle_add_full(G_PRIORITY_LOW, work, app, NULL);
}

static gboolean work(gpointer user) {
    studio_app *app = user;
    const uint32_t nfaces =
        is_at_rest(app) ? slv_adjacency_face_count(studio_document_adjacency(&app->document)) : 0;
    app->seam_work = 0;
    for (int side = 0; side < 2 && nfaces; side++) {
        studio_seam *s = seam_of(app, side);
        if (!s || s->next >= nfaces)
            continue;
        const bool fine = measure(app, s, nfaces);
        if (fine && s->next == nfaces) {
            tell(app, s);
            studio_panel_inspector_sync(app);
        }
        go_on(app, !fine);
        break;
    }
    return G_SOURCE_REMOVE;
}

void studio_seam_soon(studio_app *app) {
    if (!app->seam_work)
        app->seam_work = g_timeout_add_full(G_PRIORITY_LOW, PAUSE, work, app, NULL);
}

void studio_seam_forget(studio_app *app) {
    app->seam_faces = MAX(app->seam_faces, FEWEST);
    for (int side = 0; side < 2; side++)
        app->seams[side] = (studio_seam){.strategy = UINT32_MAX};
}

/* What is known already is said at once. */
void studio_seam_ask(studio_app *app) {
    const studio_seam *s = seam_of(app, 0);
    app->seam_asked = true;
    if (s->next == slv_adjacency_face_count(studio_document_adjacency(&app->document)))
        tell(app, s);
    else
        studio_say(app, "The seam jump is being measured while the view rests.", NULL, NULL);
    studio_seam_soon(app);
}
