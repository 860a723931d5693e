/* A .ptx out of images and their index. */
#ifndef SLV_BAKE_EXCHANGE_IMPORT_H
#define SLV_BAKE_EXCHANGE_IMPORT_H

#include "exchange/exchange_data.h"

#include <selvage/image.h>

/* Images that lose something on their way, and the first of them. */
typedef struct slvi_import_loss {
    uint64_t count;
    char first[2200];
} slvi_import_loss;

slv_result slvi_exchange_import(const slv_env *env, const slv_exchange *source,
                                const slv_exchange_params *params, const slvi_exchange_plan *plan,
                                const char *path);

/* An image that is to have `needed` channels (1 grey, 2 grey and alpha, 3 RGB, 4 RGBA), as other
 * programs save it: grey stands for R G B, alpha that is missing is 1, alpha too many is left out,
 * and R G B that are alike are grey. SLV_ERROR_MISMATCH: a colour where grey is needed. */
slv_result slvi_import_fit(const slv_env *env, const char *path, uint32_t needed, slv_image *image,
                           slvi_import_loss *dropped, slvi_import_loss *added);
void slvi_import_note(slvi_import_loss *loss, const char *path);
void slvi_import_warn(const slv_env *env, const slvi_import_loss *dropped,
                      const slvi_import_loss *added, const slvi_import_loss *unsaid);

#endif
