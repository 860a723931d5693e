/* The texture of a reference: borders, and what they leave to be mended. */
#include "rays/reference_texels.h"

#include "adjacency/edge.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/border.h>

#include <math.h>
#include <string.h>

struct filling {
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    const slv_env *env;
    uint32_t first_channel, nsource;
    const reference_texels *texels;
};

static uint64_t bordered(slv_res res) {
    return ((UINT64_C(1) << res.u) + 2) * ((UINT64_C(1) << res.v) + 2);
}

static slv_result fill(void *user, uint64_t begin, uint64_t end) {
    const struct filling *f = user;
    const reference_texels *t = f->texels;
    float *whole = NULL;
    slv_result result = SLV_OK;
    if (f->nsource != t->nchannels) {
        uint64_t most = 0;
        for (uint64_t face = begin; face < end; face++)
            most = bordered(t->res[face]) > most ? bordered(t->res[face]) : most;
        if ((result = slvi_alloc(f->env, "texels", most * f->nsource, sizeof *whole, &whole)))
            return result;
    }
    for (uint64_t face = begin; face < end && !result; face++) {
        float *to = t->values + t->first[face];
        result = slv_border_build(f->levels, f->adjacency, (uint32_t)face, 0, 1, 1,
                                  whole ? whole : to, NULL);
        for (uint64_t i = 0; whole && !result && i < bordered(t->res[face]); i++)
            memcpy(to + i * t->nchannels, whole + i * f->nsource + f->first_channel,
                   t->nchannels * sizeof *to);
    }
    slvi_free(whole);
    return result;
}

/* Whether the texels of a face are shorter than a neighbour's along the edge where they meet. */
static bool finer(const slv_res *res, uint32_t face, unsigned edge, const slv_neighbour *to) {
    int own = slvi_edge_along(edge, res[face].u, res[face].v);
    int other = slvi_edge_along(to->edge, res[to->face].u, res[to->face].v);
    return own > other + slvi_neighbour_halvings(to);
}

/* Counts the links of all faces, and lists them once there is room. */
static void list_links(const slv_adjacency *adjacency, uint32_t nfaces, reference_texels *t) {
    uint32_t count = 0;
    for (uint32_t face = 0; face < nfaces; face++) {
        t->first_link[face] = count;
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour to[2];
            uint32_t n = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, to);
            for (uint32_t i = 0; i < n; i++) {
                if (!finer(t->res, face, edge, &to[i]))
                    continue;
                if (t->links)
                    t->links[count] =
                        (reference_link){(uint32_t)to[i].face, edge, to[i].t0, to[i].t1, to[i].map};
                count++;
            }
        }
    }
    t->first_link[nfaces] = count;
}

/* The whole quad whose edge goes straight past a corner of two sub-faces, and its value there. */
static bool quad_value(const reference_texels *t, const slv_adjacency *adjacency, uint32_t face,
                       unsigned corner, float value[4]) {
    for (unsigned side = 0; side < 2; side++) {
        slv_neighbour to[2];
        float u = (float)slvi_corner_u(corner), v = (float)slvi_corner_v(corner);
        unsigned edge = side ? slvi_edge_before(corner) : corner;
        if (slv_adjacency_neighbours(adjacency, (int32_t)face, edge, to) != 1 || to->scale >= 1.0f)
            continue;
        slv_affine_apply(&to->map, u, v, &u, &v);
        reference_bilinear(t, (uint32_t)to->face, reference_clamp(u, 1.0f),
                           reference_clamp(v, 1.0f), value);
        return true;
    }
    return false;
}

static void corner_value(const reference_texels *t, uint32_t face, unsigned corner,
                         float value[4]) {
    reference_bilinear(t, face, (float)slvi_corner_u(corner), (float)slvi_corner_v(corner), value);
}

/* Not for vectors, which are other numbers in each face. One value for each vertex: borders give it
 * nearly always, but where oblong resolutions contradict each other around a vertex, or at the
 * middle of a whole quad's edge, only almost. */
static void mend_corners(const slv_adjacency *adjacency, uint32_t nfaces, reference_texels *t) {
    for (uint32_t face = 0; face < nfaces; face++) {
        t->mended[face] |= t->first_link[face] != t->first_link[face + 1];
        for (unsigned corner = 0; corner < 4; corner++) {
            uint32_t position;
            slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)face, corner, &position);
            float value[4], meeting[4];
            double sum[4] = {0, 0, 0, 0};
            if (position)
                continue;
            for (uint32_t i = 0; i < ring.count; i++) {
                corner_value(t, (uint32_t)ring.corners[i].face, ring.corners[i].corner, value);
                for (uint32_t c = 0; c < t->nchannels; c++)
                    sum[c] += (double)value[c];
            }
            for (uint32_t c = 0; c < t->nchannels; c++)
                meeting[c] = (float)(sum[c] / ring.count);
            if (slv_adjacency_is_t_corner(adjacency, (int32_t)face, corner))
                quad_value(t, adjacency, face, corner, meeting);
            for (uint32_t i = 0; i < ring.count; i++) {
                uint32_t other = (uint32_t)ring.corners[i].face, k = ring.corners[i].corner;
                corner_value(t, other, k, value);
                for (uint32_t c = 0; c < t->nchannels; c++) {
                    float lacks = meeting[c] - value[c];
                    t->corners[((size_t)other * 4 + k) * t->nchannels + c] = lacks;
                    t->mended[other] |= fabsf(lacks) > 1e-6f * (1.0f + fabsf(value[c]));
                }
            }
        }
    }
}

