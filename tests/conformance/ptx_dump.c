/* ptx_dump FILE.ptx [QUESTIONS] [--premultiply]: prints what a reader finds in a .ptx file, one
 * fact a line: header, levels, metakeys, meta, face  what the tables say sum FACE ULOG2 VLOG2 FNV
 * 64-bit FNV-1a of a face's texels at a resolution pix FACE ULOG2 VLOG2 X Y -> values    one texel
 * as floats QUESTIONS is a file of the same form: its face, sum and pix lines say which facts to
 * print, in its order. It is, unless named, FILE.expect.txt or FILE.premult.expect.txt beside the
 * file; where there is none all faces are listed and summed at each stored level. With
 * --premultiply the file is opened so.
 */
#include <selvage/half.h>
#include <selvage/ptx.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void log_line(void *user, slv_log_level level, const char *message) {
    (void)user;
    (void)level;
    fprintf(stderr, "ptx_dump: %s\n", message);
}

static uint64_t fnv(const void *data, size_t size) {
    const uint8_t *bytes = data;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    return hash;
}

static void print_header(const slv_ptx_info *info) {
    static const char *const types[] = {"uint8", "uint16", "float16", "float32"};
    static const char *const borders[] = {"clamp", "black", "periodic"};
    static const char *const filters[] = {"none", "tanvec"};
    printf("header meshtype=%s datatype=%s nchannels=%u alphachan=%d uborder=%s vborder=%s "
           "edgefilter=%s nfaces=%u hasedits=%d hasmipmaps=%d\n",
           info->mesh_type == SLV_PTX_QUAD ? "quad" : "triangle", types[info->type],
           info->nchannels, info->alpha_channel, borders[info->border_u], borders[info->border_v],
           filters[info->edge_filter], info->nfaces, info->has_edits, info->nlevels > 1);
    printf("levels minorversion=%u nlevels=%u nfaces_per_level=", info->minor_version,
           info->nlevels);
    for (uint32_t i = 0; i < info->nlevels; i++)
        printf("%s%u", i ? "," : "", info->level_faces[i]);
    printf("\nmetakeys %u\n", info->nmeta);
}

static void print_value(const slv_ptx_meta *meta, uint32_t i) {
    switch (meta->type) {
    case SLV_META_STRING:
        break;
    case SLV_META_INT8:
        printf(" %d", ((const int8_t *)meta->values)[i]);
        break;
    case SLV_META_INT16:
        printf(" %d", ((const int16_t *)meta->values)[i]);
        break;
    case SLV_META_INT32:
        printf(" %" PRId32, ((const int32_t *)meta->values)[i]);
        break;
    case SLV_META_FLOAT:
        printf(" %.9g", (double)((const float *)meta->values)[i]);
        break;
    case SLV_META_DOUBLE:
        printf(" %.17g", ((const double *)meta->values)[i]);
        break;
    }
}

static void print_meta(const slv_ptx_meta *meta) {
    static const char *const names[] = {"string", "int8", "int16", "int32", "float", "double"};
    static const uint8_t sizes[] = {1, 1, 2, 4, 4, 8};
    printf("meta %s %s %u %016" PRIx64, meta->key, names[meta->type], meta->count,
           fnv(meta->values, (size_t)meta->count * sizes[meta->type]));
    if (meta->type == SLV_META_STRING && meta->count < 200)
        printf(" \"%s\"", (const char *)meta->values);
    for (uint32_t i = 0; i < meta->count && i < 16; i++)
        print_value(meta, i);
    putchar('\n');
}

static slv_result print_face(const slv_ptx *ptx, uint32_t face) {
    slv_ptx_face f;
    slv_result result = slv_ptx_get_face(ptx, face, &f);
    if (!result)
        printf("face %u res %d %d adjfaces %d %d %d %d adjedges %d %d %d %d flags %d\n", face,
               f.res.u, f.res.v, f.adjacency.face[0], f.adjacency.face[1], f.adjacency.face[2],
               f.adjacency.face[3], f.adjacency.edge[0], f.adjacency.edge[1], f.adjacency.edge[2],
               f.adjacency.edge[3], f.flags);
    return result;
}

/* A face's texels at a resolution; kept, because questions about one resolution follow each other.
 */
struct texels {
    uint32_t face;
    slv_res res;
    void *data;
    size_t size;
};

static slv_result fetch(const slv_ptx *ptx, uint32_t face, slv_res res, struct texels *t) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    if (t->data && t->face == face && t->res.u == res.u && t->res.v == res.v)
        return SLV_OK;
    free(t->data);
    t->data = NULL;
    if (res.u < 0 || res.v < 0 || res.u > SLV_MAX_LOG2_RES || res.v > SLV_MAX_LOG2_RES)
        return SLV_ERROR_ARGUMENT;
    t->size = (((size_t)1 << (res.u + res.v)) * info->nchannels) * slv_type_size(info->type);
    t->face = face;
    t->res = res;
    t->data = malloc(t->size);
    return t->data ? slv_ptx_read_face(ptx, face, res, t->data) : SLV_ERROR_MEMORY;
}

