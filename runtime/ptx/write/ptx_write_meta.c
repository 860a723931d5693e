/* Metadata of a file being made. */
#include "ptx/write/ptx_write.h"

#include "base/log.h"
#include "base/memory.h"

struct meta_packer {
    const slv_env *env;
    const char *path;
    struct libdeflate_compressor *deflater;
    bool all_small;
    ptx_bytes small, large_headers, large_data;
};

uint64_t slvi_ptx_meta_size(const slv_ptx_meta *meta) {
    static const uint8_t sizes[] = {1, 1, 2, 4, 4, 8};
    return (uint64_t)meta->count * sizes[meta->type] + (meta->type == SLV_META_STRING);
}

slv_result slvi_ptx_meta_check(const slv_env *env, const char *path, const slv_ptx_meta *meta) {
    if (!meta)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: a metadata entry is missing", path);
    if (!meta->key || !meta->key[0] || strlen(meta->key) > PTX_MAX_KEY)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: metadata keys have 1 to %d bytes", path,
                         PTX_MAX_KEY);
    if ((unsigned)meta->type > SLV_META_DOUBLE || (meta->count && !meta->values) ||
        (!meta->count && meta->type != SLV_META_STRING))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: metadata %s: %s", path, meta->key,
                         (unsigned)meta->type > SLV_META_DOUBLE ? "unknown type" : "has no values");
    if (slvi_ptx_meta_size(meta) > UINT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%s: metadata %s: %llu bytes are too many", path,
                         meta->key, (unsigned long long)slvi_ptx_meta_size(meta));
    return SLV_OK;
}

static slv_result add(struct meta_packer *m, const slv_ptx_meta *meta) {
    bool text = meta->type == SLV_META_STRING;
    uint64_t size = slvi_ptx_meta_size(meta), values_size = size - text;
    unsigned key_size = (unsigned)strlen(meta->key) + 1;
    bool large = size > PTX_LARGE_META && !m->all_small;
    uint8_t header[1 + PTX_MAX_KEY + 1 + 9];
    header[0] = (uint8_t)key_size;
    memcpy(header + 1, meta->key, key_size);
    header[1 + key_size] = (uint8_t)meta->type;
    ptx_put_u32(header + 2 + key_size, (uint32_t)size);
    ptx_bytes own = {0}, *values = large ? &own : &m->small;
    slv_result result = SLV_OK;
    if (!large)
        result = slvi_ptx_bytes_append(m->env, m->path, &m->small, header, key_size + 6);
    if (!result &&
        !(result = slvi_ptx_bytes_append(m->env, m->path, values, meta->values, values_size)) &&
        text)
        result = slvi_ptx_bytes_append(m->env, m->path, values, "", 1);
    if (large) {
        uint32_t zipped = 0;
        if (!result)
            result = slvi_ptx_bytes_append_zip(m->env, m->path, m->deflater, &m->large_data,
                                               values->data, size, UINT32_MAX, &zipped);
        ptx_put_u32(header + 6 + key_size, zipped);
        if (!result)
            result =
                slvi_ptx_bytes_append(m->env, m->path, &m->large_headers, header, key_size + 10);
        slvi_free(own.data);
    }
    return result;
}

slv_result slvi_ptx_meta_pack(const slv_env *env, const char *path,
                              struct libdeflate_compressor *deflater, const ptx_kept_meta *meta,
                              uint32_t nmeta, ptx_meta_out *out) {
    static const uint8_t barrier[PTX_BARRIER_SIZE] = {0};
    struct meta_packer m = {.env = env, .path = path, .deflater = deflater};
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < nmeta; i++)
        result = add(&m, &meta[i].entry);
    if (!result && (m.small.size > UINT32_MAX || m.large_headers.size > UINT32_MAX))
        result = slvi_fail(env, SLV_ERROR_LIMIT, "%s: too much metadata", path);
    if (!result && m.small.size)
        result = slvi_ptx_bytes_append_zip(env, path, deflater, &out->bytes, m.small.data,
                                           m.small.size, UINT32_MAX, &out->small_zipped);
    /* even without metadata: readers skip the barrier in any case before they look for edits */
    if (!result)
        result = slvi_ptx_bytes_append(env, path, &out->bytes, barrier, sizeof barrier);
    if (!result && m.large_headers.size)
        result = slvi_ptx_bytes_append_zip(env, path, deflater, &out->bytes, m.large_headers.data,
                                           m.large_headers.size, UINT32_MAX, &out->large_zipped);
    if (!result)
        result =
            slvi_ptx_bytes_append(env, path, &out->bytes, m.large_data.data, m.large_data.size);
    out->small_size = (uint32_t)m.small.size;
    out->large_size = (uint32_t)m.large_headers.size;
    out->large_data = m.large_data.size;
    slvi_free(m.small.data);
    slvi_free(m.large_headers.data);
    slvi_free(m.large_data.data);
    return result;
}

slv_result slvi_ptx_meta_pack_edit(const slv_env *env, const char *path, const ptx_kept_meta *meta,
                                   uint32_t nmeta, ptx_bytes *out) {
    struct meta_packer m = {.env = env, .path = path, .all_small = true};
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < nmeta; i++)
        result = add(&m, &meta[i].entry);
    if (!result && m.small.size > UINT32_MAX / 2)
        result = slvi_fail(env, SLV_ERROR_LIMIT, "%s: too much metadata for one edit", path);
    *out = m.small;
    return result;
}
