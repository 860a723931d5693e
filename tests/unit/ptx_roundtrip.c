/* Textures of every kind written, read back and compared; with any number of threads the same
 * bytes. */
#include "kit/ptx_kit.h"

static uint64_t seed = 7;

static bool same_file(const char *a, const char *b) {
    size_t size_a = 0, size_b = 0;
    uint8_t *bytes_a = read_whole(a, &size_a), *bytes_b = read_whole(b, &size_b);
    bool same = bytes_a && bytes_b && size_a == size_b && !memcmp(bytes_a, bytes_b, size_a);
    free(bytes_a);
    free(bytes_b);
    return same;
}

static void fill(slv_type type, void *texels, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint32_t r = test_random(&seed);
        switch (type) {
        case SLV_TYPE_U8:
            ((uint8_t *)texels)[i] = (uint8_t)r;
            break;
        case SLV_TYPE_U16:
            ((uint16_t *)texels)[i] = (uint16_t)r;
            break;
        case SLV_TYPE_HALF:
            ((uint16_t *)texels)[i] = (uint16_t)(r % 0x7c00 | (r & 0x10000) >> 1);
            break;
        case SLV_TYPE_FLOAT:
            ((float *)texels)[i] = (float)r / 1e9f - 1.0f;
            break;
        }
    }
}

static slv_texture *random_texture(slv_type type, uint32_t nchannels, uint32_t nfaces,
                                   int largest) {
    slv_env env = test_env();
    slv_texture *texture = NULL;
    slv_res *res = calloc(nfaces, sizeof *res);
    for (uint32_t face = 0; face < nfaces; face++) {
        res[face].u = (int8_t)(test_random(&seed) % (uint32_t)(largest + 1));
        res[face].v = (int8_t)(test_random(&seed) % (uint32_t)(largest + 1));
    }
    slv_texture_desc desc = {
        nfaces,    type,
        nchannels, test_random(&seed) % 2 ? SLV_NO_ALPHA : (int32_t)nchannels - 1,
        res,       SLV_TEXTURE_AUTO};
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    size_t pixel = slv_type_size(type) * nchannels;
    uint8_t *texels = malloc(pixel << (2 * largest));
    for (uint32_t face = 0; face < nfaces; face++) {
        size_t count = (size_t)1 << (res[face].u + res[face].v);
        uint32_t kind = test_random(&seed) % 4;
        fill(type, texels, count * nchannels);
        if (kind == 0)
            REQUIRE(slv_texture_set_constant(texture, face, texels) == SLV_OK);
        if (kind == 1) /* half of it constant, so that large faces get constant tiles */
            for (size_t i = 1; i < count / 2; i++)
                memcpy(texels + i * pixel, texels, pixel);
        if (kind)
            REQUIRE(slv_texture_set_face(texture, face, texels) == SLV_OK);
    }
    free(texels);
    free(res);
    return texture;
}

static void compare_textures(const slv_texture *a, const slv_texture *b) {
    const slv_texture_desc *da = slv_texture_get_desc(a), *db = slv_texture_get_desc(b);
    REQUIRE(da->nfaces == db->nfaces && da->type == db->type && da->nchannels == db->nchannels);
    CHECK(da->alpha_channel == db->alpha_channel);
    for (uint32_t face = 0; face < da->nfaces; face++) {
        REQUIRE(da->res[face].u == db->res[face].u && da->res[face].v == db->res[face].v);
        bool constant = slv_texture_is_constant(a, face);
        CHECK(constant == slv_texture_is_constant(b, face));
        size_t count = constant ? 1 : (size_t)1 << (da->res[face].u + da->res[face].v);
        CHECK_MSG(!memcmp(slv_texture_texels(a, face), slv_texture_texels(b, face),
                          count * da->nchannels * slv_type_size(da->type)),
                  "face %u", face);
    }
}

