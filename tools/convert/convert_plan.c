#include "convert/convert.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int convert_word(const char *words, const char *word) {
    size_t length = strlen(word);
    for (int index = 0; *words; index++) {
        size_t here = strcspn(words, "|");
        if (here == length && strncmp(words, word, length) == 0)
            return index;
        words += here + (words[here] == '|');
    }
    return -1;
}

const char *convert_border_name(slv_border_mode mode) {
    return mode == SLV_BORDER_CLAMP ? "clamp" : mode == SLV_BORDER_BLACK ? "black" : "periodic";
}

const char *convert_filter_name(slv_edge_filter filter) {
    return filter == SLV_EDGE_FILTER_TANVEC ? "tanvec" : "none";
}

const char *convert_meta_name(slv_meta_type type) {
    static const char *const names[] = {"string", "int8", "int16", "int32", "float", "double"};
    return names[type];
}

/* The log2 of a power of two up to the format's limit, or -1. */
static int log2_of(unsigned long long size) {
    for (int log2 = 0; log2 <= SLV_MAX_LOG2_RES; log2++)
        if (size == 1ull << log2)
            return log2;
    return -1;
}

static int parse_channels(const cli_command *command, const char *text, convert_plan *plan) {
    uint32_t count = 1, have = plan->source.nchannels;
    for (const char *at = text; *at; at++)
        count += *at == ',';
    if (count > 65535)
        return cli_usage(command, "--channels: more than 65535");
    plan->channels = calloc(count, sizeof *plan->channels);
    if (!plan->channels)
        return cli_error("no memory for %u channels", count);
    plan->target.nchannels = count;
    plan->same_channels = count == have;
    for (uint32_t i = 0; i < count; i++) {
        bool value = *text == '=';
        char *end;
        convert_channel *channel = &plan->channels[i];
        if (value) {
            channel->source = -1;
            channel->value = strtof(text + 1, &end);
        } else {
            unsigned long index = strtoul(text, &end, 10);
            if (*text < '0' || *text > '9' || index >= have)
                return cli_usage(command, "--channels: '%s': the file has channels 0 to %u", text,
                                 have - 1);
            channel->source = (int32_t)index;
        }
        if (end == text + value || (*end && *end != ',') || !isfinite(channel->value))
            return cli_usage(command, "--channels: cannot read '%s'", text);
        plan->same_channels &= channel->source == (int32_t)i;
        text = end + (*end == ',');
    }
    return EXIT_OK;
}

static int choose_channels(const cli_command *command, const convert_options *options,
                           convert_plan *plan) {
    if (options->channels)
        return parse_channels(command, options->channels, plan);
    plan->channels = calloc(plan->source.nchannels, sizeof *plan->channels);
    if (!plan->channels)
        return cli_error("no memory for %u channels", plan->source.nchannels);
    for (uint32_t i = 0; i < plan->source.nchannels; i++)
        plan->channels[i].source = (int32_t)i;
    plan->same_channels = true;
    return EXIT_OK;
}

/* Alpha goes where its channel went, if it is still there. */
static int choose_alpha(const cli_command *command, const convert_options *options,
                        convert_plan *plan) {
    char *end;
    plan->target.alpha_channel = SLV_NO_ALPHA;
    if (!options->alpha) {
        for (uint32_t i = plan->target.nchannels; plan->source.alpha_channel >= 0 && i-- > 0;)
            if (plan->channels[i].source == plan->source.alpha_channel)
                plan->target.alpha_channel = (int32_t)i;
        return EXIT_OK;
    }
    if (strcmp(options->alpha, "none") == 0)
        return EXIT_OK;
    unsigned long index = strtoul(options->alpha, &end, 10);
    if (*options->alpha < '0' || *options->alpha > '9' || *end || index >= plan->target.nchannels)
        return cli_usage(command, "--alpha: '%s' is neither none nor a channel from 0 to %u",
                         options->alpha, plan->target.nchannels - 1);
    plan->target.alpha_channel = (int32_t)index;
    return EXIT_OK;
}

static int parse_scale(const cli_command *command, const char *text, convert_plan *plan) {
    char *end;
    bool smaller = strncmp(text, "1/", 2) == 0;
    const char *number = text + (smaller ? 2 : 0);
    int log2 = log2_of(strtoull(number, &end, 10));
    if (*number < '0' || *number > '9' || *end || log2 < 0)
        return cli_usage(command, "--scale: '%s' is not a power of two such as 2, 1/2 or 1/8",
                         text);
    plan->shift = smaller ? -log2 : log2;
    return EXIT_OK;
}

static int parse_bound(const cli_command *command, const char *name, const uint32_t size[2],
                       int8_t out[2]) {
    for (int i = 0; i < 2; i++) {
        int log2 = log2_of(size[i]);
        if (log2 < 0)
            return cli_usage(command, "%s: %u is not a power of two up to %u", name, size[i],
                             1u << SLV_MAX_LOG2_RES);
        out[i] = (int8_t)log2;
    }
    return EXIT_OK;
}

