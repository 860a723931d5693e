/* The inside of a session. */
#ifndef SLV_PAINT_SESSION_DATA_H
#define SLV_PAINT_SESSION_DATA_H

#include "layer/document_data.h"

#include <selvage/script.h>
#include <selvage/session.h>

#include <jansson.h>

/* A file of lines, each a JSON object that ends with its number and checksum. */
typedef struct slvi_journal {
    slv_env env;
    char *path; /* for messages */
    int file;   /* locked; -1: none, or there is none to be read */
    uint64_t size;
    uint64_t next; /* the number of the next line */
    bool relaxed;
} slvi_journal;

/* A whole line: its number, and where its text without number and checksum is. */
typedef struct slvi_journal_line {
    uint64_t number, at, size;
} slvi_journal_line;

/* The whole lines of a journal up to the first that is not, which is at `end`. */
typedef struct slvi_journal_text {
    char *text;
    slvi_journal_line *lines;
    uint64_t count, end;
} slvi_journal_text;

/* Where there is none (it was deleted) an empty one, which is made unless it is only to be `read`;
 * `*missing` (may be NULL) says so. */
slv_result slvi_journal_open(const slv_env *env, const char *path, bool read, bool *missing,
                             slvi_journal *journal);
void slvi_journal_close(slvi_journal *journal);
slv_result slvi_journal_scan(const slvi_journal *journal, slvi_journal_text *out);
void slvi_journal_free(slvi_journal_text *text);
/* Which lines after number `line` were not undone, and how many: false if something from before
 * was. Behind those in `live`, which has room for all, are *undone more that could be redone at the
 * end. `*whole` says whether no line is missing. */
bool slvi_journal_survivors(const slvi_journal_text *text, uint64_t line, uint64_t *live,
                            uint64_t *count, uint64_t *undone, bool *whole);
/* Cuts off what is behind `end`. */
slv_result slvi_journal_cut(slvi_journal *journal, uint64_t end);
/* Appends a line, which then is on the disk unless the journal is relaxed; if it cannot be, nothing
 * is appended. */
slv_result slvi_journal_append(slvi_journal *journal, const json_t *line);

uint32_t slvi_crc(uint32_t crc, const void *data, size_t size);

/* What was done as JSON, and done again. */
slv_result slvi_edit_to_json(const slv_env *env, const slvi_op *op, uint32_t nfaces, json_t **out);
slv_result slvi_edit_apply(slv_document *document, const char *name, json_t *edit,
                           const char *folder);
/* A line has keys of a list, "a|b|c", and what each has. */
slv_result slvi_edit_keys(const slv_env *env, const char *name, json_t *edit, const char *known);

/* A stroke that is being made. */
typedef struct slvi_live_stroke {
    slv_script *script; /* has the brush */
    slv_stroke *stroke; /* NULL: there is none */
    json_t *line, *samples;
    double last; /* sample's time */
    slvi_edit edit;
} slvi_live_stroke;

struct slv_session {
    slv_env env;   /* its log is ours, which may be silent */
    slv_env outer; /* as it was given */
    bool quiet;    /* what goes wrong is not the end of it */
    char why[512]; /* what went wrong then */
    char *path;
    slv_session_params params;
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_document *document;
    slv_paint_surface *surface;
    slv_painter *painter;
    slvi_journal journal;
    json_t *edits; /* of the entry that is open */
    json_t *set;   /* what lines with "set" have said */
    slvi_live_stroke live;
    bool running;   /* a line of a script: layers may be painted on */
    bool replaying; /* nothing is journalled */
    bool began;     /* its parameters have the resolutions that it had at first */
    uint64_t state; /* the number of the newest state */
    uint64_t floor; /* and of that which the session was opened with */
    uint64_t saved_line;
    slv_session_info info;
    slv_script_stats stats; /* and which faces were touched, or NULL for none */
    uint8_t *touched;
};

/* A path inside of a folder, for slvi_free. */
slv_result slvi_session_path(const slv_env *env, const char *folder, const char *name, char **out);
slv_result slvi_session_state_path(const slv_session *session, uint64_t state, char **out);

/* session.json: what the document was made as. The resolutions and the background of what is read
 * are for slvi_free. */
slv_result slvi_session_describe(const slv_env *env, const char *path,
                                 const slv_session_params *params);
/* `*began`: it says which resolutions the document had at first; else they are zeros. */
slv_result slvi_session_read_description(const slv_env *env, const char *path,
                                         slv_session_params *out, bool *began);
void slvi_session_free_description(slv_session_params *params);

/* The document as it is, complete or not at all; `line` is the last of the journal that it has. */
slv_result slvi_state_write(const slv_env *env, const char *path, const slv_document *document,
                            uint64_t line);
/* Puts what was written into a document without layers. */
slv_result slvi_state_read(const slv_env *env, const char *path, slv_document *document,
                           uint64_t *line);

/* A new state, also within an entry that is to be part of it. */
slv_result slvi_session_save(slv_session *session);

/* Makes the document of the newest state that fits the journal, and does again what came after. */
slv_result slvi_session_recover(slv_session *session);
slv_result slvi_session_new_document(slv_session *session);
/* All that goes before the samples of a stroke, or a fill: `line` says all that was set, and
 * brushes are in the session. */
slv_result slvi_session_line(slv_session *session, const char *folder, const char *line,
                             size_t size, json_t **out);
/* What the history calls a line: stroke, erase or fill. */
const char *slvi_session_name(const json_t *line);
/* Takes from a line what scripts have no keys for. */
void slvi_session_make_bare(json_t *line);
/* The line for the journal. */
slv_result slvi_session_keep(slv_session *session, uint32_t layer, bool mask, json_t *line);
/* Adds what a script has done to what is known of the session's strokes. */
slv_result slvi_session_note(slv_session *session, const slv_script *script);
/* A script that paints on a layer. */
slv_result slvi_session_script(slv_session *session, uint32_t layer, bool mask, slv_script **out);
/* Runs a line of a script, which says all, on a layer. */
slv_result slvi_session_paint(slv_session *session, uint32_t layer, bool mask, json_t *line);

#endif
