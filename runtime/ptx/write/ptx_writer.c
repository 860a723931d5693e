/* Taking in faces, metadata and adjacency. */
#include "base/beside.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "ptx/write/ptx_write.h"
#include "texture/reduce.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define DEFAULT_MEMORY (UINT64_C(128) << 20)
/* With large blocks of integers packed by other means, as small as zlib's sixth: files of halves
 * are a little smaller, those of bytes from 15 % smaller to 3 % larger. */
#define DEFAULT_COMPRESSION 6

/* Whether a file has faces of which reductions would be stored. */
static bool could_reduce(const slv_ptx *ptx) {
    if (ptx_need(ptx, PTX_FACES))
        return false;
    for (uint32_t face = 0; face < ptx->info.nfaces; face++) {
        slv_ptx_face f = slvi_ptx_face_at(ptx, face);
        if (ptx_min_log2(f.res) > 2 && !(f.flags & SLV_FACE_CONSTANT))
            return true;
    }
    return false;
}

slv_ptx_writer_params slvi_ptx_writer_params_of_header(const slv_ptx *ptx) {
    const slv_ptx_info *info = &ptx->info;
    return (slv_ptx_writer_params){.mesh_type = info->mesh_type,
                                   .type = info->type,
                                   .nchannels = info->nchannels,
                                   .alpha_channel = info->alpha_channel,
                                   .nfaces = info->nfaces,
                                   .border_u = info->border_u,
                                   .border_v = info->border_v,
                                   .edge_filter = info->edge_filter};
}

slv_ptx_writer_params slv_ptx_writer_params_like(const slv_ptx *ptx) {
    slv_ptx_writer_params params = slvi_ptx_writer_params_of_header(ptx);
    params.no_reductions = ptx->info.nlevels == 1 && could_reduce(ptx);
    return params;
}

static slv_result check_params(const slv_env *env, const char *path,
                               const slv_ptx_writer_params *p) {
    if ((unsigned)p->mesh_type > SLV_PTX_QUAD || (unsigned)p->type > SLV_TYPE_FLOAT ||
        (unsigned)p->border_u > SLV_BORDER_PERIODIC ||
        (unsigned)p->border_v > SLV_BORDER_PERIODIC ||
        (unsigned)p->edge_filter > SLV_EDGE_FILTER_TANVEC)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%s: unknown mesh type, data type, border mode or edge filter", path);
    if (p->nchannels < 1 || p->nchannels > UINT16_MAX)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: %u channels, 1 to %d are possible", path,
                         p->nchannels, UINT16_MAX);
    if (p->alpha_channel < SLV_NO_ALPHA ||
        (p->alpha_channel >= 0 && (uint32_t)p->alpha_channel >= p->nchannels))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: alpha is channel %d, there are %u channels",
                         path, p->alpha_channel, p->nchannels);
    if (p->nfaces > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: %u faces, the format has room for %d", path,
                         p->nfaces, INT32_MAX);
    if ((unsigned)p->seams > SLV_PTX_SEAMS_ALL)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: unknown kind of reductions", path);
    if (p->seams && p->mesh_type == SLV_PTX_TRIANGLE)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "%s: reductions of triangles cannot be made to agree where faces meet",
                         path);
    if (p->compression < 0 || p->compression > 12)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: compression is 1 to 12, not %d", path,
                         p->compression);
    return SLV_OK;
}

static slv_result copy_string(const slv_env *env, const char *path, const char *from, char **out) {
    slv_result result = slvi_alloc(env, path, strlen(from) + 1, 1, out);
    if (!result)
        memcpy(*out, from, strlen(from) + 1);
    return result;
}

/* What is written, and beside what packed faces wait if they are too many for memory. */
static slv_result name_target(slv_ptx_writer *writer, const slv_env *env, const char *path) {
    if (writer->output.write) {
        const char *folder = getenv("TMPDIR");
        char beside[PATH_MAX];
        snprintf(beside, sizeof beside, "%s/selvage", folder && *folder ? folder : "/tmp");
        slv_result result = copy_string(env, path, path, &writer->path);
        return result ? result : copy_string(env, path, beside, &writer->spill_path);
    }
    /* what is kept lies beside what a link leads to */
    slv_result result = slvi_beside_resolve(env, path, &writer->path);
    return result ? result : copy_string(env, path, writer->path, &writer->spill_path);
}

