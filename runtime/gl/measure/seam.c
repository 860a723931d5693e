/* Seam jumps: lookups on both sides of every shared edge. */
#include "gl/store/texture.h"

#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

#define MAGNIFIED (1.0f / 64)

/* One shared stretch of edge, seen from the side that names it. */
struct seam {
    int32_t face, other;
    unsigned edge;
    slv_neighbour neighbour;
    bool equal;
    float du, dv; /* footprint in the first face's (u,v) */
};

/* The neighbour's texel, measured in the first face's (u,v). */
static void texel_seen_from(const slv_affine *map, slv_res res, float *du, float *dv) {
    float u = 1.0f / (float)(1u << res.u), v = 1.0f / (float)(1u << res.v);
    /* axes are swapped or not, so the inverse of the linear part has the reciprocals in transposed
     * places */
    if (map->uu != 0) {
        *du = u / fabsf(map->uu);
        *dv = v / fabsf(map->vv);
    } else {
        *dv = u / fabsf(map->uv);
        *du = v / fabsf(map->vu);
    }
}

static void make_seam(const slv_res *table, int32_t face, unsigned edge,
                      const slv_neighbour *neighbour, uint32_t level, struct seam *out) {
    slv_res res = table[face];
    float du = 1.0f / (float)(1u << res.u), dv = 1.0f / (float)(1u << res.v), other_du, other_dv;
    float texels = level ? (float)(1u << level) : MAGNIFIED;
    texel_seen_from(&neighbour->map, table[neighbour->face], &other_du, &other_dv);
    *out = (struct seam){.face = face,
                         .other = neighbour->face,
                         .edge = edge,
                         .neighbour = *neighbour,
                         .equal = du == other_du && dv == other_dv,
                         .du = texels * fmaxf(du, other_du),
                         .dv = texels * fmaxf(dv, other_dv)};
}

/* Each shared edge of faces first..end-1 once: from the whole quad where sub-faces meet one, else
 * from the side that comes first. */
static slv_result find_seams(const slv_env *env, const slv_adjacency *adjacency,
                             const slv_res *table, const slv_gl_seam_params *params,
                             struct seam **out, uint32_t *count) {
    const uint32_t first_face = params->first_face,
                   all = slv_adjacency_face_count(adjacency) - first_face,
                   nfaces = params->nfaces ? params->nfaces : all, level = params->level;
    uint32_t found = 0;
    slv_result result = slvi_alloc(env, "seams", (uint64_t)nfaces * 8, sizeof **out, out);
    if (result)
        return result;
    for (uint32_t f = first_face; f < first_face + nfaces; f++) {
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour neighbours[2];
            uint32_t n = slv_adjacency_neighbours(adjacency, (int32_t)f, e, neighbours);
            for (uint32_t i = 0; i < n; i++) {
                const slv_neighbour *other = &neighbours[i];
                bool first =
                    other->face != (int32_t)f ? (int32_t)f < other->face : e <= other->edge;
                if (other->scale > 1 || (other->scale == 1 && first))
                    make_seam(table, (int32_t)f, e, other, level, &(*out)[found++]);
            }
        }
    }
    *count = found;
    return SLV_OK;
}

static void side_points(const struct seam *seam, float t, size_t at, int32_t *faces, float *uv,
                        float *dx, float *dy) {
    const slv_affine *map = &seam->neighbour.map;
    float u, v;
    slvi_edge_point(seam->edge, t, &u, &v);
    faces[at] = seam->face;
    uv[2 * at] = u;
    uv[2 * at + 1] = v;
    dx[2 * at] = seam->du;
    dx[2 * at + 1] = 0;
    dy[2 * at] = 0;
    dy[2 * at + 1] = seam->dv;
    at++;
    faces[at] = seam->other;
    slv_affine_apply(map, u, v, &uv[2 * at], &uv[2 * at + 1]);
    dx[2 * at] = map->uu * seam->du;
    dx[2 * at + 1] = map->vu * seam->du;
    dy[2 * at] = map->uv * seam->dv;
    dy[2 * at + 1] = map->vv * seam->dv;
}

