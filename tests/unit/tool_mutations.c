/* The command's verbs on 2,000 spoilt .ptx files: info, check and convert end soon, with a result
 * or with words, and leave nothing half done. They are called, many in one process, which another
 * one follows where a verb took it down; what happened is told with the number of the file, which
 * is all that it is made from, and the file is kept beside the test's folder. SELVAGE_MUTATIONS is
 * another number of files, or FIRST-LAST; sanitizers have fewer. */
#include "kit/tool_kit.h"

#include <selvage/ptx.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/time.h>

enum { MUTATIONS = TEST_SANITIZED ? 300 : 2000 };
/* Of a processor's time, for one verb: far more than any takes on a slow machine. */
enum { LIMIT_SECONDS = TEST_SANITIZED ? 120 : 30 };
enum { MAX_SAMPLES = 64, HEADER = 104, BATCH = 100 };
enum { INFO, CHECKS, CONVERT, VERBS };

static const char *const verb_names[VERBS] = {"info", "check", "convert"};

struct sample {
    char name[64];
    uint8_t *bytes;
    size_t size;
};

/* What the process that calls verbs has got to: shared with the one that waits for it. */
struct progress {
    uint32_t mutation, sample;
    int verb; /* VERBS between two files */
    int checks, failures;
    uint32_t codes[VERBS][3]; /* how often each verb ended with 0, 1, 2 */
};

static struct sample samples[MAX_SAMPLES];
static uint32_t nsamples;
static struct progress *progress;
static char place[300], in[320], out[320],
    words[2][320]; /* a folder; files; the last two are printed to */
static int own_stderr;

static int by_name(const void *left, const void *right) {
    return strcmp(((const struct sample *)left)->name, ((const struct sample *)right)->name);
}

static void load_samples(void) {
    const char *path = data_folder();
    DIR *folder = path ? opendir(path) : NULL;
    REQUIRE(folder);
    for (struct dirent *entry; (entry = readdir(folder)) && nsamples < MAX_SAMPLES;) {
        char file[2048];
        size_t length = strlen(entry->d_name);
        struct sample *sample = &samples[nsamples];
        if (length < 4 || length >= sizeof sample->name ||
            strcmp(entry->d_name + length - 4, ".ptx") != 0)
            continue;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        memcpy(sample->name, entry->d_name, length + 1);
        sample->bytes = read_whole(file, &sample->size);
        REQUIRE(sample->bytes && sample->size > HEADER);
        nsamples++;
    }
    closedir(folder);
    REQUIRE(nsamples > 0);
    qsort(samples, nsamples, sizeof *samples, by_name);
}

/* A field of the header, or of the list of levels and what follows it, as a wrong size has it. */
static void change_field(uint8_t *bytes, size_t size, uint64_t *seed) {
    size_t range = test_random(seed) % 4 ? HEADER : size < 600 ? size : 600;
    size_t at = test_random(seed) % (range / 4) * 4;
    uint32_t value, wrong[] = {0, 1, UINT32_MAX, INT32_MAX, (uint32_t)size, 65536, 1u << 24};
    memcpy(&value, bytes + at, sizeof value);
    uint32_t choice = test_random(seed) % 12;
    value = choice < 7     ? wrong[choice]
            : choice == 7  ? value + 1
            : choice == 8  ? value - 1
            : choice == 9  ? value * 2
            : choice == 10 ? value << 8
                           : ~value;
    memcpy(bytes + at, &value, sizeof value);
}

