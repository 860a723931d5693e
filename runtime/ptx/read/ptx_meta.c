/* Metadata: typed arrays under a key. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdlib.h>

static size_t element_size(unsigned type) {
    static const uint8_t sizes[] = {1, 1, 2, 4, 4, 8};
    return sizes[type];
}

/* While a file is being opened nobody else looks at its entries. */
static void move(ptx_meta *to, const ptx_meta *from) {
    to->entry = from->entry;
    to->memory = from->memory;
    to->large = from->large;
    to->position = from->position;
    to->zipped = from->zipped;
    to->unpacked = from->unpacked;
    atomic_init(&to->loaded, atomic_load_explicit(&from->loaded, memory_order_relaxed));
}

/* Begun with an address, so that no file can be made of keys that all share a slot. */
static uint32_t hash_key(const slv_ptx *ptx, const char *key) {
    uint64_t hash = (uint64_t)(uintptr_t)ptx;
    for (; *key; key++) {
        hash = (hash ^ (uint8_t)*key) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 32;
    }
    return (uint32_t)hash;
}

/* The slot of a key: of an entry that has it, or the free one where it would be. */
static uint32_t *find_slot(const slv_ptx *ptx, const char *key) {
    uint32_t mask = ptx->meta_slot_count - 1, at = hash_key(ptx, key) & mask;
    while (ptx->meta_slots[at] && strcmp(ptx->meta[ptx->meta_slots[at] - 1].entry.key, key) != 0)
        at = (at + 1) & mask;
    return &ptx->meta_slots[at];
}

/* Room for one more entry, and for more than twice as many slots. */
static slv_result make_room(slv_ptx *ptx) {
    uint64_t capacity = ptx->meta_capacity ? 2 * (uint64_t)ptx->meta_capacity : 16;
    ptx_meta *grown = NULL;
    uint32_t *slots = NULL;
    if (ptx->info.nmeta < ptx->meta_capacity)
        return SLV_OK;
    slv_result result = slvi_alloc(&ptx->env, ptx->name, capacity, sizeof *grown, &grown);
    if (!result)
        result = slvi_alloc(&ptx->env, ptx->name, 4 * capacity, sizeof *slots, &slots);
    if (result) {
        slvi_free(grown);
        return result;
    }
    for (uint32_t i = 0; i < ptx->info.nmeta; i++)
        move(&grown[i], &ptx->meta[i]);
    slvi_free(ptx->meta);
    slvi_free(ptx->meta_slots);
    ptx->meta = grown;
    ptx->meta_slots = slots;
    ptx->meta_capacity = (uint32_t)capacity;
    ptx->meta_slot_count = (uint32_t)(4 * capacity);
    for (uint32_t i = 0; i < ptx->info.nmeta; i++)
        *find_slot(ptx, ptx->meta[i].entry.key) = i + 1;
    return SLV_OK;
}

/* Keeps an entry: with its values' memory, or, where `values` is NULL, without. The last of a key
 * is the one that counts, so that what it replaces is given back at once. */
static slv_result keep(slv_ptx *ptx, const uint8_t *key, unsigned key_size, unsigned type,
                       uint32_t size, void **values, ptx_meta **out) {
    void *memory = NULL;
    if (key_size < 1 || key[key_size - 1] != 0)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: metadata entry %u: its key does not end where it says", ptx->name,
                         ptx->info.nmeta);
    if (type > SLV_META_DOUBLE)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT, "%s: metadata %s: unknown type %u", ptx->name,
                         (const char *)key, type);
    slv_result result = make_room(ptx);
    if (result)
        return result;
    uint32_t *slot = find_slot(ptx, (const char *)key);
    ptx_meta *meta = &ptx->meta[*slot ? *slot - 1 : ptx->info.nmeta];
    /* one byte more, so that a string without its NUL gets one */
    uint64_t room = values ? (uint64_t)size + 1 : 0;
    if ((result = slvi_alloc(&ptx->env, ptx->name, room + key_size, 1, &memory)))
        return result;
    if (*slot)
        slvi_free(meta->memory);
    else
        *slot = ++ptx->info.nmeta;
    memset(meta, 0, sizeof *meta);
    meta->memory = memory;
    char *name = (char *)meta->memory + room;
    memcpy(name, key, key_size);
    meta->entry = (slv_ptx_meta){name, (slv_meta_type)type, size / (uint32_t)element_size(type),
                                 values ? meta->memory : NULL};
    atomic_init(&meta->loaded, values != NULL);
    if (values)
        *values = meta->memory;
    *out = meta;
    return SLV_OK;
}

