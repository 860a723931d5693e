/* A block of faces: how many, their values, and their texels in the file. */
#include "recipe/bake_data.h"
#include "source/holes.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

#define DEFAULT_MEMORY (UINT64_C(64) << 20)
/* Of work that a killed bake may lose, and a rank take at once: rays, or what takes as long. */
#define MOST_COST (UINT64_C(1) << 22)
enum { BAND_TEXELS = 1 << 14, BAND_COST = 1 << 18, LEAST_BLOCKS = 8 };

static slv_result bake_bands(void *user, uint64_t first, uint64_t end) {
    bake *b = user;
    float *values = NULL;
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        const bake_band *now = &b->bands[i];
        slv_rect rect = now->rect;
        uint64_t count = (uint64_t)rect.width * rect.height;
        if ((result = slvi_alloc_plain(&b->env, "bake: values", count,
                                       b->encoder.nchannels * sizeof *values, &values)) ||
            (result = slv_bake_evaluate(b->source, &b->env, now->face, b->res[now->face], rect,
                                        values, b->block.misses + now->at)))
            break;
        slvi_encoder_run(&b->encoder, values, count, b->block.texels + now->at * b->texel_size);
        result = slvi_steps_add(&b->steps, &b->env, "bake", count);
        slvi_free(values);
        values = NULL;
    }
    slvi_free(values);
    return result;
}

static slv_result fill_holes(const bake *b, slv_res res, const uint8_t *misses, uint8_t *texels) {
    uint64_t count = slvi_bake_texels_of(res);
    float *values = NULL;
    slv_result result = slvi_alloc_plain(&b->env, "bake: values", count,
                                         b->encoder.nchannels * sizeof *values, &values);
    if (result)
        return result;
    slvi_encoder_undo(&b->encoder, texels, count, values);
    if (!(result = slvi_holes_fill(&b->env, b->encoder.nchannels, 1u << res.u, 1u << res.v, misses,
                                   values)))
        slvi_encoder_run(&b->encoder, values, count, texels);
    slvi_free(values);
    return result;
}

