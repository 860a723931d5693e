/* Polygon control meshes: from OBJ and PLY files, from arrays, and their faces in Ptex order. */
#ifndef SELVAGE_MESH_H
#define SELVAGE_MESH_H

#include <selvage/adjacency.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How a subdivision surface meets its boundary (OpenSubdiv's VtxBoundaryInterpolation). The default
 * is edge-and-corner. */
typedef enum slv_boundary {
    SLV_BOUNDARY_DEFAULT = 0,
    SLV_BOUNDARY_NONE,
    SLV_BOUNDARY_EDGE_ONLY,
    SLV_BOUNDARY_EDGE_AND_CORNER
} slv_boundary;

/* default, none, edge-only, edge-and-corner */
SLV_API const char *slv_boundary_name(slv_boundary boundary);
SLV_API bool slv_boundary_from_name(const char *name, slv_boundary *out);

/* A mesh as arrays that the caller owns. Only positions and polygons are required. Indices are
 * zero-based. */
typedef struct slv_mesh_view {
    uint32_t nverts;
    const float *positions; /* 3 * nverts */
    uint32_t npolys;
    const int32_t *poly_sizes; /* npolys, each >= 3 */
    const int32_t *poly_verts; /* sum of poly_sizes */

    uint32_t ntexcoords;
    const float *texcoords; /* 2 * ntexcoords */
    const int32_t
        *poly_texcoords; /* like poly_verts, -1 where there is none; NULL if no polygon has any */
    uint32_t nnormals;
    const float *normals;        /* 3 * nnormals */
    const int32_t *poly_normals; /* like poly_texcoords */

    uint32_t ncreases;
    const int32_t *crease_verts;   /* 2 * ncreases: the ends of an edge */
    const float *crease_sharpness; /* ncreases; 10 and more is infinitely sharp */
    uint32_t ncorners;
    const int32_t *corner_verts;
    const float *corner_sharpness;
    uint32_t nholes;
    const int32_t *hole_polys;
    slv_boundary boundary; /* what the file asked for; default if it did not say */

    /* Runs of polygons under a name, by their first polygon. They may overlap, and a name may have
     * several. */
    uint32_t ngroups;
    const char *const *group_names;
    const int32_t *group_first; /* first polygon of each run, ascending */
    const int32_t *group_count; /* how many; NULL if each ends where the next begins */

    /* What positions are relative to: they lie at origin + position. Zero, but for meshes out of
     * files that are more than 64 times their own size away from zero, of which floats would keep
     * little: there it is the middle. Surfaces, tessellations, cameras and pictures of a mesh are
     * all in the frame that has its zero here. */
    double origin[3];
    /* Colours of vertices, RGBA from 0 to 1 as the file has them, not multiplied by alpha: 4 *
     * nverts, or NULL. NaN where a vertex has none. */
    const float *colors;
    bool colors_linear; /* they are light, as floats of PLY files; else sRGB */
    bool colors_alpha;  /* the fourth says something; else it is 1 */
    uint64_t reserved[1];
} slv_mesh_view;

/* A checked copy of such arrays. Immutable; any number of threads may read it. */
typedef struct slv_mesh slv_mesh;

/* A face of a mesh: a whole quad (sub = -1) or sub-face number `sub` of an n-gon. */
typedef struct slv_mesh_face {
    int32_t poly;
    int32_t sub;
} slv_mesh_face;

typedef struct slv_mesh_stats {
    uint32_t npolys, nverts, nfaces, nsubfaces, nholes, ncreases;
    uint32_t nedges, nboundary_edges, nnonmanifold_edges,
        nflipped_edges; /* flipped: both sides run the same way */
    uint32_t nisolated_verts;
    uint32_t nvalence[33]; /* vertices by number of polygons around them; the last counts all from
                              32 up */
    uint32_t
        nextraordinary; /* inner vertices of other than 4 polygons, boundary ones of more than 2 */
    float bounds_min[3], bounds_max[3]; /* the origin added */
    uint64_t reserved[4];
} slv_mesh_stats;

/* Checks and copies. A negative or too large index, a polygon of fewer than 3 vertices, or a
 * position that is not finite is SLV_ERROR_FORMAT, naming the polygon. */
SLV_NODISCARD SLV_API slv_result slv_mesh_create(const slv_env *env, const slv_mesh_view *view,
                                                 slv_mesh **out);
/* The cube that six quads close, with corners at -1 and 1: for textures of environments, which have
 * no geometry. Each pair of opposite faces has an axis, x, y and z in the order in which they come;
 * the first of a pair lies at 1: faces +x -x +y -y +z -z come back as what they are. An adjacency
 * of anything else is SLV_ERROR_MISMATCH. */
SLV_NODISCARD SLV_API slv_result slv_mesh_create_cube(const slv_env *env,
                                                      const slv_adjacency *adjacency,
                                                      slv_mesh **out);

/* Reads a file that slv_mesh_parse_obj or slv_mesh_parse_ply understands, told apart by its first
 * bytes, as it is or packed by gzip. */
SLV_NODISCARD SLV_API slv_result slv_mesh_load(const slv_env *env, const char *path,
                                               slv_mesh **out);
