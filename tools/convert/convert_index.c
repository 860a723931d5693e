/* What an index of images says that is not read. */
#include "convert/convert_options.h"

#include "command/fields.h"

#include <selvage/file.h>

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const char of_files[] =
    "schema|kind|mesh_type|data_type|channels|alpha_channel|"
    "texture_encoding|border_u|border_v|edge_filter|reductions|meta|faces|images|images_encoding",
                  of_faces[] = "width|height|constant|subface|adjacent_faces|adjacent_edges|images|"
                               "x|y",
                  of_entries[] = "key|type|value|values";

/* Of the items of a list those of the first that has any are told. */
static void warn_of_first(const slv_env *env, const char *path, const char *what,
                          const json_t *list, const char *known) {
    for (size_t i = 0; i < json_array_size(list); i++) {
        char where[300];
        snprintf(where, sizeof where, "%.200s: %s %zu", path, what, i);
        if (fields_warn(env, where, json_array_get(list, i), known))
            return;
    }
}

void convert_warn_of_index(const slv_env *env, const char *path, bool folder) {
    slv_env silent = *env;
    char index[1200];
    char *text = NULL;
    size_t length = 0;
    json_error_t error;
    silent.log = NULL;
    int written = snprintf(index, sizeof index, "%s%s", path, folder ? "/index.json" : "");
    struct stat status; /* a pipe is read once */
    if (written < 0 || (size_t)written >= sizeof index || stat(index, &status) != 0 ||
        !S_ISREG(status.st_mode))
        return;
    /* what is wrong with it otherwise is said by those who read it */
    json_t *root =
        slv_text_load(&silent, index, &text, &length) ? NULL : json_loadb(text, length, 0, &error);
    slv_free(text);
    fields_warn(env, index, root, of_files);
    warn_of_first(env, index, "face", json_object_get(root, "faces"), of_faces);
    warn_of_first(env, index, "entry of metadata", json_object_get(root, "meta"), of_entries);
    json_decref(root);
}
