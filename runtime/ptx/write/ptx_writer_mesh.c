/* What a writer is told besides texels: metadata, and how faces meet. */
#include "ptx/write/ptx_write.h"

#include "base/log.h"
#include "base/memory.h"
#include "mesh/mesh_data.h"

#include <math.h>
#include <stdlib.h>

#define LOSS_TOLD 1e-4f /* of half the mesh's size */

static slv_result check_open(const slv_ptx_writer *writer, const char *what) {
    if (!writer->finished)
        return SLV_OK;
    return slvi_fail(&writer->env, SLV_ERROR_ARGUMENT, "%s: %s comes after the file is finished",
                     writer->path, what);
}

slv_result slv_ptx_writer_set_meta(slv_ptx_writer *writer, const slv_ptx_meta *meta) {
    if (meta->key && strcmp(meta->key, SLV_PTX_REDUCTIONS_KEY) == 0 && writer->edited < 0)
        return SLV_OK; /* of the file that it comes from */
    slv_result result = check_open(writer, "metadata");
    return result ? result : slvi_ptx_writer_keep_meta(writer, meta);
}

slv_result slvi_ptx_writer_keep_meta(slv_ptx_writer *writer, const slv_ptx_meta *meta) {
    const slv_env *env = &writer->env;
    uint32_t at = 0;
    uint8_t *memory = NULL;
    slv_result result = slvi_ptx_meta_check(env, writer->path, meta);
    if (result)
        return result;
    while (at < writer->nmeta && strcmp(writer->meta[at].entry.key, meta->key) != 0)
        at++;
    if (at == writer->meta_capacity) {
        uint64_t capacity = at ? 2 * (uint64_t)at : 16;
        ptx_kept_meta *grown = NULL;
        if ((result = slvi_alloc(env, writer->path, capacity, sizeof *grown, &grown)))
            return result;
        if (at)
            memcpy(grown, writer->meta, at * sizeof *grown);
        slvi_free(writer->meta);
        writer->meta = grown;
        writer->meta_capacity = (uint32_t)capacity;
    }
    uint64_t size = slvi_ptx_meta_size(meta) - (meta->type == SLV_META_STRING);
    size_t key_size = strlen(meta->key) + 1;
    /* the values come first, where they are aligned */
    if ((result = slvi_alloc(env, writer->path, size + key_size, 1, &memory)))
        return result;
    if (size)
        memcpy(memory, meta->values, (size_t)size);
    memcpy(memory + size, meta->key, key_size);
    if (at < writer->nmeta)
        slvi_free(writer->meta[at].memory);
    writer->meta[at].entry =
        (slv_ptx_meta){(const char *)memory + size, meta->type, meta->count, memory};
    writer->meta[at].memory = memory;
    if (at == writer->nmeta)
        writer->nmeta++;
    return SLV_OK;
}

slv_result slv_ptx_writer_set_adjacency(slv_ptx_writer *writer, const slv_adjacency *adjacency) {
    uint32_t nfaces = writer->params.nfaces;
    slv_result result = check_open(writer, "adjacency");
    if (result)
        return result;
    if (writer->edited >= 0 || writer->params.mesh_type == SLV_PTX_TRIANGLE)
        return slvi_fail(&writer->env, SLV_ERROR_ARGUMENT,
                         "%s: adjacency as a whole is for new files of quads", writer->path);
    if (slv_adjacency_face_count(adjacency) != nfaces)
        return slvi_fail(&writer->env, SLV_ERROR_MISMATCH,
                         "%s: the texture has %u faces, the adjacency %u", writer->path, nfaces,
                         slv_adjacency_face_count(adjacency));
    if (!writer->links && (result = slvi_alloc(&writer->env, writer->path, nfaces,
                                               sizeof *writer->links, &writer->links)))
        return result;
    for (uint32_t face = 0; face < nfaces; face++) {
        writer->links[face].adjacency = slv_adjacency_faces(adjacency)[face];
        writer->links[face].flags =
            slv_adjacency_is_subface(adjacency, (int32_t)face) ? SLV_FACE_SUBFACE : 0;
    }
    return SLV_OK;
}

/* A triangle's side, by the vertices that it joins. */
struct side {
    uint64_t key; /* the smaller vertex, the larger one */
    uint32_t face;
    uint8_t edge, backwards;
};

static int compare_sides(const void *a, const void *b) {
    const struct side *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->face != y->face ? (x->face < y->face ? -1 : 1) : x->edge - y->edge;
}

/* Two triangles are neighbours where they are the only two at a side, and run along it in opposite
 * directions. */
