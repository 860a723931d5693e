/* Inside a brush, and the engine that makes dabs of it. */
#ifndef SLV_PAINT_BRUSH_DATA_H
#define SLV_PAINT_BRUSH_DATA_H

#include <selvage/brush.h>

enum { SLVI_BRUSH_POINTS = 64 };

/* A curve from an input to a setting: `count` pairs, x ascending. */
typedef struct slvi_brush_curve {
    int setting, input, count;
    float points[2 * SLVI_BRUSH_POINTS];
} slvi_brush_curve;

struct slv_brush {
    slv_env env;
    bool is_file;
    slv_brush_params round;
    float *base; /* of each setting of libmypaint */
    slvi_brush_curve *curves;
    uint32_t ncurves;
    char **unknown;
    uint32_t nunknown;
    float radius;
};

/* Settings of libmypaint by name, -1 for none; and what they are kept within. */
int slvi_mypaint_settings(void); /* how many; 0 without libmypaint */
int slvi_mypaint_setting(const char *name);
int slvi_mypaint_input(const char *name);
void slvi_mypaint_range(int setting, float *low, float *base, float *high);
float slvi_mypaint_radius(const slv_brush *brush);

/* A dab in the plane. The angle is in degrees from x towards y. */
typedef struct slvi_plane_dab {
    double x, y, radius;
    float rgb[3], opacity, hardness, aspect, angle;
    float erase, lock_alpha, colorize; /* shares, as libmypaint has them */
} slvi_plane_dab;

/* Where dabs go, and colours come from. */
typedef struct slvi_plane {
    void (*dab)(void *user, const slvi_plane_dab *dab);
    void (*color)(void *user, double x, double y, double radius, float rgba[4]);
    void *user;
} slvi_plane;

/* A stroke of libmypaint; a new one for each stroke, so that its random numbers are the same. */
typedef struct slvi_mypaint slvi_mypaint;
slv_result slvi_mypaint_begin(const slv_brush *brush, const float rgb[3], const slvi_plane *plane,
                              slvi_mypaint **out);
void slvi_mypaint_move(slvi_mypaint *engine, double x, double y, float pressure, float tilt_x,
                       float tilt_y, double seconds);
void slvi_mypaint_end(slvi_mypaint *engine);

void slvi_rgb_to_hsv(const float rgb[3], float hsv[3]);

#endif
