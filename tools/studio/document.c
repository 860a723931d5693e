/* Opening, painting in sessions, saving. */
#include "studio/document.h"

#include "command/output.h"
#include "command/ptx_name.h"

#include <selvage/blank.h>
#include <selvage/ptx.h>

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BLANK_FILL 0.7529412f /* #c0c0c0, as selvage new has it */

void studio_document_note(void *message, slv_log_level level, const char *line) {
    if (level != SLV_LOG_INFO)
        snprintf(message, STUDIO_MESSAGE, "%s", line);
}

/* Much is asked for while files are opened, which makes this the place to end it. */
static void *allocate(void *user, size_t bytes) {
    const studio_work *work = user;
    return atomic_load(&work->cancelled) ? NULL : malloc(bytes);
}

static void release(void *user, void *memory) {
    (void)user;
    free(memory);
}

void studio_document_cancel(studio_document *document) {
    atomic_store(&document->work->cancelled, true);
}

static void begin(studio_document *d, studio_step step) {
    atomic_store(&d->work->part, 0);
    atomic_store(&d->work->step, (int)step);
}

static void begin_scene(void *user, scene_step step) {
    static const studio_step steps[SCENE_STEPS] = {STUDIO_STEP_MESH, STUDIO_STEP_ADJACENCY,
                                                   STUDIO_STEP_SURFACE, STUDIO_STEP_TEXELS};
    begin(user, steps[step]);
}

static bool go_on(void *user, uint64_t done, uint64_t total) {
    studio_document *d = user;
    atomic_store(&d->work->part, (unsigned)(1000 * done / (total ? total : 1)));
    return !atomic_load(&d->work->cancelled);
}

bool studio_document_init(studio_document *document) {
    memset(document, 0, sizeof *document);
    document->message = calloc(1, STUDIO_MESSAGE);
    document->env = cli_env(0);
    document->env.log = studio_document_note;
    document->env.log_user = document->message;
    document->work = calloc(1, sizeof *document->work);
    document->env.allocate = allocate;
    document->env.release = release;
    document->env.memory_user = document->work;
    return document->message && document->work;
}

void studio_document_end(studio_document *document) {
    free(document->message);
    free(document->work);
    document->message = NULL;
    document->work = NULL;
}

void studio_document_close(studio_document *d) {
    const studio_document kept = {
        .env = d->env, .message = d->message, .work = d->work, .serial = d->serial + 1};
    studio_document_forget_moved(d);
    displace_close(&d->scene.displace); /* looks at an adjacency that may be the session's */
    slv_session_destroy(d->session);
    slv_paint_surface_destroy(d->surface);
    scene_free(&d->scene);
    free(d->path);
    free(d->target);
    *d = kept;
}

slv_result studio_document_displace(studio_document *d, const displace_settings *settings) {
    displace_open opened;
    slv_result result = displace_open_settings(&d->env, settings, studio_document_adjacency(d),
                                               studio_document_mesh(d), &opened);
    if (result)
        return result;
    studio_document_forget_moved(d);
    displace_close(&d->scene.displace);
    d->scene.displace = opened;
    d->displace = *settings;
    d->shape++;
    return SLV_OK;
}

const slv_displacement *studio_document_displacement(const studio_document *d) {
    return d->scene.displace.moves ? &d->scene.displace.displacement : NULL;
}

const slv_mesh *studio_document_mesh(const studio_document *d) {
    return d->kind == STUDIO_SESSION ? slv_session_mesh(d->session) : d->scene.mesh;
}

slv_scheme studio_document_scheme(const studio_document *d) {
    return d->session ? slv_session_scheme(d->session) : d->scene.scheme;
}

const slv_adjacency *studio_document_adjacency(const studio_document *d) {
    return d->kind == STUDIO_SESSION ? slv_session_adjacency(d->session) : d->scene.adjacency;
}

slv_document *studio_document_layers(const studio_document *d) {
    return d->session ? slv_session_document(d->session) : NULL;
}

