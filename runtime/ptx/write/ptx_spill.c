/* What a writer has packed and keeps until the end: in memory at first, then in a file. */
#include "ptx/write/ptx_write.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <unistd.h>

#define CHUNK (UINT64_C(1) << 20)

slv_result slvi_ptx_spill_begin(ptx_spill *spill, const slv_env *env, const char *path,
                                uint64_t budget) {
    spill->path = path;
    spill->descriptor = -1;
    pthread_mutex_init(&spill->lock, NULL);
    spill->budget = (budget + CHUNK - 1) / CHUNK * CHUNK;
    uint64_t most = slvi_env_or_default(env).max_bytes / 2 / CHUNK * CHUNK;
    if (spill->budget > most)
        spill->budget = most; /* the rest is for what cannot go into a file */
    return slvi_alloc(env, path, spill->budget / CHUNK, sizeof *spill->chunks, &spill->chunks);
}

/* Sets apart `size` bytes, and sees that there is memory or a file for them. */
static slv_result reserve(ptx_spill *spill, const slv_env *env, uint64_t size, uint64_t *position) {
    uint64_t first = spill->size, end = first + size;
    for (uint64_t i = first / CHUNK; i * CHUNK < end && i * CHUNK < spill->budget; i++) {
        if (spill->chunks[i])
            continue;
        slv_result result = slvi_alloc_plain(env, spill->path, CHUNK, 1, &spill->chunks[i]);
        if (result)
            return result;
    }
    if (end > spill->budget && spill->descriptor < 0) {
        slv_result result = slvi_beside_nameless(env, spill->path, spill->path, &spill->descriptor);
        if (result)
            return result;
    }
    *position = first;
    spill->size = end;
    return SLV_OK;
}

/* How much of a stretch is in one chunk; 0 if it is in the file. */
static uint64_t part_in_memory(const ptx_spill *spill, uint64_t position, uint64_t size) {
    uint64_t left = CHUNK - position % CHUNK;
    if (position >= spill->budget)
        return 0;
    return size < left ? size : left;
}

slv_result slvi_ptx_spill_append(ptx_spill *spill, const slv_env *env, const void *data,
                                 uint64_t size, uint64_t *position) {
    const uint8_t *from = data;
    pthread_mutex_lock(&spill->lock);
    slv_result result = reserve(spill, env, size, position);
    pthread_mutex_unlock(&spill->lock);
    if (result)
        return result;
    uint64_t at = *position;
    while (size) {
        uint64_t part = part_in_memory(spill, at, size);
        if (!part)
            return slvi_write_at(env, spill->path, spill->descriptor, from, size,
                                 at - spill->budget);
        memcpy(spill->chunks[at / CHUNK] + at % CHUNK, from, (size_t)part);
        at += part;
        from += part;
        size -= part;
    }
    return SLV_OK;
}

slv_result slvi_ptx_spill_read(const ptx_spill *spill, const slv_env *env, uint64_t position,
                               uint64_t size, void *out) {
    uint8_t *to = out;
    while (size) {
        uint64_t part = part_in_memory(spill, position, size);
        if (!part) {
            int reason = slvi_read_at(spill->descriptor, to, size, position - spill->budget);
            return reason ? slvi_fail(env, slvi_io_error(reason),
                                      "%s: what was kept beside it could not be read back: %s",
                                      spill->path, strerror(reason))
                          : SLV_OK;
        }
        memcpy(to, spill->chunks[position / CHUNK] + position % CHUNK, (size_t)part);
        position += part;
        to += part;
        size -= part;
    }
    return SLV_OK;
}

void slvi_ptx_spill_end(ptx_spill *spill) {
    if (!spill->path)
        return;
    for (uint64_t i = 0; spill->chunks && i < spill->budget / CHUNK; i++)
        slvi_free(spill->chunks[i]);
    slvi_free(spill->chunks);
    if (spill->descriptor >= 0)
        close(spill->descriptor);
    pthread_mutex_destroy(&spill->lock);
}