static slv_result link_triangles(slv_ptx_writer *writer, const slv_mesh_view *view) {
    uint32_t nfaces = writer->params.nfaces;
    struct side *sides = NULL;
    slv_result result =
        slvi_alloc(&writer->env, writer->path, 3 * (uint64_t)nfaces, sizeof *sides, &sides);
    if (!result && !writer->links)
        result =
            slvi_alloc(&writer->env, writer->path, nfaces, sizeof *writer->links, &writer->links);
    if (result)
        goto done;
    for (uint32_t face = 0; face < nfaces; face++) {
        writer->links[face] = (slv_ptx_face){
            .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
        for (unsigned edge = 0; edge < 3; edge++) {
            uint32_t from = (uint32_t)view->poly_verts[3 * (size_t)face + edge];
            uint32_t to = (uint32_t)view->poly_verts[3 * (size_t)face + (edge + 1) % 3];
            bool backwards = from > to;
            sides[3 * (size_t)face + edge] =
                (struct side){backwards ? (uint64_t)to << 32 | from : (uint64_t)from << 32 | to,
                              face, (uint8_t)edge, backwards};
        }
    }
    if (nfaces)
        qsort(sides, 3 * (size_t)nfaces, sizeof *sides, compare_sides);
    for (size_t first = 0, end; first < 3 * (size_t)nfaces; first = end) {
        for (end = first + 1; end < 3 * (size_t)nfaces && sides[end].key == sides[first].key;)
            end++;
        const struct side *a = &sides[first], *b = a + 1;
        if (end - first != 2 || a->backwards == b->backwards)
            continue;
        writer->links[a->face].adjacency.face[a->edge] = (int32_t)b->face;
        writer->links[a->face].adjacency.edge[a->edge] = b->edge;
        writer->links[b->face].adjacency.face[b->edge] = (int32_t)a->face;
        writer->links[b->face].adjacency.edge[b->edge] = a->edge;
    }
done:
    slvi_free(sides);
    return result;
}

static slv_result link_mesh(slv_ptx_writer *writer, const slv_mesh *mesh) {
    slv_adjacency *adjacency = NULL;
    if (writer->params.mesh_type == SLV_PTX_TRIANGLE)
        return link_triangles(writer, slv_mesh_get_view(mesh));
    slv_result result = slv_mesh_adjacency(&writer->env, mesh, &adjacency);
    if (!result)
        result = slv_ptx_writer_set_adjacency(writer, adjacency);
    slv_adjacency_destroy(adjacency);
    return result;
}

/* Positions as the file has them: floats, from zero. What that takes from those of a mesh far away
 * is told. */
static slv_result absolute_positions(const slv_ptx_writer *writer, const slv_mesh_view *view,
                                     float **out) {
    float worst = 0, size = 0;
    slv_result result =
        slvi_alloc_plain(&writer->env, writer->path, view->nverts, 3 * sizeof **out, out);
    for (size_t i = 0; !result && i < (size_t)3 * view->nverts; i++) {
        double exact = (double)view->positions[i] + view->origin[i % 3];
        (*out)[i] = (float)exact;
        worst = fmaxf(worst, (float)fabs(exact - (double)(*out)[i]));
        size = fmaxf(size, fabsf(view->positions[i]));
    }
    if (!result && worst > LOSS_TOLD * size)
        slvi_logf(&writer->env, SLV_LOG_WARNING,
                  "%s: so far from zero the geometry inside is off by up to %g, of a mesh of %g; "
                  "the mesh's own file is better",
                  writer->path, (double)worst, 2 * (double)size);
    return result;
}

slv_result slvi_ptx_writer_set_geometry(slv_ptx_writer *writer, const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    if (view->ncreases || view->ncorners || view->nholes)
        slvi_logf(&writer->env, SLV_LOG_WARNING,
                  "%s: the geometry inside does not keep the mesh's creases, corners and holes",
                  writer->path);
    bool triangle = writer->params.mesh_type == SLV_PTX_TRIANGLE;
    uint64_t nindices = 0;
    slv_result result = SLV_OK;
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        nindices += (uint32_t)view->poly_sizes[poly];
        if (triangle && view->poly_sizes[poly] != 3)
            return slvi_fail(&writer->env, SLV_ERROR_MISMATCH,
                             "%s: polygon %u of the mesh has %d vertices, not those of a triangle",
                             writer->path, poly, view->poly_sizes[poly]);
    }
    uint32_t nfaces = triangle ? view->npolys : slv_mesh_face_count(mesh);
    if (nfaces != writer->params.nfaces)
        return slvi_fail(&writer->env, SLV_ERROR_MISMATCH,
                         "%s: the texture has %u faces, the mesh %u", writer->path,
                         writer->params.nfaces, nfaces);
    if (nindices > UINT32_MAX / 4 || view->nverts > UINT32_MAX / 12)
        return slvi_fail(&writer->env, SLV_ERROR_LIMIT,
                         "%s: the mesh is too large to be written with it", writer->path);
    slv_ptx_meta entries[3] = {
        {"PtexFaceVertCounts", SLV_META_INT32, view->npolys, view->poly_sizes},
        {"PtexFaceVertIndices", SLV_META_INT32, (uint32_t)nindices, view->poly_verts},
        {"PtexVertPositions", SLV_META_FLOAT, 3 * view->nverts, view->positions}};
    float *positions = NULL;
    if (slvi_mesh_is_far(view) && !(result = absolute_positions(writer, view, &positions)))
        entries[2].values = positions;
    for (size_t i = 0; i < 3 && !result; i++)
        if (entries[i].count)
            result = slv_ptx_writer_set_meta(writer, &entries[i]);
    slvi_free(positions);
    return result;
}

slv_result slv_ptx_writer_set_mesh(slv_ptx_writer *writer, const slv_mesh *mesh) {
    slv_result result = check_open(writer, "the mesh");
    if (!result && !(result = slvi_ptx_writer_set_geometry(writer, mesh)) && writer->edited < 0)
        result = link_mesh(writer, mesh);
    return result;
}
