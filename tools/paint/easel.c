/* What is painted on: a .ptx or a mesh as a texture of floats, or a session. */
#include "paint/paint.h"

#include "command/output.h"
#include "command/ptx_name.h"

#include <selvage/blank.h>

#include <stdlib.h>
#include <string.h>

#define BLANK_FILL 0.7529412f /* #c0c0c0 */

/* The texels of a face as floats. */
static slv_result load_face(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                            void *texels) {
    easel *e = user;
    bool constant = (info->flags & SLV_FACE_CONSTANT) != 0;
    size_t count = (size_t)e->writer.nchannels << (constant ? 0 : info->res.u + info->res.v);
    float *values = malloc(count * sizeof *values);
    if (!values)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its texels", e->name,
                           face);
    slv_type_to_float(e->writer.type, texels, count, values);
    slv_result result = constant ? slv_texture_set_constant(e->texture, face, values)
                                 : slv_texture_set_face(e->texture, face, values);
    free(values);
    return result;
}

/* The mesh of a .ptx of quads. */
static slv_result open_ptx(const slv_env *env, easel *e) {
    slv_result result = slv_ptx_open(env, e->name, &e->ptx);
    if (result)
        return result;
    if (slv_ptx_get_info(e->ptx)->mesh_type != SLV_PTX_QUAD)
        return output_fail(env, SLV_ERROR_UNSUPPORTED, "%s: is of triangles: quads are painted on",
                           e->name);
    result = e->mesh_path ? slv_mesh_load(env, cli_input(e->mesh_path), &e->mesh)
                          : scene_load_geometry(env, e->ptx, "--mesh FILE.obj", &e->mesh);
    return result || !e->mesh_path ? result : slv_ptx_match_mesh(env, e->ptx, e->mesh);
}

static slv_result load_ptx(const slv_env *env, easel *e) {
    slv_result result = open_ptx(env, e);
    if (result)
        return result;
    const slv_ptx_info *info = slv_ptx_get_info(e->ptx);
    e->writer = slv_ptx_writer_params_like(e->ptx);
    slv_res *res = calloc((size_t)info->nfaces + 1, sizeof *res);
    if (!res)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", e->name,
                           info->nfaces);
    for (uint32_t face = 0; face < info->nfaces && !result; face++) {
        slv_ptx_face f;
        if (!(result = slv_ptx_get_face(e->ptx, face, &f)))
            res[face] = f.res;
    }
    slv_texture_desc desc = {.nfaces = info->nfaces,
                             .type = SLV_TYPE_FLOAT,
                             .nchannels = info->nchannels,
                             .alpha_channel = info->alpha_channel,
                             .res = res};
    if (!result && !(result = slv_ptx_get_encoding(e->ptx, &desc.encoding)) &&
        !(result = slv_texture_create(env, &desc, &e->texture)))
        result = slv_ptx_visit_faces(env, e->ptx, load_face, e);
    free(res);
    return result;
}

static slv_result load_mesh(const slv_env *env, easel *e, slv_type type) {
    static const float fill[3] = {BLANK_FILL, BLANK_FILL, BLANK_FILL};
    const slv_blank_params params = {.type = type, .fill = fill, .scheme = e->scheme};
    slv_result result = slv_mesh_load(env, cli_input(e->name), &e->mesh);
    if (result || (result = slv_blank_create(env, e->mesh, &params, &e->texture, NULL)))
        return result;
    e->writer = (slv_ptx_writer_params){.mesh_type = SLV_PTX_QUAD,
                                        .type = SLV_TYPE_U8,
                                        .nchannels = 3,
                                        .alpha_channel = SLV_NO_ALPHA,
                                        .nfaces = slv_mesh_face_count(e->mesh)};
    return SLV_OK;
}

slv_result easel_open(const slv_env *env, easel *e) {
    const slv_paint_surface_params how = {.scheme = e->scheme, .boundary = e->boundary};
    const slv_env own = line_log_begin(&e->log, env, NULL);
    slv_result result =
        ptx_name_is_safe(e->name) ? load_ptx(&own, e) : load_mesh(&own, e, SLV_TYPE_FLOAT);
    if (!result && !(result = slv_paint_surface_create(&own, e->mesh, &how, &e->surface)))
        result = slv_painter_create(&own, e->surface, &e->painter);
    return result;
}

static void choose_layer(easel *e, uint32_t layer) {
    slv_document *document = slv_session_document(e->session);
    uint32_t count = slv_document_layer_count(document);
    e->layer = layer ? layer : count ? slv_document_layer_at(document, count - 1) : 0;
    e->scheme = slv_session_scheme(e->session);
}

slv_result easel_open_session(const slv_env *env, easel *e, uint32_t layer, bool unkept) {
    const slv_session_params how = {.unkept = unkept};
    const slv_env own = line_log_begin(&e->log, env, NULL);
    int silenced = output_silence();
    slv_result result = slv_session_open(&own, e->name, &how, &e->session);
    output_restore(silenced);
    if (!result)
        choose_layer(e, layer);
    return result;
}

