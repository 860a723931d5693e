/* The verb info: what kind of file it is, and its options. */
#include "info/info.h"
#include "verbs.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <strings.h>

void info_line(const char *label, const char *format, ...) {
    va_list args;
    va_start(args, format);
    printf("  %-14s", label);
    vprintf(format, args);
    putchar('\n');
    va_end(args);
}

void info_title(const char *path) {
    output_terminal(stdout, path, strlen(path), SIZE_MAX);
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

typedef enum file_kind { KIND_UNREADABLE, KIND_UNKNOWN, KIND_PTX, KIND_MESH } file_kind;

/* By content first: a .ptx with another name is still one. */
static file_kind find_kind(const char *path) {
    char magic[4] = {0};
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return KIND_UNREADABLE;
    errno = 0;
    size_t got = fread(magic, 1, sizeof magic, stream);
    bool failed = ferror(stream) != 0;
    int reason = errno;
    fclose(stream);
    errno = reason;
    if (failed)
        return KIND_UNREADABLE;
    if (got == 4 && memcmp(magic, "Ptex", 4) == 0)
        return KIND_PTX;
    return cli_ends_with(path, ".ptx")   ? KIND_PTX
           : cli_ends_with(path, ".obj") ? KIND_MESH
                                         : KIND_UNKNOWN;
}

int verb_info(int argc, char **argv) {
    const char *path = NULL;
    uint32_t narguments = 0;
    info_options o = {0};
    const cli_option options[] = {
        CLI_JSON(&o.json),
        {"--faces|-f", CLI_FLAG, &o.faces, "also list every face: size, flags, neighbours", NULL, 0,
         0, NULL},
        {"--meta", CLI_FLAG, &o.meta, "also show the metadata's values (.ptx)", NULL, 0, 0, NULL},
        {"--sheet|-s", CLI_TEXT, &o.sheet, "also write a picture of all faces, each in a cell",
         "OUT.png|.exr", 0, 0, NULL},
        {"--sheet-faces", CLI_TEXT, &o.sheet_faces, "draw these only: 0-99,250", "LIST", 0, 0,
         NULL},
        {"--cell", CLI_UINT, &o.cell, "pixels of a cell's side (so that all faces fit)", NULL, 1,
         4096, NULL},
        {"--encoding", CLI_CHOICE, &o.encoding,
         "of a PNG: values as they stand, or through the sRGB curve (raw, srgb for half and float)",
         "srgb|raw", 0, 0, &o.encoding_given},
        {"--progress", CLI_FLAG, &o.progress, "say on stderr how far the sheet is, terminal or not",
         NULL, 0, 0, NULL},
    };
    const cli_command command = {.name = "info",
                                 .summary = "say what a .ptx or a mesh holds",
                                 .arguments = "FILE.ptx|FILE.obj",
                                 .examples = "  selvage info teapot.ptx\n"
                                             "  selvage info teapot.ptx --meta --faces\n"
                                             "  selvage info teapot.ptx --sheet faces.png\n"
                                             "  selvage info cage.obj --json | jq .valences\n",
                                 .options = options,
                                 .noptions = sizeof options / sizeof *options,
                                 .min_arguments = 1,
                                 .max_arguments = 1,
                                 .positional = &path,
                                 .npositional = &narguments};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.sheet && !cli_ends_with(o.sheet, ".png") && !cli_ends_with(o.sheet, ".exr"))
        return cli_usage(&command, "--sheet: expected a name that ends in .png or .exr");
    if (!o.sheet && (o.sheet_faces || o.cell || o.encoding_given))
        return cli_usage(&command, "--sheet is missing: where does the picture go?");
    slv_env env = cli_env(0);
    switch (find_kind(path)) {
    case KIND_UNREADABLE:
        return cli_error("%s: %s", path, strerror(errno));
    case KIND_UNKNOWN:
        return cli_error("%s: neither a .ptx nor an .obj file", path);
    case KIND_PTX:
        code = info_ptx(&command, &env, path, &o);
        break;
    case KIND_MESH:
        if (o.meta || o.sheet)
            return cli_usage(&command, o.meta ? "--meta: a mesh has no metadata"
                                              : "--sheet: a mesh has no texels");
        code = info_mesh(&env, path, &o);
        break;
    }
    return cli_answered(code);
}