/* Bilinear, with what the corners lack added within half a texel of them. */
static void with_corners(const reference_texels *t, uint32_t face, float u, float v,
                         float rgba[4]) {
    float x = u * (float)(1u << t->res[face].u), y = v * (float)(1u << t->res[face].v);
    float right = (float)(1u << t->res[face].u) - x, top = (float)(1u << t->res[face].v) - y;
    reference_bilinear(t, face, u, v, rgba);
    for (unsigned corner = 0; corner < 4; corner++) {
        float across = 1.0f - 2.0f * (slvi_corner_u(corner) ? right : x);
        float up = 1.0f - 2.0f * (slvi_corner_v(corner) ? top : y);
        const float *lacks = t->corners + ((size_t)face * 4 + corner) * t->nchannels;
        for (uint32_t c = 0; across > 0 && up > 0 && c < t->nchannels; c++)
            rgba[c] += across * up * lacks[c];
    }
}

/* On an edge the border texels agree with those of a coarser neighbour at this face's texel centres
 * only, and between two of them where the neighbour is linear. What is left is added here, fading
 * out towards the row of centres. */
void slvi_reference_mend(const reference_texels *t, uint32_t face, float u, float v,
                         float rgba[4]) {
    float width = (float)(1u << t->res[face].u), height = (float)(1u << t->res[face].v);
    with_corners(t, face, u, v, rgba);
    for (uint32_t i = t->first_link[face]; i < t->first_link[face + 1]; i++) {
        const reference_link *link = &t->links[i];
        float texels = slvi_edge_along_v(link->edge) ? width : height, own[4], other[4];
        float depth = slvi_edge_depth(link->edge, u, v) * texels;
        float at = slvi_edge_t(link->edge, u, v), edge_u = u, edge_v = v;
        if (depth >= 0.5f || at < link->t0 || at > link->t1 || (at == link->t1 && at < 1.0f))
            continue;
        slvi_edge_project(link->edge, &edge_u, &edge_v);
        with_corners(t, face, edge_u, edge_v, own);
        slv_affine_apply(&link->map, edge_u, edge_v, &edge_u, &edge_v);
        with_corners(t, link->face, reference_clamp(edge_u, 1.0f), reference_clamp(edge_v, 1.0f),
                     other);
        for (uint32_t c = 0; c < t->nchannels; c++)
            rgba[c] += (1.0f - 2.0f * depth) * (other[c] - own[c]);
    }
}

slv_result slvi_reference_texels_create(const slv_env *env, const slv_texture *texture,
                                        const slv_adjacency *adjacency,
                                        const slv_reference_params *params, uint32_t nchannels,
                                        reference_texels *out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    reference_texels made = {.nchannels = nchannels};
    slv_parallel_log *log = NULL;
    slv_levels *levels = NULL;
    slv_env serial;
    const bool vectors = params->edge_filter == SLV_EDGE_FILTER_TANVEC && desc->nchannels > 1;
    uint64_t count = 0;
    slv_result result;
    if ((result = slvi_alloc(env, "resolutions", desc->nfaces, sizeof *made.res, &made.res)) ||
        (result = slvi_alloc(env, "faces", desc->nfaces, sizeof *made.first, &made.first)) ||
        (result = slvi_alloc(env, "faces", (uint64_t)desc->nfaces + 1, sizeof *made.first_link,
                             &made.first_link)))
        goto done;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        made.res[face] = desc->res[face];
        made.first[face] = count;
        count += bordered(desc->res[face]) * nchannels;
    }
    list_links(adjacency, desc->nfaces, &made);
    if ((result = slvi_alloc(env, "links", made.first_link[desc->nfaces], sizeof *made.links,
                             &made.links)) ||
        (result = slvi_alloc(env, "corners", (uint64_t)desc->nfaces * 4 * nchannels,
                             sizeof *made.corners, &made.corners)) ||
        (result = slvi_alloc(env, "faces", desc->nfaces, sizeof *made.mended, &made.mended)))
        goto done;
    list_links(adjacency, desc->nfaces, &made);
    if ((result = slvi_alloc(env, "texels as floats", count, sizeof *made.values, &made.values)) ||
        (result = slvi_parallel_env_begin(env, &log, &serial)) ||
        (result = slv_levels_create_over(&serial, texture, &levels)))
        goto done;
    slv_levels_set_edge_filter(levels, params->edge_filter);
    struct filling filling = {levels,          adjacency, &serial, params->first_channel,
                              desc->nchannels, &made};
    if (!(result = slvi_parallel_for(env, desc->nfaces, 16, fill, &filling)) && !vectors)
        mend_corners(adjacency, desc->nfaces, &made);
done:
    slv_levels_destroy(levels);
    slvi_parallel_env_end(log);
    if (result)
        slvi_reference_texels_free(&made);
    *out = made;
    return result;
}

slv_result slvi_reference_texels_border(const slv_env *env, const slv_adjacency *adjacency,
                                        slv_border_mode border_u, slv_border_mode border_v,
                                        reference_texels *texels) {
    uint32_t nfaces = slv_adjacency_face_count(adjacency);
    if (border_u != SLV_BORDER_BLACK && border_v != SLV_BORDER_BLACK)
        return SLV_OK;
    slv_result result = slvi_alloc(env, "faces", nfaces, 1, &texels->black);
    for (uint32_t face = 0; face < nfaces && !result; face++)
        texels->black[face] = (uint8_t)slvi_black_edges(adjacency, face, border_u, border_v);
    return result;
}

void slvi_reference_texels_free(reference_texels *texels) {
    slvi_free(texels->black);
    slvi_free(texels->res);
    slvi_free(texels->first);
    slvi_free(texels->values);
    slvi_free(texels->first_link);
    slvi_free(texels->links);
    slvi_free(texels->corners);
    slvi_free(texels->mended);
    memset(texels, 0, sizeof *texels);
}