static void measure(const struct seam *seams, uint32_t nseams, uint32_t samples,
                    const float *values, slv_gl_seam *out) {
    double sum = 0, equal_sum = 0;
    for (uint32_t s = 0; s < nseams; s++) {
        const struct seam *seam = &seams[s];
        out->nequal += seam->equal;
        for (uint32_t k = 0; k < samples; k++) {
            const float *a = values + 8 * ((size_t)s * samples + k), *b = a + 4;
            float jump = 0;
            for (int c = 0; c < 4; c++) {
                float difference = fabsf(a[c] - b[c]);
                if (!(difference <= jump)) /* a NaN is the worst of jumps */
                    jump = isnan(difference) ? INFINITY : difference;
            }
            sum += jump;
            if (seam->equal) {
                equal_sum += jump;
                out->equal_max = fmaxf(out->equal_max, jump);
            }
            if (jump > out->max || out->face < 0) {
                float fraction = (float)k / (float)(samples - 1);
                out->max = jump;
                out->face = seam->face;
                out->edge = (int32_t)seam->edge;
                out->t = seam->neighbour.t0 + fraction * (seam->neighbour.t1 - seam->neighbour.t0);
            }
        }
    }
    out->nedges = nseams;
    out->mean = nseams ? (float)(sum / ((double)nseams * samples)) : 0;
    out->equal_mean = out->nequal ? (float)(equal_sum / ((double)out->nequal * samples)) : 0;
}

slv_result slv_gl_texture_seam_jump(slv_gl_texture *texture, const slv_env *env,
                                    const slv_strategy *strategy, const slv_adjacency *adjacency,
                                    const slv_gl_seam_params *params, slv_gl_seam *out) {
    const slv_gl_seam_params p = params ? *params : (slv_gl_seam_params){0};
    const uint32_t samples = p.samples > 1 ? p.samples : 17;
    uint32_t nseams = 0;
    struct seam *seams = NULL;
    int32_t *faces = NULL;
    float *floats = NULL;
    slv_result result;
    memset(out, 0, sizeof *out);
    out->face = out->edge = -1;
    if (slv_adjacency_face_count(adjacency) != texture->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, the adjacency %u",
                         texture->nfaces, slv_adjacency_face_count(adjacency));
    if (p.level > SLV_MAX_LOG2_RES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "there is no level %u", p.level);
    if (p.first_face > texture->nfaces || p.nfaces > texture->nfaces - p.first_face)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%u faces from %u on: there are %u", p.nfaces,
                         p.first_face, texture->nfaces);
    if ((result = find_seams(env, adjacency, texture->res, &p, &seams, &nseams)))
        goto done;
    uint64_t count = 2 * (uint64_t)nseams * samples;
    if (count > UINT32_MAX) {
        result =
            slvi_fail(env, SLV_ERROR_LIMIT, "too many samples: %u edges of %u", nseams, samples);
        goto done;
    }
    if ((result = slvi_alloc(env, "seam samples", count, sizeof *faces, &faces)) ||
        (result = slvi_alloc(env, "seam samples", count * 10, sizeof *floats, &floats)))
        goto done;
    float *uv = floats, *dx = uv + 2 * count, *dy = dx + 2 * count, *values = dy + 2 * count;
    for (uint32_t s = 0; s < nseams; s++) {
        for (uint32_t k = 0; k < samples; k++) {
            float fraction = (float)k / (float)(samples - 1);
            float t =
                seams[s].neighbour.t0 + fraction * (seams[s].neighbour.t1 - seams[s].neighbour.t0);
            side_points(&seams[s], t, 2 * ((size_t)s * samples + k), faces, uv, dx, dy);
        }
    }
    result =
        slv_gl_texture_lookup(texture, env, strategy, (uint32_t)count, faces, uv, dx, dy, values);
    if (!result)
        measure(seams, nseams, samples, values, out);
done:
    slvi_free(seams);
    slvi_free(faces);
    slvi_free(floats);
    return result;
}