static void round_trip(slv_type type, uint32_t nchannels, int largest, bool with_mesh) {
    slv_env env = test_env(), one = test_env();
    one.threads = 1;
    env.threads = 3;
    slv_mesh *mesh = grid_mesh(4, 3, with_mesh), *mesh_again = NULL;
    slv_adjacency *adjacency = NULL;
    slv_ptx *ptx = NULL;
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_texture *texture = random_texture(type, nchannels, nfaces, largest), *again = NULL;
    double numbers[200];
    for (int i = 0; i < 200; i++)
        numbers[i] = i * 0.1;
    slv_ptx_meta meta[] = {{"comment", SLV_META_STRING, 5, "hello"},
                           {"empty", SLV_META_STRING, 0, ""},
                           {"numbers", SLV_META_DOUBLE, 200, numbers},
                           {"PtexVertPositions", SLV_META_DOUBLE, 1, numbers}};
    slv_ptx_write_params params = {.mesh = with_mesh ? mesh : NULL,
                                   .border_u = SLV_BORDER_PERIODIC,
                                   .edge_filter = SLV_EDGE_FILTER_TANVEC,
                                   .compression = with_mesh ? 1 : 0,
                                   .nmeta = 4,
                                   .meta = meta};
    const char *path = scratch_path("a.ptx"), *serial = scratch_path("b.ptx");
    REQUIRE(slv_ptx_save(&env, path, texture, adjacency, &params) == SLV_OK);
    REQUIRE(slv_ptx_save(&one, serial, texture, adjacency, &params) == SLV_OK);
    CHECK(same_file(path, serial));
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(!strcmp(slv_ptx_name(ptx), path));
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    CHECK(info->mesh_type == SLV_PTX_QUAD && info->border_u == SLV_BORDER_PERIODIC &&
          info->border_v == SLV_BORDER_CLAMP && info->edge_filter == SLV_EDGE_FILTER_TANVEC &&
          info->minor_version == 4 && !info->has_edits);
    REQUIRE(slv_ptx_load_texture(&env, ptx, &again) == SLV_OK);
    compare_textures(texture, again);
    CHECK(slv_ptx_match_mesh(&env, ptx, mesh) == SLV_OK);
    const slv_ptx_meta *found = slv_ptx_find_meta(ptx, "numbers");
    CHECK(found && found->count == 200 && !memcmp(found->values, numbers, sizeof numbers));
    found = slv_ptx_find_meta(ptx, "comment");
    CHECK(found && found->count == 5 && !strcmp(found->values, "hello"));
    found = slv_ptx_find_meta(ptx, "empty");
    CHECK(found && found->count == 0 && !strcmp(found->values, ""));
    CHECK(!slv_ptx_find_meta(ptx, "nothing"));
    if (with_mesh) {
        REQUIRE(slv_ptx_load_mesh(&env, ptx, &mesh_again) == SLV_OK);
        const slv_mesh_view *a = slv_mesh_get_view(mesh), *b = slv_mesh_get_view(mesh_again);
        CHECK(a->nverts == b->nverts && a->npolys == b->npolys &&
              !memcmp(a->positions, b->positions, 12 * a->nverts) &&
              !memcmp(a->poly_sizes, b->poly_sizes, 4 * a->npolys) &&
              !memcmp(a->poly_verts, b->poly_verts, 4 * (4 * a->npolys + 1)));
    } else /* the entry that the caller gave has a type of its own */
        CHECK(slv_ptx_load_mesh(&env, ptx, &mesh_again) == SLV_ERROR_UNSUPPORTED);
    slv_ptx_close(ptx);
    slv_texture_destroy(texture);
    slv_texture_destroy(again);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(mesh_again);
    remove(path);
    remove(serial);
}

