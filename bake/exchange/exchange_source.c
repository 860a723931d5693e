/* Opening what is to be exchanged. */
#include "exchange/exchange_data.h"
#include "exchange/index.h"

#include "base/names.h"

#include <string.h>

const char *slv_exchange_images_name(slv_exchange_images images) {
    static const char *const names[] = {"by-type", "png", "exr"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)images);
}

static slv_result begin(const slv_env *env, const char *path, slv_exchange **out) {
    size_t size = strlen(path) + 1;
    slv_exchange *source;
    slv_result result = slvi_alloc(env, path, 1, sizeof *source, &source);
    if (result)
        return result;
    if ((result = slvi_alloc(env, path, size, 1, &source->path))) {
        slvi_free(source);
        return result;
    }
    memcpy(source->path, path, size);
    *out = source;
    return SLV_OK;
}

slv_result slv_exchange_open(const slv_env *given, const char *path, slv_exchange **out) {
    slv_env env = slvi_env_or_default(given);
    slv_exchange *source = NULL;
    *out = NULL;
    slv_result result = begin(&env, path, &source);
    if (result)
        return result;
    if (slv_exchange_is_index(path)) {
        result = slvi_index_open(&env, path, source);
    } else if (!(result = slv_ptx_open(&env, path, &source->own)) &&
               !(result = slv_ptx_load_tables(source->own)) &&
               !(result = slv_ptx_get_encoding(source->own, &source->encoding))) {
        source->ptx = source->own;
        source->params = slv_ptx_writer_params_like(source->ptx);
    }
    if (result)
        slv_exchange_close(source);
    else
        *out = source;
    return result;
}

slv_result slv_exchange_open_ptx(const slv_env *given, const slv_ptx *ptx, slv_exchange **out) {
    slv_env env = slvi_env_or_default(given);
    slv_exchange *source = NULL;
    *out = NULL;
    slv_result result = begin(&env, slv_ptx_name(ptx), &source);
    if (result)
        return result;
    source->ptx = ptx;
    source->params = slv_ptx_writer_params_like(ptx);
    if ((result = slv_ptx_get_encoding(ptx, &source->encoding))) {
        slv_exchange_close(source);
        return result;
    }
    *out = source;
    return SLV_OK;
}

const slv_ptx_writer_params *slv_exchange_get_params(const slv_exchange *source) {
    return &source->params;
}

void slv_exchange_close(slv_exchange *source) {
    if (!source)
        return;
    slv_ptx_close(source->own);
    json_decref(source->index);
    slvi_free(source->path);
    slvi_free(source);
}
