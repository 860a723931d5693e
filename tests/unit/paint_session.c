/* Sessions: what was done is there again after a kill, a cut at any byte, a full disk. */
#include "kit/document_kit.h"
#include "kit/folder_kit.h"

#include <selvage/ptx.h>
#include <selvage/session.h>

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void run(const char *command) {
    char line[512];
    snprintf(line, sizeof line, "cd %s && %s", test_folder, command);
    REQUIRE(system(line) == 0);
}

static slv_session *create(const char *name, int log2) {
    slv_env env = test_env();
    shape cube = shape_cube();
    slv_mesh *mesh = shape_mesh(&env, &cube);
    slv_res res[6];
    for (int i = 0; i < 6; i++)
        res[i] = (slv_res){(int8_t)log2, (int8_t)log2};
    slv_session_params params = {.document.flat = {6, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, 0},
                                 .document.background = (const float[3]){1, 1, 1},
                                 .scheme = SLV_SCHEME_BILINEAR};
    slv_session *session = NULL;
    MUST(slv_session_create(&env, test_path(name), mesh, &params, &session));
    slv_mesh_destroy(mesh);
    shape_clear(&cube);
    return session;
}

static slv_session *reopen(const char *name) {
    slv_env env = test_env();
    slv_session *session = NULL;
    MUST(slv_session_open(&env, test_path(name), NULL, &session));
    return session;
}

static slv_result line_of(slv_session *session, uint32_t layer, const char *line) {
    return slv_session_run(session, layer, false, NULL, line, strlen(line));
}

/* The i-th thing that is done, on layer 1. */
static slv_result act(slv_session *session, uint32_t i) {
    slv_document *d = slv_session_document(session);
    slv_layer_props props = {.name = "\xc3\xa4 layer", .opacity = 0.75f};
    const slv_res res[2] = {{(int8_t)(i / 10 % 2), 4},
                            {5, (int8_t)(i / 10 % 2)}}; /* others each time */
    const uint32_t faces[2] = {1, 4};
    char line[256];
    uint32_t copy;
    slv_result result;
    switch (i % 10) {
    case 0:
        return i ? slv_document_undo(d) : slv_document_add_layer(d, NULL, NULL);
    case 3:
        return slv_document_set_layer(d, 1, &props);
    case 5:
        return slv_document_resize(d, 1, 2, faces, res);
    case 6:
        if ((result = slv_document_begin(d, "two")) ||
            (result = slv_document_duplicate_layer(d, 1, &copy)) ||
            (result = line_of(session, copy, "{\"op\":\"fill\",\"face\":2,\"opacity\":0.5}")) ||
            (result = slv_document_merge_down(d, copy)))
            return result;
        return slv_document_end(d);
    case 7:
        return line_of(session, 1, "{\"op\":\"fill\",\"face\":3,\"color\":[0.1,0.9,0.3]}");
    default:
        snprintf(
            line, sizeof line,
            "{\"samples\":[[%u,0.2,0.3],[%u,0.%u,0.8,0.7]],\"radius\":0.3,\"color\":[0.%u,0,1]}",
            i % 6, i % 6, 1 + i % 9, i % 10);
        return line_of(session, 1, line);
    }
}

static uint64_t state_of(slv_session *session) {
    return document_state(slv_session_document(session));
}

enum { ACTS = 40 };
static uint64_t states[ACTS + 1]; /* after so many */

static void find_states(void) {
    slv_session *session = create("reference.selvage", 4);
    states[0] = state_of(session);
    for (uint32_t i = 0; i < ACTS; i++) {
        MUST(act(session, i));
        states[i + 1] = state_of(session);
    }
    slv_session_destroy(session);
}

static void comes_back(void) {
    slv_env env = test_env();
    slv_session_info info;
    slv_session *session = reopen("reference.selvage"), *other;
    slv_history_info history;
    CHECK(state_of(session) == states[ACTS]);
    slv_session_get_info(session, &info);
    CHECK(info.lines == ACTS && info.unsaved == ACTS && !info.torn_bytes && info.recovered == 34);
    CHECK(slv_session_open(&env, test_path("reference.selvage"), NULL, &other) == SLV_ERROR_IO);
    CHECK(strstr(test_last_log, "another process") != NULL);
    MUST(slv_session_save(session));
    slv_session_destroy(session);
    session = reopen("reference.selvage");
    slv_session_get_info(session, &info);
    CHECK(state_of(session) == states[ACTS] && !info.unsaved && !info.recovered);
    CHECK(slv_document_undo(slv_session_document(session)) == SLV_ERROR_ARGUMENT);
    slv_session_destroy(session);
    /* undone beyond what was saved: what was saved is another state then */
    session = create("undone.selvage", 4);
    for (uint32_t i = 0; i < 5; i++)
        MUST(act(session, i));
    MUST(slv_session_save(session));
    MUST(act(session, 8));
    for (uint32_t i = 0; i < 3; i++)
        MUST(slv_document_undo(slv_session_document(session)));
    CHECK(state_of(session) == states[3]);
    slv_session_destroy(session);
    session = reopen("undone.selvage");
    CHECK(state_of(session) == states[3]);
    slv_document_history(slv_session_document(session), &history);
    CHECK(history.undos == 3);
    slv_session_destroy(session);
    MUST(slv_session_open(&env, test_path("undone.selvage"),
                          &(slv_session_params){.as_saved = true}, &session));
    CHECK(state_of(session) == states[5]);
    slv_session_destroy(session);
    session = reopen("undone.selvage");
    CHECK(state_of(session) == states[5]);
    /* layers are painted on through the session */
    slv_painter *painter;
    uint64_t random = 1;
    MUST(slv_session_painter(session, &painter));
    CHECK(document_dab(slv_session_document(session), painter, 1, false, &random) ==
          SLV_ERROR_ARGUMENT);
    CHECK(line_of(session, 1, "{\"samples\":[[0,0.5]]}") == SLV_ERROR_FORMAT);
    CHECK(state_of(session) == states[5]);
    slv_session_destroy(session);
}

