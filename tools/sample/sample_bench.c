/* How many lookups there are a second, of those that a text asks for. */
#include "sample/sample.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Samplers are made beforehand and there is one for each set of parameters, so sets are few. */
enum { MAX_QUERIES = 1 << 20, MAX_SETS = 1024, PIECE = 1 << 16, PIECE_VALUES = 1 << 20 };
static const double seconds_a_mode = 0.4, seconds_a_round = 0.05;

typedef enum mode { ONE_BY_ONE, BATCHED, SORTED, MODES } mode;
static const char *const mode_names[MODES][2] = {
    {"One by one", "one_by_one"}, {"Batched", "batched"}, {"Sorted", "sorted"}};

typedef struct set {
    size_t first, count;
    slv_filter_params params;
} set;

typedef struct bench {
    sample_texture *texture;
    sample_query *queries;
    slv_lookup *lookups;
    size_t count, room, stride, piece;
    set sets[MAX_SETS];
    uint32_t nsets;
    mode mode;
} bench;

typedef struct runner {
    const bench *bench;
    slv_sampler *samplers[MAX_SETS];
    float *values;
    slv_result *results;
    void *workspace;
    double rate;
} runner;

static int by_params(const void *a, const void *b) {
    const sample_query *x = a, *y = b;
    int order = sample_compare_params(&x->params, &y->params);
    return order ? order : (x->line > y->line) - (x->line < y->line);
}

static int load(bench *b, sample_reader *reader, uint64_t *failed) {
    for (size_t got; b->count < MAX_QUERIES; b->count += got) {
        if (b->room - b->count < PIECE) {
            b->room = 2 * b->room + PIECE;
            sample_query *more = realloc(b->queries, b->room * sizeof *more);
            if (!more)
                return cli_error("%s: no memory for its lookups", reader->name);
            b->queries = more;
        }
        sample_query *queries = b->queries + b->count;
        int code = sample_read(reader, queries, PIECE, &got);
        if (code || !got)
            return code;
        size_t kept = 0;
        for (size_t i = 0; i < got; i++) {
            char problem[160];
            if (!sample_parse(b->texture, &queries[i], problem, sizeof problem))
                return cli_error("%s:%llu: %s", reader->name, (unsigned long long)queries[i].line,
                                 problem);
            if (sample_is_there(b->texture, &queries[i])) {
                queries[kept++] = queries[i];
                continue;
            }
            sample_reason(b->texture, &queries[i], SLV_ERROR_ARGUMENT, problem, sizeof problem);
            sample_complain(reader, queries[i].line, problem, failed);
        }
        got = kept;
    }
    uint64_t line = reader->line;
    sample_query beyond;
    size_t more;
    int code = sample_read(reader, &beyond, 1, &more);
    if (!code && more)
        cli_warning("%s: only the lookups up to line %llu are repeated", reader->name,
                    (unsigned long long)line);
    return code;
}

static void find_sets(bench *b) {
    qsort(b->queries, b->count, sizeof *b->queries, by_params);
    for (size_t i = 0; i < b->count; i++) {
        set *last = &b->sets[b->nsets ? b->nsets - 1 : 0];
        if (b->nsets && sample_compare_params(&last->params, &b->queries[i].params) == 0) {
            last->count++;
            continue;
        }
        if (b->nsets == MAX_SETS) {
            cli_warning("of %zu lookups %zu are repeated, those with the first %d sets of "
                        "parameters",
                        b->count, i, MAX_SETS);
            b->count = i;
            break;
        }
        b->sets[b->nsets++] = (set){i, 1, b->queries[i].params};
    }
}

static bool runner_begin(runner *r, const bench *b) {
    r->bench = b;
    r->values = calloc(b->piece * b->stride, sizeof *r->values);
    r->results = calloc(b->piece, sizeof *r->results);
    r->workspace = malloc(slv_sample_workspace(b->piece));
    bool good = r->values && r->results && r->workspace;
    for (uint32_t i = 0; good && i < b->nsets; i++)
        good = !slv_sampler_create(b->texture->cache, &b->sets[i].params, &r->samplers[i]);
    return good;
}

static void runner_end(runner *r) {
    for (uint32_t i = 0; i < MAX_SETS; i++)
        slv_sampler_destroy(r->samplers[i]);
    free(r->values);
    free(r->results);
    free(r->workspace);
}

static void look_up(runner *r, uint32_t which, size_t first, size_t count) {
    const bench *b = r->bench;
    const slv_lookup *lookups = b->lookups + first;
    slv_sampler *sampler = r->samplers[which];
    slv_result failed = SLV_OK;
    switch (b->mode) {
    case ONE_BY_ONE:
        for (size_t i = 0; i < count; i++)
            r->results[i] = slv_sample(sampler, &lookups[i], r->values + i * b->stride);
        break;
    case BATCHED:
        failed = slv_sample_batch(sampler, lookups, count, r->values, b->stride, r->results);
        break;
    default:
        failed = slv_sample_sorted(sampler, lookups, count, r->values, b->stride, r->results,
                                   r->workspace);
    }
    (void)failed; /* each has a result of its own */
}

static size_t piece_of(const bench *b, const set *s, size_t done) {
    return s->count - done < b->piece ? s->count - done : b->piece;
}

