/* The command `selvage convert`: what comes back is what went in, and what was asked for is what
 * comes. */
#include "kit/ptx_same.h"
#include "kit/tool_kit.h"

#include <selvage/image.h>
#include <selvage/ptx_resize.h>

#include <sys/stat.h>

#define SAME(a, b) RUNS(0, "diff '%s' '%s'", a, b)

static void copy_is_same(const char *path) {
    char original[512], copy[512];
    snprintf(original, sizeof original, "%s", path[0] == '/' ? path : tool_path(path));
    snprintf(copy, sizeof copy, "%s", tool_path("copy.ptx"));
    same_content(original, copy);
    remove(copy);
}

/* Through every form and back, nothing is lost. */
static void there_and_back(const char *path) {
    char first[240];
    RUNS(0, "convert '%s' copy.ptx", path);
    CHECK_MSG(count_findings(tool_path("copy.ptx"), first, sizeof first) == 0, "%s: %s", path,
              first);
    slv_ptx *ptx = tool_open("copy.ptx");
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces;
    slv_ptx_close(ptx);
    copy_is_same(path);
    if (nfaces <= (test_brief() ? 100 : 2000)) { /* an image each */
        RUNS(0, "convert '%s' faces", path);
        RUNS(0, "convert faces copy.ptx");
        copy_is_same(path);
    }
    RUNS(0, "convert '%s' sheet.exr", path);
    RUNS(0, "convert sheet.json copy.ptx");
    copy_is_same(path);
}

static slv_ptx_face face_of(const char *name, uint32_t face, void *texels) {
    slv_ptx *ptx = tool_open(name);
    slv_ptx_face info;
    REQUIRE(!slv_ptx_get_face(ptx, face, &info));
    if (texels)
        REQUIRE(!slv_ptx_read_face(ptx, face, info.res, texels));
    slv_ptx_close(ptx);
    return info;
}

static slv_ptx_info info_of(const char *name) {
    slv_ptx *ptx = tool_open(name);
    slv_ptx_info info = *slv_ptx_get_info(ptx);
    slv_ptx_close(ptx);
    return info;
}

static void check_types(void) {
    RUNS(0, "convert rgb.ptx half.ptx --type half");
    CHECK(info_of("half.ptx").type == SLV_TYPE_HALF);
    RUNS(0, "diff rgb.ptx half.ptx --texels --tolerance 0.0005");
    RUNS(0, "convert half.ptx back.ptx --type uint8");
    SAME("rgb.ptx", "back.ptx");
    RUNS(0, "convert rgb.ptx wide.ptx -t uint16");
    RUNS(0, "diff rgb.ptx wide.ptx --texels --tolerance 0.000001");
    RUNS(0, "convert rgb.ptx small.ptx --compression 12 --no-reductions --border-u periodic "
            "--border-v black --edge-filter tanvec --no-meta");
    slv_ptx_info info = info_of("small.ptx");
    CHECK(info.nlevels == 1 && info.border_u == SLV_BORDER_PERIODIC);
    CHECK(info.border_v == SLV_BORDER_BLACK && info.edge_filter == SLV_EDGE_FILTER_TANVEC);
    CHECK(info.nmeta == 0);
    RUNS(0, "convert small.ptx large.ptx --reductions --border clamp");
    info = info_of("large.ptx");
    CHECK(info.nlevels == 3 && info.border_u == SLV_BORDER_CLAMP);
    RUNS(0, "check --strict large.ptx");
}

