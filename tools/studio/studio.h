/* The window and all that it knows. Whatever is done goes through an action (commands/actions.c),
 * which changes the model and then calls studio_sync: panels and menus show what the model has, and
 * keep nothing of their own. */
#ifndef SELVAGE_STUDIO_STUDIO_H
#define SELVAGE_STUDIO_STUDIO_H

#include "command/frames.h"
#include "studio/brush/brush.h"
#include "studio/picture/camera.h"
#include "studio/picture/picture.h"

#include <gtk/gtk.h>

typedef enum studio_tool {
    STUDIO_VIEW = 0, /* the pointer turns the view */
    STUDIO_PAINT,
    STUDIO_ERASE,
    STUDIO_FILL,
    STUDIO_GRADIENT, /* fills between two places */
    STUDIO_PICK,     /* takes up a colour */
    STUDIO_SELECT,   /* faces that take paint */
    STUDIO_STENCIL,  /* moves the image that is painted through */
    STUDIO_TEXELS,   /* more texels, or fewer, where the brush goes */
    STUDIO_TOOLS
} studio_tool;
extern const char *const studio_tool_names[STUDIO_TOOLS];

/* Making ready what a picture needs first, for which the window stands still: it is said before. */
typedef enum studio_ready {
    STUDIO_READY = 0,
    STUDIO_READY_WANTED, /* it is to be said */
    STUDIO_READY_SAID,   /* and is not on the screen yet */
    STUDIO_READY_SHOWN   /* the next picture may take its time */
} studio_ready;

/* What the pointer drags. */
typedef enum studio_drag {
    STUDIO_DRAG_NONE = 0,
    STUDIO_DRAG_ORBIT,
    STUDIO_DRAG_PAN,
    STUDIO_DRAG_ZOOM,
    STUDIO_DRAG_DIVIDER,
    STUDIO_DRAG_STENCIL,
    STUDIO_DRAG_STENCIL_TURN,
    STUDIO_DRAG_STROKE,
    STUDIO_DRAG_TEXELS,
    STUDIO_DRAG_GRADIENT,
    STUDIO_DRAG_BRUSH /* its size and opacity */
} studio_drag;

enum { STUDIO_BOOKMARKS = 4, STUDIO_RECENT = 8, STUDIO_TURNS = 10000 };
#define STUDIO_EXPOSURE 20.0f /* stops, at most */

/* A stroke from pen down until all of it is painted. */
typedef struct studio_stroke {
    GArray *waiting; /* samples that no dabs were made of yet */
    bool begun;      /* one of its samples has met the surface */
    bool eraser;
    gint64 lifted; /* when the pen was; 0: it is down */
    guint work;    /* the idle moment in which it goes on */
    bool said;     /* that it takes long */
} studio_stroke;

/* The seam jump of a strategy, as far as it is measured: its first so many faces. */
typedef struct studio_seam {
    uint32_t strategy, channel, anisotropy;
    bool other_levels;
    uint32_t next;
    double sum; /* of the means of all edges */
    slv_gl_seam found;
} studio_seam;

