/* convert IN.ptx OUT.ptx: the same texture with 16-bit integers, its edits applied. */
#include <selvage/ptx_writer.h>
#include <stdlib.h>

struct job {
    const slv_ptx_info *from;
    slv_ptx_writer *writer;
};

/* Called on several threads, with one texel of a constant face and with all of any other. */
static slv_result convert_face(void *user, const slv_env *env, uint32_t face,
                               const slv_ptx_face *info, void *texels) {
    const struct job *job = user;
    (void)env;
    bool constant = info->flags & SLV_FACE_CONSTANT;
    size_t count = (size_t)job->from->nchannels << (constant ? 0 : info->res.u + info->res.v);
    float *values = malloc(count * sizeof *values);
    uint16_t *integers = malloc(count * sizeof *integers);
    slv_result result = values && integers ? SLV_OK : SLV_ERROR_MEMORY;
    if (!result) {
        slv_type_to_float(job->from->type, texels, count, values);
        slv_type_from_float(SLV_TYPE_U16, values, count, integers);
        result = slv_ptx_writer_write_face(job->writer, face, info, integers);
    }
    free(values);
    free(integers);
    return result;
}

int main(int argc, char **argv) {
    slv_ptx *ptx = NULL;
    if (argc != 3 || slv_ptx_open(NULL, argv[1], &ptx))
        return 1;
    struct job job = {.from = slv_ptx_get_info(ptx)};
    slv_ptx_writer_params params = slv_ptx_writer_params_like(ptx);
    params.type = SLV_TYPE_U16;
    slv_result result = slv_ptx_writer_create(NULL, argv[2], &params, &job.writer);
    for (uint32_t i = 0; !result && i < job.from->nmeta; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(ptx, i, &meta)))
            result = slv_ptx_writer_set_meta(job.writer, meta);
    }
    if (!result && !(result = slv_ptx_visit_faces(NULL, ptx, convert_face, &job)))
        result = slv_ptx_writer_finish(job.writer);
    slv_ptx_writer_destroy(job.writer);
    slv_ptx_close(ptx);
    return result;
}
