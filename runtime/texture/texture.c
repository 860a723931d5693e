/* The store: faces' texels in memory, and what was changed of them. */
#include "base/log.h"
#include "base/memory.h"
#include "texture/changes.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#define MAX_CHANNELS 65535 /* what a .ptx file can count */

struct slv_texture {
    slv_env env; /* its log is serialised: faces may be set by many threads at once */
    slv_parallel_log *log;
    slv_texture_desc desc;
    slv_res *res;
    size_t texel_size;
    uint64_t bytes;
    _Atomic uint64_t allocated;
    unsigned char *constants; /* one texel a face */
    unsigned char **texels;   /* NULL where the face is constant */
    unsigned char *together;  /* where texels of many faces are; NULL: each has its own piece */
    uint64_t ntogether;
    slv_changes *changes;
    uint64_t *versions; /* of each face's last change, for when `changes` has forgotten it */
};

bool slvi_texture_desc_same(const slv_texture_desc *a, const slv_texture_desc *b) {
    return a->nfaces == b->nfaces && a->type == b->type && a->nchannels == b->nchannels &&
           (!a->nfaces || memcmp(a->res, b->res, a->nfaces * sizeof *a->res) == 0);
}

static slv_result check_res(const slv_env *env, uint32_t face, slv_res res) {
    if (res.u < 0 || res.v < 0 || res.u > SLV_MAX_LOG2_RES || res.v > SLV_MAX_LOG2_RES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "texture: face %u: resolution 2^%d x 2^%d, expected exponents 0 to %d",
                         (unsigned)face, res.u, res.v, SLV_MAX_LOG2_RES);
    return SLV_OK;
}

slv_result slvi_texture_check_desc(const slv_env *env, const slv_texture_desc *desc,
                                   uint64_t *bytes) {
    if (!desc || (desc->nfaces && !desc->res))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: no description");
    if (!slv_type_size(desc->type))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: unknown type %d", (int)desc->type);
    if (desc->nchannels < 1 || desc->nchannels > MAX_CHANNELS)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: %u channels, expected 1 to %u",
                         (unsigned)desc->nchannels, (unsigned)MAX_CHANNELS);
    if (desc->alpha_channel != SLV_NO_ALPHA &&
        (desc->alpha_channel < 0 || (uint32_t)desc->alpha_channel >= desc->nchannels))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: alpha channel %d of %u channels",
                         (int)desc->alpha_channel, (unsigned)desc->nchannels);
    if ((unsigned)desc->encoding > SLV_TEXTURE_DATA)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: unknown encoding %d",
                         (int)desc->encoding);
    if (desc->nfaces > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "texture: %u faces, at most %d can be numbered",
                         (unsigned)desc->nfaces, INT32_MAX);
    uint64_t texel = slv_type_size(desc->type) * (uint64_t)desc->nchannels, total = 0;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        slv_res res = desc->res[face];
        slv_result result = check_res(env, face, res);
        if (result)
            return result;
        uint64_t size = texel * slv_res_texels(res);
        if (size > UINT64_MAX - total)
            return slvi_fail(env, SLV_ERROR_LIMIT,
                             "texture: face %u: more than 2^64 bytes of texels", (unsigned)face);
        total += size;
    }
    *bytes = total;
    return SLV_OK;
}

static slv_result create(const slv_env *env, const slv_texture_desc *desc, slv_texture **out) {
    slv_texture *texture = NULL;
    uint64_t bytes = 0;
    *out = NULL;
    slv_result result = slvi_texture_check_desc(env, desc, &bytes);
    if (result)
        return result;
    if ((result = slvi_alloc(env, "texture", 1, sizeof *texture, &texture)))
        return result;
    texture->desc = *desc;
    texture->bytes = bytes;
    texture->texel_size = slv_type_size(desc->type) * desc->nchannels;
    atomic_init(&texture->allocated, 0);
    if ((result = slvi_parallel_env_begin(env, &texture->log, &texture->env)))
        goto done;
    uint64_t n = desc->nfaces;
    if ((result = slvi_alloc(env, "texture resolutions", n, sizeof *texture->res, &texture->res)) ||
        (result = slvi_alloc(env, "texture faces", n, sizeof *texture->texels, &texture->texels)) ||
        (result =
             slvi_alloc(env, "constant texels", n, texture->texel_size, &texture->constants)) ||
        (result =
             slvi_alloc(env, "texture changes", 1, sizeof *texture->changes, &texture->changes)) ||
        (result =
             slvi_alloc(env, "texture changes", n, sizeof *texture->versions, &texture->versions)))
        goto done;
    slvi_changes_begin(texture->changes);
    if (n)
        memcpy(texture->res, desc->res, n * sizeof *texture->res);
    texture->desc.res = texture->res;
    *out = texture;
    texture = NULL;
done:
    slv_texture_destroy(texture);
    return result;
}

