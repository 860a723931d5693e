/* Reads what the options of convert say about channels and sizes, which depends on the source. */
#include "convert/convert_options.h"

#include "command/lists.h"
#include "command/numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static value_channels channels_of(const convert_request *request) {
    return (value_channels){request->source->nchannels, request->source->alpha_channel};
}

static int parse_channels(const cli_command *command, const char *text, convert_request *request) {
    value_channel *list = NULL;
    uint32_t count;
    int code =
        value_channel_list(command, "--channels", text, channels_of(request), true, &list, &count);
    if (!code && !(request->channels = calloc(count, sizeof *request->channels)))
        code = cli_error("no memory for %u channels", count);
    for (uint32_t i = 0; i < count && !code; i++)
        request->channels[i] = (slv_exchange_channel){list[i].source, list[i].value};
    free(list);
    request->params.channels = request->channels;
    request->params.nchannels = count;
    return code;
}

/* A channel of the result: its number, or what the source calls the channel that is there, or else
 * what a file of so many channels calls it. */
static int parse_alpha(const cli_command *command, const char *text, convert_request *request) {
    char *end;
    uint32_t have = request->channels ? request->params.nchannels : request->source->nchannels;
    bool number = *text >= '0' && *text <= '9';
    request->params.changes |= SLV_EXCHANGE_ALPHA;
    request->params.alpha_channel = SLV_NO_ALPHA;
    if (strcmp(text, "none") == 0)
        return EXIT_OK;
    unsigned long index = number ? strtoul(text, &end, 10) : have;
    int32_t named = number ? -1 : value_channel_find(text, strlen(text), channels_of(request));
    for (uint32_t i = have; i-- > 0 && named >= 0;)
        if ((request->channels ? request->channels[i].source : (int32_t)i) == named)
            index = i;
    if (!number && index == have) {
        named = value_channel_find(text, strlen(text), (value_channels){have, SLV_NO_ALPHA});
        index = named < 0 ? have : (unsigned long)named;
    }
    if ((number && *end) || index >= have)
        return cli_usage(command,
                         "--alpha: '%s' is neither none nor a channel of the result, 0 to %u", text,
                         have - 1);
    request->params.alpha_channel = (int32_t)index;
    return EXIT_OK;
}

static int parse_scale(const cli_command *command, const char *text, convert_request *request) {
    const char *end;
    double scale;
    int exponent;
    if (!value_ratio(text, &scale, &end) || *end || !(scale > 0) ||
        frexp(scale, &exponent) != 0.5 || abs(exponent - 1) > SLV_MAX_LOG2_RES)
        return cli_usage(command, "--scale: '%s' is not a power of two such as 2, 0.5 or 1/8",
                         text);
    request->params.scale_log2 = exponent - 1;
    return EXIT_OK;
}

static int parse_bound(const cli_command *command, const char *name, const uint32_t size[2],
                       slv_res *out) {
    int8_t sides[2];
    for (int i = 0; i < 2; i++) {
        int log2 = slv_res_log2(size[i]);
        if (log2 < 0)
            return cli_usage(command, "%s: %u is not a power of two up to %u", name, size[i],
                             1u << SLV_MAX_LOG2_RES);
        sides[i] = (int8_t)log2;
    }
    *out = (slv_res){sides[0], sides[1]};
    return EXIT_OK;
}

static int compare_faces(const void *left, const void *right) {
    const slv_exchange_face_res *a = left, *b = right;
    return (a->face > b->face) - (a->face < b->face);
}

/* One item of --res, FACE=WxH or FIRST-LAST=W. */
typedef struct res_item {
    uint64_t first, last;
    slv_res res;
} res_item;

static int parse_res_item(const cli_command *command, const char **at, const convert_request *r,
                          res_item *out) {
    const char *text = *at;
    char *end;
    if (!value_range_read(at, &out->first, &out->last) || **at != '=' ||
        out->last >= r->source->nfaces)
        return cli_usage(command, "--res: '%s': expected FACE=WxH with faces 0 to %u", text,
                         r->source->nfaces - 1);
    int u = slv_res_log2(strtoull(*at + 1, &end, 10)), v = u;
    if (*end == 'x')
        v = slv_res_log2(strtoull(end + 1, &end, 10));
    if (u < 0 || v < 0 || (*end && *end != ','))
        return cli_usage(command, "--res: '%s': sizes are powers of two up to %u", text,
                         1u << SLV_MAX_LOG2_RES);
    if (r->source->mesh_type == SLV_PTX_TRIANGLE && u != v)
        return cli_usage(command, "--res: face %llu is a triangle, which is square",
                         (unsigned long long)out->first);
    out->res = (slv_res){(int8_t)u, (int8_t)v};
    *at = end + (*end == ',');
    return EXIT_OK;
}