typedef struct studio_app {
    GtkApplication *application;
    GtkWindow *window;
    GtkGLArea *area;
    GtkStack *stack;
    GtkWidget *bar, *bar_text, *page_text, *status, *inspector, *live, *layers, *saved, *history,
        *brushes_list, *swatch_list;
    GtkWidget *bar_button, *layer_blend, *layer_opacity;
    guint fade;             /* the timer that waits for its slider to be let go of */
    const char *bar_action; /* what its button does */
    uint32_t history_first; /* how many things its first row has done */
    guint history_scroll;   /* an idle moment in which it is scrolled */
    GtkWidget *sliders[4], *color_buttons[2];
    GMenu *recent_menu;

    GQueue asked; /* actions that wait for a stroke's end */
    studio_document document;
    studio_camera camera;
    studio_look look;
    slv_light light;          /* of an image, before it is turned */
    char *light_path;         /* of that image; NULL: none was chosen */
    char *light_kept;         /* the one of the last time, until it is read */
    studio_encoding encoding; /* that pictures of colours have */
    studio_paint paint;
    studio_brushes brushes;
    studio_swatch swatches[STUDIO_SWATCHES];
    studio_tool tool;
    studio_camera bookmarks[STUDIO_BOOKMARKS];
    bool bookmarked[STUDIO_BOOKMARKS];
    char *recent[STUDIO_RECENT];

    studio_picture *picture;
    studio_picture_stats stats;
    studio_seam seams[2];           /* of what is shown, and of what is beside it */
    uint32_t seam_faces;            /* so many are measured at once */
    guint seam_work;                /* the moment in which they are */
    bool seam_asked;                /* to be said above the picture */
    const char *pending;            /* a file that is to be opened */
    struct studio_opening *opening; /* that is being opened; NULL: none is */
    GtkWidget *opening_text, *opening_bar;
    char *mesh_path; /* of the command line */
    bool loading, closing, syncing, dark;
    bool thrown_away; /* what is not saved, as soon as something else is open */
    bool asking;      /* a question or a file chooser is open, and nothing else is done */
    bool dirty;       /* the document is ahead of its texture */
    bool stale;       /* the picture is not what it was drawn of */
    bool framed;      /* the camera fits what is open */

    studio_drag drag;
    guint button; /* that it began with, and ends with */
    studio_stroke stroke;
    uint8_t *touched;        /* of each face, whether a drag of the resolution brush was there */
    bool fewer;              /* that drag takes texels away */
    float density;           /* texels a unit that it gives instead; 0: none */
    double x, y, start_time; /* of the pointer, in pixels of the area */
    double held[2];          /* where a drag began: of size and opacity, or of a gradient */
    float pressure, tilt[2];
    bool pointer_inside;
    gint64 began;   /* when a picture of what moves was, which is not on the screen yet; 0: none */
    gulong painted; /* the handler for when it is */
    gint64 moved;   /* when something moved last, of the monotonic clock */
    guint rest;     /* the timer that refines */
    guint32 input;  /* the display's time of the oldest event that no picture shows yet; 0: none */
    uint32_t frames;
    bool refined;
    studio_ready ready;
    float scale;   /* of pictures that move */
    guint follow;  /* panels follow the pictures */
    guint flicker; /* the timer that changes sides */

    int size[2]; /* of the picture, as the command line wants it; 0: as it comes */
    const char *pen_path;
    FILE *log;           /* lines of what happens; NULL: nobody asked */
    gint64 watched;      /* for it: when the window was last seen to answer */
    double worked;       /* and the seconds of processors until then */
    GSubprocess *report; /* that is being made; NULL: none */
    char *report_path;
    char *screenshot;      /* to be written after the next fine picture */
    frames_list turntable; /* that is being written; no cameras: none is */
    uint32_t turned;       /* so many of its pictures are */
    uint32_t turns;        /* of how many, if nobody asks for another number */
    char *turntable_path;
} studio_app;

/* commands/actions.c */
void studio_actions_add(studio_app *app);
GMenuModel *studio_actions_menu(studio_app *app);
GtkWidget *studio_actions_shortcuts(studio_app *app);
/* A row of buttons, each of an action (with its prefix) and said by its tip. */
typedef struct studio_button {
    const char *icon, *action, *tip;
} studio_button;
GtkWidget *studio_actions_buttons(const studio_button *buttons, size_t count);
/* As menus and keys do. `target` may be NULL. While a stroke is still being painted whose pen was
 * lifted, what neither ends nor undoes it waits for its end. */
void studio_actions_run(studio_app *app, const char *name, const char *target);
/* What has waited. */
void studio_actions_run_asked(studio_app *app);

/* window.c */
void studio_window_create(studio_app *app);
void studio_open(studio_app *app, const char *path);
/* Lets go of a file that is being opened: what was open before stays. */
void studio_open_cancel(studio_app *app);
/* After a change of the model: everything that shows it. */
void studio_sync(studio_app *app);
/* In words, above the picture; NULL takes it away. With `action` there is a button for it. */
void studio_say(studio_app *app, const char *text, const char *button, const char *action);
/* What went wrong in the document, if `result` says that something did. */
bool studio_failed(studio_app *app, slv_result result);
/* Instead of the picture, a page of the stack; its words are those of `message`. Either may be
 * NULL. */
void studio_page(studio_app *app, const char *page, const char *text);
void studio_log(studio_app *app, const char *format, ...) G_GNUC_PRINTF(2, 3);
/* Where a widget is in the window as the display knows it, frame included. */
void studio_log_place(studio_app *app, const char *name, GtkWidget *widget);

/* area.c */
GtkWidget *studio_area_create(studio_app *app);
/* The picture is another; `moving`: and soon again. */
void studio_area_redraw(studio_app *app, bool moving);
/* Before the document is another: what OpenGL has of it. */
void studio_area_forget(studio_app *app);
slv_camera studio_area_camera(const studio_app *app, uint32_t *width, uint32_t *height);

