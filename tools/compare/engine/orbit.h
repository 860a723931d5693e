/* The path of a comparison's camera. */
#ifndef SELVAGE_TOOLS_ORBIT_H
#define SELVAGE_TOOLS_ORBIT_H

#include <selvage/camera.h>

/* At time t, 0 to 1: azimuth + turn t; elevation + tilt sin(6 pi t); the distance that frames the
 * box, divided by dolly to the power sin(2 pi t), but never inside the box. So t = 0 and 1/2 frame
 * the box, 1/4 is nearest and lowest, 3/4 furthest and highest. An orthographic view becomes larger
 * and smaller instead. */
typedef struct orbit {
    float azimuth, turn, elevation, tilt, fov; /* degrees */
    float dolly;                               /* 1 or more */
    float bounds_min[3], bounds_max[3], aspect;
} orbit;

slv_camera orbit_camera(const orbit *path, double t);

/* The camera moved by a part of a pixel: what was at (x, y) comes to (x - dx, y - dy). */
slv_camera orbit_shifted(const slv_camera *camera, uint32_t width, uint32_t height, float dx,
                         float dy);
/* The camera looking at a part of its picture only, 0 to 1 from the upper left. */
slv_camera orbit_part(const slv_camera *camera, double left, double top, double right,
                      double bottom);

#endif
