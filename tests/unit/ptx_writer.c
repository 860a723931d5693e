/* Writing face by face: order, threads, spilling, triangles, and everything that is refused. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

#include <dirent.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <signal.h>

#define NFACES 60

static uint64_t seed = 3;

struct face_data {
    slv_ptx_face info;
    uint8_t *texels;
};

static struct face_data faces[NFACES];

static void make_faces(const slv_ptx_writer_params *p) {
    size_t pixel = slv_type_size(p->type) * p->nchannels;
    for (uint32_t face = 0; face < NFACES; face++) {
        int u = (int)(test_random(&seed) % 8), v = (int)(test_random(&seed) % 8);
        bool triangle = p->mesh_type == SLV_PTX_TRIANGLE;
        slv_ptx_face info = {.res = {(int8_t)u, (int8_t)(triangle ? u : v)},
                             .flags = face % 7 ? 0 : SLV_FACE_CONSTANT,
                             .adjacency.face = {-1, (int32_t)((face + 1) % NFACES), -1,
                                                (int32_t)((face + NFACES - 1) % NFACES)},
                             .adjacency.edge = {0, triangle ? 2 : 3, 1, 1}};
        if (triangle)
            info.adjacency.face[2] = info.adjacency.face[3];
        size_t size = pixel << (info.res.u + info.res.v);
        faces[face].info = info;
        faces[face].texels = malloc(size);
        for (size_t i = 0; i < size; i++) /* some ramps, some noise; floats stay finite */
            faces[face].texels[i] = (uint8_t)(face % 3   ? i / 9 % 100
                                              : face % 2 ? test_random(&seed) % 60
                                                         : i % 7);
    }
}

static void free_faces(void) {
    for (uint32_t face = 0; face < NFACES; face++)
        free(faces[face].texels);
}

struct worker {
    slv_ptx_writer *writer;
    uint32_t first, step;
    bool backwards;
    slv_result result;
};

static void *work(void *user) {
    struct worker *w = user;
    for (uint32_t i = w->first; i < NFACES && !w->result; i += w->step) {
        uint32_t face = w->backwards ? NFACES - 1 - i : i;
        w->result =
            slv_ptx_writer_write_face(w->writer, face, &faces[face].info, faces[face].texels);
    }
    return NULL;
}

static void write_file(const char *path, const slv_ptx_writer_params *p, uint32_t threads,
                       bool backwards) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    pthread_t ids[4];
    struct worker workers[4];
    env.threads = threads;
    REQUIRE(slv_ptx_writer_create(&env, path, p, &writer) == SLV_OK);
    for (uint32_t i = 0; i < threads; i++) {
        workers[i] = (struct worker){writer, i, threads, backwards, SLV_OK};
        REQUIRE(pthread_create(&ids[i], NULL, work, &workers[i]) == 0);
    }
    for (uint32_t i = 0; i < threads; i++) {
        pthread_join(ids[i], NULL);
        CHECK(workers[i].result == SLV_OK);
    }
    slv_ptx_meta meta = {"author", SLV_META_STRING, 2, "xx"};
    CHECK(slv_ptx_writer_set_meta(writer, &meta) == SLV_OK);
    meta.values = "me"; /* the last one counts */
    CHECK(slv_ptx_writer_set_meta(writer, &meta) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    CHECK(slv_ptx_writer_finish(writer) == SLV_ERROR_ARGUMENT);
    CHECK(slv_ptx_writer_write_face(writer, 0, &faces[0].info, faces[0].texels) ==
          SLV_ERROR_ARGUMENT);
    slv_ptx_writer_destroy(writer);
}

static bool same_file(const char *a, const char *b) {
    size_t size_a = 0, size_b = 0;
    uint8_t *bytes_a = read_whole(a, &size_a), *bytes_b = read_whole(b, &size_b);
    bool same = bytes_a && bytes_b && size_a == size_b && !memcmp(bytes_a, bytes_b, size_a);
    free(bytes_a);
    free(bytes_b);
    return same;
}

