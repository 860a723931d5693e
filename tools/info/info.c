/* The verb info: what kind of file it is, and its options. */
#include "info/info.h"
#include "command/ptx_name.h"
#include "verbs.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

typedef enum file_kind { KIND_UNREADABLE, KIND_UNKNOWN, KIND_PTX, KIND_MESH } file_kind;

static bool is_mesh(const char *path) {
    static const char *const endings[] = {".obj", ".ply", ".obj.gz", ".ply.gz"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (cli_ends_with(path, endings[i]))
            return true;
    return false;
}

/* By content first: a .ptx with another name is still one. */
static file_kind find_kind(const char *path) {
    char magic[4] = {0};
    struct stat status;
    if (stat(path, &status) != 0)
        return KIND_UNREADABLE;
    if (!S_ISREG(status.st_mode))
        return KIND_MESH;
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
    if (strcmp(path, cli_input("-")) == 0 || strncmp(path, "/dev/fd/", 8) == 0) /* no ending */
        return KIND_MESH;
    return ptx_name_is_safe(path) ? KIND_PTX : is_mesh(path) ? KIND_MESH : KIND_UNKNOWN;
}

int verb_info(int argc, char **argv) {
    const char *path = NULL;
    uint32_t narguments = 0;
    info_options o = {0};
    const cli_option options[] = {
        CLI_JSON(&o.json),
        {"--list-faces||--faces|-f", CLI_FLAG, &o.faces,
         "also list every face: size, flags, neighbours", NULL, 0, 0, NULL},
        {"--meta", CLI_FLAG, &o.meta, "also show the metadata's values (.ptx)", NULL, 0, 0, NULL},
        {"--sheet|--out|-o|--output", CLI_TEXT, &o.sheet,
         "also write a picture of all faces, each in a cell", "OUT.png|.exr", 0, 0, NULL},
        {"--sheet-faces", CLI_TEXT, &o.sheet_faces, "draw these only: 0-99,250", "LIST", 0, 0,
         NULL},
        {"--ids", CLI_FLAG, &o.ids, "write its number into every cell of the sheet", NULL, 0, 0,
         NULL},
        {"--cell", CLI_UINT, &o.cell, "pixels of a cell's side (so that all faces fit)", NULL, 1,
         4096, NULL},
        {"--encoding", CLI_CHOICE, &o.encoding,
         "of the sheet: colours, in a PNG as sRGB, or numbers as they stand", "srgb|raw", 0, 0,
         &o.encoding_given},
        CLI_TEXTURE_ENCODING(&o.texture_encoding),
        CLI_PROGRESS(&o.progress),
    };
    const cli_command command = {.name = "info",
                                 .summary = "say what a .ptx or a mesh holds",
                                 .arguments = "FILE.ptx|FILE.obj|FILE.ply [SHEET|-o SHEET]",
                                 .reads = "a texture or a mesh",
                                 .writes = "a picture of its faces if it is named, PNG or EXR; as "
                                           "an argument it must not exist yet",
                                 .examples = "  selvage info teapot.ptx\n"
                                             "  selvage info teapot.ptx --meta --list-faces\n"
                                             "  selvage info teapot.ptx --sheet faces.png\n"
                                             "  selvage info cage.obj --json | jq .valences\n",
                                 CLI_TAKES(options, 1, 1, &path, &narguments),
                                 .output = &o.sheet,
                                 .output_is_new = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.sheet && slv_image_format_of_name(o.sheet) == SLV_IMAGE_NONE)
        return cli_usage(&command, "--sheet: expected a name that ends in .png or .exr");
    if (!o.sheet && (o.sheet_faces || o.cell || o.ids || o.encoding_given || o.texture_encoding))
        return cli_usage(&command, "--sheet is missing: where does the picture go?");
    slv_env env = cli_env(0);
    path = cli_input(path);
    switch (find_kind(path)) {
    case KIND_UNREADABLE:
        return cli_error("%s: %s", path, strerror(errno));
    case KIND_UNKNOWN:
        return cli_error("%s: neither a .ptx nor an .obj or .ply file", path);
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
    return code;
}
