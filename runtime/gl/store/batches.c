#include "gl/store/store.h"

#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/border.h>

#include <string.h>

#define MAX_REACH 9 /* a face and two neighbours across each edge */

/* As the shader reads it; see slv_links in shaders/lookup/links.glsl. */
struct link_row {
    int32_t face[4];
    uint16_t links[4];
    uint32_t corners, levels;
};

void slvi_gl_batches_free(slv_gl_batches *batches) {
    slvi_free(batches->ranges);
    slvi_free(batches->faces);
    memset(batches, 0, sizeof *batches);
}

static slv_result add_range(const slv_env *env, slv_gl_batches *batches, slv_gl_batch_range **out) {
    if (batches->count == batches->capacity) {
        uint32_t capacity = batches->capacity ? batches->capacity * 2 : 16;
        slv_result result =
            slvi_grow(env, "batches", capacity, sizeof *batches->ranges, &batches->ranges);
        if (result)
            return result;
        batches->capacity = capacity;
    }
    *out = &batches->ranges[batches->count++];
    memset(*out, 0, sizeof **out);
    return SLV_OK;
}

slv_result slvi_gl_batches_by_pool(const slv_gl_source *source, const slv_gl_store *store,
                                   slv_gl_batches *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, first = 0;
    slv_gl_batches batches = {0};
    slv_result result =
        slvi_alloc(source->env, "batches", nfaces, sizeof *batches.faces, &batches.faces);
    for (uint32_t p = 0; !result && p < store->npools; p++) {
        slv_gl_batch_range *range = NULL;
        if ((result = add_range(source->env, &batches, &range)))
            break;
        range->first = first;
        range->count = store->pools[p].nlayers;
        range->npools = 1;
        range->pools[0] = p;
        memcpy(batches.faces + first, store->pools[p].faces, range->count * sizeof *batches.faces);
        first += range->count;
    }
    if (result)
        slvi_gl_batches_free(&batches);
    *out = batches;
    return result;
}

/* Adds a pool to a set if it is not there; returns its place. */
static uint32_t add_pool(uint32_t *pools, uint32_t *npools, uint32_t pool) {
    for (uint32_t i = 0; i < *npools; i++)
        if (pools[i] == pool)
            return i;
    pools[*npools] = pool;
    return (*npools)++;
}

/* The pools that a face's lookups can reach, its own first, at most `most`. */
static uint32_t reach_of(const slv_gl_source *source, const slv_gl_store *store, uint32_t face,
                         uint32_t most, uint32_t pools[MAX_REACH], bool *two_subfaces,
                         bool *dropped) {
    uint32_t npools = 0;
    add_pool(pools, &npools, store->pool_of[face]);
    *two_subfaces = false;
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour neighbours[2];
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, neighbours);
        *two_subfaces |= count > 0 && neighbours[0].scale > 1;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t before = npools;
            add_pool(pools, &npools, store->pool_of[neighbours[i].face]);
            if (npools > most) {
                npools = before;
                *dropped = true;
            }
        }
    }
    return npools;
}

static uint32_t variant_for(uint32_t npools, bool two_subfaces) {
    uint32_t log2 = 0;
    while (1u << log2 < npools)
        log2++;
    return log2 << 1 | two_subfaces;
}

/* How many of `pools` a range lacks, or UINT32_MAX if it has no room for them. */
static uint32_t missing_pools(const slv_gl_batch_range *range, const uint32_t *pools,
                              uint32_t npools) {
    uint32_t missing = 0;
    for (uint32_t i = 0; i < npools; i++) {
        uint32_t k = 0;
        while (k < range->npools && range->pools[k] != pools[i])
            k++;
        missing += k == range->npools;
    }
    return range->npools + missing <= slv_gl_variant_pools(range->variant) ? missing : UINT32_MAX;
}

/* The batch that a face joins at the least cost: of its variant, among the newest of its own pool.
 * Where size classes alternate from face to face, neighbouring faces belong to different batches,
 * so that the newest alone would seldom fit. */
static slv_gl_batch_range *find_range(const slv_gl_batches *batches, uint32_t first,
                                      uint32_t variant, const uint32_t *pools, uint32_t npools) {
    enum { NEWEST = 64 };
    slv_gl_batch_range *best = NULL;
    uint32_t least = UINT32_MAX;
    for (uint32_t b = batches->count; b > first && b + NEWEST > batches->count && least > 0; b--) {
        slv_gl_batch_range *range = &batches->ranges[b - 1];
        uint32_t missing =
            range->variant == variant ? missing_pools(range, pools, npools) : UINT32_MAX;
        if (missing < least) {
            least = missing;
            best = range;
        }
    }
    return best;
}

