/* How many vertices a mesh takes where it is drawn: one for each texture coordinate of each. */
#include "mesh/wrap/round.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct pair {
    int32_t vertex;
    uint32_t at[2]; /* bits of the coordinates */
} pair;

static int by_bits(const void *a, const void *b) {
    return memcmp(a, b, sizeof(pair));
}

slv_result slvi_wrap_count_drawn(const slv_env *env, const slv_mesh *mesh, uint32_t *out) {
    const slv_mesh_view *view = &mesh->view;
    const uint32_t nsides = mesh->poly_first[view->npolys];
    pair *pairs;
    slv_result result = slvi_alloc(env, "texture coordinates", nsides, sizeof *pairs, &pairs);
    *out = 0;
    if (result)
        return result;
    for (uint32_t s = 0; s < nsides; s++) {
        const int32_t id = view->poly_texcoords ? view->poly_texcoords[s] : -1;
        float at[2] = {NAN, NAN};
        for (size_t k = 0; k < 2 && id >= 0; k++)
            at[k] = view->texcoords[2 * (size_t)id + k] + 0.0f; /* of nothing one sign */
        pairs[s].vertex = view->poly_verts[s];
        memcpy(pairs[s].at, at, sizeof at);
    }
    qsort(pairs, nsides, sizeof *pairs, by_bits);
    for (uint32_t s = 0; s < nsides; s++)
        *out += !s || by_bits(&pairs[s], &pairs[s - 1]) != 0;
    slvi_free(pairs);
    return SLV_OK;
}
