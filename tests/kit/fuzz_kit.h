/* What the fuzz targets share: an environment whose promises are checked, and a folder for files.
 * A broken promise aborts, which is what a fuzzer notices. */
#ifndef SLV_FUZZ_KIT_H
#define SLV_FUZZ_KIT_H

#include <selvage/ptx_writer.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FUZZ_MAX_BYTES = 1 << 24, FUZZ_MAX_WRITTEN = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FUZZ_REQUIRE(condition, ...)                                                               \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: ", __FILE__, __LINE__);                                        \
            fprintf(stderr, __VA_ARGS__);                                                          \
            fputc('\n', stderr);                                                                   \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

static int fuzz_errors; /* lines since the last call that was expected to log at most one */
static char fuzz_last[512];

static void fuzz_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    size_t length = strlen(message); /* reads all of it */
    if (level != SLV_LOG_ERROR)
        return;
    fuzz_errors++;
    if (length >= sizeof fuzz_last)
        length = sizeof fuzz_last - 1;
    memcpy(fuzz_last, message, length);
    fuzz_last[length] = 0;
}

static inline slv_env fuzz_env(void) {
    slv_env env = {.log = fuzz_log, .threads = 1, .max_bytes = FUZZ_MAX_BYTES};
    return env;
}

/* A failure has logged exactly one line, a success none. */
#define FUZZ_CALL(call) fuzz_called(call, #call)
static inline slv_result fuzz_called(slv_result result, const char *what) {
    FUZZ_REQUIRE(fuzz_errors == (result != SLV_OK), "%d error lines, result %d: %s\nlast: %s",
                 fuzz_errors, (int)result, what, fuzz_last);
    fuzz_errors = 0;
    return result;
}

/* The last bytes of an input decide what is done with the others. */
static inline uint32_t fuzz_control(const uint8_t *data, size_t *size) {
    uint32_t control = 0;
    for (int i = 0; i < 4 && *size; i++)
        control = control << 8 | data[--*size];
    return control;
}

struct fuzz_bytes {
    const uint8_t *data;
    size_t size;
};

/* Two files in one input: the length of the first in four bytes, the first, the second. An input
 * that is no such pair stands for both. */
static inline void fuzz_pair(const uint8_t *data, size_t size, struct fuzz_bytes out[2]) {
    uint32_t first = 0;
    for (int i = 0; i < 4 && size >= 4; i++)
        first |= (uint32_t)data[i] << 8 * i;
    bool pair = size >= 4 && first <= size - 4;
    out[0] = pair ? (struct fuzz_bytes){data + 4, first} : (struct fuzz_bytes){data, size};
    out[1] = pair ? (struct fuzz_bytes){data + 4 + first, size - 4 - first} : out[0];
}

static inline int fuzz_read(void *user, uint64_t offset, void *buffer, size_t size) {
    const struct fuzz_bytes *bytes = user;
    if (offset > bytes->size || size > bytes->size - offset)
        return -1;
    memcpy(buffer, bytes->data + offset, size);
    return 0;
}

/* `bytes` outlives the file. */
static inline slv_ptx *fuzz_open(const slv_env *env, struct fuzz_bytes *bytes, bool premultiply) {
    slv_stream_in source = {fuzz_read, NULL, bytes, bytes->size};
    slv_ptx_open_params params = {.premultiply = premultiply, .source = &source};
    slv_ptx *ptx = NULL;
    return FUZZ_CALL(slv_ptx_open_with(env, "fuzz.ptx", &params, &ptx)) ? NULL : ptx;
}

static char fuzz_folder[256];

static inline int fuzz_empty(bool all);

static inline void fuzz_remove_folder(void) {
    fuzz_empty(true);
    rmdir(fuzz_folder);
}

/* A path in a folder of this process's own, in memory where there is such a place; four are valid
 * at a time. */
static inline const char *fuzz_path(const char *name) {
    static char paths[4][512];
    static int turn;
    if (!fuzz_folder[0]) {
        snprintf(fuzz_folder, sizeof fuzz_folder, "%s/selvage_fuzz_XXXXXX",
                 access("/dev/shm", W_OK | X_OK) == 0 ? "/dev/shm" : "/tmp");
        FUZZ_REQUIRE(mkdtemp(fuzz_folder), "no folder %s", fuzz_folder);
        atexit(fuzz_remove_folder);
    }
    char *path = paths[turn = (turn + 1) % 4];
    snprintf(path, sizeof paths[0], "%s/%s", fuzz_folder, name);
    return path;
}

static inline void fuzz_write(const char *name, const uint8_t *data, size_t size) {
    FILE *stream = fopen(fuzz_path(name), "wb");
    FUZZ_REQUIRE(stream, "cannot write %s", name);
    FUZZ_REQUIRE(!size || fwrite(data, 1, size, stream) == size, "cannot write %s", name);
    FUZZ_REQUIRE(fclose(stream) == 0, "cannot write %s", name);
}

static inline bool fuzz_exists(const char *name) {
    return access(fuzz_path(name), F_OK) == 0;
}

/* Files whose names begin with keep_ outlive an input. Returns how many others there were. */
static inline int fuzz_empty(bool all) {
    DIR *folder = fuzz_folder[0] ? opendir(fuzz_folder) : NULL;
    int count = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        bool keep = strncmp(entry->d_name, "keep_", 5) == 0;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 || (keep && !all))
            continue;
        count += !keep;
        FUZZ_REQUIRE(unlink(fuzz_path(entry->d_name)) == 0, "cannot remove %s", entry->d_name);
    }
    if (folder)
        closedir(folder);
    return count;
}

/* Removes all files, of which there must be as many as are meant to be there. */
static inline void fuzz_clear(int expected) {
    int count = fuzz_empty(false);
    FUZZ_REQUIRE(count == expected, "%d files where %d are meant to be", count, expected);
}

/* Bytes that all faces take when they are unpacked; 0 if damaged tables prevent that. What writes
 * all of a file takes time for all of it, however well it was packed. */
static inline uint64_t fuzz_unpacked(const slv_ptx *ptx) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t pixel = (uint64_t)slv_type_size(info->type) * info->nchannels, bytes = 0;
    if (FUZZ_CALL(slv_ptx_load_tables(ptx)))
        return 0;
    for (uint32_t i = 0; i < info->nfaces; i++) {
        slv_ptx_face face;
        if (FUZZ_CALL(slv_ptx_get_face(ptx, i, &face)))
            return 0;
        bytes += face.flags & SLV_FACE_CONSTANT ? pixel : pixel << (face.res.u + face.res.v);
    }
    return bytes;
}

#endif
