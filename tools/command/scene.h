/* A .ptx with the surface that it belongs to, and the view of it: what render and compare start
 * from. */
#ifndef SELVAGE_TOOLS_SCENE_H
#define SELVAGE_TOOLS_SCENE_H

#include "command/displace.h"
#include "command/frames.h"

#include <selvage/bake.h>

/* A camera and its shading, as a view file states them. */
typedef struct scene_view {
    slv_camera camera;
    double world_to_camera[16]; /* the same before it is rounded to floats */
    bool has_camera, has_size, has_shading;
    uint32_t ncameras; /* of a list, the first of which is `camera`; scene_view_free releases it */
    struct scene_view *cameras;
    bool whole_window; /* of which the file says nothing: as much as the picture's proportions take
                          around -1 to 1 */
    bool has_fov;      /* for an orbit: how it is projected */
    float fov;         /* degrees; 0 without perspective */
    uint32_t size[2];
    slv_shading shading;
    float ka, kd;
    char light[DISPLACE_PATH]; /* of the shading by an image; empty: none is named */
    float light_turn;
    slv_boundary boundary; /* default if the file does not say */
    slv_scheme scheme;
    bool has_scheme;
    bool has_alpha;
    slv_alpha_mode alpha;
    bool premultiplied; /* without has_alpha, too */
    displace_settings displacement;
} scene_view;

/* Reads a view file (JSON), see docs/view-files.md. */
slv_result scene_load_view(const slv_env *env, const char *path, scene_view *out);
void scene_view_free(scene_view *view);
/* Light from an image of all directions, turned by so many degrees. */
slv_result scene_load_light(const slv_env *env, const char *path, float turn, slv_light *out);
/* The view's camera for a mesh, whose positions are relative to its origin. */
slv_camera scene_view_camera(const scene_view *view, const slv_mesh *mesh);
/* Makes a window wider or higher to have the proportions width / height = aspect. */
void scene_fit_window(float window[4], float aspect);

/* What loading a scene goes through, one after the other. */
typedef enum scene_step {
    SCENE_STEP_MESH = 0,
    SCENE_STEP_ADJACENCY,
    SCENE_STEP_SURFACE,
    SCENE_STEP_TEXELS,
    SCENE_STEPS
} scene_step;

typedef struct scene_params {
    const char *ptx, *mesh; /* mesh may be NULL: the geometry inside the .ptx */
    slv_scheme scheme;
    bool scheme_given; /* else that of triangles is Loop's */
    slv_texture_encoding encoding;
    slv_boundary boundary;
    int adjacency;     /* 0 they must agree, 1 the file's, 2 the mesh's */
    const char *focus; /* NULL, or the group of the mesh that the camera frames */
    bool salvage;      /* faces that cannot be read are filled */
    bool moves;        /* the surface will be moved */
    slv_alpha_mode alpha;
    bool premultiplied; /* colours are stored multiplied by alpha */
    bool environment;   /* six faces are a sphere, whatever geometry there is */
    void (*begins)(void *user, scene_step step); /* NULL: nobody is told */
    void *user;
    slv_progress progress; /* of the texels: as slv_ptx_open_params has it */
} scene_params;

typedef struct scene {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_scheme scheme; /* of the surface */
    slv_texture *texture;
    slv_texture *triangles;             /* NULL, or what the texture of sub-faces was made of */
    float bounds_min[3], bounds_max[3]; /* of the mesh, or of the group in focus */
    slv_border_mode border_u, border_v; /* how the texture is drawn */
    slv_edge_filter edge_filter;        /* likewise */
    bool even;                          /* reductions agree: looked up in even levels */
    slv_alpha_mode alpha;               /* too: colours are then multiplied by alpha */
    bool premultiplied;                 /* they are in the file */
    bool raw;                           /* numbers are not light */
    uint32_t ndamaged; /* faces of the mesh that could not be read and were filled */
    uint8_t *damaged;  /* of each of its faces, whether it was; NULL: none */
    displace_open displace;
    bool environment; /* the mesh is a cube, to be moved onto a sphere */
    slv_displacement sphere;
    frames_list frames;  /* of verbs that write several pictures */
    slv_bake_source *uv; /* NULL, or what is shown in place of a texture: */
    slv_uv_images images;
} scene_data;

