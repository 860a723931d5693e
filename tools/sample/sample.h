/* Lookups by the line: what the files of `selvage sample` share. */
#ifndef SELVAGE_TOOLS_SAMPLE_H
#define SELVAGE_TOOLS_SAMPLE_H

#include "command/output.h"

typedef struct sample_options {
    const char *queries, *out;
    bool json, premultiply, bench, progress, quiet;
    int encoding; /* slv_texture_encoding; as they stand unless something else is asked for: these
                     are numbers, and no picture */
    uint32_t cache_mib, threads;
} sample_options;

/* The library's words go to stderr, nowhere while lookups run on many threads, or into `message`
 * while a failed one is repeated. */
typedef struct sample_log {
    enum { SAMPLE_LOG_PRINT, SAMPLE_LOG_DROP, SAMPLE_LOG_KEEP } mode;
    char message[512];
} sample_log;

/* The file that is looked up in. */
typedef struct sample_texture {
    const char *path;
    slv_cache *cache;
    slv_file_id file;
    slv_ptx_info info;
    sample_log *log;
} sample_texture;

typedef struct sample_query {
    slv_lookup lookup;
    slv_filter_params params; /* only what matters; the channels are there, or none is */
    int64_t face;             /* as given */
    uint64_t line;
    const char *text; /* up to the arrow, nothing blank at its end */
    uint32_t length;
} sample_query;

/* A text in pieces. */
typedef struct sample_reader {
    const char *name;
    int descriptor;
    char *buffer;
    char *unpacked;    /* in place of these, all of a file that gzip packed */
    size_t start, end; /* of what is in the buffer and not yet given out */
    bool ended;
    uint64_t line, taken, size; /* bytes; the size is 0 if unknown */
} sample_reader;

int sample_reader_open(const char *path, sample_reader *out);
void sample_reader_close(sample_reader *reader);
/* Up to `max` lines that are no comments, `text`, `length` and `line` set; valid until the next
 * call. None, and code 0, means that there are no more. */
int sample_read(sample_reader *reader, sample_query *queries, size_t max, size_t *count);
/* Fills in the rest. False if the line is malformed; `problem` says how. */
bool sample_parse(const sample_texture *texture, sample_query *query, char *problem, size_t size);
/* By parameters alone; negative, 0 or positive. */
int sample_compare_params(const slv_filter_params *a, const slv_filter_params *b);

/* Whether the library can be asked at all. */
bool sample_is_there(const sample_texture *texture, const sample_query *query);
/* Why a lookup failed. */
void sample_reason(const sample_texture *texture, const sample_query *query, slv_result result,
                   char *reason, size_t size);

/* Does a failed lookup again, so that the log's message says why. */
slv_result sample_again(const sample_texture *texture, slv_sampler *sampler,
                        const slv_lookup *lookup, float *out);

/* All lookups of the reader, to the stream. `failed` counts those that failed. Returns
 * EXIT_FAILED only for what ends the work. */
int sample_run(const sample_options *options, sample_texture *texture, sample_reader *reader,
               FILE *stream, uint64_t *failed);
int sample_bench(const sample_options *options, sample_texture *texture, sample_reader *reader,
                 FILE *stream, uint64_t *failed);
/* One line for a failed lookup, as long as there are few of them. */
enum { SAMPLE_COMPLAINTS = 20 };
void sample_complain(const sample_reader *reader, uint64_t line, const char *reason,
                     uint64_t *failed);

uint32_t sample_threads(const sample_options *options);

#endif
