/* What is painted with: the line of a script that a stroke begins with, and the brushes that there
 * are. */
#ifndef SELVAGE_STUDIO_BRUSH_H
#define SELVAGE_STUDIO_BRUSH_H

#include "studio/document.h"
#include "studio/picture/look.h"

typedef struct studio_brush {
    char *name; /* as it is shown */
    char *path; /* of its file; NULL: round */
} studio_brush;

/* The round one, and those of MyPaint in the folders of the data directories. */
typedef struct studio_brushes {
    studio_brush *list;
    uint32_t count;
} studio_brushes;
void studio_brushes_find(studio_brushes *brushes);
void studio_brushes_free(studio_brushes *brushes);

typedef struct studio_paint {
    const char *brush; /* the path of its file; NULL: round */
    float radius;      /* pixels */
    float opacity, hardness;
    float color[3]; /* as they are on the screen, 0..1 */
    float other[3]; /* that gradients end with */
    bool radial;    /* gradients are, by the distance from where they begin */
    slv_blend blend;
    bool erase, lock_alpha, project;
    bool mirror; /* on the plane x = the middle of the surface */
    float pressure_radius, pressure_opacity;
    studio_stencil stencil;
} studio_paint;

/* Colours to come back to, "#rrggbb" as they are on the screen, the one that was kept last first;
 * empty beyond them. */
enum { STUDIO_SWATCHES = 16 };
typedef char studio_swatch[8];
/* A few to begin with. */
void studio_swatches_default(studio_swatch list[STUDIO_SWATCHES]);
/* One that is there already comes to the front; the last goes if there are too many. */
void studio_swatches_add(studio_swatch list[STUDIO_SWATCHES], const float color[3]);

studio_paint studio_paint_default(void);
/* The line without its samples, which are places in a picture, or on the surface if there is no
 * camera: then the radius is in units of the mesh. For free(); NULL: no memory. */
char *studio_paint_line(const studio_paint *paint, const studio_document *document,
                        const slv_camera *camera, uint32_t width, uint32_t height);
/* From one place of the mesh to another. */
typedef struct studio_gradient {
    float from[3], to[3];
    bool radial;
} studio_gradient;
/* Fills from a face on, with the colour or, unless it is NULL, a gradient to the other one. */
char *studio_fill_line(const studio_paint *paint, const studio_document *document, uint32_t face,
                       slv_select select, const studio_gradient *gradient);
/* A colour as the document's texels have it. */
void studio_paint_color(const studio_document *document, const float rgb[3], bool to_texels,
                        float out[3]);

#endif
