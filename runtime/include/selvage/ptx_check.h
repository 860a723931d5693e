/* Whether a .ptx file keeps the format's promises, and copies in which what is certain is put
 * right. */
#ifndef SELVAGE_PTX_CHECK_H
#define SELVAGE_PTX_CHECK_H

#include <selvage/ptx_writer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_check_kind {
    SLV_CHECK_STRUCTURE = 0, /* header, tables or metadata cannot be read: no more was looked at */
    SLV_CHECK_TEXELS,        /* a face's texels, or a reduction of them, cannot be read */
    SLV_CHECK_VALUES,        /* half or float texels that are not finite */
    SLV_CHECK_ADJACENCY,     /* an edge whose neighbour does not lead back to it */
    SLV_CHECK_SUBFACES,      /* sub-faces that do not make up a polygon */
    SLV_CHECK_FLAGS,         /* a face said to lie among its own value that does not */
    SLV_CHECK_REDUCTIONS,    /* a stored reduction or average that is not the face's */
    SLV_CHECK_SEAMS,         /* a shared edge whose two sides differ by more than the tolerance */
    SLV_CHECK_META,          /* metadata that contradicts itself or the number of faces */
    SLV_CHECK_MESH,          /* faces or edges that the mesh, given or inside, has otherwise */
    SLV_CHECK_KINDS
} slv_check_kind;

SLV_API const char *slv_check_kind_name(slv_check_kind kind);

typedef struct slv_check_finding {
    slv_check_kind kind;
    bool warning;              /* legal, but hardly meant; else an error */
    bool repairable;           /* slv_ptx_repair makes it right, with the mesh if there is one */
    int32_t face, edge, level; /* -1 where there is none */
    float amount; /* seams and reductions: the largest difference of two values, integers as 0..1 */
    char message[240]; /* in words, face and edge included */
} slv_check_finding;

/* Zero means default. */
typedef struct slv_ptx_check_params {
    const slv_mesh *mesh;  /* compare with this one too; the mesh inside is compared in any case */
    bool seams;            /* compare full resolution along shared edges */
    float seam_tolerance;  /* the difference that a seam may have, integers as 0..1 */
    bool no_texels;        /* look at the tables only */
    uint32_t max_findings; /* of each kind that are kept, the first by face and edge; 0: 1000 */
    slv_progress progress; /* faces */
    uint64_t reserved[4];
} slv_ptx_check_params;

typedef struct slv_ptx_report {
    uint32_t nfindings; /* sorted by kind, face, edge and level */
    const slv_check_finding *findings;
    uint64_t counts[SLV_CHECK_KINDS];   /* of findings, those not kept included */
    uint64_t warnings[SLV_CHECK_KINDS]; /* how many of them are warnings */
    uint64_t nseams;                    /* shared edges compared */
    slv_check_finding worst_seam;       /* of all of them; face -1 if there is none */
    bool opened;                        /* false: not even the header could be read */
} slv_ptx_report;

/* Looks at everything that a file holds, on env->threads threads. A damaged file is a report with
 * findings and SLV_OK; other results mean that the check itself failed (no such file, no memory).
 */
SLV_NODISCARD SLV_API slv_result slv_ptx_check(const slv_env *env, const char *path,
                                               const slv_ptx_check_params *params,
                                               slv_ptx_report **out);
SLV_API void slv_ptx_report_destroy(slv_ptx_report *report);

/* Writes a copy with reductions, averages and flags made anew, edits applied and, if `mesh` is
 * given, its adjacency and geometry in place of the file's. SLV_ERROR_MISMATCH if the mesh has
 * another number of faces. `path` may be the file's own. A file opened leniently can be repaired
 * though an edge leads to no face: without a mesh such an edge becomes a boundary. `params` as in
 * slv_ptx_rewrite. */
SLV_NODISCARD SLV_API slv_result slv_ptx_repair(const slv_env *env, const slv_ptx *ptx,
                                                const slv_mesh *mesh, const char *path,
                                                const slv_ptx_writer_params *params);

#ifdef __cplusplus
}
#endif

#endif
