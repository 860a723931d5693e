/* Files that another writer made, loaded and written again: every stored fact must come out bit for
 * bit the same. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

static void compare_face(const char *path, const slv_ptx *a, const slv_ptx *b, uint32_t face) {
    const slv_ptx_info *info = slv_ptx_get_info(a);
    slv_ptx_face fa, fb;
    REQUIRE(slv_ptx_get_face(a, face, &fa) == SLV_OK && slv_ptx_get_face(b, face, &fb) == SLV_OK);
    CHECK_MSG(fa.flags == fb.flags, "%s: face %u: flags %d, then %d", path, face, fa.flags,
              fb.flags);
    CHECK(fa.res.u == fb.res.u && fa.res.v == fb.res.v);
    for (int edge = 0; edge < 4; edge++)
        CHECK_MSG(
            fa.adjacency.face[edge] == fb.adjacency.face[edge] &&
                (fa.adjacency.face[edge] < 0 || fa.adjacency.edge[edge] == fb.adjacency.edge[edge]),
            "%s: face %u edge %d", path, face, edge);
    size_t size = slv_type_size(info->type) * info->nchannels << (fa.res.u + fa.res.v);
    void *texels[2] = {malloc(size), malloc(size)};
    for (slv_res res = fa.res; res.u >= 0 && res.v >= 0; res.u--, res.v--) {
        size_t bytes = slv_type_size(info->type) * info->nchannels << (res.u + res.v);
        REQUIRE(slv_ptx_read_face(a, face, res, texels[0]) == SLV_OK);
        REQUIRE(slv_ptx_read_face(b, face, res, texels[1]) == SLV_OK);
        CHECK_MSG(!memcmp(texels[0], texels[1], bytes), "%s: face %u at 2^%d x 2^%d", path, face,
                  res.u, res.v);
    }
    slv_res one = {0, 0};
    REQUIRE(slv_ptx_read_face(a, face, one, texels[0]) == SLV_OK);
    REQUIRE(slv_ptx_read_face(b, face, one, texels[1]) == SLV_OK);
    CHECK_MSG(!memcmp(texels[0], texels[1], slv_type_size(info->type) * info->nchannels),
              "%s: average of face %u", path, face);
    free(texels[0]);
    free(texels[1]);
}

static void rewrite(const char *path) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL, *again = NULL;
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    if (info->mesh_type == SLV_PTX_TRIANGLE || info->has_edits) {
        slv_ptx_close(ptx);
        return;
    }
    REQUIRE(slv_ptx_load_texture(&env, ptx, &texture) == SLV_OK);
    REQUIRE(slv_ptx_load_adjacency(&env, ptx, &adjacency) == SLV_OK);
    CHECK_MSG(slv_adjacency_cut_count(adjacency) == 0, "%s: links were cut", path);
    slv_ptx_meta *meta = calloc(info->nmeta + 1, sizeof *meta);
    for (uint32_t i = 0; i < info->nmeta; i++)
        meta[i] = *slv_ptx_get_meta(ptx, i);
    slv_ptx_write_params params = {.border_u = info->border_u,
                                   .border_v = info->border_v,
                                   .edge_filter = info->edge_filter,
                                   .no_reductions = info->nlevels == 1,
                                   .nmeta = info->nmeta,
                                   .meta = meta};
    const char *out = scratch_path("rewrite.ptx");
    REQUIRE(slv_ptx_save(&env, out, texture, adjacency, &params) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, out, &again) == SLV_OK);
    const slv_ptx_info *second = slv_ptx_get_info(again);
    CHECK(second->type == info->type && second->nchannels == info->nchannels &&
          second->alpha_channel == info->alpha_channel && second->nfaces == info->nfaces &&
          second->border_u == info->border_u && second->border_v == info->border_v &&
          second->edge_filter == info->edge_filter && second->nmeta == info->nmeta);
    CHECK_MSG(second->nlevels == info->nlevels, "%s: %u levels, then %u", path, info->nlevels,
              second->nlevels);
    for (uint32_t i = 0; i < info->nlevels && i < second->nlevels; i++)
        CHECK_MSG(info->level_faces[i] == second->level_faces[i], "%s: level %u", path, i);
    for (uint32_t i = 0; i < info->nmeta && i < second->nmeta; i++) {
        const slv_ptx_meta *wanted = slv_ptx_get_meta(ptx, i);
        const slv_ptx_meta *found = slv_ptx_find_meta(again, wanted->key);
        CHECK(found && found->type == wanted->type && found->count == wanted->count);
    }
    for (uint32_t face = 0; face < info->nfaces; face++)
        compare_face(path, ptx, again, face);
    free(meta);
    slv_ptx_close(ptx);
    slv_ptx_close(again);
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    remove(out);
}

/* The same through slv_ptx_rewrite, which takes triangles and edits as well. */
static void copy(const char *path) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL, *again = NULL;
    const char *out = scratch_path("copy.ptx");
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_rewrite(&env, ptx, out, NULL) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, out, &again) == SLV_OK);
    const slv_ptx_info *a = slv_ptx_get_info(ptx), *b = slv_ptx_get_info(again);
    CHECK(a->mesh_type == b->mesh_type && a->type == b->type && a->nchannels == b->nchannels &&
          a->alpha_channel == b->alpha_channel && a->nfaces == b->nfaces &&
          a->border_u == b->border_u && a->border_v == b->border_v &&
          a->edge_filter == b->edge_filter && a->nmeta == b->nmeta && !b->has_edits);
    for (uint32_t i = 0; i < a->nmeta; i++) {
        const slv_ptx_meta *wanted = slv_ptx_get_meta(ptx, i);
        const slv_ptx_meta *found = wanted ? slv_ptx_find_meta(again, wanted->key) : NULL;
        static const uint8_t sizes[] = {1, 1, 2, 4, 4, 8};
        CHECK(found && found->type == wanted->type && found->count == wanted->count &&
              !memcmp(found->values, wanted->values, wanted->count * sizes[wanted->type]));
    }
    if (!a->has_edits) {
        CHECK(a->nlevels == b->nlevels);
        for (uint32_t face = 0; face < a->nfaces; face++)
            compare_face(path, ptx, again, face);
        CHECK_MSG(b->file_bytes <= a->file_bytes + a->file_bytes / 20 + 64,
                  "%s: %llu bytes became %llu", path, (unsigned long long)a->file_bytes,
                  (unsigned long long)b->file_bytes);
    } else {
        /* stored reductions of edited faces are new */
        slv_texture *one = NULL, *two = NULL;
        REQUIRE(slv_ptx_load_texture(&env, ptx, &one) == SLV_OK);
        REQUIRE(slv_ptx_load_texture(&env, again, &two) == SLV_OK);
        for (uint32_t face = 0; face < a->nfaces; face++) {
            slv_res res = slv_texture_get_desc(one)->res[face];
            size_t pixel = slv_type_size(a->type) * a->nchannels;
            bool constant = slv_texture_is_constant(one, face);
            CHECK(!memcmp(slv_texture_texels(one, face), slv_texture_texels(two, face),
                          constant ? pixel : pixel << (res.u + res.v)));
        }
        slv_texture_destroy(one);
        slv_texture_destroy(two);
    }
    slv_ptx_close(ptx);
    slv_ptx_close(again);
    remove(out);
}

int main(void) {
    CHECK(each_sample(copy) > 0);
    CHECK(each_sample(rewrite) > 0);
    return test_end();
}
