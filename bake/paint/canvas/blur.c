/* Blur: each texel towards what a filtered lookup of the canvas gives there, across every seam. The
 * canvas is looked up as a source behind a small cache, which the painter keeps. */
#include "canvas/lay_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/canvas.h>
#include <selvage/filter.h>

#include <string.h>

/* Lookups at a time. */
enum { BATCH = 256 };

struct slvi_blur {
    slv_env env;
    slv_canvas canvas;
    slv_canvas_desc desc; /* with a copy of its resolutions */
    slv_res *res;
    const slv_adjacency *adjacency;
    slv_cache *cache;
    slv_file_id file;
    slv_sampler *sampler;
};

static slv_result describe(void *user, slv_source_desc *out) {
    const struct slvi_blur *b = user;
    *out = (slv_source_desc){.name = "canvas",
                             .nfaces = b->desc.nfaces,
                             .type = SLV_TYPE_FLOAT,
                             .nchannels = b->desc.nchannels,
                             .alpha_channel = b->desc.alpha_channel};
    return SLV_OK;
}

static slv_result get_face(void *user, uint32_t face, slv_source_face *out) {
    const struct slvi_blur *b = user;
    if (face >= b->desc.nfaces)
        return slvi_fail(&b->env, SLV_ERROR_ARGUMENT, "canvas: face %u of %u", (unsigned)face,
                         (unsigned)b->desc.nfaces);
    *out = (slv_source_face){.res = b->desc.res[face],
                             .adjacency = slv_adjacency_faces(b->adjacency)[face]};
    if (slv_adjacency_is_subface(b->adjacency, (int32_t)face))
        out->flags |= SLV_FACE_SUBFACE;
    return SLV_OK;
}

static const slv_source_fns source_fns;

static slv_result read_rect(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    const struct slvi_blur *b = user;
    const slv_source source = {&source_fns, user};
    slv_source_face f;
    slv_result result = slv_source_check(&b->env, &source, face, res, rect, &f);
    if (result)
        return result;
    if (res.u == f.res.u && res.v == f.res.v)
        return b->canvas.fns->read(b->canvas.user, face, rect, out);
    return slv_source_reduce(&b->env, &source, face, res, rect, out);
}

static const slv_source_fns source_fns = {
    .describe = describe, .face = get_face, .read = read_rect};

static void destroy_blur(struct slvi_blur *blur) {
    if (!blur)
        return;
    slv_sampler_destroy(blur->sampler);
    slv_cache_destroy(blur->cache);
    slvi_free(blur->res);
    slvi_free(blur);
}

static slv_result make_blur(slv_painter *p, const slv_canvas *canvas, const slv_canvas_desc *desc) {
    const slv_filter_params filter = {.filter = SLV_FILTER_ANISOTROPIC};
    struct slvi_blur *b = NULL;
    slv_result result = slvi_alloc(&p->env, "blur", 1, sizeof *b, &b);
    if (result)
        return result;
    b->env = p->env;
    b->canvas = *canvas;
    b->desc = *desc;
    b->adjacency = p->surface->adjacency;
    if ((result = slvi_alloc(&p->env, "blur", desc->nfaces, sizeof *b->res, &b->res))) {
        destroy_blur(b);
        return result;
    }
    memcpy(b->res, desc->res, desc->nfaces * sizeof *b->res);
    b->desc.res = b->res;
    const slv_source source = {&source_fns, b};
    const slv_cache_params small = {.max_bytes = UINT64_C(32) << 20};
    if ((result = slv_cache_create(&p->env, &small, &b->cache)) ||
        (result = slv_cache_open_source(b->cache, &source, NULL, &b->file)) ||
        (result = slv_sampler_create(b->cache, &filter, &b->sampler))) {
        destroy_blur(b);
        return result;
    }
    destroy_blur(p->blur);
    p->blur = b;
    p->end_blur = destroy_blur;
    return SLV_OK;
}

/* The values of a patch's texels: lookups with a footprint of `width` mesh units. */
static slv_result look_up(const slv_painter *p, const slv_patch *patch, float width, float *out) {
    const struct slvi_blur *b = p->blur;
    slv_lookup lookups[BATCH];
    const float *sides = p->surface->sides + 3 * (size_t)patch->face;
    uint64_t count = (uint64_t)patch->rect.width * patch->rect.height;
    slv_res res = b->desc.res[patch->face];
    float u = sides[0] > 0 ? width / sides[0] : 0, v = sides[1] > 0 ? width / sides[1] : 0;
    size_t n;
    for (uint64_t done = 0; done < count; done += n) {
        for (n = 0; n < BATCH && done + n < count; n++) {
            uint32_t x = patch->rect.x + (uint32_t)((done + n) % patch->rect.width),
                     y = patch->rect.y + (uint32_t)((done + n) / patch->rect.width);
            lookups[n] = (slv_lookup){.file = b->file,
                                      .face = patch->face,
                                      .u = ldexpf((float)x + 0.5f, -res.u),
                                      .v = ldexpf((float)y + 0.5f, -res.v),
                                      .uw1 = u,
                                      .vw2 = v};
        }
        slv_result result = slv_sample_batch(b->sampler, lookups, n, out + done * b->desc.nchannels,
                                             b->desc.nchannels, NULL);
        if (result)
            return result;
    }
    return SLV_OK;
}

