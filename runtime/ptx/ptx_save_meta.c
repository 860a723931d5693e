/* Metadata of a file being made. */
#include "ptx/ptx_write.h"

#include <stdlib.h>

static const char *const geometry_keys[] = {"PtexFaceVertCounts", "PtexFaceVertIndices",
                                            "PtexVertPositions"};

static bool is_geometry(const char *key) {
    for (size_t i = 0; i < 3; i++)
        if (!strcmp(key, geometry_keys[i]))
            return true;
    return false;
}

struct meta_packer {
    const slv_env *env;
    const char *path;
    struct libdeflate_compressor *deflater;
    ptx_bytes small, large_headers, large_data;
};

static slv_result add(struct meta_packer *m, const slv_ptx_meta *meta) {
    static const uint8_t sizes[] = {1, 1, 2, 4, 4, 8};
    if (!meta->key || !meta->key[0] || strlen(meta->key) > PTX_MAX_KEY)
        return slv_fail(m->env, SLV_ERROR_ARGUMENT, "%s: metadata keys have 1 to %d bytes", m->path,
                        PTX_MAX_KEY);
    if ((unsigned)meta->type > SLV_META_DOUBLE || (meta->count && !meta->values) ||
        (!meta->count && meta->type != SLV_META_STRING))
        return slv_fail(m->env, SLV_ERROR_ARGUMENT, "%s: metadata %s: %s", m->path, meta->key,
                        (unsigned)meta->type > SLV_META_DOUBLE ? "unknown type" : "has no values");
    bool text = meta->type == SLV_META_STRING;
    uint64_t values_size = (uint64_t)meta->count * sizes[meta->type], size = values_size + text;
    if (size > UINT32_MAX)
        return slv_fail(m->env, SLV_ERROR_LIMIT, "%s: metadata %s: %llu bytes are too many",
                        m->path, meta->key, (unsigned long long)size);
    unsigned key_size = (unsigned)strlen(meta->key) + 1;
    bool large = size > PTX_LARGE_META;
    uint8_t header[1 + PTX_MAX_KEY + 1 + 9];
    header[0] = (uint8_t)key_size;
    memcpy(header + 1, meta->key, key_size);
    header[1 + key_size] = (uint8_t)meta->type;
    ptx_put_u32(header + 2 + key_size, (uint32_t)size);
    ptx_bytes own = {0}, *values = large ? &own : &m->small;
    slv_result result = SLV_OK;
    if (!large)
        result = ptx_bytes_append(m->env, m->path, &m->small, header, key_size + 6);
    if (!result &&
        !(result = ptx_bytes_append(m->env, m->path, values, meta->values, values_size)) && text)
        result = ptx_bytes_append(m->env, m->path, values, "", 1);
    if (large) {
        uint32_t zipped = 0;
        if (!result)
            result = ptx_bytes_append_zip(m->env, m->path, m->deflater, &m->large_data,
                                          values->data, size, UINT32_MAX, &zipped);
        ptx_put_u32(header + 6 + key_size, zipped);
        if (!result)
            result = ptx_bytes_append(m->env, m->path, &m->large_headers, header, key_size + 10);
        free(own.data);
    }
    return result;
}

static slv_result add_mesh(struct meta_packer *m, const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    uint64_t nindices = 0;
    slv_result result;
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        nindices += (uint32_t)view->poly_sizes[poly];
    if (nindices > UINT32_MAX / 4 || view->nverts > UINT32_MAX / 12)
        return slv_fail(m->env, SLV_ERROR_LIMIT, "%s: the mesh is too large to be written with it",
                        m->path);
    slv_ptx_meta entries[3] = {
        {geometry_keys[0], SLV_META_INT32, view->npolys, view->poly_sizes},
        {geometry_keys[1], SLV_META_INT32, (uint32_t)nindices, view->poly_verts},
        {geometry_keys[2], SLV_META_FLOAT, 3 * view->nverts, view->positions}};
    for (size_t i = 0; i < 3; i++)
        if (entries[i].count && (result = add(m, &entries[i])))
            return result;
    return SLV_OK;
}

slv_result ptx_meta_pack(const slv_env *env, const char *path,
                         struct libdeflate_compressor *deflater, const slv_ptx_write_params *params,
                         ptx_meta_out *out) {
    static const uint8_t barrier[PTX_BARRIER_SIZE] = {0};
    struct meta_packer m = {.env = env, .path = path, .deflater = deflater};
    slv_result result = SLV_OK;
    if (params->mesh)
        result = add_mesh(&m, params->mesh);
    for (uint32_t i = 0; !result && i < params->nmeta; i++)
        if (!params->mesh || !params->meta[i].key || !is_geometry(params->meta[i].key))
            result = add(&m, &params->meta[i]);
    if (!result && (m.small.size > UINT32_MAX || m.large_headers.size > UINT32_MAX))
        result = slv_fail(env, SLV_ERROR_LIMIT, "%s: too much metadata", path);
    if (!result && m.small.size)
        result = ptx_bytes_append_zip(env, path, deflater, &out->bytes, m.small.data, m.small.size,
                                      UINT32_MAX, &out->small_zipped);
    /* even without metadata: readers skip the barrier in any case before they look for edits */
    if (!result)
        result = ptx_bytes_append(env, path, &out->bytes, barrier, sizeof barrier);
    if (!result && m.large_headers.size)
        result = ptx_bytes_append_zip(env, path, deflater, &out->bytes, m.large_headers.data,
                                      m.large_headers.size, UINT32_MAX, &out->large_zipped);
    if (!result)
        result = ptx_bytes_append(env, path, &out->bytes, m.large_data.data, m.large_data.size);
    out->small_size = (uint32_t)m.small.size;
    out->large_size = (uint32_t)m.large_headers.size;
    out->large_data = m.large_data.size;
    free(m.small.data);
    free(m.large_headers.data);
    free(m.large_data.data);
    return result;
}
