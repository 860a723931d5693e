/* The two halves of `selvage info`. */
#ifndef SELVAGE_TOOLS_INFO_H
#define SELVAGE_TOOLS_INFO_H

#include "output.h"

typedef struct info_options {
    bool json, faces, meta;
} info_options;

/* Each returns an exit code. */
int info_ptx(const slv_env *env, const char *path, const info_options *options);
int info_mesh(const slv_env *env, const char *path, const info_options *options);

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
