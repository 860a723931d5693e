/* Lookups as text: lines out of a stream, and what they say. */
#define _GNU_SOURCE /* tee */
#include "sample/sample.h"

#include "command/words.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER ((size_t)4 << 20)
#define GZIP "\x1f\x8b"

/* What comes first, without taking it: 0 bytes if that cannot be known. */
static ssize_t look_ahead(int descriptor, bool pipes, char *text, size_t size) {
    int twin[2];
    if (!pipes)
        return pread(descriptor, text, size, lseek(descriptor, 0, SEEK_CUR));
    if (pipe(twin) != 0)
        return 0;
    ssize_t got = tee(descriptor, twin[1], size, 0);
    if (got > 0)
        got = read(twin[0], text, (size_t)got);
    close(twin[0]);
    close(twin[1]);
    return got;
}

/* What gzip packed is read whole: no lookup begins like that. */
static int unpack(const char *path, bool pipes, sample_reader *out) {
    slv_env env = cli_env(0);
    char magic;
    size_t size;
    if (look_ahead(out->descriptor, pipes, &magic, 1) != 1 || magic != GZIP[0])
        return EXIT_OK;
    if (slv_text_load(&env, path, &out->unpacked, &size))
        return EXIT_FAILED;
    free(out->buffer);
    out->buffer = out->unpacked;
    out->size = out->end = size;
    out->ended = true;
    return EXIT_OK;
}

/* What stands before the first line. */
static int skip_mark(sample_reader *reader) {
    const char *at = reader->buffer + reader->start;
    size_t size = reader->end - reader->start;
    if (size >= 2 && memcmp(at, GZIP, 2) == 0)
        return cli_error("%s: is packed by gzip, which only a file or a pipe can be", reader->name);
    if (slv_text_encoding(at, size))
        return cli_error("%s: is text in %s: save it as UTF-8, which is what can be read",
                         reader->name, slv_text_encoding(at, size));
    if (size >= 3 && memcmp(at, "\xEF\xBB\xBF", 3) == 0) {
        reader->start += 3;
        reader->taken += 3;
    }
    return EXIT_OK;
}

/* A pipe is read as long as somebody has it open; who never comes is not waited for. */
static int wait_for_writer(sample_reader *out) {
    struct pollfd poller = {.fd = out->descriptor, .events = POLLIN};
    bool ready = poll(&poller, 1, 2000) != 0;
    ssize_t got = ready ? 1 : read(out->descriptor, out->buffer, BUFFER);
    if (!got)
        return cli_error("%s: a pipe that nobody writes to", out->name);
    out->end = !ready && got > 0 ? (size_t)got : 0;
    fcntl(out->descriptor, F_SETFL, fcntl(out->descriptor, F_GETFL) & ~O_NONBLOCK);
    return EXIT_OK;
}

int sample_reader_open(const char *path, sample_reader *out) {
    bool standard = !path || strcmp(cli_input(path), "/dev/stdin") == 0;
    struct stat status;
    *out = (sample_reader){.name = standard ? "standard input" : path,
                           .descriptor = standard ? STDIN_FILENO
                                                  : open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK),
                           .buffer = malloc(BUFFER + 1)};
    if (out->descriptor < 0)
        return cli_error("%s: %s", path, strerror(errno));
    if (!out->buffer)
        return cli_error("%s: no memory to read it", out->name);
    bool known = fstat(out->descriptor, &status) == 0;
    if (known && S_ISREG(status.st_mode)) {
        out->size = (uint64_t)status.st_size;
        return unpack(cli_input(standard ? "-" : path), false, out);
    }
    bool pipes = known && S_ISFIFO(status.st_mode);
    if (!standard && !pipes)
        return cli_error("%s: not a regular file", path);
    int code = standard ? EXIT_OK : wait_for_writer(out);
    return code || !pipes || out->end ? code : unpack(cli_input(standard ? "-" : path), true, out);
}

void sample_reader_close(sample_reader *reader) {
    if (reader->descriptor > STDIN_FILENO)
        close(reader->descriptor);
    if (!reader->unpacked)
        free(reader->buffer);
    slv_free(reader->unpacked);
}

static bool has_more_now(int descriptor) {
    struct pollfd poller = {.fd = descriptor, .events = POLLIN};
    return poll(&poller, 1, 0) > 0;
}

/* Fills the buffer, but does not wait once there is a line: whoever writes the lines may be waiting
 * for answers. */
