/* A fuzz target without a fuzzer: runs it on every file of the folders given, and on files. */
#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* Of a processor's time: a fuzzer says 5, and machines differ. */
enum { LIMIT_SECONDS = 60 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replayed, failures;

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

/* Exactly as many bytes as there are, so that a sanitizer sees a read past the end. */
static void replay_file(const char *path, size_t size) {
    uint8_t *data = malloc(size);
    FILE *stream = fopen(path, "rb");
    if ((!data && size) || !stream || (size && fread(data, 1, size, stream) != size)) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        failures++;
    } else {
        fprintf(stderr, "%s\n", path);
        double start = now();
        LLVMFuzzerTestOneInput(data, size);
        double seconds = now() - start;
        if (seconds > LIMIT_SECONDS) {
            fprintf(stderr, "%s: took %.1f s\n", path, seconds);
            failures++;
        }
        replayed++;
    }
    if (stream)
        fclose(stream);
    free(data);
}

static void replay(const char *path) {
    struct stat status;
    DIR *folder = opendir(path);
    if (!folder && stat(path, &status) == 0)
        replay_file(path, (size_t)status.st_size);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char name[2048];
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (stat(name, &status) == 0 && S_ISREG(status.st_mode))
            replay_file(name, (size_t)status.st_size);
    }
    if (folder)
        closedir(folder);
}

int main(int argc, char **argv) {
    LLVMFuzzerTestOneInput((const uint8_t *)"", 0);
    for (int i = 1; i < argc; i++)
        replay(argv[i]);
    fprintf(stderr, "%d files, %d failures\n", replayed, failures);
    return failures || !replayed ? 1 : 0;
}
