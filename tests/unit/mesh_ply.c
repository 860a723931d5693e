/* PLY files in all their forms, plain and packed, hold the mesh that they were made of; spoilt ones
 * are refused. */
#include "kit/mesh_shapes.h"

#include <libdeflate.h>
#include <unistd.h>

typedef struct text {
    char *bytes;
    size_t size, room;
} text;

static void put(text *t, const void *bytes, size_t size) {
    if (t->size + size > t->room) {
        t->room = 2 * (t->size + size) + 64;
        t->bytes = realloc(t->bytes, t->room);
        REQUIRE(t->bytes != NULL);
    }
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
}

static void print(text *t, const char *words) {
    put(t, words, strlen(words));
}

typedef enum form { ASCII, LITTLE, BIG, FORMS } form;

static const char *const types[] = {"char", "uchar", "short", "ushort",
                                    "int",  "uint",  "float", "double"};

/* Writes a number as the type says, byte by byte, independent of the reader. */
static void number(text *t, form f, int type, double value) {
    unsigned char bytes[8];
    static const int sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    char words[64];
    uint64_t bits;
    if (f == ASCII) {
        static const char *const blanks[] = {" ", "\t", "  ", " \t "};
        static uint64_t state = 17;
        const char *blank = blanks[test_random(&state) % 4];
        uint32_t kind = type < 6 ? 0 : test_random(&state) % 4;
        if (kind == 1)
            snprintf(words, sizeof words, "%.17e%s", value, blank);
        else if (kind == 2)
            snprintf(words, sizeof words, "%+.16E%s", value, blank);
        else
            snprintf(words, sizeof words, "%.17g%s", value, blank);
        print(t, words);
        return;
    }
    float single = (float)value;
    uint32_t single_bits;
    memcpy(&single_bits, &single, 4);
    memcpy(&bits, &value, 8);
    bits = type == 7 ? bits : type == 6 ? single_bits : (uint64_t)(int64_t)value;
    for (int i = 0; i < sizes[type]; i++)
        bytes[f == LITTLE ? i : sizes[type] - 1 - i] = (unsigned char)(bits >> (8 * i));
    put(t, bytes, (size_t)sizes[type]);
}

static void vertices(text *t, form f, const shape *s, int type, bool extra) {
    for (uint32_t v = 0; v < s->nverts; v++) {
        if (extra)
            number(t, f, 1, v % 200);
        for (int c = 0; c < 3; c++)
            number(t, f, type, (double)s->positions[3 * v + (uint32_t)c]);
        if (extra) {
            number(t, f, 1, 2); /* a list */
            number(t, f, 3, 7);
            number(t, f, 3, 65535);
            number(t, f, 6, 0.25 * v);
            number(t, f, 6, -0.5 * v);
        }
        if (f == ASCII)
            print(t, v % 3 ? "\n" : "\r\n");
    }
}

static void faces(text *t, form f, const shape *s, int count_type, int index_type, bool extra) {
    const int32_t *verts = s->verts;
    for (uint32_t p = 0; p < s->npolys; verts += s->sizes[p++]) {
        if (extra)
            number(t, f, 7, 1e300);
        number(t, f, count_type, s->sizes[p]);
        for (int32_t i = 0; i < s->sizes[p]; i++)
            number(t, f, index_type, verts[i]);
        if (f == ASCII)
            print(t, "\n");
    }
}

static text write_ply(const shape *s, form f, uint64_t *random) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    text t = {0};
    char line[200];
    bool extra = test_random(random) % 2, faces_first = test_random(random) % 2;
    int type = 6 + (int)(test_random(random) % 2);
    int count_type = s->nverts < 100 ? (int)(test_random(random) % 6) : 4;
    int index_type = s->nverts < 100 ? (int)(test_random(random) % 6) : 4;
    snprintf(line, sizeof line, "ply\nformat %s 1.0\ncomment made by a test\n", formats[f]);
    print(&t, line);
    for (int part = 0; part < 2; part++) {
        if ((part == 0) == faces_first) {
            snprintf(line, sizeof line,
                     "element face %u\n%sproperty list %s %s vertex_ind%s\nobj_info x\n", s->npolys,
                     extra ? "property double weight\n" : "", types[count_type], types[index_type],
                     extra ? "ices" : "ex");
        } else {
            snprintf(line, sizeof line,
                     "element vertex %u\n%sproperty %s x\nproperty %s y\nproperty %s z\n%s",
                     s->nverts, extra ? "property uint8 red\n" : "", types[type], types[type],
                     types[type],
                     extra ? "property list uchar uint16 used_by\nproperty float32 s\n"
                             "property float t\n"
                           : "");
        }
        print(&t, line);
        if (part == 0 && extra)
            print(&t, "element edge 2\nproperty int a\nproperty int b\n");
    }
    print(&t, "end_header\n");
    for (int part = 0; part < 2; part++) {
        if ((part == 0) == faces_first)
            faces(&t, f, s, count_type, index_type, extra);
        else
            vertices(&t, f, s, type, extra);
        for (int i = 0; part == 0 && extra && i < 4; i++)
            number(&t, f, 4, -i);
    }
    return t;
}

