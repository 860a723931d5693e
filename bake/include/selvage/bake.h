/* What makes textures: UV images, and procedural patterns that are continuous in space, as texels
 * on the faces of a mesh.
 *
 *     slv_bake_source *source = NULL;
 *     slv_bake_report report;
 *     if (!slv_bake_from_uv(&env, mesh, "colour.<UDIM>.exr", NULL, &source) &&
 *         !slv_bake_save(&env, mesh, source, NULL, "cow.ptx", &report))
 *         printf("%llu texels\n", (unsigned long long)report.texels);
 *     slv_bake_source_destroy(source);
 */
#ifndef SELVAGE_BAKE_H
#define SELVAGE_BAKE_H

#include <selvage/camera.h>
#include <selvage/filter.h>
#include <selvage/surface.h>
#include <selvage/uv_images.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_pattern {
    SLV_PATTERN_STRIPES = 0, /* smooth bands across `direction`, bent by noise if `warp` says so */
    SLV_PATTERN_NOISE,       /* gradient noise, `octaves` of it */
    SLV_PATTERN_CHECKER,     /* cubes in space, hard-edged */
    SLV_PATTERN_FACE_COLOR,  /* one opaque colour a face, drawn from the face id and the seed */
    SLV_PATTERN_POSITION     /* the position itself, scaled: linear in space, not clamped, opaque */
} slv_pattern;

/* stripes, noise, checker, face-color, position */
SLV_API const char *slv_pattern_name(slv_pattern pattern);
SLV_API bool slv_pattern_from_name(const char *name, slv_pattern *out);

/* A pattern; zero means default (a colour of four zeros, too). Colours are linear. Position enters
 * as (position - offset) * frequency. The same values come out on every machine: nothing but IEEE
 * arithmetic and an integer hash is used. */
typedef struct slv_procedural {
    slv_pattern pattern;
    float frequency;    /* periods per unit of length; default 1 */
    float direction[3]; /* of stripes, any length; default (0.36, 0.80, 0.48) */
    float offset[3];
    float warp; /* how far noise, four periods wide, bends the stripes, in periods; default 0 */
    uint32_t octaves; /* default 4, at most 16 */
    uint32_t seed;
    float color0[4]; /* where the pattern is 0; default opaque black */
    float color1[4]; /* where it is 1; default opaque white */
    float face_tint; /* 0..1: how much of each face's own colour is mixed into RGB */
    uint64_t reserved[4];
} slv_procedural;

/* The pattern at a point in space, as RGBA; `face` matters only to FACE_COLOR and
 * face_tint. Pure. */
SLV_API void slv_procedural_evaluate(const slv_procedural *pattern, int32_t face,
                                     const float position[3], float rgba[4]);

/* Zero means default. */
typedef struct slv_bake_params {
    uint32_t samples;      /* per texel and axis, 1..64; default 1, the texel's centre */
    uint32_t first_face;   /* where to begin; faces before it are left as they are */
    uint32_t face_count;   /* how many; default all from first_face on */
    slv_progress progress; /* faces */
    uint64_t reserved[4];
} slv_bake_params;

/* Evaluates a pattern into every texel of every face, at the limit position of the texel's centre
 * (or the mean over a regular grid of samples in it). Channels are the first of RGBA, or the
 * luminance (Rec. 709) for one channel; more than four are SLV_ERROR_UNSUPPORTED. In parallel; the
 * same bytes with any number of threads. A surface and a texture of different face counts are
 * SLV_ERROR_MISMATCH. `params` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_bake_procedural(const slv_env *env, const slv_surface *surface,
                                                     const slv_procedural *pattern,
                                                     const slv_bake_params *params,
                                                     slv_texture *texture);

/* ---- sources, and a .ptx of one ---- */

/* Why a texel has no value. */
typedef enum slv_bake_miss {
    SLV_BAKE_HIT = 0,
    SLV_BAKE_NO_UV,       /* the polygon has no texture coordinates, or some beyond 2^16 */
    SLV_BAKE_NO_TILE,     /* there is no image where its coordinates are */
    SLV_BAKE_NO_HIT,      /* rays meet nothing */
    SLV_BAKE_TOO_FAR,     /* or nothing within reach */
    SLV_BAKE_BACK_FACING, /* or only the wrong side of something */
    SLV_BAKE_NAN          /* what the source has there is no finite number */
} slv_bake_miss;
enum { SLV_BAKE_MISSES = 7 };

