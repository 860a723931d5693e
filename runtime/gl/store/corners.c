/* Values at vertices: which corners of which faces share them, and what they are. */
#include "gl/store/corners.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "gl/store/tables.h"

#include <selvage/border.h>

#include <string.h>

enum {
    SKIP_SHIFT = 27, /* in `where` */
    LEAST_CHUNK =
        5, /* log2 of faces, 8 bytes each: any driver lets a range of a buffer begin there */
    MOST_VALUES = SLV_GL_LEVELS + 1
};

/* As found for each corner, before values have numbers. */
enum { SHARE_HALF = 32, SHARE_ALONE = 64 };

struct list_job {
    const slv_gl_source *source;
    uint8_t *shares;
};

/* What values at vertices are of. */
static const slv_levels *levels_of(const slv_gl_source *source) {
    return source->even ? source->even : source->levels;
}

static slv_result find_shares(void *user, uint64_t first, uint64_t end) {
    const struct list_job *job = user;
    for (uint64_t i = first; i < end; i++) {
        slv_vertex_share share = slv_border_vertex_share(
            levels_of(job->source), job->source->adjacency, (uint32_t)(i / 4), i % 4);
        job->shares[i] = (uint8_t)((share.skip < 31 ? share.skip : 31) |
                                   (share.half ? SHARE_HALF : 0) | (share.alone ? SHARE_ALONE : 0));
    }
    return SLV_OK;
}

static uint32_t corner_id(slv_corner corner) {
    return 4 * (uint32_t)corner.face + corner.corner;
}

/* How many values of its list a face has levels for. */
static uint32_t values_of(const slv_gl_source *source, uint32_t face, uint32_t skip) {
    uint32_t levels = slv_levels_count(source->levels, face);
    return levels > skip ? levels - skip : 1;
}

/* Numbers the values of one ring: a list for those corners that are alike and in one part. */
static void number_ring(const struct list_job *job, slv_gl_chunks chunks, slv_ring ring,
                        slv_gl_corners *out) {
    for (uint32_t i = 0; i < ring.count; i++) {
        uint32_t id = corner_id(ring.corners[i]), chunk = slv_gl_chunk_of(chunks, id / 4);
        uint32_t share = job->shares[id], skip = share & 31, nvalues = 0;
        uint32_t end = share & SHARE_ALONE ? i + 1 : ring.count;
        if (out->where[id] != UINT32_MAX)
            continue;
        for (uint32_t k = i; k < end; k++) {
            uint32_t other = corner_id(ring.corners[k]), its = job->shares[other];
            if (((its ^ share) & SHARE_HALF) || slv_gl_chunk_of(chunks, other / 4) != chunk)
                continue;
            skip = its & 31;
            out->where[other] = (uint32_t)out->first[chunk + 1] | skip << SKIP_SHIFT;
            uint32_t count = values_of(job->source, other / 4, skip);
            nvalues = count > nvalues ? count : nvalues;
        }
        out->first[chunk + 1] += nvalues;
    }
}

/* Numbers all values; false if a part has more than fit. */
static bool number_values(const struct list_job *job, slv_gl_chunks chunks, slv_gl_corners *out) {
    uint32_t nfaces = slv_levels_get_desc(job->source->levels)->nfaces;
    uint64_t most = slvi_gl_parts_limit(job->source->gl) / (4 * sizeof(float));
    most = most < 1u << SKIP_SHIFT ? most : 1u << SKIP_SHIFT;
    memset(out->where, 0xff, (size_t)nfaces * 4 * sizeof *out->where);
    memset(out->first, 0, (chunks.count + 1) * sizeof *out->first);
    for (uint32_t face = 0; face < nfaces; face++) {
        for (unsigned corner = 0; corner < 4; corner++) {
            uint32_t position;
            slv_ring ring =
                slv_adjacency_ring(job->source->adjacency, (int32_t)face, corner, &position);
            if (position == 0)
                number_ring(job, chunks, ring, out);
            if (out->first[slv_gl_chunk_of(chunks, face) + 1] + MOST_VALUES > most)
                return false;
        }
    }
    for (uint32_t chunk = 0; chunk < chunks.count; chunk++) {
        if (out->first[chunk + 1] > most)
            return false;
        out->first[chunk + 1] += out->first[chunk];
    }
    return true;
}

slv_result slvi_gl_corners_list(const slv_gl_source *source, uint64_t row, slv_gl_chunks *chunks,
                                slv_gl_corners *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, log2 = 32;
    uint64_t ncorners = 4 * (uint64_t)nfaces, limit = slvi_gl_parts_limit(source->gl);
    struct list_job job = {.source = source};
    bool fits = false;
    slv_result result;
    if ((result = slvi_alloc(source->env, "corner table", ncorners, 1, &job.shares)) ||
        (result =
             slvi_alloc(source->env, "corner table", ncorners, sizeof *out->where, &out->where)) ||
        (result = slvi_parallel_for(source->env, ncorners, 4096, find_shares, &job)))
        goto done;
    while (log2 > LEAST_CHUNK && (log2 == 32 ? nfaces : UINT64_C(1) << log2) * row > limit)
        log2 = log2 == 32 ? 31 : log2 - 1;
    for (; !result && !fits && log2 >= LEAST_CHUNK; log2--) {
        *chunks = slv_gl_chunks_of(nfaces, log2);
        if (chunks->log2 < 32 || log2 == 32 || nfaces == 0) {
            slvi_free(out->first);
            out->first = NULL;
            result = slvi_alloc(source->env, "corner table", chunks->count + 1, sizeof *out->first,
                                &out->first);
            fits = !result && number_values(&job, *chunks, out);
        }
    }
    if (!result && !fits)
        result = slvi_fail(source->env, SLV_ERROR_LIMIT,
                           "the corner table does not fit the limit of %llu bytes",
                           (unsigned long long)limit);
done:
    slvi_free(job.shares);
    return result;
}

