/* Whether a file is sound, and whether two hold the same. */
#ifndef SLV_PTX_SAME_H
#define SLV_PTX_SAME_H

#include "kit/ptx_kit.h"

#include <selvage/ptx_check.h>
#include <selvage/ptx_diff.h>

/* The number of findings, warnings as well; says the first if there are any. */
static inline uint64_t count_findings(const char *path, char *first, size_t size) {
    slv_env env = test_env();
    slv_ptx_report *report = NULL;
    uint64_t count = 0;
    first[0] = 0;
    REQUIRE(!slv_ptx_check(&env, path, NULL, &report));
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++)
        count += report->counts[kind];
    if (report->nfindings)
        snprintf(first, size, "%s", report->findings[0].message);
    slv_ptx_report_destroy(report);
    return count;
}

static inline void same_meta(const slv_ptx *a, const slv_ptx *b, const char *path) {
    static const size_t sizes[] = {1, 1, 2, 4, 4, 8};
    uint32_t count = slv_ptx_get_info(a)->nmeta;
    CHECK_MSG(count == slv_ptx_get_info(b)->nmeta, "%s: entries of metadata", path);
    for (uint32_t i = 0; i < count; i++) {
        const slv_ptx_meta *x = slv_ptx_get_meta(a, i), *y = slv_ptx_find_meta(b, x->key);
        CHECK_MSG(y && x->type == y->type && x->count == y->count &&
                      memcmp(x->values, y->values, x->count * sizes[x->type]) == 0,
                  "%s: metadata %s", path, x->key);
    }
}

/* Headers, metadata, faces, and every texel at every resolution that halving both sides leads to:
 * bit for bit. */
static inline void same_content(const char *one, const char *two) {
    slv_env env = test_env();
    slv_ptx *a = NULL, *b = NULL;
    REQUIRE(!slv_ptx_open(&env, one, &a) && !slv_ptx_open(&env, two, &b));
    const slv_ptx_info *x = slv_ptx_get_info(a), *y = slv_ptx_get_info(b);
    CHECK_MSG(x->mesh_type == y->mesh_type && x->type == y->type && x->nchannels == y->nchannels &&
                  x->alpha_channel == y->alpha_channel && x->border_u == y->border_u &&
                  x->border_v == y->border_v && x->edge_filter == y->edge_filter,
              "%s: header", one);
    CHECK_MSG((x->nlevels > 1) == (y->nlevels > 1), "%s: reductions", one);
    REQUIRE(x->nfaces == y->nfaces);
    same_meta(a, b, one);
    size_t pixel = slv_type_size(x->type) * x->nchannels;
    uint32_t different = 0;
    for (uint32_t face = 0; face < x->nfaces; face++) {
        slv_ptx_face f, g;
        REQUIRE(!slv_ptx_get_face(a, face, &f) && !slv_ptx_get_face(b, face, &g));
        bool same = f.res.u == g.res.u && f.res.v == g.res.v &&
                    !((f.flags ^ g.flags) & (SLV_FACE_SUBFACE | SLV_FACE_CONSTANT));
        for (int edge = 0; edge < 4; edge++)
            same &=
                f.adjacency.face[edge] == g.adjacency.face[edge] &&
                (f.adjacency.face[edge] < 0 || f.adjacency.edge[edge] == g.adjacency.edge[edge]);
        /* an edited face has no stored reductions, so that its smaller ones may be other */
        bool edited = f.flags & SLV_FACE_EDITED;
        for (int level = 0; same && level <= f.res.u && level <= f.res.v; level++) {
            slv_res res = {(int8_t)(f.res.u - level), (int8_t)(f.res.v - level)};
            size_t bytes = pixel << (res.u + res.v);
            void *texels[2] = {malloc(bytes), malloc(bytes)};
            same = !slv_ptx_read_face(a, face, res, texels[0]) &&
                   !slv_ptx_read_face(b, face, res, texels[1]) &&
                   memcmp(texels[0], texels[1], bytes) == 0;
            free(texels[0]);
            free(texels[1]);
            if (edited)
                break;
        }
        different += !same;
    }
    CHECK_MSG(different == 0, "%s: %u of %u faces", one, different, x->nfaces);
    slv_face_diff *diff = calloc((size_t)x->nfaces + 1, sizeof *diff);
    REQUIRE(!slv_ptx_diff(&env, a, b, NULL, diff));
    for (uint32_t face = different = 0; face < x->nfaces; face++)
        different += diff[face].what != 0;
    CHECK_MSG(different == 0, "%s: %u faces by diff", one, different);
    free(diff);
    slv_ptx_close(a);
    slv_ptx_close(b);
}

#endif
