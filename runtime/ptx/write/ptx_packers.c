/* The memory and compressors that threads pack faces with, which go from one to the next. */
#include "ptx/write/ptx_write.h"

#include "base/log.h"

slv_result slvi_ptx_writer_take(slv_ptx_writer *writer, const slv_env *env, ptx_packer **out) {
    ptx_packer *packer = slvi_idle_take(&writer->packers);
    *out = packer;
    if (packer) {
        packer->env = env;
        return SLV_OK;
    }
    slv_result result = slvi_alloc(env, writer->path, 1, sizeof *packer, &packer);
    if (result)
        return result;
    packer->env = env;
    packer->path = writer->path;
    packer->type = writer->params.type;
    packer->nchannels = writer->params.nchannels;
    packer->pixel_size = writer->pixel_size;
    packer->deflater = libdeflate_alloc_compressor(writer->compression);
    if (!packer->deflater)
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to pack it", writer->path);
    else if (writer->params.compression == 0)
        result = slvi_ptx_deflater_create(env, writer->path, &packer->own);
    if (result) {
        slvi_ptx_packer_free(packer);
        return result;
    }
    *out = packer;
    return SLV_OK;
}

void slvi_ptx_writer_give(slv_ptx_writer *writer, ptx_packer *packer) {
    if (packer)
        slvi_idle_give(&writer->packers, packer);
}
