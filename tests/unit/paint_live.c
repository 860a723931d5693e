/* Strokes that are made while they show, journals as scripts, and sessions that move. */
#include "kit/document_kit.h"
#include "kit/folder_kit.h"

#include <selvage/session.h>

#include <sys/stat.h>
#include <unistd.h>

/* A cube with grey texels, made from a texture. */
static slv_session *create(const char *name) {
    slv_env env = test_env();
    shape cube = shape_cube();
    slv_mesh *mesh = shape_mesh(&env, &cube);
    slv_res res[6];
    slv_texture *texture = NULL;
    slv_session *session = NULL;
    const slv_session_params params = {.scheme = SLV_SCHEME_BILINEAR};
    for (int i = 0; i < 6; i++)
        res[i] = (slv_res){(int8_t)(3 + i % 3), 4};
    const slv_texture_desc desc = {6, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, 0};
    MUST(slv_texture_create(&env, &desc, &texture));
    MUST(slv_texture_set_constant(texture, 2, (const uint8_t[3]){200, 100, 50}));
    MUST(slv_session_create_from(&env, test_path(name), mesh, texture, &params, &session));
    slv_history_info info;
    slv_document_history(slv_session_document(session), &info);
    CHECK_MSG(!info.undos && !info.lost, "what a session was made of can be undone");
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    shape_clear(&cube);
    return session;
}

static uint64_t state_of(slv_session *session) {
    return document_state(slv_session_document(session));
}

static slv_result begin(slv_session *session, const char *line) {
    return slv_session_stroke_begin(session, 2, false, NULL, line, strlen(line));
}

#define PEN "{\"radius\":0.3,\"color\":[0.9,0.1,0.2],\"brush\":{\"pressure_radius\":1}"
#define PICTURE                                                                                    \
    ",\"size\":[200,100],\"unit\":\"pixels\",\"camera\":{\"azimuth\":30,\"elevation\":20}}"

/* In a picture, a hand that trembles: numbers with many digits; and a pen that is not calibrated,
 * with a clock that now and then goes back. */
static slv_stroke_sample sample_at(int i) {
    return (slv_stroke_sample){.x = 60 + 80.0f * (float)i / 39,
                               .y = 50 + 9 * sinf((float)i),
                               .pressure = i % 11 ? 0.3f + 0.5f * (float)(i % 7) / 7 : 1.02f,
                               .tilt_x = i % 13 ? 0.1f : -1.5f,
                               .time = 1e9 + (i % 10 ? i : i - 2) / 125.0};
}

static void stroke(slv_session *session, uint32_t portion) {
    slv_stroke_stats stats;
    MUST(begin(session, PEN PICTURE));
    for (int i = 0; i < 40; i += (int)portion) {
        slv_stroke_sample samples[40];
        for (uint32_t k = 0; k < portion; k++)
            samples[k] = sample_at(i + (int)k);
        MUST(slv_session_stroke_add(session, samples, portion));
    }
    MUST(slv_session_stroke_end(session, &stats));
    CHECK(stats.dabs > 20);
}

static void shows_at_once(void) {
    slv_session *session = create("a.selvage");
    slv_document *document = slv_session_document(session);
    slv_session_info info;
    uint64_t before = state_of(session), flat;
    slv_stroke_sample place = sample_at(0), nowhere = {.x = NAN};
    CHECK(slv_document_layer_count(document) == 2);
    MUST(slv_document_flatten(document));
    flat = document_texture_hash(slv_document_texture(document));
    MUST(begin(session, PEN PICTURE));
    for (int i = 0; i < 6; i++) {
        place = sample_at(4 * i);
        MUST(slv_session_stroke_add(session, &place, 1));
    }
    MUST(slv_document_flatten(document));
    CHECK(document_texture_hash(slv_document_texture(document)) != flat);
    CHECK(slv_document_undo(document) == SLV_ERROR_ARGUMENT);
    CHECK(slv_session_save(session) == SLV_ERROR_ARGUMENT);
    CHECK(begin(session, PEN PICTURE) == SLV_ERROR_ARGUMENT);
    slv_session_stroke_cancel(session);
    CHECK(state_of(session) == before);
    MUST(slv_document_flatten(document));
    CHECK(document_texture_hash(slv_document_texture(document)) == flat);
    CHECK(slv_session_stroke_add(session, &place, 1) == SLV_ERROR_ARGUMENT);
    CHECK(slv_session_stroke_end(session, NULL) == SLV_ERROR_ARGUMENT);
    /* what is wrong leaves nothing, and ends it */
    MUST(begin(session, PEN PICTURE));
    MUST(slv_session_stroke_add(session, &place, 1));
    CHECK(slv_session_stroke_add(session, &nowhere, 1) == SLV_ERROR_ARGUMENT);
    CHECK(state_of(session) == before);
    CHECK(begin(session, PEN ",\"samples\":[[0,0,0]]}") == SLV_ERROR_FORMAT);
    CHECK(begin(session, "{\"op\":\"fill\",\"face\":1}") == SLV_ERROR_FORMAT);
    CHECK(begin(session, "{\"nothing\":1}") == SLV_ERROR_FORMAT);
    CHECK(begin(session, "[]") == SLV_ERROR_FORMAT);
    MUST(begin(session, PEN PICTURE)); /* without a sample: nothing was done */
    MUST(slv_session_stroke_end(session, NULL));
    slv_session_get_info(session, &info);
    CHECK(info.lines == 3 && info.unsaved == 0 && state_of(session) == before);
    MUST(begin(session, PEN PICTURE));
    MUST(slv_session_stroke_add(session, &place, 1));
    slv_session_destroy(session); /* as if it had not begun */
    slv_env env = test_env();
    MUST(slv_session_open(&env, test_path("a.selvage"), NULL, &session));
    CHECK(state_of(session) == before);
    slv_session_destroy(session);
}

