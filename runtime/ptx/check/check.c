/* Checking a file as a whole: opening it, its tables, its metadata, and what the other files look
 * at. */
#include "ptx/check/check.h"

#include "base/log.h"
#include "base/memory.h"
#include "ptx/format/ptx_file.h"

#include <string.h>

enum { DEFAULT_MAX_FINDINGS = 1000 };

/* Turns a failure that speaks of the file into a finding and success; logs any other. */
static slv_result find_failure(check_context *check, slv_check_kind kind, slv_result result,
                               const char *path, const check_log *log) {
    if (!slvi_check_is_of_file(result))
        return slvi_fail(&check->env, result, "%s: %s", path, log->message);
    slv_check_finding finding = {.kind = kind, .face = -1, .edge = -1, .level = -1};
    slvi_check_find(check->findings, &finding, "%s", log->message);
    return SLV_OK;
}

static slv_result load_faces(check_context *check) {
    uint32_t nfaces = check->info->nfaces;
    slv_result result =
        slvi_alloc(&check->env, "faces", nfaces, sizeof *check->faces, &check->faces);
    for (uint32_t face = 0; !result && face < nfaces; face++)
        result = slv_ptx_get_face(check->ptx, face, &check->faces[face]);
    return result;
}

/* Values that go with the faces one by one are known by their keys; the mesh checks the others. */
static void check_counts(check_context *check, const slv_ptx_meta *meta) {
    slv_check_finding finding = {
        .kind = SLV_CHECK_META, .warning = true, .face = -1, .edge = -1, .level = -1};
    bool triangle = check->info->mesh_type == SLV_PTX_TRIANGLE;
    if (!meta->key[0])
        slvi_check_find(check->findings, &finding, "metadata without a name");
    if (strcmp(meta->key, "PtexFaceVertCounts") == 0 && meta->type == SLV_META_INT32) {
        uint64_t faces = 0;
        const int32_t *sizes = meta->values;
        for (uint32_t i = 0; i < meta->count; i++)
            faces += triangle || sizes[i] == 4 ? 1 : sizes[i] > 0 ? (uint32_t)sizes[i] : 0;
        finding.warning = false;
        if (faces != check->info->nfaces)
            slvi_check_find(
                check->findings, &finding,
                "PtexFaceVertCounts has %u polygons, which are %llu faces, where the file "
                "has %u",
                meta->count, (unsigned long long)faces, check->info->nfaces);
    }
}

static slv_result check_meta(check_context *check, check_log *log) {
    for (uint32_t i = 0; i < check->info->nmeta; i++) {
        log->message[0] = 0;
        const slv_ptx_meta *meta;
        slv_result result = slv_ptx_load_meta(check->ptx, i, &meta);
        if (!result) {
            check_counts(check, meta);
            continue;
        }
        if (!slvi_check_is_of_file(result))
            return slvi_fail(&check->env, result, "%s: metadata entry %u: %s",
                             slv_ptx_name(check->ptx), i, log->message);
        slv_check_finding finding = {.kind = SLV_CHECK_META, .face = -1, .edge = -1, .level = -1};
        slvi_check_find(check->findings, &finding, "metadata entry %u: %s", i, log->message);
    }
    return SLV_OK;
}

static slv_result check_meshes(check_context *check, const char *path) {
    check_log log;
    slv_env quiet = slvi_check_log_env(&check->env, &log, path);
    slv_mesh *inside = NULL;
    slv_result result = slv_ptx_load_mesh(&quiet, check->ptx, &inside);
    if (!result)
        result = slvi_check_mesh(check, inside, true);
    else if (result == SLV_ERROR_UNSUPPORTED)
        result = SLV_OK;
    else
        result = find_failure(check, SLV_CHECK_META, result, path, &log);
    if (!result && check->params.mesh)
        result = slvi_check_mesh(check, check->params.mesh, false);
    if (!result && check->params.mesh && inside)
        result = slvi_check_corners(check, inside);
    slv_mesh_destroy(inside);
    if (!result && check->mesh_fits) {
        slvi_check_findings_mend(check->findings, SLV_CHECK_ADJACENCY);
        slvi_check_findings_mend(check->findings, SLV_CHECK_SUBFACES);
    }
    return result;
}