static uint8_t *spoil(uint32_t mutation, uint32_t *sample, size_t *size) {
    uint64_t seed = 977 + UINT64_C(1000003) * mutation;
    test_random(&seed);
    *sample = mutation % nsamples;
    if (samples[*sample].size > 40000 && mutation / nsamples % 4)
        *sample = test_random(&seed) % nsamples;
    const struct sample *from = &samples[*sample], *other = &samples[test_random(&seed) % nsamples];
    uint8_t *bytes = malloc(from->size);
    REQUIRE(bytes);
    memcpy(bytes, from->bytes, from->size);
    *size = from->size;
    uint32_t changes = 1 + test_random(&seed) % 2;
    for (uint32_t i = 0; i < changes; i++) {
        size_t range = test_random(&seed) % 2 && *size > 600 ? 600 : *size;
        size_t at = test_random(&seed) % range, length = 1 + test_random(&seed) % 512;
        switch (test_random(&seed) % 6) {
        case 0:
            bytes[at] ^= (uint8_t)(1u << test_random(&seed) % 8);
            break;
        case 1:
            bytes[at] = (uint8_t)test_random(&seed);
            break;
        case 2:
            if (i == 0)
                *size = at > HEADER || test_random(&seed) % 8 == 0 ? at : *size - at;
            break;
        case 3: { /* a piece of another file */
            size_t source = test_random(&seed) % other->size;
            length = length < *size - at ? length : *size - at;
            length = length < other->size - source ? length : other->size - source;
            memcpy(bytes + at, other->bytes + source, length);
            break;
        }
        default:
            if (*size > HEADER)
                change_field(bytes, *size, &seed);
        }
        if (*size < 4)
            break;
    }
    return bytes;
}

static void write_input(uint32_t mutation) {
    size_t size;
    uint8_t *bytes = spoil(mutation, &progress->sample, &size);
    FILE *stream = fopen(in, "wb");
    REQUIRE(stream && fwrite(bytes, 1, size, stream) == size && fclose(stream) == 0);
    free(bytes);
}

static void print_to(int stream, const char *path) {
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    REQUIRE(file >= 0 && dup2(file, stream) == stream && close(file) == 0);
}

static int call_verb(int verb, uint32_t mutation) {
    char *lines[VERBS][7] = {
        {"selvage", "info", mutation % 3 ? "--list-faces" : "--json", "--meta", in},
        {"selvage", "check", mutation % 4 ? "--show=3" : "--seams=0.1", in},
        {"selvage", "convert", "--scale=1/2", "--type=half", in, out}};
    char *whole[] = {"selvage", "convert", in, out, NULL};
    char **line = verb == CONVERT && mutation % 2 ? whole : lines[verb];
    int count = 0;
    while (line[count])
        count++;
    print_to(STDOUT_FILENO, words[0]);
    print_to(STDERR_FILENO, words[1]);
    int code = command_main(count, line);
    fflush(stdout);
    dup2(own_stderr, STDERR_FILENO);
    return code;
}

static bool has_words(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && status.st_size > 0;
}

static uint32_t count_files(const char *path) {
    uint32_t count = 0;
    DIR *folder = opendir(path);
    REQUIRE(folder);
    while (readdir(folder))
        count++;
    closedir(folder);
    return count - 2;
}

/* What convert says it wrote can be opened. */
static bool is_good(const char *path) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    bool good = !slv_ptx_open(&env, path, &ptx) && !slv_ptx_load_tables(ptx);
    slv_ptx_close(ptx);
    return good;
}

static const char *describe(void) {
    static char what[200];
    snprintf(what, sizeof what, "%s of %s, mutation %u", verb_names[progress->verb],
             samples[progress->sample].name, progress->mutation);
    return what;
}

static void keep(void) {
    char kept[400];
    snprintf(kept, sizeof kept, "%s-mutation-%u.ptx", test_folder, progress->mutation);
    if (link(in, kept) == 0)
        fprintf(stderr, "kept as %s\n", kept);
}

static void judge(int code) {
    int verb = progress->verb, before = test_failures;
    bool written = verb == CONVERT && code == 0, printed = has_words(words[0]),
         explained = has_words(words[1]) || (verb == CHECKS && printed);
    const char *what = describe();
    CHECK_MSG(code >= 0 && code <= 2, "%s: exit code %d", what, code);
    CHECK_MSG(code == 0 || explained, "%s: exit code %d without a word", what, code);
    CHECK_MSG(code != 0 || printed || verb == CONVERT, "%s: no answer", what);
    CHECK_MSG(count_files(place) == 1 + (uint32_t)written, "%s: files were left", what);
    CHECK_MSG(!written || is_good(out), "%s: its result cannot be read: %s", what, test_last_log);
    if (code >= 0 && code <= 2)
        progress->codes[verb][code]++;
    remove(out);
    if (test_failures > before && test_failures <= 20)
        keep();
}