static void check_channels(void) {
    uint8_t rgb[256 * 3], four[256 * 4];
    face_of("rgb.ptx", 2, rgb);
    RUNS(0, "convert rgb.ptx four.ptx --channels 2,1,=1,0 --alpha 2");
    CHECK(info_of("four.ptx").alpha_channel == 2);
    face_of("four.ptx", 2, four);
    for (int i = 0; i < 256; i++)
        if (four[4 * i] != rgb[3 * i + 2] || four[4 * i + 1] != rgb[3 * i + 1] ||
            four[4 * i + 2] != 255 || four[4 * i + 3] != rgb[3 * i]) {
            CHECK_MSG(false, "texel %d", i);
            break;
        }
    RUNS(0, "convert four.ptx moved.ptx --channels 2,0");
    CHECK(info_of("moved.ptx").alpha_channel == 0);
    RUNS(0, "convert four.ptx gone.ptx --channels 3,1,0");
    CHECK(info_of("gone.ptx").alpha_channel == SLV_NO_ALPHA);
    SAME("gone.ptx", "rgb.ptx");
    tool_write_noise("alpha.ptx", SLV_TYPE_FLOAT, 4, 3, 9);
    RUNS(0, "convert alpha.ptx multiplied.ptx --premultiply");
    RUNS(0, "convert multiplied.ptx divided.ptx --unmultiply");
    RUNS(1, "diff alpha.ptx multiplied.ptx --tolerance 0.00001");
    RUNS(0, "diff alpha.ptx divided.ptx --tolerance 0.00001");
    RUNS(1, "convert rgb.ptx x.ptx --premultiply");
    HAS("has no alpha channel");
}

static void check_sizes(void) {
    RUNS(0, "convert rgb.ptx sized.ptx --scale 1/4 --res 3=64x2,5=16 --max 8x32 --min 1x8");
    slv_ptx_face f = face_of("sized.ptx", 0, NULL);
    CHECK(f.res.u == 2 && f.res.v == 3);
    f = face_of("sized.ptx", 3, NULL);
    CHECK(f.res.u == 6 && f.res.v == 1);
    RUNS(0, "diff rgb.ptx sized.ptx --texels --tolerance 0.4 --json");
    RUNS(0, "check --strict sized.ptx");
    uint8_t from[256 * 3], to[64 * 3];
    RUNS(0, "convert rgb.ptx half.ptx --scale 1/2");
    face_of("rgb.ptx", 1, from);
    face_of("half.ptx", 1, to);
    for (int i = 0; i < 64 * 3; i++) {
        int x = i / 3 % 8, y = i / 24, c = i % 3;
        const uint8_t *p = from + (2 * y * 16 + 2 * x) * 3 + c;
        int sum = p[0] + p[3] + p[48] + p[51];
        if (abs(4 * to[i] - sum) > 2) {
            CHECK_MSG(false, "value %d: %d of %d", i, to[i], sum);
            break;
        }
    }
    RUNS(0, "convert rgb.ptx double.ptx --scale 2");
    CHECK(face_of("double.ptx", 0, NULL).res.u == 5);
    RUNS(0, "check --strict double.ptx");
    const char *data = data_folder();
    RUNS(0, "convert '%s/tri_closed_half_4.ptx' tri.ptx --scale 2", data);
    RUNS(0, "check tri.ptx");
    RUNS(0, "convert tri.ptx tri2.ptx --scale 1/2");
    RUNS(0, "diff '%s/tri_closed_half_4.ptx' tri2.ptx --tolerance 0.001", data);
    RUNS(2, "convert '%s/tri_closed_half_4.ptx' tri.ptx --max 4x8", data);
}

/* A slope stays a slope, and a texel's parts keep its value. */
static void check_resize(void) {
    slv_env env = test_env();
    float from[8], to[32], triangle[4] = {1, 2, 3, 4}, larger[64];
    for (int i = 0; i < 8; i++)
        from[i] = (float)i + 0.5f;
    REQUIRE(!slv_ptx_resize(&env, SLV_PTX_QUAD, 1, (slv_res){3, 0}, from, (slv_res){5, 0}, to));
    for (int i = 4; i < 28; i++)
        CHECK(fabsf(to[i] - ((float)i + 0.5f) / 4) < 1e-6f);
    CHECK(to[0] == 0.5f && to[31] == 7.5f);
    REQUIRE(!slv_ptx_resize(&env, SLV_PTX_TRIANGLE, 1, (slv_res){1, 1}, triangle, (slv_res){3, 3},
                            larger));
    REQUIRE(
        !slv_ptx_resize(&env, SLV_PTX_TRIANGLE, 1, (slv_res){3, 3}, larger, (slv_res){1, 1}, to));
    CHECK(memcmp(to, triangle, sizeof triangle) == 0);
    CHECK(slv_ptx_resize(&env, SLV_PTX_TRIANGLE, 1, (slv_res){1, 2}, from, (slv_res){1, 1}, to) ==
          SLV_ERROR_ARGUMENT);
    CHECK(slv_ptx_resize(&env, SLV_PTX_QUAD, 1, (slv_res){17, 0}, from, (slv_res){0, 0}, to) ==
          SLV_ERROR_ARGUMENT);
}

