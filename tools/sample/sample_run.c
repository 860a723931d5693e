/* Lookups in chunks: blocks of lines go to threads, which group them by parameters; what they give
 * is printed in order. */
#include "sample/sample.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most values of a chunk, lines of a chunk, and blocks of one. */
enum { CHUNK_VALUES = 1 << 22, CHUNK_LINES = 1 << 16, BLOCKS = 64, SAMPLERS = 16 };

typedef struct block {
    size_t first, end;
    uint64_t failed;
    bool malformed;
    char problem[160]; /* of the line `end` */
    char *text;
    size_t size;
} block;

typedef struct worker {
    struct job *job;
    struct {
        slv_filter_params params;
        slv_sampler *sampler;
    } samplers[SAMPLERS];
    uint32_t next_sampler;
    sample_query **order;
    slv_lookup *lookups;
    slv_result *results;
    float *rows;
    bool no_memory;
} worker;

typedef struct job {
    const sample_options *options;
    sample_texture *texture;
    sample_query *queries;
    float *values;
    slv_result *results;
    size_t count, max, block_lines, stride;
    block blocks[BLOCKS];
    size_t nblocks;
    atomic_size_t next_block;
    worker *workers;
    uint32_t nworkers;
} job;

uint32_t sample_threads(const sample_options *options) {
    long online = options->threads ? (long)options->threads : sysconf(_SC_NPROCESSORS_ONLN);
    return online < 1 ? 1 : online > 256 ? 256 : (uint32_t)online;
}

void sample_complain(const sample_reader *reader, uint64_t line, const char *reason,
                     uint64_t *failed) {
    if (++*failed <= SAMPLE_COMPLAINTS)
        cli_error("%s:%llu: %s", reader->name, (unsigned long long)line, reason);
}

void sample_reason(const sample_texture *texture, const sample_query *query, slv_result result,
                   char *reason, size_t size) {
    const slv_lookup *l = &query->lookup;
    const slv_ptx_info *info = &texture->info;
    if (query->face < 0 || query->face >= info->nfaces)
        snprintf(reason, size, "face %lld does not exist, there are %u", (long long)query->face,
                 info->nfaces);
    else if (!query->params.nchannels)
        snprintf(reason, size, "channel %u does not exist, there are %u",
                 query->params.first_channel, info->nchannels);
    else if (!isfinite(l->u) || !isfinite(l->v))
        snprintf(reason, size, "%s is not finite", isfinite(l->u) ? "v" : "u");
    else if (isnan(l->uw1 + l->vw1 + l->uw2 + l->vw2))
        snprintf(reason, size, "the footprint is not a number");
    else
        snprintf(reason, size, "%s",
                 texture->log->message[0] ? texture->log->message : slv_result_string(result));
}

slv_result sample_again(const sample_texture *texture, slv_sampler *sampler,
                        const slv_lookup *lookup, float *out) {
    slv_cache *cache = texture->cache;
    texture->log->mode = SAMPLE_LOG_KEEP;
    texture->log->message[0] = 0;
    /* what failed is told once: the cache must forget it, or all if it is of a neighbour's */
    if (slv_cache_invalidate_face(cache, texture->file, lookup->face, NULL))
        texture->log->message[0] = 0;
    slv_result result = slv_sample(sampler, lookup, out);
    if (result && !texture->log->message[0] && !slv_cache_invalidate(cache, texture->file))
        result = slv_sample(sampler, lookup, out);
    texture->log->mode = SAMPLE_LOG_PRINT;
    return result;
}

/* By parameters, then by face, so that texels are at hand; the text's own order breaks ties. */
static int compare_queries(const void *a, const void *b) {
    const sample_query *x = *(sample_query *const *)a, *y = *(sample_query *const *)b;
    int order = sample_compare_params(&x->params, &y->params);
    if (order == 0 && x->lookup.face != y->lookup.face)
        order = x->lookup.face < y->lookup.face ? -1 : 1;
    return order ? order : (x > y) - (x < y);
}