/* In a process of its own; where a verb ends it, `progress` says which. */
static void run_batch(uint32_t first, uint32_t end) {
    struct itimerval limit = {{0, 0}, {LIMIT_SECONDS, 0}};
    int checks = test_checks, failures = test_failures;
    for (uint32_t mutation = first; mutation < end; mutation++) {
        progress->mutation = mutation;
        write_input(mutation);
        for (int verb = 0; verb < VERBS; verb++) {
            progress->verb = verb;
            REQUIRE(setitimer(ITIMER_PROF, &limit, NULL) == 0);
            judge(call_verb(verb, mutation));
            progress->checks = test_checks - checks;
            progress->failures = test_failures - failures;
        }
        progress->verb = VERBS;
    }
}

static void print_words(const char *path) {
    size_t size;
    char *text = (char *)read_whole(path, &size);
    if (text)
        fprintf(stderr, "%.*s", (int)(size < 4000 ? size : 4000), text);
    free(text);
}

/* Returns the first file that was not looked at. */
static uint32_t start_batch(uint32_t first, uint32_t end) {
    int status;
    progress->mutation = first;
    progress->verb = VERBS;
    progress->checks = progress->failures = 0;
    fflush(NULL);
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        run_batch(first, end);
        exit(0);
    }
    REQUIRE(waitpid(child, &status, 0) == child);
    test_checks += progress->checks;
    test_failures += progress->failures;
    if (progress->verb == VERBS) { /* leaks are found when the process ends */
        CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0,
                  "mutations %u to %u: status %d at the end of the process", first, end - 1,
                  status);
        return progress->mutation + 1;
    }
    CHECK_MSG(!WIFSIGNALED(status), "%s: ended by signal %d%s", describe(), WTERMSIG(status),
              WTERMSIG(status) == SIGPROF ? ": it took too long" : "");
    CHECK_MSG(!WIFEXITED(status), "%s: ended the process with %d", describe(), WEXITSTATUS(status));
    print_words(words[1]);
    keep();
    remove(out);
    return progress->mutation + 1;
}

int main(void) {
    const char *wanted = getenv("SELVAGE_MUTATIONS");
    uint32_t next = 0, end = MUTATIONS;
    if (wanted && strchr(wanted, '-')) {
        next = (uint32_t)strtoul(wanted, NULL, 10);
        end = (uint32_t)strtoul(strchr(wanted, '-') + 1, NULL, 10) + 1;
    } else if (wanted) {
        end = (uint32_t)strtoul(wanted, NULL, 10);
    }
    uint32_t count = end - next;
    progress =
        mmap(NULL, sizeof *progress, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(progress != MAP_FAILED);
    tool_begin();
    load_samples();
    snprintf(place, sizeof place, "%s/here", test_folder);
    snprintf(in, sizeof in, "%s/in.ptx", place);
    snprintf(out, sizeof out, "%s/out.ptx", place);
    snprintf(words[0], sizeof words[0], "%s.out", place);
    snprintf(words[1], sizeof words[1], "%s.err", place);
    REQUIRE(mkdir(place, 0700) == 0);
    REQUIRE((own_stderr = dup(STDERR_FILENO)) >= 0);
    while (next < end)
        next = start_batch(next, end - next < BATCH ? end : next + BATCH);
    for (int verb = 0; verb < VERBS; verb++) {
        const uint32_t *codes = progress->codes[verb];
        fprintf(stderr, "%s: %u ended with 0, %u with 1, %u with 2\n", verb_names[verb], codes[0],
                codes[1], codes[2]);
        /* or the files were spoilt too much, or too little, to say anything */
        CHECK(count < 100 || (codes[0] > count / 50 && codes[1] > count / 10));
    }
    for (uint32_t i = 0; i < nsamples; i++)
        free(samples[i].bytes);
    tool_end();
    return test_end();
}
