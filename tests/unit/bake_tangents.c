/* Normal maps in MikkTSpace's frame: frames that are known, mirrored and degenerate coordinates,
 * and normals that come back. */
#include "kit/uv_kit.h"

static const float want_normal[3] = {0.36f, 0.48f, 0.8f};

static slv_image load(const char *name) {
    slv_env env = test_env();
    slv_image image;
    MUST(slv_image_load(&env, tool_path(name), &image));
    REQUIRE(image.nchannels == 3);
    return image;
}

static void pixel(const slv_image *image, double u, double v, float out[3]) {
    uint32_t x = (uint32_t)(u * image->width), y = (uint32_t)((1 - v) * image->height);
    for (int c = 0; c < 3; c++)
        out[c] = 2 * image->pixels[((size_t)y * image->width + x) * 3 + (size_t)c] - 1;
}

static void write_text(const char *name, const char *text) {
    tool_write_file(name, text, strlen(text));
}

static void check_pixel(const slv_image *image, double u, double v, float a, float b, float c,
                        const char *what) {
    float got[3];
    pixel(image, u, v, got);
    CHECK_MSG(fabsf(got[0] - a) < 2e-3f && fabsf(got[1] - b) < 2e-3f && fabsf(got[2] - c) < 2e-3f,
              "%s at %g,%g: %g %g %g, not %g %g %g", what, u, v, (double)got[0], (double)got[1],
              (double)got[2], (double)a, (double)b, (double)c);
}

/* A plane whose coordinates lean by 30 degrees, and beside it one whose u runs the other way: the
 * tangent follows u, the bitangent v. */
static void plane(void) {
    const double c = cos(0.5235987755982988), s = sin(0.5235987755982988);
    char text[1024];
    int used =
        snprintf(text, sizeof text, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n");
    for (int i = 0; i < 4; i++) {
        const double x = i == 1 || i == 2, y = i > 1;
        used += snprintf(text + used, sizeof text - (size_t)used, "vt %.9g %.9g\n",
                         0.1 + 0.3 * (c * x + s * y), 0.3 + 0.3 * (c * y - s * x));
    }
    snprintf(text + used, sizeof text - (size_t)used,
             "vt .9 .6\nvt .6 .6\nvt .6 .9\nvt .9 .9\nf 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n");
    write_text("plane.obj", text);
    write_text("constant.json", "{\"source\": {\"constant\": [0.36, 0.48, 0.8]}, \"size\": 8, "
                                "\"type\": \"float\", \"reductions\": \"plain\"}");
    RUNS(0, "bake plane.obj --recipe constant.json -o plane.ptx");
    RUNS(0, "unbake plane.ptx --mesh plane.obj --tangent object-normal -o plane.exr --size 128 "
            "--bits 32");
    slv_image image = load("plane.exr");
    const float *n = want_normal;
    const float along = (float)(c * (double)n[0] + s * (double)n[1]),
                across = (float)(c * (double)n[1] - s * (double)n[0]);
    for (int k = 1; k < 10; k++) {
        const double x = k / 10.0, y = (k * 7 % 10) / 10.0;
        check_pixel(&image, 0.1 + 0.3 * (c * x + s * y), 0.3 + 0.3 * (c * y - s * x), along, across,
                    n[2], "leaning");
        check_pixel(&image, 0.6 + 0.3 * x, 0.6 + 0.3 * y, -n[0], n[1], n[2], "mirrored");
    }
    slv_image_free(&image);
    RUNS(0, "unbake plane.ptx --mesh plane.obj --tangent object-normal -o one.png --threads 1");
    RUNS(0, "unbake plane.ptx --mesh plane.obj --tangent object-normal -o four.png --threads 4");
    CHECK(uv_same_files("one.png", "four.png"));
}

/* A cylinder of flat quads with round normals: against the frame, which turns from vertex to
 * vertex, a quad's own normal leans one way and then the other. */
static void cylinder(void) {
    enum { N = 12 };
    static char text[8192];
    int used = 0;
    for (int i = 0; i < N; i++) {
        const double angle = 2 * 3.14159265358979 * i / N;
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "v %.9g %.9g 0\nv %.9g %.9g 1\nvn %.9g %.9g 0\n", cos(angle), sin(angle),
                         cos(angle), sin(angle), cos(angle), sin(angle));
    }
    for (int i = 0; i <= N; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, "vt %.9g 0.25\nvt %.9g 0.75\n",
                         (double)i / N, (double)i / N);
    for (int i = 0; i < N; i++) {
        const int j = (i + 1) % N;
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "f %d/%d/%d %d/%d/%d %d/%d/%d %d/%d/%d\n", 2 * i + 1, 2 * i + 1, i + 1,
                         2 * j + 1, 2 * i + 3, j + 1, 2 * j + 2, 2 * i + 4, j + 1, 2 * i + 2,
                         2 * i + 2, i + 1);
    }
    write_text("cylinder.obj", text);
    RUNS(0, "bake cylinder.obj --surface normal --scheme bilinear --size 16 --type float "
            "--reductions plain -o cylinder.ptx");
    RUNS(0, "unbake cylinder.ptx --mesh cylinder.obj --tangent object-normal -o cylinder.exr "
            "--size 384x64 --bits 32");
    slv_image image = load("cylinder.exr");
    const double half = tan(3.14159265358979 / N);
    for (int i = 1; i + 1 < N; i++) /* the first and the last are at the seam, with half a frame */
        for (int k = 4; k < 28; k++) {
            const double at = (k + 0.5) / 32, angle = atan((2 * at - 1) * half);
            check_pixel(&image, (i + at) / N, 0.5, (float)-sin(angle), 0, (float)cos(angle),
                        "cylinder");
        }
    slv_image_free(&image);
}

