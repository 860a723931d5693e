/* selvage-assets FOLDER: writes the demo scene, a mesh and two textures. */
#include "scene.h"

#include <selvage/ptx.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char usage[] =
    "usage: selvage-assets OUTDIR\n"
    "\n"
    "Makes the demo scene and writes it into the folder OUTDIR:\n"
    "  scene.obj        a creature and the ground beneath it, groups \"creature\" and \"ground\"\n"
    "  scene.ptx        its texture: stripes and noise, continuous in space, of mixed resolutions\n"
    "  scene_faces.ptx  the same with a base colour of its own for every face\n";

static void print_message(void *user, slv_log_level level, const char *message) {
    static const char *const words[] = {"", "warning: ", "error: "};
    (void)user;
    fprintf(stderr, "selvage-assets: %s%s\n", words[level], message);
}

static bool path_join(char *out, size_t size, const char *folder, const char *name) {
    int length = snprintf(out, size, "%s/%s", folder, name);
    if (length >= 0 && (size_t)length < size)
        return true;
    fprintf(stderr, "selvage-assets: error: %s: the path is too long\n", folder);
    return false;
}

static slv_result write_texture(const slv_env *env, const struct scene *scene, const char *folder,
                                const char *name, const slv_mesh *mesh,
                                const slv_adjacency *adjacency, const slv_surface *surface,
                                float face_tint) {
    char path[4096];
    slv_texture *texture = NULL;
    if (!path_join(path, sizeof path, folder, name))
        return SLV_ERROR_ARGUMENT;
    slv_result result = scene_bake(env, scene, surface, face_tint, &texture);
    if (!result)
        result = slv_ptx_save(env, path, texture, adjacency, &(slv_ptx_write_params){.mesh = mesh});
    slv_texture_destroy(texture);
    if (!result)
        printf("%s\n", path);
    return result;
}

static int write_all(const slv_env *env, const struct scene *scene, const char *folder) {
    char path[4096];
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    int status = 1;
    if (!path_join(path, sizeof path, folder, "scene.obj"))
        goto done;
    if (scene_save_obj(env, scene, path))
        goto done;
    printf("%s\n", path);
    /* The textures are made for the mesh as the file has it. */
    if (slv_mesh_load(env, path, &mesh) || slv_mesh_adjacency(env, mesh, &adjacency) ||
        slv_surface_create(env, mesh, NULL, &surface))
        goto done;
    if (write_texture(env, scene, folder, "scene.ptx", mesh, adjacency, surface, 0) ||
        write_texture(env, scene, folder, "scene_faces.ptx", mesh, adjacency, surface, 0.55f))
        goto done;
    status = 0;
done:
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    return status;
}

int main(int argc, char **argv) {
    if (argc == 2 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
        fputs(usage, stdout);
        return 0;
    }
    if (argc != 2 || argv[1][0] == '-') {
        fputs(usage, stderr);
        return 2;
    }
    const slv_env env = {.log = print_message};
    if (mkdir(argv[1], 0777) && errno != EEXIST) {
        fprintf(stderr, "selvage-assets: error: %s: %s\n", argv[1], strerror(errno));
        return 1;
    }
    struct scene *scene = calloc(1, sizeof *scene);
    int status = 1;
    if (scene && scene_build(scene))
        status = write_all(&env, scene, argv[1]);
    else
        fputs("selvage-assets: error: out of memory\n", stderr);
    scene_free(scene);
    return status;
}
