/* The flattened document in a .ptx: whole, or what of it differs. */
#include "session/session_data.h"

#include "base/log.h"

#include <selvage/ptx_writer.h>

#include <string.h>

slv_result slv_session_export(slv_session *session, const char *path) {
    const slv_ptx_write_params params = {.mesh = session->mesh};
    slv_result result = slv_document_flatten(session->document);
    return result ? result
                  : slv_ptx_save(&session->env, path, slv_document_texture(session->document),
                                 session->adjacency, &params);
}

/* Whether a face of two textures is the same, to the bit. */
static bool is_same(const slv_texture *a, const slv_texture *b, uint32_t face) {
    const slv_texture_desc *desc = slv_texture_get_desc(a);
    slv_res res = desc->res[face], other = slv_texture_get_desc(b)->res[face];
    size_t texel = slv_type_size(desc->type) * desc->nchannels, bytes = texel << (res.u + res.v);
    const unsigned char *x = slv_texture_texels(a, face), *y = slv_texture_texels(b, face);
    size_t step_x = slv_texture_is_constant(a, face) ? 0 : texel;
    size_t step_y = slv_texture_is_constant(b, face) ? 0 : texel;
    if (res.u != other.u || res.v != other.v)
        return false;
    if (step_x && step_y)
        return memcmp(x, y, bytes) == 0;
    return !step_x && !step_y && memcmp(x, y, texel) == 0; /* else one of them is not constant */
}

static slv_result write_face(slv_ptx_writer *writer, const slv_texture *texture,
                             const slv_adjacency *adjacency, uint32_t face) {
    slv_ptx_face info = {.res = slv_texture_get_desc(texture)->res[face],
                         .adjacency = slv_adjacency_faces(adjacency)[face]};
    if (slv_texture_is_constant(texture, face))
        info.flags |= SLV_FACE_CONSTANT;
    if (slv_adjacency_is_subface(adjacency, (int32_t)face))
        info.flags |= SLV_FACE_SUBFACE;
    return slv_ptx_writer_write_face(writer, face, &info, slv_texture_texels(texture, face));
}

static slv_result write_edits(slv_session *session, const char *path, const slv_texture *old,
                              uint32_t *faces) {
    const slv_texture *texture = slv_document_texture(session->document);
    slv_ptx_writer *writer = NULL;
    slv_result result = SLV_OK;
    for (uint32_t face = 0; !result && face < session->document->flat.nfaces; face++) {
        if (is_same(texture, old, face))
            continue;
        if (!writer && (result = slv_ptx_writer_edit(&session->env, path, NULL, &writer)))
            break;
        result = write_face(writer, texture, session->adjacency, face);
        ++*faces;
    }
    if (writer && !result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

slv_result slv_session_export_edits(slv_session *session, const char *path, uint32_t *faces) {
    const slv_texture_desc *flat = &session->document->flat;
    uint32_t count = 0;
    slv_ptx *ptx = NULL;
    slv_texture *old = NULL;
    slv_result result;
    if ((result = slv_document_flatten(session->document)) ||
        (result = slv_ptx_open(&session->env, path, &ptx)) ||
        (result = slv_ptx_load_texture(&session->env, ptx, &old)))
        goto done;
    const slv_texture_desc *desc = slv_texture_get_desc(old);
    if (desc->nfaces != flat->nfaces || desc->type != flat->type ||
        desc->nchannels != flat->nchannels || desc->alpha_channel != flat->alpha_channel)
        result =
            slvi_fail(&session->env, SLV_ERROR_MISMATCH,
                      "%s: %u faces of %u channels, %s; the session has %u of %u, %s", path,
                      (unsigned)desc->nfaces, (unsigned)desc->nchannels, slv_type_name(desc->type),
                      (unsigned)flat->nfaces, (unsigned)flat->nchannels, slv_type_name(flat->type));
    else
        result = write_edits(session, path, old, &count);
done:
    slv_texture_destroy(old);
    slv_ptx_close(ptx);
    if (faces)
        *faces = count;
    return result;
}