/* One pass puts texels into the cache and finds the lookups that fail, which are not repeated. */
static void drop_failures(bench *b, runner *r, const sample_reader *reader, uint64_t *failed) {
    char reason[640];
    size_t kept = 0;
    sample_log *log = b->texture->log;
    for (uint32_t k = 0; k < b->nsets; k++) {
        set s = b->sets[k];
        b->sets[k] = (set){kept, 0, s.params};
        for (size_t i = s.first; i < s.first + s.count; i++) {
            log->message[0] = 0;
            log->mode = SAMPLE_LOG_KEEP;
            slv_result result = slv_sample(r->samplers[k], &b->queries[i].lookup, r->values);
            log->mode = SAMPLE_LOG_PRINT;
            if (result && result != SLV_ERROR_ARGUMENT && !log->message[0])
                result = sample_again(b->texture, r->samplers[k], &b->queries[i].lookup, r->values);
            if (!result) {
                b->queries[kept++] = b->queries[i];
                b->sets[k].count++;
                continue;
            }
            sample_reason(b->texture, &b->queries[i], result, reason, sizeof reason);
            sample_complain(reader, b->queries[i].line, reason, failed);
        }
    }
    b->count = kept;
}

static void *repeat(void *user) {
    runner *r = user;
    const bench *b = r->bench;
    double started = cli_now(), spent;
    uint64_t passes = 0;
    do {
        for (uint32_t k = 0; k < b->nsets; k++)
            for (size_t done = 0, n; done < b->sets[k].count; done += n) {
                n = piece_of(b, &b->sets[k], done);
                look_up(r, k, b->sets[k].first + done, n);
            }
        passes++;
        spent = cli_now() - started;
    } while (spent < seconds_a_round);
    r->rate = (double)passes * (double)b->count / spent;
    return NULL;
}

/* All threads together, for a moment. */
static double run_round(runner *runners, uint32_t count) {
    pthread_t threads[256];
    uint32_t started = 0;
    double rate = 0;
    while (started + 1 < count &&
           pthread_create(&threads[started], NULL, repeat, &runners[started + 1]) == 0)
        started++;
    repeat(&runners[0]);
    rate = runners[0].rate;
    for (uint32_t i = 0; i < started; i++) {
        pthread_join(threads[i], NULL);
        rate += runners[i + 1].rate;
    }
    return rate;
}

/* Rounds of all modes take turns, so that whatever else the machine does hits all of them. */
static void measure(bench *b, runner *runners, uint32_t nthreads, double *rates) {
    double spent[MODES] = {0}, looked_up[MODES] = {0}, total = 0;
    while (total < MODES * seconds_a_mode) {
        for (int m = 0; m < MODES; m++) {
            double started = cli_now();
            b->mode = (mode)m;
            double rate = run_round(runners, nthreads);
            double time = cli_now() - started;
            spent[m] += time;
            looked_up[m] += rate * time;
            total += time;
        }
    }
    for (int m = 0; m < MODES; m++)
        rates[m] = looked_up[m] / spent[m];
}

static void print_rates(const sample_options *options, const bench *b, uint32_t nthreads,
                        const double *rates, FILE *stream) {
    if (options->json) {
        json_t *root = json_pack("{s:i, s:o, s:I, s:I, s:I, s:f, s:f, s:f}", "schema", 1, "path",
                                 output_json_name(b->texture->path), "lookups",
                                 (json_int_t)b->count, "parameter_sets", (json_int_t)b->nsets,
                                 "threads", (json_int_t)nthreads, mode_names[0][1], rates[0],
                                 mode_names[1][1], rates[1], mode_names[2][1], rates[2]);
        if (root && json_dumpf(root, stream, JSON_INDENT(2)) == 0)
            fputc('\n', stream);
        json_decref(root);
        return;
    }
    fprintf(stream, "  %-14s%zu, with %u set%s of parameters\n", "Lookups", b->count, b->nsets,
            b->nsets == 1 ? "" : "s");
    fprintf(stream, "  %-14s%u\n", "Threads", nthreads);
    for (int m = 0; m < MODES; m++)
        fprintf(stream, "  %-14s%.0f a second\n", mode_names[m][0], rates[m]);
}

int sample_bench(const sample_options *options, sample_texture *texture, sample_reader *reader,
                 FILE *stream, uint64_t *failed) {
    uint32_t nthreads = sample_threads(options);
    size_t piece = PIECE_VALUES / texture->info.nchannels;
    bench *b = calloc(1, sizeof *b);
    runner *runners = calloc(nthreads, sizeof *runners);
    double rates[MODES];
    int code = EXIT_FAILED;
    if (!b || !runners) {
        cli_error("%s: no memory to repeat lookups", reader->name);
        goto done;
    }
    *b = (bench){.texture = texture,
                 .stride = texture->info.nchannels,
                 .piece = piece < PIECE ? piece : PIECE};
    if (load(b, reader, failed))
        goto done;
    find_sets(b);
    code = EXIT_OK;
    for (uint32_t i = 0; i < nthreads && !code; i++)
        if (!runner_begin(&runners[i], b))
            code = cli_error("%s: no memory to repeat lookups", reader->name);
    if (code)
        goto done;
    drop_failures(b, &runners[0], reader, failed);
    b->lookups = malloc((b->count ? b->count : 1) * sizeof *b->lookups);
    if (!b->lookups || !b->count) {
        code = cli_error("%s: %s", reader->name,
                         b->count ? "no memory to repeat lookups" : "no lookups to repeat");
        goto done;
    }
    for (size_t i = 0; i < b->count; i++)
        b->lookups[i] = b->queries[i].lookup;
    measure(b, runners, nthreads, rates);
    print_rates(options, b, nthreads, rates, stream);
done:
    for (uint32_t i = 0; runners && i < nthreads; i++)
        runner_end(&runners[i]);
    if (b) {
        free(b->queries);
        free(b->lookups);
    }
    free(b);
    free(runners);
    return code;
}
