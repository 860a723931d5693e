/* A document in a file: its layers' blocks as they are, and a checksum of all. */
#include "session/session_data.h"

#include "base/file.h"
#include "base/log.h"
#include "base/output.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char magic[16] = "selvage-state-1";
#define ENDIAN_MARK 0x01020304u

/* ---- writing ---- */

typedef struct writing {
    FILE *stream;
    uint32_t crc;
    int reason; /* errno of the first failure */
} writing;

static void put(writing *w, const void *data, size_t size) {
    w->crc = slvi_crc(w->crc, data, size);
    errno = 0;
    if (!w->reason && size && fwrite(data, size, 1, w->stream) != 1)
        w->reason = errno ? errno : EIO;
}

static void put_u32(writing *w, uint32_t value) {
    put(w, &value, sizeof value);
}

static void put_plane(writing *w, const slvi_plane *plane) {
    put_u32(w, (uint32_t)plane->type);
    put_u32(w, plane->nchannels);
    put_u32(w, (uint32_t)plane->alpha);
    put(w, plane->fill, sizeof plane->fill);
    put(w, plane->res, plane->nfaces * sizeof *plane->res);
    for (uint32_t face = 0; face < plane->nfaces; face++) {
        const slvi_table *table = plane->tables[face];
        uint32_t count = 0;
        for (uint32_t i = 0; table && i < table->count; i++)
            count += table->blocks[i] != NULL;
        put_u32(w, count);
        for (uint32_t i = 0; table && i < table->count; i++)
            if (table->blocks[i]) {
                put_u32(w, i);
                put(w, table->blocks[i]->texels, table->blocks[i]->bytes);
            }
    }
}

static void put_layer(writing *w, const slvi_layer *layer) {
    put_u32(w, layer->id);
    put(w, layer->props.name, sizeof layer->props.name);
    put(w, &layer->props.opacity, sizeof layer->props.opacity);
    put_u32(w, (uint32_t)layer->props.blend);
    put_u32(w, (uint32_t)layer->props.hidden | (uint32_t)layer->props.locked << 1 |
                   (uint32_t)(layer->mask != NULL) << 2);
    put_plane(w, layer->colour);
    if (layer->mask)
        put_plane(w, layer->mask);
}

slv_result slvi_state_write(const slv_env *env, const char *path, const slv_document *document,
                            uint64_t line) {
    slv_output output;
    writing w = {0};
    uint32_t nfaces = document->flat.nfaces;
    slv_result result = slvi_output_begin(env, path, false, &output);
    if (result)
        return result;
    if ((result = slvi_output_stream(&output, &w.stream))) {
        slvi_output_discard(&output);
        return result;
    }
    put(&w, magic, sizeof magic);
    put_u32(&w, ENDIAN_MARK);
    put_u32(&w, nfaces);
    put(&w, &line, sizeof line);
    put_u32(&w, document->next_id);
    put_u32(&w, document->nlayers);
    put_u32(&w, document->selected != NULL);
    put_u32(&w, document->mixed);
    put(&w, document->res, nfaces * sizeof *document->res);
    if (document->selected)
        put(&w, document->selected, ((size_t)nfaces + 63) / 64 * sizeof(uint64_t));
    for (uint32_t i = 0; i < document->nlayers; i++)
        put_layer(&w, document->stack[i]);
    put_u32(&w, w.crc);
    if (!w.reason)
        return slvi_output_commit(&output, true);
    slvi_output_discard(&output);
    return slvi_fail(env, SLV_ERROR_IO, "%s: cannot be written: %s", path, strerror(w.reason));
}

/* ---- reading ---- */

typedef struct reading {
    const slv_env *env;
    const char *path;
    const char *at;
    size_t left;
    slv_result result;
} reading;

static bool wrong(reading *r, const char *what) {
    if (!r->result)
        r->result = slvi_fail(r->env, SLV_ERROR_FORMAT, "%s: %s", r->path, what);
    return false;
}

static bool get(reading *r, void *out, size_t size) {
    if (r->result || r->left < size)
        return wrong(r, "ends too early");
    memcpy(out, r->at, size);
    r->at += size;
    r->left -= size;
    return true;
}

static uint32_t get_u32(reading *r) {
    uint32_t value = 0;
    get(r, &value, sizeof value);
    return value;
}

static bool get_res(reading *r, uint32_t nfaces, slv_res *res) {
    if (!get(r, res, nfaces * sizeof *res))
        return false;
    for (uint32_t i = 0; i < nfaces; i++)
        if (res[i].u < 0 || res[i].v < 0 || res[i].u > SLV_MAX_LOG2_RES ||
            res[i].v > SLV_MAX_LOG2_RES)
            return wrong(r, "a face has a resolution that there is not");
    return true;
}