static char *load(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    REQUIRE(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *data = malloc(*size + 1);
    REQUIRE(fread(data, 1, *size, file) == *size);
    fclose(file);
    return data;
}

static void put(const char *path, const char *data, size_t size) {
    FILE *file = fopen(path, "wb");
    REQUIRE(file && fwrite(data, 1, size, file) == size);
    fclose(file);
}

/* The journal cut at every byte opens to its last whole line. */
static void cuts(void) {
    slv_session *session = create("cut.selvage", 3);
    size_t size, ends[9] = {0};
    uint64_t there[9] = {state_of(session)};
    for (uint32_t i = 0; i < 8; i++) {
        slv_session_info info;
        MUST(act(session, i));
        there[i + 1] = state_of(session);
        slv_session_get_info(session, &info);
        ends[i + 1] = (size_t)info.journal_bytes;
    }
    slv_session_destroy(session);
    char *journal = load(test_path("cut.selvage/journal"), &size);
    CHECK(size == ends[8]);
    for (size_t cut = 0, whole = 0; cut <= size; cut++) {
        whole += whole < 8 && cut >= ends[whole + 1];
        if (test_effort(1) == 1 && cut > ends[1] && cut % 29 && cut - ends[whole] > 1)
            continue;
        put(test_path("cut.selvage/journal"), journal, cut);
        session = reopen("cut.selvage");
        CHECK_MSG(state_of(session) == there[whole], "cut at byte %zu of %zu", cut, size);
        if (cut % 5 == 0 && whole) { /* it goes on from there */
            MUST(slv_document_add_layer(slv_session_document(session), NULL, NULL));
            uint64_t after = state_of(session);
            slv_session_destroy(session);
            session = reopen("cut.selvage");
            CHECK(state_of(session) == after);
        }
        slv_session_destroy(session);
    }
    /* a byte that is another in the middle: what is whole before it counts, the rest is kept */
    journal[ends[4] + 9] ^= 1;
    put(test_path("cut.selvage/journal"), journal, size);
    session = reopen("cut.selvage");
    CHECK(state_of(session) == there[4]);
    slv_session_destroy(session);
    CHECK(access(test_path("cut.selvage/journal-damaged"), F_OK) == 0);
    free(journal);
}

/* Paints on where others have stopped, and tells of each thing that was done. */
static void paint_until_killed(int tell) {
    slv_session *session = reopen("kill.selvage");
    slv_session_info info;
    slv_session_get_info(session, &info);
    for (uint32_t i = (uint32_t)info.lines; i < ACTS; i++) {
        MUST(act(session, i));
        if (write(tell, "", 1) != 1)
            _exit(1);
        if (i % 10 == 3) /* so that there is something to undo where others go on */
            MUST(slv_session_save(session));
        if (i % 4 == 3)
            MUST(slv_session_export(session, test_path("kill.ptx")));
    }
    slv_session_destroy(session);
    _exit(0);
}

static void kills(void) {
    uint32_t done = 0, count = 0;
    uint64_t random = 77;
    slv_session_destroy(create("kill.selvage", 4));
    for (uint32_t k = 0; k < test_effort(12); k++) {
        int pipes[2];
        char byte;
        slv_session_info info;
        REQUIRE(pipe(pipes) == 0);
        pid_t child = fork();
        if (child == 0) {
            close(pipes[0]);
            paint_until_killed(pipes[1]);
        }
        close(pipes[1]);
        usleep(2000 + test_random(&random) % 40000);
        kill(child, SIGKILL);
        int status;
        waitpid(child, &status, 0);
        CHECK(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
        while (read(pipes[0], &byte, 1) == 1)
            done++;
        close(pipes[0]);
        slv_session *session = reopen("kill.selvage");
        slv_session_get_info(session, &info);
        CHECK_MSG(info.lines >= done && info.lines <= done + 1, "%u done, %u there", (unsigned)done,
                  (unsigned)info.lines);
        CHECK_MSG(state_of(session) == states[info.lines], "another state after %u",
                  (unsigned)info.lines);
        done = (uint32_t)info.lines;
        slv_session_destroy(session);
        if (done == ACTS) { /* once more from the beginning */
            run("rm -rf kill.selvage");
            slv_session_destroy(create("kill.selvage", 4));
            done = 0;
            count++;
        }
    }
    run("! ls kill.selvage | grep '\\.selvage$'");
    if (access(test_path("kill.ptx"), F_OK) == 0) {
        slv_env env = test_env();
        slv_ptx *ptx = NULL;
        CHECK(!slv_ptx_open(&env, test_path("kill.ptx"), &ptx));
        slv_ptx_close(ptx);
    }
}

/* Files that may not grow: what cannot be journalled is not done, and the session is that which can
 * be opened again. */
static void full_disk(void) {
    slv_session *session = create("full.selvage", 4);
    uint32_t i = 0;
    slv_result result = SLV_OK;
    const struct rlimit none = {RLIM_INFINITY, RLIM_INFINITY};
    struct rlimit limit = {2000, RLIM_INFINITY};
    signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limit) == 0);
    while (!result && i < ACTS)
        if (!(result = act(session, i)))
            i++;
    CHECK(result == SLV_ERROR_IO && i > 1 && i < ACTS);
    CHECK_MSG(strstr(test_last_log, "journal") != NULL, "%s", test_last_log);
    CHECK(state_of(session) == states[i]);
    CHECK(slv_session_save(session) == SLV_ERROR_IO && state_of(session) == states[i]);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &none) == 0);
    MUST(act(session, i));
    CHECK(state_of(session) == states[i + 1]);
    slv_session_destroy(session);
    session = reopen("full.selvage");
    CHECK(state_of(session) == states[i + 1]);
    slv_session_destroy(session);
}