static void check_images(void) {
    slv_env env = test_env();
    slv_image image = {0};
    uint8_t rgb[256 * 3];
    face_of("rgb.ptx", 7, rgb);
    RUNS(0, "convert rgb.ptx pictures/");
    REQUIRE(!slv_image_load(&env, tool_path("pictures/face_000007.png"), &image));
    CHECK(image.width == 16 && image.height == 16 && image.nchannels == 3);
    CHECK(fabsf(image.pixels[15 * 16 * 3 + 1] * 255 - rgb[1]) < 1e-3f);
    image.pixels[15 * 16 * 3 + 1] = 1.0f;
    slv_image_params raw = {.encoding = SLV_ENCODE_RAW};
    REQUIRE(!slv_image_save(&env, tool_path("pictures/face_000007.png"), &image, &raw));
    slv_image_free(&image);
    REQUIRE(symlink("pictures", tool_path("link")) == 0);
    RUNS(0, "convert pictures painted.ptx");
    RUNS(0, "convert painted.ptx link");
    RUNS(0, "convert link painted.ptx");
    face_of("painted.ptx", 7, rgb);
    CHECK(rgb[1] == 255);
    RUNS(1, "diff rgb.ptx painted.ptx");
    HAS("face 7: 1 of 256 texels");
    REQUIRE(!slv_image_create(&env, 12, 8, 3, &image));
    REQUIRE(!slv_image_save(&env, tool_path("pictures/face_000003.png"), &image, &raw));
    slv_image_free(&image);
    RUNS(1, "convert pictures bad.ptx");
    HAS("face 3: its image is 12 x 8, which is not made of powers of two");
    CHECK(access(tool_path("bad.ptx"), F_OK) != 0);
    RUNS(0, "convert rgb.ptx sheet.png --channels 0 --progress");
    HAS("convert: 100%");
    HAS("writing: 100%");
    RUNS(0, "convert sheet.json grey.ptx --type half --scale 1/2");
    CHECK(info_of("grey.ptx").nchannels == 1);
}

/* Integers that are light in the texture go through PNG: 8 bits as 16 of sRGB; 16 as they stand,
 * and the PNG says so. If a program drops that, the index says it, and if it makes sRGB of them,
 * they are decoded. */
static void check_light(void) {
    static const char *const types[] = {"uint8", "uint16"};
    slv_env env = test_env();
    for (int i = 0; i < 2; i++) {
        slv_image image = {0};
        RUNS(0, "convert rgb.ptx light.ptx --scale 2 --type %s --texture-encoding linear",
             types[i]);
        RUNS(0, "convert light.ptx light_%d", i);
        RUNS(0, "convert light_%d again.ptx", i);
        LACKS("warning");
        RUNS(0, "diff light.ptx again.ptx");
        RUNS(0, "convert light.ptx light.png");
        RUNS(0, "convert light.json again.ptx");
        RUNS(0, "diff light.ptx again.ptx");
        RUNS(0, "convert rgb.ptx same.ptx --scale 2 --type %s", types[i]);
        RUNS(0, "convert same.ptx numbers --texture-encoding linear");
        RUNS(0, "convert numbers again.ptx --texture-encoding linear");
        RUNS(0, "diff light.ptx again.ptx");
        REQUIRE(!slv_image_load(&env, tool_path("light.png"), &image));
        CHECK(i ? image.encoding == SLV_TEXTURE_LINEAR && !image.encoding_is_assumed
                : image.encoding == SLV_TEXTURE_SRGB);
        slv_image_params form = {.encoding = SLV_ENCODE_RAW, .bits = 16};
        REQUIRE(!slv_image_save(&env, tool_path("light.png"), &image, &form));
        RUNS(0, "convert light.json again.ptx");
        if (i)
            HAS("light.png: does not say any more that its numbers are light");
        else
            LACKS("warning");
        RUNS(0, "diff light.ptx again.ptx");
        form.encoding = i ? SLV_ENCODE_SRGB : SLV_ENCODE_RAW;
        REQUIRE(!slv_image_save(&env, tool_path("light.png"), &image, &form));
        slv_image_free(&image);
        RUNS(0, "convert light.json again.ptx");
        LACKS("warning");
        RUNS(0, "diff light.ptx again.ptx --texels --tolerance 0.00003");
    }
}

