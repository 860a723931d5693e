#include "gl/store/store.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/edge_aligned.h>

#include <string.h>

#define ARRAY_BYTES (UINT64_C(512) << 20) /* software drivers refuse textures above 1 GiB */

slv_result slvi_gl_buffer(const slv_gl *gl, const slv_env *env, const char *what, const void *data,
                          uint64_t bytes, GLuint *out) {
    const slv_gl_api *api = &gl->api;
    api->CreateBuffers(1, out);
    api->NamedBufferStorage(*out, (GLsizeiptr)(bytes ? bytes : 16), bytes ? data : NULL, 0);
    return slvi_gl_check(gl, env, what);
}

slv_result slvi_gl_table(const slv_gl_source *source, const char *what, const void *data,
                         uint64_t bytes, GLuint *out) {
    uint64_t most = source->gl->max_storage;
    if (bytes > most)
        return slvi_fail(source->env, SLV_ERROR_LIMIT,
                         "the %s takes %llu bytes, the driver's limit is %llu", what,
                         (unsigned long long)bytes, (unsigned long long)most);
    return slvi_gl_buffer(source->gl, source->env, what, data, bytes, out);
}

/* Faces in breadth-first order over the adjacency, so that faces which meet get layers close
 * together. */
static slv_result neighbourly_order(const slv_gl_source *source, uint32_t nfaces, uint32_t *order) {
    const slv_face_adjacency *adjacency = slv_adjacency_faces(source->adjacency);
    bool *seen = NULL;
    slv_result result = slvi_alloc(source->env, "face order", nfaces, sizeof *seen, &seen);
    if (result)
        return result;
    uint32_t head = 0, tail = 0;
    for (uint32_t start = 0; start < nfaces; start++) {
        if (seen[start])
            continue;
        seen[start] = true;
        order[tail++] = start;
        for (; head < tail; head++) {
            for (unsigned e = 0; e < 4; e++) {
                int32_t next = adjacency[order[head]].face[e];
                if (next >= 0 && !seen[next]) {
                    seen[next] = true;
                    order[tail++] = (uint32_t)next;
                }
            }
        }
    }
    slvi_free(seen);
    return SLV_OK;
}

struct widen_job {
    const slv_gl_source *source;
    slv_env env; /* logs one at a time */
    uint8_t *wide;
};

/* Only the innermost border can leave the range of a type, so one texel of border is
 * enough to know. */
static slv_result find_wide(void *user, uint64_t first, uint64_t end) {
    struct widen_job *job = user;
    const slv_texture_desc *desc = slv_levels_get_desc(job->source->levels);
    float *scratch = NULL;
    slv_result result = SLV_OK;
    size_t capacity = 0;
    for (uint64_t face = first; !result && face < end; face++) {
        uint32_t nlevels = slv_levels_count(job->source->levels, (uint32_t)face);
        for (uint32_t level = 0; !result && !job->wide[face] && level < nlevels; level++) {
            slv_res res = slv_res_level(desc->res[face], level);
            size_t needed =
                (((size_t)1 << res.u) + 2) * (((size_t)1 << res.v) + 2) * desc->nchannels;
            bool wide = false;
            if (needed > capacity) {
                slvi_free(scratch);
                capacity = needed;
                result = slvi_alloc(&job->env, "border", needed, sizeof *scratch, &scratch);
            }
            if (!result)
                result = slv_border_build(job->source->levels, job->source->adjacency,
                                          (uint32_t)face, level, 1, 1, scratch, &wide);
            job->wide[face] |= wide;
        }
    }
    slvi_free(scratch);
    return result;
}

static uint32_t class_of(slv_res res, bool wide) {
    return (uint32_t)wide << 10 | (uint32_t)res.u << 5 | (uint32_t)res.v;
}

#define NCLASSES (1u << 11)

