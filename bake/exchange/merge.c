/* Several .ptx files as one. */
#include "exchange/merge.h"

struct part {
    slv_ptx_writer *writer;
    slvi_exchange_plan plan;
    uint32_t first;
};

static slv_result write_face(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    const struct part *part = user;
    slv_ptx_face moved = *info;
    const void *values = texels;
    void *own;
    slv_result result = slvi_exchange_face(env, &part->plan, face, &moved, &values, &own);
    for (int edge = 0; edge < 4; edge++)
        if (moved.adjacency.face[edge] >= 0)
            moved.adjacency.face[edge] += (int32_t)part->first;
    if (!result)
        result = slv_ptx_writer_write_face(part->writer, part->first + face, &moved, values);
    slvi_free(own);
    return result;
}

static slv_result write_part(const slv_env *env, slvi_merge *m, uint32_t index) {
    struct part part = {.writer = m->writer, .first = m->first_faces[index]};
    const slv_exchange_params params = {.changes = SLV_EXCHANGE_TYPE, .type = m->target.type};
    slv_ptx_writer_params source = slv_ptx_writer_params_like(m->files[index]);
    slv_result result =
        slvi_exchange_plan_make(env, &params, m->paths[index], &source, &m->totals, &part.plan);
    if (!result)
        result = slvi_exchange_visited(
            env, &part.plan, slv_ptx_visit_faces(env, m->files[index], write_face, &part));
    slvi_exchange_plan_free(&part.plan);
    return result;
}

/* Of two types the one that holds all values of both: integers by their size, else float, which
 * half is enough for beside uint8. */
static slv_type wider(slv_type a, slv_type b) {
    slv_type low = a < b ? a : b, high = a < b ? b : a;
    return low == SLV_TYPE_U16 && high == SLV_TYPE_HALF ? SLV_TYPE_FLOAT : high;
}

/* Numbers are kept, so one of the two is shown wrongly. */
static slv_result join_encoding(const slv_env *env, slvi_merge *m, uint32_t index) {
    slv_texture_encoding encoding;
    slv_result result = slv_ptx_get_encoding(m->files[index], &encoding);
    if (result)
        return result;
    m->noted |= slv_ptx_find_meta(m->files[index], SLV_PTX_ENCODING_KEY) != NULL;
    if (index == 0)
        m->encoding = encoding;
    else if (encoding != m->encoding)
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: its colours are %s, those of %s are %s, and all will be taken for that",
                  m->paths[index], slv_texture_encoding_name(encoding), m->paths[0],
                  slv_texture_encoding_name(m->encoding));
    return SLV_OK;
}

static slv_result note_encoding(const slvi_merge *m) {
    const slvi_exchange_plan plan = {.encoding = m->encoding, .target = m->target};
    return m->noted || slvi_exchange_needs_note(&plan)
               ? slvi_exchange_note_encoding(&plan, m->writer)
               : SLV_OK;
}

static slv_result plan_result(const slv_env *env, const slv_merge_params *params, slvi_merge *m) {
    uint64_t nfaces = 0;
    m->target = slv_ptx_writer_params_like(m->files[0]);
    for (uint32_t i = 0; i < m->npaths; i++) {
        slv_ptx_writer_params part = slv_ptx_writer_params_like(m->files[i]);
        if (part.mesh_type != m->target.mesh_type)
            return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: is of %s, %s is not", m->paths[i],
                             part.mesh_type == SLV_PTX_QUAD ? "quads" : "triangles", m->paths[0]);
        if (part.nchannels != m->target.nchannels || part.alpha_channel != m->target.alpha_channel)
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "%s: has %u channels and alpha %d, %s has %u and %d: convert it first",
                             m->paths[i], part.nchannels, part.alpha_channel, m->paths[0],
                             m->target.nchannels, m->target.alpha_channel);
        if (part.border_u != m->target.border_u || part.border_v != m->target.border_v ||
            part.edge_filter != m->target.edge_filter)
            slvi_logf(env, SLV_LOG_WARNING,
                      "%s: its border modes or edge filter differ: those of %s are taken",
                      m->paths[i], m->paths[0]);
        slv_result result = join_encoding(env, m, i);
        if (result)
            return result;
        m->target.type = wider(m->target.type, part.type);
        m->first_faces[i] = (uint32_t)nfaces;
        nfaces += part.nfaces;
        if (nfaces > INT32_MAX)
            return slvi_fail(env, SLV_ERROR_LIMIT, "%s: with it there are more than %d faces",
                             m->paths[i], INT32_MAX);
    }
    m->target.nfaces = (uint32_t)nfaces;
    if (params->changes & SLV_EXCHANGE_REDUCTIONS)
        m->target.no_reductions = params->no_reductions;
    m->target.compression = params->compression;
    if (params->changes & SLV_EXCHANGE_TYPE)
        m->target.type = params->type;
    return SLV_OK;
}

static slv_result merge(const slv_env *env, const slv_merge_params *params, slvi_merge *m) {
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < m->npaths; i++)
        if ((result = slv_ptx_open(env, m->paths[i], &m->files[i])) ||
            (result = slv_ptx_load_tables(m->files[i])))
            return result;
    if ((result = plan_result(env, params, m)) ||
        (result = slv_ptx_writer_create(env, m->out, &m->target, &m->writer)) ||
        (result = slvi_merge_meta(env, m)) || (result = note_encoding(m)))
        return result;
    m->totals.steps.total = m->target.nfaces;
    for (uint32_t i = 0; i < m->npaths && !result; i++)
        result = write_part(env, m, i);
    return result ? result : slv_ptx_writer_finish(m->writer);
}

slv_result slv_merge(const slv_env *given, const char *const *paths, uint32_t npaths,
                     const slv_merge_params *params, const char *out, uint32_t *first_faces,
                     bool *geometry, slv_exchange_stats *stats) {
    static const slv_merge_params none = {0};
    slv_env env = slvi_env_or_default(given);
    slvi_merge m = {.paths = paths, .npaths = npaths, .out = out};
    slv_result result;
    params = params ? params : &none;
    if (!npaths)
        return slvi_fail(&env, SLV_ERROR_ARGUMENT, "%s: of no files", out);
    slvi_exchange_begin(&m.totals, params->progress, 0);
    if (!(result = slvi_alloc(&env, out, npaths, sizeof *m.files, &m.files)) &&
        !(result = slvi_alloc(&env, out, npaths, sizeof *m.first_faces, &m.first_faces)))
        result = merge(&env, params, &m);
    for (uint32_t i = 0; first_faces && !result && i < npaths; i++)
        first_faces[i] = m.first_faces[i];
    if (geometry)
        *geometry = m.geometry;
    slvi_exchange_end(&env, &m.totals, result, &m.target, stats);
    slv_ptx_writer_destroy(m.writer);
    for (uint32_t i = 0; m.files && i < npaths; i++)
        slv_ptx_close(m.files[i]);
    slvi_free(m.files);
    slvi_free(m.first_faces);
    return result;
}
