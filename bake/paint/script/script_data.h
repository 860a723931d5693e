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
    bool by_color; /* a fill of what is alike, from `at` of the face */
    float at[2], tolerance;
    slv_lay lay; /* what it points to is of the script, or of this line */
    bool image_at, facing, masked;
    slv_canvas mask_canvas;
} slvi_line;

/* A line that is being read. */
typedef struct slvi_reading {
    slv_script *script;
    uint64_t number;
    slvi_line *line;
} slvi_reading;

/* An image that a line has named. */
typedef struct slvi_script_image {
    char *key;
    slv_image *image;
} slvi_script_image;

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
    slvi_line set, live; /* and that of a stroke whose samples come later */
    slvi_script_brush *brushes;
    uint32_t nbrushes;
    slvi_script_image *images;
    uint32_t nimages;
    uint64_t pixels; /* of all images */
    slv_symmetry *symmetry, *old_symmetry;
    uint32_t symmetry_of[4];
    uint8_t *line_faces, *set_faces; /* of masks */
    uint8_t *touched, *selected;
    uint32_t *list; /* stats.faces that are touched */
    uint64_t list_room;
    uint32_t nfaces, nchannels;
    slv_script_stats stats;
};

/* Reads a line into `out`, which holds what was set. What is wrong is told, naming the line. */
slv_result slvi_script_read(slv_script *script, uint64_t number, json_t *root, slvi_line *out);
/* Begins the stroke of a line that has no samples. The script outlives it. */
slv_result slvi_script_stroke(slv_script *script, uint64_t number, json_t *root, slv_stroke **out);
/* The faces that were touched, stats.faces of them. */
const uint32_t *slvi_script_faces(const slv_script *script);
/* Whether paint is more than a colour. */
bool slvi_script_is_laid(const slv_lay *lay);
/* Does the fill of a line. */
slv_result slvi_script_fill(slv_script *script, const slvi_line *line);
/* One error line: what a key should be. */
slv_result slvi_script_wrong(const slvi_reading *r, const char *key, const char *expected);
bool slvi_script_number(json_t *value, double low, double high, float *out);
/* As many numbers as `least` to `most`. */
bool slvi_script_numbers(json_t *value, size_t least, size_t most, float *out);
/* Whether an object has only keys of a list. */
bool slvi_script_knows(json_t *value, const char *const *keys, size_t count);
/* How paint is laid. */
slv_result slvi_script_read_stamp(slvi_reading *r, const char *key, json_t *value);
slv_result slvi_script_read_image(slvi_reading *r, const char *key, json_t *value);
slv_result slvi_script_read_gradient(slvi_reading *r, const char *key, json_t *value);
slv_result slvi_script_read_clone(slvi_reading *r, const char *key, json_t *value);
slv_result slvi_script_read_where(slvi_reading *r, const char *key, json_t *value);
slv_result slvi_script_read_symmetry(slvi_reading *r, const char *key, json_t *value);
/* What depends on other keys; the line stays where it is from then on. */
slv_result slvi_script_finish_lay(slvi_reading *r);
void slvi_script_free_images(slv_script *script);
/* Where a file is that a line names, for slvi_free. */
slv_result slvi_script_path(const slv_script *script, const char *file, char **out);
/* A copy of a text, for slvi_free. */
slv_result slvi_script_copy(const slv_env *env, const char *text, char **out);
/* Sample `index` of a line's. */
slv_result slvi_script_sample(const slv_script *script, uint64_t number, const slvi_line *line,
                              size_t index, slv_stroke_sample *out);
/* The brush of a name or a description, made when it is first asked for. */
slv_result slvi_script_brush_of(slv_script *script, uint64_t number, json_t *value,
                                const slv_brush **out);

#endif
