/* One .ptx as several: the inverse of a merge. */
#include "exchange/parts.h"

#include "base/file.h"

#include <selvage/folder.h>

#include <stdio.h>
#include <string.h>

/* The entry of a key; `*out` is NULL if there is none. */
static slv_result find_entry(const slv_ptx *ptx, const char *key, const slv_ptx_meta **out) {
    slv_result result = SLV_OK;
    *out = NULL;
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta && !result && !*out; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(ptx, i, &meta)) && strcmp(meta->key, key) == 0)
            *out = meta;
    }
    return result;
}

/* The part's own entries, under their old names. */
static slv_result write_meta(const slv_ptx *ptx, const slvi_part *part, slv_ptx_writer *writer) {
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta && !part->meta && !result; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(ptx, i, &meta)) && slvi_geometry_key(meta->key) < 0 &&
            strcmp(meta->key, SLV_PARTS_KEY) != 0)
            result = slv_ptx_writer_set_meta(writer, meta);
    }
    for (size_t i = 0; i < json_array_size(part->meta) && !result; i++) {
        const json_t *entry = json_array_get(part->meta, i);
        const char *key = json_string_value(json_array_get(entry, 0)),
                   *merged = json_string_value(json_array_get(entry, 1));
        const slv_ptx_meta *found = NULL;
        if ((key && merged && (result = find_entry(ptx, merged, &found))) || !found)
            continue; /* an error, or somebody took it out since */
        slv_ptx_meta meta = *found;
        meta.key = key;
        result = slv_ptx_writer_set_meta(writer, &meta);
    }
    return result;
}

static slv_result write_part(const slv_env *env, const slv_ptx *ptx, const slvi_part *part,
                             const slv_split_params *params, slvi_exchange_totals *totals,
                             const char *path) {
    slv_ptx_writer_params source = slv_ptx_writer_params_like(ptx);
    slv_exchange_params changes = part->changes;
    slvi_exchange_plan plan = {0};
    slv_ptx_writer *writer = NULL;
    uint32_t *faces;
    slv_result result = slvi_alloc(env, path, (uint64_t)part->count + 1, sizeof *faces, &faces);
    if (result)
        return result;
    for (uint32_t i = 0; i < part->count; i++)
        faces[i] = part->first + i;
    changes.faces = faces;
    changes.nfaces = part->count;
    changes.compression = params->compression;
    if ((result =
             slvi_exchange_plan_make(env, &changes, slv_ptx_name(ptx), &source, totals, &plan)) ||
        (result = slv_ptx_writer_create(env, path, &plan.target, &writer)) ||
        (result = write_meta(ptx, part, writer)) ||
        (result = slvi_geometry_select(env, ptx, faces, part->count,
                                       part->has_vertices ? &part->vertices : NULL, writer)) ||
        (result = slvi_exchange_write_faces(env, &plan, ptx, writer)))
        goto done;
    result = slv_ptx_writer_finish(writer);
done:
    slv_ptx_writer_destroy(writer);
    slvi_exchange_plan_free(&plan);
    slvi_free(faces);
    return result;
}

/* A part may have the name that the whole has now. */
static slv_result check_names(const slv_env *env, const slv_ptx *ptx, const slvi_parts *parts,
                              const char *folder) {
    char *path;
    size_t size = strlen(folder) + sizeof parts->list->name + 2;
    slv_result result = slvi_alloc(env, folder, size, 1, &path);
    for (uint32_t i = 0; i < parts->count && !result; i++) {
        snprintf(path, size, "%s/%s", folder, parts->list[i].name);
        if (slvi_same_file(path, slv_ptx_name(ptx)))
            result =
                slvi_fail(env, SLV_ERROR_ARGUMENT,
                          "%s: is what is split, and would be lost as the name of a part", path);
    }
    slvi_free(path);
    return result;
}

static slv_result write_parts(const slv_env *env, const slv_ptx *ptx, const slvi_parts *parts,
                              const slv_split_params *params, slvi_exchange_totals *totals,
                              const char *folder) {
    slv_folder *made;
    slv_result result = slv_folder_begin(env, folder, &made);
    if (result)
        return result;
    for (uint32_t i = 0; i < parts->count && !result; i++) {
        const slvi_part *part = &parts->list[i];
        size_t size = strlen(slv_folder_path(made)) + sizeof part->name + 2;
        char *path;
        if ((result = slvi_alloc(env, folder, size, 1, &path)))
            break;
        snprintf(path, size, "%s/%s", slv_folder_path(made), part->name);
        result = write_part(env, ptx, part, params, totals, path);
        slvi_free(path);
        if (!result && params->each)
            params->each(params->user, part->name, part->first, part->count);
    }
    return slv_folder_end(made, NULL, result);
}

slv_result slv_split(const slv_env *given, const slv_ptx *ptx, const slv_split_params *params,
                     const char *folder, slv_exchange_stats *stats) {
    static const slv_split_params none = {0};
    slv_env env = slvi_env_or_default(given);
    slvi_exchange_totals totals;
    slvi_parts parts = {.root = NULL};
    params = params ? params : &none;
    slvi_exchange_begin(&totals, params->progress, slv_ptx_get_info(ptx)->nfaces);
    slv_result result = slv_ptx_load_tables(ptx);
    if (!result)
        result = params->at ? slvi_parts_at(&env, ptx, params->at, params->nparts, &parts)
                            : slvi_parts_read(&env, ptx, &parts);
    if (!result)
        result = check_names(&env, ptx, &parts, folder);
    if (!result)
        result = write_parts(&env, ptx, &parts, params, &totals, folder);
    slv_ptx_writer_params wrote = slv_ptx_writer_params_like(ptx);
    slvi_exchange_end(&env, &totals, result, &wrote, stats);
    slvi_parts_free(&parts);
    return result;
}