static uint64_t layer_bytes(const slv_gl_pool *pool, const slv_gl_format *format, bool packed) {
    uint64_t texels = 0, bytes = 0;
    if (format->block) {
        for (uint32_t level = 0; level < (packed ? 1 : pool->nlevels); level++) {
            slv_res r = slv_res_level(pool->res, level);
            bytes += slv_gl_compressed_bytes(format->block, packed ? pool->width : 1u << r.u,
                                             packed ? pool->height : 1u << r.v);
        }
        return bytes;
    }
    if (packed)
        return (uint64_t)pool->width * pool->height * format->texel_bytes;
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_res r = slv_res_level(pool->res, level);
        texels += (uint64_t)1 << (r.u + r.v);
    }
    return texels * format->texel_bytes;
}

/* What gets layers: the faces, or the squares of edges. */
struct items {
    uint32_t count;
    slv_res *res;
    uint8_t *wide;
    uint32_t *order; /* those close together that meet */
    uint32_t *faces; /* the faces in such an order, where items are edges */
};

static void free_items(struct items *items) {
    slvi_free(items->res);
    slvi_free(items->wide);
    slvi_free(items->order);
    slvi_free(items->faces);
}

static slv_result list_faces(const slv_gl_source *source, struct items *out) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    slv_result result;
    out->count = desc->nfaces;
    if ((result = slvi_alloc(source->env, "faces", out->count, sizeof *out->res, &out->res)) ||
        (result = slvi_alloc(source->env, "faces", out->count, 1, &out->wide)) ||
        (result = slvi_alloc(source->env, "faces", out->count, sizeof *out->order, &out->order)))
        return result;
    memcpy(out->res, desc->res, out->count * sizeof *out->res);
    return neighbourly_order(source, out->count, out->order);
}

/* Edges in the order in which the faces first need them. */
static slv_result list_squares(const slv_gl_source *source, const slv_htex *htex,
                               struct items *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, listed = 0;
    bool *seen = NULL;
    slv_result result;
    out->count = slv_htex_edge_count(htex);
    if ((result = slvi_alloc(source->env, "edges", out->count, sizeof *out->res, &out->res)) ||
        (result = slvi_alloc(source->env, "edges", out->count, 1, &out->wide)) ||
        (result = slvi_alloc(source->env, "edges", out->count, sizeof *out->order, &out->order)) ||
        (result = slvi_alloc(source->env, "edges", out->count, sizeof *seen, &seen)) ||
        (result = slvi_alloc(source->env, "face order", nfaces, sizeof *out->faces, &out->faces)) ||
        (result = neighbourly_order(source, nfaces, out->faces)))
        goto done;
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_htex_face face = slv_htex_get_face(htex, out->faces[i]);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t edge = face.edge[k];
            if (seen[edge])
                continue;
            seen[edge] = true;
            out->res[edge].u = out->res[edge].v = (int8_t)slv_htex_log2(htex, edge);
            out->order[listed++] = edge;
        }
    }
done:
    slvi_free(seen);
    return result;
}