/* Reductions of a plain gradient, against arithmetic done here. */
static void reductions(void) {
    slv_env env = test_env();
    slv_res res = {3, 4};
    slv_texture_desc desc = {1, SLV_TYPE_U8, 1, SLV_NO_ALPHA, &res, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    slv_ptx *ptx = NULL;
    uint8_t texels[128], out[128];
    for (int i = 0; i < 128; i++)
        texels[i] = (uint8_t)(i % 8 * 5 + i / 8);
    const char *path = scratch_path("reduced.ptx");
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_texture_set_face(texture, 0, texels) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, path, texture, NULL, NULL) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(slv_ptx_get_info(ptx)->nlevels == 2);
    REQUIRE(slv_ptx_read_face(ptx, 0, (slv_res){2, 4}, out) == SLV_OK);
    for (int i = 0; i < 64; i++)
        CHECK(out[i] == (texels[2 * i] + texels[2 * i + 1]) / 2);
    REQUIRE(slv_ptx_read_face(ptx, 0, (slv_res){2, 3}, out) == SLV_OK);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 4; x++) {
            const uint8_t *p = texels + 16 * y + 2 * x;
            CHECK(out[4 * y + x] == (p[0] + p[1] + p[8] + p[9]) / 4);
        }
    CHECK(slv_ptx_read_face(ptx, 0, (slv_res){4, 4}, out) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 0"));
    CHECK(slv_ptx_read_face(ptx, 0, (slv_res){-1, 0}, out) == SLV_ERROR_ARGUMENT);
    CHECK(slv_ptx_read_face(ptx, 1, (slv_res){0, 0}, out) == SLV_ERROR_ARGUMENT);
    slv_ptx_face face;
    CHECK(slv_ptx_get_face(ptx, 0, &face) == SLV_OK && face.adjacency.face[3] == SLV_BOUNDARY);
    CHECK(slv_ptx_get_face(ptx, 1, &face) == SLV_ERROR_ARGUMENT);
    slv_ptx_close(ptx);
    slv_texture_destroy(texture);
    remove(path);
}

static void refusals(void) {
    slv_env env = test_env();
    slv_res res[2] = {{1, 1}, {1, 1}};
    slv_texture_desc desc = {2, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    char key[300];
    memset(key, 'k', sizeof key);
    key[255] = 0;
    const char *path = scratch_path("refused.ptx");
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    slv_ptx_meta meta = {key, SLV_META_STRING, 1, "x"};
    slv_ptx_write_params params = {.nmeta = 1, .meta = &meta};
    CHECK(slv_ptx_save(&env, path, texture, NULL, &params) == SLV_ERROR_ARGUMENT);
    meta = (slv_ptx_meta){"none", SLV_META_INT32, 0, NULL};
    CHECK(slv_ptx_save(&env, path, texture, NULL, &params) == SLV_ERROR_ARGUMENT);
    params = (slv_ptx_write_params){.compression = 13};
    CHECK(slv_ptx_save(&env, path, texture, NULL, &params) == SLV_ERROR_ARGUMENT);
    slv_mesh *mesh = grid_mesh(3, 1, false);
    params = (slv_ptx_write_params){.mesh = mesh};
    CHECK(slv_ptx_save(&env, path, texture, NULL, &params) == SLV_ERROR_MISMATCH);
    CHECK(access(path, F_OK) != 0);
    CHECK(slv_ptx_save(&env, "/nowhere/at/all.ptx", texture, NULL, NULL) == SLV_ERROR_IO);
    CHECK(strstr(test_last_log, "/nowhere/at/all.ptx"));
    key[254] = 0; /* the longest that the format can hold */
    meta = (slv_ptx_meta){key, SLV_META_STRING, 1, "x"};
    params = (slv_ptx_write_params){.nmeta = 1, .meta = &meta};
    REQUIRE(slv_ptx_save(&env, path, texture, NULL, &params) == SLV_OK);
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(slv_ptx_find_meta(ptx, key));
    slv_ptx_close(ptx);
    slv_mesh_destroy(mesh);
    slv_texture_destroy(texture);
    remove(path);
}

int main(void) {
    for (int type = 0; type < 4; type++)
        for (uint32_t nchannels = 1; nchannels <= 5; nchannels++)
            round_trip((slv_type)type, nchannels, 5, nchannels % 2);
    round_trip(SLV_TYPE_FLOAT, 3, 8, true);
    round_trip(SLV_TYPE_U16, 4, 8, false);
    round_trip(SLV_TYPE_U8, 70000 / 8, 3, false);
    round_trip(SLV_TYPE_FLOAT, 40000, 2, false); /* one texel is more than two tiles */
    reductions();
    refusals();
    return test_end();
}