/* The face table, the averages and the first level have to be there; reductions can be made anew.
 */
static slv_result check_tables(check_context *check, const char *path, check_log *log, bool *good) {
    slv_result result = ptx_need(check->ptx, PTX_FACES | PTX_CONSTANTS | PTX_LEVEL(0));
    *good = !result;
    if (result)
        return find_failure(check, SLV_CHECK_STRUCTURE, result, path, log);
    for (uint32_t level = 1; !result && level < check->info->nlevels; level++) {
        const slv_check_finding finding = {.kind = SLV_CHECK_TEXELS,
                                           .repairable = true,
                                           .face = -1,
                                           .edge = -1,
                                           .level = (int32_t)level};
        result = ptx_need(check->ptx, PTX_LEVEL(level) | PTX_RANKS);
        if (slvi_check_is_of_file(result)) {
            slvi_check_find(check->findings, &finding, "%s", log->message);
            result = SLV_OK;
        } else if (result) {
            return slvi_fail(&check->env, result, "%s: %s", path, log->message);
        }
    }
    return result;
}

static slv_result check_file(check_context *check, const char *path, check_log *log) {
    bool good;
    check->info = slv_ptx_get_info(check->ptx);
    slv_result result = check_tables(check, path, log, &good);
    if (result || !good)
        return result;
    check->nedges = check->info->mesh_type == SLV_PTX_TRIANGLE ? 3 : 4;
    check->pixel_size = slv_type_size(check->info->type) * check->info->nchannels;
    if ((result = load_faces(check)) || (result = check_meta(check, log)) ||
        (result = slvi_check_adjacency(check)) || (result = check_meshes(check, path)))
        return result;
    if (check->params.no_texels)
        return SLV_OK;
    if ((result = slvi_check_texels(check)))
        return result;
    return check->strips ? slvi_check_seams(check) : SLV_OK;
}

static slv_result check_within(const slv_env *env, const char *path,
                               const slv_ptx_check_params *params, slv_ptx_report **out) {
    check_context check = {.env = slvi_env_or_default(env)};
    check_log log;
    slv_env quiet = slvi_check_log_env(&check.env, &log, path);
    slv_ptx *ptx = NULL;
    *out = NULL;
    if (params)
        check.params = *params;
    if (!check.params.max_findings)
        check.params.max_findings = DEFAULT_MAX_FINDINGS;
    slv_result result = slvi_alloc(env, "report", 1, sizeof *check.report, &check.report);
    if (result)
        return result;
    check.report->worst_seam =
        (slv_check_finding){.kind = SLV_CHECK_SEAMS, .face = -1, .edge = -1, .level = -1};
    if ((result = slvi_check_findings_create(env, check.params.max_findings, &check.findings)))
        goto done;
    const slv_ptx_open_params lenient = {.lenient = true};
    if ((result = slv_ptx_open_with(&quiet, path, &lenient, &ptx))) {
        result = find_failure(&check, SLV_CHECK_STRUCTURE, result, path, &log);
    } else {
        check.ptx = ptx;
        check.report->opened = true;
        result = check_file(&check, path, &log);
    }
    if (!result)
        result = slvi_check_findings_report(env, check.findings, check.report);
    if (!result) {
        *out = check.report;
        check.report = NULL;
    }
done:
    slv_ptx_close(ptx);
    slvi_check_findings_destroy(check.findings);
    slv_ptx_report_destroy(check.report);
    slvi_free(check.faces);
    slvi_free(check.strips);
    slvi_free(check.strip_starts);
    slvi_free(check.unread);
    return result;
}

slv_result slv_ptx_check(const slv_env *env, const char *path, const slv_ptx_check_params *params,
                         slv_ptx_report **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, check_within(&own, path, params, out));
}