static void exports(void) {
    slv_env env = test_env();
    slv_session *session = create("export.selvage", 4);
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    uint32_t faces;
    for (uint32_t i = 0; i < 3; i++)
        MUST(act(session, i));
    MUST(slv_session_export(session, test_path("out.ptx")));
    MUST(slv_session_export_edits(session, test_path("out.ptx"), &faces));
    CHECK(faces == 0);
    MUST(line_of(session, 1, "{\"op\":\"fill\",\"face\":5,\"color\":[0,0,0]}"));
    MUST(slv_session_export_edits(session, test_path("out.ptx"), &faces));
    CHECK(faces == 1);
    MUST(slv_ptx_open(&env, test_path("out.ptx"), &ptx));
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    MUST(slv_document_flatten(slv_session_document(session)));
    CHECK(document_texture_hash(texture) ==
          document_texture_hash(slv_document_texture(slv_session_document(session))));
    /* and what was exported can be put into a layer, and comes back */
    MUST(slv_document_load_layer(slv_session_document(session), 1, texture));
    uint64_t state = state_of(session);
    slv_session_destroy(session);
    session = reopen("export.selvage");
    CHECK(state_of(session) == state);
    slv_session_destroy(session);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
}

/* Two who paint on other faces: one gets what the other has. */
static void merges(void) {
    static const char left[] = "{\"op\":\"fill\",\"face\":1,\"color\":[1,0,0]}",
                      right[] = "{\"op\":\"fill\",\"face\":4,\"color\":[0,0,1]}";
    slv_session *a = create("a.selvage", 3), *b = create("b.selvage", 3), *both;
    uint32_t faces, ids;
    MUST(slv_document_add_layer(slv_session_document(a), NULL, &ids));
    MUST(slv_document_add_layer(slv_session_document(b), NULL, &ids));
    MUST(line_of(a, 1, left));
    MUST(line_of(b, 1, right));
    both = create("both.selvage", 3);
    MUST(slv_document_add_layer(slv_session_document(both), NULL, &ids));
    MUST(line_of(both, 1, left));
    MUST(line_of(both, 1, right));
    MUST(slv_session_merge(a, b, &faces));
    CHECK(faces == 1 && state_of(a) == state_of(both));
    CHECK(slv_document_undo(slv_session_document(a)) == SLV_ERROR_ARGUMENT);
    slv_session_destroy(a);
    a = reopen("a.selvage");
    CHECK(state_of(a) == state_of(both));
    MUST(line_of(b, 1, "{\"op\":\"fill\",\"face\":1,\"color\":[0,1,0]}"));
    CHECK(slv_session_merge(a, b, &faces) == SLV_ERROR_MISMATCH);
    CHECK(strstr(test_last_log, "face 1 was painted on in both") != NULL);
    CHECK(state_of(a) == state_of(both));
    MUST(slv_document_add_layer(slv_session_document(b), NULL, &ids));
    CHECK(slv_session_merge(a, b, &faces) == SLV_ERROR_MISMATCH);
    slv_session_destroy(a);
    slv_session_destroy(b);
    slv_session_destroy(both);
}

int main(void) {
    test_folder_begin();
    find_states();
    comes_back();
    cuts();
    kills();
    full_disk();
    exports();
    merges();
    test_folder_end();
    return test_end();
}