/* A warning that alpha was asked for where nothing has any. */
void scene_warn_of_alpha(const char *path, slv_alpha_mode wanted);
/* What is made of alpha in a file of which all channels are shown, as far as there are four. */
slv_alpha_mode scene_alpha_of(const slv_ptx_info *info, slv_alpha_mode wanted);
slv_result scene_load(const slv_env *env, const scene_params *params, scene_data *out);
/* The same in two steps: all but the texels, and then those, at their own resolutions or others.
 * The file is the caller's; it is NULL after a failure. */
slv_result scene_load_model(const slv_env *env, const scene_params *params, slv_ptx **ptx,
                            scene_data *out);
slv_result scene_load_texels(const slv_env *env, const slv_ptx *ptx, const slv_res *res,
                             slv_texture_encoding encoding, scene_data *out);
/* A mesh and an image through its texture coordinates: there is no texture then. */
slv_result scene_load_images(const slv_env *env, const scene_params *params, const slv_bake_uv *uv,
                             const char *image, scene_data *out);
/* The geometry inside a .ptx; if there is none, says that `option`, "--mesh FILE.obj", gives it. */
slv_result scene_load_geometry(const slv_env *env, const slv_ptx *ptx, const char *option,
                               slv_mesh **out);
/* Whether all polygons have three vertices. */
static inline bool scene_is_of_triangles(const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        if (view->poly_sizes[poly] != 3)
            return false;
    return true;
}
void scene_free(scene_data *scene);
/* Which face of the file a face of the scene is part of, or -1 if it is none. */
int32_t scene_file_face(const scene_data *scene, int32_t face);

/* What the verbs that make one picture ask about the scene and the view of it. */
typedef struct scene_options {
    const char *mesh, *view, *focus, *channels, *light;
    int alpha;        /* slv_alpha_mode */
    bool alpha_given; /* else the view's, if that says so */
    int straight;     /* 0 if colours are stored multiplied by alpha */
    bool straight_given;
    bool raw; /* numbers are not light */
    bool environment, latlong;
    int round;          /* 1 u goes round, 2 v, 3 both */
    const char *frames; /* meshes that move, for verbs that write several pictures */
    uint32_t turntable; /* how many pictures around, or 0 */
    bool numbered;      /* the verb writes as many as a view file has cameras */
    const char *uv;     /* an image for the mesh that the verb's argument is then */
    int scheme, boundary, shading, adjacency, encoding; /* encoding: slv_texture_encoding */
    bool scheme_given, boundary_given, shading_given, size_given, orbit_given, fov_given,
        light_turn_given, progress, quiet, salvage;
    uint32_t size[2], tess, threads;
    float azimuth, elevation, fov, background[4], light_turn;
    displace_options displace;
} scene_options;

/* Of the verbs that draw. */
#define SCENE_ALPHA(mode, straight, what, given, straight_given)                                   \
    {"--alpha",                                                                                    \
     CLI_CHOICE,                                                                                   \
     mode,                                                                                         \
     "what a channel of alpha does: show what lies behind, cut out what is below 1/2, or "         \
     "nothing (" what ")",                                                                         \
     names_alpha_modes(),                                                                          \
     0,                                                                                            \
     0,                                                                                            \
     given},                                                                                       \
    {                                                                                              \
        "--premultiplied", CLI_MODE, straight,                                                     \
            "colours are stored multiplied by alpha: yes, which the word alone says, or no",       \
            "yes|no", 0, 0, straight_given                                                         \
    }
