/* The header of a PLY file: which elements follow, made of which properties, written how. */
#ifndef SLV_MESH_PLY_HEADER_H
#define SLV_MESH_PLY_HEADER_H

#include <selvage/result.h>

enum { PLY_MAX_ELEMENTS = 32, PLY_MAX_PROPERTIES = 256, PLY_NAME = 32 };

typedef enum ply_format { PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_format;

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE
} ply_type;

typedef struct ply_property {
    char name[PLY_NAME];
    ply_type type, count_type;
    bool is_list;
} ply_property;

typedef struct ply_element {
    char name[PLY_NAME];
    uint64_t count;
    uint32_t first, nproperties; /* in the header's properties */
} ply_element;

typedef struct ply_header {
    ply_format format;
    ply_element elements[PLY_MAX_ELEMENTS];
    ply_property properties[PLY_MAX_PROPERTIES];
    uint32_t nelements, nproperties;
    uint32_t lines; /* of the header, end_header among them */
    size_t bytes;   /* where the elements begin */
} ply_header;

static inline unsigned slvi_ply_size(ply_type type) {
    static const uint8_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

/* SLV_ERROR_FORMAT with the file's name and the line if it is not the header of a PLY file. */
slv_result slvi_ply_read_header(const slv_env *env, const char *name, const char *text, size_t size,
                                ply_header *out);

#endif