static slv_sampler *find_sampler(worker *w, const slv_filter_params *params) {
    for (uint32_t i = 0; i < SAMPLERS; i++)
        if (w->samplers[i].sampler && sample_compare_params(&w->samplers[i].params, params) == 0)
            return w->samplers[i].sampler;
    uint32_t slot = w->next_sampler++ % SAMPLERS;
    slv_sampler_destroy(w->samplers[slot].sampler);
    w->samplers[slot].params = *params;
    if (slv_sampler_create(w->job->texture->cache, params, &w->samplers[slot].sampler))
        w->no_memory = true;
    return w->samplers[slot].sampler;
}

static bool same_params(const sample_query *a, const sample_query *b) {
    return sample_compare_params(&a->params, &b->params) == 0;
}

static void look_up(worker *w, size_t count) {
    job *j = w->job;
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first; end < count && same_params(w->order[first], w->order[end]); end++)
            w->lookups[end - first] = w->order[end]->lookup;
        const slv_filter_params *params = &w->order[first]->params;
        slv_sampler *sampler = find_sampler(w, params);
        if (!sampler)
            return;
        slv_result failed =
            slv_sample_batch(sampler, w->lookups, end - first, w->rows, j->stride, w->results);
        (void)failed; /* each has a result of its own */
        for (size_t i = first; i < end; i++) {
            size_t at = (size_t)(w->order[i] - j->queries);
            j->results[at] = w->results[i - first];
            memcpy(j->values + at * j->stride, w->rows + (i - first) * j->stride,
                   params->nchannels * sizeof *j->values);
        }
    }
}

static void print_answer(const job *j, size_t at, FILE *stream) {
    const sample_query *query = &j->queries[at];
    const float *values = j->values + at * j->stride;
    if (!j->options->json) {
        fwrite(query->text, 1, query->length, stream);
        fputs(" ->", stream);
        for (uint32_t c = 0; c < query->params.nchannels; c++)
            fprintf(stream, " %.9g", (double)values[c]);
        fputc('\n', stream);
        return;
    }
    fprintf(stream, ",\n    {\"line\": %llu, \"values\": [", (unsigned long long)query->line);
    for (uint32_t c = 0; c < query->params.nchannels; c++) {
        if (isfinite(values[c]))
            fprintf(stream, "%s%.9g", c ? ", " : "", (double)values[c]);
        else
            fprintf(stream, "%snull", c ? ", " : "");
    }
    fputs("]}", stream);
}

static void print_json_text(const char *words, FILE *stream) {
    json_t *text = output_json_text(words, strlen(words));
    if (!text || json_dumpf(text, stream, JSON_ENCODE_ANY) != 0)
        fputs("null", stream);
    json_decref(text);
}

static void print_failure(const job *j, size_t at, const char *reason, FILE *stream) {
    const sample_query *query = &j->queries[at];
    if (!j->options->json) {
        fwrite(query->text, 1, query->length, stream);
        fputs(" -> error: ", stream);
        output_terminal(stream, reason, strlen(reason), SIZE_MAX);
        fputc('\n', stream);
        return;
    }
    fprintf(stream, ",\n    {\"line\": %llu, \"error\": ", (unsigned long long)query->line);
    print_json_text(reason, stream);
    fputc('}', stream);
}

/* Answers of a block without a failure are put into words here, by the thread. */
static void do_block(worker *w, block *b) {
    job *j = w->job;
    size_t count = 0;
    for (size_t i = b->first; i < b->end; i++) {
        sample_query *query = &j->queries[i];
        if (!sample_parse(j->texture, query, b->problem, sizeof b->problem)) {
            b->malformed = true;
            b->end = i;
            break;
        }
        j->results[i] = SLV_ERROR_ARGUMENT;
        if (sample_is_there(j->texture, query))
            w->order[count++] = query;
    }
    qsort(w->order, count, sizeof(sample_query *), compare_queries);
    look_up(w, count);
    for (size_t i = b->first; i < b->end; i++)
        b->failed += j->results[i] != SLV_OK;
    if (b->failed || w->no_memory)
        return;
    FILE *stream = open_memstream(&b->text, &b->size);
    for (size_t i = b->first; stream && i < b->end; i++)
        print_answer(j, i, stream);
    bool failed = !stream || ferror(stream) != 0;
    if (stream)
        failed |= fclose(stream) != 0;
    w->no_memory |= failed;
}

