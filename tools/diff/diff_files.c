/* What differs between two files besides their faces. */
#include "diff/diff.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static int note(struct diff *d, const char *format, ...) __attribute__((format(printf, 2, 3)));
static int note(struct diff *d, const char *format, ...) {
    char line[600];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    char **notes = realloc(d->notes, (d->nnotes + 1) * sizeof *notes);
    if (notes)
        d->notes = notes;
    if (!notes || !(notes[d->nnotes] = strdup(line)))
        return cli_error("no memory for the differences");
    d->nnotes++;
    return EXIT_OK;
}

static int note_number(struct diff *d, const char *what, int64_t a, int64_t b) {
    return a == b ? EXIT_OK : note(d, "%s: %lld and %lld", what, (long long)a, (long long)b);
}

static int note_word(struct diff *d, const char *what, const char *a, const char *b) {
    return strcmp(a, b) == 0 ? EXIT_OK : note(d, "%s: %s and %s", what, a, b);
}

static int compare_headers(struct diff *d) {
    const slv_ptx_info *a = slv_ptx_get_info(d->files[0]), *b = slv_ptx_get_info(d->files[1]);
    if (note_number(d, "faces", a->nfaces, b->nfaces) ||
        note_number(d, "channels", a->nchannels, b->nchannels))
        return EXIT_FAILED;
    if (d->texels)
        return EXIT_OK;
    if (note_word(d, "data type", slv_type_name(a->type), slv_type_name(b->type)) ||
        note_number(d, "alpha channel", a->alpha_channel, b->alpha_channel) ||
        note_word(d, "border mode in u", slv_border_mode_name(a->border_u),
                  slv_border_mode_name(b->border_u)) ||
        note_word(d, "border mode in v", slv_border_mode_name(a->border_v),
                  slv_border_mode_name(b->border_v)) ||
        note_word(d, "edge filter", slv_edge_filter_name(a->edge_filter),
                  slv_edge_filter_name(b->edge_filter)) ||
        note_word(d, "reductions", a->nlevels > 1 ? "stored" : "none",
                  b->nlevels > 1 ? "stored" : "none"))
        return EXIT_FAILED;
    return EXIT_OK;
}

static size_t value_size(const slv_ptx_meta *meta) {
    static const size_t sizes[] = {1, 1, 2, 4, 4, 8};
    return sizes[meta->type] * meta->count;
}

static int compare_entry(struct diff *d, const slv_ptx_meta *a, const slv_ptx_meta *b) {
    if (!b)
        return note(d, "metadata %.200s: only in the first", a->key);
    if (a->type != b->type)
        return note(d, "metadata %.200s: has another type", a->key);
    if (a->count != b->count)
        return note(d, "metadata %.200s: %u and %u values", a->key, a->count, b->count);
    if (memcmp(a->values, b->values, value_size(a)) != 0)
        return note(d, "metadata %.200s: other values", a->key);
    return EXIT_OK;
}

/* Afterwards a key that is not found is not there. */
static int load_meta(const slv_ptx *ptx) {
    const slv_ptx_meta *entry;
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++)
        if (slv_ptx_load_meta(ptx, i, &entry))
            return EXIT_FAILED;
    return EXIT_OK;
}

static int compare_meta(struct diff *d) {
    uint32_t na = slv_ptx_get_info(d->files[0])->nmeta, nb = slv_ptx_get_info(d->files[1])->nmeta;
    if (load_meta(d->files[0]) || load_meta(d->files[1]))
        return EXIT_FAILED;
    for (uint32_t i = 0; i < na; i++) {
        const slv_ptx_meta *a = slv_ptx_get_meta(d->files[0], i);
        if (compare_entry(d, a, slv_ptx_find_meta(d->files[1], a->key)))
            return EXIT_FAILED;
    }
    for (uint32_t i = 0; i < nb; i++) {
        const slv_ptx_meta *b = slv_ptx_get_meta(d->files[1], i);
        if (!slv_ptx_find_meta(d->files[0], b->key) &&
            note(d, "metadata %.200s: only in the second", b->key))
            return EXIT_FAILED;
    }
    return EXIT_OK;
}

int diff_files(struct diff *d) {
    int code = compare_headers(d);
    return code || d->texels ? code : compare_meta(d);
}
