/* A smooth curve through the samples of a pen. */
#ifndef SLV_PAINT_PATH_H
#define SLV_PAINT_PATH_H

#include <stdbool.h>
#include <stdint.h>

/* In the plane of the canvas. */
typedef struct slvi_path_point {
    double x, y, time;
    float pressure, tilt_x, tilt_y;
} slvi_path_point;

/* The curve is handed on as short straight pieces, each from the end of the one before. */
typedef struct slvi_path {
    void (*piece)(void *user, const slvi_path_point *from, const slvi_path_point *to);
    void *user;
    double smallest;         /* shorter stretches are no stretches */
    slvi_path_point last[3]; /* samples: the newest at count - 1 */
    uint32_t count;
} slvi_path;

void slvi_path_add(slvi_path *path, const slvi_path_point *sample);
/* Hands on what waited; the next sample begins a curve. */
void slvi_path_end(slvi_path *path);

#endif