#define INDEX_TOP "{\"schema\":1,\"kind\":\"faces\","
#define INDEX_FORM                                                                                 \
    "\"mesh_type\":\"quad\",\"data_type\":\"uint8\",\"border_u\":\"clamp\",\"border_v\":"          \
    "\"clamp\",\"edge_filter\":\"none\",\"channels\":1,"
#define INDEX INDEX_TOP INDEX_FORM
#define INDEX_FACE "\"faces\":[{\"width\":2,\"height\":1}]"
#define INDEX_META(type, value)                                                                    \
    INDEX INDEX_FACE ",\"meta\":[{\"key\":\"k\",\"type\":\"" type "\",\"values\":[" value "]}]}"
#define INDEX_SHEET(place)                                                                         \
    INDEX "\"images\":[\"s.png\"],\"faces\":[{\"width\":2,\"height\":1" place "}]}"

static void check_hostile(void) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "bad.json:"},
        {"{", "bad.json:"},
        {"[]", "schema is missing"},
        {"{\"faces\": 3}", "schema is missing"},
        {"{\"schema\":2,\"kind\":\"faces\"," INDEX_FORM INDEX_FACE "}", "schema is missing"},
        {"{\"schema\":1,\"kind\":\"views\"," INDEX_FORM INDEX_FACE "}", "kind is missing"},
        {"{\"schema\":1," INDEX_FORM INDEX_FACE "}", "kind is missing"},
        {INDEX "\"faces\":[{\"width\":3,\"height\":1}]}", "face 0"},
        {INDEX "\"faces\":[{\"width\":2,\"height\":1,\"adjacent_faces\":[7]}]}", "face 0"},
        {INDEX_SHEET(",\"x\":5,\"y\":-1"), "face 0: lies outside"},
        {INDEX_SHEET(",\"x\":0"), "face 0: y is missing"},
        {INDEX_SHEET(",\"x\":\"0\",\"y\":0"), "face 0: x is missing"},
        {INDEX_SHEET(",\"x\":0,\"y\":0.0"), "face 0: y is missing"},
        {INDEX INDEX_FACE ",\"meta\":{\"k\":1}}", "meta is missing"},
        {INDEX INDEX_FACE ",\"meta\":null}", "meta is missing"},
        {INDEX_META("int8", "300"), "metadata k: value 0"},
        {INDEX_META("float", "1,\"Infinity\""), "metadata k: value 1"},
        {INDEX_META("double", "\"-\""), "metadata k: value 0"},
        {INDEX_META("string", "65,0,66"), "metadata k: value 1"}};
    slv_env env = test_env();
    slv_image image = {0};
    REQUIRE(!slv_image_create(&env, 2, 2, 1, &image));
    REQUIRE(!slv_image_save(&env, tool_path("s.png"), &image, NULL));
    slv_image_free(&image);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tool_write_file("bad.json", cases[i].text, strlen(cases[i].text));
        RUNS(1, "convert bad.json bad.ptx");
        HAS(cases[i].message);
        char *end = strchr(tool_out, '\n');
        CHECK_MSG(end && !end[1], "text %zu: %s", i, tool_out);
        CHECK(access(tool_path("bad.ptx"), F_OK) != 0);
    }
    const char *good = INDEX "\"images\":[\"s.png\"],\"faces\":[{\"width\":2,\"height\":1,\"x\":0,"
                             "\"y\":1}],\"meta\":[{\"key\":\"k\",\"type\":\"float\",\"values\":"
                             "[\"nan\",\"inf\",\"-inf\",1]}]}";
    tool_write_file("good.json", good, strlen(good));
    RUNS(0, "convert good.json good.ptx");
    CHECK(info_of("good.ptx").nmeta == 1);
}

static void mark_of(const char *name, struct stat *out) {
    REQUIRE(stat(tool_path(name), out) == 0);
}

