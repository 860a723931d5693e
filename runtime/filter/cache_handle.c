/* File handles: no more than asked for, given up and taken again. */
#include "filter/cache_data.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Closes the handle that was not used for longest, if there are too many. */
static void make_room(slv_cache *cache) {
    while (cache->nhandles >= cache->max_handles) {
        cache_handle *oldest = NULL;
        for (cache_handle *h = cache->handles; h; h = h->next)
            if (h->descriptor >= 0 && !h->readers && (!oldest || h->turn < oldest->turn))
                oldest = h;
        if (!oldest)
            return;
        close(oldest->descriptor);
        oldest->descriptor = -1;
        cache->nhandles--;
    }
}

static slv_result open_handle(slv_cache *cache, cache_handle *h) {
    struct stat status;
    make_room(cache);
    int descriptor = open(h->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return slv_fail(&cache->env, SLV_ERROR_IO, "%s: %s", h->path, strerror(errno));
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(descriptor);
        return slv_fail(&cache->env, SLV_ERROR_IO, "%s: not a regular file", h->path);
    }
    cache_handle now = {.identity = {(uint64_t)status.st_dev, (uint64_t)status.st_ino,
                                     (uint64_t)status.st_size, status.st_mtim.tv_sec,
                                     status.st_mtim.tv_nsec}};
    if (h->opened_before) {
        if (memcmp(&now.identity, &h->identity, sizeof now.identity) != 0) {
            close(descriptor);
            return slv_fail(&cache->env, SLV_ERROR_MISMATCH,
                            "%s: was changed while it was in use: it must be invalidated", h->path);
        }
        cache->reopened++;
    }
    h->identity = now.identity;
    h->opened_before = true;
    h->descriptor = descriptor;
    cache->nhandles++;
    return SLV_OK;
}

static int handle_read(void *user, uint64_t offset, void *buffer, size_t size) {
    cache_handle *h = user;
    slv_cache *cache = h->cache;
    uint8_t *to = buffer;
    pthread_mutex_lock(&cache->handle_lock);
    slv_result result = h->descriptor >= 0 ? SLV_OK : open_handle(cache, h);
    if (!result) {
        h->readers++;
        h->turn = ++cache->handle_turn;
        cache->bytes_read += size;
    }
    pthread_mutex_unlock(&cache->handle_lock);
    if (result)
        return -1;
    while (size) {
        ssize_t got = pread(h->descriptor, to, size, (off_t)offset);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        to += got;
        offset += (uint64_t)got;
        size -= (size_t)got;
    }
    pthread_mutex_lock(&cache->handle_lock);
    h->readers--;
    pthread_mutex_unlock(&cache->handle_lock);
    return size ? -1 : 0;
}

static void handle_close(void *user) {
    cache_handle *h = user;
    slv_cache *cache = h->cache;
    pthread_mutex_lock(&cache->handle_lock);
    cache_handle **at = &cache->handles;
    while (*at != h)
        at = &(*at)->next;
    *at = h->next;
    if (h->descriptor >= 0) {
        close(h->descriptor);
        cache->nhandles--;
    }
    pthread_mutex_unlock(&cache->handle_lock);
    free(h->path);
    free(h);
}

slv_result cache_handle_create(slv_cache *cache, const char *path, slv_ptx_source *out) {
    cache_handle *h = NULL;
    slv_result result = slv_alloc(&cache->env, path, 1, sizeof *h, &h);
    if (!result)
        result = slv_alloc(&cache->env, path, strlen(path) + 1, 1, &h->path);
    if (result) {
        free(h);
        return result;
    }
    memcpy(h->path, path, strlen(path) + 1);
    h->cache = cache;
    h->descriptor = -1;
    pthread_mutex_lock(&cache->handle_lock);
    h->next = cache->handles;
    cache->handles = h;
    result = open_handle(cache, h);
    pthread_mutex_unlock(&cache->handle_lock);
    if (result) {
        handle_close(h);
        return result;
    }
    *out = (slv_ptx_source){handle_read, handle_close, h, h->identity.size};
    return SLV_OK;
}
