/* What pixels' rays meet: the same places as the reference's own picture, and footprints that tell
 * where the next pixel is. */
#include "kit/reference_kit.h"

enum { WIDTH = 48, HEIGHT = 40, PIXELS = WIDTH * HEIGHT };

/* All faces are rectangles, on which (u,v) goes evenly. */
static const char cube_obj[] = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
                               "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n";

static slv_reference_hit hits[PIXELS], again[PIXELS];

static void check_footprints(const model *m, const slv_camera *camera) {
    uint32_t same = 0, hit = 0;
    float worst = 0, deepest = 0;
    slv_env env = test_env();
    REQUIRE(slv_reference_trace(m->reference, &env, camera, WIDTH, HEIGHT, hits) == SLV_OK);
    for (uint32_t y = 0; y + 1 < HEIGHT; y++) {
        for (uint32_t x = 0; x + 1 < WIDTH; x++) {
            const slv_reference_hit *h = &hits[y * WIDTH + x];
            hit += h->face >= 0;
            if (h->face < 0) {
                CHECK(h->u == 0 && h->depth == 0 && h->du[0] == 0);
                continue;
            }
            CHECK(h->u >= 0 && h->u <= 1 && h->v >= 0 && h->v <= 1);
            for (uint32_t k = 0; k < 2; k++) {
                const slv_reference_hit *next = h + (k ? WIDTH : 1);
                if (next->face != h->face)
                    continue;
                same++;
                worst = fmaxf(worst, fabsf(h->u + h->du[k] - next->u));
                worst = fmaxf(worst, fabsf(h->v + h->dv[k] - next->v));
                deepest = fmaxf(deepest, fabsf(h->depth + h->ddepth[k] - next->depth));
            }
        }
    }
    fprintf(stderr, "%u pixels hit, %u pairs on one face, off by at most %g in (u,v), %g deep\n",
            hit, same, (double)worst, (double)deepest);
    CHECK(hit > PIXELS / 8 && same > hit);
    CHECK(worst < 1e-3f && deepest < 1e-3f);
}

/* The texture at the centres is what one sample of an unlit picture finds, give or take where in
 * the pixel that sample is. */
static void check_places(const model *m, const slv_camera *camera) {
    slv_env env = test_env();
    slv_image image = {0};
    const slv_reference_frame frame = {.camera = *camera,
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .shading = SLV_SHADE_UNLIT,
                                       .samples = 256};
    REQUIRE(slv_reference_render(m->reference, &env, &frame, &image, NULL, NULL) == SLV_OK);
    REQUIRE(slv_reference_trace(m->reference, &env, camera, WIDTH, HEIGHT, hits) == SLV_OK);
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        float rgb[3];
        bool covered = image.pixels[4 * i + 3] == 1;
        if (image.pixels[4 * i + 3] == 0)
            CHECK(hits[i].face < 0);
        CHECK(!covered || hits[i].face >= 0);
        if (!covered)
            continue;
        const slv_surface_point point = {hits[i].face, hits[i].u, hits[i].v};
        REQUIRE(slv_reference_lookup(m->reference, 1, &point, rgb) == SLV_OK);
        for (int c = 0; c < 3; c++)
            sum += fabs((double)(rgb[c] - image.pixels[4 * i + (uint32_t)c]));
        count += 3;
    }
    fprintf(stderr, "a pixel's centre is off its mean by %.5f\n", sum / count);
    CHECK(count > PIXELS / 4 && sum / count < 0.01);
    slv_image_free(&image);
}

int main(void) {
    const slv_procedural smooth = {.pattern = SLV_PATTERN_NOISE, .frequency = 1};
    model flat = make_model(cube_obj, SLV_SCHEME_BILINEAR, &smooth, 3, 0);
    model round = make_model(box_obj, SLV_SCHEME_CATMARK, &smooth, 3, 0);
    slv_camera cameras[2] = {look(30, 25, 40), look(-50, -35, 0)};
    for (int k = 0; k < 2; k++)
        check_places(&round, &cameras[k]);
    /* flat faces, seen without perspective: what is derived at one pixel holds for all */
    check_footprints(&flat, &cameras[1]);
    slv_env env = test_env();
    env.threads = 3;
    REQUIRE(slv_reference_trace(flat.reference, &env, &cameras[1], WIDTH, HEIGHT, again) == SLV_OK);
    CHECK(memcmp(hits, again, sizeof hits) == 0);
    CHECK(slv_reference_trace(flat.reference, &env, &cameras[1], 0, HEIGHT, again) ==
          SLV_ERROR_ARGUMENT);
    cameras[0].world_to_camera[0] = NAN;
    CHECK(slv_reference_trace(flat.reference, &env, &cameras[0], WIDTH, HEIGHT, again) ==
          SLV_ERROR_ARGUMENT);
    free_model(&flat);
    free_model(&round);
    return test_end();
}