/* Whether two corners of a ring have one list. */
static bool same_list(const slv_gl_corners *corners, slv_gl_chunks chunks, uint32_t a, uint32_t b) {
    return (corners->where[a] << (32 - SKIP_SHIFT)) == (corners->where[b] << (32 - SKIP_SHIFT)) &&
           slv_gl_chunk_of(chunks, a / 4) == slv_gl_chunk_of(chunks, b / 4);
}

/* The list of a corner: a value from whichever face has a level for it. Returns how many.
 * `texel` has room for all channels. */
static uint32_t list_values(const slv_gl_source *source, slv_gl_chunks chunks,
                            const slv_gl_corners *corners, uint32_t id, float *texel,
                            float out[4 * MOST_VALUES]) {
    slv_ring ring = slv_adjacency_ring(source->adjacency, (int32_t)(id / 4), id % 4, NULL);
    uint32_t done = 0;
    for (uint32_t i = 0; i < ring.count; i++) {
        uint32_t other = corner_id(ring.corners[i]), face = other / 4;
        if (!same_list(corners, chunks, id, other))
            continue;
        uint32_t skip = corners->where[other] >> SKIP_SHIFT, count = values_of(source, face, skip);
        uint32_t last = slv_levels_count(source->levels, face) - 1;
        for (; done < count; done++) {
            uint32_t level = skip + done < last ? skip + done : last;
            slv_border_vertex(levels_of(source), source->adjacency, face, level, other % 4, texel);
            slvi_gl_table_value(&source->params, texel, out + 4 * done);
        }
    }
    return done;
}

/* The number of a corner's first value in its part. */
static uint32_t first_value(const slv_gl_corners *corners, uint32_t id) {
    return corners->where[id] & ((1u << SKIP_SHIFT) - 1);
}

struct fill_job {
    const slv_gl_source *source;
    slv_gl_chunks chunks;
    const slv_gl_corners *corners;
    float *values;
};

static slv_result fill(void *user, uint64_t first, uint64_t end) {
    const struct fill_job *job = user;
    const slv_gl_source *source = job->source;
    float *texel = NULL, values[4 * MOST_VALUES];
    slv_result result =
        slvi_alloc(&source->shared, "corner", slv_levels_get_desc(source->levels)->nchannels,
                   sizeof *texel, &texel);
    for (uint64_t i = first; !result && i < end; i++) {
        uint32_t id = (uint32_t)i, position, k = 0;
        slv_ring ring = slv_adjacency_ring(source->adjacency, (int32_t)(id / 4), id % 4, &position);
        while (k < position &&
               !same_list(job->corners, job->chunks, id, corner_id(ring.corners[k])))
            k++;
        if (k < position) /* that one does it */
            continue;
        uint32_t count = list_values(source, job->chunks, job->corners, id, texel, values);
        uint64_t part = job->corners->first[slv_gl_chunk_of(job->chunks, id / 4)];
        memcpy(job->values + 4 * (part + first_value(job->corners, id)), values,
               4 * count * sizeof *values);
    }
    slvi_free(texel);
    return result;
}

slv_result slvi_gl_corners_fill(const slv_gl_source *source, slv_gl_chunks chunks,
                                const slv_gl_corners *corners, float *values) {
    struct fill_job job = {source, chunks, corners, values};
    uint64_t ncorners = 4 * (uint64_t)slv_levels_get_desc(source->levels)->nfaces;
    return slvi_parallel_for(&source->shared, ncorners, 1024, fill, &job);
}

/* Whether an earlier corner of its ring, of one of these faces, has the same list: that one does
 * it. */
static bool is_done(const slv_gl_source *source, slv_gl_chunks chunks,
                    const slv_gl_corners *corners, const slv_gl_marks *faces, uint32_t id) {
    uint32_t position;
    slv_ring ring = slv_adjacency_ring(source->adjacency, (int32_t)(id / 4), id % 4, &position);
    for (uint32_t k = 0; k < position; k++)
        if (faces->is_listed[ring.corners[k].face] &&
            same_list(corners, chunks, id, corner_id(ring.corners[k])))
            return true;
    return false;
}

slv_result slvi_gl_corners_refresh(const slv_gl_source *source, slv_gl_chunks chunks,
                                   slv_gl_corners *corners, const slv_gl_marks *faces,
                                   const slv_gl_part *parts) {
    float values[4 * MOST_VALUES];
    size_t size = 4 * sizeof *values;
    slv_result result = SLV_OK;
    if (!corners->texel)
        result =
            slvi_alloc_plain(source->env, "corner", slv_levels_get_desc(source->levels)->nchannels,
                             sizeof *corners->texel, &corners->texel);
    for (uint32_t i = 0; !result && i < 4 * faces->count; i++) {
        uint32_t id = 4 * faces->listed[i / 4] + i % 4;
        if (is_done(source, chunks, corners, faces, id))
            continue;
        uint32_t nvalues = list_values(source, chunks, corners, id, corners->texel, values);
        source->gl->api.NamedBufferSubData(parts[slv_gl_chunk_of(chunks, id / 4)].values,
                                           (GLintptr)(first_value(corners, id) * size),
                                           (GLsizeiptr)(nvalues * size), values);
    }
    return result;
}

void slvi_gl_corners_free(slv_gl_corners *corners) {
    slvi_free(corners->texel);
    slvi_free(corners->where);
    slvi_free(corners->first);
    memset(corners, 0, sizeof *corners);
}
