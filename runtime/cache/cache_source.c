/* A file of a cache as a source: rectangles out of blocks. */
#include "cache/cache_data.h"

#include "base/idle.h"
#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"

typedef struct idle_thread {
    slvi_idle_link link;
    cache_thread thread;
} idle_thread;

typedef struct cached_source {
    slv_cache *cache;
    slv_file_id file;
    char *name;
    slv_source_desc desc;
    slvi_idle idle;
} cached_source;

static const slv_source_fns cache_fns;

static slv_result describe(void *user, slv_source_desc *out) {
    const cached_source *source = user;
    *out = source->desc;
    return SLV_OK;
}

static slv_result take_thread(cached_source *source, idle_thread **out) {
    idle_thread *thread = slvi_idle_take(&source->idle);
    *out = thread;
    if (thread)
        return SLV_OK;
    slv_result result =
        slvi_alloc_aligned(&source->cache->env, source->name, 64, 1, sizeof *thread, &thread);
    if (!result)
        slvi_cache_thread_begin(source->cache, &thread->thread);
    *out = thread;
    return result;
}

/* Pins, and finds the tables; if there are none, it is not pinned. */
static slv_result pin_tables(const cached_source *source, cache_thread *thread,
                             cache_tables **out) {
    for (;;) {
        cache_pin(thread);
        *out = cache_find_tables(thread->view, source->file);
        if (*out)
            return SLV_OK;
        cache_unpin(thread);
        slv_result result = slvi_cache_load_tables(source->cache, source->file);
        if (result == SLV_ERROR_ARGUMENT)
            slvi_cache_no_such_file(source->cache, source->file);
        if (result)
            return result;
    }
}

static slv_result face(void *user, uint32_t index, slv_source_face *out) {
    cached_source *source = user;
    idle_thread *thread;
    cache_tables *tables;
    if (index >= source->desc.nfaces)
        return slvi_fail(&source->cache->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces",
                         source->name, (unsigned)index, (unsigned)source->desc.nfaces);
    slv_result result = take_thread(source, &thread);
    if (result)
        return result;
    if (!(result = pin_tables(source, &thread->thread, &tables))) {
        const cache_face *f = cache_find_face(tables, index);
        *out = (slv_source_face){.res = {f->res_u, f->res_v}, .flags = (uint8_t)cache_flags(f)};
        for (int e = 0; e < 4; e++) {
            out->adjacency.face[e] = f->adjacent[e];
            out->adjacency.edge[e] = (uint8_t)adjacent_edge(f, e);
        }
        cache_unpin(&thread->thread);
    }
    slvi_idle_give(&source->idle, thread);
    return result;
}

/* The texels of a block, as lookups find them. NULL with SLV_OK: the tables are gone. */
static const uint8_t *find_block(cache_thread *thread, cache_tables *tables, uint32_t index,
                                 slv_res res, uint32_t tile, slv_result *result) {
    cache_face *f = &tables->faces[index];
    bool direct = res.u == f->res_u && res.v == f->res_v && res.u + res.v <= tables->whole_log2;
    const uint8_t *texels =
        direct ? cache_find_full(thread->view, f)
               : cache_find_hashed(thread->view, tables, index, res.u, res.v, tile);
    *result = SLV_OK;
    return texels ? texels
                  : slvi_cache_load_block(thread, tables, index, res.u, res.v, tile, result);
}

/* The part of a rectangle that lies in a tile at (tile_x, tile_y). */
static void copy_part(const cache_tables *tables, slv_res tile, uint32_t tile_x, uint32_t tile_y,
                      const uint8_t *texels, slv_rect rect, uint8_t *out) {
    size_t pixel = tables->pixel_size;
    uint32_t x = rect.x > tile_x ? rect.x : tile_x, y = rect.y > tile_y ? rect.y : tile_y;
    uint32_t end_x = tile_x + (1u << tile.u), end_y = tile_y + (1u << tile.v);
    end_x = end_x < rect.x + rect.width ? end_x : rect.x + rect.width;
    end_y = end_y < rect.y + rect.height ? end_y : rect.y + rect.height;
    for (; y < end_y; y++)
        memcpy(out + ((size_t)(y - rect.y) * rect.width + (x - rect.x)) * pixel,
               texels + (((size_t)(y - tile_y) << tile.u) + (x - tile_x)) * pixel,
               (end_x - x) * pixel);
}

/* Pinned. *again: the tables went, and all is to be read anew. */
static slv_result read_pinned(cache_thread *thread, cache_tables *tables, uint32_t index,
                              slv_res res, slv_rect rect, uint8_t *out, bool *again) {
    cache_face *f = cache_find_face(tables, index);
    slv_result result = SLV_OK;
    if ((cache_flags(f) & SLV_FACE_CONSTANT) || res.u + res.v == 0) {
        const uint8_t *texel = tables->averages
                                   ? tables->averages + (size_t)index * tables->pixel_size
                                   : find_block(thread, tables, index, (slv_res){0, 0}, 0, &result);
        if (texel)
            slvi_fill_texels(out, texel, tables->pixel_size, (uint64_t)rect.width * rect.height);
        *again = !texel && !result;
        return result;
    }
    slv_res tile = slvi_cache_tile_res(tables, res.u, res.v);
    for (uint32_t y = rect.y >> tile.v; y <= (rect.y + rect.height - 1) >> tile.v; y++)
        for (uint32_t x = rect.x >> tile.u; x <= (rect.x + rect.width - 1) >> tile.u; x++) {
            uint32_t number = (y << (res.u - tile.u)) + x;
            const uint8_t *texels = find_block(thread, tables, index, res, number, &result);
            *again = !texels && !result;
            if (!texels)
                return result;
            copy_part(tables, tile, x << tile.u, y << tile.v, texels, rect, out);
        }
    return SLV_OK;
}

