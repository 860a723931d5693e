/* The parts of `selvage info`. */
#ifndef SELVAGE_TOOLS_INFO_H
#define SELVAGE_TOOLS_INFO_H

#include "command/output.h"

typedef struct info_options {
    bool json, faces, meta, progress, ids;
    const char *sheet, *sheet_faces; /* a picture of faces, and of which */
    uint32_t cell;                   /* pixels of a side, 0: as many as fit */
    bool encoding_given;
    int encoding;         /* slv_image_encoding */
    int texture_encoding; /* slv_texture_encoding */
} info_options;

/* What the contact sheet looks like. */
typedef struct info_sheet_layout {
    uint32_t columns, rows, cell, gap, width, height, shown;
    uint64_t faces; /* asked for */
} info_sheet_layout;

/* Each returns an exit code. */
int info_ptx(const cli_command *command, const slv_env *env, const char *path,
             const info_options *options);
int info_mesh(const slv_env *env, const char *path, const info_options *options);

/* What each stored level holds and how it is packed; for free(). */
typedef struct info_levels info_levels;
slv_result info_levels_make(const slv_env *env, const slv_ptx *ptx, info_levels **out);
void info_levels_print(const info_levels *levels);
json_t *info_levels_json(const info_levels *levels);
json_t *info_edits_json(const info_levels *levels);

/* info_sheet.c: draws and writes a contact sheet. Returns an exit code. */
int info_sheet(const cli_command *command, const slv_env *env, const info_options *options,
               const char *path, info_sheet_layout *out);

/* Prints a label in a column of its own, and what follows it. */
void info_line(const char *label, const char *format, ...) __attribute__((format(printf, 2, 3)));
void info_title(const char *path);
/* "3.2 MB", or "812 bytes" */
const char *info_bytes(uint64_t bytes, char *buffer, size_t size);
/* One face's neighbours, "12:3 -:- 4:0": the face and which of its edges. */
void info_print_adjacency(const slv_face_adjacency *adjacency, unsigned nedges);
/* The same as two arrays in an object, boundaries as null. */
json_t *info_adjacency_json(const slv_face_adjacency *adjacency, unsigned nedges, json_t *object);
/* Appends to a list; NULL once anything has failed, as jansson's own packing has it. */
json_t *info_append(json_t *list, json_t *item);

#endif