slv_result slv_texture_create(const slv_env *env, const slv_texture_desc *desc, slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, desc, out));
}

static void free_texels(slv_texture *texture, uint32_t face) {
    uintptr_t at = (uintptr_t)texture->texels[face], first = (uintptr_t)texture->together;
    if (at < first || at >= first + texture->ntogether)
        slvi_free(texture->texels[face]);
    texture->texels[face] = NULL;
}

void slv_texture_destroy(slv_texture *texture) {
    if (!texture)
        return;
    for (uint32_t face = 0; texture->texels && face < texture->desc.nfaces; face++)
        free_texels(texture, face);
    slvi_free(texture->together);
    slvi_free(texture->texels);
    slvi_free(texture->constants);
    slvi_free(texture->res);
    if (texture->changes)
        slvi_changes_end(texture->changes);
    slvi_free(texture->changes);
    slvi_free(texture->versions);
    slvi_parallel_env_end(texture->log);
    slvi_free(texture);
}

const slv_texture_desc *slv_texture_get_desc(const slv_texture *texture) {
    return &texture->desc;
}

uint64_t slv_texture_bytes(const slv_texture *texture) {
    return texture->bytes;
}

static slv_result check_number(const slv_texture *texture, uint32_t face) {
    return face < texture->desc.nfaces
               ? SLV_OK
               : slvi_fail(&texture->env, SLV_ERROR_ARGUMENT, "texture: face %u of %u",
                           (unsigned)face, (unsigned)texture->desc.nfaces);
}

static slv_result check_face(const slv_texture *texture, uint32_t face, const void *texels) {
    slv_result result = check_number(texture, face);
    if (result)
        return result;
    if (!texels)
        return slvi_fail(&texture->env, SLV_ERROR_ARGUMENT, "texture: face %u: no texels",
                         (unsigned)face);
    return SLV_OK;
}

static void make_constant(slv_texture *texture, uint32_t face, const void *texel) {
    memmove(texture->constants + face * texture->texel_size, texel, texture->texel_size);
    if (texture->texels[face]) {
        free_texels(texture, face);
        atomic_fetch_sub(&texture->allocated,
                         texture->texel_size * slv_res_texels(texture->res[face]));
    }
}

/* Room for all texels of a face that was constant; what is in it is undefined. */
static slv_result make_room(slv_texture *texture, uint32_t face) {
    uint64_t size = (uint64_t)texture->texel_size * slv_res_texels(texture->res[face]);
    uint64_t before = atomic_fetch_add(&texture->allocated, size);
    slv_result result;
    if (before > texture->env.max_bytes || size > texture->env.max_bytes - before)
        result = slvi_fail(&texture->env, SLV_ERROR_LIMIT,
                           "texture: face %u: %llu bytes more are over the limit of %llu",
                           (unsigned)face, (unsigned long long)size,
                           (unsigned long long)texture->env.max_bytes);
    else
        result =
            slvi_alloc_plain(&texture->env, "texels of a face", size, 1, &texture->texels[face]);
    if (result)
        atomic_fetch_sub(&texture->allocated, size);
    return result;
}

static void note_change(slv_texture *texture, uint32_t face, slv_rect rect, bool constancy) {
    texture->versions[face] = slvi_changes_add(texture->changes, face, rect, constancy);
}

