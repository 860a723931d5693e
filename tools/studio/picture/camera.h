/* Where the eye is: an orbit around a point that can be moved. */
#ifndef SELVAGE_STUDIO_CAMERA_H
#define SELVAGE_STUDIO_CAMERA_H

#include <selvage/camera.h>

typedef struct studio_camera {
    float target[3];          /* what the eye looks at */
    float azimuth, elevation; /* degrees, as in slv_camera_orbit */
    float fov;                /* degrees, vertical; what it was, too, while it is orthographic */
    float distance;           /* to the target */
    bool orthographic;        /* as high as the picture is at the target */
} studio_camera;

/* Frames a box; keeps the direction. `aspect` is width / height. */
void studio_camera_frame(studio_camera *camera, const float low[3], const float high[3],
                         float aspect);
/* By pixels of a picture that is `height` high. */
void studio_camera_orbit(studio_camera *camera, float dx, float dy);
void studio_camera_pan(studio_camera *camera, float dx, float dy, uint32_t height);
/* More than 1 goes nearer. */
void studio_camera_zoom(studio_camera *camera, float factor);
slv_camera studio_camera_get(const studio_camera *camera, float aspect);
/* The nearest that an orbit has to a camera of any kind: what is lost is a roll. The target is
 * where it passes the middle of a box. */
void studio_camera_set(studio_camera *camera, const slv_camera *from, const float low[3],
                       const float high[3]);

#endif