static void is_untouched(const char *name, const struct stat *before) {
    struct stat now;
    mark_of(name, &now);
    CHECK_MSG(now.st_ino == before->st_ino && now.st_size == before->st_size, "%s", name);
}

/* What cannot be written whole leaves what was there, and nothing beside it. */
static void check_kept(void) {
    struct stat picture, index;
    REQUIRE(mkdir(tool_path("kept"), 0777) == 0);
    RUNS(0, "convert rgb.ptx kept/s.png");
    tool_write_noise("many.ptx", SLV_TYPE_U8, 5, SLV_NO_ALPHA, 3);
    mark_of("kept/s.png", &picture);
    mark_of("kept/s.json", &index);
    REQUIRE(mkdir(tool_path("kept/s.1.png"), 0777) == 0);
    RUNS(1, "convert many.ptx kept/s.png");
    HAS("kept/s.1.png: is a folder, where a file would go");
    is_untouched("kept/s.png", &picture);
    is_untouched("kept/s.json", &index);
    REQUIRE(rmdir(tool_path("kept/s.1.png")) == 0);
    RUNS(0, "convert many.ptx kept/s.png");
    RUNS(0, "convert kept/s.json again.ptx");
    SAME("many.ptx", "again.ptx");
    static const char *const others[] = {"not json", "{\"kind\":\"report\"}", "[]"};
    for (int i = 0; i < 3; i++) {
        tool_write_file("kept/view.json", others[i], strlen(others[i]));
        mark_of("kept/view.json", &index);
        RUNS(1, "convert rgb.ptx kept/view.png");
        HAS("kept/view.json: is there already and is no index");
        is_untouched("kept/view.json", &index);
        CHECK(access(tool_path("kept/view.png"), F_OK) != 0);
    }
    RUNS(0, "convert rgb.ptx kept/faces");
    mark_of("kept/faces/face_000000.png", &picture);
    mark_of("kept/faces/index.json", &index);
    REQUIRE(remove(tool_path("kept/faces/face_000005.png")) == 0);
    REQUIRE(mkdir(tool_path("kept/faces/face_000005.png"), 0777) == 0);
    RUNS(1, "convert many.ptx kept/faces");
    HAS("face_000005.png: is a folder, where a file would go");
    is_untouched("kept/faces/face_000000.png", &picture);
    is_untouched("kept/faces/index.json", &index);
    CHECK(access(tool_path("kept/faces/face_000000.1.png"), F_OK) != 0);
    /* left by a killed export; the other is nobody's of ours */
    REQUIRE(mkdir(tool_path("kept/late.0.selvage"), 0777) == 0);
    tool_write_file("kept/late.0.selvage/face_000000.png", "x", 1);
    REQUIRE(mkdir(tool_path("kept/late.mine.selvage"), 0777) == 0);
    RUNS(0, "convert rgb.ptx kept/late");
    CHECK(access(tool_path("kept/late.0.selvage"), F_OK) != 0);
    CHECK(rmdir(tool_path("kept/late.mine.selvage")) == 0);
    RUNS(0, "--version && ls kept | grep -c selvage || true");
    HAS("\n0\n");
}

/* What was done, in numbers; and what no longer fits is said. */
static void check_summary(void) {
    static const char *const forms[] = {"sum.ptx", "sum.png", "sums"};
    char line[64];
    for (int i = 0; i < 3; i++) {
        RUNS(0, "convert rgb.ptx %s --scale 1/2 --channels 0,1 --json", forms[i]);
        snprintf(line, sizeof line, "\"made\": \"%s\"",
                 i == 0   ? "ptx"
                 : i == 1 ? "sheet"
                          : "folder");
        HAS(line);
        HAS("\"faces\": 10");
        HAS("\"resized_faces\": 10");
        HAS("\"texels\": 640,");
        HAS("\"texel_bytes\": 1280");
        HAS("\"clipped_values\": 0");
        LACKS("warning");
    }
    struct stat status;
    REQUIRE(stat(tool_path("sum.png"), &status) == 0);
    RUNS(0, "convert rgb.ptx sum.png --scale 1/2 --channels 0,1 --json");
    snprintf(line, sizeof line, "\"file_bytes\": %lld", (long long)status.st_size);
    HAS(line);
    RUNS(0, "convert sums sum2.ptx --json");
    HAS("\"source\": \"sums\"");
    HAS("\"texels\": 640,");
    RUNS(0, "convert rgb.ptx wide.ptx --type float --channels 0,=2,=-1");
    RUNS(0, "convert wide.ptx narrow.ptx --type uint8 --json --threads 3");
    HAS("\"clipped_values\": 5120");
    HAS("warning: 5120 values did not fit into uint8 and were clipped");
    RUNS(0, "convert wide.ptx narrow.ptx --type half --progress");
    LACKS("warning");
    HAS("convert: 100% after");
    RUNS(0, "convert wide.ptx narrow.ptx");
    CHECK(!tool_out[0]);
    RUNS(0, "convert wide.ptx huge.ptx --channels 0,=100000");
    RUNS(0, "convert huge.ptx narrow.ptx --type half --json");
    HAS("\"clipped_values\": 2560");
    RUNS(1, "convert rgb.ptx sum3.ptx --json >/dev/full");
    HAS("cannot write the answer");
}

