/* The metadata of several .ptx files as that of one. */
#include "exchange/merge.h"
#include "exchange/parts.h"

#include <stdio.h>
#include <string.h>

enum { MAX_KEY = 254 };

static size_t value_size(slv_meta_type type) {
    static const size_t sizes[] = {1, 1, 2, 4, 4, 8};
    return sizes[type];
}

static bool equal(const slv_ptx_meta *a, const slv_ptx_meta *b) {
    return a->type == b->type && a->count == b->count &&
           memcmp(a->values, b->values, a->count * value_size(a->type)) == 0;
}

/* One of the three arrays of geometry, of all files; vertices are counted on from file to file. */
static slv_result join_geometry(const slv_env *env, slvi_merge *m, int which) {
    uint64_t count = 0;
    uint32_t done = 0, first_vertex = 0;
    for (uint32_t i = 0; i < m->npaths; i++)
        count += slv_ptx_find_meta(m->files[i], slvi_geometry_keys[which])->count;
    if (count > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%s: %s would have %llu values", m->out,
                         slvi_geometry_keys[which], (unsigned long long)count);
    int32_t *values;
    slv_result result = slvi_alloc_plain(env, m->out, count, sizeof *values, &values);
    if (result)
        return result;
    for (uint32_t i = 0; i < m->npaths; i++) {
        const slv_ptx_meta *meta = slv_ptx_find_meta(m->files[i], slvi_geometry_keys[which]);
        memcpy(values + done, meta->values, meta->count * sizeof *values);
        for (uint32_t k = 0; which == SLVI_INDICES && k < meta->count; k++)
            values[done + k] += (int32_t)first_vertex;
        first_vertex +=
            slv_ptx_find_meta(m->files[i], slvi_geometry_keys[SLVI_POSITIONS])->count / 3;
        done += meta->count;
    }
    slv_ptx_meta joined = {.key = slvi_geometry_keys[which],
                           .type = which == SLVI_POSITIONS ? SLV_META_FLOAT : SLV_META_INT32,
                           .count = (uint32_t)count,
                           .values = values};
    result = slv_ptx_writer_set_meta(m->writer, &joined);
    slvi_free(values);
    return result;
}

static bool is_taken(const slvi_merge *m, const char *key) {
    for (uint32_t i = 0; i < m->npaths; i++)
        if (slv_ptx_find_meta(m->files[i], key))
            return true;
    return false;
}

/* Another value under a name that is taken is kept as KEY.2 for the second file, and so on. */
static slv_result join_entry(const slv_env *env, slvi_merge *m, uint32_t file,
                             const slv_ptx_meta *meta, char key[MAX_KEY + 16]) {
    slv_ptx_meta renamed = *meta;
    const slv_ptx_meta *before = NULL;
    /* the result has a record of its own, and geometry of all or none */
    bool renames = strcmp(meta->key, SLV_PARTS_KEY) == 0 ||
                   (slvi_geometry_key(meta->key) >= 0 && m->npaths > 1);
    snprintf(key, MAX_KEY + 16, "%s", meta->key);
    for (uint32_t i = 0; i < file && !before; i++)
        before = slv_ptx_find_meta(m->files[i], meta->key);
    if (!before && !renames)
        return slv_ptx_writer_set_meta(m->writer, meta);
    if (before && !renames && equal(before, meta))
        return SLV_OK;
    uint64_t number = (uint64_t)file + 1;
    do {
        snprintf(key, MAX_KEY + 16, "%s.%llu", meta->key, (unsigned long long)number);
        number += m->npaths;
    } while (renames && is_taken(m, key)); /* a merge of merges has such names */
    if (!renames && is_taken(m, key))
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s: metadata %.200s differs, and the name %.210s is taken",
                         m->paths[file], meta->key, key);
    renamed.key = key;
    return slv_ptx_writer_set_meta(m->writer, &renamed);
}

/* All entries of a file, and what it was in the record. */
static slv_result join_file(const slv_env *env, slvi_merge *m, uint32_t file, json_t *parts) {
    const slv_ptx *ptx = m->files[file];
    const slv_ptx_writer_params params = slv_ptx_writer_params_like(ptx);
    const slv_ptx_meta *positions =
        m->geometry ? slv_ptx_find_meta(ptx, slvi_geometry_keys[SLVI_POSITIONS]) : NULL;
    json_t *entries = json_array();
    slv_result result = SLV_OK;
    for (uint32_t k = 0; k < slv_ptx_get_info(ptx)->nmeta && !result; k++) {
        const slv_ptx_meta *meta;
        char key[MAX_KEY + 16];
        if ((result = slv_ptx_load_meta(ptx, k, &meta)) ||
            (m->geometry && slvi_geometry_key(meta->key) >= 0) ||
            (result = join_entry(env, m, file, meta, key)))
            continue;
        if (json_array_append_new(entries, slvi_parts_entry(env, meta->key, key)))
            result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to record its metadata",
                               m->paths[file]);
    }
    if (result) {
        json_decref(entries);
        return result;
    }
    json_t *part = slvi_parts_describe(env, m->paths[file], &params,
                                       positions ? positions->count / 3 : 0, entries);
    return json_array_append_new(parts, part)
               ? slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to record it", m->paths[file])
               : SLV_OK;
}

slv_result slvi_merge_meta(const slv_env *env, slvi_merge *m) {
    uint32_t with_geometry = 0;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < m->npaths; i++) {
        slv_mesh *mesh = NULL;
        if ((result = slv_ptx_find_mesh(env, m->files[i], &mesh, NULL)))
            return result;
        with_geometry += mesh != NULL;
        slv_mesh_destroy(mesh);
    }
    m->geometry = with_geometry == m->npaths;
    if (with_geometry && !m->geometry)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "%u of %u files have no usable geometry inside: the result has none, and split gives "
            "the others theirs again",
            m->npaths - with_geometry, m->npaths);
    for (int which = 0; m->geometry && which < SLVI_GEOMETRY_KEYS && !result; which++)
        result = join_geometry(env, m, which);
    json_t *parts = json_array();
    for (uint32_t i = 0; i < m->npaths && !result; i++)
        result = join_file(env, m, i, parts);
    if (!result && m->npaths > 1) /* one file is its own only part */
        return slvi_parts_record(env, m->out, &m->target, parts, m->writer);
    json_decref(parts);
    return result;
}
