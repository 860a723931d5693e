/* The batches and tables of lookups in squares of edges. */
#include "gl/store/squares.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/group.h"
#include "gl/store/tables.h"

#include <selvage/htex.h>

#include <string.h>

/* As the shader reads it; see slv_squares in shaders/strategy/htex.glsl. */
struct square_row {
    uint32_t squares[4], corners[4], centre, turns, unused[2];
};

enum { CORNERS = 5 }; /* of a row: where four half-edges start, and the centre */

static uint32_t corner_of(const slv_htex_face *face, uint32_t k) {
    return k < 4 ? face->start[k] : face->centre;
}

/* Numbers the values of the corners that the faces of each part need. Where there is one part they
 * lie as the form has them. */
static slv_result list_corners(const slv_gl_source *source, const slv_htex *htex,
                               slv_gl_chunks chunks, uint32_t *part_of, slv_gl_corners *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, chunk = 0, *number = NULL;
    uint64_t most = slvi_gl_parts_limit(source->gl) / 16, filled = 0;
    slv_result result = slvi_alloc(source->env, "corner table", slv_htex_value_count(htex),
                                   sizeof *number, &number);
    most = most < 1u << 27 ? most : 1u << 27;
    memset(part_of, 0xff, slv_htex_value_count(htex) * sizeof *part_of);
    for (uint32_t f = 0; !result && f < nfaces; f++) {
        slv_htex_face face = slv_htex_get_face(htex, f);
        if (chunk != slv_gl_chunk_of(chunks, f)) {
            out->first[++chunk] = filled;
        }
        for (uint32_t k = 0; k < CORNERS; k++) {
            uint32_t corner = corner_of(&face, k), first, log2;
            slv_htex_get_corner(htex, corner, &first, &log2);
            if (part_of[corner] != chunk) {
                part_of[corner] = chunk;
                number[corner] = (uint32_t)(filled - out->first[chunk]);
                filled += log2 + 1;
            }
            out->where[CORNERS * (size_t)f + k] = number[corner] | log2 << 27;
        }
        if (filled - out->first[chunk] > most)
            result = SLV_ERROR_LIMIT;
    }
    out->first[chunk + 1] = filled;
    slvi_free(number);
    return result;
}

/* As large parts as the driver's limits allow. */
static slv_result choose_chunks(const slv_gl_source *source, const slv_htex *htex,
                                slv_gl_reach *out) {
    const slv_env *env = source->env;
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, log2 = 32, *part_of = NULL;
    uint64_t row = sizeof(struct square_row), limit = slvi_gl_parts_limit(source->gl);
    slv_gl_corners *corners = &out->corners;
    slv_result result;
    if ((result = slvi_alloc(env, "corner table", (uint64_t)nfaces * CORNERS,
                             sizeof *corners->where, &corners->where)) ||
        (result = slvi_alloc(env, "corner table", slv_htex_value_count(htex), sizeof *part_of,
                             &part_of)))
        goto done;
    if (nfaces * row > limit)
        for (log2 = 31; log2 > 5 && row << log2 > limit;)
            log2--;
    for (bool again = true; !result && again;) {
        out->chunks = slv_gl_chunks_of(nfaces, log2);
        slvi_free(corners->first);
        corners->first = NULL;
        if ((result = slvi_alloc(env, "corner table", out->chunks.count + (uint64_t)1,
                                 sizeof *corners->first, &corners->first)))
            break;
        result = list_corners(source, htex, out->chunks, part_of, corners);
        again = result == SLV_ERROR_LIMIT && log2 > 5;
        if (again) {
            result = SLV_OK;
            do
                log2--;
            while (log2 > 5 && UINT64_C(1) << log2 >= nfaces);
        }
    }
    if (result == SLV_ERROR_LIMIT)
        result = slvi_fail(env, result, "the corner table does not fit the limit of %llu bytes",
                           (unsigned long long)limit);
done:
    slvi_free(part_of);
    return result;
}

static void fill_square_row(const slv_gl_pools *layers, const slv_gl_reach *reach,
                            const slv_gl_batch_range *range, const slv_htex *htex, uint32_t f,
                            struct square_row *row) {
    slv_htex_face face = slv_htex_get_face(htex, f);
    const uint32_t *where = reach->corners.where + CORNERS * (size_t)f;
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t edge = face.edge[k];
        row->squares[k] = layers->layer_of[edge] |
                          slvi_gl_slot_of(range, layers->pool_of[edge]) << 16 |
                          (uint32_t)layers->pools[layers->pool_of[edge]].res.u << 20 |
                          (uint32_t)face.second[k] << 25 | (uint32_t)face.part << 26;
        row->corners[k] = where[k];
    }
    row->centre = where[4];
    row->turns = 0;
    for (uint32_t i = 0; i < sizeof face.turns; i++)
        row->turns |= (uint32_t)face.turns[i] << 2 * i;
}

/* All values of a corner, which follow one another; returns how many. */
static uint32_t corner_values(const slv_gl_source *source, const slv_htex *htex, uint32_t corner,
                              float *out) {
    uint32_t first, log2, nchannels = slv_htex_get_desc(htex)->nchannels;
    slv_htex_get_corner(htex, corner, &first, &log2);
    for (uint32_t i = 0; i <= log2; i++)
        slvi_gl_table_value(&source->params,
                            slv_htex_values(htex) + (size_t)(first + i) * nchannels, out + 4 * i);
    return log2 + 1;
}