/* Sorts them into classes, keeping their order, and cuts the classes into pools. */
static slv_result assign_pools(const slv_gl_source *source, const struct items *items,
                               slv_gl_store *store) {
    const slv_env *env = source->env;
    slv_result result = SLV_OK;
    uint32_t count_all = items->count, npools = 0, *start = NULL;
    slv_gl_pool *templates = NULL;
    bool packed = slv_gl_is_packed(store->layout);
    if ((result = slvi_alloc(env, "size classes", NCLASSES + 1, sizeof *start, &start)) ||
        (result = slvi_alloc(env, "size classes", NCLASSES, sizeof *templates, &templates)) ||
        (result = slvi_alloc(env, "layers", count_all, sizeof *store->order, &store->order)) ||
        (result = slvi_alloc(env, "pools", count_all, sizeof *store->pool_of, &store->pool_of)) ||
        (result = slvi_alloc(env, "layers", count_all, sizeof *store->layer_of, &store->layer_of)))
        goto done;
    for (uint32_t i = 0; i < count_all; i++)
        start[class_of(items->res[i], items->wide[i]) + 1]++;
    for (uint32_t c = 0; c < NCLASSES; c++) {
        slv_gl_pool *pool = &templates[c];
        uint32_t count = start[c + 1];
        if (count) {
            pool->res = (slv_res){(int8_t)(c >> 5 & 31), (int8_t)(c & 31)};
            pool->wide = c >> 10;
            const slv_gl_format *format = pool->wide ? &store->wide_format : &store->format;
            if (packed) {
                slvi_gl_pack_levels(pool->res, store->layout, source->params.border, format->block,
                                    pool);
            } else {
                pool->width = 1u << pool->res.u;
                pool->height = 1u << pool->res.v;
                pool->nlevels = slv_res_level_count(pool->res);
            }
            uint32_t limit = source->gl->info.max_texture_size;
            if (pool->width > limit || pool->height > limit) {
                result = slvi_fail(
                    env, SLV_ERROR_LIMIT,
                    "%s of %u x %u texels needs a texture of %u x %u, the driver's limit is %u",
                    store->layout == SLV_GL_HALF_EDGE ? "an edge's square" : "a face",
                    1u << pool->res.u, 1u << pool->res.v, pool->width, pool->height, limit);
                goto done;
            }
            uint64_t per_array = ARRAY_BYTES / layer_bytes(pool, format, packed);
            per_array =
                per_array < source->params.pool_layers ? per_array : source->params.pool_layers;
            pool->nlayers = per_array ? (uint32_t)per_array : 1;
            npools += (count + pool->nlayers - 1) / pool->nlayers;
        }
        start[c + 1] += start[c];
    }
    if (npools > 0xffff) {
        result = slvi_fail(env, SLV_ERROR_LIMIT, "%u array textures are needed, the limit is 65535",
                           npools);
        goto done;
    }
    if ((result = slvi_alloc(env, "pools", npools, sizeof *store->pools, &store->pools)))
        goto done;
    for (uint32_t i = 0; i < count_all; i++) {
        uint32_t item = items->order[i];
        store->order[start[class_of(items->res[item], items->wide[item])]++] = item;
    }
    /* start[c] is now where class c ends */
    for (uint32_t c = 0; c < NCLASSES; c++) {
        uint32_t end = start[c], first = c ? start[c - 1] : 0;
        uint32_t most = templates[c].nlayers;
        for (; first < end; first += most) {
            slv_gl_pool *pool = &store->pools[store->npools];
            *pool = templates[c];
            pool->faces = store->order + first;
            pool->nlayers = end - first < most ? end - first : most;
            for (uint32_t layer = 0; layer < pool->nlayers; layer++) {
                store->pool_of[pool->faces[layer]] = store->npools;
                store->layer_of[pool->faces[layer]] = layer;
            }
            store->npools++;
        }
    }
done:
    slvi_free(start);
    slvi_free(templates);
    return result;
}

/* One layer that is 1 in every texel of every level, with the size and levels of the pool that it
 * normalises. */
static slv_result make_coverage(const slv_gl_source *source, slv_gl_pool *pool) {
    const slv_gl_api *api = &source->gl->api;
    unsigned char *ones = NULL;
    slv_result result =
        slvi_alloc(source->env, "coverage", (uint64_t)pool->width * pool->height, 1, &ones);
    if (result)
        return result;
    memset(ones, 255, (size_t)pool->width * pool->height);
    api->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &pool->coverage);
    api->TextureStorage3D(pool->coverage, (GLsizei)pool->nlevels, GL_R8, (GLsizei)pool->width,
                          (GLsizei)pool->height, 1);
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_res r = slv_res_level(pool->res, level);
        api->TextureSubImage3D(pool->coverage, (GLint)level, 0, 0, 0, 1 << r.u, 1 << r.v, 1, GL_RED,
                               GL_UNSIGNED_BYTE, ones);
    }
    slvi_free(ones);
    return SLV_OK;
}

static uint64_t coverage_bytes(const slv_gl_pool *pool) {
    uint64_t texels = 0;
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_res r = slv_res_level(pool->res, level);
        texels += (uint64_t)1 << (r.u + r.v);
    }
    return texels;
}

