/* Planes on whose other sides paint is put too: strokes and fills have them alike. */
#ifndef SLV_PAINT_MIRROR_H
#define SLV_PAINT_MIRROR_H

#include <selvage/stroke.h>

/* Bit i of a `which` says that plane i reflects. */
typedef struct slvi_mirrors {
    const slv_paint_surface *surface;
    const slv_mirror *list;
    uint32_t count;
} slvi_mirrors;

/* Whether what is seen is turned over. */
static inline bool slvi_mirror_turns(unsigned which) {
    return (which ^ which >> 1 ^ which >> 2) & 1;
}
/* The point of the surface on the other side, within so far of it; false if there is none. An axis
 * goes along. */
bool slvi_mirror_point(const slvi_mirrors *mirrors, unsigned which, float reach,
                       slv_surface_point *at, float axis[3]);
void slvi_mirror_camera(const slvi_mirrors *mirrors, unsigned which, slv_camera *camera);
/* Ink and mask as the planes show them; the mask's camera is put into *facing. False: a clone whose
 * source has no image. */
bool slvi_mirror_lay(const slvi_mirrors *mirrors, unsigned which, float reach, slv_lay *lay,
                     slv_camera *facing);

#endif