static uint64_t first_value(const slv_gl_reach *reach, uint32_t f, uint32_t k) {
    return reach->corners.first[slv_gl_chunk_of(reach->chunks, f)] +
           (reach->corners.where[CORNERS * (size_t)f + k] & 0x7ffffffu);
}

static slv_result upload_squares(const slv_gl_source *source, const slv_htex *htex,
                                 const uint32_t *batch_of, const slv_gl_pools *layers,
                                 slv_gl_reach *out) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    uint64_t nvalues = out->corners.first[out->chunks.count], row = sizeof(struct square_row);
    struct square_row *rows = NULL;
    float *values = NULL;
    slv_result result;
    if ((result = slvi_alloc(source->env, "table of squares", desc->nfaces, row, &rows)) ||
        (result = slvi_alloc(source->env, "corner table", nvalues, 4 * sizeof *values, &values)))
        goto done;
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        slv_htex_face face = slv_htex_get_face(htex, f);
        fill_square_row(layers, out, &out->batches.ranges[batch_of[f]], htex, f, &rows[f]);
        for (uint32_t k = 0; k < CORNERS; k++)
            corner_values(source, htex, corner_of(&face, k), values + 4 * first_value(out, f, k));
    }
    out->bytes = desc->nfaces * row + nvalues * 4 * sizeof *values;
    slv_gl_part_rows from = {rows, row, values, out->corners.first};
    result = slvi_gl_parts_make(source, out->chunks, &from, &out->parts);
done:
    slvi_free(rows);
    slvi_free(values);
    return result;
}

slv_result slvi_gl_reach_squares(const slv_gl_source *source, const slv_gl_pools *layers,
                                 const void *made, slv_gl_reach *out) {
    const slv_htex *htex = slv_form_get_htex(layers->form, made);
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    uint32_t *batch_of = NULL, *order = NULL, most;
    slv_gl_need *needs = NULL;
    slv_gl_batches *batches = &out->batches;
    slv_result result;
    if (!htex)
        return slvi_fail(source->env, SLV_ERROR_ARGUMENT, "the form %s has no squares of edges",
                         layers->form->name);
    if ((result =
             slvi_alloc(source->env, "batches", nfaces, sizeof *batches->faces, &batches->faces)) ||
        (result = slvi_alloc(source->env, "batches", nfaces, sizeof *batch_of, &batch_of)) ||
        (result = slvi_alloc(source->env, "batches", nfaces, sizeof *needs, &needs)) ||
        (result = slvi_alloc(source->env, "face order", nfaces, sizeof *order, &order)) ||
        (result = slvi_gl_face_order(source, order)))
        goto done;
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_htex_face face = slv_htex_get_face(htex, order[i]);
        needs[i].face = order[i];
        for (uint32_t k = 0; k < 4; k++)
            slvi_gl_add_pool(needs[i].pools, &needs[i].npools, layers->pool_of[face.edge[k]]);
    }
    most = source->params.batch_pools < SLV_GL_SQUARES_POOLS ? SLV_GL_SQUARES_POOLS
                                                             : source->params.batch_pools;
    if ((result = slvi_gl_group(source->env, batches, needs, nfaces, layers->npools, most, false,
                                batch_of)) ||
        (result = choose_chunks(source, htex, out)) ||
        (result = slvi_gl_batches_list(source->env, batches, order, nfaces, out->chunks, batch_of)))
        goto done;
    result = upload_squares(source, htex, batch_of, layers, out);
    if (!result && source->params.live)
        result = slvi_gl_marks_begin(source->env, (uint32_t)out->corners.first[out->chunks.count],
                                     &out->at_hand);
done:
    slvi_free(batch_of);
    slvi_free(order);
    slvi_free(needs);
    return result;
}

/* Sends the values at a face's corners that have not been sent yet. */
static void send_corners(const slv_gl_source *source, const slv_htex *htex, uint32_t f,
                         slv_gl_reach *reach) {
    slv_htex_face face = slv_htex_get_face(htex, f);
    float values[4 * (SLV_GL_LEVELS + 1)];
    uint32_t chunk = slv_gl_chunk_of(reach->chunks, f);
    for (uint32_t k = 0; k < CORNERS; k++) {
        uint64_t first = first_value(reach, f, k);
        uint32_t sent = reach->at_hand.count;
        slvi_gl_marks_add(&reach->at_hand, (uint32_t)first);
        if (reach->at_hand.count == sent)
            continue;
        uint32_t count = corner_values(source, htex, corner_of(&face, k), values);
        first -= reach->corners.first[chunk];
        source->gl->api.NamedBufferSubData(reach->parts[chunk].values,
                                           (GLintptr)(first * 4 * sizeof *values),
                                           (GLsizeiptr)(count * 4 * sizeof *values), values);
    }
}

slv_result slvi_gl_squares_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                   const void *made, const slv_gl_marks *faces,
                                   slv_gl_reach *reach) {
    const slv_htex *htex = slv_form_get_htex(pools->form, made);
    slvi_gl_marks_clear(&reach->at_hand);
    for (uint32_t i = 0; i < faces->count; i++) {
        uint32_t face = faces->listed[i];
        send_corners(source, htex, face, reach);
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour to[2];
            uint32_t n = slv_adjacency_neighbours(source->adjacency, (int32_t)face, e, to);
            while (n-- > 0)
                send_corners(source, htex, (uint32_t)to[n].face, reach);
        }
    }
    return SLV_OK;
}