static int fill(sample_reader *reader) {
    reader->end -= reader->start;
    memmove(reader->buffer, reader->buffer + reader->start, reader->end);
    reader->start = 0;
    bool has_line = memchr(reader->buffer, '\n', reader->end) != NULL;
    while (!reader->ended && reader->end < BUFFER &&
           (!has_line || has_more_now(reader->descriptor))) {
        char *at = reader->buffer + reader->end;
        ssize_t got = read(reader->descriptor, at, BUFFER - reader->end);
        if (cli_interrupted())
            return cli_error("%s: interrupted after line %llu", reader->name,
                             (unsigned long long)reader->line);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return cli_error("%s: %s", reader->name, strerror(errno));
        reader->ended = got == 0;
        reader->end += (size_t)got;
        has_line |= memchr(at, '\n', (size_t)got) != NULL;
    }
    return EXIT_OK;
}

/* Where the arrow is, or the end. */
static const char *find_arrow(const char *text, const char *end) {
    for (const char *p = text; (p = memchr(p, '-', (size_t)(end - p))); p++)
        if (p + 1 < end && p[1] == '>')
            return p;
    return end;
}

int sample_read(sample_reader *reader, sample_query *queries, size_t max, size_t *count) {
    *count = 0;
    while (*count == 0 && !(reader->ended && reader->start == reader->end)) {
        if (fill(reader) || (!reader->line && !reader->taken && skip_mark(reader)))
            return EXIT_FAILED;
        while (*count < max && reader->start < reader->end) {
            char *text = reader->buffer + reader->start, *limit = reader->buffer + reader->end;
            char *end = memchr(text, '\n', (size_t)(limit - text));
            if (!end && !reader->ended) {
                if (text == reader->buffer && limit == reader->buffer + BUFFER)
                    return cli_error("%s:%llu: the line is longer than %zu bytes", reader->name,
                                     (unsigned long long)reader->line + 1, BUFFER);
                break;
            }
            size_t length = end ? (size_t)(end - text) + 1 : (size_t)(limit - text);
            end = end ? end : limit;
            *end = 0;
            reader->start += length;
            reader->taken += length;
            reader->line++;
            const char *first = text, *last = find_arrow(text, end);
            while (first < end && isspace((unsigned char)*first))
                first++;
            if (first == end || *first == '#')
                continue;
            while (last > text && isspace((unsigned char)last[-1]))
                last--;
            queries[(*count)++] = (sample_query){
                .line = reader->line, .text = text, .length = (uint32_t)(last - text)};
        }
    }
    return EXIT_OK;
}

enum {
    FILTER,
    LERP,
    SHARPNESS,
    NO_EDGE_BLEND,
    WIDTH,
    BLUR,
    FIRST_CHANNEL,
    CHANNELS,
    FACE,
    POSITION,
    FOOTPRINT = POSITION + 2,
    FIELDS = FOOTPRINT + 4
};

static const char *const field_names[FIELDS] = {
    "the filter", "lerp", "sharpness", "noedgeblend", "width", "blur", "firstchan", "nchan",
    "faceid",     "u",    "v",         "uw1",         "vw1",   "uw2",  "vw2"};

typedef struct word {
    const char *text;
    size_t length;
    char shown[32]; /* fit for a terminal */
} word;

static bool next_word(const char **at, const char *end, word *out) {
    const char *p = *at;
    while (p < end && isspace((unsigned char)*p))
        p++;
    out->text = p;
    while (p < end && !isspace((unsigned char)*p))
        p++;
    out->length = (size_t)(p - out->text);
    *at = p;
    return out->length > 0;
}

static const char *show(word *w) {
    size_t n = w->length < sizeof w->shown ? w->length : sizeof w->shown - 1;
    for (size_t i = 0; i < n; i++)
        w->shown[i] = isprint((unsigned char)w->text[i]) ? w->text[i] : '?';
    w->shown[n] = 0;
    return w->shown;
}

static const char *filter_words(char *text, size_t size) {
    size_t used = 0;
    for (int f = 0; f < SLV_FILTER_COUNT && used < size; f++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", f ? "|" : "",
                                 slv_filter_name((slv_filter)f));
    return text;
}

static bool parse_filter(const word *w, slv_filter *out) {
    char name[32] = {0};
    if (w->length >= sizeof name)
        return false;
    memcpy(name, w->text, w->length);
    return strlen(name) == w->length && slv_filter_from_name(name, out);
}

static bool parse_whole(const word *w, int64_t min, int64_t max, int64_t *out) {
    char *end;
    errno = 0;
    long long value = strtoll(w->text, &end, 10);
    *out = value;
    return end == w->text + w->length && !errno && value >= min && value <= max;
}

static bool parse_real(const word *w, float *out) {
    char *end;
    *out = strtof(w->text, &end);
    return end == w->text + w->length;
}