static void count_string(slv_ptx_meta *entry, uint32_t size) {
    if (entry->type == SLV_META_STRING)
        entry->count = (uint32_t)strnlen(entry->values, size);
}

slv_result slvi_ptx_meta_parse(slv_ptx *ptx, const char *what, const uint8_t *bytes,
                               uint64_t size) {
    uint64_t at = 0;
    while (at < size) {
        unsigned key_size = bytes[at];
        uint64_t value = at + 1 + key_size + 5;
        if (value > size || ptx_get_u32(bytes + value - 4) > size - value)
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: the %s: entry %u, at byte %llu of %llu, goes beyond the end",
                             ptx->name, what, ptx->info.nmeta, (unsigned long long)at,
                             (unsigned long long)size);
        uint32_t value_size = ptx_get_u32(bytes + value - 4);
        void *values = NULL;
        ptx_meta *meta;
        slv_result result =
            keep(ptx, bytes + at + 1, key_size, bytes[value - 5], value_size, &values, &meta);
        if (result)
            return result;
        memcpy(values, bytes + value, value_size);
        count_string(&meta->entry, value_size);
        at = value + value_size;
    }
    return SLV_OK;
}

slv_result slvi_ptx_meta_read_large(slv_ptx *ptx, const uint8_t *headers, uint64_t size,
                                    uint64_t position, uint64_t end) {
    uint64_t at = 0;
    while (at < size) {
        unsigned key_size = headers[at];
        uint64_t next = at + 1 + key_size + 9;
        if (next > size)
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: the table of large metadata ends within entry %u", ptx->name,
                             ptx->info.nmeta);
        uint32_t value_size = ptx_get_u32(headers + next - 8);
        uint32_t zipped = ptx_get_u32(headers + next - 4);
        if (zipped > end - position)
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: large metadata entry %u: %u bytes at offset %llu go beyond its "
                             "section, which ends at %llu",
                             ptx->name, ptx->info.nmeta, zipped, (unsigned long long)position,
                             (unsigned long long)end);
        if (!slvi_ptx_zip_is_plausible(zipped, value_size))
            return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                             "%s: large metadata entry %u claims %u bytes packed into %u",
                             ptx->name, ptx->info.nmeta, value_size, zipped);
        ptx_meta *meta;
        slv_result result =
            keep(ptx, headers + at + 1, key_size, headers[next - 9], value_size, NULL, &meta);
        if (result)
            return result;
        meta->position = position;
        meta->zipped = zipped;
        meta->unpacked = value_size;
        position += zipped;
        at = next;
    }
    return SLV_OK;
}

struct keyed {
    const char *key;
    uint32_t index;
};

static int compare_keyed(const void *a, const void *b) {
    return strcmp(((const struct keyed *)a)->key, ((const struct keyed *)b)->key);
}

slv_result slvi_ptx_meta_finish(slv_ptx *ptx) {
    uint32_t count = ptx->info.nmeta;
    struct keyed *sorted = NULL;
    slvi_free(ptx->meta_slots);
    ptx->meta_slots = NULL;
    slv_result result = slvi_alloc(&ptx->env, ptx->name, count, sizeof *sorted, &sorted);
    if (!result)
        result =
            slvi_alloc(&ptx->env, ptx->name, count, sizeof *ptx->meta_by_key, &ptx->meta_by_key);
    for (uint32_t i = 0; !result && i < count; i++)
        sorted[i] = (struct keyed){ptx->meta[i].entry.key, i};
    if (!result && count)
        qsort(sorted, count, sizeof *sorted, compare_keyed);
    for (uint32_t i = 0; !result && i < count; i++)
        ptx->meta_by_key[i] = sorted[i].index;
    slvi_free(sorted);
    return result;
}

void slvi_ptx_meta_free(slv_ptx *ptx) {
    for (uint32_t i = 0; i < ptx->info.nmeta; i++) {
        ptx_meta *meta = &ptx->meta[i];
        slvi_free(meta->large);
        slvi_free(meta->memory);
    }
    slvi_free(ptx->meta);
    slvi_free(ptx->meta_slots);
    slvi_free(ptx->meta_by_key);
}

