/* Inside a script that is run. */
#ifndef SLV_PAINT_SCRIPT_DATA_H
#define SLV_PAINT_SCRIPT_DATA_H

#include <selvage/script.h>

#include <jansson.h>

typedef enum slvi_script_op {
    SLVI_SCRIPT_STROKE,
    SLVI_SCRIPT_FILL,
    SLVI_SCRIPT_SET,
    SLVI_SCRIPT_OPS
} slvi_script_op;

/* What holds for a line: what was set, and what it says itself. */
typedef struct slvi_line {
    slvi_script_op op;
    slv_stroke_params stroke;
    slv_mirror mirrors[SLV_MIRRORS];
    json_t *camera;  /* borrowed while the line is read: it takes the size */
    json_t *samples; /* borrowed */
    int64_t face;    /* of a fill; -1: none */
    slv_select select;
    float degrees;
} slvi_line;

/* A brush that a line has named or described. */
typedef struct slvi_script_brush {
    char *key;
    slv_brush *brush;
} slvi_script_brush;

struct slv_script {
    slv_env env;
    slv_painter *painter;
    slv_canvas inner, canvas; /* ours notes what is touched */
    char *name, *folder;
    slv_script_params params;
    slvi_line set;
    slvi_script_brush *brushes;
    uint32_t nbrushes;
    uint8_t *touched, *selected;
    uint32_t nfaces;
    slv_script_stats stats;
};

/* Reads a line into `out`, which holds what was set. What is wrong is told, naming the line. */
slv_result slvi_script_read(slv_script *script, uint64_t number, json_t *root, slvi_line *out);
/* Begins the stroke of a line that has no samples. The script outlives it. */
slv_result slvi_script_stroke(slv_script *script, uint64_t number, json_t *root, slv_stroke **out);
/* A copy of a text, for slvi_free. */
slv_result slvi_script_copy(const slv_env *env, const char *text, char **out);
/* Sample `index` of a line's. */
slv_result slvi_script_sample(const slv_script *script, uint64_t number, const slvi_line *line,
                              size_t index, slv_stroke_sample *out);
/* The brush of a name or a description, made when it is first asked for. */
slv_result slvi_script_brush_of(slv_script *script, uint64_t number, json_t *value,
                                const slv_brush **out);

#endif