slv_result slvi_texture_reserve(slv_texture *texture, const slv_texture *like) {
    uint64_t total = 0;
    for (uint32_t face = 0; face < texture->desc.nfaces; face++)
        if (like->texels[face])
            total += texture->texel_size * slv_res_texels(texture->res[face]);
    slv_result result = slvi_alloc_plain(&texture->env, "texels", total, 1, &texture->together);
    if (result)
        return result;
    unsigned char *next = texture->together;
    texture->ntogether = total;
    atomic_fetch_add(&texture->allocated, total);
    for (uint32_t face = 0; face < texture->desc.nfaces; face++) {
        if (!like->texels[face])
            continue;
        texture->texels[face] = next;
        next += texture->texel_size * slv_res_texels(texture->res[face]);
    }
    return SLV_OK;
}

static slv_rect whole_rect(slv_res res) {
    return (slv_rect){0, 0, 1u << res.u, 1u << res.v};
}

slv_result slv_texture_set_face(slv_texture *texture, uint32_t face, const void *texels) {
    slv_result result = check_face(texture, face, texels);
    if (result)
        return result;
    uint64_t count = slv_res_texels(texture->res[face]);
    bool was_constant = !texture->texels[face];
    bool constant = slvi_texels_equal(texels, texture->texel_size, count);
    if (constant)
        make_constant(texture, face, texels);
    else if (was_constant && (result = make_room(texture, face)))
        return result;
    else
        memmove(texture->texels[face], texels, count * texture->texel_size);
    note_change(texture, face, whole_rect(texture->res[face]), constant || was_constant);
    return SLV_OK;
}

/* Whether a rectangle that was set made all texels of its face the same. */
static bool became_constant(const slv_texture *texture, uint32_t face, slv_rect rect) {
    size_t size = texture->texel_size, pitch = size << texture->res[face].u;
    const unsigned char *texels = texture->texels[face],
                        *from = texels + rect.y * pitch + rect.x * size;
    /* most rectangles, and most faces that have one of a single colour, are told by these */
    if (memcmp(texels, from, size) != 0)
        return false;
    for (uint32_t y = 0; y < rect.height; y++)
        if (memcmp(from + y * pitch, from, size) != 0 ||
            !slvi_texels_equal(from + y * pitch, size, rect.width))
            return false;
    return slvi_texels_equal(texels, size, slv_res_texels(texture->res[face]));
}

slv_result slv_texture_fill_rect(slv_texture *texture, uint32_t face, slv_rect rect,
                                 slv_fill_rect fill, void *user) {
    slv_result result = check_number(texture, face);
    if (result)
        return result;
    slv_res res = texture->res[face];
    size_t size = texture->texel_size;
    if (!slvi_rect_is_within(rect, res))
        return slvi_fail(&texture->env, SLV_ERROR_ARGUMENT,
                         "texture: face %u: %u x %u texels at (%u, %u) do not lie within %u x %u",
                         (unsigned)face, (unsigned)rect.width, (unsigned)rect.height,
                         (unsigned)rect.x, (unsigned)rect.y, 1u << res.u, 1u << res.v);
    bool was_constant = !texture->texels[face];
    if (was_constant) {
        if ((result = make_room(texture, face)))
            return result;
        slvi_fill_texels(texture->texels[face], texture->constants + face * size, size,
                         slv_res_texels(res));
    }
    fill(user, texture->texels[face] + (((size_t)rect.y << res.u) + rect.x) * size,
         (size_t)1 << res.u);
    bool constant = became_constant(texture, face, rect);
    if (constant)
        make_constant(texture, face, texture->texels[face]);
    note_change(texture, face, rect, constant || was_constant);
    return SLV_OK;
}

struct copy {
    const unsigned char *texels;
    size_t size, row, rows; /* bytes of a texel, of a row, and how many rows */
};

static void copy_rect(void *user, void *texels, size_t pitch) {
    const struct copy *copy = user;
    for (size_t y = 0; y < copy->rows; y++)
        memcpy((unsigned char *)texels + y * pitch * copy->size, copy->texels + y * copy->row,
               copy->row);
}

slv_result slv_texture_set_rect(slv_texture *texture, uint32_t face, slv_rect rect,
                                const void *texels) {
    struct copy copy = {texels, texture->texel_size, rect.width * texture->texel_size, rect.height};
    slv_result result = check_face(texture, face, texels);
    if (result)
        return result;
    if (!texture->texels[face] && slvi_rect_is_within(rect, texture->res[face]) &&
        memcmp(texels, texture->constants + face * copy.size, copy.size) == 0 &&
        slvi_texels_equal(texels, copy.size, (uint64_t)rect.width * rect.height)) {
        note_change(texture, face, rect, true); /* and it needs no room */
        return SLV_OK;
    }
    return slv_texture_fill_rect(texture, face, rect, copy_rect, &copy);
}

