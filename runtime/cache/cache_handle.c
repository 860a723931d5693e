/* File handles: no more than asked for, given up and taken again. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHANGED "%s: was changed while it was in use: it must be invalidated"

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

static bool identify(int descriptor, cache_identity *out) {
    struct stat status;
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
        return false;
    *out =
        (cache_identity){(uint64_t)status.st_dev, (uint64_t)status.st_ino, (uint64_t)status.st_size,
                         status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
    return true;
}

static bool is_same(const cache_identity *a, const cache_identity *b) {
    return a->device == b->device && a->inode == b->inode && a->size == b->size &&
           a->seconds == b->seconds && a->nanoseconds == b->nanoseconds;
}

/* Under the handles' lock. Says why not in the handle. */
static bool open_handle(slv_cache *cache, cache_handle *h) {
    cache_identity now;
    make_room(cache);
    int descriptor = open(h->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        atomic_store(&h->error, errno);
        return false;
    }
    if (!identify(descriptor, &now) || (h->opened_before && !is_same(&now, &h->identity))) {
        close(descriptor);
        atomic_store(&h->changed, h->opened_before);
        atomic_store(&h->error, EINVAL);
        return false;
    }
    cache->reopened += h->opened_before;
    h->identity = now;
    h->opened_before = true;
    h->descriptor = descriptor;
    cache->nhandles++;
    return true;
}

static int handle_read(void *user, uint64_t offset, void *buffer, size_t size) {
    cache_handle *h = user;
    slv_cache *cache = h->cache;
    uint8_t *to = buffer;
    cache_identity now;
    int error = 0;
    pthread_mutex_lock(&cache->handle_lock);
    bool opened = h->descriptor >= 0 || open_handle(cache, h);
    if (opened) {
        h->readers++;
        h->turn = ++cache->handle_turn;
        cache->bytes_read += size;
    }
    pthread_mutex_unlock(&cache->handle_lock);
    if (!opened)
        return -1;
    while (size) {
        ssize_t got = pread(h->descriptor, to, size, (off_t)offset);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0) {
            error = got < 0 ? errno : ENODATA;
            break;
        }
        to += got;
        offset += (uint64_t)got;
        size -= (size_t)got;
    }
    /* bytes that somebody wrote over those of the file are none of its */
    if (!identify(h->descriptor, &now) || !is_same(&now, &h->identity)) {
        atomic_store(&h->changed, true);
        error = EINVAL;
    }
    atomic_store_explicit(&h->error, error, memory_order_relaxed);
    pthread_mutex_lock(&cache->handle_lock);
    h->readers--;
    pthread_mutex_unlock(&cache->handle_lock);
    return error ? -1 : 0;
}

void slvi_cache_handle_release(cache_handle *h) {
    slv_cache *cache = h->cache;
    pthread_mutex_lock(&cache->handle_lock);
    if (--h->owners) {
        pthread_mutex_unlock(&cache->handle_lock);
        return;
    }
    cache_handle **at = &cache->handles;
    while (*at != h)
        at = &(*at)->next;
    *at = h->next;
    if (h->descriptor >= 0) {
        close(h->descriptor);
        cache->nhandles--;
    }
    pthread_mutex_unlock(&cache->handle_lock);
    slvi_free(h->path);
    slvi_free(h);
}

static void handle_close(void *user) {
    slvi_cache_handle_release(user);
}

slv_result slvi_cache_handle_create(slv_cache *cache, const char *path,
                                    const cache_identity *identity, slv_stream_in *source,
                                    cache_handle **out) {
    cache_handle *h = NULL;
    slv_result result = slvi_alloc(&cache->env, path, 1, sizeof *h, &h);
    if (!result)
        result = slvi_alloc(&cache->env, path, strlen(path) + 1, 1, &h->path);
    if (result) {
        slvi_free(h);
        return result;
    }
    memcpy(h->path, path, strlen(path) + 1);
    h->cache = cache;
    h->descriptor = -1;
    h->owners = 1;
    if (identity) {
        h->identity = *identity;
        h->opened_before = true;
    }
    pthread_mutex_lock(&cache->handle_lock);
    h->next = cache->handles;
    cache->handles = h;
    bool opened = open_handle(cache, h);
    pthread_mutex_unlock(&cache->handle_lock);
    if (!opened) {
        result = atomic_load(&h->changed)
                     ? slvi_fail(&cache->env, SLV_ERROR_MISMATCH, CHANGED, path)
                     : slvi_fail(&cache->env, SLV_ERROR_IO, "%s: %s", path,
                                 strerror(atomic_load(&h->error)));
        slvi_cache_handle_release(h);
        return result;
    }
    h->owners = 2;
    *source = (slv_stream_in){handle_read, handle_close, h, h->identity.size};
    *out = h;
    return SLV_OK;
}

static void handle_log(void *user, slv_log_level level, const char *message) {
    cache_handle *h = user;
    const slv_env *env = &h->cache->env;
    int error = atomic_load(&h->error);
    if (level == SLV_LOG_ERROR && atomic_load(&h->changed))
        slvi_logf(env, level, CHANGED, h->path);
    else if (level == SLV_LOG_ERROR && error)
        slvi_logf(env, level, "%s: %s", message, strerror(error));
    else
        slvi_logf(env, level, "%s", message);
}

slv_env slvi_cache_handle_env(cache_handle *handle) {
    slv_env env = handle->cache->env;
    env.log = handle_log;
    env.log_user = handle;
    return env;
}

bool slvi_cache_handle_is_current(const char *path, const cache_identity *identity) {
    cache_identity now;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool same = descriptor >= 0 && identify(descriptor, &now) && is_same(&now, identity);
    if (descriptor >= 0)
        close(descriptor);
    return same;
}

slv_result slvi_cache_handle_result(const cache_handle *handle, slv_result result) {
    return result && atomic_load(&handle->changed) ? SLV_ERROR_MISMATCH : result;
}
