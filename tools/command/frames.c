/* Lists of numbered pictures, and meshes whose vertices move. */
#include "command/frames.h"
#include "command/output.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEPT_BYTES (UINT64_C(256) << 20)

void frames_free(frames_list *frames) {
    for (uint32_t i = 0; i < frames->count && frames->meshes; i++)
        free(frames->meshes[i]);
    for (uint32_t i = 0; i < frames->count && frames->positions; i++)
        free(frames->positions[i]);
    free(frames->meshes);
    free(frames->positions);
    free(frames->cameras);
    free(frames->numbers);
    *frames = (frames_list){0};
}

static slv_result no_memory(const slv_env *env) {
    return output_fail(env, SLV_ERROR_MEMORY, "no memory for the list of frames");
}

slv_result frames_turntable(const slv_env *env, const slv_camera *camera, const float low[3],
                            const float high[3], uint32_t count, frames_list *out) {
    *out = (frames_list){.count = count,
                         .cameras = calloc(count, sizeof *out->cameras),
                         .numbers = calloc(count, sizeof *out->numbers)};
    if (!out->cameras || !out->numbers) {
        frames_free(out);
        return no_memory(env);
    }
    const double x = 0.5 * ((double)low[0] + (double)high[0]),
                 z = 0.5 * ((double)low[2] + (double)high[2]);
    for (uint32_t i = 0; i < count; i++) {
        /* the world turns the other way, around an upright axis through the middle */
        double turn = 6.283185307179586 * i / count, c = cos(turn), s = sin(turn);
        out->numbers[i] = i + 1;
        out->cameras[i] = *camera;
        for (int r = 0; r < 3 && i; r++) {
            const float *from = camera->world_to_camera + 4 * r;
            float *to = out->cameras[i].world_to_camera + 4 * r;
            double a = (double)from[0] * c + (double)from[2] * s,
                   b = (double)from[2] * c - (double)from[0] * s;
            to[0] = (float)a;
            to[2] = (float)b;
            to[3] =
                (float)((double)from[3] + ((double)from[0] - a) * x + ((double)from[2] - b) * z);
        }
    }
    return SLV_OK;
}

/* ---- files ---- */

typedef struct numbered {
    uint32_t number;
    char *path;
} numbered;

static int by_number(const void *a, const void *b) {
    const numbered *p = a, *q = b;
    return p->number != q->number ? (p->number > q->number) - (p->number < q->number)
                                  : strcmp(p->path, q->path);
}

/* The run of # in a file's own name, if there is one. */
static bool find_run(const char *name, size_t *begin, size_t *end) {
    const char *slash = strrchr(name, '/'), *first = strchr(slash ? slash : name, '#');
    *begin = first ? (size_t)(first - name) : 0;
    *end = *begin + (first ? strspn(first, "#") : 0);
    return first != NULL;
}

/* Whether a file's name is `own` with a number of at least so many digits in place of the run. */
static bool matches(const char *own, size_t begin, size_t end, const char *name, uint32_t *number) {
    size_t length = strlen(name), tail = strlen(own + end), digits;
    if (length < begin + tail + (end - begin) || strncmp(name, own, begin) != 0 ||
        strcmp(name + length - tail, own + end) != 0)
        return false;
    digits = length - begin - tail;
    if (digits > 9 || (digits > end - begin && name[begin] == '0') ||
        strspn(name + begin, "0123456789") < digits)
        return false;
    *number = (uint32_t)strtoul(name + begin, NULL, 10);
    return true;
}

/* Files whose numbers have another width, and the first of them. */
typedef struct others {
    uint32_t count;
    char *first;
} others;

static void add_other(const char *own, size_t begin, size_t end, const char *name, others *to) {
    size_t length = strlen(name), tail = strlen(own + end);
    if (length <= begin + tail || strncmp(name, own, begin) != 0 ||
        strcmp(name + length - tail, own + end) != 0 ||
        strspn(name + begin, "0123456789") < length - begin - tail)
        return;
    to->count++;
    if (to->first && strcmp(name, to->first) >= 0)
        return;
    free(to->first);
    to->first = strdup(name);
}