/* Adds a face that needs these pools to one of the batches from `first` on, or to a new one. */
static slv_result join_batch(const slv_env *env, slv_gl_batches *batches, uint32_t first,
                             uint32_t variant, const uint32_t *pools, uint32_t npools,
                             uint32_t *batch) {
    slv_gl_batch_range *range = find_range(batches, first, variant, pools, npools);
    if (!range) {
        slv_result result = add_range(env, batches, &range);
        if (result)
            return result;
        range->variant = variant;
    }
    for (uint32_t i = 0; i < npools; i++)
        add_pool(range->pools, &range->npools, pools[i]);
    range->count++;
    *batch = (uint32_t)(range - batches->ranges);
    return SLV_OK;
}

/* Puts each face into a batch of its own pool whose pools hold its neighbours. Small needs get
 * small batches of their own, so that most faces run the cheapest shader. */
static slv_result assign_batches(const slv_gl_source *source, const slv_gl_store *store,
                                 slv_gl_batches *batches, uint32_t *batch_of) {
    uint32_t dropped_faces = 0, most = source->params.batch_pools;
    slv_result result = SLV_OK;
    for (uint32_t p = 0; p < store->npools; p++) {
        uint32_t first = batches->count;
        for (uint32_t layer = 0; layer < store->pools[p].nlayers; layer++) {
            uint32_t face = store->pools[p].faces[layer], pools[MAX_REACH];
            bool two_subfaces = false, dropped = false;
            uint32_t npools = reach_of(source, store, face, most, pools, &two_subfaces, &dropped);
            uint32_t variant = variant_for(npools, two_subfaces);
            dropped_faces += dropped;
            if ((result = join_batch(source->env, batches, first, variant, pools, npools,
                                     &batch_of[face])))
                return result;
        }
    }
    if (dropped_faces)
        slvi_logf(source->env, SLV_LOG_WARNING,
                  "%u faces meet more array textures than the driver has units for: some of their "
                  "edges are drawn "
                  "as boundaries",
                  dropped_faces);
    return SLV_OK;
}

static uint32_t slot_of(const slv_gl_batch_range *range, uint32_t pool) {
    uint32_t slot = 0;
    while (slot < range->npools && range->pools[slot] != pool)
        slot++;
    return slot;
}

/* Which half of a whole quad's edge a sub-face touches: where the sub-face's edge starts, seen
 * along the quad's. */
static bool second_half(unsigned edge, const slv_neighbour *neighbour) {
    float u, v;
    slvi_edge_point(edge, 0, &u, &v);
    slv_affine_apply(&neighbour->map, u, v, &u, &v);
    return slvi_edge_t(neighbour->edge, u, v) > 0.75f;
}

/* Whether a neighbour's texels are as large as the face's own, along both axes. */
static bool same_texels(const slv_texture_desc *desc, uint32_t face,
                        const slv_neighbour *neighbour) {
    slv_res own = desc->res[face], other = desc->res[neighbour->face];
    int finer = slvi_neighbour_halvings(neighbour);
    bool swapped = neighbour->map.uu == 0;
    return own.u == (swapped ? other.v : other.u) + finer &&
           own.v == (swapped ? other.u : other.v) + finer;
}

static void fill_link_row(const slv_gl_source *source, const slv_gl_store *store,
                          const slv_gl_batches *batches, const uint32_t *batch_of, uint32_t face,
                          struct link_row *row) {
    const slv_gl_batch_range *range = &batches->ranges[batch_of[face]];
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour neighbours[2] = {{0}};
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, neighbours),
                 slots[2] = {0};
        bool fits = count > 0, same[2] = {false, false};
        for (uint32_t i = 0; i < count; i++) {
            same[i] = same_texels(slv_levels_get_desc(source->levels), face, &neighbours[i]);
            slots[i] = slot_of(range, store->pool_of[neighbours[i].face]);
            fits &= slots[i] < range->npools;
        }
        row->face[e] = SLV_BOUNDARY;
        row->links[e] =
            (uint16_t)(slv_adjacency_is_t_corner(source->adjacency, (int32_t)face, e) << 14);
        if (!fits)
            continue;
        /* of two sub-faces the shader starts at the primary, the one that the record names */
        uint32_t first = count == 2 &&
                         neighbours[0].face != slv_adjacency_faces(source->adjacency)[face].face[e];
        uint32_t kind = neighbours[0].scale > 1 ? 2 : neighbours[0].scale < 1 ? 3 : 1;
        bool second = kind == 2 ? count == 2 : kind == 3 && second_half(e, &neighbours[0]);
        row->face[e] = neighbours[first].face;
        row->links[e] |= (uint16_t)(neighbours[first].edge | kind << 2 | (uint32_t)second << 4 |
                                    slots[first] << 5 | slots[!first] << 9 |
                                    (uint32_t)same[0] << 13 | (uint32_t)same[count - 1] << 15);
    }
}

