/* Common batches of several textures: faces sorted by the batch that each texture has them in. */
#include "base/log.h"
#include "base/memory.h"
#include "gl/store/texture.h"

#include <selvage/gl_material.h>

#include <string.h>

enum { STORAGE_BINDINGS = 4 };

struct slv_gl_material {
    slv_gl_lookup lookups[SLV_GL_MAX_LOOKUPS];
    uint64_t serials[SLV_GL_MAX_LOOKUPS]; /* of the textures whose batches are listed */
    uint32_t nlookups, nfaces;
    uint32_t *faces;              /* of all common batches, one after the other */
    slv_gl_common_batch *batches; /* whose faces they are */
    uint32_t nbatches;
};

static bool overlap(uint32_t a, uint32_t na, uint32_t b, uint32_t nb) {
    return na && nb && a < b + nb && b < a + na;
}

static uint32_t units(const slv_gl_lookup *lookup) {
    return slvi_gl_slot_units(lookup->texture,
                              slvi_gl_texture_slot(lookup->texture, lookup->strategy));
}

static slv_result check_pair(const slv_env *env, const slv_gl_lookup *a, const slv_gl_lookup *b) {
    const slv_gl_texture_params *p = &a->texture->params, *q = &b->texture->params;
    if (a->texture->nfaces != b->texture->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "a material of textures with %u and %u faces",
                         a->texture->nfaces, b->texture->nfaces);
    if (overlap(p->first_unit, units(a), q->first_unit, units(b)))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "textures of a material share texture units, from %u and from %u on",
                         p->first_unit, q->first_unit);
    if (overlap(p->first_storage, STORAGE_BINDINGS, q->first_storage, STORAGE_BINDINGS))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "textures of a material share storage bindings, from %u and from %u on",
                         p->first_storage, q->first_storage);
    return SLV_OK;
}

static slv_result check_lookups(const slv_env *env, slv_gl_material *m) {
    slv_result result = SLV_OK;
    for (uint32_t k = 0; !result && k < m->nlookups; k++) {
        slv_gl_slot *slot = NULL;
        slv_gl_lookup *lookup = &m->lookups[k];
        if ((result = slvi_gl_texture_need(lookup->texture, env, lookup->strategy, &slot)))
            return result;
        lookup->strategy = slot->strategy;
        for (uint32_t i = 0; !result && i < k; i++)
            result = check_pair(env, &m->lookups[i], lookup);
    }
    return result;
}

/* Faces sorted by the batch that one texture has them in, otherwise in the order that they had. */
static slv_result sort_faces(const slv_env *env, const slv_gl_batches *batches,
                             const uint32_t *batch_of, uint32_t nfaces, const uint32_t *faces,
                             uint32_t *out) {
    uint32_t *next = NULL;
    slv_result result = slvi_alloc(env, "batches", batches->count, sizeof *next, &next);
    for (uint32_t b = 0; !result && b < batches->count; b++)
        next[b] = batches->ranges[b].first;
    for (uint32_t i = 0; !result && i < nfaces; i++)
        out[next[batch_of[faces[i]]]++] = faces[i];
    slvi_free(next);
    return result;
}

/* Whether a face is in other batches than the one before it. */
static bool begins(const slv_gl_material *m, uint32_t *const *batch_of, uint32_t i) {
    bool differs = i == 0;
    for (uint32_t k = 0; k < m->nlookups && !differs; k++)
        differs = batch_of[k][m->faces[i]] != batch_of[k][m->faces[i - 1]];
    return differs;
}

static slv_result cut(const slv_env *env, slv_gl_material *m, uint32_t *const *batch_of) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < m->nfaces; i++)
        count += begins(m, batch_of, i);
    slv_result result = slvi_alloc(env, "batches", count, sizeof *m->batches, &m->batches);
    for (uint32_t i = 0; !result && i < m->nfaces; i++) {
        if (begins(m, batch_of, i)) {
            slv_gl_common_batch *batch = &m->batches[m->nbatches++];
            batch->faces = m->faces + i;
            for (uint32_t k = 0; k < m->nlookups; k++) {
                const slv_gl_lookup *of = &m->lookups[k];
                batch->batches[k] = batch_of[k][m->faces[i]];
                batch->variants[k] = slvi_gl_texture_batches(of->texture, of->strategy)
                                         ->ranges[batch->batches[k]]
                                         .variant;
            }
        }
        m->batches[m->nbatches - 1].nfaces++;
    }
    return result;
}