slv_result easel_make_session(const slv_env *env, easel *e, const char *path) {
    const slv_session_params how = {.scheme = e->scheme, .made_of = e->name};
    const slv_env own = line_log_begin(&e->log, env, NULL);
    slv_result result;
    if (ptx_name_is_safe(e->name)) {
        if (!(result = open_ptx(env, e)))
            result = slv_ptx_load_texture(env, e->ptx, &e->texture);
    } else {
        result = load_mesh(env, e, SLV_TYPE_U8);
    }
    if (!result &&
        !(result = slv_session_create_from(&own, path, e->mesh, e->texture, &how, &e->session)))
        choose_layer(e, 0);
    return result;
}

void easel_close(easel *e) {
    slv_script_destroy(e->script);
    slv_painter_destroy(e->painter);
    slv_paint_surface_destroy(e->surface);
    slv_texture_destroy(e->texture);
    slv_mesh_destroy(e->mesh);
    slv_ptx_close(e->ptx);
    slv_session_destroy(e->session);
}

slv_result easel_begin(const slv_env *env, easel *e, const char *script,
                       void (*unknown)(void *user, const char *brush, const char *setting),
                       void *user) {
    const slv_script_params params = {.name = script,
                                      .folder = e->folder,
                                      .unknown = unknown,
                                      .user = user,
                                      .integers = e->writer.type == SLV_TYPE_U8 ||
                                                  e->writer.type == SLV_TYPE_U16};
    if ((size_t)snprintf(e->folder, sizeof e->folder, "%s", script) >= sizeof e->folder)
        return output_fail(env, SLV_ERROR_IO, "%s: its name is too long", script);
    e->log.path = script;
    char *slash = strrchr(e->folder, '/');
    *(slash ? slash : e->folder) = 0;
    if (e->session)
        return SLV_OK;
    const slv_canvas canvas = slv_texture_as_canvas(e->texture);
    return slv_script_create(e->painter, &canvas, &params, &e->script);
}

slv_result easel_run(easel *e, uint64_t number, const char *line, size_t size) {
    e->log.line = number;
    int silenced = output_silence();
    slv_result result = e->session ? slv_session_run(e->session, e->layer, false,
                                                     *e->folder ? e->folder : NULL, line, size)
                                   : slv_script_run(e->script, number, line, size);
    output_restore(silenced);
    e->log.line = 0;
    return result;
}

slv_result easel_texture(easel *e, slv_texture **out) {
    slv_result result = SLV_OK;
    *out = e->texture;
    if (e->session) {
        slv_document *document = slv_session_document(e->session);
        result = slv_document_flatten(document);
        *out = slv_document_texture(document);
    }
    return result;
}

const slv_adjacency *easel_adjacency(const easel *e) {
    return e->session ? slv_session_adjacency(e->session) : slv_paint_surface_adjacency(e->surface);
}

void easel_stats(const easel *e, slv_script_stats *out) {
    if (e->session)
        slv_session_get_stats(e->session, out);
    else
        slv_script_get_stats(e->script, out);
}

bool easel_touched(const easel *e, uint32_t face) {
    return e->session ? slv_session_touched(e->session, face) : slv_script_touched(e->script, face);
}

uint32_t easel_faces(const easel *e) {
    return e->session ? slv_document_get_desc(slv_session_document(e->session))->nfaces
                      : e->writer.nfaces;
}

/* A face that was painted on, rounded; any other as it was. */
static slv_result write_face(const slv_env *env, const easel *e, slv_ptx_writer *writer,
                             uint32_t face) {
    slv_ptx_face info = {
        .res = slv_texture_get_desc(e->texture)->res[face],
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
    slv_result result = e->ptx ? slv_ptx_get_face(e->ptx, face, &info) : SLV_OK;
    bool painted = !e->ptx || slv_script_touched(e->script, face);
    if (result)
        return result;
    bool constant =
        painted ? slv_texture_is_constant(e->texture, face) : (info.flags & SLV_FACE_CONSTANT) != 0;
    size_t texels = (size_t)1 << (constant ? 0 : info.res.u + info.res.v);
    void *values = malloc(texels * e->writer.nchannels * slv_type_size(e->writer.type));
    if (!values)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its texels", e->name,
                           face);
    info.flags = (uint8_t)((info.flags & SLV_FACE_SUBFACE) | (constant ? SLV_FACE_CONSTANT : 0));
    if (painted)
        slv_type_from_float(e->writer.type, slv_texture_texels(e->texture, face),
                            texels * e->writer.nchannels, values);
    else
        result = slv_ptx_read_face(e->ptx, face, constant ? (slv_res){0, 0} : info.res, values);
    if (!result)
        result = slv_ptx_writer_write_face(writer, face, &info, values);
    free(values);
    return result;
}

slv_result easel_save(const slv_env *env, easel *e, const char *path, bool forced, bool quiet) {
    slv_ptx_writer *writer = NULL;
    if (e->session)
        return slv_session_export(e->session, path);
    cli_progress progress = cli_progress_fleeting("write", forced, quiet);
    e->writer.progress = (slv_progress){cli_progress_report, &progress};
    slv_result result = slv_ptx_writer_create(env, path, &e->writer, &writer);
    for (uint32_t i = 0; e->ptx && !result && i < slv_ptx_get_info(e->ptx)->nmeta; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(e->ptx, i, &meta)))
            result = slv_ptx_writer_set_meta(writer, meta);
    }
    if (!result && !e->ptx)
        result = slv_ptx_writer_set_mesh(writer, e->mesh);
    for (uint32_t face = 0; !result && face < e->writer.nfaces; face++)
        result = write_face(env, e, writer, face);
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    cli_progress_end(&progress);
    return result;
}
