/* Resolutions: as a blank texture would have them, or as the source itself is resolved. */
#include "recipe/plan.h"
#include "rays/coverage.h"
#include "recipe/fit.h"
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/blank.h>

#include <math.h>

enum { DEFAULT_MAX_LOG2 = 12 };

static int8_t within(double value, int low, int high) {
    return (int8_t)(value > low ? (value < high ? lround(value) : high) : low); /* NaN: low */
}

/* The job with what faces are kept within, though it leaves that to us; blank textures know what
 * uniform ones are. */
static slv_bake_job limited(const slv_bake_job *job) {
    slv_bake_job out = *job;
    if (!out.uniform && !out.max_given && !out.max_res.u && !out.max_res.v) {
        out.max_res.u = out.min_res.u > DEFAULT_MAX_LOG2 ? out.min_res.u : DEFAULT_MAX_LOG2;
        out.max_res.v = out.min_res.v > DEFAULT_MAX_LOG2 ? out.min_res.v : DEFAULT_MAX_LOG2;
        out.max_given = true;
    }
    return out;
}

static slv_result match(const slv_env *env, const slv_bake_source *source, const slv_bake_job *job,
                        slv_res **out) {
    slv_res low = job->min_res, high = job->max_res;
    double scale = job->match > 0 ? (double)job->match : 1;
    slv_result result = slvi_alloc(env, "resolutions", source->nfaces, sizeof **out, out);
    for (uint32_t face = 0; face < source->nfaces && !result; face++) {
        float size[2];
        source->fns->extent(source, face, size);
        (*out)[face] = (slv_res){within(log2((double)size[0] * scale), low.u, high.u),
                                 within(log2((double)size[1] * scale), low.v, high.v)};
    }
    return result;
}

static slv_result by_views(const slv_env *env, const slv_mesh *mesh, const slv_bake_job *job,
                           slv_res **out) {
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_res low = job->min_res, high = job->max_res;
    double scale = job->texels_per_pixel > 0 ? (double)job->texels_per_pixel : 1;
    float *sizes = NULL;
    slv_result result = slvi_alloc(env, "resolutions", nfaces, sizeof **out, out);
    if (!result)
        result = slvi_alloc(env, "resolutions", nfaces, 2 * sizeof *sizes, &sizes);
    if (!result)
        result = slvi_coverage(env, mesh, job, sizes);
    for (uint32_t face = 0; face < nfaces && !result; face++) {
        const float *size = sizes + 2 * (size_t)face;
        (*out)[face] = (slv_res){within(log2((double)size[0] * scale), low.u, high.u),
                                 within(log2((double)size[1] * scale), low.v, high.v)};
    }
    slvi_free(sizes);
    return result;
}

static void tell(const slv_res *res, uint32_t nfaces, slv_bake_report *report) {
    for (uint32_t face = 0; face < nfaces; face++) {
        int size = res[face].u + res[face].v;
        if (!face || size < report->smallest.u + report->smallest.v)
            report->smallest = res[face];
        if (!face || size > report->largest.u + report->largest.v)
            report->largest = res[face];
        report->texels += UINT64_C(1) << size;
    }
}

/* The two texels of a whole quad's edge beside two sub-faces are its corners', and none is left for
 * the vertex in its middle: such a quad gets four, as far as it may. */
static void widen_quads(const slv_adjacency *adjacency, slv_res high, uint64_t room, slv_res *res) {
    uint32_t nfaces = slv_adjacency_face_count(adjacency);
    for (uint32_t face = 0; face < nfaces; face++)
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour across[2];
            int8_t *side = edge % 2 ? &res[face].v : &res[face].u;
            uint64_t more = UINT64_C(1) << (res[face].u + res[face].v);
            if (*side != 1 || (edge % 2 ? high.v : high.u) < 2 || more > room ||
                !slv_adjacency_neighbours(adjacency, (int32_t)face, edge, across) ||
                across[0].scale <= 1)
                continue;
            *side = 2;
            room -= more;
        }
}

static slv_result widen(const slv_env *env, const slv_mesh *mesh, const slv_bake_job *job,
                        uint64_t most, slv_res *res) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_res high = job->max_res;
    uint64_t room = most ? most : UINT64_MAX;
    uint32_t poly = 0;
    slv_adjacency *adjacency = NULL;
    while (poly < view->npolys && view->poly_sizes[poly] == 4)
        poly++;
    if (poly == view->npolys)
        return SLV_OK;
    for (uint32_t face = 0; most && face < slv_mesh_face_count(mesh); face++) {
        uint64_t texels = UINT64_C(1) << (res[face].u + res[face].v);
        room = room > texels ? room - texels : 0;
    }
    slv_result result = slv_mesh_adjacency(env, mesh, &adjacency);
    if (!result)
        widen_quads(adjacency, high, room, res);
    slv_adjacency_destroy(adjacency);
    return result;
}

slv_result slvi_bake_plan(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                          const slv_bake_job *asked, const encoder *e, slv_res **out,
                          slv_bake_report *report) {
    const slv_bake_job own_job = limited(asked), *job = &own_job;
    slv_type type = job->type_given ? job->type : source->desc.type;
    uint64_t most = job->max_texels;
    if (job->max_bytes)
        most = job->max_bytes / (source->desc.nchannels * slv_type_size(type));
    most += job->max_bytes && !most;
    const slv_blank_params blank = {.uniform = job->uniform,
                                    .res = job->res,
                                    .density = job->density,
                                    .max_texels = most,
                                    .min_res = job->min_res,
                                    .max_res = job->max_res,
                                    .max_given = job->max_given,
                                    .scheme = job->scheme};
    *out = NULL;
    int given = (job->uniform != 0) + (job->density != 0) + (job->max_texels != 0) +
                (job->max_bytes != 0) + (job->match != 0) + (job->max_error != 0) +
                (job->nviews != 0);
    if (given > 1)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: a resolution, a density, a number of texels, an error, views or a "
                         "match with the source: one of them");
    if (!(job->match >= 0) || !isfinite(job->match))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: %g texels for one of the source, expected more than 0",
                         (double)job->match);
    if (!(job->texels_per_pixel >= 0) || !isfinite(job->texels_per_pixel))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: %g texels for a pixel, expected more than 0",
                         (double)job->texels_per_pixel);
    if (!(job->max_error >= 0) || !isfinite(job->max_error))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: an error of %g, expected more than 0",
                         (double)job->max_error);
    bool own = source->fns->extent && (!given || job->match != 0);
    if (job->match != 0 && !own)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: the source has no resolution to match");
    slv_result result = SLV_OK;
    if (job->least_error && !most)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: the least error of how many texels or bytes?");
    if (job->least_error) {
        result = slvi_alloc(env, "resolutions", source->nfaces, sizeof **out, out);
        result = result ? result : slvi_bake_fit_within(env, source, job, e, most, *out, report);
    } else if (job->max_error > 0) {
        result = slvi_alloc(env, "resolutions", source->nfaces, sizeof **out, out);
        result = result ? result : slvi_bake_fit(env, source, job, e, *out, report);
    } else if (job->nviews) {
        result = by_views(env, mesh, job, out);
    } else if (own) {
        result = match(env, source, job, out);
    } else {
        result = slv_blank_plan(env, mesh, &blank, out, NULL);
    }
    if (!result && job->seams_given && job->seams == SLV_PTX_SEAMS_ALL && !job->uniform)
        result = widen(env, mesh, job, most, *out);
    if (!result) {
        tell(*out, source->nfaces, report);
        return SLV_OK;
    }
    slvi_free(*out);
    *out = NULL;
    return result;
}
