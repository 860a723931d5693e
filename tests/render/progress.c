/* Making a texture on the GPU says how far it is and can be stopped at any report. */
#include "kit/border_kit.h"
#include "kit/progress_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

static slv_gl *gl;
static kit grid;

static slv_result create(const slv_env *env, slv_progress progress) {
    const slv_gl_texture_params params = {KIT_ALL, .progress = progress, .pool_layers = 4};
    slv_gl_texture *texture = NULL;
    slv_result result =
        slv_gl_texture_create(gl, env, grid.texture, grid.adjacency, &params, &texture);
    CHECK((texture != NULL) == (result == SLV_OK));
    slv_gl_texture_destroy(texture);
    return result;
}

int main(void) {
    slv_env env = test_env();
    uint64_t random = 1;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    kit_grid(&grid, 4, 4, false, 0, NULL, NULL);
    kit_equal(&grid, 2);
    kit_noise(&grid, SLV_TYPE_U8, 3, &random);
    progress_check("GL texture", create);
    kit_free(&grid);
    slv_gl_destroy(gl);
    return test_end();
}