slv_result slv_texture_set_constant(slv_texture *texture, uint32_t face, const void *texel) {
    slv_result result = check_face(texture, face, texel);
    if (result)
        return result;
    make_constant(texture, face, texel);
    note_change(texture, face, whole_rect(texture->res[face]), true);
    return SLV_OK;
}

slv_result slv_texture_set_resolution(slv_texture *texture, uint32_t face, slv_res res,
                                      const void *texels) {
    size_t size = texture->texel_size;
    unsigned char *before = NULL;
    slv_result result = check_face(texture, face, texels);
    if (result || (result = check_res(&texture->env, face, res)))
        return result;
    slv_res old = texture->res[face];
    bool constant = slvi_texels_equal(texels, size, slv_res_texels(res));
    if (!constant) {
        before = texture->texels[face];
        texture->res[face] = res;
        if ((result = make_room(texture, face))) {
            texture->texels[face] = before;
            texture->res[face] = old;
            return result;
        }
        memcpy(texture->texels[face], texels, slv_res_texels(res) * size);
    }
    unsigned char *made = texture->texels[face];
    texture->res[face] = old;
    texture->texels[face] = constant ? made : before;
    make_constant(texture, face, texels); /* gives back what there was */
    texture->texels[face] = constant ? NULL : made;
    texture->res[face] = res;
    texture->bytes = texture->bytes - slv_res_texels(old) * size + slv_res_texels(res) * size;
    note_change(texture, face, whole_rect(res), true);
    return SLV_OK;
}

bool slv_texture_is_constant(const slv_texture *texture, uint32_t face) {
    assert(face < texture->desc.nfaces);
    return !texture->texels[face];
}

const void *slv_texture_texels(const slv_texture *texture, uint32_t face) {
    assert(face < texture->desc.nfaces);
    return texture->texels[face] ? texture->texels[face]
                                 : texture->constants + face * texture->texel_size;
}

void slv_texture_fetch(const slv_texture *texture, uint32_t face, uint32_t x, uint32_t y,
                       float *out) {
    const unsigned char *texels = slv_texture_texels(texture, face);
    assert(x >> texture->res[face].u == 0 && y >> texture->res[face].v == 0);
    if (texture->texels[face])
        texels += (((size_t)y << texture->res[face].u) + x) * texture->texel_size;
    slv_type_to_float(texture->desc.type, texels, texture->desc.nchannels, out);
}

uint64_t slv_texture_version(const slv_texture *texture) {
    return slvi_changes_version(texture->changes);
}

slv_result slvi_texture_visit_changes(const slv_texture *texture, uint64_t since,
                                      slvi_visit_change visit, void *user) {
    slv_change changes[CHANGES_KEPT];
    slv_result result = SLV_OK;
    uint32_t count = slvi_changes_since(texture->changes, since, changes);
    bool known = count != UINT32_MAX;
    for (uint32_t i = 0; known && !result && i < count; i++) {
        slv_res res = texture->res[changes[i].face];
        /* that of a resolution which the face has no longer */
        bool gone = !slvi_rect_is_within(changes[i].rect, res);
        result = visit(user, changes[i].face, gone ? whole_rect(res) : changes[i].rect,
                       changes[i].constancy);
    }
    for (uint32_t face = 0; !known && !result && face < texture->desc.nfaces; face++)
        if (!since || texture->versions[face] > since)
            result = visit(user, face, whole_rect(texture->res[face]), true);
    return result;
}

struct plain_visit {
    slv_visit_rect visit;
    void *user;
};

static slv_result visit_plain(void *user, uint32_t face, slv_rect rect, bool constancy) {
    const struct plain_visit *plain = user;
    (void)constancy;
    return plain->visit(plain->user, face, rect);
}

slv_result slv_texture_changed(const slv_texture *texture, uint64_t since, slv_visit_rect visit,
                               void *user) {
    struct plain_visit plain = {visit, user};
    return slvi_texture_visit_changes(texture, since, visit_plain, &plain);
}