static char *copy_text(const char *text) {
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

static void find_bounds(studio_document *d) {
    const slv_mesh_view *view = slv_mesh_get_view(studio_document_mesh(d));
    for (uint32_t v = 0; v < view->nverts; v++)
        for (int c = 0; c < 3; c++) {
            float at = view->positions[3 * (size_t)v + (size_t)c];
            d->scene.bounds_min[c] = v && d->scene.bounds_min[c] < at ? d->scene.bounds_min[c] : at;
            d->scene.bounds_max[c] = v && d->scene.bounds_max[c] > at ? d->scene.bounds_max[c] : at;
        }
}

/* The session's layer that is painted on is the topmost, until another is chosen. */
static void choose_layer(studio_document *d) {
    slv_document *layers = slv_session_document(d->session);
    uint32_t count = slv_document_layer_count(layers);
    slv_layer_info info;
    if (!slv_document_layer(layers, d->layer, &info)) {
        d->layer = count ? slv_document_layer_at(layers, count - 1) : 0;
        d->mask = false;
    } else if (!info.has_mask) {
        d->mask = false;
    }
}

static slv_result open_session(studio_document *d, const char *path) {
    slv_result result = slv_session_open(&d->env, path, NULL, &d->session);
    if (result)
        return result;
    begin(d, STUDIO_STEP_SURFACE);
    slv_surface_params surface = {.scheme = slv_session_scheme(d->session)};
    if ((result = slv_surface_create(&d->env, slv_session_mesh(d->session), &surface,
                                     &d->scene.surface)))
        return result;
    find_bounds(d);
    begin(d, STUDIO_STEP_TEXELS);
    slv_session_info info;
    slv_session_get_info(d->session, &info);
    d->saved_lines = info.lines - info.unsaved;
    d->target = copy_text(path);
    return studio_document_refresh(d);
}

static slv_result open_mesh(studio_document *d, const char *path) {
    static const float fill[3] = {BLANK_FILL, BLANK_FILL, BLANK_FILL};
    const slv_blank_params blank = {.fill = fill};
    const slv_surface_params surface = {0};
    slv_result result = slv_mesh_load(&d->env, path, &d->scene.mesh);
    begin(d, STUDIO_STEP_ADJACENCY);
    if (result || (result = slv_mesh_adjacency(&d->env, d->scene.mesh, &d->scene.adjacency)))
        return result;
    begin(d, STUDIO_STEP_SURFACE);
    if ((result = slv_surface_create(&d->env, d->scene.mesh, &surface, &d->scene.surface)))
        return result;
    begin(d, STUDIO_STEP_TEXELS);
    if ((result = slv_blank_create(&d->env, d->scene.mesh, &blank, &d->scene.texture, NULL)))
        return result;
    find_bounds(d);
    d->texture = d->scene.texture;
    return SLV_OK;
}

/* A session's own description stands for the session: file choosers know files only. */
static bool is_session(const char *path, char *folder, size_t size) {
    static const char about[] = "/session.json";
    size_t length = strlen(path), end = sizeof about - 1;
    snprintf(folder, size, "%s", path);
    if (length > end && length < size && strcmp(path + length - end, about) == 0)
        folder[length - end] = 0;
    return slv_session_is(folder);
}

slv_result studio_document_open(studio_document *d, const char *path, const char *mesh) {
    char folder[PATH_MAX], whole[PATH_MAX];
    slv_result result;
    d->message[0] = 0;
    if (!realpath(path, whole))
        return output_fail(&d->env, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
    if (is_session(whole, folder, sizeof folder)) {
        d->kind = STUDIO_SESSION;
        result = open_session(d, folder);
        snprintf(whole, sizeof whole, "%s", folder);
    } else if (ptx_name_is_safe(whole)) {
        const scene_params scene = {.ptx = whole,
                                    .mesh = mesh,
                                    .salvage = true,
                                    .begins = begin_scene,
                                    .user = d,
                                    .progress = {go_on, d}};
        d->kind = STUDIO_PTX;
        result = scene_load(&d->env, &scene, &d->scene);
        d->texture = d->scene.texture;
    } else {
        struct stat status;
        if (stat(whole, &status) == 0 && S_ISDIR(status.st_mode))
            return output_fail(&d->env, SLV_ERROR_FORMAT, "%s: is a folder, but no session", whole);
        d->kind = STUDIO_MESH;
        result = open_mesh(d, whole);
    }
    d->path = copy_text(whole);
    if (result)
        studio_document_close(d);
    return result;
}

/* ---- unfinished work ---- */

/* Makes the folder, and those above it. */
static bool make_folders(char *path) {
    for (char *at = path + 1; *at; at++)
        if (*at == '/') {
            *at = 0;
            bool fine = mkdir(path, 0700) == 0 || errno == EEXIST;
            *at = '/';
            if (!fine)
                return false;
        }
    return true;
}

static bool work_path(const studio_document *d, char *out, size_t size) {
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    const char *base = strrchr(d->path, '/');
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (const char *c = d->path; *c; c++)
        hash = (hash ^ (unsigned char)*c) * UINT64_C(0x100000001b3);
    int length = snprintf(out, size, "%s%s/selvage/unfinished/%.60s-%016llx.selvage",
                          state && *state == '/' ? state
                          : home                 ? home
                                                 : "/tmp",
                          state && *state == '/' ? "" : "/.local/state", base ? base + 1 : d->path,
                          (unsigned long long)hash);
    return length > 0 && (size_t)length < size;
}

char *studio_document_unfinished(const studio_document *d) {
    char path[PATH_MAX];
    if (!d->path || d->kind == STUDIO_SESSION || !work_path(d, path, sizeof path) ||
        !slv_session_is(path))
        return NULL;
    return copy_text(path);
}

/* From now on the texture is the session's. */
static slv_result take_session(studio_document *d) {
    slv_result result;
    d->working = true;
    if ((result = studio_document_refresh(d)))
        return result;
    slv_texture_destroy(d->scene.texture);
    d->scene.texture = NULL;
    slv_paint_surface_destroy(d->surface);
    d->surface = NULL;
    return SLV_OK;
}

slv_result studio_document_recover(studio_document *d) {
    char *path = studio_document_unfinished(d);
    slv_result result =
        path ? slv_session_open(&d->env, path, NULL, &d->session)
             : output_fail(&d->env, SLV_ERROR_IO, "%s: there is no unfinished work of it", d->path);
    free(path);
    if (!result &&
        slv_mesh_face_count(slv_session_mesh(d->session)) != slv_mesh_face_count(d->scene.mesh)) {
        slv_session_destroy(d->session);
        d->session = NULL;
        result = output_fail(&d->env, SLV_ERROR_MISMATCH,
                             "%s: its unfinished work is on another mesh", d->path);
    }
    d->saved_lines = 0; /* nobody knows */
    return result ? result : take_session(d);
}

slv_result studio_document_discard(studio_document *d) {
    char *path = studio_document_unfinished(d);
    slv_result result = path ? slv_session_remove(&d->env, path) : SLV_OK;
    free(path);
    return result;
}

slv_result studio_document_need_session(studio_document *d) {
    char path[PATH_MAX];
    if (d->session)
        return SLV_OK;
    d->message[0] = 0;
    if (!d->texture)
        return output_fail(&d->env, SLV_ERROR_ARGUMENT, "nothing is open");
    if (!work_path(d, path, sizeof path) || !make_folders(path))
        return output_fail(&d->env, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
    const slv_session_params params = {.scheme = d->scene.scheme};
    slv_result result =
        slv_session_create_from(&d->env, path, d->scene.mesh, d->texture, &params, &d->session);
    if (result)
        return result;
    slv_session_info info;
    slv_session_get_info(d->session, &info);
    d->saved_lines = info.lines;
    return take_session(d);
}

slv_result studio_document_refresh(studio_document *d) {
    slv_document *layers = studio_document_layers(d);
    if (!layers)
        return SLV_OK;
    choose_layer(d);
    slv_result result = slv_document_flatten(layers);
    if (!result && d->texture != slv_document_texture(layers)) {
        d->texture = slv_document_texture(layers);
        d->serial++;
    }
    return result;
}

/* ---- saving ---- */

bool studio_document_is_data(const studio_document *d) {
    return d->texture && slv_texture_get_encoding(d->texture, SLV_TEXTURE_AUTO) == SLV_TEXTURE_DATA;
}

bool studio_document_is_unsaved(const studio_document *d) {
    slv_session_info info;
    if (!d->session)
        return false;
    slv_session_get_info(d->session, &info);
    return info.lines != d->saved_lines;
}

static void note_saved(studio_document *d) {
    slv_session_info info;
    slv_session_get_info(d->session, &info);
    d->saved_lines = info.lines;
}

slv_result studio_document_save(studio_document *d) {
    d->message[0] = 0;
    if (!d->session || !d->target)
        return output_fail(&d->env, SLV_ERROR_ARGUMENT, "there is no place to save to yet");
    bool exports = ptx_name_is_safe(d->target);
    slv_result result =
        exports ? studio_document_export(d, d->target) : slv_session_save(d->session);
    if (!result)
        note_saved(d);
    return result;
}

slv_result studio_document_save_as(studio_document *d, const char *path) {
    slv_result result = studio_document_need_session(d);
    d->message[0] = 0;
    if (result)
        return result;
    bool exports = ptx_name_is_safe(path), worked = d->working;
    char *work = copy_text(slv_session_path(d->session));
    result = exports ? studio_document_export(d, path) : slv_session_save_as(d->session, path);
    if (!result) {
        free(d->target);
        d->target = copy_text(path);
        note_saved(d);
        if (!exports) {
            d->working = false;
            if (worked && work)
                result = slv_session_remove(&d->env, work); /* it is elsewhere now */
        }
    }
    free(work);
    return result;
}

slv_result studio_document_export(studio_document *d, const char *path) {
    slv_result result = studio_document_need_session(d);
    return result ? result : slv_session_export(d->session, path);
}