static slv_ptx_face face_info(slv_res res, bool constant) {
    return (slv_ptx_face){
        .res = res,
        .flags = constant ? SLV_FACE_CONSTANT : 0,
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
}

static slv_result write_map(const bake *b, uint32_t face, const uint8_t *misses) {
    uint64_t count = slvi_bake_texels_of(b->res[face]);
    uint8_t *colors = NULL;
    slv_result result =
        slvi_alloc_plain(&b->env, "bake: miss map", count, BAKE_MAP_CHANNELS, &colors);
    for (uint64_t i = 0; i < count && !result; i++)
        memcpy(colors + i * BAKE_MAP_CHANNELS, b->map_colors[misses[i]], BAKE_MAP_CHANNELS);
    const slv_ptx_face info = face_info(b->res[face], false);
    if (!result)
        result = slv_ptx_writer_write_face(b->map, face, &info, colors);
    slvi_free(colors);
    return result;
}

static slv_result write_face(bake *b, uint32_t face) {
    const bake_block *block = &b->block;
    uint64_t at = block->offsets[face - block->first], count = slvi_bake_texels_of(b->res[face]);
    uint64_t misses[SLV_BAKE_MISSES] = {0};
    uint8_t *texels = block->texels + at * b->texel_size, *missed = block->misses + at;
    bool hole = slv_mesh_face_is_hole(b->mesh, (int32_t)face);
    slv_result result = SLV_OK;
    for (uint64_t i = 0; i < count; i++)
        misses[missed[i]]++;
    uint64_t hits = misses[SLV_BAKE_HIT];
    if (hits && hits < count && (result = fill_holes(b, b->res[face], missed, texels)))
        return result;
    bool constant =
        memcmp(texels, texels + b->texel_size, (size_t)(count - 1) * b->texel_size) == 0;
    const slv_ptx_face info = face_info(b->res[face], constant);
    result = slv_ptx_writer_write_face(b->writer, face, &info, texels);
    if (!result && b->map) {
        if (hole)
            memset(missed, SLV_BAKE_HIT, count);
        result = write_map(b, face, missed);
    }
    pthread_mutex_lock(&b->lock);
    b->report->constant_faces += constant;
    for (int i = 0; i < SLV_BAKE_MISSES; i++)
        b->report->misses[hole ? SLV_BAKE_HIT : i] += misses[i];
    pthread_mutex_unlock(&b->lock);
    return result;
}

static slv_result write_faces(void *user, uint64_t first, uint64_t end) {
    bake *b = user;
    slv_result result = SLV_OK;
    for (uint64_t face = first; face < end && !result; face++)
        result = write_face(b, b->block.first + (uint32_t)face);
    return result;
}

/* Cuts the faces of the block into bands. */
static slv_result cut(bake *b) {
    const bake_block *block = &b->block;
    uint32_t nfaces = block->end - block->first, count = 0, most = BAND_TEXELS;
    slv_result result = SLV_OK;
    if (b->source->cost > BAND_COST / BAND_TEXELS)
        most = b->source->cost < BAND_COST ? BAND_COST / b->source->cost : 1;
    for (int pass = 0; pass < 2 && !result; pass++) {
        count = 0;
        for (uint32_t k = 0; k < nfaces; k++) {
            slv_res res = b->res[block->first + k];
            uint32_t width = 1u << res.u, height = 1u << res.v;
            uint32_t columns = width < most ? width : most, rows = most >> res.u;
            rows = rows ? rows : 1;
            for (uint32_t y = 0; y < height; y += rows)
                for (uint32_t x = 0; x < width; x += columns, count++)
                    if (pass)
                        b->bands[count] =
                            (bake_band){block->first + k,
                                        {x, y, width - x < columns ? width - x : columns,
                                         height - y < rows ? height - y : rows},
                                        block->offsets[k] + ((uint64_t)y << res.u) + x};
        }
        if (!pass)
            result = slvi_alloc_plain(&b->env, "bake: bands", count, sizeof *b->bands, &b->bands);
    }
    b->nbands = count;
    return result;
}

void slvi_bake_end_block(bake *b) {
    slvi_free(b->block.offsets);
    slvi_free(b->block.texels);
    slvi_free(b->block.misses);
    slvi_free(b->bands);
    b->block = (bake_block){0};
    b->bands = NULL;
}

slv_result slvi_bake_begin_block(bake *b, uint32_t first, uint32_t end) {
    uint32_t nfaces = end - first;
    slvi_bake_end_block(b);
    bake_block *block = &b->block;
    slv_result result =
        slvi_alloc(&b->env, "bake: block", nfaces + 1, sizeof *block->offsets, &block->offsets);
    if (result)
        return result;
    block->first = first;
    block->end = end;
    for (uint32_t k = 0; k < nfaces; k++)
        block->offsets[k + 1] = block->offsets[k] + slvi_bake_texels_of(b->res[first + k]);
    if (!(result = slvi_alloc_plain(&b->env, "bake: texels", block->offsets[nfaces], b->texel_size,
                                    &block->texels)))
        result =
            slvi_alloc_plain(&b->env, "bake: misses", block->offsets[nfaces], 1, &block->misses);
    return result;
}

slv_result slvi_bake_evaluate_block(bake *b) {
    slv_result result = cut(b);
    return result ? result : slvi_parallel_for(&b->env, b->nbands, 1, bake_bands, b);
}

slv_result slvi_bake_write_block(bake *b) {
    return slvi_parallel_for(&b->env, b->block.end - b->block.first, 1, write_faces, b);
}

bool slvi_bake_next_block(bake *b, uint32_t *first, uint32_t *end) {
    uint64_t most = b->job->memory ? b->job->memory : DEFAULT_MEMORY, bytes = 0, cost = 0;
    uint64_t ranks = b->job->team ? b->job->team->count : 1;
    uint64_t most_cost = b->total * (1 + (uint64_t)b->source->cost) / (LEAST_BLOCKS * ranks) + 1;
    if (ranks == 1 || most_cost > MOST_COST)
        most_cost = MOST_COST;
    while (b->next < b->source->nfaces && b->done[b->next])
        b->next++;
    *first = b->next;
    for (*end = *first; *end < b->source->nfaces && !b->done[*end]; ++*end) {
        uint64_t texels = slvi_bake_texels_of(b->res[*end]);
        bytes += texels * (b->texel_size + 1) + sizeof *b->block.offsets;
        cost += texels * (1 + (uint64_t)b->source->cost);
        if (*end > *first && (bytes > most || cost > most_cost))
            break;
        b->done[*end] = 1;
    }
    return *end > *first;
}
