/* Converting and merging as an application calls them: what is asked for is done, what does not fit
 * is refused in one line, and a call that is cancelled leaves nothing behind. */
#include "kit/ptx_kit.h"

#include <selvage/exchange.h>
#include <selvage/folder.h>
#include <selvage/ptx_diff.h>

#include <dirent.h>

enum { FACES = 12 };

static char folder[256], in[300], out[300];
static int errors; /* lines of the library's */

static void count_errors(void *user, slv_log_level level, const char *message) {
    (void)user, (void)message;
    errors += level == SLV_LOG_ERROR;
}

static slv_env counting_env(void) {
    return (slv_env){.log = count_errors};
}

static void write_file(const char *path, uint32_t nchannels, int32_t alpha) {
    slv_env env = test_env();
    const slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                          .type = SLV_TYPE_U8,
                                          .nchannels = nchannels,
                                          .alpha_channel = alpha,
                                          .nfaces = FACES};
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, path, &params, &writer));
    for (uint32_t face = 0; face < FACES; face++) {
        uint8_t texels[16 * 16 * 4];
        const slv_ptx_face info = {.res = {4, 4}, .adjacency = {{-1, -1, -1, -1}, {0, 0, 0, 0}}};
        for (size_t i = 0; i < sizeof texels; i++)
            texels[i] = (uint8_t)(i * 7 + face);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

static int count_files(void) {
    int count = 0;
    DIR *list = opendir(folder);
    REQUIRE(list);
    for (struct dirent *entry; (entry = readdir(list));)
        count += entry->d_name[0] != '.';
    closedir(list);
    return count;
}

struct watch {
    uint64_t calls, last, total, stop; /* stop: at so many */
};

static bool report(void *user, uint64_t done, uint64_t total) {
    struct watch *w = user;
    CHECK(done >= w->last && done <= total);
    w->calls++;
    w->last = done;
    w->total = total;
    return !w->stop || done < w->stop;
}

static void check_params(void) {
    slv_env env = test_env();
    slv_exchange *source = NULL;
    slv_exchange_stats stats;
    struct watch watch = {0};
    const slv_exchange_channel channels[2] = {{.source = 2}, {.source = -1, .value = 0.5f}};
    const slv_exchange_face_res one = {.face = 3, .res = {5, 1}};
    const slv_exchange_params params = {.changes = SLV_EXCHANGE_TYPE | SLV_EXCHANGE_MAX_RES,
                                        .type = SLV_TYPE_HALF,
                                        .max_res = {3, 3},
                                        .face_res = &one,
                                        .nface_res = 1,
                                        .channels = channels,
                                        .nchannels = 2,
                                        .progress = {report, &watch}};
    slv_ptx *ptx = NULL;
    slv_ptx_face face;
    REQUIRE(!slv_exchange_open(&env, in, &source));
    CHECK(slv_exchange_get_params(source)->nfaces == FACES);
    REQUIRE(!slv_exchange_to_ptx(&env, source, &params, out, &stats));
    CHECK(stats.faces == FACES && stats.resized == FACES && stats.clipped == 0 &&
          stats.texels == (FACES - 1) * 64 + 64 && stats.wrote.nchannels == 2 &&
          stats.wrote.type == SLV_TYPE_HALF);
    CHECK(watch.last == FACES && watch.total == FACES);
    REQUIRE(!slv_ptx_open(&env, out, &ptx) && !slv_ptx_load_tables(ptx));
    REQUIRE(!slv_ptx_get_face(ptx, 3, &face));
    CHECK(face.res.u == 5 && face.res.v == 1);
    slv_ptx_close(ptx);
    slv_exchange_close(source);
    CHECK(remove(out) == 0);
}

/* With nothing asked for the file comes out as it was, from memory too. */
static void check_default(void) {
    slv_env env = test_env();
    slv_exchange *source = NULL;
    slv_ptx *before = NULL, *after = NULL;
    slv_face_diff faces[FACES];
    REQUIRE(!slv_ptx_open(&env, in, &before) && !slv_ptx_load_tables(before));
    REQUIRE(!slv_exchange_open_ptx(&env, before, &source));
    REQUIRE(!slv_exchange_to_ptx(&env, source, NULL, out, NULL));
    slv_exchange_close(source);
    REQUIRE(!slv_ptx_open(&env, out, &after));
    REQUIRE(!slv_ptx_diff(&env, before, after, NULL, faces));
    for (uint32_t i = 0; i < FACES; i++)
        CHECK(!faces[i].what);
    slv_ptx_close(before);
    slv_ptx_close(after);
    CHECK(remove(out) == 0);
}

#define REFUSES(wanted, call)                                                                      \
    do {                                                                                           \
        int before_ = errors;                                                                      \
        CHECK((call) == (wanted));                                                                 \
        CHECK_MSG(errors == before_ + 1, "%d lines", errors - before_);                            \
        CHECK(count_files() == 1);                                                                 \
    } while (0)

static void check_refused(void) {
    slv_env env = counting_env();
    slv_exchange *source = NULL;
    const slv_exchange_channel channel = {.source = 9};
    const slv_exchange_face_res twice[2] = {{0, {1, 1}}, {0, {2, 2}}};
    const slv_exchange_params bad[] = {
        {.channels = &channel, .nchannels = 1},
        {.channels = &channel, .nchannels = 0},
        {.changes = SLV_EXCHANGE_ALPHA, .alpha_channel = 3},
        {.min_res = {4, 4}, .changes = SLV_EXCHANGE_MAX_RES, .max_res = {3, 4}},
        {.min_res = {-1, 0}},
        {.scale_log2 = 99},
        {.face_res = twice, .nface_res = 2},
        {.premultiply = true},
        {.unmultiply = true, .premultiply = true}};
    REQUIRE(!slv_exchange_open(&env, in, &source));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        REFUSES(SLV_ERROR_ARGUMENT, slv_exchange_to_ptx(&env, source, &bad[i], out, NULL));
    REFUSES(SLV_ERROR_ARGUMENT, slv_exchange_to_sheet(&env, source, NULL, out, NULL));
    slv_exchange_close(source);
    REFUSES(SLV_ERROR_IO, slv_exchange_open(&env, "/nonexistent.ptx", &source));
    CHECK(!source);
    REFUSES(SLV_ERROR_ARGUMENT, slv_merge(&env, NULL, 0, NULL, out, NULL, NULL, NULL));
}

/* Stopped at any face, by any kind of result. */
static void check_cancelled(void) {
    slv_env env = counting_env();
    slv_exchange *source = NULL;
    char name[300];
    const char *paths[2] = {in, in};
    REQUIRE(!slv_exchange_open(&env, in, &source));
    for (uint32_t threads = 1; threads <= 4; threads += 3)
        for (uint64_t stop = 1; stop <= FACES; stop += 5) {
            struct watch watch = {.stop = stop};
            const slv_exchange_params params = {
                .changes = SLV_EXCHANGE_TYPE, .type = SLV_TYPE_HALF, .progress = {report, &watch}};
            const slv_merge_params merge = {.progress = {report, &watch}};
            env.threads = threads;
            REFUSES(SLV_ERROR_CANCELLED, slv_exchange_to_ptx(&env, source, &params, out, NULL));
            watch.last = 0;
            snprintf(name, sizeof name, "%s/images", folder);
            REFUSES(SLV_ERROR_CANCELLED, slv_exchange_to_folder(&env, source, &params, name, NULL));
            watch.last = 0;
            snprintf(name, sizeof name, "%s/sheet.exr", folder);
            REFUSES(SLV_ERROR_CANCELLED, slv_exchange_to_sheet(&env, source, &params, name, NULL));
            watch.last = 0;
            REFUSES(SLV_ERROR_CANCELLED, slv_merge(&env, paths, 2, &merge, out, NULL, NULL, NULL));
        }
    struct watch late = {.stop = 1};
    const slv_exchange_params params = {.sheet_progress = {report, &late}};
    REFUSES(SLV_ERROR_CANCELLED, slv_exchange_to_sheet(&env, source, &params, name, NULL));
    slv_exchange_close(source);
}

static void check_merge(void) {
    slv_env env = test_env();
    const char *paths[3] = {in, in, in};
    uint32_t first[3];
    bool geometry = true;
    slv_exchange_stats stats;
    REQUIRE(!slv_merge(&env, paths, 3, NULL, out, first, &geometry, &stats));
    CHECK(first[0] == 0 && first[1] == FACES && first[2] == 2 * FACES && !geometry);
    CHECK(stats.wrote.nfaces == 3 * FACES && stats.faces == 3 * FACES);
    CHECK(remove(out) == 0);
}

static void check_folder(void) {
    slv_env env = test_env();
    slv_folder *made = NULL;
    char path[300], name[400];
    snprintf(path, sizeof path, "%s/made", folder);
    for (int good = 0; good < 2; good++) {
        REQUIRE(!slv_folder_begin(&env, path, &made));
        snprintf(name, sizeof name, "%s/file", slv_folder_path(made));
        FILE *file = fopen(name, "w");
        REQUIRE(file && fclose(file) == 0);
        slv_result wanted = good ? SLV_OK : SLV_ERROR_CANCELLED;
        CHECK(slv_folder_end(made, NULL, wanted) == wanted);
        CHECK(count_files() == 1 + good);
    }
    snprintf(name, sizeof name, "%s/file", path);
    CHECK(remove(name) == 0 && remove(path) == 0);
    CHECK(slv_folder_end(NULL, NULL, SLV_ERROR_IO) == SLV_ERROR_IO);
}

int main(void) {
    snprintf(folder, sizeof folder, "%s/selvage_exchange_XXXXXX", test_parent());
    REQUIRE(mkdtemp(folder));
    snprintf(in, sizeof in, "%s/in.ptx", folder);
    snprintf(out, sizeof out, "%s/out.ptx", folder);
    write_file(in, 3, SLV_NO_ALPHA);
    check_default();
    check_params();
    check_refused();
    check_cancelled();
    check_merge();
    check_folder();
    CHECK(remove(in) == 0 && rmdir(folder) == 0);
    return test_end();
}