static int compare_faces(const void *left, const void *right) {
    const convert_face_res *a = left, *b = right;
    return (a->face > b->face) - (a->face < b->face);
}

/* FACE=WxH,FACE=W,... */
static int parse_res(const cli_command *command, const char *text, convert_plan *plan) {
    uint32_t count = 1;
    for (const char *at = text; *at; at++)
        count += *at == ',';
    plan->face_res = calloc(count, sizeof *plan->face_res);
    if (!plan->face_res)
        return cli_error("no memory for %u sizes", count);
    for (uint32_t i = 0; i < count; i++) {
        char *end;
        unsigned long face = strtoul(text, &end, 10);
        if (*text < '0' || *text > '9' || *end != '=' || face >= plan->source.nfaces)
            return cli_usage(command, "--res: '%s': expected FACE=WxH with faces 0 to %u", text,
                             plan->source.nfaces - 1);
        int u = log2_of(strtoull(end + 1, &end, 10)), v = u;
        if (*end == 'x')
            v = log2_of(strtoull(end + 1, &end, 10));
        if (u < 0 || v < 0 || (*end && *end != ','))
            return cli_usage(command, "--res: '%s': sizes are powers of two up to %u", text,
                             1u << SLV_MAX_LOG2_RES);
        if (plan->source.mesh_type == SLV_PTX_TRIANGLE && u != v)
            return cli_usage(command, "--res: face %lu is a triangle, which is square", face);
        plan->face_res[i] = (convert_face_res){(uint32_t)face, {(int8_t)u, (int8_t)v}};
        text = end + (*end == ',');
    }
    qsort(plan->face_res, count, sizeof *plan->face_res, compare_faces);
    plan->nface_res = count;
    for (uint32_t i = 1; i < count; i++)
        if (plan->face_res[i].face == plan->face_res[i - 1].face)
            return cli_usage(command, "--res: face %u is there twice", plan->face_res[i].face);
    return EXIT_OK;
}

static int choose_sizes(const cli_command *command, const convert_options *options,
                        convert_plan *plan) {
    int code = EXIT_OK;
    plan->max[0] = plan->max[1] = SLV_MAX_LOG2_RES;
    if (options->scale)
        code = parse_scale(command, options->scale, plan);
    if (!code && options->max_given)
        code = parse_bound(command, "--max", options->max, plan->max);
    if (!code && options->min_given)
        code = parse_bound(command, "--min", options->min, plan->min);
    if (!code && (plan->min[0] > plan->max[0] || plan->min[1] > plan->max[1]))
        code = cli_usage(command, "--min is larger than --max");
    if (!code && plan->source.mesh_type == SLV_PTX_TRIANGLE &&
        (plan->min[0] != plan->min[1] || plan->max[0] != plan->max[1]))
        code = cli_usage(command, "--min and --max of triangles are square");
    return !code && options->res ? parse_res(command, options->res, plan) : code;
}

int convert_plan_make(const cli_command *command, const convert_options *options, const char *path,
                      const slv_ptx_writer_params *source, convert_totals *totals,
                      convert_plan *plan) {
    *plan = (convert_plan){.path = path,
                           .source = *source,
                           .target = *source,
                           .totals = totals,
                           .premultiply = options->premultiply,
                           .unmultiply = options->unmultiply};
    int code = choose_channels(command, options, plan);
    if (code || (code = choose_alpha(command, options, plan)) ||
        (code = choose_sizes(command, options, plan)))
        return code;
    if ((plan->premultiply || plan->unmultiply) && source->alpha_channel < 0)
        return cli_error("--%smultiply: the file has no alpha channel",
                         plan->premultiply ? "pre" : "un");
    if (options->type_given)
        plan->target.type = (slv_type)options->type;
    if (options->border_given)
        plan->target.border_u = plan->target.border_v = (slv_border_mode)options->border;
    if (options->border_u_given)
        plan->target.border_u = (slv_border_mode)options->border_u;
    if (options->border_v_given)
        plan->target.border_v = (slv_border_mode)options->border_v;
    if (options->edge_filter_given)
        plan->target.edge_filter = (slv_edge_filter)options->edge_filter;
    if (options->reductions || options->no_reductions)
        plan->target.no_reductions = options->no_reductions;
    plan->target.compression = (int)options->compression;
    return EXIT_OK;
}

void convert_plan_free(convert_plan *plan) {
    free(plan->channels);
    free(plan->face_res);
}

static int8_t resize_side(const convert_plan *plan, int axis, int8_t log2) {
    int side = log2 + plan->shift;
    side = side < plan->min[axis] ? plan->min[axis] : side;
    return (int8_t)(side > plan->max[axis] ? plan->max[axis] : side);
}

slv_res convert_plan_res(const convert_plan *plan, uint32_t face, slv_res res) {
    convert_face_res key = {face, res};
    const convert_face_res *own =
        plan->nface_res ? bsearch(&key, plan->face_res, plan->nface_res, sizeof key, compare_faces)
                        : NULL;
    if (own)
        return own->res;
    return (slv_res){resize_side(plan, 0, res.u), resize_side(plan, 1, res.v)};
}
