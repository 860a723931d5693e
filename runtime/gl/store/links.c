/* The batches and tables of lookups that go on across edges. */
#include "gl/store/links.h"

#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "gl/store/group.h"
#include "gl/store/tables.h"

#include <selvage/border.h>

/* As the shader reads it; see slv_links in shaders/lookup/links.glsl. */
struct link_row {
    int32_t face[4];
    uint16_t links[4];
    uint32_t corners, levels;
};

/* The pools that a face's lookups can reach, its own first, as far as a batch has room. */
static slv_gl_need need_of(const slv_gl_source *source, const slv_gl_pools *layers, uint32_t face,
                           bool *two_subfaces, bool *dropped) {
    slv_gl_need need = {.face = face};
    slvi_gl_add_pool(need.pools, &need.npools, layers->pool_of[face]);
    *two_subfaces = false;
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour neighbours[2];
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, neighbours);
        *two_subfaces |= count > 0 && neighbours[0].scale > 1;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t before = need.npools;
            slvi_gl_add_pool(need.pools, &need.npools, layers->pool_of[neighbours[i].face]);
            if (need.npools > source->params.batch_pools) {
                need.npools = before;
                *dropped = true;
            }
        }
    }
    return need;
}

/* Puts each face into a batch of its own pool whose pools hold its neighbours. Faces beside two
 * sub-faces, which take another shader, get batches of their own. */
static slv_result assign_batches(const slv_gl_source *source, const slv_gl_pools *layers,
                                 slv_gl_batches *batches, uint32_t *batch_of) {
    uint32_t dropped_faces = 0, most_layers = 0;
    slv_gl_need *needs = NULL;
    slv_result result;
    for (uint32_t p = 0; p < layers->npools; p++)
        most_layers =
            layers->pools[p].nlayers > most_layers ? layers->pools[p].nlayers : most_layers;
    result = slvi_alloc(source->env, "batches", most_layers, sizeof *needs, &needs);
    for (uint32_t p = 0; !result && p < layers->npools; p++) {
        const slv_gl_pool *pool = &layers->pools[p];
        for (int subfaces = 0; !result && subfaces < 2; subfaces++) {
            uint32_t count = 0;
            for (uint32_t layer = 0; layer < pool->nlayers; layer++) {
                bool two_subfaces = false, dropped = false;
                needs[count] = need_of(source, layers, pool->items[layer], &two_subfaces, &dropped);
                if (two_subfaces != (subfaces > 0))
                    continue;
                count++;
                dropped_faces += dropped;
            }
            result = slvi_gl_group(source->env, batches, needs, count, layers->npools,
                                   source->params.batch_pools, subfaces > 0, batch_of);
        }
    }
    slvi_free(needs);
    if (!result && dropped_faces)
        slvi_logf(source->env, SLV_LOG_WARNING,
                  "%u faces meet more array textures than the driver has units for: some of their "
                  "edges are drawn "
                  "as boundaries",
                  dropped_faces);
    return result;
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

static void fill_link_row(const slv_gl_source *source, const slv_gl_pools *layers,
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
            slots[i] = slvi_gl_slot_of(range, layers->pool_of[neighbours[i].face]);
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

/* The values at a face's corners: four floats for each level of each corner. `texel` has room for
 * all channels. */
static void corner_values(const slv_gl_source *source, uint32_t face, float *texel, float *out) {
    uint32_t levels = slv_levels_count(source->levels, face);
    for (unsigned corner = 0; corner < 4; corner++) {
        for (uint32_t level = 0; level < levels; level++, out += 4) {
            slv_border_vertex(source->levels, source->adjacency, face, level, corner, texel);
            slvi_gl_table_value(&source->params, texel, out);
        }
    }
}

struct corner_job {
    const slv_gl_source *source;
    const struct link_row *rows;
    float *corners;
};

static slv_result fill_corners(void *user, uint64_t first, uint64_t end) {
    const struct corner_job *job = user;
    float *values = NULL;
    slv_result result =
        slvi_alloc(&job->source->shared, "corner",
                   slv_levels_get_desc(job->source->levels)->nchannels, sizeof *values, &values);
    if (result)
        return result;
    for (uint64_t face = first; face < end; face++)
        corner_values(job->source, (uint32_t)face, values,
                      job->corners + 4 * (size_t)job->rows[face].corners);
    slvi_free(values);
    return result;
}

slv_result slvi_gl_links_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, const uint32_t *faces, uint32_t count,
                                 slv_gl_reach *reach) {
    float *texel = NULL, values[4 * SLV_GL_LEVELS * 4];
    slv_result result =
        slvi_alloc_plain(source->env, "corner", slv_levels_get_desc(source->levels)->nchannels,
                         sizeof *texel, &texel);
    (void)pools;
    (void)made;
    for (uint32_t i = 0; !result && i < count; i++) {
        size_t size = 4 * sizeof *values;
        corner_values(source, faces[i], texel, values);
        source->gl->api.NamedBufferSubData(
            reach->values, (GLintptr)(reach->first_value[faces[i]] * size),
            (GLsizeiptr)(4 * slv_levels_count(source->levels, faces[i]) * size), values);
    }
    slvi_free(texel);
    return result;
}

/* Where the values of each face are, for those who change them. */
static slv_result keep_corners(const slv_gl_source *source, const struct link_row *rows,
                               slv_gl_reach *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    slv_result result = slvi_alloc(source->env, "corner table", nfaces, sizeof *out->first_value,
                                   &out->first_value);
    for (uint32_t f = 0; !result && f < nfaces; f++)
        out->first_value[f] = rows[f].corners;
    return result;
}

static slv_result upload_links(const slv_gl_source *source, const slv_gl_pools *layers,
                               const slv_gl_batches *batches, const uint32_t *batch_of,
                               slv_gl_reach *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    uint64_t ncorners = 0;
    struct link_row *rows = NULL;
    float *values = NULL;
    slv_result result = slvi_alloc(source->env, "link table", nfaces, sizeof *rows, &rows);
    for (uint32_t f = 0; !result && f < nfaces; f++) {
        fill_link_row(source, layers, batches, batch_of, f, &rows[f]);
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
        result = slvi_parallel_for(&source->shared, nfaces, 256, fill_corners, &job);
    }
    if (!result)
        result =
            slvi_gl_table(source, "link table", rows, (uint64_t)nfaces * sizeof *rows, &out->ways);
    if (!result)
        result = slvi_gl_table(source, "corner table", values, ncorners * 4 * sizeof *values,
                               &out->values);
    if (!result && source->params.live)
        result = keep_corners(source, rows, out);
    out->bytes = (uint64_t)nfaces * sizeof *rows + ncorners * 4 * sizeof *values;
    slvi_free(rows);
    slvi_free(values);
    return result;
}

slv_result slvi_gl_reach_neighbours(const slv_gl_source *source, const slv_gl_pools *layers,
                                    const void *made, slv_gl_reach *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, *batch_of = NULL;
    slv_gl_batches *batches = &out->batches;
    slv_result result;
    (void)made;
    if ((result =
             slvi_alloc(source->env, "batches", nfaces, sizeof *batches->faces, &batches->faces)) ||
        (result = slvi_alloc(source->env, "batches", nfaces, sizeof *batch_of, &batch_of)) ||
        (result = assign_batches(source, layers, batches, batch_of)) ||
        (result = slvi_gl_batches_list(source->env, batches, layers->order, nfaces, batch_of)))
        goto done;
    result = upload_links(source, layers, batches, batch_of, out);
done:
    slvi_free(batch_of);
    return result;
}