static slv_result load_large(const slv_ptx *ptx, ptx_meta *meta) {
    struct libdeflate_decompressor *inflater = libdeflate_alloc_decompressor();
    if (!inflater)
        return slvi_fail(&ptx->env, SLV_ERROR_MEMORY, "%s: no memory to unpack it", ptx->name);
    slv_result result = slvi_ptx_read_zip(ptx, inflater, "large metadata", meta->position,
                                          meta->zipped, meta->unpacked, &meta->large);
    libdeflate_free_decompressor(inflater);
    if (result)
        return result;
    meta->entry.values = meta->large;
    count_string(&meta->entry, meta->unpacked);
    return SLV_OK;
}

slv_result slvi_ptx_meta_salvage(slv_ptx *ptx) {
    uint32_t kept = 0;
    ptx_kept_line line;
    slv_env env = ptx->env;
    slv_result result = SLV_OK;
    ptx->env = slvi_ptx_keep_line(&env, &line);
    for (uint32_t i = 0; i < ptx->info.nmeta; i++) {
        ptx_meta *meta = &ptx->meta[i];
        slv_result one = result || meta->entry.values ? SLV_OK : load_large(ptx, meta);
        if (ptx_goes_on(ptx, one)) {
            slvi_logf(&env, SLV_LOG_WARNING, "%s; metadata %s is left out", line.text,
                      meta->entry.key);
            slvi_free(meta->memory);
            ptx->nleft_out++;
            continue;
        }
        result = result ? result : one;
        atomic_store_explicit(&meta->loaded, meta->entry.values != NULL, memory_order_relaxed);
        if (kept != i)
            move(&ptx->meta[kept], meta);
        kept++;
    }
    ptx->env = env;
    ptx->info.nmeta = kept;
    return result ? slvi_fail(&env, result, "%s", line.text) : SLV_OK;
}

slv_result slvi_ptx_meta_load(const slv_ptx *ptx, ptx_meta *meta, const slv_ptx_meta **out) {
    slv_result result = SLV_OK;
    if (!atomic_load_explicit(&meta->loaded, memory_order_acquire)) {
        pthread_mutex_lock(&ptx->tables->lock);
        if (!atomic_load_explicit(&meta->loaded, memory_order_relaxed) &&
            !(result = load_large(ptx, meta)))
            atomic_store_explicit(&meta->loaded, true, memory_order_release);
        pthread_mutex_unlock(&ptx->tables->lock);
    }
    *out = result ? NULL : &meta->entry;
    return result;
}

slv_result slv_ptx_load_meta(const slv_ptx *ptx, uint32_t index, const slv_ptx_meta **out) {
    *out = NULL;
    if (index >= ptx->info.nmeta)
        return slvi_fail(&ptx->env, SLV_ERROR_ARGUMENT, "%s: metadata %u: there are %u entries",
                         ptx->name, index, ptx->info.nmeta);
    return slvi_ptx_meta_load(ptx, &ptx->meta[index], out);
}

const slv_ptx_meta *slv_ptx_get_meta(const slv_ptx *ptx, uint32_t index) {
    const slv_ptx_meta *entry = NULL;
    if (index >= ptx->info.nmeta || slvi_ptx_meta_load(ptx, &ptx->meta[index], &entry))
        return NULL;
    return entry;
}

ptx_meta *slvi_ptx_meta_lookup(const slv_ptx *ptx, const char *key) {
    uint32_t low = 0, high = ptx->info.nmeta;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        ptx_meta *meta = &ptx->meta[ptx->meta_by_key[middle]];
        int order = strcmp(key, meta->entry.key);
        if (order == 0)
            return meta;
        if (order < 0)
            high = middle;
        else
            low = middle + 1;
    }
    return NULL;
}

const slv_ptx_meta *slv_ptx_find_meta(const slv_ptx *ptx, const char *key) {
    ptx_meta *meta = slvi_ptx_meta_lookup(ptx, key);
    const slv_ptx_meta *entry = NULL;
    if (!meta || slvi_ptx_meta_load(ptx, meta, &entry))
        return NULL;
    return entry;
}

uint64_t slvi_ptx_meta_bytes(const slv_ptx *ptx, bool all) {
    uint64_t bytes = (uint64_t)ptx->meta_capacity * sizeof *ptx->meta + 4ull * ptx->info.nmeta;
    for (uint32_t i = 0; i < ptx->info.nmeta; i++) {
        const ptx_meta *meta = &ptx->meta[i];
        bytes += strlen(meta->entry.key) + 1;
        if (!meta->position)
            bytes += (uint64_t)meta->entry.count * element_size(meta->entry.type) + 1;
        else if (all || atomic_load_explicit(&meta->loaded, memory_order_acquire))
            bytes += meta->unpacked + 1;
    }
    return bytes;
}
