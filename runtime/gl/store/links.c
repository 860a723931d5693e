/* The batches and tables of lookups that go on across edges. */
#include "gl/store/links.h"

#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"
#include "gl/store/corners.h"
#include "gl/store/group.h"
#include "gl/store/tables.h"

#include <string.h>

/* As the shader reads it; see slv_links in shaders/lookup/links.glsl. */
struct link_row {
    uint16_t links[4];
    uint32_t unused[2], across[4], beside[4], corners[4];
};

/* The pools that a face's lookups can reach, its own first, as far as a batch has room. */
static slv_gl_need need_of(const slv_gl_source *source, const slv_gl_pools *layers, uint32_t face,
                           bool *subfaces_near, bool *dropped) {
    slv_gl_need need = {.face = face};
    slvi_gl_add_pool(need.pools, &need.npools, layers->pool_of[face]);
    *subfaces_near = slv_adjacency_is_subface(source->adjacency, (int32_t)face);
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour neighbours[2];
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, neighbours);
        *subfaces_near |= count > 0 && neighbours[0].scale > 1;
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

/* Puts each face into a batch of its own pool whose pools hold its neighbours. Sub-faces and
 * their neighbours, which take another shader, get batches of their own. */
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
                bool subfaces_near = false, dropped = false;
                needs[count] =
                    need_of(source, layers, pool->items[layer], &subfaces_near, &dropped);
                if (subfaces_near != (subfaces > 0))
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

/* Where a neighbour's texels are, for a draw that binds the batch. */
static uint32_t site_of(const slv_gl_source *source, const slv_gl_pools *layers,
                        const slv_gl_batch_range *range, int32_t face) {
    slv_res res = slv_levels_get_desc(source->levels)->res[face];
    return layers->layer_of[face] | (uint32_t)res.u << 16 | (uint32_t)res.v << 21 |
           slvi_gl_slot_of(range, layers->pool_of[face]) << 26 |
           (uint32_t)slvi_gl_is_single(source, layers, (uint32_t)face) << 30;
}

static void fill_link_row(const slv_gl_source *source, const slv_gl_pools *layers,
                          const slv_gl_batch_range *range, uint32_t face, struct link_row *row) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour neighbours[2] = {{0}};
        uint32_t count = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, neighbours);
        bool fits = count > 0, same[2] = {false, false};
        for (uint32_t i = 0; i < count; i++) {
            same[i] = same_texels(desc, face, &neighbours[i]);
            fits &= slvi_gl_slot_of(range, layers->pool_of[neighbours[i].face]) < range->npools;
        }
        row->links[e] =
            (uint16_t)(slv_adjacency_is_t_corner(source->adjacency, (int32_t)face, e) << 14);
        if (!fits)
            continue;
        /* of two sub-faces the shader starts at the primary, the one that the record names */
        uint32_t first = count == 2 &&
                         neighbours[0].face != slv_adjacency_faces(source->adjacency)[face].face[e];
        uint32_t kind = neighbours[0].scale > 1 ? 2 : neighbours[0].scale < 1 ? 3 : 1;
        bool second = kind == 2 ? count == 2 : kind == 3 && second_half(e, &neighbours[0]);
        row->across[e] = site_of(source, layers, range, neighbours[first].face);
        if (count == 2)
            row->beside[e] = site_of(source, layers, range, neighbours[!first].face);
        row->links[e] |= (uint16_t)(neighbours[first].edge | kind << 2 | (uint32_t)second << 4 |
                                    (uint32_t)neighbours[!first].edge << 5 |
                                    (uint32_t)same[0] << 13 | (uint32_t)same[count - 1] << 15);
    }
}

slv_result slvi_gl_links_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, const slv_gl_marks *faces, slv_gl_reach *reach) {
    (void)pools;
    (void)made;
    return slvi_gl_corners_refresh(source, reach->chunks, &reach->corners, faces, reach->parts);
}

static slv_result upload_links(const slv_gl_source *source, const slv_gl_pools *layers,
                               const uint32_t *batch_of, slv_gl_reach *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    uint64_t row = sizeof(struct link_row), nvalues = out->corners.first[out->chunks.count];
    struct link_row *rows = NULL;
    float *values = NULL;
    slv_result result = slvi_alloc(source->env, "link table", nfaces, row, &rows);
    for (uint32_t f = 0; !result && f < nfaces; f++) {
        fill_link_row(source, layers, &out->batches.ranges[batch_of[f]], f, &rows[f]);
        memcpy(rows[f].corners, out->corners.where + 4 * (size_t)f, sizeof rows[f].corners);
    }
    if (!result)
        result = slvi_alloc(source->env, "corner table", nvalues, 4 * sizeof *values, &values);
    if (!result)
        result = slvi_gl_corners_fill(source, out->chunks, &out->corners, values);
    if (!result)
        result = slvi_gl_parts_make(source, out->chunks,
                                    &(slv_gl_part_rows){rows, row, values, out->corners.first},
                                    &out->parts);
    out->bytes = nfaces * row + nvalues * 4 * sizeof *values;
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
        (result =
             slvi_gl_corners_list(source, sizeof(struct link_row), &out->chunks, &out->corners)) ||
        (result = assign_batches(source, layers, batches, batch_of)) ||
        (result = slvi_gl_batches_list(source->env, batches, layers->order, nfaces, out->chunks,
                                       batch_of)))
        goto done;
    result = upload_links(source, layers, batch_of, out);
done:
    slvi_free(batch_of);
    return result;
}
