/* What a displacement looks its values up in, where that is not a file as it stands. */
#ifndef SLV_DISPLACEMENT_TEXELS_H
#define SLV_DISPLACEMENT_TEXELS_H

#include <selvage/cache.h>

/* A file of a cache as a source of its own: with the neighbours of `adjacency`, which must outlive
 * it, in place of the file's unless it is NULL; and of triangles the texture of their sub-faces.
 * It reads of that cache, so that another one has to hold it. */
slv_result slvi_displacement_texels(slv_cache *cache, slv_file_id file,
                                    const slv_adjacency *adjacency, slv_source *out);

#endif
