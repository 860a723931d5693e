/* Textures larger than the memory of the GPU, or of the machine: of each face there are as many
 * texels as the eye can tell, within a budget. Coarse levels of all faces are always there; finer
 * ones are read in the background and come when they are there.
 *
 *     slv_gl_residency_create(gl, env, &source, adjacency, corners, &params, &residency);
 *     ...
 *     slv_gl_residency_update(residency, env, &camera, width, height, &state);   once a frame
 *     draw slv_gl_residency_texture(residency)
 *
 * A face is held at a level (texture.h) and shown with that and coarser ones, which are those of
 * the whole texture, bit for bit. It looks as if all of it were there when its level is no coarser
 * than its size on the screen needs; but for a strip along edges where the faces' texels are of
 * other sizes, since what is there decides how they are joined. Where there is room, faces that are
 * seen become finer than that, once all that is needed is there, so that of a texture that fits all
 * is there in the end and pictures are the same.
 *
 * At first faces have the reductions that the source has, which are there at once; those that are
 * seen are exchanged for means of all texels. What is not needed any more stays as long as there is
 * room; then faces are made coarser out of what they have, without a wait for the source. */
#ifndef SELVAGE_GL_RESIDENCY_H
#define SELVAGE_GL_RESIDENCY_H

#include <selvage/camera.h>
#include <selvage/gl_live.h>
#include <selvage/source.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. */
typedef struct slv_gl_residency_params {
    slv_gl_texture_params texture; /* `live` is set, and `binding` to units, since arrays come and
                                      go in each update; compression goes through */
    uint64_t gpu_bytes;  /* most bytes of arrays and tables at any moment; 0 means 256 MiB */
    uint64_t host_bytes; /* most bytes of texels held here, levels and what is being read included;
                            what the source holds is not. 0 means 256 MiB */
    uint64_t upload_bytes; /* most bytes of texels that an update takes from what was read, but for
                              a single face; 0 means 4 MiB. Faces that change count for a sixteenth
                              of it at least, since those around them change, too */
    uint32_t coarse_log2;  /* log2 of the texels along the longer side that each face always has;
                              0 means 3 */
    uint32_t readers;      /* threads that read; 0 means 2, at most 16 */
    uint64_t reserved[4];
} slv_gl_residency_params;

typedef struct slv_gl_residency_state {
    uint64_t gpu_bytes, host_bytes; /* now in use */
    uint32_t waiting;               /* faces of which finer texels are wanted than there are */
    uint32_t failed;                /* that could not be read; they stay as they are */
    uint32_t bias; /* levels by which faces are coarser than wanted, for want of memory */
    bool settled;  /* nothing is being read, nor will be for this camera: the picture is final */
    uint64_t reserved[4];
} slv_gl_residency_state;

typedef struct slv_gl_residency slv_gl_residency;

/* Reads the coarse levels and makes the texture of them, which takes time with the number of faces;
 * of a source without reductions, or with alpha, with that of its texels.
 * `source` is taken, also if this fails, and closed in the end; it is read by several threads at
 * once. One of a cache (slv_cache_as_source) keeps what is read within the cache's bounds. Colours
 * of SLV_TEXTURE_SRGB are reduced as light. A source does not say what its colours are: integers
 * are taken for that unless params->texture.encoding says otherwise, as it has to for numbers
 * (SLV_TEXTURE_DATA), even if the source is a texture that says so itself. `adjacency` must outlive
 * it; `corners` are 12 floats a face (slv_mesh_corners), of a mesh in the camera's world, and are
 * copied. SLV_ERROR_LIMIT if the coarse levels alone are more than the budgets. */
SLV_NODISCARD SLV_API slv_result slv_gl_residency_create(
    slv_gl *gl, const slv_env *env, slv_source *source, const slv_adjacency *adjacency,
    const float *corners, const slv_gl_residency_params *params, slv_gl_residency **out);
/* Waits for what is being read. */
SLV_API void slv_gl_residency_destroy(slv_gl_residency *residency);

/* Takes what was read since the last time, and decides what is read next for a camera and a picture
 * of so many pixels; one with a number that is not finite is SLV_ERROR_ARGUMENT. Never waits for
 * the source. On the thread of the context; `out` may be NULL. Leaves GL state as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_residency_update(slv_gl_residency *residency,
                                                         const slv_env *env,
                                                         const slv_camera *camera, uint32_t width,
                                                         uint32_t height,
                                                         slv_gl_residency_state *out);

/* Owned by the residency; batches may be others after an update. */
SLV_API slv_gl_texture *slv_gl_residency_texture(slv_gl_residency *residency);

#ifdef __cplusplus
}
#endif

#endif
