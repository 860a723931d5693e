/* Files that appear together: written into a folder beside their place, and moved when all are
 * there. */
#ifndef SELVAGE_FOLDER_H
#define SELVAGE_FOLDER_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slv_folder slv_folder;

/* Begins files that will make up the folder `path`, or be among those that it has; links are
 * followed. What killed writers of the same place left beside it is removed. */
SLV_NODISCARD SLV_API slv_result slv_folder_begin(const slv_env *env, const char *path,
                                                  slv_folder **out);
/* Begins files that will lie where the file `path` does, among others. */
SLV_NODISCARD SLV_API slv_result slv_folder_begin_beside(const slv_env *env, const char *path,
                                                         slv_folder **out);
/* The folder to write them into meanwhile. */
SLV_API const char *slv_folder_path(const slv_folder *folder);
/* With `result` SLV_OK moves all into their place, the one named `last` (may be NULL) after all
 * others; with any other removes them. Releases the folder, which may be NULL, and returns `result`
 * or what went wrong. */
SLV_NODISCARD SLV_API slv_result slv_folder_end(slv_folder *folder, const char *last,
                                                slv_result result);

#ifdef __cplusplus
}
#endif

#endif
