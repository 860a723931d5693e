/* Lines and lists that all of info prints. */
#include "info/info.h"

#include <stdarg.h>
#include <string.h>

void info_line(const char *label, const char *format, ...) {
    va_list args;
    va_start(args, format);
    printf("  %-14s", label);
    vprintf(format, args);
    putchar('\n');
    va_end(args);
}

void info_title(const char *path) {
    output_terminal(stdout, cli_shown(path), strlen(cli_shown(path)), SIZE_MAX);
    putchar('\n');
}

const char *info_bytes(uint64_t bytes, char *buffer, size_t size) {
    if (bytes < 1000)
        snprintf(buffer, size, "%u byte%s", (unsigned)bytes, bytes == 1 ? "" : "s");
    else if (bytes < 1000000)
        snprintf(buffer, size, "%.1f kB", (double)bytes / 1e3);
    else
        snprintf(buffer, size, "%.1f MB", (double)bytes / 1e6);
    return buffer;
}

void info_print_adjacency(const slv_face_adjacency *adjacency, unsigned nedges) {
    for (unsigned e = 0; e < nedges; e++) {
        char text[32];
        if (adjacency->face[e] < 0)
            snprintf(text, sizeof text, "-");
        else
            snprintf(text, sizeof text, "%d:%u", adjacency->face[e], adjacency->edge[e]);
        printf(e + 1 < nedges ? " %-9s" : " %s", text);
    }
    putchar('\n');
}

json_t *info_append(json_t *list, json_t *item) {
    if (json_array_append_new(list, item) == 0)
        return list;
    json_decref(list);
    return NULL;
}

json_t *info_adjacency_json(const slv_face_adjacency *adjacency, unsigned nedges, json_t *object) {
    json_t *faces = json_array(), *edges = json_array();
    for (unsigned e = 0; e < nedges; e++) {
        bool boundary = adjacency->face[e] < 0;
        faces = info_append(faces, boundary ? json_null() : json_integer(adjacency->face[e]));
        edges = info_append(edges, boundary ? json_null() : json_integer(adjacency->edge[e]));
    }
    bool failed = json_object_set_new(object, "adjacent_faces", faces) != 0;
    failed |= json_object_set_new(object, "adjacent_edges", edges) != 0;
    if (!failed)
        return object;
    json_decref(object);
    return NULL;
}
