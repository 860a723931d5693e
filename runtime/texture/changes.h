/* What was changed when, as far back as is remembered. */
#ifndef SLV_TEXTURE_CHANGES_H
#define SLV_TEXTURE_CHANGES_H

#include <selvage/source.h>

#include <pthread.h>

#define CHANGES_KEPT 256

typedef struct slv_change {
    uint64_t version;
    uint32_t face;
    bool constancy; /* whether the face is constant, or its one value, may have changed */
    slv_rect rect;
} slv_change;

/* The newest changes, in a ring. Any thread may call any function at any time. */
typedef struct slv_changes {
    pthread_mutex_t lock;
    uint64_t version; /* of the newest; 1 at first */
    uint64_t known;   /* what came after this version is all there */
    uint32_t first, count;
    slv_change kept[CHANGES_KEPT];
} slv_changes;

void slvi_changes_begin(slv_changes *changes);
void slvi_changes_end(slv_changes *changes);
uint64_t slvi_changes_version(slv_changes *changes);
/* Returns the version that it makes. */
uint64_t slvi_changes_add(slv_changes *changes, uint32_t face, slv_rect rect, bool constancy);
/* Everything may have changed. */
void slvi_changes_add_all(slv_changes *changes);
/* Copies what came after a version to `out`, and returns how many they are; or UINT32_MAX if it is
 * not known. */
uint32_t slvi_changes_since(slv_changes *changes, uint64_t since, slv_change out[CHANGES_KEPT]);

#endif
