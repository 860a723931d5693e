/* What a target is written to until it is complete: a file or a folder beside it, locked while its
 * writer lives, so that those of a killed one are known. */
#ifndef SLV_BASE_BESIDE_H
#define SLV_BASE_BESIDE_H

#include <selvage/result.h>

#include <stdbool.h>
#include <sys/stat.h>

/* Where writing to `path` ends up, for slvi_free: links at its end are followed, whether or not
 * something is there. */
slv_result slvi_beside_resolve(const slv_env *env, const char *path, char **target);

/* Makes one beside `target`, of at most `mode`. `path` is the target in messages. *name is for
 * slvi_free, closing *descriptor gives up the lock. Removes what killed writers of the same target
 * left. */
slv_result slvi_beside_create(const slv_env *env, const char *path, const char *target, bool folder,
                              mode_t mode, char **name, int *descriptor);
/* Removes what killed writers left. */
void slvi_beside_sweep(const char *target);
/* A folder and the files in it. */
void slvi_beside_remove_folder(const char *folder);
/* An unnamed file in the folder of `target`. */
slv_result slvi_beside_nameless(const slv_env *env, const char *path, const char *target,
                                int *descriptor);

#endif