static void check_usage(void) {
    RUNS(2, "convert rgb.ptx");
    RUNS(2, "convert rgb.ptx x.ptx --channels 3");
    RUNS(2, "convert rgb.ptx x.ptx --channels 0,,1");
    RUNS(2, "convert rgb.ptx x.ptx --channels =nan");
    RUNS(2, "convert rgb.ptx x.ptx --alpha 3");
    RUNS(2, "convert rgb.ptx x.ptx --scale 3");
    RUNS(2, "convert rgb.ptx x.ptx --max 7");
    RUNS(2, "convert rgb.ptx x.ptx --min 8 --max 4");
    RUNS(2, "convert rgb.ptx x.ptx --res 10=8");
    RUNS(2, "convert rgb.ptx x.ptx --res 1=8,1=4");
    RUNS(2, "convert rgb.ptx x.ptx --premultiply --unmultiply");
    RUNS(2, "convert rgb.ptx x.png --mesh x.obj");
    RUNS(2, "convert faces x.png");
    RUNS(2, "convert rgb.ptx x.ptx --format png");
    RUNS(2, "convert rgb.ptx x.png --format png");
    RUNS(2, "convert rgb.ptx x.png --compression 3");
    RUNS(2, "convert rgb.ptx x --compression 3");
    static const char *const others[] = {"x.jpg", "x.JPEG", "x.tif", "x.tiff", "x.json"};
    for (int i = 0; i < 5; i++) {
        RUNS(2, "convert rgb.ptx %s", others[i]);
        HAS("expected a folder, .ptx, .png or .exr");
        CHECK(access(tool_path(others[i]), F_OK) != 0);
    }
    RUNS(1, "convert rgb.ptx x.png --res 0=65536x1,1=1x65536,2=1x65536");
    HAS("selvage: x.png: a sheet of 65536 x 65537 is too large");
    RUNS(1, "convert rgb.ptx x.ptx --scale 65536");
    HAS("rgb.ptx: face ");
    HAS(": 65536 x 65536 texels of 3 channels are 48.0 GiB, the limit is 16.0 GiB");
    RUNS(1, "convert nofile.json x.ptx");
    HAS("selvage: nofile.json: No such file or directory\n");
    RUNS(2, "convert rgb.ptx ''");
    RUNS(2, "convert -- rgb.ptx ''");
    RUNS(2, "info ''");
    RUNS(2, "diff rgb.ptx rgb.ptx --images ''");
    RUNS(1, "convert missing.ptx x.ptx");
    RUNS(1, "convert rgb.ptx nowhere/x.ptx");
    RUNS(1, "convert rgb.ptx rgb.ptx/x");
    RUNS(0, "convert --help");
    HAS("Examples:");
    CHECK(access(tool_path("x.ptx"), F_OK) != 0);
}

