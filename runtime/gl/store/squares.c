/* The batches and tables of lookups in squares of edges. */
#include "gl/store/squares.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/group.h"
#include "gl/store/tables.h"

#include <selvage/htex.h>

/* As the shader reads it; see slv_squares in shaders/strategy/htex.glsl. */
struct square_row {
    uint32_t squares[4], corners[4], centre, unused[3];
};

static uint32_t corner_bits(const slv_htex *htex, uint32_t corner) {
    uint32_t first, log2;
    slv_htex_get_corner(htex, corner, &first, &log2);
    return first | log2 << 27;
}

static void fill_square_row(const slv_gl_pools *layers, const slv_gl_batch_range *range,
                            const slv_htex *htex, uint32_t f, struct square_row *row) {
    slv_htex_face face = slv_htex_get_face(htex, f);
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t edge = face.edge[k];
        row->squares[k] = layers->layer_of[edge] |
                          slvi_gl_slot_of(range, layers->pool_of[edge]) << 16 |
                          slv_htex_log2(htex, edge) << 20 | (uint32_t)face.second[k] << 25 |
                          (uint32_t)face.part << 26;
        row->corners[k] = corner_bits(htex, face.start[k]);
    }
    row->centre = corner_bits(htex, face.centre);
}

static slv_result upload_squares(const slv_gl_source *source, const slv_htex *htex,
                                 const slv_gl_batches *batches, const uint32_t *batch_of,
                                 const slv_gl_pools *layers, slv_gl_reach *out) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    const slv_gl_texture_params *params = &source->params;
    uint64_t nvalues = slv_htex_value_count(htex);
    const float *from = slv_htex_values(htex);
    struct square_row *rows = NULL;
    float *values = NULL;
    slv_result result;
    if (nvalues >> 27)
        return slvi_fail(source->env, SLV_ERROR_LIMIT, "too many corners for 27-bit indices");
    if ((result = slvi_alloc(source->env, "table of squares", desc->nfaces, sizeof *rows, &rows)) ||
        (result = slvi_alloc(source->env, "corner table", nvalues, 4 * sizeof *values, &values)))
        goto done;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        fill_square_row(layers, &batches->ranges[batch_of[f]], htex, f, &rows[f]);
    for (uint64_t i = 0; i < nvalues; i++, from += desc->nchannels)
        slvi_gl_table_value(params, from, values + 4 * i);
    out->bytes = desc->nfaces * sizeof *rows + nvalues * 4 * sizeof *values;
    if (!(result = slvi_gl_table(source, "table of squares", rows, desc->nfaces * sizeof *rows,
                                 &out->ways)))
        result = slvi_gl_table(source, "corner table", values, nvalues * 4 * sizeof *values,
                               &out->values);
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
        (result = slvi_gl_batches_list(source->env, batches, order, nfaces, batch_of)))
        goto done;
    result = upload_squares(source, htex, batches, batch_of, layers, out);
    if (!result && source->params.live)
        result = slvi_gl_marks_begin(source->env, slv_htex_value_count(htex), &out->corners);
done:
    slvi_free(batch_of);
    slvi_free(order);
    slvi_free(needs);
    return result;
}

static void mark_corners(const slv_htex *htex, uint32_t f, slv_gl_marks *corners) {
    slv_htex_face face = slv_htex_get_face(htex, f);
    slvi_gl_marks_add(corners, face.centre);
    for (uint32_t k = 0; k < 4; k++)
        slvi_gl_marks_add(corners, face.start[k]);
}

/* All values of a corner, which follow one another. */
static void send_corner(const slv_gl_source *source, const slv_htex *htex, uint32_t corner,
                        GLuint table) {
    uint32_t first, log2, nchannels = slv_htex_get_desc(htex)->nchannels;
    float values[4 * (SLV_GL_LEVELS + 1)];
    slv_htex_get_corner(htex, corner, &first, &log2);
    for (uint32_t i = 0; i <= log2; i++)
        slvi_gl_table_value(&source->params,
                            slv_htex_values(htex) + (size_t)(first + i) * nchannels,
                            values + 4 * i);
    source->gl->api.NamedBufferSubData(table, (GLintptr)(first * 4 * sizeof *values),
                                       (GLsizeiptr)((log2 + 1) * 4 * sizeof *values), values);
}

slv_result slvi_gl_squares_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                   const void *made, const uint32_t *faces, uint32_t count,
                                   slv_gl_reach *reach) {
    const slv_htex *htex = slv_form_get_htex(pools->form, made);
    slv_gl_marks *corners = &reach->corners;
    slvi_gl_marks_clear(corners);
    for (uint32_t i = 0; i < count; i++) {
        mark_corners(htex, faces[i], corners);
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour to[2];
            uint32_t n = slv_adjacency_neighbours(source->adjacency, (int32_t)faces[i], e, to);
            while (n-- > 0)
                mark_corners(htex, (uint32_t)to[n].face, corners);
        }
    }
    for (uint32_t i = 0; i < corners->count; i++)
        send_corner(source, htex, corners->listed[i], reach->values);
    return SLV_OK;
}