static void forget(slv_gl_material *m) {
    slvi_free(m->faces);
    slvi_free(m->batches);
    m->faces = NULL;
    m->batches = NULL;
    m->nbatches = 0;
}

/* Sorts by the last texture's batches first, and by those of the first one last. */
static slv_result list_batches(const slv_env *env, slv_gl_material *m) {
    uint32_t *batch_of[SLV_GL_MAX_LOOKUPS] = {NULL}, *spare = NULL, n = m->nfaces;
    slv_result result;
    forget(m);
    if ((result = slvi_alloc(env, "faces", n, sizeof *m->faces, &m->faces)) ||
        (result = slvi_alloc(env, "faces", n, sizeof *spare, &spare)))
        goto done;
    for (uint32_t f = 0; f < n; f++)
        spare[f] = f;
    for (uint32_t k = m->nlookups; k--;) {
        const slv_gl_lookup *of = &m->lookups[k];
        const slv_gl_batches *batches = slvi_gl_texture_batches(of->texture, of->strategy);
        if (n && !batches->count) {
            result = slvi_fail(env, SLV_ERROR_ARGUMENT,
                               "a texture of a material has no batches since its update failed");
            goto done;
        }
        if ((result = slvi_alloc(env, "batches", n, sizeof *batch_of[k], &batch_of[k])))
            goto done;
        for (uint32_t b = 0; b < batches->count; b++)
            for (uint32_t i = 0; i < batches->ranges[b].count; i++)
                batch_of[k][batches->faces[batches->ranges[b].first + i]] = b;
        if ((result = sort_faces(env, batches, batch_of[k], n, spare, m->faces)))
            goto done;
        memcpy(spare, m->faces, n * sizeof *spare);
        m->serials[k] = of->texture->serial;
    }
    result = cut(env, m, batch_of);
done:
    for (uint32_t k = 0; k < m->nlookups; k++)
        slvi_free(batch_of[k]);
    slvi_free(spare);
    if (result)
        forget(m);
    return result;
}

slv_result slv_gl_material_create(const slv_env *env, const slv_gl_lookup *lookups, uint32_t count,
                                  slv_gl_material **out) {
    slv_gl_material *made = NULL;
    slv_result result;
    *out = NULL;
    if (!count || count > SLV_GL_MAX_LOOKUPS)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "a material of %u textures: 1 to %d can be",
                         count, SLV_GL_MAX_LOOKUPS);
    if ((result = slvi_alloc(env, "material", 1, sizeof *made, &made)))
        return result;
    memcpy(made->lookups, lookups, count * sizeof *lookups);
    made->nlookups = count;
    made->nfaces = lookups[0].texture->nfaces;
    if ((result = check_lookups(env, made)) || (result = slv_gl_material_update(made, env, NULL))) {
        slv_gl_material_destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

void slv_gl_material_destroy(slv_gl_material *material) {
    if (!material)
        return;
    forget(material);
    slvi_free(material);
}

slv_result slv_gl_material_update(slv_gl_material *material, const slv_env *env, bool *changed) {
    bool other = !material->faces;
    slv_result result = SLV_OK;
    for (uint32_t k = 0; !result && k < material->nlookups; k++) {
        const slv_gl_texture *texture = material->lookups[k].texture;
        result = slvi_gl_texture_need_ready(texture, env);
        other |= texture->serial != material->serials[k];
    }
    if (!result && other)
        result = list_batches(env, material);
    if (changed)
        *changed = other;
    return result;
}

uint32_t slv_gl_material_batch_count(const slv_gl_material *material) {
    return material->nbatches;
}

slv_gl_common_batch slv_gl_material_batch(const slv_gl_material *material, uint32_t index) {
    static const slv_gl_common_batch none;
    return index < material->nbatches ? material->batches[index] : none;
}

void slv_gl_material_bind(const slv_gl_material *material, uint32_t index) {
    for (uint32_t k = 0; k < material->nlookups && index < material->nbatches; k++)
        slv_gl_texture_bind(material->lookups[k].texture, material->lookups[k].strategy,
                            material->batches[index].batches[k]);
}

void slv_gl_material_unbind(const slv_gl_material *material) {
    for (uint32_t k = 0; k < material->nlookups; k++)
        slv_gl_texture_unbind(material->lookups[k].texture);
}
