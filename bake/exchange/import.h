/* A .ptx out of images and their index. */
#ifndef SLV_BAKE_EXCHANGE_IMPORT_H
#define SLV_BAKE_EXCHANGE_IMPORT_H

#include "exchange/exchange_data.h"

slv_result slvi_exchange_import(const slv_env *env, const slv_exchange *source,
                                const slv_exchange_params *params, const slvi_exchange_plan *plan,
                                const char *path);

#endif