static void check_contents(const char *path, const slv_ptx_writer_params *p) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    slv_ptx_reader *reader = NULL;
    size_t pixel = slv_type_size(p->type) * p->nchannels;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_load_tables(ptx) == SLV_OK);
    REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    CHECK(info->mesh_type == p->mesh_type && info->type == p->type && info->nfaces == NFACES);
    CHECK(p->no_reductions ? info->nlevels == 1 : info->nlevels > 2);
    const slv_ptx_meta *meta = slv_ptx_find_meta(ptx, "author");
    CHECK(info->nmeta == 1 && meta && !strcmp(meta->values, "me"));
    uint8_t *texels = malloc(pixel << 14), *again = malloc(pixel << 14);
    uint64_t stored = 0;
    for (uint32_t face = 0; face < NFACES; face++) {
        slv_ptx_face f;
        slv_ptx_block block;
        size_t count = (size_t)1 << (faces[face].info.res.u + faces[face].info.res.v);
        REQUIRE(slv_ptx_get_face(ptx, face, &f) == SLV_OK);
        REQUIRE(slv_ptx_get_block(ptx, face, 0, &block) == SLV_OK);
        bool constant = f.flags & SLV_FACE_CONSTANT;
        CHECK(block.stored == !constant);
        stored += block.bytes;
        CHECK(f.res.u == faces[face].info.res.u && f.res.v == faces[face].info.res.v);
        CHECK(!memcmp(&f.adjacency.face, &faces[face].info.adjacency.face, p->mesh_type ? 16 : 12));
        REQUIRE(slv_ptx_reader_read(reader, face, f.res, texels) == SLV_OK);
        if (faces[face].info.flags & SLV_FACE_CONSTANT)
            CHECK(constant && !memcmp(texels, faces[face].texels, pixel));
        else
            CHECK_MSG(!memcmp(texels, faces[face].texels, count * pixel), "face %u", face);
        /* the next level, made with the public arithmetic */
        if (!p->no_reductions && !constant && f.res.u > 2 && f.res.v > 2) {
            slv_res half = {(int8_t)(f.res.u - 1), (int8_t)(f.res.v - 1)};
            slv_ptx_premultiply(p->type, p->nchannels, p->alpha_channel, texels, count);
            slv_ptx_reduce(p->mesh_type, p->type, p->nchannels, f.res, texels, again);
            REQUIRE(slv_ptx_read_face(ptx, face, half, texels) == SLV_OK);
            CHECK_MSG(!memcmp(texels, again, count / 4 * pixel), "reduction of face %u", face);
        }
    }
    CHECK(info->level_bytes[0] > stored && info->level_bytes[0] < info->file_bytes);
    free(texels);
    free(again);
    slv_ptx_reader_destroy(reader);
    slv_ptx_close(ptx);
}

static void every_way(slv_ptx_mesh_type mesh_type, slv_type type, uint32_t nchannels, int32_t alpha,
                      bool no_reductions) {
    slv_ptx_writer_params p = {.mesh_type = mesh_type,
                               .type = type,
                               .nchannels = nchannels,
                               .alpha_channel = alpha,
                               .nfaces = NFACES,
                               .no_reductions = no_reductions};
    const char *path = scratch_path("one.ptx"), *other = scratch_path("other.ptx");
    make_faces(&p);
    write_file(path, &p, 1, false);
    check_contents(path, &p);
    write_file(other, &p, 4, true);
    CHECK(same_file(path, other));
    p.memory = 1; /* nearly all goes through a file */
    write_file(other, &p, 3, true);
    CHECK(same_file(path, other));
    free_faces();
    remove(path);
    remove(other);
}

static int count_beside(const char *name) {
    const char *path = scratch_path(name), *base = strrchr(path, '/') + 1;
    char folder[1024];
    snprintf(folder, sizeof folder, "%.*s", (int)(base - path), path);
    DIR *dir = opendir(folder);
    int count = 0;
    for (struct dirent *entry; dir && (entry = readdir(dir));)
        count += !strncmp(entry->d_name, base, strlen(base));
    if (dir)
        closedir(dir);
    return count;
}

