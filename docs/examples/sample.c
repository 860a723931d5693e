/* Filtered lookups from several threads.
 *
 *   cc sample.c $(pkg-config --cflags --libs selvage) -pthread -o sample
 *   ./sample teapot.ptx
 *
 * Prints the mean of all faces, found in three ways that give the same numbers. */
#include <selvage/filter.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

enum { THREADS = 2, BATCH = 256 };

typedef enum way { ONE_BY_ONE, BATCHED, SORTED, WAYS } way;

/* The faces first, first + THREADS, ... belong to one thread. */
typedef struct task {
    slv_cache *cache;
    slv_file_id file;
    uint32_t first, nfaces, nchannels;
    way way;
    double sum; /* of the first channel */
    slv_result result;
} task;

static void *render(void *user) {
    task *t = user;
    slv_filter_params params = {.filter = SLV_FILTER_BOX};
    slv_sampler *sampler = NULL; /* for one thread: each makes its own, and keeps it */
    slv_lookup lookups[BATCH];
    float *out = calloc(BATCH, t->nchannels * sizeof *out);
    void *workspace = malloc(slv_sample_workspace(BATCH));
    t->result =
        out && workspace ? slv_sampler_create(t->cache, &params, &sampler) : SLV_ERROR_MEMORY;
    for (uint32_t face = t->first; face < t->nfaces && !t->result;) {
        size_t count = 0;
        /* the footprint is the whole face, so that the box filter gives its mean */
        for (; count < BATCH && face < t->nfaces; face += THREADS)
            lookups[count++] = (slv_lookup){
                .file = t->file, .face = face, .u = 0.5f, .v = 0.5f, .uw1 = 1, .vw2 = 1};
        if (t->way == ONE_BY_ONE)
            for (size_t i = 0; i < count && !t->result; i++)
                t->result = slv_sample(sampler, &lookups[i], out + i * t->nchannels);
        else if (t->way == BATCHED)
            t->result = slv_sample_batch(sampler, lookups, count, out, t->nchannels, NULL);
        else
            t->result =
                slv_sample_sorted(sampler, lookups, count, out, t->nchannels, NULL, workspace);
        for (size_t i = 0; i < count; i++)
            t->sum += (double)out[i * t->nchannels];
    }
    slv_sampler_destroy(sampler);
    free(workspace);
    free(out);
    return NULL;
}

static void print_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "%s\n", message);
}

int main(int argc, char **argv) {
    static const char *const names[WAYS] = {"one by one", "batched", "sorted"};
    slv_env env = {.log = print_log};
    slv_cache_params params = {.max_bytes = UINT64_C(64) << 20};
    slv_cache *cache = NULL; /* one for the whole renderer, however many files and threads */
    slv_ptx_info info;
    slv_file_id file;
    slv_cache_stats stats;
    slv_result result = SLV_ERROR_ARGUMENT;
    if (argc != 2 || slv_cache_create(&env, &params, &cache) ||
        slv_cache_open(cache, argv[1], &file) || slv_cache_get_info(cache, file, &info))
        goto done;
    result = SLV_OK;
    for (int w = 0; w < WAYS && !result; w++) {
        pthread_t threads[THREADS];
        task tasks[THREADS];
        bool started[THREADS];
        double sum = 0;
        for (uint32_t i = 0; i < THREADS; i++) {
            tasks[i] = (task){cache, file, i, info.nfaces, info.nchannels, (way)w, 0, SLV_OK};
            started[i] = pthread_create(&threads[i], NULL, render, &tasks[i]) == 0;
            if (!started[i])
                render(&tasks[i]);
        }
        for (uint32_t i = 0; i < THREADS; i++) {
            if (started[i])
                pthread_join(threads[i], NULL);
            sum += tasks[i].sum;
            result = result ? result : tasks[i].result;
        }
        if (!result)
            printf("%-10s  %.6f\n", names[w], sum / info.nfaces);
    }
    slv_cache_get_stats(cache, &stats);
    if (!result)
        printf("%u faces, %llu lookups, %llu bytes read\n", info.nfaces,
               (unsigned long long)stats.lookups, (unsigned long long)stats.bytes_read);
done:
    slv_cache_destroy(cache);
    return result != SLV_OK;
}