static slv_result list_folder(const slv_env *env, const char *pattern, size_t begin, size_t end,
                              numbered **list, uint32_t *count, others *rest) {
    const char *slash = strrchr(pattern, '/');
    size_t folder = slash ? (size_t)(slash - pattern) + 1 : 0;
    char path[FRAMES_PATH];
    snprintf(path, sizeof path, "%.*s", folder ? (int)folder : 1, folder ? pattern : ".");
    DIR *dir = opendir(path);
    if (!dir)
        return output_fail(env, SLV_ERROR_IO, "%s: its folder cannot be read", pattern);
    slv_result result = SLV_OK;
    for (struct dirent *entry; !result && (entry = readdir(dir));) {
        uint32_t number;
        if (!matches(pattern + folder, begin - folder, end - folder, entry->d_name, &number)) {
            add_other(pattern + folder, begin - folder, end - folder, entry->d_name, rest);
            continue;
        }
        int length = snprintf(path, sizeof path, "%.*s%s", (int)folder, pattern, entry->d_name);
        numbered *grown =
            *count & (*count + 1) ? *list : realloc(*list, 2 * (*count + 1) * sizeof **list);
        *list = grown ? grown : *list;
        char *copy = strdup(path);
        if (*count == FRAMES_MOST || length >= (int)sizeof path)
            result = output_fail(env, SLV_ERROR_LIMIT, "%s: more than %d files, or a longer name",
                                 pattern, FRAMES_MOST);
        else if (!grown || !copy)
            result = no_memory(env);
        if (result)
            free(copy);
        else
            (*list)[(*count)++] = (numbered){number, copy};
    }
    closedir(dir);
    return result;
}

/* What may not be meant of frames begin..end-1 of a pattern, which are in the order of their
 * numbers. */
static void warn_of_gaps(const char *pattern, const numbered *list, uint32_t count,
                         const others *rest) {
    uint32_t missing = 0, from = 0, to = 0;
    for (uint32_t i = 1; i < count; i++) {
        if (list[i].number == list[i - 1].number + 1)
            continue;
        if (!missing) {
            from = list[i - 1].number + 1;
            to = list[i].number - 1;
        }
        missing += list[i].number - list[i - 1].number - 1;
    }
    if (missing)
        cli_warning("%s: %u numbers between %u and %u are missing, and have no picture: the first "
                    "gap is %u to %u",
                    pattern, missing, list[0].number, list[count - 1].number, from, to);
    if (rest->count && rest->first)
        cli_warning("%s: %u files have numbers of another width, and are left out: the first is %s",
                    pattern, rest->count, rest->first);
}

slv_result frames_find(const slv_env *env, const char *pattern, frames_list *out) {
    numbered *list = NULL;
    uint32_t count = 0;
    size_t begin, end;
    others rest = {0};
    slv_result result = SLV_OK;
    *out = (frames_list){0};
    if (strlen(pattern) >= FRAMES_PATH)
        return output_fail(env, SLV_ERROR_ARGUMENT, "the name of frames is too long");
    if (find_run(pattern, &begin, &end)) {
        result = list_folder(env, pattern, begin, end, &list, &count, &rest);
        if (!result && !count)
            result = output_fail(env, SLV_ERROR_IO, "%s: there is no such file%s%s%s", pattern,
                                 rest.first ? " (but " : "", rest.first ? rest.first : "",
                                 rest.first ? " is there)" : "");
    } else if ((list = malloc(sizeof *list)) && (list->path = strdup(pattern))) {
        list->number = 1;
        count = 1;
    } else {
        result = no_memory(env);
    }
    if (count)
        qsort(list, count, sizeof *list, by_number);
    for (uint32_t i = 1; i < count && !result; i++)
        if (list[i].number == list[i - 1].number)
            result = output_fail(env, SLV_ERROR_ARGUMENT, "%s and %s have one number",
                                 list[i - 1].path, list[i].path);
    if (!result)
        warn_of_gaps(pattern, list, count, &rest);
    free(rest.first);
    if (!result && !((out->meshes = calloc(count, sizeof *out->meshes)) &&
                     (out->numbers = calloc(count, sizeof *out->numbers))))
        result = no_memory(env);
    for (uint32_t i = 0; i < count; i++) {
        if (result) {
            free(list[i].path);
            continue;
        }
        out->meshes[i] = list[i].path;
        out->numbers[i] = list[i].number;
        out->count = count;
    }
    free(list);
    if (result)
        frames_free(out);
    return result;
}

