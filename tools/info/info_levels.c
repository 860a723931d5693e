/* What each stored level of a .ptx holds. */
#include "info/info.h"

#include <stdlib.h>

enum { ENCODINGS = SLV_PTX_TILED + 1 };

struct info_level {
    uint64_t faces; /* that have texels of their own there, edited ones left out */
    uint64_t texels, block_bytes;
    uint64_t encodings[ENCODINGS];
};

struct info_levels {
    const slv_ptx_info *info;
    uint64_t edited, edited_bytes;
    struct info_level levels[];
};

static slv_result add_face(const slv_ptx *ptx, uint32_t face, info_levels *out) {
    slv_ptx_face f;
    slv_result result = slv_ptx_get_face(ptx, face, &f);
    bool edited = !result && (f.flags & SLV_FACE_EDITED);
    out->edited += edited;
    for (uint32_t level = 0; level < out->info->nlevels && !result; level++) {
        slv_ptx_block block;
        if ((result = slv_ptx_get_block(ptx, face, level, &block)) || !block.stored)
            break;
        if (edited) {
            out->edited_bytes += block.bytes;
            break;
        }
        struct info_level *at = &out->levels[level];
        at->faces++;
        at->texels += UINT64_C(1) << (block.res.u + block.res.v);
        at->block_bytes += block.bytes;
        at->encodings[block.encoding]++;
    }
    return result;
}

slv_result info_levels_make(const slv_env *env, const slv_ptx *ptx, info_levels **out) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    info_levels *levels = calloc(1, sizeof *levels + info->nlevels * sizeof *levels->levels);
    slv_result result = SLV_OK;
    *out = NULL;
    if (!levels)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its levels",
                           slv_ptx_name(ptx));
    levels->info = info;
    for (uint32_t face = 0; face < info->nfaces && !result; face++)
        result = add_face(ptx, face, levels);
    if (result)
        free(levels);
    else
        *out = levels;
    return result;
}

static uint64_t texel_bytes(const info_levels *levels, uint32_t level) {
    return levels->levels[level].texels * levels->info->nchannels *
           slv_type_size(levels->info->type);
}

void info_levels_print(const info_levels *levels) {
    const slv_ptx_info *info = levels->info;
    uint64_t other = info->file_bytes;
    char a[32], b[32];
    const char *label = "Levels";
    for (uint32_t i = 0; i < info->nlevels; i++) {
        const struct info_level *level = &levels->levels[i];
        uint64_t unpacked = texel_bytes(levels, i);
        const char *separator = ": ";
        other -= info->level_bytes[i] < other ? info->level_bytes[i] : other;
        printf("  %-14s%u: %llu face%s, %s of texels in %s", label, i,
               (unsigned long long)level->faces, level->faces == 1 ? "" : "s",
               info_bytes(unpacked, a, sizeof a), info_bytes(info->level_bytes[i], b, sizeof b));
        if (unpacked)
            printf(" (%.0f%%)", 100 * (double)info->level_bytes[i] / (double)unpacked);
        for (int e = 0; e < ENCODINGS; e++) {
            if (!level->encodings[e])
                continue;
            printf("%s%llu %s", separator, (unsigned long long)level->encodings[e],
                   slv_ptx_encoding_name((slv_ptx_encoding)e));
            separator = ", ";
        }
        putchar('\n');
        label = "";
    }
    info_line("", "%s besides: tables, constant faces and averages, metadata, edits",
              info_bytes(other, a, sizeof a));
    if (info->has_edits)
        info_line("Edits", "%llu face%s, %s of packed texels", (unsigned long long)levels->edited,
                  levels->edited == 1 ? "" : "s", info_bytes(levels->edited_bytes, a, sizeof a));
}

static json_t *level_json(const info_levels *levels, uint32_t i) {
    const struct info_level *level = &levels->levels[i];
    json_t *encodings = json_object();
    for (int e = 0; e < ENCODINGS; e++)
        if (json_object_set_new(encodings, slv_ptx_encoding_name((slv_ptx_encoding)e),
                                json_integer((json_int_t)level->encodings[e]))) {
            json_decref(encodings);
            return NULL;
        }
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:o}", "faces", (json_int_t)level->faces, "texels",
                     (json_int_t)level->texels, "texel_bytes", (json_int_t)texel_bytes(levels, i),
                     "block_bytes", (json_int_t)level->block_bytes, "file_bytes",
                     (json_int_t)levels->info->level_bytes[i], "encodings", encodings);
}

json_t *info_levels_json(const info_levels *levels) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < levels->info->nlevels; i++)
        list = info_append(list, level_json(levels, i));
    return list;
}

json_t *info_edits_json(const info_levels *levels) {
    return json_pack("{s:I, s:I}", "faces", (json_int_t)levels->edited, "block_bytes",
                     (json_int_t)levels->edited_bytes);
}