/* Lookups with the same parameters go together: so what does not matter is the same. */
static void set_params(const sample_texture *texture, const int64_t *whole, const float *real,
                       sample_query *query) {
    uint32_t there = texture->info.nchannels;
    slv_filter_params *p = &query->params;
    slv_lookup *l = &query->lookup;
    p->lerp = whole[LERP] != 0;
    p->no_edge_blend = whole[NO_EDGE_BLEND] != 0;
    p->sharpness = p->filter == SLV_FILTER_BICUBIC ? real[SHARPNESS] : 0;
    p->width = real[WIDTH] == 0 ? 1 : real[WIDTH];
    p->blur = real[BLUR];
    p->first_channel = (uint32_t)whole[FIRST_CHANNEL];
    there = there > p->first_channel ? there - p->first_channel : 0;
    p->nchannels = whole[CHANNELS] && whole[CHANNELS] < there ? (uint32_t)whole[CHANNELS] : there;
    /* the library takes a width of 0 for the default; inf * 0 is not a number, as it should be */
    float scale = real[WIDTH] == 0 ? 0 : 1;
    query->face = whole[FACE];
    *l = (slv_lookup){.file = texture->file,
                      .face = (uint32_t)whole[FACE],
                      .u = real[POSITION],
                      .v = real[POSITION + 1],
                      .uw1 = real[FOOTPRINT] * scale,
                      .vw1 = real[FOOTPRINT + 1] * scale,
                      .uw2 = real[FOOTPRINT + 2] * scale,
                      .vw2 = real[FOOTPRINT + 3] * scale};
}

bool sample_parse(const sample_texture *texture, sample_query *query, char *problem, size_t size) {
    const char *at = query->text, *end = at + query->length;
    int64_t whole[FIELDS] = {0};
    float real[FIELDS] = {0};
    word w;
    for (int i = 0; i < FIELDS; i++) {
        const char *name = field_names[i];
        if (!next_word(&at, end, &w)) {
            snprintf(problem, size, "%s is missing: expected %d values, found %d", name, FIELDS, i);
            return false;
        }
        if (i == FILTER) {
            if (!parse_filter(&w, &query->params.filter)) {
                char hint[SLV_WORDS_HINT], words[256];
                const char *shown = show(&w);
                snprintf(problem, size, "'%s' is no filter%s", shown,
                         slv_words_hint(shown, filter_words(words, sizeof words), hint));
                return false;
            }
        } else if (i == LERP || i == NO_EDGE_BLEND || (i >= FIRST_CHANNEL && i <= FACE)) {
            int64_t max = i == FACE ? INT64_MAX : i >= FIRST_CHANNEL ? UINT32_MAX : 1;
            if (!parse_whole(&w, i == FACE ? INT64_MIN : 0, max, &whole[i])) {
                if (i == FACE)
                    snprintf(problem, size, "%s: '%s' is not a whole number", name, show(&w));
                else
                    snprintf(problem, size, "%s: '%s' is not a whole number from 0 to %lld", name,
                             show(&w), (long long)max);
                return false;
            }
        } else if (!parse_real(&w, &real[i])) {
            snprintf(problem, size, "%s: '%s' is not a number", name, show(&w));
            return false;
        } else if ((i == WIDTH || i == BLUR) && !(real[i] >= 0 && real[i] < INFINITY)) {
            snprintf(problem, size, "%s: '%s' is not finite, or negative", name, show(&w));
            return false;
        } else if (i == SHARPNESS && query->params.filter == SLV_FILTER_BICUBIC &&
                   !(real[i] >= 0 && real[i] <= 1)) {
            snprintf(problem, size, "%s: '%s' does not lie in 0 to 1", name, show(&w));
            return false;
        }
    }
    if (next_word(&at, end, &w)) {
        snprintf(problem, size, "'%s' comes after vw2, where '->' or the end was expected",
                 show(&w));
        return false;
    }
    set_params(texture, whole, real, query);
    return true;
}

#define ORDER(a, b)                                                                                \
    if ((a) != (b))                                                                                \
    return (a) < (b) ? -1 : 1

int sample_compare_params(const slv_filter_params *a, const slv_filter_params *b) {
    ORDER(a->filter, b->filter);
    ORDER(a->lerp, b->lerp);
    ORDER(a->no_edge_blend, b->no_edge_blend);
    ORDER(a->sharpness, b->sharpness);
    ORDER(a->width, b->width);
    ORDER(a->blur, b->blur);
    ORDER(a->first_channel, b->first_channel);
    ORDER(a->nchannels, b->nchannels);
    return 0;
}

bool sample_is_there(const sample_texture *texture, const sample_query *query) {
    return query->face >= 0 && query->face < texture->info.nfaces && query->params.nchannels > 0;
}
