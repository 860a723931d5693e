/* Filtered lookups against those that were written down: every line of a *.filter.txt, one by one
 * and as batches. */
#include <selvage/filter.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CHANNELS 64

static void print_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "%s\n", message);
}

typedef struct line {
    slv_filter_params params;
    slv_lookup lookup;
    int n;
    float expected[MAX_CHANNELS];
} line;

static bool parse(const char *text, slv_file_id file, line *out) {
    char name[32];
    int lerp, no_blend, at = 0;
    memset(out, 0, sizeof *out);
    slv_filter_params *p = &out->params;
    slv_lookup *l = &out->lookup;
    if (sscanf(text, "%31s %d %f %d %f %f %u %u %u %f %f %f %f %f %f -> %n", name, &lerp,
               &p->sharpness, &no_blend, &p->width, &p->blur, &p->first_channel, &p->nchannels,
               &l->face, &l->u, &l->v, &l->uw1, &l->vw1, &l->uw2, &l->vw2, &at) != 15 ||
        !at || !slv_filter_from_name(name, &p->filter))
        return false;
    p->lerp = lerp != 0;
    p->no_edge_blend = no_blend != 0;
    l->file = file;
    char *end;
    for (text += at; out->n < MAX_CHANNELS; text = end) {
        out->expected[out->n] = strtof(text, &end);
        if (end == text)
            break;
        out->n++;
    }
    return out->n > 0;
}

int main(int argc, char **argv) {
    if (argc < 3) {
        fprintf(stderr, "usage: filter_check FILE.ptx LOOKUPS.txt [--premultiply]\n");
        return 2;
    }
    slv_env env = {.log = print_log};
    slv_cache_params params = {.premultiply = argc > 3 && strcmp(argv[3], "--premultiply") == 0};
    slv_cache *cache = NULL;
    slv_file_id file;
    FILE *in = fopen(argv[2], "r");
    if (!in || slv_cache_create(&env, &params, &cache) || slv_cache_open(cache, argv[1], &file))
        return 1;
    char text[4096];
    long lines = 0, wrong = 0;
    double worst = 0;
    while (fgets(text, sizeof text, in)) {
        line l;
        slv_sampler *sampler;
        float one[MAX_CHANNELS], many[3 * MAX_CHANNELS];
        lines++;
        if (!parse(text, file, &l) || slv_sampler_create(cache, &l.params, &sampler)) {
            fprintf(stderr, "%s:%ld: not understood\n", argv[2], lines);
            return 1;
        }
        slv_lookup lookups[3] = {l.lookup, l.lookup, l.lookup};
        bool bad = slv_sample(sampler, &l.lookup, one) != SLV_OK;
        bad |= slv_sample_batch(sampler, lookups, 3, many, MAX_CHANNELS, NULL) != SLV_OK;
        bad |= slv_sampler_channels(sampler, file) != (uint32_t)l.n;
        for (int c = 0; c < l.n; c++) {
            double limit = 1e-5 * fmax(1, fabs((double)l.expected[c]));
            double error = fabs((double)one[c] - (double)l.expected[c]);
            worst = fmax(worst, error / limit);
            bad |= !(error <= limit);
            for (int i = 0; i < 3; i++)
                bad |= memcmp(&many[i * MAX_CHANNELS + c], &one[c], sizeof one[c]) != 0;
        }
        if (bad && wrong++ < 10) {
            printf("%s:%ld: %s  found", argv[2], lines, text);
            for (int c = 0; c < l.n; c++)
                printf(" %.9g", (double)one[c]);
            printf("\n");
        }
        slv_sampler_destroy(sampler);
    }
    fclose(in);
    slv_cache_destroy(cache);
    printf("%s: %ld lookups, %ld wrong, largest error %.2f of what is allowed\n", argv[2], lines,
           wrong, worst);
    return wrong || !lines;
}
