/* A view file of any bytes. */
#include "kit/fuzz_kit.h"

#include "command/scene.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    scene_view view;
    fuzz_write("view.json", data, size);
    if (!FUZZ_CALL(scene_load_view(&env, fuzz_path("view.json"), &view))) {
        for (int i = 0; i < 16; i++)
            FUZZ_REQUIRE(isfinite(view.camera.world_to_camera[i]), "a matrix that is not finite");
        FUZZ_REQUIRE(!view.has_camera || (view.camera.window[0] < view.camera.window[1] &&
                                          view.camera.window[2] < view.camera.window[3]),
                     "an empty window");
        FUZZ_REQUIRE(!view.has_size || (view.size[0] >= 1 && view.size[0] <= 16384 &&
                                        view.size[1] >= 1 && view.size[1] <= 16384),
                     "a size of %u x %u", view.size[0], view.size[1]);
        FUZZ_REQUIRE(
            (unsigned)view.shading <= SLV_SHADE_IMAGE && (unsigned)view.alpha <= SLV_ALPHA_MASK &&
                (unsigned)view.boundary <= SLV_BOUNDARY_EDGE_AND_CORNER &&
                (unsigned)view.scheme <= SLV_SCHEME_BILINEAR && view.ka >= 0 && view.kd >= 0,
            "a word that there is not");
    }
    fuzz_clear(1);
    return 0;
}