static slv_result upload_pool(const slv_gl_source *source, const slv_env *env, slv_gl_store *store,
                              const slv_gl_forms *forms, slv_gl_pool *pool, unsigned char **staging,
                              uint64_t *capacity) {
    const slv_gl_api *api = &source->gl->api;
    const slv_gl_format *format = pool->wide ? &store->wide_format : &store->format;
    bool packed = slv_gl_is_packed(store->layout);
    uint32_t nlevels = packed ? 1 : pool->nlevels;
    slv_result result = SLV_OK;
    api->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &pool->texture);
    api->TextureStorage3D(pool->texture, (GLsizei)nlevels, format->internal, (GLsizei)pool->width,
                          (GLsizei)pool->height, (GLsizei)pool->nlayers);
    api->TextureParameteriv(pool->texture, GL_TEXTURE_SWIZZLE_RGBA, format->swizzle);
    if ((result = slvi_gl_check(source->gl, source->env, "array texture")))
        return result;
    store->bytes += layer_bytes(pool, format, packed) * pool->nlayers;
    for (uint32_t level = 0; !result && level < nlevels; level++)
        result = slvi_gl_upload_level(source, env, store, forms, pool, level, staging, capacity);
    if (!result && store->layout == SLV_GL_BARE && format->nsource == 4) {
        result = make_coverage(source, pool);
        store->coverage_bytes += coverage_bytes(pool);
    }
    return result ? result : slvi_gl_check(source->gl, source->env, "texture upload");
}

/* The share of the store's steps that a pool stands for; `*layers` are those of pools before it. */
static slv_result count_pool(const slv_gl_source *source, const slv_gl_pool *pool, uint32_t nitems,
                             uint64_t *layers) {
    uint64_t nfaces = slv_levels_get_desc(source->levels)->nfaces, before = *layers;
    *layers += pool->nlayers;
    return slvi_steps_add(source->steps, source->env, "GL texture",
                          nfaces * *layers / nitems - nfaces * before / nitems);
}

static slv_result upload_tables(const slv_gl_source *source, slv_gl_store *store) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    const slv_env *env = source->env;
    uint32_t *rows = NULL;
    float *rects = NULL;
    slv_result result = slvi_alloc(env, "face table", desc->nfaces, 8, &rows);
    if (result)
        goto done;
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        if (store->layout != SLV_GL_HALF_EDGE)
            rows[2 * f] = store->pool_of[f] | store->layer_of[f] << 16;
        rows[2 * f + 1] = (uint32_t)desc->res[f].u | (uint32_t)desc->res[f].v << 8;
    }
    store->bytes += (uint64_t)desc->nfaces * 8;
    if ((result = slvi_gl_table(source, "face table", rows, (uint64_t)desc->nfaces * 8,
                                &store->table)) ||
        !slv_gl_is_packed(store->layout))
        goto done;
    uint64_t bytes = (uint64_t)store->npools * SLV_GL_LEVELS * 4 * sizeof *rects;
    if ((result = slvi_alloc(env, "level table", bytes, 1, &rects)))
        goto done;
    float first_sample = store->layout == SLV_GL_EDGE_ALIGNED ? 0.5f : 0.0f;
    for (uint32_t p = 0; p < store->npools; p++) {
        const slv_gl_pool *pool = &store->pools[p];
        for (uint32_t level = 0; level < pool->nlevels; level++) {
            const slv_gl_rect *rect = &pool->rects[level];
            float *row = rects + (p * SLV_GL_LEVELS + level) * 4;
            row[0] = (float)rect->width / (float)pool->width;
            row[1] = (float)rect->height / (float)pool->height;
            row[2] = ((float)(rect->x + rect->bu) + first_sample) / (float)pool->width;
            row[3] = ((float)(rect->y + rect->bv) + first_sample) / (float)pool->height;
        }
    }
    store->bytes += bytes;
    result = slvi_gl_table(source, "level table", rects, bytes, &store->rects);
done:
    slvi_free(rows);
    slvi_free(rects);
    return result;
}

