/* Texture coordinates at the corners of faces, as slv_mesh_face_texcoords has them, and what is the
 * matter with some. */
#ifndef SLV_BAKE_UV_CORNERS_H
#define SLV_BAKE_UV_CORNERS_H

#include <selvage/bake.h>

/* Faces that nothing can be looked up with; the first of each kind. */
typedef struct uv_lacking {
    uint32_t none, first_none; /* that have none */
    uint32_t far, first_far;   /* that have some beyond all reason */
} uv_lacking;

/* Makes the first of a face's coordinates NaN if one of them is, or is beyond all reason. */
uv_lacking slvi_uv_check_corners(float *corners, uint32_t nfaces);
/* One warning for each kind; `path` is the image's. */
void slvi_uv_warn_of_lacking(const slv_env *env, const char *path, const uv_lacking *lacking,
                             uint32_t nfaces);
/* Of a face over half of the map both ways round are as short, or the wrong one is. Where nothing
 * goes round: of those that run backward, as faces do over the end of a map that should. */
void slvi_uv_warn_of_wide(const slv_env *env, const char *path, const float *corners,
                          uint32_t nfaces, const bool round[2]);
/* Whether no face leaves 0..1 along an axis. */
bool slvi_uv_stays(const float *corners, uint32_t nfaces, int axis);

#endif