struct corner_job {
    const slv_gl_source *source;
    slv_env env; /* logs one at a time */
    const struct link_row *rows;
    float *corners;
};

static slv_result fill_corners(void *user, uint64_t first, uint64_t end) {
    const struct corner_job *job = user;
    const slv_gl_texture_params *params = &job->source->params;
    float *values = NULL;
    slv_result result =
        slvi_alloc(&job->env, "corner", slv_levels_get_desc(job->source->levels)->nchannels,
                   sizeof *values, &values);
    if (result)
        return result;
    for (uint64_t face = first; face < end; face++) {
        const struct link_row *row = &job->rows[face];
        for (unsigned corner = 0; corner < 4; corner++) {
            for (uint32_t level = 0; level < row->levels; level++) {
                float *out =
                    job->corners + 4 * ((size_t)row->corners + corner * row->levels + level);
                slv_border_vertex(job->source->levels, job->source->adjacency, (uint32_t)face,
                                  level, corner, values);
                out[3] = 1;
                memcpy(out, values + params->first_channel, params->nchannels * sizeof *out);
                if (params->nchannels == 1)
                    out[1] = out[2] = out[0];
            }
        }
    }
    slvi_free(values);
    return SLV_OK;
}

static slv_result upload_links(const slv_gl_source *source, const slv_gl_store *store,
                               const slv_gl_batches *batches, const uint32_t *batch_of,
                               GLuint *links, GLuint *corners, uint64_t *bytes) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    uint64_t ncorners = 0;
    struct link_row *rows = NULL;
    float *values = NULL;
    slv_result result = slvi_alloc(source->env, "link table", nfaces, sizeof *rows, &rows);
    for (uint32_t f = 0; !result && f < nfaces; f++) {
        fill_link_row(source, store, batches, batch_of, f, &rows[f]);
        rows[f].levels = slv_levels_count(source->levels, f);
        rows[f].corners = (uint32_t)ncorners;
        ncorners += 4 * (uint64_t)rows[f].levels;
        if (ncorners > UINT32_MAX)
            result = slvi_fail(source->env, SLV_ERROR_LIMIT,
                               "too many corners for 32-bit indices at face %u", f);
    }
    if (!result)
        result = slvi_alloc(source->env, "corner table", ncorners, 4 * sizeof *values, &values);
    if (!result) {
        struct corner_job job = {.source = source, .rows = rows, .corners = values};
        slv_parallel_log *log = NULL;
        if (!(result = slvi_parallel_env_begin(source->env, &log, &job.env)))
            result = slvi_parallel_for(source->env, nfaces, 256, fill_corners, &job);
        slvi_parallel_env_end(log);
    }
    if (!result)
        result = slvi_gl_table(source, "link table", rows, (uint64_t)nfaces * sizeof *rows, links);
    if (!result)
        result =
            slvi_gl_table(source, "corner table", values, ncorners * 4 * sizeof *values, corners);
    *bytes = (uint64_t)nfaces * sizeof *rows + ncorners * 4 * sizeof *values;
    slvi_free(rows);
    slvi_free(values);
    return result;
}

/* The faces of each batch, in the order of `order`. */
static void list_faces(slv_gl_batches *batches, const uint32_t *order, uint32_t nfaces,
                       const uint32_t *batch_of) {
    uint32_t first = 0;
    for (uint32_t b = 0; b < batches->count; b++) {
        batches->ranges[b].first = first;
        first += batches->ranges[b].count;
        batches->ranges[b].count = 0;
    }
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_gl_batch_range *range = &batches->ranges[batch_of[order[i]]];
        batches->faces[range->first + range->count++] = order[i];
    }
}

/* As the shader reads it; see slv_squares in shaders/strategy/htex.glsl. */
struct square_row {
    uint32_t squares[4], corners[4], centre, unused[3];
};

static uint32_t corner_bits(const slv_htex *htex, uint32_t corner) {
    uint32_t first, log2;
    slv_htex_get_corner(htex, corner, &first, &log2);
    return first | log2 << 27;
}