static slv_result begin(const slv_env *env, const char *path, const slv_ptx_writer_params *params,
                        slv_ptx_writer **out) {
    slv_ptx_writer *writer = NULL;
    uint32_t nfaces = params->nfaces;
    *out = NULL;
    slv_result result = check_params(env, path, params);
    if (result || (result = slvi_alloc(env, path, 1, sizeof *writer, &writer)))
        return result;
    writer->edited = writer->seams.descriptor = -1;
    writer->params = *params;
    writer->params.output = NULL;
    if (params->output)
        writer->output = *params->output;
    writer->compression = params->compression ? params->compression : DEFAULT_COMPRESSION;
    writer->pixel_size = params->nchannels * slv_type_size(params->type);
    atomic_init(&writer->failed, false);
    pthread_mutex_init(&writer->lock, NULL);
    slvi_idle_begin(&writer->packers);
    slvi_steps_begin(&writer->steps, params->progress, nfaces);
    if ((result = slvi_parallel_env_begin(env, &writer->log, &writer->env)))
        goto done;
    env = &writer->env;
    if ((result = name_target(writer, env, path)))
        goto done;
    if ((result = slvi_alloc(env, path, nfaces, PTX_FACE_INFO_SIZE, &writer->records)) ||
        (result = slvi_alloc(env, path, nfaces, writer->pixel_size, &writer->constants)) ||
        (result = slvi_alloc(env, path, nfaces, 1, &writer->given)) ||
        (result = slvi_alloc(env, path, nfaces, sizeof *writer->positions, &writer->positions)) ||
        (result = slvi_ptx_spill_begin(&writer->spill, env, writer->spill_path,
                                       params->memory ? params->memory : DEFAULT_MEMORY)))
        goto done;
    for (uint32_t level = 0; level < PTX_MAX_STORED_LEVELS; level++)
        if ((result = slvi_alloc(env, path, nfaces, sizeof(uint32_t), &writer->headers[level])))
            goto done;
    if (params->seams && (result = slvi_ptx_seams_begin(writer)))
        goto done;
    slv_ptx_face none = {
        .flags = SLV_FACE_CONSTANT,
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
    for (uint32_t face = 0; face < nfaces; face++)
        slvi_ptx_pack_record(&none, writer->records + (size_t)face * PTX_FACE_INFO_SIZE);
    *out = writer;
    writer = NULL;
done:
    slv_ptx_writer_destroy(writer);
    return result;
}

slv_result slvi_ptx_writer_begin(const slv_env *env, const char *path,
                                 const slv_ptx_writer_params *params, slv_ptx_writer **out) {
    slv_env own = slvi_budget_begin(env); /* which the writer holds from then on */
    return slvi_budget_end(&own, begin(&own, path, params, out));
}

slv_result slv_ptx_writer_create(const slv_env *env, const char *path,
                                 const slv_ptx_writer_params *params, slv_ptx_writer **out) {
    slv_output output;
    slv_result result = slvi_ptx_writer_begin(env, path, params, out);
    if (result)
        return result;
    if ((*out)->output.write)
        return SLV_OK;
    /* better to hear now than after the work that the folder cannot be written */
    if (!(result = slvi_output_begin(&(*out)->env, path, false, &output))) {
        slvi_output_discard(&output);
        return SLV_OK;
    }
    slv_ptx_writer_destroy(*out);
    *out = NULL;
    return result;
}

void slv_ptx_writer_destroy(slv_ptx_writer *writer) {
    if (!writer)
        return;
    for (ptx_packer *packer; (packer = slvi_idle_take(&writer->packers));)
        slvi_ptx_packer_free(packer);
    slvi_idle_end(&writer->packers);
    slvi_ptx_spill_end(&writer->spill);
    slvi_ptx_seams_end(writer);
    for (uint32_t level = 0; level < PTX_MAX_STORED_LEVELS; level++)
        slvi_free(writer->headers[level]);
    for (uint32_t i = 0; i < writer->nmeta; i++)
        slvi_free(writer->meta[i].memory);
    if (writer->edited >= 0)
        close(writer->edited);
    slvi_free(writer->links);
    slvi_free(writer->meta);
    slvi_free(writer->records);
    slvi_free(writer->constants);
    slvi_free(writer->given);
    slvi_free(writer->positions);
    slvi_free(writer->path);
    slvi_free(writer->spill_path);
    pthread_mutex_destroy(&writer->lock);
    slvi_steps_end(&writer->steps);
    slvi_parallel_env_end(writer->log);
    slvi_free(writer);
}

/* Packs a face's texels and reductions, and finds its average. */
static slv_result pack_face(slv_ptx_writer *writer, ptx_packer *packer, uint32_t face, slv_res res,
                            const void *texels) {
    const slv_ptx_writer_params *p = &writer->params;
    bool premultiply = p->alpha_channel >= 0;
    bool reduce = !p->no_reductions && writer->edited < 0;
    uint8_t *average = writer->constants + face * writer->pixel_size;
    unsigned turn = 0;
    slv_result result;
    packer->out.size = 0;
    if ((result = slvi_ptx_pack(packer, face, texels, res, &writer->headers[0][face])))
        return result;
    uint64_t count = ptx_texel_count(res);
    for (unsigned i = 0; i < 2; i++) {
        packer->work[i].size = 0;
        uint64_t room = i == 0 && premultiply ? count : reduce ? count / 4 : 0;
        if ((result = slvi_ptx_bytes_reserve(packer->env, packer->path, &packer->work[i],
                                             room * writer->pixel_size)))
            return result;
    }
    if (premultiply) {
        memcpy(packer->work[0].data, texels, (size_t)count * writer->pixel_size);
        texels = packer->work[0].data;
        slv_ptx_premultiply(p->type, p->nchannels, p->alpha_channel, packer->work[0].data, count);
        turn = 1;
    }
    for (uint32_t level = 1; reduce && ptx_min_log2(res) > 2; level++) {
        uint8_t *reduced = packer->work[turn].data;
        slv_ptx_reduce(p->mesh_type, p->type, p->nchannels, res, texels, reduced);
        texels = reduced;
        turn ^= 1;
        res = (slv_res){(int8_t)(res.u - 1), (int8_t)(res.v - 1)};
        if ((result = slvi_ptx_pack(packer, face, texels, res, &writer->headers[level][face])))
            return result;
    }
    slv_ptx_average(p->type, p->nchannels, texels, ptx_texel_count(res), average);
    slv_ptx_unmultiply(p->type, p->nchannels, p->alpha_channel, average, 1);
    return slvi_ptx_spill_append(&writer->spill, packer->env, packer->out.data, packer->out.size,
                                 &writer->positions[face]);
}

static slv_result check_info(const slv_ptx_writer *writer, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info) {
    const slv_ptx_writer_params *p = &writer->params;
    bool triangle = p->mesh_type == SLV_PTX_TRIANGLE;
    if (writer->finished)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: face %u: the file is finished", writer->path,
                         face);
    if (face >= p->nfaces)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces", writer->path,
                         face, p->nfaces);
    if (info->res.u < 0 || info->res.v < 0 || info->res.u > SLV_MAX_LOG2_RES ||
        info->res.v > SLV_MAX_LOG2_RES || (triangle && info->res.u != info->res.v))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%s: face %u: a resolution of 2^%d x 2^%d; sides are 2^0 to 2^%d%s",
                         writer->path, face, info->res.u, info->res.v, SLV_MAX_LOG2_RES,
                         triangle ? ", those of a triangle equal" : "");
    for (unsigned edge = 0; edge < (triangle ? 3 : 4); edge++)
        if ((uint32_t)info->adjacency.face[edge] + 1 > p->nfaces)
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "%s: face %u edge %u: the adjacent face is %d, but there are %u faces",
                             writer->path, face, edge, info->adjacency.face[edge], p->nfaces);
    return SLV_OK;
}

