/* Pictures of a surface in somebody's OpenGL context: the runtime's renderer, and one pass that
 * puts what it drew onto the screen. No window system. All of it is called with that context
 * current. */
#ifndef SELVAGE_STUDIO_PICTURE_H
#define SELVAGE_STUDIO_PICTURE_H

#include "studio/document.h"
#include "studio/picture/look.h"

#include <selvage/gl_renderer.h>

typedef struct studio_picture studio_picture;

/* Whether the context that is current is one of a driver in software. */
bool studio_picture_in_software(void);
/* Uses the context that is current. */
slv_result studio_picture_create(const slv_env *env, studio_picture **out);
void studio_picture_destroy(studio_picture *picture);
const slv_gl_info *studio_picture_info(const studio_picture *picture);

typedef struct studio_shot {
    studio_look look;
    slv_light light; /* of the shading by an image */
    slv_camera camera;
    uint32_t width, height;        /* of the screen */
    float scale;                   /* what is drawn is so much smaller, 0..1 */
    bool coarse;                   /* one sample a pixel */
    float background[4];           /* linear */
    float cursor[3];               /* of the brush: where, and its radius; 0: none */
    const studio_stencil *stencil; /* NULL: none */
    const uint8_t *meant;          /* of each face, 0: it is darker; NULL: none is */
    bool again; /* nothing but the cursor is another than in the picture before */
} studio_shot;

typedef struct studio_picture_stats {
    double seconds;     /* of the draw, by a GL timer or the clock */
    double update;      /* of bringing the texels up to date */
    uint64_t gpu_bytes; /* of the textures that were made */
    uint32_t draws;
    uint32_t widened;   /* faces that need a wider type than the texture's */
    uint32_t segments;  /* of the overlay's mesh */
    uint64_t triangles; /* of the surface */
} studio_picture_stats;

/* Whether a picture needs nothing to be made first that may take seconds: shaders, and texels on
 * the GPU. */
bool studio_picture_is_ready(const studio_picture *picture, const studio_document *document,
                             const studio_shot *shot);
/* Until that has been said: the picture before, as far as it is one of this surface. */
slv_result studio_picture_keep(studio_picture *picture, const studio_document *document,
                               const studio_shot *shot);
/* Draws into the framebuffer that is bound, whatever its number. The document's texels are
 * followed.
 */
slv_result studio_picture_draw(studio_picture *picture, studio_document *document,
                               const studio_shot *shot, studio_picture_stats *stats);
/* What the last picture that was drawn anew took, in seconds of this thread and of the GPU; below
 * zero: the driver does not say. */
void studio_picture_times(const studio_picture *picture, double *cpu, double *gpu);
/* What was drawn last, as it is on the screen, 8 bits in sRGB. */
slv_result studio_picture_read(studio_picture *picture, slv_image *out);
/* The seam jump of one of a look's strategies at what is magnified. */
slv_result studio_picture_seam(studio_picture *picture, studio_document *document,
                               const studio_look *look, uint32_t strategy,
                               const slv_gl_seam_params *params, slv_gl_seam *out);
/* Forgets what was made of the document that is open. */
void studio_picture_forget(studio_picture *picture);

#endif