static slv_result print_sum(const slv_ptx *ptx, uint32_t face, slv_res res, struct texels *t) {
    slv_result result = fetch(ptx, face, res, t);
    if (!result)
        printf("sum %u %d %d %016" PRIx64 "\n", face, res.u, res.v, fnv(t->data, t->size));
    return result;
}

/* The format's own conversion, which multiplies by a rounded inverse where slv_type_to_float
 * divides. */
static float channel(slv_type type, const void *texels, size_t index) {
    switch (type) {
    case SLV_TYPE_U8:
        return (float)((const uint8_t *)texels)[index] * (1.0f / 255.0f);
    case SLV_TYPE_U16:
        return (float)((const uint16_t *)texels)[index] * (1.0f / 65535.0f);
    case SLV_TYPE_HALF:
        return slv_half_to_float(((const uint16_t *)texels)[index]);
    case SLV_TYPE_FLOAT:
        break;
    }
    return ((const float *)texels)[index];
}

static slv_result print_pixel(const slv_ptx *ptx, uint32_t face, slv_res res, uint32_t x,
                              uint32_t y, struct texels *t) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_result result = fetch(ptx, face, res, t);
    if (result)
        return result;
    if (x >> res.u || y >> res.v)
        return SLV_ERROR_ARGUMENT;
    printf("pix %u %d %d %u %u ->", face, res.u, res.v, x, y);
    size_t first = (((size_t)y << res.u) + x) * info->nchannels;
    for (uint32_t c = 0; c < info->nchannels; c++)
        printf(" %.9g", (double)channel(info->type, t->data, first + c));
    putchar('\n');
    return SLV_OK;
}

static slv_result answer(const slv_ptx *ptx, FILE *questions) {
    struct texels texels = {0};
    char line[4096];
    slv_result result = SLV_OK;
    while (!result && fgets(line, sizeof line, questions)) {
        unsigned face, x, y;
        int u, v;
        if (sscanf(line, "face %u", &face) == 1)
            result = print_face(ptx, face);
        else if (sscanf(line, "sum %u %d %d", &face, &u, &v) == 3)
            result = print_sum(ptx, face, (slv_res){(int8_t)u, (int8_t)v}, &texels);
        else if (sscanf(line, "pix %u %d %d %u %u", &face, &u, &v, &x, &y) == 5)
            result = print_pixel(ptx, face, (slv_res){(int8_t)u, (int8_t)v}, x, y, &texels);
    }
    free(texels.data);
    return result;
}

static slv_result print_all(const slv_ptx *ptx) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    struct texels texels = {0};
    slv_result result = SLV_OK;
    for (uint32_t face = 0; !result && face < info->nfaces; face++)
        result = print_face(ptx, face);
    for (uint32_t face = 0; !result && face < info->nfaces; face++) {
        slv_ptx_face f = {0};
        result = slv_ptx_get_face(ptx, face, &f);
        for (; !result && f.res.u > 0 && f.res.v > 0; f.res.u--, f.res.v--)
            result = print_sum(ptx, face, f.res, &texels);
        if (!result)
            result = print_sum(ptx, face, (slv_res){0, 0}, &texels);
    }
    free(texels.data);
    return result;
}

/* The questions that lie beside a file. */
static FILE *open_questions(const char *name, bool premultiply) {
    char path[4096];
    size_t length = strlen(name);
    if (length < 4 || strcmp(name + length - 4, ".ptx") != 0)
        return NULL;
    int written = snprintf(path, sizeof path, "%.*s%s.expect.txt", (int)length - 4, name,
                           premultiply ? ".premult" : "");
    return written > 0 && (size_t)written < sizeof path ? fopen(path, "r") : NULL;
}

int main(int argc, char **argv) {
    slv_env env = {.log = log_line};
    slv_ptx_open_params params = {0};
    const char *names[2] = {NULL, NULL};
    slv_ptx *ptx = NULL;
    FILE *questions = NULL;
    int nnames = 0;
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--premultiply"))
            params.premultiply = true;
        else if (nnames < 2)
            names[nnames++] = argv[i];
        else
            nnames = 3;
    }
    if (nnames < 1 || nnames > 2) {
        fprintf(stderr, "usage: ptx_dump FILE.ptx [QUESTIONS] [--premultiply]\n");
        return 2;
    }
    if (names[1] && !(questions = fopen(names[1], "r"))) {
        perror(names[1]);
        return 2;
    }
    if (!names[1])
        questions = open_questions(names[0], params.premultiply);
    slv_result result = slv_ptx_open_with(&env, names[0], &params, &ptx);
    if (!result)
        result = slv_ptx_load_tables(ptx);
    if (!result) {
        print_header(slv_ptx_get_info(ptx));
        for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++)
            print_meta(slv_ptx_get_meta(ptx, i));
        result = questions ? answer(ptx, questions) : print_all(ptx);
    }
    slv_ptx_close(ptx);
    if (questions)
        fclose(questions);
    return result ? 1 : 0;
}