/* brush/stroke.c */
/* Something of a pen at a place of the area, in pixels. */
typedef enum studio_pen { STUDIO_PEN_DOWN, STUDIO_PEN_MOVE, STUDIO_PEN_UP } studio_pen;
void studio_stroke_pen(studio_app *app, studio_pen what, const slv_stroke_sample *samples,
                       uint32_t count, bool eraser);
/* Ends a stroke whose pen was lifted where it is by now. */
void studio_stroke_stop(studio_app *app);

/* brush/sizing.c */
/* Whether the tool has a brush; a drag that changes its size to the sides and its opacity up and
 * down, around where it began. */
bool studio_sizing_has_brush(const studio_app *app);
void studio_sizing_begin(studio_app *app);
void studio_sizing_drag(studio_app *app, double dx, double dy);
void studio_sizing_end(studio_app *app);

/* brush/gradient.c */
/* A drag from where the pointer is now to where it is when it ends. */
void studio_gradient_begin(studio_app *app);
void studio_gradient_end(studio_app *app);

/* brush/texels.c */
/* A drag of the resolution brush begins where the pointer is, goes there, and ends: then it is one
 * entry of the history. */
void studio_texels_begin(studio_app *app, bool fewer);
void studio_texels_touch(studio_app *app);
void studio_texels_end(studio_app *app);
/* The faces that something is meant for, a byte for each, for g_free; NULL: all. */
uint8_t *studio_texels_meant(const studio_app *app);

/* picture/turntable.c */
/* Pictures from all around, one after the other: each begins when the one before is written. */
slv_result studio_turntable_begin(studio_app *app, const char *path);
void studio_turntable_next(studio_app *app);
void studio_turntable_stop(studio_app *app);

/* picture/seam.c */
/* Measures when the view has rested for a while; nothing if it has been done. */
void studio_seam_soon(studio_app *app);
/* Before texels are others. */
void studio_seam_forget(studio_app *app);
/* Says it above the picture, when it is known. */
void studio_seam_ask(studio_app *app);
/* A line for the panel, of the left side or the other one; empty: that is not shown. */
void studio_seam_words(studio_app *app, int side, char *text, size_t size);

/* brush/pen.c */
/* Plays the log of a pen, line by line as the file or pipe gives them. */
void studio_pen_play(studio_app *app, const char *path);

/* panels: each makes its widgets, and shows what the model has */
GtkWidget *studio_panel_brush(studio_app *app);
void studio_panel_brush_sync(studio_app *app);
GtkWidget *studio_panel_layers(studio_app *app);
void studio_panel_layers_sync(studio_app *app);
GtkWidget *studio_panel_history(studio_app *app);
void studio_panel_history_sync(studio_app *app);
GtkWidget *studio_panel_swatches(studio_app *app);
void studio_panel_swatches_sync(studio_app *app);
GtkWidget *studio_panel_inspector(studio_app *app);
void studio_panel_inspector_sync(studio_app *app);

/* dialogs.c */
typedef void (*studio_path_fn)(studio_app *app, const char *path);
void studio_choose_file(studio_app *app, const char *title, GtkFileChooserAction action,
                        const char *name, studio_path_fn done);
typedef void (*studio_answer_fn)(studio_app *app, int answer);
/* Up to three answers, the last of which is what closing the question means. */
void studio_ask(studio_app *app, const char *question, const char *more,
                const char *const answers[3], studio_answer_fn done);

typedef void (*studio_number_fn)(studio_app *app, uint32_t number);
/* A number from 1 on, which closing the question leaves unasked. */
void studio_ask_number(studio_app *app, const char *question, uint32_t value, uint32_t most,
                       studio_number_fn done);

/* commands/file.c */
/* Closes what is open, and removes what nobody needs of it. */
void studio_leave(studio_app *app);

/* settings.c */
void studio_settings_load(studio_app *app);
void studio_settings_save(studio_app *app);
void studio_settings_opened(studio_app *app, const char *path);

/* commands/light.c */
bool studio_light_load(studio_app *app, const char *path);
/* Reads the light of the last time, if there is to be one; else the light is at the eye. */
void studio_light_recall(studio_app *app);

/* picture/views.c */
slv_result studio_view_save(studio_app *app, const char *path);
slv_result studio_view_load(studio_app *app, const char *path);

#endif
