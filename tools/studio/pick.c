/* What lies at a place of the picture: on the surface as it is shown, moved by what displaces it or
 * not. */
#include "studio/document.h"

#include <math.h>
#include <stdlib.h>

/* A surface that is moved is picked on as many cells as are made in a moment. */
enum { MOST_CELLS = 1 << 17, MOST_SEGMENTS = 128 };

static slv_result make_moved(studio_document *d) {
    const slv_mesh *mesh = studio_document_mesh(d);
    slv_paint_surface_params params = {.scheme = studio_document_scheme(d),
                                       .segments = 2,
                                       .displacement = studio_document_displacement(d)};
    while (params.segments < MOST_SEGMENTS &&
           4 * (uint64_t)params.segments * params.segments * slv_mesh_face_count(mesh) <=
               MOST_CELLS)
        params.segments *= 2;
    slv_result result = slv_paint_surface_create(&d->env, mesh, &params, &d->moved);
    return result ? result : slv_painter_create(&d->env, d->moved, &d->moved_painter);
}

void studio_document_forget_moved(studio_document *d) {
    slv_painter_destroy(d->moved_painter);
    slv_paint_surface_destroy(d->moved);
    d->moved_painter = NULL;
    d->moved = NULL;
}

/* As it is without what displaces it; NULL: want of memory. */
static const slv_paint_surface *surface_of(studio_document *d) {
    const slv_paint_surface_params params = {.scheme = studio_document_scheme(d)};
    const slv_paint_surface *surface = d->surface;
    slv_painter *painter;
    if (d->session && !slv_session_painter(d->session, &painter))
        surface = slv_painter_get_surface(painter);
    else if (!d->session && !surface && d->scene.mesh &&
             !slv_paint_surface_create(&d->env, d->scene.mesh, &params, &d->surface))
        surface = d->surface;
    return surface;
}

static slv_result shown_painter(studio_document *d, slv_painter **out) {
    if (!studio_document_displacement(d))
        return slv_session_painter(d->session, out);
    slv_result result = d->moved_painter ? SLV_OK : make_moved(d);
    if (result)
        studio_document_forget_moved(d);
    *out = d->moved_painter;
    return result;
}

static const slv_paint_surface *shown_surface(studio_document *d) {
    slv_painter *painter;
    if (!studio_document_displacement(d))
        return surface_of(d);
    return shown_painter(d, &painter) ? NULL : slv_painter_get_surface(painter);
}

float studio_document_density(studio_document *d, uint32_t face) {
    const slv_paint_surface *surface = surface_of(d);
    float area = surface ? slv_paint_surface_texel_area(surface, face,
                                                        slv_texture_get_desc(d->texture)->res[face])
                         : 0;
    return area > 0 ? 1 / sqrtf(area) : 0;
}

bool studio_document_pick(studio_document *d, const slv_camera *camera, uint32_t width,
                          uint32_t height, float x, float y, slv_paint_hit *out) {
    const slv_paint_surface *surface = shown_surface(d);
    float origin[3], direction[3];
    return surface &&
           slv_paint_surface_ray(surface, camera, width, height, x, y, origin, direction) &&
           slv_paint_surface_hit(surface, origin, direction, out);
}

bool studio_document_place(studio_document *d, slv_surface_point point, float out[3]) {
    const slv_paint_surface *surface = surface_of(d);
    return surface && slv_paint_surface_at(surface, point, out, NULL, NULL);
}

/* Asked for few texels: which faces there are is all that is wanted. */
slv_result studio_document_cover(studio_document *d, const slv_screen_dab *dab, uint8_t *touched) {
    enum { SIZE = 3 };
    const slv_document *layers = slv_session_document(d->session);
    const uint32_t nfaces = slv_document_get_desc(layers)->nfaces;
    slv_res *res = malloc(nfaces * sizeof *res + 1);
    slv_painter *painter;
    slv_patches patches;
    slv_result result = res ? shown_painter(d, &painter) : SLV_ERROR_MEMORY;
    for (uint32_t f = 0; res && f < nfaces; f++)
        res[f] = (slv_res){SIZE, SIZE};
    if (!result)
        result = slv_painter_cover_screen(painter, res, dab, &patches);
    for (uint32_t i = 0; !result && i < patches.count; i++) {
        const slv_patch *patch = &patches.list[i];
        const uint32_t ntexels = patch->rect.width * patch->rect.height;
        for (uint32_t t = 0; t < ntexels; t++)
            if (patch->coverage[t] > 0 && slv_document_selected(layers, patch->face))
                touched[patch->face] = 1;
    }
    free(res);
    return result;
}
