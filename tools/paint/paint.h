/* What the parts of the verb paint share: what is painted on, and pictures of it. */
#ifndef SELVAGE_TOOLS_PAINT_H
#define SELVAGE_TOOLS_PAINT_H

#include "command/line_log.h"
#include "command/scene.h"

#include <selvage/gl_live.h>
#include <selvage/gl_renderer.h>
#include <selvage/ptx_writer.h>
#include <selvage/session.h>

/* What is painted on: a texture of floats, so that thin paint adds up, which is rounded when it is
 * written; or a session. */
typedef struct easel {
    const char *name, *mesh_path; /* mesh_path may be NULL */
    slv_scheme scheme;
    slv_boundary boundary;
    slv_mesh *mesh; /* of a session: its own */
    /* of a texture */
    slv_ptx *ptx; /* NULL: a mesh was named */
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_texture *texture;
    slv_ptx_writer_params writer;
    slv_script *script;
    /* of a session */
    slv_session *session;
    uint32_t layer;
    line_log log; /* which errors of lines go through */
    char folder[4096];
} easel;

/* Of a texture or a mesh. */
slv_result easel_open(const slv_env *env, easel *e);
/* Of a session, which stays as it was if it is `unkept`. `layer` 0: its topmost. */
slv_result easel_open_session(const slv_env *env, easel *e, uint32_t layer, bool unkept);
/* A new session of a texture or a mesh. */
slv_result easel_make_session(const slv_env *env, easel *e, const char *path);
void easel_close(easel *e);

/* A script's lines, one after the other; `script` is its name. */
slv_result easel_begin(const slv_env *env, easel *e, const char *script,
                       void (*unknown)(void *user, const char *brush, const char *setting),
                       void *user);
slv_result easel_run(easel *e, uint64_t number, const char *line, size_t size);

/* What it all shows, as it is now. Owned by the easel. */
slv_result easel_texture(easel *e, slv_texture **out);
const slv_adjacency *easel_adjacency(const easel *e);
void easel_stats(const easel *e, slv_script_stats *out);
bool easel_touched(const easel *e, uint32_t face);
uint32_t easel_faces(const easel *e);

/* Writes a .ptx. */
slv_result easel_save(const slv_env *env, easel *e, const char *path, bool forced, bool quiet);

/* Numbered pictures of what is painted. */
typedef struct record {
    const char *out;
    float azimuth, elevation, fov;
    slv_frame frame; /* has the picture's size */
    slv_gl *gl;
    slv_surface *surface;
    slv_texture *shown; /* what the GPU has */
    slv_gl_texture *texture;
    slv_gl_renderer *renderer;
    slv_image_params file;
    uint32_t next; /* the number of the next picture */
} record;

slv_result record_begin(const slv_env *env, record *r, easel *e);
slv_result record_picture(const slv_env *env, record *r, easel *e);
void record_end(record *r);

#endif
