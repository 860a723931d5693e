/* Where the grids of faces meet. */
#include "mesh/grid.h"

uint32_t slvi_edge_segments(const slvi_grid_job *job, uint32_t face, unsigned edge) {
    const uint16_t *segments = job->out->segments;
    slv_neighbour other[2];
    uint32_t least = segments[face];
    uint32_t count = slv_adjacency_neighbours(job->adjacency, (int32_t)face, edge, other);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t n = segments[other[i].face];
        if (n && other[i].scale < 1) /* the whole quad knows the other sub-face, too */
            n = slvi_edge_segments(job, (uint32_t)other[i].face, other[i].edge) / 2;
        else if (other[i].scale > 1)
            n *= 2;
        least = n && n < least ? n : least;
    }
    return least;
}

bool slvi_t_corner_place(const slvi_grid_job *job, uint32_t face, unsigned corner,
                         slv_neighbour *quad, float uv[2]) {
    /* the middle of a whole quad's edge; that edge is one of the two which meet here */
    for (unsigned side = 0; side < 2; side++) {
        slv_neighbour other[2];
        unsigned edge = side ? slvi_edge_before(corner) : corner;
        if (slv_adjacency_neighbours(job->adjacency, (int32_t)face, edge, other) != 1 ||
            other->scale >= 1 || !job->out->segments[other->face])
            continue;
        *quad = other[0];
        slv_affine_apply(&other->map, (float)slvi_corner_u(corner), (float)slvi_corner_v(corner),
                         uv, uv + 1);
        return true;
    }
    return false;
}