SLV_API const char *slv_bake_miss_name(slv_bake_miss miss); /* hit, no-uv, no-tile,
                                                           no-hit, too-far, back-facing, nan */
/* The colour of a cause in a miss map, three values of 0..1 as sRGB has them. */
SLV_API void slv_bake_miss_color(slv_bake_miss miss, float rgb[3]);

/* Where values come from, at any place of a mesh's faces. Immutable; any number of threads may use
 * one. */
typedef struct slv_bake_source slv_bake_source;
SLV_API void slv_bake_source_destroy(slv_bake_source *source);

/* What a source has of itself. */
typedef struct slv_bake_source_desc {
    slv_type type; /* that holds its values */
    uint32_t nchannels;
    int32_t alpha_channel;
    slv_texture_encoding encoding; /* of its files' colours: LINEAR, SRGB or DATA */
} slv_bake_source_desc;
SLV_API const slv_bake_source_desc *slv_bake_source_get_desc(const slv_bake_source *source);

/* What lies beyond the edge of an image that is no tile of a set. */
typedef enum slv_bake_wrap {
    SLV_BAKE_WRAP_AUTO = 0, /* repeat if texture coordinates leave 0..1, else clamp */
    SLV_BAKE_WRAP_REPEAT,   /* the image again */
    SLV_BAKE_WRAP_CLAMP,    /* its outermost pixels */
    SLV_BAKE_WRAP_NONE      /* nothing: SLV_BAKE_NO_TILE */
} slv_bake_wrap;
SLV_API const char *slv_bake_wrap_name(slv_bake_wrap wrap); /* auto, repeat, clamp, none */

#define SLV_BAKE_UDIM "<UDIM>" /* stands in a name for the number of a tile */

/* Zero means default. */
typedef struct slv_bake_uv {
    slv_texture_encoding encoding; /* of the images' colours; default: what each file says, else
                                      SRGB of a PNG and LINEAR of an OpenEXR */
    slv_bake_wrap wrap;
    bool round_u, round_v; /* the coordinate goes round, with one value a vertex (wrap.h): within a
                              polygon it takes the short way, and the image repeats */
    uint64_t reserved[3];
} slv_bake_uv;

/* An image through the mesh's texture coordinates (u to the right, v up), or a set of tiles, where
 * `path` has <UDIM>: tile 1001 + floor(u) + 10 floor(v) for u of 0..9. Which tiles there are to be
 * follows from the coordinates; those without a file are listed in one warning. Coordinates are
 * interpolated bilinearly within a face, those of sub-faces from the polygon's corners, the middles
 * of its sides and its centre, so that polygons may meet along split edges. Filtering goes from one
 * tile into the next where a face, or one that has the same coordinates along an edge, does.
 * Colours are averaged as light, multiplied by alpha. The images stay in memory, in the type that
 * their files have; they have one number of channels, else SLV_ERROR_MISMATCH. `mesh` is not kept.
 */
SLV_NODISCARD SLV_API slv_result slv_bake_from_uv(const slv_env *env, const slv_mesh *mesh,
                                                  const char *path, const slv_bake_uv *params,
                                                  slv_bake_source **out);

/* The colours of the mesh's vertices (slv_mesh_view), linear over a face's (u,v) as texture
 * coordinates are: light between vertices, multiplied by alpha. `encoding` says what they are;
 * AUTO: what the mesh says. uint8 and sRGB, or float where the file's are light. A texel whose
 * polygon has a vertex without a colour is SLV_BAKE_NAN; a mesh without any is SLV_ERROR_MISMATCH.
 * `mesh` is not kept. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_vertex_colors(const slv_env *env,
                                                             const slv_mesh *mesh,
                                                             slv_texture_encoding encoding,
                                                             slv_bake_source **out);

/* Zero means default. */
typedef struct slv_bake_points {
    float distance; /* how near a point must be; default 1/100 of the mesh's diagonal */
    uint32_t count; /* of nearest points that count; default 8, at most 64 */
    slv_texture_encoding encoding; /* of their colours; default: what the mesh that has them says */
    uint64_t reserved[4];
} slv_bake_points;