static void refusals(void) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {.mesh_type = SLV_PTX_TRIANGLE, .nchannels = 1, .nfaces = 2};
    slv_ptx_writer *writer = NULL;
    const char *path = scratch_path("refused");
    uint8_t texels[16] = {1, 2};
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_OK);
    slv_ptx_face info = {.res = {1, 2}, .adjacency.face = {-1, -1, -1, -1}};
    CHECK(slv_ptx_writer_write_face(writer, 0, &info, texels) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 0") && strstr(test_last_log, "triangle"));
    info.res = (slv_res){1, 1};
    CHECK(slv_ptx_writer_write_face(writer, 2, &info, texels) == SLV_ERROR_ARGUMENT);
    info.adjacency.face[1] = 2;
    CHECK(slv_ptx_writer_write_face(writer, 1, &info, texels) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 1 edge 1"));
    slv_ptx_writer_destroy(writer); /* unfinished: nothing stays */
    CHECK(count_beside("refused") == 0);
    p.nchannels = 0;
    CHECK(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_ERROR_ARGUMENT && !writer);
    p.nchannels = 70000;
    CHECK(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_ERROR_ARGUMENT);
    p = (slv_ptx_writer_params){.nchannels = 2, .alpha_channel = 2};
    CHECK(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_ERROR_ARGUMENT);
    p = (slv_ptx_writer_params){.nchannels = 1, .compression = 13};
    CHECK(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_ERROR_ARGUMENT);
    p.compression = 0;
    CHECK(slv_ptx_writer_create(&env, "/dev/null", &p, &writer) == SLV_ERROR_IO);
    CHECK(slv_ptx_writer_create(&env, "/nowhere/x.ptx", &p, &writer) == SLV_ERROR_IO);
    slv_ptx_writer_destroy(NULL);
    slv_ptx_reader_destroy(NULL);
}

/* Faces that nobody gave, and a triangle mesh whose adjacency the writer finds. */
static void triangles(void) {
    slv_env env = test_env();
    const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    const int32_t sizes[2] = {3, 3}, verts[6] = {0, 1, 2, 1, 3, 2};
    slv_mesh_view view = {
        .nverts = 4, .positions = positions, .npolys = 2, .poly_sizes = sizes, .poly_verts = verts};
    slv_ptx_writer_params p = {
        .mesh_type = SLV_PTX_TRIANGLE, .nchannels = 1, .alpha_channel = SLV_NO_ALPHA, .nfaces = 2};
    slv_ptx_writer *writer = NULL;
    slv_mesh *mesh = NULL;
    slv_ptx *ptx = NULL;
    slv_ptx_face face;
    const char *path = scratch_path("triangles.ptx");
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_OK);
    CHECK(slv_ptx_writer_set_mesh(writer, mesh) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_get_face(ptx, 0, &face) == SLV_OK);
    CHECK(face.adjacency.face[0] == -1 && face.adjacency.face[1] == 1 &&
          face.adjacency.edge[1] == 2 && face.adjacency.face[2] == -1);
    CHECK(face.flags & SLV_FACE_CONSTANT);
    REQUIRE(slv_ptx_get_face(ptx, 1, &face) == SLV_OK);
    CHECK(face.adjacency.face[2] == 0 && face.adjacency.edge[2] == 1);
    CHECK(slv_ptx_get_info(ptx)->nmeta == 3);
    slv_ptx_close(ptx);
    slv_mesh_destroy(mesh);
    remove(path);
}

/* A disk that is full, as far as this process can tell. */
static void full_disk(void) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {
        .mesh_type = SLV_PTX_QUAD, .nchannels = 4, .alpha_channel = SLV_NO_ALPHA, .nfaces = NFACES};
    const char *path = scratch_path("full.ptx");
    struct rlimit old, small = {5000, 0};
    make_faces(&p);
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream && fputs("the old file", stream) > 0);
    fclose(stream);
    signal(SIGXFSZ, SIG_IGN);
    REQUIRE(getrlimit(RLIMIT_FSIZE, &old) == 0);
    small.rlim_max = old.rlim_max;
    for (int spill = 0; spill < 2; spill++) {
        slv_ptx_writer *writer = NULL;
        slv_result result = SLV_OK;
        p.memory = spill ? 1 : 0;
        REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
        REQUIRE(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_OK);
        for (uint32_t round = 0; round < 40 && !result; round++)
            for (uint32_t face = 0; face < NFACES && !result; face++)
                result =
                    slv_ptx_writer_write_face(writer, face, &faces[face].info, faces[face].texels);
        CHECK(spill || result == SLV_OK);
        CHECK(slv_ptx_writer_finish(writer) != SLV_OK);
        slv_ptx_writer_destroy(writer);
        REQUIRE(setrlimit(RLIMIT_FSIZE, &old) == 0);
        size_t size = 0;
        uint8_t *bytes = read_whole(path, &size);
        CHECK(bytes && size == 12 && !memcmp(bytes, "the old file", 12));
        CHECK(count_beside("full.ptx") == 1);
        free(bytes);
    }
    free_faces();
    remove(path);
}

int main(void) {
    every_way(SLV_PTX_QUAD, SLV_TYPE_U8, 3, SLV_NO_ALPHA, false);
    every_way(SLV_PTX_QUAD, SLV_TYPE_U8, 4, 3, false);
    every_way(SLV_PTX_QUAD, SLV_TYPE_U16, 2, 0, false);
    every_way(SLV_PTX_TRIANGLE, SLV_TYPE_HALF, 1, SLV_NO_ALPHA, false);
    every_way(SLV_PTX_TRIANGLE, SLV_TYPE_U8, 5, SLV_NO_ALPHA, false);
    every_way(SLV_PTX_QUAD, SLV_TYPE_FLOAT, 6, SLV_NO_ALPHA, true);
    refusals();
    triangles();
    full_disk();
    return test_end();
}