static void check_same(const slv_mesh *mesh, const shape *s) {
    const slv_mesh_view *v = slv_mesh_get_view(mesh);
    size_t sides = 0;
    REQUIRE(v->nverts == s->nverts && v->npolys == s->npolys);
    for (uint32_t p = 0; p < s->npolys; p++)
        sides += (size_t)s->sizes[p];
    CHECK(!memcmp(v->positions, s->positions, 12 * (size_t)s->nverts));
    CHECK(!memcmp(v->poly_sizes, s->sizes, 4 * (size_t)s->npolys));
    CHECK(!memcmp(v->poly_verts, s->verts, 4 * sides));
    for (uint32_t i = 0; i < v->ntexcoords; i++)
        CHECK(v->texcoords[2 * i] == 0.25f * (float)i &&
              v->texcoords[2 * i + 1] == -0.5f * (float)i);
    CHECK(!v->ntexcoords || !memcmp(v->poly_texcoords, s->verts, 4 * sides));
}

/* A file of one member, or of two. */
static void save(const char *path, const text *t, bool packed, size_t split) {
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream != NULL);
    for (size_t at = 0; at < t->size;) {
        size_t size = at < split ? split : t->size - at;
        size_t room = libdeflate_gzip_compress_bound(NULL, size);
        struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(6);
        void *bytes = malloc(room);
        REQUIRE(compressor && bytes);
        size_t made =
            packed ? libdeflate_gzip_compress(compressor, t->bytes + at, size, bytes, room) : size;
        CHECK(fwrite(packed ? bytes : t->bytes + at, 1, made, stream) == made);
        libdeflate_free_compressor(compressor);
        free(bytes);
        at += size;
    }
    CHECK(fclose(stream) == 0);
}

static void test_forms(void) {
    slv_env env = test_env();
    uint64_t random = 5;
    char path[64];
    snprintf(path, sizeof path, "%s/selvage-mesh-%ld.ply", test_parent(), (long)getpid());
    for (int round = 0; round < 60; round++) {
        shape s = shape_random(round % SHAPE_KINDS, &random);
        text t = write_ply(&s, (form)(round % FORMS), &random);
        slv_mesh *mesh = NULL;
        test_last_log[0] = 0;
        MUST(slv_mesh_parse_ply(&env, "t.ply", t.bytes, t.size, &mesh));
        check_same(mesh, &s);
        CHECK_MSG(!test_last_log[0], "%s", test_last_log);
        slv_mesh_destroy(mesh);
        save(path, &t, round % 4 != 0, round % 8 == 7 ? t.size / 3 : 0);
        MUST(slv_mesh_load(&env, path, &mesh));
        check_same(mesh, &s);
        slv_mesh_destroy(mesh);
        free(t.bytes);
        shape_clear(&s);
    }
    unlink(path);
}

#define HEADER "ply\nformat ascii 1.0\n"
#define VERTEX "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define FACE "element face 1\nproperty list uchar int vertex_index\nend_header\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n"