static void *work(void *user) {
    worker *w = user;
    for (;;) {
        size_t next = atomic_fetch_add(&w->job->next_block, 1);
        if (next >= w->job->nblocks || w->no_memory)
            return NULL;
        do_block(w, &w->job->blocks[next]);
    }
}

/* False if memory ran out. */
static bool do_chunk(job *j) {
    pthread_t threads[256];
    uint32_t started = 0;
    j->nblocks = 0;
    for (size_t first = 0; first < j->count; first += j->block_lines) {
        size_t left = j->count - first;
        j->blocks[j->nblocks++] =
            (block){.first = first, .end = first + (left < j->block_lines ? left : j->block_lines)};
    }
    atomic_store(&j->next_block, 0);
    j->texture->log->mode = SAMPLE_LOG_DROP;
    while (started + 1 < j->nworkers && started + 1 < j->nblocks &&
           pthread_create(&threads[started], NULL, work, &j->workers[started + 1]) == 0)
        started++;
    work(&j->workers[0]);
    while (started)
        pthread_join(threads[--started], NULL);
    j->texture->log->mode = SAMPLE_LOG_PRINT;
    bool good = true;
    for (uint32_t i = 0; i < j->nworkers; i++)
        good &= !j->workers[i].no_memory;
    return good;
}

/* A block with failures: what could not be read is read again, by itself, to learn why. */
static bool print_block(job *j, const block *b, const sample_reader *reader, FILE *stream,
                        uint64_t *failed) {
    char reason[640];
    for (size_t i = b->first; i < b->end; i++) {
        const sample_query *query = &j->queries[i];
        j->texture->log->message[0] = 0;
        if (j->results[i] != SLV_OK && j->results[i] != SLV_ERROR_ARGUMENT) {
            slv_sampler *sampler = find_sampler(&j->workers[0], &query->params);
            if (!sampler)
                return false;
            j->results[i] =
                sample_again(j->texture, sampler, &query->lookup, j->values + i * j->stride);
        }
        if (!j->results[i]) {
            print_answer(j, i, stream);
            continue;
        }
        sample_reason(j->texture, query, j->results[i], reason, sizeof reason);
        print_failure(j, i, reason, stream);
        sample_complain(reader, query->line, reason, failed);
    }
    return true;
}

/* Chunks of at most `max` lines, a multiple of the blocks. */
static bool job_begin_with(job *j, const sample_options *options, sample_texture *texture,
                           size_t max) {
    size_t channels = texture->info.nchannels;
    *j = (job){.options = options, .texture = texture, .stride = channels, .max = max};
    j->block_lines = j->max / BLOCKS;
    j->queries = calloc(j->max, sizeof *j->queries);
    j->values = calloc(j->max * channels, sizeof *j->values);
    j->results = calloc(j->max, sizeof *j->results);
    j->nworkers = sample_threads(options);
    j->workers = calloc(j->nworkers, sizeof *j->workers);
    bool good = j->queries && j->values && j->results && j->workers;
    for (uint32_t i = 0; good && i < j->nworkers; i++) {
        worker *w = &j->workers[i];
        w->job = j;
        w->order = calloc(j->block_lines, sizeof(sample_query *));
        w->lookups = calloc(j->block_lines, sizeof *w->lookups);
        w->results = calloc(j->block_lines, sizeof *w->results);
        w->rows = calloc(j->block_lines * channels, sizeof *w->rows);
        good = w->order && w->lookups && w->results && w->rows;
    }
    return good;
}