static slv_result read_rect(void *user, uint32_t index, slv_res res, slv_rect rect, void *out) {
    cached_source *source = user;
    const slv_source self = {&cache_fns, source};
    idle_thread *thread;
    slv_source_face found;
    bool again = true;
    slv_result result = slv_source_check(&source->cache->env, &self, index, res, rect, &found);
    if (result || (result = take_thread(source, &thread)))
        return result;
    while (again && !result) {
        cache_tables *tables;
        again = false;
        if ((result = pin_tables(source, &thread->thread, &tables)))
            break;
        result = read_pinned(&thread->thread, tables, index, res, rect, out, &again);
        cache_unpin(&thread->thread);
    }
    slvi_idle_give(&source->idle, thread);
    return result;
}

static uint64_t version(void *user) {
    const cached_source *source = user;
    pthread_mutex_lock(&source->cache->lock);
    cache_file *file = slvi_cache_find_file(source->cache, source->file);
    uint64_t now = file && file->changes ? slvi_changes_version(file->changes) : 1;
    pthread_mutex_unlock(&source->cache->lock);
    return now;
}

static slv_result changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    cached_source *source = user;
    slv_change changes[CHANGES_KEPT];
    slv_result result = SLV_OK;
    pthread_mutex_lock(&source->cache->lock);
    cache_file *file = slvi_cache_find_file(source->cache, source->file);
    uint32_t count =
        file && file->changes ? slvi_changes_since(file->changes, since, changes) : UINT32_MAX;
    pthread_mutex_unlock(&source->cache->lock);
    if (!file)
        return slvi_cache_no_such_file(source->cache, source->file);
    bool all = count == UINT32_MAX;
    for (uint32_t i = 0; !result && i < (all ? source->desc.nfaces : count); i++) {
        slv_source_face f;
        if (!all)
            result = visit(visitor, changes[i].face, changes[i].rect);
        else if (!(result = face(source, i, &f)))
            result = visit(visitor, i, (slv_rect){0, 0, 1u << f.res.u, 1u << f.res.v});
    }
    return result;
}

static void close_source(void *user) {
    cached_source *source = user;
    for (idle_thread *thread; (thread = slvi_idle_take(&source->idle));) {
        slvi_cache_thread_end(&thread->thread);
        slvi_free(thread);
    }
    slvi_idle_end(&source->idle);
    slvi_free(source->name);
    slvi_free(source);
}

static const slv_source_fns cache_fns = {.describe = describe,
                                         .face = face,
                                         .read = read_rect,
                                         .version = version,
                                         .changed = changed,
                                         .close = close_source};

/* Under the lock: what the source will say of itself. */
static slv_result fill(cached_source *source, cache_file *file) {
    slv_cache *cache = source->cache;
    const slv_ptx_info *info = &file->info;
    slv_source_desc desc = {.name = file->path};
    slv_result result = SLV_OK;
    if (!file->path)
        result = file->source.fns->describe(file->source.user, &desc);
    if (result ||
        (result = slvi_alloc(&cache->env, desc.name, strlen(desc.name) + 1, 1, &source->name)))
        return result;
    memcpy(source->name, desc.name, strlen(desc.name) + 1);
    source->desc = (slv_source_desc){.name = source->name,
                                     .nfaces = info->nfaces,
                                     .type = info->type,
                                     .nchannels = info->nchannels,
                                     .alpha_channel = info->alpha_channel,
                                     .triangles = info->mesh_type == SLV_PTX_TRIANGLE,
                                     .border_u = info->border_u,
                                     .border_v = info->border_v,
                                     .edge_filter = info->edge_filter};
    if (file->changes ||
        (result = slvi_alloc(&cache->env, source->name, 1, sizeof *file->changes, &file->changes)))
        return result;
    slvi_changes_begin(file->changes);
    return SLV_OK;
}

slv_result slv_cache_as_source(slv_cache *cache, slv_file_id id, slv_source *out) {
    cached_source *source = NULL;
    *out = (slv_source){0};
    slv_result result = slvi_alloc(&cache->env, "source", 1, sizeof *source, &source);
    if (result)
        return result;
    source->cache = cache;
    source->file = id;
    slvi_idle_begin(&source->idle);
    pthread_mutex_lock(&cache->lock);
    cache_file *file = slvi_cache_find_file(cache, id);
    result = file ? fill(source, file) : slvi_cache_no_such_file(cache, id);
    pthread_mutex_unlock(&cache->lock);
    if (result) {
        close_source(source);
        return result;
    }
    *out = (slv_source){&cache_fns, source};
    return SLV_OK;
}