#define SCENE_EVEN_LEVELS(value, given)                                                            \
    {                                                                                              \
        "--even-levels", CLI_MODE, value,                                                          \
            "no seams between faces of different shapes seen from afar, and a little less sharp: " \
            "yes, which the word alone says, or no (where the file's reductions agree)",           \
            "yes|no", 0, 0, given                                                                  \
    }
#define SCENE_UV(value)                                                                            \
    {                                                                                              \
        "--uv", CLI_TEXT, value,                                                                   \
            "draw this image, or a set of tiles (name.<UDIM>.exr), through texture coordinates: "  \
            "the argument is the mesh that has them",                                              \
            "IMAGE", 0, 0, NULL                                                                    \
    }
#define SCENE_ROUND(value)                                                                         \
    {                                                                                              \
        "--round", CLI_CHOICE, value,                                                              \
            "with --uv: coordinates that go round, one value a vertex (selvage wrap)",             \
            names_rounds(), 0, 0, NULL                                                             \
    }
#define SCENE_ENVIRONMENT(value)                                                                   \
    {                                                                                              \
        "--environment", CLI_FLAG, value,                                                          \
            "six faces are what is seen in all directions, and are drawn on a sphere (where "      \
            "there "                                                                               \
            "is no geometry)",                                                                     \
            NULL, 0, 0, NULL                                                                       \
    }
#define SCENE_LATLONG(value)                                                                       \
    {                                                                                              \
        "--latlong", CLI_FLAG, value,                                                              \
            "an environment as a map of latitude and longitude, +z in the middle (512x256)", NULL, \
            0, 0, NULL                                                                             \
    }
#define SCENE_FRAMES(value)                                                                        \
    {                                                                                              \
        "--frames", CLI_TEXT, value,                                                               \
            "a picture of each of these, with the vertices of the mesh elsewhere; #### stands "    \
            "for "                                                                                 \
            "the number, in the picture's name too",                                               \
            "MESH.####.obj", 0, 0, NULL                                                            \
    }
#define SCENE_TURNTABLE(value)                                                                     \
    {                                                                                              \
        "--turntable", CLI_UINT, value, "so many numbered pictures from all around", NULL, 1,      \
            FRAMES_MOST, NULL                                                                      \
    }
/* Rows that compare has too. */
#define SCENE_VIEW(kind, value, help)                                                              \
    { "--view|-v", kind, value, help, "FILE.json", 0, 0, NULL }
#define SCENE_AZIMUTH(value, help, given)                                                          \
    { "--azimuth", CLI_FLOAT, value, help, "DEG", 0, 0, given }
#define SCENE_ELEVATION(value, given)                                                              \
    { "--elevation", CLI_FLOAT, value, "degrees above the horizon (20)", "DEG", 0, 0, given }
#define SCENE_FOCUS(value, given)                                                                  \
    {                                                                                              \
        "--focus", CLI_TEXT, value,                                                                \
            "frame this group (g, o) of the OBJ instead of the whole mesh", "GROUP", 0, 0, given   \
    }
#define SCENE_FOV(value, given)                                                                    \
    {                                                                                              \
        "--fov", CLI_FLOAT, value, "vertical field of view; 0 is orthographic (35)", "DEG", 0, 0,  \
            given                                                                                  \
    }
#define SCENE_SHADING(value, help, given)                                                          \
    { "--shading", CLI_CHOICE, value, help, names_shadings(), 0, 0, given }
#define SCENE_LIGHT(value, turn, turn_given)                                                       \
    {                                                                                              \
        "--light",                                                                                 \
        CLI_TEXT,                                                                                  \
        value,                                                                                     \
        "light the surface by this map of all directions, +z in the middle (shading image)",       \
        "IMAGE",                                                                                   \
        0,                                                                                         \
        0,                                                                                         \
        NULL},                                                                                     \
    {                                                                                              \
        "--light-turn", CLI_FLOAT, turn, "turn that light around the y axis, from +z to +x (0)",   \
            "DEG", 0, 0, turn_given                                                                \
    }