slv_result slvi_ptx_writer_put(slv_ptx_writer *writer, const slv_env *env, uint32_t face,
                               const slv_ptx_face *info, const void *texels) {
    ptx_packer *packer = NULL;
    slv_result result = check_info(writer, env, face, info);
    if (result)
        return result;
    slv_ptx_face own = *info;
    bool triangle = writer->params.mesh_type == SLV_PTX_TRIANGLE;
    own.flags &= triangle ? SLV_FACE_CONSTANT : SLV_FACE_CONSTANT | SLV_FACE_SUBFACE;
    if (triangle) {
        own.adjacency.face[3] = SLV_BOUNDARY;
        own.adjacency.edge[3] = 0;
    }
    if (!(own.flags & SLV_FACE_CONSTANT) &&
        slvi_texels_equal(texels, writer->pixel_size, ptx_texel_count(own.res)))
        own.flags |= SLV_FACE_CONSTANT;
    for (uint32_t level = 0; writer->given[face] && level < PTX_MAX_STORED_LEVELS; level++)
        writer->headers[level][face] = 0;
    if (own.flags & SLV_FACE_CONSTANT)
        memcpy(writer->constants + face * writer->pixel_size, texels, writer->pixel_size);
    else if (!(result = slvi_ptx_writer_take(writer, env, &packer)))
        result = writer->params.seams ? slvi_ptx_seams_keep(writer, packer, face, own.res, texels)
                                      : pack_face(writer, packer, face, own.res, texels);
    slvi_ptx_writer_give(writer, packer);
    if (result) {
        atomic_store(&writer->failed, true);
        return result;
    }
    slvi_ptx_pack_record(&own, writer->records + (size_t)face * PTX_FACE_INFO_SIZE);
    writer->given[face] = 1;
    return SLV_OK;
}

slv_result slv_ptx_writer_write_face(slv_ptx_writer *writer, uint32_t face,
                                     const slv_ptx_face *info, const void *texels) {
    return slvi_ptx_writer_put(writer, &writer->env, face, info, texels);
}

slv_result slv_ptx_writer_finish(slv_ptx_writer *writer) {
    if (writer->finished)
        return slvi_fail(&writer->env, SLV_ERROR_ARGUMENT, "%s: is finished already", writer->path);
    writer->finished = true;
    if (atomic_load(&writer->failed))
        return slvi_fail(&writer->env, SLV_ERROR_ARGUMENT,
                         "%s: is not written, since one of its faces could not be", writer->path);
    slv_result result = writer->params.seams ? slvi_ptx_seams_pack(writer) : SLV_OK;
    if (result)
        return result;
    return writer->edited < 0 ? slvi_ptx_writer_assemble(writer) : slvi_ptx_writer_append(writer);
}
