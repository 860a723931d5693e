/* A writer that is killed at random moments: its target is the old file or the new one, and what it
 * leaves beside it is gone after the next run that ends well. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

#include <dirent.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

#define NFACES 64
#define LOG2 6

static uint64_t seed = 11;
static char folder[1024], path[1200];
static uint8_t texels[(3 << (2 * LOG2)) + 1];

/* A file all of whose faces begin with `value`; `memory` small enough to make it spill. */
static slv_result write_file(uint8_t value) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {.mesh_type = SLV_PTX_QUAD,
                               .nchannels = 3,
                               .alpha_channel = SLV_NO_ALPHA,
                               .nfaces = NFACES,
                               .memory = 1};
    slv_ptx_writer *writer = NULL;
    slv_result result = slv_ptx_writer_create(&env, path, &p, &writer);
    texels[0] = value;
    for (uint32_t face = 0; face < NFACES && !result; face++) {
        slv_ptx_face info = {.res = {LOG2, LOG2}, .adjacency.face = {-1, -1, -1, -1}};
        result = slv_ptx_writer_write_face(writer, face, &info, texels);
    }
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

static slv_result edit_file(uint8_t value) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    slv_result result = slv_ptx_writer_edit(&env, path, NULL, &writer);
    texels[0] = value;
    for (uint32_t face = 0; face < NFACES && !result; face++) {
        slv_ptx_face info = {.res = {LOG2, LOG2}, .adjacency.face = {-1, -1, -1, -1}};
        result = slv_ptx_writer_write_face(writer, face, &info, texels);
    }
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

/* The value that all faces of the file begin with. */
static int value_of_file(void) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    int value = -1;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_load_texture(&env, ptx, &texture) == SLV_OK);
    for (uint32_t face = 0; face < NFACES; face++) {
        int found = *(const uint8_t *)slv_texture_texels(texture, face);
        CHECK(value < 0 || value == found);
        value = found;
    }
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    return value;
}

static int count_files(void) {
    DIR *dir = opendir(folder);
    int count = 0;
    for (struct dirent *entry; dir && (entry = readdir(dir));)
        count += entry->d_name[0] != '.';
    if (dir)
        closedir(dir);
    return count;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void rounds(slv_result (*change)(uint8_t), int kills) {
    double start = now();
    REQUIRE(change(1) == SLV_OK);
    double whole = now() - start;
    int killed = 0, value = 1;
    for (int i = 0; i < kills; i++) {
        uint8_t next = (uint8_t)(2 + i % 200);
        double moment =
            i ? whole * (test_random(&seed) % 1200) / 1000.0 : 0; /* one dies for sure */
        struct timespec wait = {(time_t)moment, (long)((moment - (double)(time_t)moment) * 1e9)};
        pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0)
            _exit(change(next) ? 1 : 0);
        nanosleep(&wait, NULL);
        kill(child, SIGKILL);
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        killed += WIFSIGNALED(status);
        int found = value_of_file();
        CHECK_MSG(found == value || found == next, "%d, which is neither %d nor %d", found, value,
                  next);
        value = found;
    }
    CHECK(killed > 0);
    fprintf(stderr, "%d of %d were killed, %d files at the end\n", killed, kills, count_files());
    REQUIRE(change(250) == SLV_OK);
    CHECK(value_of_file() == 250);
    CHECK_MSG(count_files() == 1, "%d files", count_files());
}

/* Another writer's file is left alone while that writer lives. */
static void neighbour(void) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {
        .mesh_type = SLV_PTX_QUAD, .nchannels = 1, .alpha_channel = SLV_NO_ALPHA, .nfaces = 1};
    slv_ptx_writer *a = NULL, *b = NULL;
    slv_ptx_face info = {.flags = SLV_FACE_CONSTANT, .adjacency.face = {-1, -1, -1, -1}};
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &a) == SLV_OK);
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &b) == SLV_OK);
    REQUIRE(slv_ptx_writer_write_face(a, 0, &info, "a") == SLV_OK);
    REQUIRE(slv_ptx_writer_write_face(b, 0, &info, "b") == SLV_OK);
    CHECK(slv_ptx_writer_finish(b) == SLV_OK);
    CHECK(slv_ptx_writer_finish(a) == SLV_OK);
    slv_ptx_writer_destroy(a);
    slv_ptx_writer_destroy(b);
    CHECK(count_files() == 1);
}

int main(void) {
    snprintf(folder, sizeof folder, "%s", scratch_path("kill"));
    snprintf(path, sizeof path, "%s/target.ptx", folder);
    REQUIRE(mkdir(folder, 0700) == 0);
    for (size_t i = 0; i < sizeof texels; i++)
        texels[i] = (uint8_t)(test_random(&seed) % 40);
    rounds(write_file, 50);
    rounds(write_file, 10);
    REQUIRE(write_file(1) == SLV_OK);
    rounds(edit_file, 50);
    neighbour();
    remove(path);
    remove(folder);
    return test_end();
}