static void test_refused(void) {
    static const char *const bad[] = {
        "",
        "ply",
        "ply\n",
        HEADER,
        HEADER VERTEX,
        HEADER VERTEX FACE,
        "play\n",
        "ply\nformat text 1.0\n" VERTEX FACE POINTS "3 0 1 2\n",
        "ply\n" VERTEX FACE POINTS "3 0 1 2\n",
        HEADER VERTEX FACE POINTS "3 0 1\n",
        HEADER VERTEX FACE POINTS "3 0 1 3\n",
        HEADER VERTEX FACE POINTS "3 0 1 -1\n",
        HEADER VERTEX FACE POINTS "3 0 1 x\n",
        HEADER VERTEX FACE POINTS "2 0 1\n",
        HEADER VERTEX FACE POINTS "-1\n",
        HEADER VERTEX FACE POINTS "4000000000 1\n",
        HEADER VERTEX FACE "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n",
        HEADER VERTEX FACE "0 0 1e39\n1 0 0\n0 1 0\n3 0 1 2\n",
        HEADER VERTEX VERTEX FACE POINTS POINTS "3 0 1 2\n",
        HEADER "element vertex 3\nproperty float x\nproperty float y\n" FACE
               "0 0\n1 0\n0 1\n3 0 1 2\n",
        HEADER "element vertex 99999999999\nproperty float x\n" FACE POINTS,
        HEADER "element vertex -3\n",
        HEADER "property float x\n",
        HEADER "element vertex 3\nproperty list float int x\n",
        HEADER "element vertex 3\nproperty quad x\n",
        HEADER "element vertex\n",
        HEADER "elephant 3\n",
        "ply\nformat binary_little_endian 1.0\n" VERTEX FACE "short",
        "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float "
        "x\nproperty "
        "float y\nproperty float z\n" FACE "short"};
    slv_env env = test_env();
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        slv_mesh *mesh = NULL;
        test_last_log[0] = 0;
        slv_result result = slv_mesh_parse_ply(&env, "t.ply", bad[i], strlen(bad[i]), &mesh);
        CHECK_MSG(result == SLV_ERROR_FORMAT && !mesh, "case %zu gave %d", i, (int)result);
        CHECK_MSG(strstr(test_last_log, "t.ply") != NULL, "case %zu: '%s'", i, test_last_log);
        slv_mesh_destroy(mesh);
    }
    slv_mesh *mesh = NULL;
    const char *good = HEADER VERTEX FACE POINTS "3 0 1 2";
    MUST(slv_mesh_parse_ply(&env, "t.ply", good, strlen(good), &mesh));
    slv_mesh_destroy(mesh);
    const char *strips = HEADER VERTEX "element tristrips 1\nproperty list int int vertex_indices\n"
                                       "end_header\n" POINTS "3 0 1 2";
    CHECK(slv_mesh_parse_ply(&env, "t.ply", strips, strlen(strips), &mesh) ==
          SLV_ERROR_UNSUPPORTED);
    /* edges told as faces are no polygons, and are told of */
    const char *mixed = HEADER VERTEX "element face 3\nproperty list uchar int vertex_index\n"
                                      "end_header\n" POINTS "2 0 1\n3 0 1 2\n1 0\n";
    MUST(slv_mesh_parse_ply(&env, "t.ply", mixed, strlen(mixed), &mesh));
    CHECK(slv_mesh_get_view(mesh)->npolys == 1 && strstr(test_last_log, "2 faces of fewer"));
    slv_mesh_destroy(mesh);
}

/* Bytes changed at random: read or refused, never worse. */
static void test_mutations(void) {
    slv_env env = test_env();
    uint64_t random = 17;
    int read = 0, refused = 0;
    env.max_bytes = UINT64_C(1) << 26;
    for (int round = 0; round < 6000; round++) {
        shape s = round % 2 ? shape_cube() : shape_fan(5, 3);
        text t = write_ply(&s, (form)(round % FORMS), &random);
        slv_mesh *mesh = NULL;
        size_t size = test_random(&random) % 5 ? t.size : test_random(&random) % t.size;
        for (uint32_t n = 1 + test_random(&random) % 4; n; n--)
            t.bytes[test_random(&random) % t.size] = (char)test_random(&random);
        char *exact = malloc(size ? size : 1); /* for the sanitizer's sake */
        REQUIRE(exact != NULL);
        memcpy(exact, t.bytes, size);
        slv_result result = slv_mesh_parse_ply(&env, "t.ply", exact, size, &mesh);
        read += !result;
        refused += result != SLV_OK;
        CHECK(!result == (mesh != NULL));
        slv_mesh_destroy(mesh);
        free(exact);
        free(t.bytes);
        shape_clear(&s);
    }
    CHECK_MSG(read > 500 && refused > 500, "%d read, %d refused", read, refused);
}

static void test_packed_badly(void) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    char path[64];
    snprintf(path, sizeof path, "%s/selvage-mesh-%ld.obj.gz", test_parent(), (long)getpid());
    text t = {0}, packed;
    print(&t, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    save(path, &t, true, 0);
    MUST(slv_mesh_load(&env, path, &mesh));
    slv_mesh_destroy(mesh);
    FILE *stream = fopen(path, "rb");
    char bytes[256];
    packed = (text){bytes, fread(bytes, 1, sizeof bytes, stream), sizeof bytes};
    fclose(stream);
    for (size_t size = 2; size < packed.size; size++) {
        text part = {bytes, size, size};
        save(path, &part, false, 0);
        CHECK(slv_mesh_load(&env, path, &mesh) == SLV_ERROR_FORMAT && !mesh);
        CHECK(strstr(test_last_log, path) != NULL);
    }
    free(t.bytes);
    t = (text){calloc(1, 1 << 24), 1 << 24, 1 << 24}; /* unpacks to more than is allowed */
    save(path, &t, true, 0);
    env.max_bytes = 1 << 20;
    CHECK(slv_mesh_load(&env, path, &mesh) == SLV_ERROR_LIMIT && !mesh);
    free(t.bytes);
    unlink(path);
}

int main(void) {
    test_forms();
    test_refused();
    test_mutations();
    test_packed_badly();
    return test_end();
}