static slv_result build_forms(const slv_gl_source *source, const slv_env *env, slv_gl_layout layout,
                              slv_gl_forms *out) {
    if (layout == SLV_GL_EDGE_ALIGNED)
        return slv_edge_aligned_create(env, source->levels, source->adjacency, &out->aligned);
    if (layout == SLV_GL_HALF_EDGE)
        return slv_htex_create(env, source->levels, source->adjacency, &out->htex);
    return SLV_OK;
}

static slv_result widen(const slv_gl_source *source, const slv_env *env, bool blocks,
                        struct items *items, slv_gl_store *store) {
    struct widen_job job = {.source = source, .env = *env, .wide = items->wide};
    slv_result result = slvi_parallel_for(env, items->count, 64, find_wide, &job);
    for (uint32_t f = 0; f < items->count; f++)
        *(blocks ? &store->nclipped : &store->nwide) += items->wide[f];
    if (blocks)
        memset(items->wide, 0, items->count);
    return result;
}

slv_result slvi_gl_store_build(const slv_gl_source *source, slv_gl_layout layout, slv_gl_store *out,
                               slv_gl_batches *batches) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    uint32_t first = source->params.first_channel, nchannels = source->params.nchannels;
    bool coverage = layout == SLV_GL_BARE;
    unsigned char *staging = NULL;
    uint64_t capacity = 0, layers = 0;
    struct items items = {0};
    slv_gl_store store = {.layout = layout};
    slv_gl_forms forms = {0};
    slv_parallel_log *log = NULL;
    slv_env env;
    slv_result result = SLV_OK;
    store.format = slvi_gl_format_for(desc->type, first, nchannels, coverage);
    store.wide_format = slvi_gl_format_for(
        desc->type == SLV_TYPE_U8 ? SLV_TYPE_HALF : SLV_TYPE_FLOAT, first, nchannels, coverage);
    bool blocks = source->params.compression == SLV_GL_COMPRESSION_BLOCKS;
    if (blocks && (result = slvi_gl_format_compress(source->gl, source->env, &store.format))) {
        *out = store;
        return result;
    }
    if ((result = slvi_parallel_env_begin(source->env, &log, &env)) ||
        (result = build_forms(source, &env, layout, &forms)) ||
        (result =
             forms.htex ? list_squares(source, forms.htex, &items) : list_faces(source, &items)))
        goto done;
    if (layout == SLV_GL_BORDERED && desc->type != SLV_TYPE_FLOAT &&
        (result = widen(source, &env, blocks, &items, &store)))
        goto done;
    if ((result = assign_pools(source, &items, &store)))
        goto done;
    for (uint32_t p = 0; !result && p < store.npools; p++)
        if (!(result =
                  upload_pool(source, &env, &store, &forms, &store.pools[p], &staging, &capacity)))
            result = count_pool(source, &store.pools[p], items.count, &layers);
    if (!result)
        result = upload_tables(source, &store);
    if (!result)
        result = forms.htex
                     ? slvi_gl_batches_of_squares(source, &store, forms.htex, items.faces, batches)
                     : slvi_gl_batches_by_pool(source, &store, batches);
done:
    slv_edge_aligned_destroy(forms.aligned);
    slv_htex_destroy(forms.htex);
    slvi_parallel_env_end(log);
    free_items(&items);
    slvi_free(staging);
    if (result)
        slvi_gl_store_free(source->gl, &store);
    *out = store;
    return result;
}

void slvi_gl_store_free(const slv_gl *gl, slv_gl_store *store) {
    for (uint32_t p = 0; p < store->npools; p++) {
        gl->api.DeleteTextures(1, &store->pools[p].texture);
        gl->api.DeleteTextures(1, &store->pools[p].coverage);
    }
    gl->api.DeleteBuffers(1, &store->table);
    gl->api.DeleteBuffers(1, &store->rects);
    gl->api.DeleteBuffers(1, &store->squares);
    gl->api.DeleteBuffers(1, &store->corners);
    slvi_free(store->pools);
    slvi_free(store->order);
    slvi_free(store->pool_of);
    slvi_free(store->layer_of);
    memset(store, 0, sizeof *store);
}
