/* The command on 2,000 spoilt .ptx files: info, check and convert end soon, with a result or with
 * words, and leave nothing half done. A file on which one does not is kept beside the test's
 * folder. SELVAGE_MUTATIONS is another number of files; sanitizers, under which a process takes ten
 * times as long to start, have fewer. */
#include "kit/tool_kit.h"

#include <selvage/ptx.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

#if TEST_SANITIZED
enum { MUTATIONS = 120, LIMIT_SECONDS = 40 };
#else
enum { MUTATIONS = 2000, LIMIT_SECONDS = 5 };
#endif

enum { MAX_SAMPLES = 64, SLOTS = 4, HEADER = 104 };
enum { INFO, CHECKS, CONVERT, VERBS };

static const char *const verb_names[VERBS] = {"info", "check", "convert"};

struct sample {
    char name[64];
    uint8_t *bytes;
    size_t size;
};

/* A spoilt file and the process that looks at it, in a folder of their own. */
struct slot {
    uint32_t mutation, sample;
    int verb;
    pid_t pid;
    char folder[300], in[320], out[320], words[2][320];
};

static struct sample samples[MAX_SAMPLES];
static uint32_t nsamples;
static char command[1024];
static uint32_t codes[VERBS][3]; /* how often each verb ended with 0, 1, 2 */

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

static void write_words(const char *path) {
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0)
        _exit(99);
    dup2(file, path[strlen(path) - 1] == 't' ? STDOUT_FILENO : STDERR_FILENO);
    close(file);
}

static void start(struct slot *slot) {
    slot->pid = fork();
    REQUIRE(slot->pid >= 0);
    if (slot->pid)
        return;
    alarm(LIMIT_SECONDS); /* goes with the process that it becomes, and ends it */
    write_words(slot->words[0]);
    write_words(slot->words[1]);
    if (slot->verb == INFO)
        execl(command, command, "info", slot->mutation % 3 ? "--faces" : "--json", "--meta",
              slot->in, (char *)NULL);
    else if (slot->verb == CHECKS)
        execl(command, command, "check", slot->mutation % 4 ? "--show=3" : "--seams=0.1", slot->in,
              (char *)NULL);
    else if (slot->mutation % 2)
        execl(command, command, "convert", slot->in, slot->out, (char *)NULL);
    else
        execl(command, command, "convert", "--scale=1/2", "--type=half", slot->in, slot->out,
              (char *)NULL);
    _exit(98);
}

static void begin(struct slot *slot, uint32_t mutation) {
    size_t size;
    uint8_t *bytes = spoil(mutation, &slot->sample, &size);
    FILE *stream = fopen(slot->in, "wb");
    REQUIRE(stream && fwrite(bytes, 1, size, stream) == size && fclose(stream) == 0);
    free(bytes);
    slot->mutation = mutation;
    slot->verb = 0;
    start(slot);
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

static void judge(const struct slot *slot, int status) {
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    bool written = slot->verb == CONVERT && code == 0, printed = has_words(slot->words[0]),
         explained = has_words(slot->words[1]) || (slot->verb == CHECKS && printed);
    int before = test_failures;
    char what[200];
    snprintf(what, sizeof what, "%s of %s, mutation %u", verb_names[slot->verb],
             samples[slot->sample].name, slot->mutation);
    CHECK_MSG(!WIFSIGNALED(status), "%s: ended by signal %d%s", what, WTERMSIG(status),
              WTERMSIG(status) == SIGALRM ? ": it took too long" : "");
    CHECK_MSG(!WIFEXITED(status) || (code >= 0 && code <= 2), "%s: exit code %d", what, code);
    CHECK_MSG(code == 0 || explained, "%s: exit code %d without a word", what, code);
    CHECK_MSG(code != 0 || printed || slot->verb == CONVERT, "%s: no answer", what);
    CHECK_MSG(count_files(slot->folder) == 1 + (uint32_t)written, "%s: files were left", what);
    CHECK_MSG(!written || is_good(slot->out), "%s: its result cannot be read: %s", what,
              test_last_log);
    if (code >= 0 && code <= 2)
        codes[slot->verb][code]++;
    remove(slot->out);
    if (test_failures > before && test_failures <= 20) {
        char kept[400];
        snprintf(kept, sizeof kept, "%s-mutation-%u.ptx", tool_folder, slot->mutation);
        if (link(slot->in, kept) == 0)
            fprintf(stderr, "kept as %s\n", kept);
    }
}

int main(void) {
    static struct slot slots[SLOTS];
    const char *wanted = getenv("SELVAGE_MUTATIONS");
    uint32_t count = wanted ? (uint32_t)strtoul(wanted, NULL, 10) : MUTATIONS, next = 0,
             running = 0;
    const char *bin = getenv("SELVAGE_BIN");
    snprintf(command, sizeof command, "%s/selvage", bin ? bin : "bin");
    REQUIRE(access(command, X_OK) == 0);
    tool_begin();
    load_samples();
    for (uint32_t i = 0; i < SLOTS; i++) {
        struct slot *slot = &slots[i];
        snprintf(slot->folder, sizeof slot->folder, "%s/%u", tool_folder, i);
        snprintf(slot->in, sizeof slot->in, "%s/in.ptx", slot->folder);
        snprintf(slot->out, sizeof slot->out, "%s/out.ptx", slot->folder);
        snprintf(slot->words[0], sizeof slot->words[0], "%s.out", slot->folder);
        snprintf(slot->words[1], sizeof slot->words[1], "%s.err", slot->folder);
        REQUIRE(mkdir(slot->folder, 0700) == 0);
        if (next < count) {
            begin(slot, next++);
            running++;
        }
    }
    while (running) {
        int status;
        pid_t pid = wait(&status);
        REQUIRE(pid > 0);
        struct slot *slot = slots;
        while (slot->pid != pid)
            slot++;
        judge(slot, status);
        if (++slot->verb < VERBS)
            start(slot);
        else if (next < count)
            begin(slot, next++);
        else
            running--;
    }
    for (int verb = 0; verb < VERBS; verb++) {
        fprintf(stderr, "%s: %u ended with 0, %u with 1, %u with 2\n", verb_names[verb],
                codes[verb][0], codes[verb][1], codes[verb][2]);
        /* or the files were spoilt too much, or too little, to say anything */
        CHECK(count < 100 || (codes[verb][0] > count / 50 && codes[verb][1] > count / 10));
    }
    for (uint32_t i = 0; i < nsamples; i++)
        free(samples[i].bytes);
    tool_end();
    return test_end();
}