static void job_end(job *j) {
    for (uint32_t i = 0; j->workers && i < j->nworkers; i++) {
        worker *w = &j->workers[i];
        for (uint32_t k = 0; k < SAMPLERS; k++)
            slv_sampler_destroy(w->samplers[k].sampler);
        free(w->order);
        free(w->lookups);
        free(w->results);
        free(w->rows);
    }
    free(j->workers);
    free(j->queries);
    free(j->values);
    free(j->results);
}

/* Where memory is short, fewer lines at a time give the same answers. */
static bool job_begin(job *j, const sample_options *options, sample_texture *texture) {
    size_t lines = CHUNK_VALUES / texture->info.nchannels / BLOCKS;
    if (lines > CHUNK_LINES / BLOCKS)
        lines = CHUNK_LINES / BLOCKS;
    for (lines = lines ? lines : 1; !job_begin_with(j, options, texture, lines * BLOCKS);
         lines /= 2) {
        if (lines == 1)
            return false;
        job_end(j);
    }
    return true;
}

/* Returns false when nothing more should come: `code` says how the work ended. */
static bool print_chunk(job *j, const sample_reader *reader, FILE *stream, uint64_t *count,
                        uint64_t *failed, int *code) {
    for (size_t i = 0; i < j->nblocks; i++) {
        block *b = &j->blocks[i];
        const char *text = b->text;
        /* each element of the JSON list begins with a comma, which the first one has not */
        bool first = j->options->json && *count == 0 && b->end > b->first;
        if (b->failed) {
            FILE *memory = open_memstream(&b->text, &b->size);
            bool good = memory && print_block(j, b, reader, memory, failed);
            if ((memory && fclose(memory) != 0) || !good) {
                *code = cli_error("%s: no memory for the answers", reader->name);
                return false;
            }
            text = b->text;
        }
        if (b->size)
            fwrite(text + first, 1, b->size - first, stream);
        *count += b->end - b->first;
        if (b->malformed) {
            *code = cli_error("%s:%llu: %s", reader->name,
                              (unsigned long long)j->queries[b->end].line, b->problem);
            return false;
        }
    }
    if (stream == stdout)
        *code = cli_answered(EXIT_OK);
    else if (fflush(stream) != 0)
        *code = cli_error("cannot write the answer: %s", strerror(errno));
    return !*code;
}

int sample_run(const sample_options *options, sample_texture *texture, sample_reader *reader,
               FILE *stream, uint64_t *failed) {
    job j;
    int code = EXIT_OK;
    uint64_t count = 0;
    bool to_terminal = !options->out && isatty(STDOUT_FILENO) == 1;
    cli_progress progress = cli_progress_fleeting("sample", options->progress,
                                                  options->quiet || to_terminal || !reader->size);
    if (!job_begin(&j, options, texture)) {
        code = cli_error("%s: no memory for its lookups", reader->name);
        goto done;
    }
    if (options->json) {
        fputs("{\n  \"schema\": 1,\n  \"path\": ", stream);
        print_json_text(cli_shown(texture->path), stream);
        fprintf(stream, ",\n  \"faces\": %u,\n  \"channels\": %u,\n  \"lookups\": [",
                texture->info.nfaces, texture->info.nchannels);
    }
    for (bool more = true; more && !code;) {
        code = sample_read(reader, j.queries, j.max, &j.count);
        if (code || !j.count)
            break;
        if (do_chunk(&j))
            more = print_chunk(&j, reader, stream, &count, failed, &code);
        else
            code = cli_error("%s: no memory for the answers", reader->name);
        for (size_t i = 0; i < j.nblocks; i++)
            free(j.blocks[i].text);
        if (reader->size)
            cli_progress_report(&progress, reader->taken, reader->size);
    }
    if (options->json)
        fprintf(stream, "%s],\n  \"count\": %llu,\n  \"failed\": %llu,\n  \"complete\": %s\n}\n",
                count ? "\n  " : "", (unsigned long long)count, (unsigned long long)*failed,
                code ? "false" : "true");
done:
    cli_progress_end(&progress);
    job_end(&j);
    return code;
}
