/* Maps of environments: all directions in one picture. */
#ifndef SELVAGE_TOOLS_LATLONG_H
#define SELVAGE_TOOLS_LATLONG_H

#include <selvage/image.h>
#include <selvage/mesh.h>

/* Points of the six faces, with footprints as slv_gl_texture_lookup takes them; room for four
 * floats each in `values`. */
typedef struct latlong_points {
    uint32_t count;
    int32_t *faces;
    float *uv, *dx, *dy, *values;
} latlong_points;

/* Fills `values`. */
typedef slv_result (*latlong_look)(void *user, const slv_env *env, const latlong_points *points);

/* Draws the environment around the middle of a cube (slv_mesh_create_cube), whose corners are at 1
 * and -1: +z is in the middle of the picture, +y at the top, and +x a quarter to the left, as one
 * who stands inside sees it and as OpenEXR has maps of latitude and longitude. Each pixel is the
 * mean of side x side lookups. `out` has four channels. */
slv_result latlong_draw(const slv_env *env, const slv_mesh *cube, uint32_t width, uint32_t height,
                        uint32_t side, latlong_look look, void *user, slv_image *out);

#endif
