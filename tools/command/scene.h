/* A .ptx with the surface that it belongs to, and the view of it: what render and compare start
 * from. */
#ifndef SELVAGE_TOOLS_SCENE_H
#define SELVAGE_TOOLS_SCENE_H

#include "command/cli.h"

/* A camera and its shading, as a view file states them. */
typedef struct scene_view {
    slv_camera camera;
    double world_to_camera[16]; /* the same before it is rounded to floats */
    bool has_camera, has_size, has_shading;
    uint32_t size[2];
    slv_shading shading;
    float ka, kd;
    slv_boundary boundary; /* default if the file does not say */
    slv_scheme scheme;
    bool has_scheme;
} scene_view;

/* Reads a view file (JSON): size, world_to_camera, projection, screen_window, shading {model, ka,
 * kd}, boundary, scheme. */
slv_result scene_load_view(const slv_env *env, const char *path, scene_view *out);
/* The view's camera for a mesh, whose positions are relative to its origin. */
slv_camera scene_view_camera(const scene_view *view, const slv_mesh *mesh);

typedef struct scene_params {
    const char *ptx, *mesh; /* mesh may be NULL: the geometry inside the .ptx */
    slv_scheme scheme;
    slv_boundary boundary;
    int adjacency;     /* 0 they must agree, 1 the file's, 2 the mesh's */
    const char *focus; /* NULL, or the group of the mesh that the camera frames */
    bool salvage;      /* faces that cannot be read are filled */
} scene_params;

typedef struct scene {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_texture *texture;
    float bounds_min[3], bounds_max[3]; /* of the mesh, or of the group in focus */
    bool salvaged;                      /* faces were filled, which has been told */
} scene_data;

slv_result scene_load(const slv_env *env, const scene_params *params, scene_data *out);
void scene_free(scene_data *scene);

/* What the verbs that make one picture ask about the scene and the view of it. */
typedef struct scene_options {
    const char *mesh, *view, *focus;
    int scheme, boundary, shading, adjacency;
    bool scheme_given, boundary_given, shading_given, size_given, orbit_given, salvage;
    uint32_t size[2], tess, threads, channel, nchannels;
    float azimuth, elevation, fov, background[4];
} scene_options;

enum { SCENE_OPTION_ROWS = 16 };

scene_options scene_options_default(void);
/* SCENE_OPTION_ROWS rows for a verb's table. */
void scene_options_rows(scene_options *options, cli_option *rows);
/* What is wrong with them, for cli_usage; NULL if nothing is. */
const char *scene_options_problem(const scene_options *options);

/* A scene as it is to be shown. */
typedef struct scene_shot {
    scene_data scene;
    slv_camera camera;
    uint32_t width, height, segments;
    slv_shading shading;
    float ka, kd, background[4]; /* colour multiplied by alpha */
} scene_shot;

/* Loads the view and the scene, and says where the camera stands. scene_free(&out->scene) releases
 * it, after a failure too. */
slv_result scene_load_shot(const slv_env *env, const char *ptx, const scene_options *options,
                           scene_shot *out);

/* Words for options: the names of all strategies; returns `text`. */
#define SCENE_STRATEGIES_SIZE 512
const char *scene_strategies(char *text, size_t size);
/* Others, in the order of the enumerations. */
#define SCENE_SCHEMES "catmark|bilinear"
#define SCENE_BOUNDARIES "default|none|edge-only|edge-and-corner"
#define SCENE_SHADINGS "headlight|headlight-abs|unlit|faces|levels"
#define SCENE_CONTEXTS "auto|egl|osmesa"
#define SCENE_ADJACENCIES "agree|ptx|mesh"

#endif