#define SCENE_SCHEME(value, given)                                                                 \
    {                                                                                              \
        "--scheme", CLI_CHOICE, value,                                                             \
            "subdivision scheme (the view's, else catmark, of triangles loop)", names_schemes(),   \
            0, 0, given                                                                            \
    }
#define SCENE_BOUNDARY(value, help, given)                                                         \
    { "--boundary", CLI_CHOICE, value, help, names_boundaries(), 0, 0, given }
#define SCENE_TESS(value, other)                                                                   \
    {                                                                                              \
        "--tess", CLI_UINT, value, "segments per face edge, a power of two (" other ")", NULL, 2,  \
            128, NULL                                                                              \
    }
#define SCENE_ADJACENCY(value)                                                                     \
    {                                                                                              \
        "--adjacency", CLI_CHOICE, value,                                                          \
            "neighbours: refuse if file and mesh differ (agree), or take the one's",               \
            SCENE_ADJACENCIES, 0, 0, NULL                                                          \
    }
#define SCENE_CONTEXT(value)                                                                       \
    {                                                                                              \
        "--context", CLI_CHOICE, value, "where OpenGL comes from (auto)", names_contexts(), 0, 0,  \
            NULL                                                                                   \
    }
#define SCENE_ANISO(value, help)                                                                   \
    { "--aniso", CLI_UINT, value, help, NULL, 1, 16, NULL }
/* slv_gl_layout */
#define SCENE_LAYOUT(value)                                                                        \
    {                                                                                              \
        "--layout", CLI_CHOICE, value,                                                             \
            "borders, edge-aligned: a layer for each face, or pages that many share (pages)",      \
            "auto|separate|pages", 0, 0, NULL                                                      \
    }

enum { SCENE_OPTION_ROWS = 19 + DISPLACE_OPTION_ROWS };

scene_options scene_options_default(void);
/* SCENE_OPTION_ROWS rows for a verb's table. */
void scene_options_rows(scene_options *options, cli_option *rows);
/* What is wrong with them, for cli_usage; NULL if nothing is. */
const char *scene_options_problem(const scene_options *options);

/* A scene as it is to be shown. */
typedef struct scene_shot {
    scene_data scene;
    slv_camera camera;
    uint32_t width, height;
    slv_tessellation_params tessellation;
    bool salvaged; /* parts of the file could not be read, which has been told */
    slv_shading shading;
    slv_light light;             /* of SLV_SHADE_IMAGE */
    float ka, kd, background[4]; /* colour multiplied by alpha */
} scene_shot;

/* Loads the view and the scene, its texture with the channels that are to be shown, and says where
 * the camera stands. Returns an exit code; scene_free(&out->scene) releases it, after a failure
 * too. */
int scene_load_shot(const cli_command *command, const slv_env *env, const char *ptx,
                    const scene_options *options, scene_shot *out);
/* The name of picture `index` of a list, or of the only one, which has `out` itself. */
slv_result scene_frame_name(const slv_env *env, const frames_list *frames, uint32_t index,
                            const char *out, char path[FRAMES_PATH]);
/* Camera and surface of that picture. */
slv_result scene_frame_set(const slv_env *env, uint32_t index, scene_shot *shot);
/* One warning that a picture shows nothing but background. */
void scene_warn_of_nothing(const char *path);

/* The resolutions that a picture needs of a texture of more than 256 MiB, for free(); NULL for
 * others. */
slv_result scene_choose_detail(const slv_env *env, const slv_ptx *ptx, const scene_shot *shot,
                               slv_res **out);

/* Refuses texels that cannot be in memory, before any of them is read; `res` as in
 * scene_load_texels. */
slv_result scene_check_memory(const slv_env *env, const slv_ptx *ptx, const slv_res *res);

/* Words for options: the names of all strategies; returns `text`. */
#define SCENE_STRATEGIES_SIZE 512
const char *scene_strategies(char *text, size_t size);
/* Those of scene_options.adjacency. */
#define SCENE_ADJACENCIES "agree|ptx|mesh"
#endif
