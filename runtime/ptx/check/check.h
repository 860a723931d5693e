/* A check under way, shared by the check files. */
#ifndef SLV_PTX_CHECK_INTERNAL_H
#define SLV_PTX_CHECK_INTERNAL_H

#include <selvage/ptx_check.h>

#include "base/log.h"
#include "base/parallel.h"

#include <pthread.h>

typedef struct check_findings check_findings;

typedef struct check_context {
    slv_env env;
    const slv_ptx *ptx;
    const slv_ptx_info *info;
    slv_ptx_check_params params;
    unsigned nedges; /* of a face */
    size_t pixel_size;
    slv_ptx_face *faces;
    check_findings *findings;
    slv_ptx_report *report;
    uint8_t *strips; /* the texels along every face's edges; NULL if seams are not compared */
    uint64_t *strip_starts; /* nfaces, in texels */
    uint8_t *unread;        /* nfaces: the texels could not be read */
    bool seamless;          /* the outermost texels of reductions are not those of the face alone */
    bool mesh_fits;         /* the one that a repair would take, which is given or else inside */
} check_context;

/* check_report.c: findings come from any thread, in any order. */
slv_result slvi_check_findings_create(const slv_env *env, uint32_t max_kept, check_findings **out);
void slvi_check_findings_destroy(check_findings *findings);
/* `finding` but for its message. */
void slvi_check_find(check_findings *findings, const slv_check_finding *finding, const char *format,
                     ...) SLV_PRINTF(3, 4);
/* All findings of a kind so far can be repaired. */
void slvi_check_findings_mend(check_findings *findings, slv_check_kind kind);
slv_result slvi_check_findings_report(const slv_env *env, check_findings *findings,
                                      slv_ptx_report *report);

/* Results that speak of the file, not of the machine or the caller: what keeps something from being
 * read is no damage. */
bool slvi_check_is_of_file(slv_result result);

/* What a failing call said, kept as a finding instead of a line in the log. */
typedef struct check_log {
    char message[240];
    const char *prefix; /* dropped from the front: the file's name */
} check_log;
slv_env slvi_check_log_env(const slv_env *env, check_log *log, const char *prefix);

/* Each adds findings; a result other than SLV_OK means that the check itself failed. */
slv_result slvi_check_adjacency(check_context *check);
slv_result slvi_check_mesh(check_context *check, const slv_mesh *mesh, bool inside);
/* check_corners.c: whether the faces of the mesh that was given lie where those of the one inside
 * do. */
slv_result slvi_check_corners(check_context *check, const slv_mesh *inside);
slv_result slvi_check_texels(check_context *check);
slv_result slvi_check_seams(check_context *check);

#endif