/* The colours of the vertices of `points` (slv_mesh_load_points), polygons or not, on the limit
 * surface: around each of four places in a texel, more in an oblong one, the mean of the points as
 * far as the nearest `count` reach, or that part of the texel, each times (1 - d^2 / r^2)^2: light,
 * multiplied by alpha. Points without a colour do not count. Texels that have none within
 * `distance` are SLV_BAKE_TOO_FAR; points that do not even come near the mesh are
 * SLV_ERROR_MISMATCH. Keeps `surface`; `points` is not kept. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_points(const slv_env *env, const slv_mesh *mesh,
                                                      const slv_surface *surface,
                                                      const slv_mesh *points,
                                                      const slv_bake_points *params,
                                                      slv_bake_source **out);

/* A per-face texture of the mesh itself: texels as they are, at its own resolution to the bit,
 * reductions as it has them, and interpolated across edges where texels are finer. `encoding` says
 * what its colours are; AUTO: what the file says. A mesh that is not the file's is
 * SLV_ERROR_MISMATCH, more than four channels and textures of triangles SLV_ERROR_UNSUPPORTED. Of
 * its texels 256 MiB at most are in memory. `mesh` is not kept. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_texture(const slv_env *env, const slv_mesh *mesh,
                                                       const char *path,
                                                       slv_texture_encoding encoding,
                                                       slv_bake_source **out);

/* Zero means default. */
typedef struct slv_bake_carry {
    bool rays;              /* along the normals of this mesh's limit; default: the nearest place */
    float distance;         /* how near the other must be; default 1/100 of the diagonal */
    float front, back;      /* how far rays reach outwards and inwards; default 1/20 of it */
    slv_scheme scheme;      /* of the other mesh's surface */
    const slv_mesh *cage;   /* for rays, as in slv_bake_detail */
    slv_scheme cage_scheme; /* that of the surface */
    bool no_copies;         /* also faces with the same corners are looked up */
    uint64_t reserved[4];
} slv_bake_carry;

/* What another mesh has, whatever source that is of it, on the limit surface of this one: from the
 * nearest place of the other's limit surface, or the nearest along the normal, that faces the same
 * way. It is looked up as in slv_transfer: interpolated between the other's texels, across its
 * edges too, or the mean of those that a texel covers; a source that has no resolution of its own
 * is taken at 4 Mi texels in all, or as many as 2^26 rays go for. Faces that the other has too, by
 * their corners, are taken as they are, unless along rays. Texels that have nothing within reach
 * are SLV_BAKE_TOO_FAR, NO_HIT, or BACK_FACING where only the wrong side of something is there;
 * those where the other has no value miss as it does. Vectors in faces' own frames are not turned.
 * Takes `of`, also if it fails; keeps `surface`, neither mesh. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_mesh(const slv_env *env, const slv_mesh *mesh,
                                                    const slv_surface *surface,
                                                    const slv_mesh *other, slv_bake_source *of,
                                                    const slv_bake_carry *params,
                                                    slv_bake_source **out);

/* A pattern in space, on the limit surface: RGBA, of which the alpha channel is kept where one of
 * its colours is not opaque. Keeps `surface`, which must outlive the source. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_pattern(const slv_env *env,
                                                       const slv_surface *surface,
                                                       const slv_procedural *pattern,
                                                       slv_bake_source **out);

/* What a surface is by itself, on its limit. */
typedef enum slv_bake_surface_kind {
    SLV_BAKE_POSITION = 0, /* x, y, z in mesh units, relative to the mesh's origin */
    SLV_BAKE_NORMAL,       /* the unit normal, -1 to 1, along the axes of the mesh */
    SLV_BAKE_FACE_ID,      /* the number of the face: exact up to 2^24 */
    SLV_BAKE_DENSITY,      /* texels per unit of length: the root of those per unit of area */
    SLV_BAKE_CURVATURE /* the mean curvature, 1 / mesh unit: 1 / r of a ball, negative in hollows */
} slv_bake_surface_kind;
SLV_API const char *slv_bake_surface_kind_name(slv_bake_surface_kind kind); /* position, normal,
                                                                               face-id, density,
                                                                               curvature */

/* Float, normals half; data. Keeps `surface`, which must outlive the source. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_surface(const slv_env *env,
                                                       const slv_surface *surface,
                                                       slv_bake_surface_kind kind,
                                                       slv_bake_source **out);

typedef enum slv_bake_rays_kind {
    SLV_BAKE_AO = 0, /* the share of light from all sides that arrives: 1 where nothing is near */
    SLV_BAKE_BENT_NORMAL, /* where it comes from on the average, a unit vector along the mesh's axes
                           */
    SLV_BAKE_THICKNESS    /* how far it is through the inside, the mean over rays inwards that meet
                             something; others count as SLV_BAKE_NO_HIT where none does */
} slv_bake_rays_kind;
SLV_API const char *
slv_bake_rays_kind_name(slv_bake_rays_kind kind); /* ao, bent-normal, thickness */

