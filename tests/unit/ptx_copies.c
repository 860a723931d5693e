/* Copies hold what the original holds, and everything that is written is sound: of samples, and of
 * meshes and resolutions drawn at random. */
#include "kit/ptx_same.h"

#include <selvage/ptx_writer.h>

static void copy_sample(const char *path) {
    const char *bin = getenv("SELVAGE_BIN"), *copy = scratch_path("copy.ptx");
    char line[4096], first[240];
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    CHECK_MSG(count_findings(path, first, sizeof first) == 0, "%s: %s", path, first);
    snprintf(line, sizeof line, "'%s/selvage' convert '%s' '%s'", bin ? bin : "bin", path, copy);
    CHECK_MSG(system(line) == 0, "%s", line);
    same_content(path, copy);
    CHECK_MSG(count_findings(copy, first, sizeof first) == 0, "convert %s: %s", path, first);
    REQUIRE(!slv_ptx_open(&env, path, &ptx));
    REQUIRE(!slv_ptx_rewrite(&env, ptx, copy, NULL));
    slv_ptx_close(ptx);
    same_content(path, copy);
    CHECK_MSG(count_findings(copy, first, sizeof first) == 0, "rewrite %s: %s", path, first);
    remove(copy);
}

/* Files of the folder, and of the folders in it. */
static int each_file(const char *name, void (*visit)(const char *path)) {
    DIR *folder = name ? opendir(name) : NULL;
    int count = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char path[2048];
        size_t length = strlen(entry->d_name);
        snprintf(path, sizeof path, "%s/%s", name, entry->d_name);
        if (entry->d_name[0] == '.')
            continue;
        if (length > 4 && strcmp(entry->d_name + length - 4, ".ptx") == 0) {
            visit(path);
            count++;
        } else {
            count += each_file(path, visit);
        }
    }
    if (folder)
        closedir(folder);
    return count;
}

/* A strip of polygons of 3 to 7 sides side by side, some with a hole between them and the next:
 * each polygon's edge 1 is the next one's last, turned at random. */
static slv_mesh *random_mesh(uint64_t *seed, uint32_t npolys) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    float *positions = calloc((size_t)npolys * 8, 3 * sizeof(float));
    int32_t *sizes = calloc(npolys, sizeof *sizes), *verts = calloc((size_t)npolys * 8, 4);
    uint32_t nverts = 0, length = 0;
    int32_t shared[2] = {-1, -1};
    for (uint32_t poly = 0; poly < npolys; poly++) {
        int32_t n = test_random(seed) % 2 ? 4 : (int32_t)(3 + test_random(seed) % 5), own[8];
        bool apart = shared[0] < 0 || test_random(seed) % 6 == 0;
        int32_t turn = (int32_t)(test_random(seed) % 8);
        for (int32_t i = 0; i < n; i++) {
            bool joined = !apart && i < 2;
            own[i] = joined ? shared[1 - i] : (int32_t)nverts;
            for (int axis = 0; !joined && axis < 3; axis++)
                positions[3 * nverts + (uint32_t)axis] =
                    (float)(test_random(seed) % 1000) / 1000 + (float)poly;
            nverts += !joined;
        }
        shared[0] = own[2 % n];
        shared[1] = own[n > 3 ? 3 : 0];
        for (int32_t i = 0; i < n; i++)
            verts[length++] = own[(i + turn) % n];
        sizes[poly] = n;
    }
    slv_mesh_view view = {.nverts = nverts,
                          .positions = positions,
                          .npolys = npolys,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    REQUIRE(!slv_mesh_create(&env, &view, &mesh));
    free(positions);
    free(sizes);
    free(verts);
    return mesh;
}

/* Values of all sizes, but finite; a third of the faces constant. */
static void random_texels(uint64_t *seed, slv_type type, size_t count, bool constant,
                          uint32_t nchannels, void *out) {
    float *values = malloc(count * nchannels * sizeof *values);
    for (size_t i = 0; i < count * nchannels; i++)
        values[i] = constant && i >= nchannels ? values[i - nchannels]
                                               : (float)(test_random(seed) % 4096) / 4096;
    slv_type_from_float(type, values, count * nchannels, out);
    free(values);
}

static void write_random(uint64_t *seed, const char *path) {
    slv_env env = test_env();
    bool triangle = test_random(seed) % 4 == 0;
    slv_mesh *mesh = triangle ? NULL : random_mesh(seed, 1 + test_random(seed) % 40);
    slv_ptx_writer_params params = {.mesh_type = triangle ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD,
                                    .type = (slv_type)(test_random(seed) % 4),
                                    .nchannels = 1 + test_random(seed) % 5,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = mesh ? slv_mesh_face_count(mesh)
                                                   : 1 + test_random(seed) % 20,
                                    .border_u = (slv_border_mode)(test_random(seed) % 3),
                                    .border_v = (slv_border_mode)(test_random(seed) % 3),
                                    .edge_filter = (slv_edge_filter)(test_random(seed) % 2),
                                    .no_reductions = test_random(seed) % 4 == 0,
                                    .compression = (int)(test_random(seed) % 13)};
    slv_ptx_writer *writer = NULL;
    slv_ptx_meta meta = {"note", SLV_META_STRING, 5, "hello"};
    if (test_random(seed) % 2)
        params.alpha_channel = (int32_t)(test_random(seed) % params.nchannels);
    REQUIRE(!slv_ptx_writer_create(&env, path, &params, &writer));
    if (mesh)
        REQUIRE(!slv_ptx_writer_set_mesh(writer, mesh));
    if (test_random(seed) % 2)
        REQUIRE(!slv_ptx_writer_set_meta(writer, &meta));
    for (uint32_t face = 0; face < params.nfaces; face++) {
        slv_ptx_face info = {
            .res = {(int8_t)(test_random(seed) % 9), (int8_t)(test_random(seed) % 8)},
            .adjacency = {{-1, -1, -1, -1}, {0}}};
        if (triangle)
            info.res.v = info.res.u;
        size_t count = (size_t)1 << (info.res.u + info.res.v);
        void *texels = malloc(count * params.nchannels * slv_type_size(params.type));
        random_texels(seed, params.type, count, test_random(seed) % 3 == 0, params.nchannels,
                      texels);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
        free(texels);
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_mesh_destroy(mesh);
}

int main(void) {
    uint64_t seed = 20;
    CHECK(each_sample(copy_sample) > 0);
    const char *samples = getenv("SELVAGE_SAMPLES");
    CHECK(each_file(samples, copy_sample) > 0 || !samples);
    for (uint32_t round = 0; round < test_effort(8); round++) {
        char path[1024];
        snprintf(path, sizeof path, "%s", scratch_path("random.ptx"));
        write_random(&seed, path);
        copy_sample(path);
        remove(path);
    }
    return test_end();
}
