/* A picture of each stage of what is painted, drawn as `selvage render` draws. */
#include "paint/paint.h"

#include "command/output.h"

/* The GPU's copy of what is shown, which follows it. */
static slv_result follow(const slv_env *env, record *r, easel *e) {
    slv_texture *texture;
    slv_result result = easel_texture(e, &texture);
    if (!result && r->texture && r->shown == texture)
        return slv_gl_texture_update(r->texture, env, NULL);
    const slv_strategy *strategy = slv_strategy_default();
    slv_gl_texture_params params = {.strategies = &strategy, .nstrategies = 1, .live = true};
    if (result)
        return result;
    /* numbers of an integer's are colours as a picture has them, though they are floats here */
    if (!e->session && slv_texture_get_desc(texture)->encoding == SLV_TEXTURE_AUTO)
        params.encoding = slv_type_encoding(e->writer.type);
    params.encoding = slv_texture_get_encoding(texture, params.encoding);
    r->file = (slv_image_params){.encoding = params.encoding == SLV_TEXTURE_DATA ? SLV_ENCODE_RAW
                                                                                 : SLV_ENCODE_SRGB};
    r->frame.alpha =
        slv_texture_get_desc(texture)->alpha_channel < 0 ? SLV_ALPHA_IGNORE : SLV_ALPHA_BLEND;
    slv_gl_texture_destroy(r->texture);
    r->texture = NULL;
    r->shown = texture;
    return slv_gl_texture_create(r->gl, env, texture, easel_adjacency(e), &params, &r->texture);
}

slv_result record_begin(const slv_env *env, record *r, easel *e) {
    const slv_mesh *mesh = e->session ? slv_session_mesh(e->session) : e->mesh;
    const slv_surface_params how = {.scheme = e->scheme, .boundary = e->boundary};
    slv_painter *painter = e->painter;
    float low[3], high[3];
    slv_result result = e->session ? slv_session_painter(e->session, &painter) : SLV_OK;
    if (result || (result = slv_surface_create(env, mesh, &how, &r->surface)) ||
        (result = slv_gl_create(env, SLV_GL_AUTO, &r->gl)))
        return result;
    slv_paint_surface_bounds(slv_painter_get_surface(painter), low, high);
    r->frame.camera = slv_camera_orbit(low, high, r->azimuth, r->elevation, r->fov,
                                       (float)r->frame.width / (float)r->frame.height);
    r->frame.msaa = 4;
    r->frame.strategy = slv_strategy_default();
    uint32_t segments =
        slv_tessellation_for(mesh, &r->frame.camera, r->frame.width, r->frame.height);
    return slv_gl_renderer_create(r->gl, env, mesh, r->surface, segments, &r->renderer);
}

slv_result record_picture(const slv_env *env, record *r, easel *e) {
    char path[FRAMES_PATH];
    slv_image image = {0};
    slv_result result = follow(env, r, e);
    if (result)
        return result;
    if (!frames_name(r->out, r->next++, path))
        return output_fail(env, SLV_ERROR_IO, "%s: its name is too long", r->out);
    if (!(result = slv_gl_renderer_draw(r->renderer, env, r->texture, &r->frame, &image, NULL)))
        result = slv_image_save(env, path, &image, &r->file);
    slv_image_free(&image);
    return result;
}

void record_end(record *r) {
    slv_gl_renderer_destroy(r->renderer);
    slv_gl_texture_destroy(r->texture);
    slv_surface_destroy(r->surface);
    slv_gl_destroy(r->gl);
}