/* Zero means default. */
typedef struct slv_bake_rays {
    slv_bake_rays_kind kind;
    uint32_t samples;  /* rays a texel, to 65536; default 256. Powers of two converge best */
    float distance;    /* what is further away does not count; default: everything counts */
    uint32_t segments; /* of the triangles that rays are cast at, as slv_tessellate has them; 16 */
    uint32_t seed;
    slv_progress progress; /* asked, while rays are set up, whether to go on; not kept */
    uint64_t reserved[2];
} slv_bake_rays;

/* Rays of Embree at the tessellated limit surface, from points all over a texel, with directions as
 * likely as their cosine to the smooth normal: Owen-scrambled Sobol sequences of each texel's own,
 * so that values do not depend on threads or blocks. AO is uint8, bent normals half, thickness
 * float; data. Holes are open. Nothing is kept. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_rays(const slv_env *env, const slv_mesh *mesh,
                                                    const slv_surface *surface,
                                                    const slv_bake_rays *params,
                                                    slv_bake_source **out);

typedef enum slv_bake_detail_kind {
    SLV_BAKE_DISPLACEMENT = 0, /* signed distance along the unit normal of the limit, mesh units */
    SLV_BAKE_OBJECT_NORMAL,    /* the detailed mesh's own normal, or a smooth one, along the mesh's
                                  axes */
    SLV_BAKE_FACE_NORMAL, /* the same in the face's own frame, as SLV_DISPLACE_TANGENT has it: along
                             growing u, along normal x that, and along the normal */
    SLV_BAKE_OBJECT_VECTOR, /* from the limit to the nearest place of the detailed mesh that faces
                               the same way, along the axes of the mesh: SLV_DISPLACE_OBJECT */
    SLV_BAKE_FACE_VECTOR    /* the same in the face's own frame: SLV_DISPLACE_TANGENT */
} slv_bake_detail_kind;
SLV_API const char *slv_bake_detail_kind_name(slv_bake_detail_kind kind); /* displacement,
                                                                    object-normal, face-normal,
                                                                    object-vector, face-vector */

/* Zero means default. */
typedef struct slv_bake_detail {
    slv_bake_detail_kind kind;
    float front, back; /* how far rays reach outwards and inwards; default 1/20 of the diagonal */
    uint32_t samples;  /* per texel and axis, to 16; default 2 */
    /* NULL, or for normals a mesh of the same polygons: rays go from its surface through this one's
     * and `back` beyond, to the first thing that faces it. Else SLV_ERROR_MISMATCH, before any ray,
     * with the polygon. */
    const slv_mesh *cage;
    slv_scheme cage_scheme; /* that of the surface */
    uint64_t reserved[4];
} slv_bake_detail;

/* From a detailed mesh, taken as it stands, to the limit surface of another: along the normal to
 * the nearest thing that faces the same way. What is not met is told: SLV_BAKE_TOO_FAR, NO_HIT, or
 * BACK_FACING where only the wrong side of something was within reach, which for vectors is the
 * larger of front and back in any direction. Meshes that do not even come
 * near each other are SLV_ERROR_MISMATCH. Displacement and vectors are float, normals half; data.
 * Keeps `surface`. */
SLV_NODISCARD SLV_API slv_result slv_bake_from_detail(const slv_env *env, const slv_mesh *mesh,
                                                      const slv_surface *surface,
                                                      const slv_mesh *detailed,
                                                      const slv_bake_detail *params,
                                                      slv_bake_source **out);

/* Values of texels `rect` of a face at resolution `res`: the mean of the source over each texel's
 * own square in the face's (u,v), in floats: light (or numbers), colours as painted, not multiplied
 * by alpha. `values` has room for nchannels a texel, v-major, and `misses` (slv_bake_miss) for one;
 * a texel without a value has zeros. Part of a texel may be missing: the mean is of the rest. */
SLV_NODISCARD SLV_API slv_result slv_bake_evaluate(const slv_bake_source *source,
                                                   const slv_env *env, uint32_t face, slv_res res,
                                                   slv_rect rect, float *values, uint8_t *misses);

/* A tile of a set, or the one image. */
typedef struct slv_bake_tile {
    uint32_t number;        /* 1001.., or 0 */
    uint32_t width, height; /* 0: there is no file */
    uint32_t faces;         /* that have to do with it */
} slv_bake_tile;
/* In the order of their numbers, NULL of other sources. Owned by the source. */
SLV_API const slv_bake_tile *slv_bake_source_tiles(const slv_bake_source *source, uint32_t *count);

