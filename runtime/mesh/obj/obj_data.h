/* An OBJ file while it is read, shared by the files that read statements, tags, and make the mesh.
 */
#ifndef SLV_MESH_OBJ_DATA_H
#define SLV_MESH_OBJ_DATA_H

#include "base/log.h"
#include "mesh/text_scan.h"

#include <selvage/mesh.h>

/* An array that grows by doubling. */
typedef struct obj_list {
    void *items;
    uint64_t count, capacity;
} obj_list;

/* What a tag names, with the tag's line, since tags may stand before what they name. */
typedef struct obj_tag {
    int32_t a, b;
    float sharpness;
    uint32_t line;
} obj_tag;

/* A run of polygons under a name; open while `count` is OBJ_OPEN. */
typedef struct obj_group {
    int32_t first, count;
    uint64_t name; /* where in `letters` */
    bool object;   /* from o, not from g */
} obj_group;

#define OBJ_OPEN (-1)

/* Things that are left out, told of once, in a total. */
typedef struct obj_tally {
    uint64_t count;
    uint32_t line; /* of the first */
    char word[40]; /* what the first one was */
} obj_tally;

enum { OBJ_VERTEX, OBJ_TEXCOORD, OBJ_NORMAL, OBJ_KINDS };

typedef struct obj {
    const slv_env *env;
    const char *name;
    slv_scan scan;
    uint32_t line; /* where the statement began */

    obj_list values[OBJ_KINDS]; /* float, slvi_obj_kind_floats per item */
    obj_list rests;  /* float, 3 per vertex: what its floats lack of the numbers in the file */
    obj_list colors; /* float, 4 per vertex once one has a colour, NaN where there is none */
    float largest;   /* of all colours */
    bool alpha, fractions;       /* a colour has four; some are no whole numbers */
    obj_list indices[OBJ_KINDS]; /* int32_t, one per side of a polygon, -1 where there is none */
    obj_list sizes, poly_lines;  /* int32_t and uint32_t per polygon */
    obj_list creases, corners, holes; /* obj_tag */
    obj_list groups, letters;         /* obj_group, char */
    slv_boundary boundary;
    obj_tally dangling[OBJ_KINDS], not_polygons, other_tags, other_statements, backslashes,
        extra_words, no_numbers;
    bool at_statement; /* the scan is where the next one begins, not at the end of this one */
} obj;

extern const unsigned slvi_obj_kind_floats[OBJ_KINDS];

static inline uint64_t slvi_obj_count(const obj *o, int kind) {
    return o->values[kind].count / slvi_obj_kind_floats[kind];
}

/* obj_words.c */
/* Logs an error of this line. */
slv_result slvi_obj_fail(const obj *o, uint32_t line, const char *format, ...) SLV_PRINTF(3, 4);
slv_result slvi_obj_append(obj *o, obj_list *l, const void *items, uint64_t count, size_t size);
/* Counts a thing that is left out; `word` may be NULL. */
void slvi_obj_tally(obj_tally *tally, uint32_t line, const char *word, size_t length);
slv_result slvi_obj_read_float(obj *o, const char *what, float *out);
slv_result slvi_obj_read_double(obj *o, const char *what, double *out);
slv_result slvi_obj_read_int(obj *o, const char *what, int32_t *out);
bool slvi_obj_take_slash(obj *o);
/* A word that would be taken for a statement where one can begin. */
bool slvi_obj_begins_statement(slv_scan scan);
/* True if a word of this statement follows: a line that a backslash joins to it is the next
 * statement all the same if it begins like one, which is told. */
bool slvi_obj_more(obj *o);
slv_result slvi_obj_fail_joined(const obj *o, const char *what, size_t length, const char *word,
                                size_t size);
/* Up to `most` numbers that follow in this statement, until something else does. */
uint64_t slvi_obj_read_numbers(obj *o, uint64_t most, double *out);
/* The end of a statement, after up to `most` numbers that have no use here: other words are told
 * of, and those that begin a statement refused. */
slv_result slvi_obj_end(obj *o, const char *what, uint64_t most);
bool slvi_obj_word_is(const char *word, size_t length, const char *expected);

/* obj_tags.c: the rest of a line that begins with t. */
slv_result slvi_obj_read_tag(obj *o);
/* obj_mesh.c: from all that was read. */
slv_result slvi_obj_make_mesh(obj *o, bool points, slv_mesh **out);

#endif