/* A patch's texels towards the values looked up. */
static slv_result mix(const slv_painter *p, const slv_canvas *canvas, const slv_patch *patch,
                      float opacity, const float *values, float *texels) {
    uint32_t n = p->blur->desc.nchannels;
    uint64_t count = (uint64_t)patch->rect.width * patch->rect.height;
    slv_result result = canvas->fns->read(canvas->user, patch->face, patch->rect, texels);
    if (result)
        return result;
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < n; c++)
            texels[i * n + c] +=
                patch->coverage[i] * opacity * (values[i * n + c] - texels[i * n + c]);
    return canvas->fns->write(canvas->user, patch->face, patch->rect, texels);
}

/* Whether a blur is of this canvas, whose resolutions may have changed. */
static bool is_of(const struct slvi_blur *b, const slv_canvas *canvas,
                  const slv_canvas_desc *desc) {
    return b && b->canvas.user == canvas->user && b->canvas.fns == canvas->fns &&
           b->desc.nfaces == desc->nfaces && b->desc.nchannels == desc->nchannels &&
           b->desc.alpha_channel == desc->alpha_channel &&
           memcmp(b->res, desc->res, desc->nfaces * sizeof *b->res) == 0;
}

slv_result slvi_painter_watch(slv_painter *p, const slv_canvas *canvas,
                              const slv_canvas_desc *desc) {
    if (desc->nfaces != p->surface->nfaces)
        return slvi_fail(&p->env, SLV_ERROR_MISMATCH, "canvas: %u faces on a surface of %u",
                         (unsigned)desc->nfaces, (unsigned)p->surface->nfaces);
    if (!is_of(p->blur, canvas, desc))
        return make_blur(p, canvas, desc);
    /* what it knows may have been painted over */
    return slv_cache_invalidate(p->blur->cache, p->blur->file);
}

slv_result slvi_painter_look_up(const slv_painter *p, uint32_t count, const slv_surface_point *at,
                                float width, float *out) {
    const struct slvi_blur *b = p->blur;
    slv_lookup lookups[BATCH];
    for (uint32_t done = 0, n; done < count; done += n) {
        for (n = 0; n < BATCH && done + n < count; n++) {
            const slv_surface_point *a = &at[done + n];
            const float *sides = p->surface->sides + 3 * (size_t)a->face;
            lookups[n] = (slv_lookup){.file = b->file,
                                      .face = (uint32_t)a->face,
                                      .u = a->u,
                                      .v = a->v,
                                      .uw1 = sides[0] > 0 ? width / sides[0] : 0,
                                      .vw2 = sides[1] > 0 ? width / sides[1] : 0};
        }
        slv_result result =
            slv_sample_batch(b->sampler, lookups, n, out + (uint64_t)done * b->desc.nchannels,
                             b->desc.nchannels, NULL);
        if (result)
            return result;
    }
    return SLV_OK;
}

slv_result slv_painter_blur(slv_painter *painter, const slv_canvas *canvas,
                            const slv_patches *patches, float width, float opacity) {
    slv_painter *p = painter;
    slv_canvas_desc desc;
    uint64_t total = 0, largest = 0;
    slv_result result = canvas->fns->describe(canvas->user, &desc);
    if (result)
        return result;
    if (!(width >= 0) || !isfinite(width) || !(opacity >= 0 && opacity <= 1))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "blur: a width of %g, an opacity of %g",
                         (double)width, (double)opacity);
    result = slvi_painter_watch(p, canvas, &desc);
    for (uint32_t i = 0; i < patches->count; i++) {
        uint64_t n = (uint64_t)patches->list[i].rect.width * patches->list[i].rect.height;
        total += n;
        largest = n > largest ? n : largest;
    }
    if (!result)
        result = slvi_painter_room(p, (total + largest) * desc.nchannels + 1, sizeof *p->texels,
                                   &p->texels, &p->texel_room);
    /* all is looked up before any of it changes */
    float *at = p->texels;
    for (uint32_t i = 0; i < patches->count && !result; i++) {
        result = look_up(p, &patches->list[i], width, at);
        at += (uint64_t)patches->list[i].rect.width * patches->list[i].rect.height * desc.nchannels;
    }
    if (!result && canvas->fns->begin && patches->count)
        result = canvas->fns->begin(canvas->user, patches);
    float *room = at;
    at = p->texels;
    for (uint32_t i = 0; i < patches->count && !result; i++) {
        result = mix(p, canvas, &patches->list[i], opacity, at, room);
        at += (uint64_t)patches->list[i].rect.width * patches->list[i].rect.height * desc.nchannels;
    }
    return result;
}