/* FACE=WxH,FIRST-LAST=W,...: counted first, then written down. */
static int parse_res(const cli_command *command, const char *text, convert_request *request) {
    uint64_t count = 0;
    res_item item;
    for (const char *at = text; !count || *at; count += item.last - item.first + 1) {
        int code = parse_res_item(command, &at, request, &item);
        if (code)
            return code;
        if (count > request->source->nfaces)
            return cli_usage(command, "--res: '%s': there are faces twice", text);
    }
    slv_exchange_face_res *list = request->face_res = calloc((size_t)count, sizeof *list);
    if (!list)
        return cli_error("no memory for %llu sizes", (unsigned long long)count);
    uint32_t n = 0;
    for (const char *at = text; n < count;) {
        parse_res_item(command, &at, request, &item);
        for (uint64_t face = item.first; face <= item.last; face++)
            list[n++] = (slv_exchange_face_res){(uint32_t)face, item.res};
    }
    qsort(list, n, sizeof *list, compare_faces);
    for (uint32_t i = 1; i < n; i++)
        if (list[i].face == list[i - 1].face)
            return cli_usage(command, "--res: face %u is there twice", list[i].face);
    request->params.face_res = list;
    request->params.nface_res = n;
    return EXIT_OK;
}

/* One after the other, which the library sorts. */
static int parse_faces(const cli_command *command, const char *text, convert_request *request) {
    value_ranges ranges;
    int code = value_faces(command, "--faces", text, request->source->nfaces, &ranges);
    if (!code && ranges.nfaces > UINT32_MAX)
        code = cli_usage(command, "--faces: '%s' has faces twice", text);
    if (!code && !(request->faces = calloc((size_t)ranges.nfaces + 1, sizeof *request->faces)))
        code = cli_error("no memory for %llu faces", (unsigned long long)ranges.nfaces);
    uint32_t n = 0;
    for (uint32_t i = 0; i < ranges.count && !code; i++)
        for (uint64_t face = ranges.list[i].first; face <= ranges.list[i].last; face++)
            request->faces[n++] = (uint32_t)face;
    free(ranges.list);
    request->params.faces = request->faces;
    request->params.nfaces = n;
    return code;
}

static int choose_sizes(const cli_command *command, const convert_options *options,
                        convert_request *request) {
    slv_res max = {SLV_MAX_LOG2_RES, SLV_MAX_LOG2_RES}, min = {0, 0};
    int code = EXIT_OK;
    if (options->scale)
        code = parse_scale(command, options->scale, request);
    if (!code && options->max_given)
        code = parse_bound(command, "--max", options->max, &max);
    if (!code && options->min_given)
        code = parse_bound(command, "--min", options->min, &min);
    if (!code && (min.u > max.u || min.v > max.v))
        code = cli_usage(command, "--min is larger than --max");
    if (!code && request->source->mesh_type == SLV_PTX_TRIANGLE &&
        (min.u != min.v || max.u != max.v))
        code = cli_usage(command, "--min and --max of triangles are square");
    request->params.changes |= SLV_EXCHANGE_MAX_RES;
    request->params.max_res = max;
    request->params.min_res = min;
    return !code && options->res ? parse_res(command, options->res, request) : code;
}

/* What an option changes, if it was given. */
static unsigned change(bool given, unsigned what) {
    return given ? what : 0;
}

int convert_request_make(const cli_command *command, const convert_options *o,
                         const slv_ptx_writer_params *source, convert_request *out) {
    *out = (convert_request){.source = source};
    slv_exchange_params *params = &out->params;
    int code = o->channels ? parse_channels(command, o->channels, out) : EXIT_OK;
    if (!code && o->alpha)
        code = parse_alpha(command, o->alpha, out);
    if (!code && o->faces)
        code = parse_faces(command, o->faces, out);
    if (code || (code = choose_sizes(command, o, out)))
        return code;
    if ((o->premultiply || o->unmultiply) && source->alpha_channel < 0)
        return cli_error("--%smultiply: the file has no alpha channel",
                         o->premultiply ? "pre" : "un");
    params->changes |= change(o->type_given, SLV_EXCHANGE_TYPE) |
                       change(o->border_given || o->border_u_given, SLV_EXCHANGE_BORDER_U) |
                       change(o->border_given || o->border_v_given, SLV_EXCHANGE_BORDER_V) |
                       change(o->edge_filter_given, SLV_EXCHANGE_EDGE_FILTER) |
                       change(o->reductions_given || o->no_reductions, SLV_EXCHANGE_REDUCTIONS);
    params->type = (slv_type)o->type;
    params->border_u = (slv_border_mode)(o->border_u_given ? o->border_u : o->border);
    params->border_v = (slv_border_mode)(o->border_v_given ? o->border_v : o->border);
    params->edge_filter = (slv_edge_filter)o->edge_filter;
    params->no_reductions = o->no_reductions;
    params->seams = (slv_ptx_seams)o->reductions;
    params->premultiply = o->premultiply;
    params->unmultiply = o->unmultiply;
    params->no_meta = o->no_meta;
    params->compression = (int)o->compression;
    params->encoding = (slv_texture_encoding)o->encoding;
    if (o->format_given)
        params->images = o->format == 1 ? SLV_EXCHANGE_EXR : SLV_EXCHANGE_PNG;
    return EXIT_OK;
}

void convert_request_free(convert_request *request) {
    free(request->channels);
    free(request->face_res);
    free(request->faces);
}