/* The images of slv_bake_from_uv as they are, to be drawn or traced: valid as long as the source.
 * Filtering goes from tile to tile as it does in a bake. False of other sources. */
SLV_API bool slv_bake_source_images(const slv_bake_source *source, slv_uv_images *out);

#define SLV_BAKE_ANY_RANK UINT32_MAX

/* Processes that bake one texture together, each with the same mesh, source and job; rank 0 writes
 * it. `send` and `receive` are between rank 0 and another one: in order, waiting, 0 if all went
 * well. `receive` takes what *from sent, or whoever it is, whom *from then names. One thread calls
 * them. */
typedef struct slv_bake_team {
    uint32_t rank, count;
    int (*send)(void *user, uint32_t to, const void *bytes, uint64_t size);
    int (*receive)(void *user, uint32_t *from, void *bytes, uint64_t size);
    void *user;
} slv_bake_team;

/* A picture in which the surface will be seen: its camera, in the mesh's frame, and its pixels. */
typedef struct slv_bake_view {
    slv_camera camera;
    uint32_t width, height;
} slv_bake_view;

/* Zero means default. How large faces are is said by one of the first seven; by none of them by the
 * source, each face along each axis with the power of two nearest to what the source has there, or
 * max_texels = 4 Mi if the source has no resolution. */
typedef struct slv_bake_job {
    bool uniform; /* every whole face has the resolution `res`, sub-faces half of it */
    slv_res res;
    float density;       /* texels per unit of length of the limit surface */
    uint64_t max_texels; /* in all, as dense as keeps within; by length on the surface */
    uint64_t max_bytes;  /* the same, of texels as they are unpacked */
    /* For each face along each axis the power of two nearest to texels_per_pixel (default 1) times
     * the most pixels that it has there in any of these; min_res where none sees it, since it is
     * out of the picture or behind something. */
    const slv_bake_view *views;
    uint32_t nviews;
    float texels_per_pixel;
    /* The least power of two along each axis from which bilinear interpolation, on the face alone,
     * comes back to within this much of the source: a difference of values as they are stored, 0..1
     * of integers. The source is sampled at four times its own density, or 1024 times along each
     * axis if it has none. Where nothing within max_res will do, the face is as large as its source
     * has pixels, and counts in faces_over. */
    float max_error;
    bool least_error;         /* with max_texels or max_bytes: not evenly dense, but with the least
                                 max_error         that keeps within, to an eighth of a power of two */
    float match;              /* so many texels for one of the source; 1 is the default */
    slv_res min_res, max_res; /* what faces are kept within; default 1x1 and 4096x4096, or 65536 of
                                 `uniform` */
    bool max_given;           /* max_res counts though it is 1x1 */

    bool type_given;
    slv_type type;     /* else the source's */
    slv_scheme scheme; /* of the surface whose lengths count */
    bool no_reductions;
    int compression;      /* as in slv_ptx_writer_params */
    uint64_t memory;      /* bytes of texels at once, and of packed ones; 0: 64 MiB. A face is never
                             taken apart */
    const char *miss_map; /* NULL, or a .ptx to write: of the same faces and sizes, each texel with
                             the colour of slv_bake_miss_color */
    slv_progress progress; /* rows of texels */
    bool seams_given;
    /* Whether faces agree where they meet (seamless.h). Default: all of it; with max_error and
     * least_error only reductions, since full resolution is what was measured (all is an error
     * then); and nothing where values are a face's own: its number or colour, or a vector in its
     * frame. */
    slv_ptx_seams seams;
    /* A file in which blocks of faces are kept as they are baked, so that a bake that was cancelled
     * or killed goes on where it was: it loses a block at most, of 2^22 rays or 64 MiB. Removed
     * when the bake is complete. One of a bake with another `resume_key`, which is to say
     * all that decides its values, or other sizes or types, is begun anew, with a warning; a file
     * that is none is SLV_ERROR_FORMAT. */
    const char *resume, *resume_key;
    const slv_bake_team
        *team; /* of several ranks: those above 0 write nothing, and report nothing */
    uint64_t reserved[4];
} slv_bake_job;

