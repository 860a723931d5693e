/* Scripts of strokes: JSON, an operation a line, as `selvage paint` and journals have them. */
#ifndef SELVAGE_SCRIPT_H
#define SELVAGE_SCRIPT_H

#include <selvage/stroke.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs lines one after the other on one canvas. The form is in docs/painting.md. What a line with
 * "op": "set" says holds for those after it. For one thread at a time, which the painter's is. */
typedef struct slv_script slv_script;

typedef struct slv_script_stats {
    uint64_t operations; /* strokes and fills */
    uint64_t dabs, missed;
    uint64_t texels; /* in the rectangles of all dabs and fills */
    uint32_t faces;  /* that were painted on */
    uint64_t reserved[4];
} slv_script_stats;

/* Zero means default. */
typedef struct slv_script_params {
    const char *name;   /* of the script, for messages; NULL: "script" */
    const char *folder; /* what the names of brush files are relative to; NULL: where the process is
                         */
    /* Lines of a brush file's that were left out, once for each file. May be NULL. */
    void (*unknown)(void *user, const char *brush, const char *setting);
    void *user;
    /* Of what is painted on: another layer, or its mask, which a line wants to be masked by. NULL:
     * there are none. What is wrong is told. */
    slv_result (*layer)(void *user, uint32_t id, bool mask, slv_canvas *out);
    bool integers; /* of what is painted only 0 to 1 will stay: colours beyond are warned of */
    uint64_t reserved[2];
} slv_script_params;

/* Painter and canvas must outlive it. */
SLV_NODISCARD SLV_API slv_result slv_script_create(slv_painter *painter, const slv_canvas *canvas,
                                                   const slv_script_params *params,
                                                   slv_script **out);
SLV_API void slv_script_destroy(slv_script *script);
/* Runs a line; `number` is for messages. Empty lines and those that begin with # do nothing. What
 * is wrong with a line is SLV_ERROR_FORMAT, naming line and key, and nothing is painted by it; a
 * sample that is no place ends its stroke. */
SLV_NODISCARD SLV_API slv_result slv_script_run(slv_script *script, uint64_t number,
                                                const char *line, size_t size);
SLV_API void slv_script_get_stats(const slv_script *script, slv_script_stats *out);
/* Whether a face was painted on. */
SLV_API bool slv_script_touched(const slv_script *script, uint32_t face);

#ifdef __cplusplus
}
#endif

#endif