/* Where coordinates have no area, or there are none, a frame is still a frame: nothing that is no
 * number comes out, and faces beside them have theirs. */
static void degenerate(void) {
    write_text("flat.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\nv 3 1 0\n"
               "vt .1 .1\nvt .4 .1\nvt .4 .4\nvt .1 .4\nvt .8 .1\nvt .8 .4\n"
               "f 1/1 2/2 3/3 4/4\nf 2/2 5/2 6/3 3/3\nf 5/2 7/5 8/6 6/3\nf 7 8 9\n"
               "f 7/5 8/6 9/6\n");
    RUNS(0, "bake flat.obj --recipe constant.json -o flat.ptx");
    HAS("flat.obj: 2 polygons have no area, the first is 3");
    RUNS(0, "unbake flat.ptx --mesh flat.obj --tangent object-normal -o flat.exr --size 64 --bits "
            "32");
    slv_image image = load("flat.exr");
    for (uint32_t i = 0; i < 64 * 64 * 3; i++)
        CHECK_MSG(image.pixels[i] >= 0 && image.pixels[i] <= 1, "%u: %g", i,
                  (double)image.pixels[i]);
    const float *n = want_normal;
    check_pixel(&image, 0.2, 0.3, n[0], n[1], n[2], "beside no area");
    check_pixel(&image, 0.6, 0.2, n[0], n[1], n[2], "beyond no area");
    slv_image_free(&image);
}

/* The same detailed mesh along the mesh's axes and in the faces' own frames, which run every way.
 */
static void both_frames(void) {
    write_text("turned.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                             "vt .1 .1\nvt .5 .1\nvt .5 .5\nvt .1 .5\nvt .9 .1\nvt .9 .5\n"
                             "f 1/1 2/2 3/3 4/4\nf 6/6 3/3 2/2 5/5\n");
    write_text("tilted.obj", "v -1 -1 -.1\nv 3 -1 .3\nv 3 2 .3\nv -1 2 -.1\nf 1 2 3 4\n");
    static const char *const kinds[] = {"object-normal", "face-normal"};
    slv_image images[2];
    for (int k = 0; k < 2; k++) {
        RUNS(0,
             "bake turned.obj --detail tilted.obj --detail-kind %s --front 1 --back 1 --size 16 "
             "-o %s.ptx",
             kinds[k], kinds[k]);
        RUNS(0, "unbake %s.ptx --mesh turned.obj --tangent %s -o %s.exr --size 64 --bits 32",
             kinds[k], kinds[k], kinds[k]);
        char name[64];
        snprintf(name, sizeof name, "%s.exr", kinds[k]);
        images[k] = load(name);
    }
    for (int k = 1; k < 20; k++) {
        const double u = 0.1 + 0.04 * k, v = 0.1 + 0.4 * ((k * 7) % 20) / 20;
        for (int i = 0; i < 2; i++)
            check_pixel(&images[i], u, v, -0.0995f, 0, 0.995f, kinds[i]);
    }
    slv_image_free(&images[0]);
    slv_image_free(&images[1]);
}

static void refused(void) {
    RUNS(0, "new plane.obj bytes.ptx --channels 3 --size 4 --quiet");
    RUNS(1, "unbake bytes.ptx --mesh plane.obj --tangent object-normal -o none.png");
    HAS("half or float");
    RUNS(2, "unbake plane.ptx --mesh plane.obj --scheme loop -o none.png");
    RUNS(2, "unbake plane.ptx --mesh plane.obj --tangent tangent -o none.png");
    CHECK(access(tool_path("none.png"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    plane();
    cylinder();
    degenerate();
    both_frames();
    refused();
    tool_end();
    return test_end();
}