typedef struct slv_bake_report {
    uint64_t faces, constant_faces, texels, bytes; /* bytes: as if no face was constant */
    uint64_t misses[SLV_BAKE_MISSES]; /* texels by cause; [SLV_BAKE_HIT] have a value */
    slv_res smallest, largest;        /* faces, by their number of texels */
    slv_type type;
    slv_texture_encoding encoding; /* of the colours that were written */
    /* With max_error: the largest difference at a sample, and what it is nowhere larger than, if
     * the source does not do more between two samples than from one to the next. */
    float error, error_bound;
    uint64_t faces_over; /* that could not be held within max_error */
    uint64_t reserved[8];
} slv_bake_report;

/* Bakes a source into a .ptx with the mesh inside; `mesh` is the one that the source was made with.
 * Colours are written as the type has them (slv_type_encoding), or as the source's files have them
 * if the type is theirs; metadata says what the type does not. A texel without a value has the mean
 * of what is nearest on its face, so that reductions mix nothing in; a face without any is zero.
 * Holes of the mesh are baked as they are numbered, but count no misses. In parallel, block after
 * block of faces; the same bytes with any number of threads. What is written is whole or not there,
 * also after SLV_ERROR_CANCELLED; misses are no failure here: the caller looks at the report.
 * `job` and `report` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_bake_save(const slv_env *env, const slv_mesh *mesh,
                                               const slv_bake_source *source,
                                               const slv_bake_job *job, const char *path,
                                               slv_bake_report *report);

/* ---- and back to UV images ---- */

/* What three channels are that become a normal map. */
typedef enum slv_unbake_normals {
    SLV_UNBAKE_VALUES,         /* nothing: they are drawn as they are */
    SLV_UNBAKE_OBJECT_NORMALS, /* normals along the mesh's axes */
    SLV_UNBAKE_FACE_NORMALS    /* in the face's own frame (SLV_BAKE_FACE_NORMAL) */
} slv_unbake_normals;
/* values, object-normal, face-normal */
SLV_API const char *slv_unbake_normals_name(slv_unbake_normals normals);

/* Zero means default. */
typedef struct slv_unbake_params {
    uint32_t width, height; /* of each image; default the power of two that has about as many pixels
                               as there are texels in what it shows, height as width */
    uint32_t bits;          /* as in slv_image_params; default what the texture's type needs */
    slv_filter filter;      /* default SLV_FILTER_POINT is taken as SLV_FILTER_BILINEAR */
    slv_texture_encoding encoding; /* of the texture's colours; default what it says */
    slv_progress progress;         /* rows */
    slv_unbake_normals normals;
    slv_scheme scheme;     /* of the surface, of SLV_UNBAKE_FACE_NORMALS */
    bool round_u, round_v; /* texture coordinates that go round, as in slv_bake_uv: an image, no
                              tiles, and no `normals` */
    uint64_t reserved[2];
} slv_unbake_params;

typedef struct slv_unbake_report {
    uint32_t images, width, height;
    uint32_t without; /* faces that have no texture coordinates */
    uint64_t inside;  /* pixels whose middle a face has */
    uint64_t shared;  /* times that another face has it too: the one of the lowest number shows */
    uint64_t reserved[4];
} slv_unbake_report;

/* Draws a .ptx of quads into an image by the mesh's texture coordinates, .png or .exr, or into a
 * set of tiles where `path` has <UDIM>: one for each cell in which faces lie. A pixel has what lies
 * at its middle, filtered over its own parallelogram on the surface, across seams. Pixels up to two
 * away from an island have what lies across the seam there; all others the mean of what is nearest
 * (pull and push), so that no reduction of the image has anything from outside of islands. A single
 * image shows faces that leave 0..1 where it would be repeated. Colours are sRGB in a PNG and light
 * in an EXR, but for SLV_TEXTURE_DATA, which is taken as it stands. The texture has one or three
 * channels, and alpha may stand behind them, else SLV_ERROR_UNSUPPORTED; a mesh that does not
 * belong to it is SLV_ERROR_MISMATCH.
 *
 * `normals` makes a tangent space normal map: what is drawn is the normal in MikkTSpace's frame of
 * the mesh's polygons with the normals of its file, or where it has none smooth ones (Mikkelsen
 * 2008; frames are interpolated and not normalised, the bitangent is that of each pixel), as n/2 +
 * 1/2 in files of both formats, with green along growing v. The texture has three channels of half
 * or float then, else SLV_ERROR_UNSUPPORTED.
 *
 * Each file is whole or not there. On env->threads threads; the
 * same bytes with any number of them. `params` and `report` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_unbake(const slv_env *env, const slv_ptx *ptx,
                                            const slv_mesh *mesh, const slv_unbake_params *params,
                                            const char *path, slv_unbake_report *report);

#ifdef __cplusplus
}
#endif

#endif