/* The same said in two ways. */
static void check_spellings(void) {
    static const char *const same[][2] = {
        {"--channels 2,1,0", "--channels b,g,r"},
        {"--channels 2,1,0", "--channels bgr"},
        {"--channels 2,1,0", "--channel B,1,r"},
        {"--channels 0,1,2,=0.5", "--channels 0-2,=1/2"},
        {"--channels 0,1,2,=1 --alpha 3", "--channels rgb,=1 --alpha 3"},
        {"--scale 1/2", "--scale 0.5"},
        {"--scale 4", "--scale 4.0"},
        {"--scale 1/4", "--scale 2/8"},
        {"--res 0=8,1=8,2=8,3=4x8", "--res 0-2=8,3=4x8"},
        {"--faces 1,2,3,4,6", "--faces 6,1-4"},
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        RUNS(0, "convert rgb.ptx first.ptx %s", same[i][0]);
        RUNS(0, "convert rgb.ptx -o second.ptx %s", same[i][1]);
        RUNS(0, "diff first.ptx second.ptx");
    }
    RUNS(0, "convert rgb.ptx rgba.ptx --channels r,g,b,=1 --alpha 3");
    /* of the result, which has a fourth channel where the source has none */
    RUNS(0, "convert rgb.ptx first.ptx --channels rgb,=1 --alpha a");
    RUNS(0, "diff rgba.ptx first.ptx");
    RUNS(2, "convert rgb.ptx x.ptx --alpha a");
    HAS("'a' is neither none nor a channel of the result, 0 to 2");
    RUNS(0, "convert rgba.ptx first.ptx --channels a,r");
    RUNS(0, "convert rgba.ptx second.ptx --channels 3,0 --alpha a");
    RUNS(0, "diff first.ptx second.ptx");
    RUNS(2, "convert rgb.ptx x.ptx --channels r,x");
    HAS("'x': the file has channels 0 to 2, also called r, g, b");
    RUNS(2, "convert rgb.ptx x.ptx --channels a");
    RUNS(2, "convert rgb.ptx x.ptx --channels 1-");
    RUNS(2, "convert rgb.ptx x.ptx --channels 1-3");
    RUNS(2, "convert rgb.ptx x.ptx --scale 0.3");
    RUNS(2, "convert rgb.ptx x.ptx --scale 1/0");
    RUNS(2, "convert rgb.ptx x.ptx --scale -2");
    RUNS(2, "convert rgb.ptx x.ptx --res 0-3=8,2=4");
    RUNS(2, "convert rgb.ptx x.ptx --res 3-0=8");
    RUNS(2, "convert rgb.ptx x.ptx y.ptx");
    RUNS(2, "convert rgb.ptx x.ptx -o y.ptx");
    HAS("two names");
    RUNS(2, "convert rgb.ptx");
    HAS("the output is missing");
}

/* The text with `what` before the first `before`, in place of the old one. */
static char *insert(char *text, const char *before, const char *what) {
    const char *at = strstr(text, before);
    REQUIRE(at);
    char *out = calloc(1, strlen(text) + strlen(what) + 1);
    REQUIRE(out);
    memcpy(out, text, (size_t)(at - text));
    strcat(strcat(out, what), at);
    free(text);
    return out;
}

/* Fields of an index that nobody reads are named, with those that may have been meant. */
static void check_fields(void) {
    enum { ROOM = 1 << 20 };
    RUNS(0, "convert rgb.ptx pictures --res 0=8");
    FILE *stream = fopen(tool_path("pictures/index.json"), "rb");
    char *text = calloc(1, ROOM);
    REQUIRE(stream && text && fread(text, 1, ROOM - 1, stream) > 0);
    fclose(stream);
    text = insert(text, "\"border_u\"", "\"boarder_u\": 1, ");
    text = insert(text, "\"constant\"", "\"widht\": 8, ");
    tool_write_file("pictures/index.json", text, strlen(text));
    free(text);
    RUNS(0, "convert pictures back.ptx");
    HAS("the field 'boarder_u' is not used; did you mean 'border_u'?");
    HAS("face 0: the field 'widht' is not used; did you mean 'width'?");
}

int main(void) {
    tool_begin();
    CHECK(each_sample(there_and_back) > 0);
    tool_write_noise("rgb.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    there_and_back("rgb.ptx");
    check_types();
    check_channels();
    check_sizes();
    check_resize();
    check_images();
    check_light();
    check_summary();
    check_hostile();
    check_kept();
    check_usage();
    check_spellings();
    check_fields();
    tool_end();
    return test_end();
}
