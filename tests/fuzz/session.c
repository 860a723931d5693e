/* A session whose journal has lines of any bytes, with numbers and checksums that fit; or, after a
 * first byte that is 's', whose state is any bytes with a checksum that fits; or, after a 'd',
 * whose session.json is any bytes. What opens is saved, and then opens again without its journal.
 */
#include "kit/fuzz_kit.h"

#include <selvage/session.h>

enum { FACES = 2, MOST_LINES = 16 };

static char folder[64], path[96], journal_path[128], state_path[128], about_path[128];

/* What the session was made with. */
typedef struct kept {
    char *bytes;
    size_t size;
} kept;
static kept first_state, first_about;

static void drop_folder(void) {
    char line[128];
    snprintf(line, sizeof line, "rm -rf %s", folder);
    if (system(line) != 0)
        abort();
    free(first_state.bytes);
    free(first_about.bytes);
}

static void put_file(const char *name, const void *data, size_t size) {
    FILE *file = fopen(name, "wb");
    FUZZ_REQUIRE(file && (!size || fwrite(data, size, 1, file) == 1) && fclose(file) == 0, "%s",
                 name);
}

static kept keep_file(const char *name) {
    FILE *file = fopen(name, "rb");
    kept out = {malloc(4096), 0};
    out.size = file ? fread(out.bytes, 1, 4096, file) : 0;
    FUZZ_REQUIRE(out.size > 16 && fclose(file) == 0, "no %s", name);
    return out;
}

/* A session on two squares that meet, made once. */
static void make_session(void) {
    static const float positions[] = {0, 0, 0, 1, 0, 0, 2, 0, 0.5f, 0, 1, 0, 1, 1, 0, 2, 1, 0.5f};
    static const int32_t sizes[] = {4, 4}, verts[] = {0, 1, 4, 3, 1, 2, 5, 4};
    static const slv_res res[FACES] = {{3, 3}, {2, 4}};
    const slv_mesh_view view = {.nverts = 6,
                                .positions = positions,
                                .npolys = FACES,
                                .poly_sizes = sizes,
                                .poly_verts = verts};
    const slv_session_params params = {
        .document.flat = {FACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO},
        .scheme = SLV_SCHEME_BILINEAR,
        .relaxed = true};
    slv_env env = fuzz_env();
    slv_mesh *mesh = NULL;
    slv_session *session = NULL;
    snprintf(folder, sizeof folder, "/tmp/selvage_fuzz_session_XXXXXX");
    FUZZ_REQUIRE(mkdtemp(folder), "no folder");
    snprintf(path, sizeof path, "%s/s.selvage", folder);
    snprintf(journal_path, sizeof journal_path, "%s/journal", path);
    snprintf(state_path, sizeof state_path, "%s/state-1", path);
    snprintf(about_path, sizeof about_path, "%s/session.json", path);
    FUZZ_REQUIRE(!slv_mesh_create(&env, &view, &mesh) &&
                     !slv_session_create(&env, path, mesh, &params, &session),
                 "no session: %s", fuzz_last);
    slv_session_destroy(session);
    slv_mesh_destroy(mesh);
    first_state = keep_file(state_path);
    first_about = keep_file(about_path);
    atexit(drop_folder);
}

static uint32_t crc_of(const void *data, size_t size) {
    const uint8_t *bytes = data;
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

/* Lines with what each ends with, in place of a brace where they have one. */
static void put_journal(const char *text, size_t size) {
    FILE *file = fopen(journal_path, "wb");
    FUZZ_REQUIRE(file, "%s", journal_path);
    for (unsigned line = 1; line <= MOST_LINES && size; line++) {
        const char *end = memchr(text, '\n', size);
        size_t length = end ? (size_t)(end - text) : size, used = length;
        char *whole = malloc(length + 64);
        memcpy(whole, text, length);
        used -= used && whole[used - 1] == '}';
        used += (size_t)sprintf(whole + used, ",\"n\":%u", line);
        uint32_t crc = crc_of(whole, used);
        used += (size_t)sprintf(whole + used, ",\"crc\":\"%08x\"}\n", (unsigned)crc);
        FUZZ_REQUIRE(fwrite(whole, used, 1, file) == 1, "%s", journal_path);
        free(whole);
        size -= length + (end != NULL);
        text += length + (end != NULL);
    }
    FUZZ_REQUIRE(fclose(file) == 0, "%s", journal_path);
}

/* Opens it, and if that can be, saves it, and opens what was saved. */
static void try_session(void) {
    const slv_session_params params = {.relaxed = true},
                             saved = {.relaxed = true, .as_saved = true};
    slv_env env = fuzz_env();
    slv_session *session = NULL;
    slv_session_info info;
    if (FUZZ_CALL(slv_session_open(&env, path, &params, &session)))
        return;
    uint32_t layers = slv_document_layer_count(slv_session_document(session));
    FUZZ_REQUIRE(!slv_session_save(session), "not saved: %s", fuzz_last);
    slv_session_destroy(session);
    FUZZ_REQUIRE(!slv_session_open(&env, path, &saved, &session), "not opened: %s", fuzz_last);
    FUZZ_REQUIRE(slv_document_layer_count(slv_session_document(session)) == layers, "other layers");
    slv_session_get_info(session, &info);
    FUZZ_REQUIRE(!info.unsaved, "something is unsaved");
    slv_session_destroy(session);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char line[160];
    char kind = size && (data[0] == 's' || data[0] == 'd') ? (char)data[0] : 'j';
    if (!first_state.bytes)
        make_session();
    for (int k = 1; k < 8; k++) {
        snprintf(line, sizeof line, "%s/state-%d", path, k);
        unlink(line);
    }
    if (kind == 's') {
        uint8_t *state = malloc(size + 3);
        uint32_t crc = crc_of(data + 1, size - 1);
        memcpy(state, data + 1, size - 1);
        memcpy(state + size - 1, &crc, sizeof crc);
        put_file(state_path, state, size + 3);
        free(state);
    } else {
        put_file(state_path, first_state.bytes, first_state.size);
    }
    if (kind == 'd')
        put_file(about_path, data + 1, size - 1);
    else
        put_file(about_path, first_about.bytes, first_about.size);
    put_journal((const char *)data, kind == 'j' ? size : 0);
    try_session();
    return 0;
}