static void fill_square_row(const slv_gl_store *store, const slv_gl_batch_range *range,
                            const slv_htex *htex, uint32_t f, struct square_row *row) {
    slv_htex_face face = slv_htex_get_face(htex, f);
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t edge = face.edge[k];
        row->squares[k] = store->layer_of[edge] | slot_of(range, store->pool_of[edge]) << 16 |
                          slv_htex_log2(htex, edge) << 20 | (uint32_t)face.second[k] << 25 |
                          (uint32_t)face.part << 26;
        row->corners[k] = corner_bits(htex, face.start[k]);
    }
    row->centre = corner_bits(htex, face.centre);
}

static slv_result upload_squares(const slv_gl_source *source, const slv_htex *htex,
                                 const slv_gl_batches *batches, const uint32_t *batch_of,
                                 slv_gl_store *store) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    const slv_gl_texture_params *params = &source->params;
    uint64_t nvalues = slv_htex_value_count(htex);
    const float *from = slv_htex_values(htex) + params->first_channel;
    struct square_row *rows = NULL;
    float *values = NULL;
    slv_result result;
    if (nvalues >> 27)
        return slvi_fail(source->env, SLV_ERROR_LIMIT, "too many corners for 27-bit indices");
    if ((result = slvi_alloc(source->env, "table of squares", desc->nfaces, sizeof *rows, &rows)) ||
        (result = slvi_alloc(source->env, "corner table", nvalues, 4 * sizeof *values, &values)))
        goto done;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        fill_square_row(store, &batches->ranges[batch_of[f]], htex, f, &rows[f]);
    for (uint64_t i = 0; i < nvalues; i++, from += desc->nchannels) {
        float *to = values + 4 * i;
        to[3] = 1;
        memcpy(to, from, params->nchannels * sizeof *to);
        if (params->nchannels == 1)
            to[1] = to[2] = to[0];
    }
    store->bytes += desc->nfaces * sizeof *rows + nvalues * 4 * sizeof *values;
    if (!(result = slvi_gl_table(source, "table of squares", rows, desc->nfaces * sizeof *rows,
                                 &store->squares)))
        result = slvi_gl_table(source, "corner table", values, nvalues * 4 * sizeof *values,
                               &store->corners);
done:
    slvi_free(rows);
    slvi_free(values);
    return result;
}

slv_result slvi_gl_batches_of_squares(const slv_gl_source *source, slv_gl_store *store,
                                      const slv_htex *htex, const uint32_t *order,
                                      slv_gl_batches *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, *batch_of = NULL;
    slv_gl_batches batches = {0};
    slv_result result;
    if ((result =
             slvi_alloc(source->env, "batches", nfaces, sizeof *batches.faces, &batches.faces)) ||
        (result = slvi_alloc(source->env, "batches", nfaces, sizeof *batch_of, &batch_of)))
        goto done;
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_htex_face face = slv_htex_get_face(htex, order[i]);
        uint32_t pools[4], npools = 0;
        for (uint32_t k = 0; k < 4; k++)
            add_pool(pools, &npools, store->pool_of[face.edge[k]]);
        if ((result = join_batch(source->env, &batches, 0, variant_for(npools, false), pools,
                                 npools, &batch_of[order[i]])))
            goto done;
    }
    list_faces(&batches, order, nfaces, batch_of);
    result = upload_squares(source, htex, &batches, batch_of, store);
done:
    slvi_free(batch_of);
    if (result)
        slvi_gl_batches_free(&batches);
    *out = batches;
    return result;
}

slv_result slvi_gl_batches_with_neighbours(const slv_gl_source *source, const slv_gl_store *store,
                                           slv_gl_batches *out, GLuint *links, GLuint *corners,
                                           uint64_t *bytes) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    slv_gl_batches batches = {0};
    uint32_t *batch_of = NULL;
    slv_result result;
    if ((result =
             slvi_alloc(source->env, "batches", nfaces, sizeof *batches.faces, &batches.faces)) ||
        (result = slvi_alloc(source->env, "batches", nfaces, sizeof *batch_of, &batch_of)) ||
        (result = assign_batches(source, store, &batches, batch_of)))
        goto done;
    list_faces(&batches, store->order, nfaces, batch_of);
    result = upload_links(source, store, &batches, batch_of, links, corners, bytes);
done:
    slvi_free(batch_of);
    if (result)
        slvi_gl_batches_free(&batches);
    *out = batches;
    return result;
}
