/* A program of somebody else's that calls all three libraries. */
#include <selvage/bake.h>
#include <selvage/gl_texture.h>
#include <selvage/ptx.h>

#include <stdio.h>
#include <string.h>

int main(void) {
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    float rgba[4];
    slv_procedural_evaluate(&(slv_procedural){0}, 0, (const float[3]){0, 0, 0}, rgba);
    printf("selvage %u: %s, %s\n", (unsigned)slv_version(), slv_result_string(SLV_ERROR_IO),
           slv_strategy_at(0)->name);
    /* OpenSubdiv is C++ */
    if (slv_mesh_parse_obj(NULL, "quad", obj, strlen(obj), &mesh) ||
        slv_surface_create(NULL, mesh, NULL, &surface))
        return 1;
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return slv_version() == SLV_VERSION && rgba[3] == 1 &&
                   slv_ptx_open(NULL, "/no/such/file.ptx", &ptx) == SLV_ERROR_IO
               ? 0
               : 1;
}
