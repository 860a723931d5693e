/* Meshes from files, of which the first bytes say what they are. */
#include "base/memory.h"
#include "mesh/mesh_data.h"

#include <selvage/file.h>
#include <selvage/mesh.h>

#include <string.h>

static slv_result load(const slv_env *env, const char *path, bool points, slv_mesh **out) {
    char *bytes = NULL;
    size_t size = 0;
    *out = NULL;
    slv_result result = slv_text_load(env, path, &bytes, &size);
    if (!result) {
        bool ply = size >= 4 && (memcmp(bytes, "ply\n", 4) == 0 || memcmp(bytes, "ply\r", 4) == 0);
        result = ply ? slvi_ply_parse(env, path, bytes, size, points, out)
                     : slvi_obj_parse(env, path, bytes, size, points, out);
    }
    slvi_free(bytes);
    return result;
}

slv_result slv_mesh_load(const slv_env *env, const char *path, slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load(&own, path, false, out));
}

slv_result slv_mesh_load_points(const slv_env *env, const char *path, slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load(&own, path, true, out));
}