/* The same of a file that need not have polygons: clouds of points, which are vertices alone. */
SLV_NODISCARD SLV_API slv_result slv_mesh_load_points(const slv_env *env, const char *path,
                                                      slv_mesh **out);
/* Reads `size` bytes of a Wavefront OBJ file; `name` stands in messages for the file. v, vt, vn, f
 * (any of the four index forms, negative indices, n-gons), colours behind the numbers of v (of
 * three or four, 0 to 1, or whole numbers to 255), g (a run for each name of the line) and o,
 * and OpenSubdiv's tag lines (t crease, corner, interpolateboundary, hole). Errors name the file
 * and the line. What is left out is told in one warning for each kind: indices of texture
 * coordinates and normals that are not there, faces of fewer than three vertices, unknown
 * statements and tags, and backslashes at the end of comments and names, which join no lines. */
SLV_NODISCARD SLV_API slv_result slv_mesh_parse_obj(const slv_env *env, const char *name,
                                                    const char *text, size_t size, slv_mesh **out);
/* The same from a PLY file (Turk 1994), text or binary of either byte order: the element vertex
 * with x, y, z, texture coordinates (s t, u v, texture_u texture_v) and colours (red green blue
 * alpha or r g b a, also behind diffuse_; integers are parts of their largest, floats light), and
 * face with vertex_indices or vertex_index. Faces of fewer than three vertices are left out and
 * told in one warning; other elements and properties are passed over; triangle strips are
 * SLV_ERROR_UNSUPPORTED. */
SLV_NODISCARD SLV_API slv_result slv_mesh_parse_ply(const slv_env *env, const char *name,
                                                    const char *bytes, size_t size, slv_mesh **out);
/* Writes positions, colours of vertices as sRGB, texture coordinates, polygons, groups, creases,
 * corners, holes and boundary rule. Atomic: beside, then rename. */
SLV_NODISCARD SLV_API slv_result slv_mesh_save_obj(const slv_env *env, const slv_mesh *mesh,
                                                   const char *path);
SLV_API void slv_mesh_destroy(slv_mesh *mesh);

/* The mesh's own arrays. Owned by the mesh. */
SLV_API const slv_mesh_view *slv_mesh_get_view(const slv_mesh *mesh);

/* Faces in Ptex order: polygon by polygon, a quad as one face and an n-gon as n. */
SLV_API uint32_t slv_mesh_face_count(const slv_mesh *mesh);
SLV_API const slv_mesh_face *slv_mesh_faces(const slv_mesh *mesh);
/* True if the face belongs to a hole: numbered and subdivided like any other, but not drawn. */
SLV_API bool slv_mesh_face_is_hole(const slv_mesh *mesh, int32_t face);

/* How the mesh's faces meet. Edges shared by more than two polygons, by two that run the same way
 * along it, or by a hole are boundaries. */
SLV_NODISCARD SLV_API slv_result slv_mesh_adjacency(const slv_env *env, const slv_mesh *mesh,
                                                    slv_adjacency **out);
/* The flags of every face (SLV_FACE_SUBFACE or 0), face_count bytes. Owned by the mesh. */
SLV_API const uint8_t *slv_mesh_face_flags(const slv_mesh *mesh);

/* The four corners of every face of the control mesh, 12 floats a face, relative to `origin` (NULL:
 * the mesh's own): of a sub-face its vertex, the middles of two edges with its polygon's centre
 * between them. For slv_free. */
SLV_NODISCARD SLV_API slv_result slv_mesh_corners(const slv_env *env, const slv_mesh *mesh,
                                                  const double *origin, float **out);

/* The texture coordinates at the four corners of every face, 8 floats a face: those of its
 * polygon's corners, of a sub-face its corner's own, the middles towards the next and the last, and
 * the mean of all between them. Bilinear in a face's (u,v), they are what a subdivision surface has
 * that interpolates them linearly (OpenSubdiv's FVAR_LINEAR_ALL). NaN where the polygon lacks one
 * of them. For slv_free. */
SLV_NODISCARD SLV_API slv_result slv_mesh_face_texcoords(const slv_env *env, const slv_mesh *mesh,
                                                         float **out);

/* A face with the same corners. */
typedef struct slv_face_match {
    int32_t face;
    uint8_t turn; /* which of its corners is corner 0 of the other */
    bool flipped; /* it goes round the other way */
} slv_face_match;

/* The corner of the face that lies at a corner of the other. */
static inline unsigned slv_face_match_corner(const slv_face_match *match, unsigned corner) {
    return (match->flipped ? match->turn + 4u - corner : match->turn + corner) % 4;
}

/* Finds for every face of a target the face of a source whose corners are within `tolerance` of its
 * own, along each axis: that of the same number, or one of the lowest, or -1. Corners as
 * slv_mesh_corners gives them, in one frame. */
SLV_NODISCARD SLV_API slv_result slv_mesh_match_corners(const slv_env *env, uint32_t nsource,
                                                        const float *source, uint32_t ntarget,
                                                        const float *target, float tolerance,
                                                        slv_face_match *out);

SLV_NODISCARD SLV_API slv_result slv_mesh_get_stats(const slv_env *env, const slv_mesh *mesh,
                                                    slv_mesh_stats *out);

#ifdef __cplusplus
}
#endif

#endif
