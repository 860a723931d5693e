/* A ring of changed rectangles. */
#include "texture/changes.h"

void slvi_changes_begin(slv_changes *changes) {
    pthread_mutex_init(&changes->lock, NULL);
    changes->version = changes->known = 1;
    changes->first = changes->count = 0;
}

void slvi_changes_end(slv_changes *changes) {
    pthread_mutex_destroy(&changes->lock);
}

uint64_t slvi_changes_version(slv_changes *changes) {
    pthread_mutex_lock(&changes->lock);
    uint64_t version = changes->version;
    pthread_mutex_unlock(&changes->lock);
    return version;
}

/* The smallest rectangle around both. */
static slv_rect join(slv_rect a, slv_rect b) {
    uint32_t x = a.x < b.x ? a.x : b.x, y = a.y < b.y ? a.y : b.y;
    uint32_t end_x = a.x + a.width > b.x + b.width ? a.x + a.width : b.x + b.width;
    uint32_t end_y = a.y + a.height > b.y + b.height ? a.y + a.height : b.y + b.height;
    return (slv_rect){x, y, end_x - x, end_y - y};
}

uint64_t slvi_changes_add(slv_changes *changes, uint32_t face, slv_rect rect, bool constancy) {
    pthread_mutex_lock(&changes->lock);
    uint64_t version = ++changes->version;
    slv_change change = {version, face, constancy, rect};
    slv_change *last = changes->count
                           ? &changes->kept[(changes->first + changes->count - 1) % CHANGES_KEPT]
                           : NULL;
    if (last && last->face == face) {
        /* who asks for what came after the older one is told more than need be, never less */
        change.rect = join(change.rect, last->rect);
        change.constancy |= last->constancy;
        *last = change;
    } else if (changes->count < CHANGES_KEPT) {
        changes->kept[(changes->first + changes->count++) % CHANGES_KEPT] = change;
    } else {
        changes->known = changes->kept[changes->first].version;
        changes->kept[changes->first] = change;
        changes->first = (changes->first + 1) % CHANGES_KEPT;
    }
    pthread_mutex_unlock(&changes->lock);
    return version;
}

void slvi_changes_add_all(slv_changes *changes) {
    pthread_mutex_lock(&changes->lock);
    changes->known = ++changes->version;
    changes->count = 0;
    pthread_mutex_unlock(&changes->lock);
}

uint32_t slvi_changes_since(slv_changes *changes, uint64_t since, slv_change out[CHANGES_KEPT]) {
    uint32_t count = 0;
    pthread_mutex_lock(&changes->lock);
    if (since < changes->known)
        count = UINT32_MAX;
    for (uint32_t i = 0; count != UINT32_MAX && i < changes->count; i++) {
        const slv_change *change = &changes->kept[(changes->first + i) % CHANGES_KEPT];
        if (change->version > since)
            out[count++] = *change;
    }
    pthread_mutex_unlock(&changes->lock);
    return count < CHANGES_KEPT + 1 ? count : UINT32_MAX;
}