/* However it comes in portions, and from its journal: the same texels. */
static void journal_is_script(void) {
    const slv_res res = {6, 2};
    const uint32_t face = 3, faces[2] = {0, 3};
    slv_session *session = create("b.selvage"), *other = create("c.selvage");
    slv_document *document = slv_session_document(session);
    static const char fill[] = "{\"op\":\"fill\",\"face\":5,\"color\":[0,1,0]}";
    uint32_t added;
    char line[65536];
    uint64_t before = state_of(session), one, all;
    stroke(session, 1);
    one = state_of(session);
    CHECK(one != before);
    MUST(slv_document_undo(document));
    CHECK(state_of(session) == before);
    stroke(session, 40);
    CHECK(state_of(session) == one);
    MUST(slv_document_undo(document));
    MUST(slv_document_redo(document));
    MUST(slv_document_add_layer(document, NULL, &added));
    MUST(slv_document_resize(document, 0, 1, &face, &res));
    MUST(slv_document_select(document, 2, faces));
    MUST(slv_document_begin(document, "two"));
    MUST(slv_document_duplicate_layer(document, 2, &added));
    MUST(slv_session_run(session, added, false, NULL, fill, sizeof fill - 1));
    MUST(slv_document_end(document));
    stroke(session, 8);
    all = state_of(session);
    FILE *file = fopen(test_path("b.selvage/journal"), "rb");
    REQUIRE(file);
    for (int i = 0; fgets(line, sizeof line, file); i++)
        if (i >= 3) /* what made the session */
            MUST(slv_session_run(other, 1, false, test_path("b.selvage"), line, strlen(line)));
    fclose(file);
    CHECK(state_of(other) == all);
    slv_session_destroy(other);
    slv_session_destroy(session);
    slv_env env = test_env();
    MUST(slv_session_open(&env, test_path("b.selvage"), NULL, &session));
    CHECK(state_of(session) == all);
    CHECK(slv_session_run(session, 1, false, NULL, "{\"op\":\"undone\"}", 15) == SLV_ERROR_FORMAT);
    CHECK(slv_session_run(session, 1, false, NULL, "{\"op\":\"group\",\"edits\":[{},{}]}", 30) !=
          SLV_OK);
    CHECK(slv_session_run(session, 1, false, NULL, "{\"op\":\"fill\",\"face\":1,\"layer\":1.5}",
                          35) == SLV_ERROR_FORMAT);
    CHECK(state_of(session) == all);
    slv_session_destroy(session);
}

static void moves(void) {
    slv_env env = test_env();
    slv_session *session = create("d.selvage"), *old;
    slv_document *document = slv_session_document(session);
    slv_session_info info;
    struct stat status;
    uint64_t before = state_of(session), painted;
    stroke(session, 4);
    painted = state_of(session);
    CHECK(slv_session_save_as(session, test_path("b.selvage")) == SLV_ERROR_IO);
    CHECK(strcmp(slv_session_path(session), test_path("d.selvage")) == 0);
    CHECK(slv_session_save_as(session, test_path("none/e.selvage")) == SLV_ERROR_IO);
    MUST(slv_session_save_as(session, test_path("e.selvage")));
    CHECK(strcmp(slv_session_path(session), test_path("e.selvage")) == 0);
    slv_session_get_info(session, &info);
    CHECK(info.unsaved == 0);
    CHECK(slv_session_open(&env, test_path("e.selvage"), NULL, &old) == SLV_ERROR_IO);
    MUST(slv_session_open(&env, test_path("d.selvage"), NULL, &old));
    CHECK(state_of(old) == painted);
    MUST(slv_document_undo(slv_session_document(old)));
    slv_session_destroy(old);
    MUST(slv_document_undo(document)); /* beyond what was saved */
    CHECK(state_of(session) == before);
    slv_session_destroy(session);
    MUST(slv_session_open(&env, test_path("e.selvage"), NULL, &session));
    CHECK(state_of(session) == before);
    CHECK(slv_session_scheme(session) == SLV_SCHEME_BILINEAR);
    CHECK(slv_session_remove(&env, test_path("e.selvage")) == SLV_ERROR_IO); /* is open */
    CHECK(slv_session_remove(&env, test_folder) == SLV_ERROR_IO);
    slv_session_destroy(session);
    CHECK(slv_session_is(test_path("e.selvage")));
    MUST(slv_session_remove(&env, test_path("e.selvage")));
    CHECK(stat(test_path("e.selvage"), &status) != 0);
    CHECK(stat(test_path("e.selvage.0.selvage"), &status) != 0);
    CHECK(stat(test_path("none"), &status) != 0);
}

int main(void) {
    test_folder_begin();
    shows_at_once();
    journal_is_script();
    moves();
    test_folder_end();
    return test_end();
}