static bool get_table(reading *r, slvi_plane *plane, uint32_t face) {
    slv_res res = plane->res[face];
    uint32_t count = get_u32(r), blocks = slvi_block_count(res), last = 0;
    size_t bytes = slvi_block_bytes(plane, res);
    if (r->result || !count)
        return !r->result;
    if (count > blocks || count > r->left / (bytes + 4))
        return wrong(r, "a face has more blocks than it can");
    if ((r->result = slvi_table_create(plane, res, &plane->tables[face])))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t index = get_u32(r);
        if (r->result || index >= blocks || (i && index <= last))
            return wrong(r, "blocks of a face are not in order");
        slvi_block **block = &plane->tables[face]->blocks[index];
        if ((r->result = slvi_block_create(plane, res, 0, block)) ||
            !get(r, (*block)->texels, bytes))
            return false;
        last = index;
    }
    return true;
}

static bool get_plane(reading *r, const slv_document *document, bool mask, slvi_plane **out) {
    uint32_t nfaces = document->flat.nfaces, type = get_u32(r), nchannels = get_u32(r);
    int32_t alpha = (int32_t)get_u32(r);
    float fill[SLVI_MOST_CHANNELS];
    slv_texture_desc desc = {.nfaces = nfaces,
                             .type = (slv_type)type,
                             .nchannels = nchannels,
                             .alpha_channel = alpha,
                             .res = document->res};
    if (!get(r, fill, sizeof fill))
        return false;
    if (type == SLV_TYPE_U8 || type > SLV_TYPE_FLOAT ||
        nchannels != (mask ? 1 : document->nchannels) ||
        alpha != (mask ? SLV_NO_ALPHA : document->alpha))
        return wrong(r, "a layer is not of the document's kind");
    if ((r->result = slvi_plane_create(&document->env, &desc, fill, out)) ||
        !get_res(r, nfaces, (*out)->res))
        return false;
    for (uint32_t face = 0; face < nfaces; face++)
        if (!get_table(r, *out, face))
            return false;
    return true;
}

static bool get_layer(reading *r, slv_document *document) {
    slvi_layer *layer = NULL;
    if ((r->result = slvi_alloc(&document->env, "layer", 1, sizeof *layer, &layer)))
        return false;
    document->stack[document->nlayers++] = layer;
    layer->refs = 1;
    layer->id = get_u32(r);
    get(r, layer->props.name, sizeof layer->props.name);
    get(r, &layer->props.opacity, sizeof layer->props.opacity);
    uint32_t blend = get_u32(r), flags = get_u32(r);
    if (r->result || blend >= SLV_BLEND_COUNT || flags > 7 || !layer->id ||
        !(layer->props.opacity >= 0 && layer->props.opacity <= 1) ||
        layer->id >= document->next_id || layer->props.name[sizeof layer->props.name - 1])
        return wrong(r, "a layer has properties that there are not");
    for (uint32_t i = 0; i + 1 < document->nlayers; i++)
        if (document->stack[i]->id == layer->id)
            return wrong(r, "two layers have one id");
    layer->props.blend = (slv_blend)blend;
    layer->props.hidden = flags & 1;
    layer->props.locked = (flags & 2) != 0;
    return get_plane(r, document, false, &layer->colour) &&
           (!(flags & 4) || get_plane(r, document, true, &layer->mask));
}

static void read_all(reading *r, slv_document *document, uint64_t *line) {
    char begin[sizeof magic];
    uint32_t nfaces = document->flat.nfaces, crc;
    if (r->left < sizeof magic + 4 || memcmp(r->at, magic, sizeof magic) != 0) {
        wrong(r, "is no state of a session");
        return;
    }
    r->left -= 4;
    memcpy(&crc, r->at + r->left, 4);
    if (crc != slvi_crc(0, r->at, r->left)) {
        wrong(r, "is damaged: its checksum is another");
        return;
    }
    get(r, begin, sizeof begin);
    if (get_u32(r) != ENDIAN_MARK || get_u32(r) != nfaces) {
        wrong(r, "is of another session, or another kind of machine");
        return;
    }
    get(r, line, sizeof *line);
    document->next_id = get_u32(r);
    uint32_t count = get_u32(r), selected = get_u32(r);
    document->mixed = get_u32(r) != 0;
    if (!get_res(r, nfaces, document->res))
        return;
    size_t words = ((size_t)nfaces + 63) / 64;
    if (selected && r->left < words * 8)
        wrong(r, "ends too early");
    else if (selected &&
             !(r->result = slvi_alloc(r->env, "document", words, 8, &document->selected)))
        get(r, document->selected, words * 8);
    if (!r->result && (!document->next_id || count > r->left / sizeof(slv_layer_props)))
        wrong(r, "has more layers than it can");
    if (!r->result)
        r->result =
            slvi_alloc(r->env, "document", count + (uint64_t)1, sizeof(void *), &document->stack);
    for (uint32_t i = 0; !r->result && i < count; i++)
        get_layer(r, document);
    if (!r->result && r->left)
        wrong(r, "has more than it should");
}

slv_result slvi_state_read(const slv_env *env, const char *path, slv_document *document,
                           uint64_t *line) {
    char *data = NULL;
    size_t size = 0;
    slv_result result = slvi_file_read(env, path, &data, &size);
    reading r = {.env = env, .path = path, .at = data, .left = size};
    if (!result) {
        read_all(&r, document, line);
        result = r.result;
    }
    slvi_free(data);
    return result;
}
