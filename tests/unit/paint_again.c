/* A script of very many dabs gives the same bytes each time, for any number of threads, and from
 * the journal after a kill; and undoing all of it gives those that there were at first. In its long
 * form 10,000 dabs. */
#include "kit/document_kit.h"
#include "kit/folder_kit.h"

#include <selvage/session.h>

#include <unistd.h>

/* A cube of faces that have a picture, and differ in size: a large dab is worth several threads. */
static slv_session *create(const char *name, uint32_t threads) {
    slv_env env = test_env();
    shape cube = shape_cube();
    slv_res res[6];
    slv_texture *texture = NULL;
    slv_session *session = NULL;
    const slv_session_params params = {.scheme = SLV_SCHEME_BILINEAR, .relaxed = true};
    env.threads = threads;
    slv_mesh *mesh = shape_mesh(&env, &cube);
    for (int i = 0; i < 6; i++)
        res[i] = (slv_res){(int8_t)(6 + i % 3), (int8_t)(8 - i % 2)};
    const slv_texture_desc desc = {6, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, 0};
    MUST(slv_texture_create(&env, &desc, &texture));
    for (uint32_t face = 0; face < 6; face++) {
        size_t size = (size_t)3 << (res[face].u + res[face].v);
        unsigned char *texels = malloc(size);
        for (size_t k = 0; k < size; k++)
            texels[k] = (unsigned char)(k * 31 + face * 7);
        MUST(slv_texture_set_face(texture, face, texels));
        free(texels);
    }
    MUST(slv_session_create_from(&env, test_path(name), mesh, texture, &params, &session));
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    shape_clear(&cube);
    return session;
}

/* The i-th line: strokes of all kinds across edges, some of them large, and a fill now and then. */
static void run_line(slv_session *session, uint32_t i) {
    static const char *const more[] = {
        "",
        ",\"blend\":\"multiply\"",
        ",\"erase\":true",
        ",\"mirror\":[{\"point\":[0,0,0],\"normal\":[1,0,0]}]",
        ",\"gradient\":{\"from\":[-1,-1,-1],\"to\":[1,1,1],\"color\":[0,0.2,0.9]}",
        ",\"where\":{\"towards\":[0,0,1],\"degrees\":70}",
        ",\"symmetry\":{\"face\":0,\"edge\":1}",
        ",\"brush\":{\"hardness\":0.2,\"spacing\":0.3,\"aspect\":2,\"angle\":30}"};
    uint64_t random = 77 + i;
    char line[512];
    float x[6];
    for (int k = 0; k < 6; k++)
        x[k] = (float)(test_random(&random) % 1000) / 1000;
    uint32_t face = test_random(&random) % 6;
    if (i % 16 == 15)
        snprintf(line, sizeof line,
                 "{\"op\":\"fill\",\"face\":%u,\"color\":[%g,%g,%g],\"opacity\":0.1}", face,
                 (double)x[0], (double)x[1], (double)x[2]);
    else
        snprintf(line, sizeof line,
                 "{\"radius\":%g,\"color\":[%g,%g,0.5],\"opacity\":0.4%s,"
                 "\"samples\":[[%u,%g,%g,1,0],[%u,%g,%g,0.5,0.1],[%u,0.5,0.5,0.8,0.2]]}",
                 i % 8 == 0 ? 0.7 : 0.05 + 0.1 * (double)x[0], (double)x[1], (double)x[2],
                 more[i % 8 ? i % (sizeof more / sizeof *more) : 0], face, (double)x[2],
                 (double)x[3], face, (double)x[4], (double)x[5], face);
    MUST(slv_session_run(session, 2, false, NULL, line, strlen(line)));
}

static uint64_t dabs_of(const slv_session *session) {
    slv_script_stats stats;
    slv_session_get_stats(session, &stats);
    return stats.dabs;
}

/* Paints, and says what it came to; the texture that is exported counts too. */
static uint64_t paint(slv_session *session, uint64_t dabs, uint32_t *lines) {
    slv_document *document = slv_session_document(session);
    for (*lines = 0; dabs_of(session) < dabs; ++*lines)
        run_line(session, *lines);
    MUST(slv_document_flatten(document));
    return document_state(document) ^ document_texture_hash(slv_document_texture(document));
}

static uint32_t undos_of(slv_session *session) {
    slv_history_info info;
    slv_document_history(slv_session_document(session), &info);
    return info.undos;
}

/* Whether two files, without how sessions are called in them, are the same bytes. */
static bool same_file(const char *name, const char *a, const char *b) {
    char line[700];
    snprintf(line, sizeof line, "cmp -s %s/%s/%s %s/%s/%s", test_folder, a, name, test_folder, b,
             name);
    return system(line) == 0;
}

int main(void) {
    const uint64_t dabs = test_brief() ? 400 : 10000;
    const slv_session_params relaxed = {.relaxed = true};
    slv_env env = test_env();
    uint32_t lines, again;
    test_folder_begin();
    slv_session *one = create("one.selvage", 1), *many = create("many.selvage", 4);
    const uint64_t begin = document_state(slv_session_document(one));
    const uint32_t before = undos_of(one);
    const uint64_t end = paint(one, dabs, &lines);
    const uint32_t entries = undos_of(one) - before; /* a line that changes nothing is none */
    CHECK(entries > lines / 2);
    CHECK(dabs_of(one) >= dabs && end != begin);
    CHECK(paint(many, dabs, &again) == end);
    CHECK(again == lines && same_file("journal", "one.selvage", "many.selvage"));
    slv_session_destroy(many);
    many = create("second.selvage", 1);
    CHECK(paint(many, dabs, &again) == end);
    CHECK(same_file("journal", "one.selvage", "second.selvage"));
    slv_session_destroy(many); /* as if it had been killed: nothing was saved */
    MUST(slv_session_open(&env, test_path("second.selvage"), &relaxed, &many));
    CHECK(paint(many, 0, &again) == end && undos_of(many) == entries);
    for (int k = 0; k < 2; k++) { /* from the journal, and as it was painted */
        slv_document *document = slv_session_document(k ? one : many);
        for (uint32_t i = 0; i < entries; i++)
            MUST(slv_document_undo(document));
        CHECK(document_state(document) == begin);
        for (uint32_t i = 0; i < entries; i++)
            MUST(slv_document_redo(document));
        CHECK(paint(k ? one : many, 0, &again) == end);
    }
    slv_session_destroy(one);
    slv_session_destroy(many);
    test_folder_end();
    return test_end();
}