/* Where a file has the vertices of `mesh`, whose polygons must be the same; for free. */
static slv_result read_positions(const slv_env *env, const char *path, const slv_mesh *mesh,
                                 float **out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_mesh *moved = NULL;
    float *positions = NULL;
    slv_result result = slv_mesh_load(env, path, &moved);
    *out = NULL;
    if (result)
        return result;
    const slv_mesh_view *other = slv_mesh_get_view(moved);
    const int32_t *a = view->poly_verts, *b = other->poly_verts;
    if (other->nverts != view->nverts || other->npolys != view->npolys)
        result = output_fail(env, SLV_ERROR_MISMATCH,
                             "%s: %u vertices and %u polygons, the mesh has %u and %u", path,
                             other->nverts, other->npolys, view->nverts, view->npolys);
    for (uint32_t p = 0; p < view->npolys && !result; p++) {
        size_t size = (size_t)view->poly_sizes[p];
        if (other->poly_sizes[p] != view->poly_sizes[p] || memcmp(a, b, size * sizeof *a) != 0)
            result = output_fail(env, SLV_ERROR_MISMATCH,
                                 "%s: polygon %u has other vertices than in the mesh", path, p + 1);
        a += size;
        b += size;
    }
    if (!result && !(positions = malloc((size_t)view->nverts * 3 * sizeof *positions + 1)))
        result = no_memory(env);
    for (size_t i = 0; i < 3 * (size_t)view->nverts && !result; i++)
        positions[i] =
            (float)((double)other->positions[i] + other->origin[i % 3] - view->origin[i % 3]);
    slv_mesh_destroy(moved);
    *out = positions;
    return result;
}

slv_result frames_check(const slv_env *env, const slv_mesh *mesh, frames_list *frames, bool forced,
                        bool quiet) {
    const uint64_t each = (uint64_t)slv_mesh_get_view(mesh)->nverts * 3 * sizeof(float);
    uint64_t left = KEPT_BYTES;
    slv_result result = SLV_OK;
    frames->positions = calloc(frames->count ? frames->count : 1, sizeof *frames->positions);
    if (!frames->positions)
        return no_memory(env);
    cli_progress progress = cli_progress_fleeting("reading meshes", forced, quiet);
    progress.total = frames->count ? frames->count : 1;
    for (uint32_t i = 0; i < frames->count && !result; i++) {
        float *positions;
        cli_progress_update(&progress, i);
        result = read_positions(env, frames->meshes[i], mesh, &positions);
        if (result || each > left) {
            free(positions);
            continue;
        }
        frames->positions[i] = positions;
        left -= each;
    }
    cli_progress_end(&progress);
    return result;
}

slv_result frames_move(const slv_env *env, const frames_list *frames, uint32_t index,
                       const slv_mesh *mesh, slv_surface *surface) {
    float *kept = frames->positions[index], *read = NULL;
    slv_result result = kept ? SLV_OK : read_positions(env, frames->meshes[index], mesh, &read);
    if (!result)
        result = slv_surface_move(surface, slv_mesh_get_view(mesh)->nverts, kept ? kept : read);
    free(read);
    return result;
}

bool frames_name(const char *out, uint32_t number, char path[FRAMES_PATH]) {
    size_t begin, end;
    int digits = 4, length;
    if (find_run(out, &begin, &end)) {
        digits = end - begin < 10 ? (int)(end - begin) : 10;
        length =
            snprintf(path, FRAMES_PATH, "%.*s%0*u%s", (int)begin, out, digits, number, out + end);
    } else {
        const char *dot = strrchr(out, '.');
        int stem = dot ? (int)(dot - out) : (int)strlen(out);
        length =
            snprintf(path, FRAMES_PATH, "%.*s.%0*u%s", stem, out, digits, number, dot ? dot : "");
    }
    return length < FRAMES_PATH;
}
