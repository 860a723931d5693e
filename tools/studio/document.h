/* What is open in the studio: a mesh with its texture, and the session in which it is painted. No
 * window and no OpenGL: what is done here a script could do. */
#ifndef SELVAGE_STUDIO_DOCUMENT_H
#define SELVAGE_STUDIO_DOCUMENT_H

#include "command/scene.h"

#include <selvage/session.h>

#include <stdatomic.h>

typedef enum studio_kind {
    STUDIO_NOTHING = 0,
    STUDIO_PTX,
    STUDIO_MESH,
    STUDIO_SESSION
} studio_kind;

/* What opening does, one after the other. */
typedef enum studio_step {
    STUDIO_STEP_MESH = 0, /* or the session */
    STUDIO_STEP_ADJACENCY,
    STUDIO_STEP_SURFACE,
    STUDIO_STEP_TEXELS,
    STUDIO_STEPS
} studio_step;

/* Between the thread that opens and the one that waits. */
typedef struct studio_work {
    atomic_bool cancelled; /* whoever works for it gets no more memory, and fails soon */
    atomic_int step;       /* studio_step */
    atomic_uint part; /* of that step, how many thousandths are done, as far as that is known */
} studio_work;

/* A file is shown as it is until something is done to it. Then there is a session in the folder of
 * unfinished work, named by the file's path, so that it is found there should the program end. */
enum { STUDIO_MESSAGE = 512 };

typedef struct studio_document {
    slv_env env;   /* its log writes `message`, which what is made with it remembers */
    char *message; /* what went wrong last, in words; STUDIO_MESSAGE bytes */
    studio_work *work;
    studio_kind kind;
    char *path;   /* what was opened; absolute */
    char *target; /* where saving goes: a session, a .ptx; NULL: not known yet */
    scene_data
        scene; /* texture: NULL once there is a session. Of a session nothing but the surface */
    slv_session *session;
    slv_paint_surface *surface; /* for picking, while there is no session */
    slv_paint_surface *moved;   /* the same as it is displaced; NULL: not needed yet */
    slv_painter *moved_painter;
    bool working;               /* the session is among the unfinished work */
    uint32_t layer;             /* the id of the layer that is painted on */
    bool mask;                  /* its mask, that is */
    uint64_t serial;            /* grows when the texture is another object */
    displace_settings displace; /* what moves the surface that is seen; not given: nothing does */
    uint64_t shape;             /* grows when something else does */
    uint64_t saved_lines;       /* of the journal, when it was saved or exported last */
    slv_texture *texture;       /* borrowed: what is shown */
} studio_document;

/* False: no memory. */
bool studio_document_init(studio_document *document);
/* After studio_document_close. */
void studio_document_end(studio_document *document);
/* A log that writes into STUDIO_MESSAGE bytes. */
void studio_document_note(void *message, slv_log_level level, const char *line);
/* Ends what is open. What was not saved stays among the unfinished work. */
void studio_document_close(studio_document *document);
/* Opens in place of nothing: a .ptx (with a mesh, if it holds none), a mesh, a session. */
slv_result studio_document_open(studio_document *document, const char *path, const char *mesh);
/* From another thread: what it is doing fails, sooner or later. It is good for nothing then. */
void studio_document_cancel(studio_document *document);

/* The unfinished work that a file has, for free(); NULL: there is none. */
char *studio_document_unfinished(const studio_document *document);
/* Goes on with it; or throws it away. */
slv_result studio_document_recover(studio_document *document);
slv_result studio_document_discard(studio_document *document);

/* Makes a session, if there is none yet: from then on it can be painted on. */
slv_result studio_document_need_session(studio_document *document);
slv_document *studio_document_layers(const studio_document *document); /* NULL: no session yet */
/* After anything was done to the session: the texture follows. */
slv_result studio_document_refresh(studio_document *document);
/* Its numbers are no colours. False if nothing is open. */
bool studio_document_is_data(const studio_document *document);
bool studio_document_is_unsaved(const studio_document *document);

/* To `target`. SLV_ERROR_ARGUMENT if it is not known. */
slv_result studio_document_save(studio_document *document);
/* To a session or, by the ending of its name, a .ptx, which is `target` from then on. */
slv_result studio_document_save_as(studio_document *document, const char *path);
/* A .ptx, and nothing else changes. */
slv_result studio_document_export(studio_document *document, const char *path);

/* Moves the surface that is seen, as scene.displace does then. What is picked lies on that; the
 * session's own surface stays as it is. */
slv_result studio_document_displace(studio_document *document, const displace_settings *settings);

const slv_displacement *studio_document_displacement(const studio_document *document);

slv_scheme studio_document_scheme(const studio_document *document);
const slv_mesh *studio_document_mesh(const studio_document *document);
const slv_adjacency *studio_document_adjacency(const studio_document *document);
/* pick.c */
/* Before what displaces the surface is another. */
void studio_document_forget_moved(studio_document *document);
/* Where a place in a picture lies, on the surface as it is seen. False if nothing is there, or want
 * of memory. */
bool studio_document_pick(studio_document *document, const slv_camera *camera, uint32_t width,
                          uint32_t height, float x, float y, slv_paint_hit *out);

/* Where a point lies on the surface that is painted on, which nothing displaces. */
bool studio_document_place(studio_document *document, slv_surface_point point, float out[3]);

/* Texels a unit of the mesh along a face, of what is shown: the root of how many a square has. 0:
 * want of memory. */
float studio_document_density(studio_document *document, uint32_t face);

/* The faces that a disc of a picture covers, of those that are
 * selected: bytes of `touched`, one for each face, become 1. There must be a session. */
slv_result studio_document_cover(studio_document *document, const slv_screen_dab *dab,
                                 uint8_t *touched);

#endif
