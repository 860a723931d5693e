/* Lines and colours over a picture, of which a face and its size is enough to know. */
#ifndef SELVAGE_STUDIO_OVERLAY_H
#define SELVAGE_STUDIO_OVERLAY_H

#include "studio/picture/picture.h"

typedef struct studio_overlay_pass studio_overlay_pass;

/* A picture that is there already, and what of which strategy it shows. */
typedef struct studio_overlay_target {
    unsigned framebuffer;
    const slv_gl_texture *texture;
    const slv_strategy *strategy;
} studio_overlay_target;

/* Whether a look has anything to draw over pictures. */
bool studio_overlay_wanted(const studio_look *look);
/* Draws over one picture, or two. The pass is made when it is first needed. */
slv_result studio_overlay_draw(studio_overlay_pass **pass, const studio_document *document,
                               const studio_shot *shot, uint32_t segments,
                               const studio_overlay_target *targets, uint32_t count);
void studio_overlay_destroy(studio_overlay_pass *pass);

#endif
