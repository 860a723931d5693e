/* The functions that read texels: of a face or a tile, at once or by a reader. */
#include "ptx/read/ptx_texels.h"

#include "base/log.h"
#include "base/memory.h"

slv_result slvi_ptx_read_face_with(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                   slv_res res, void *out) {
    return slvi_ptx_read_region(ptx, scratch, face, res, (ptx_region){res, 0, 0}, out);
}

slv_result slv_ptx_read_face(const slv_ptx *ptx, uint32_t face, slv_res res, void *out) {
    ptx_scratch scratch = {.env = &ptx->env};
    slv_result result = slvi_ptx_read_face_with(ptx, &scratch, face, res, out);
    slvi_ptx_scratch_free(&scratch);
    return result;
}

struct slv_ptx_reader {
    const slv_ptx *ptx;
    slv_env env;
    ptx_scratch scratch;
};

slv_result slv_ptx_reader_create(const slv_env *env, const slv_ptx *ptx, slv_ptx_reader **out) {
    slv_ptx_reader *reader = NULL;
    slv_result result = slvi_alloc(env, ptx->name, 1, sizeof *reader, &reader);
    *out = NULL;
    if (result)
        return result;
    reader->ptx = ptx;
    reader->env = slvi_env_or_default(env);
    reader->scratch.env = &reader->env;
    *out = reader;
    return SLV_OK;
}

void slv_ptx_reader_destroy(slv_ptx_reader *reader) {
    if (!reader)
        return;
    slvi_ptx_scratch_free(&reader->scratch);
    slvi_free(reader);
}

slv_result slv_ptx_reader_read(slv_ptx_reader *reader, uint32_t face, slv_res res, void *out) {
    return slvi_ptx_read_face_with(reader->ptx, &reader->scratch, face, res, out);
}

slv_result slv_ptx_reader_read_tile(slv_ptx_reader *reader, uint32_t face, slv_res res,
                                    slv_res size, uint32_t x, uint32_t y, void *out) {
    return slvi_ptx_read_region(reader->ptx, &reader->scratch, face, res, (ptx_region){size, x, y},
                                out);
}
