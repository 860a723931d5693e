/* From packed faces to a complete file. */
#include "ptx/write/ptx_write.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "texture/neighbourhood.h"

#include <stdlib.h>

#define BATCH (UINT64_C(4) << 20)
#define WINDOW (UINT64_C(1) << 20) /* read back at once where blocks lie close to each other */
#define GAP (UINT64_C(1) << 16)

/* A run of blocks of one level that is written at once. */
struct batch {
    uint32_t level, first, end;
    uint64_t position, size;
};

struct assembly {
    slv_ptx_writer *writer;
    uint32_t *ranks, *order; /* face to place in reduction order, and back */
    uint32_t nlevels, level_faces[PTX_MAX_STORED_LEVELS];
    uint32_t table_sizes[PTX_MAX_STORED_LEVELS];
    uint64_t level_sizes[PTX_MAX_STORED_LEVELS];
    ptx_bytes tables, front; /* of all levels; all that comes before them */
    ptx_meta_out meta;
    struct batch *batches;
    uint64_t nbatches;
    int descriptor;
    ptx_errors errors;
};

static uint32_t header_at(const struct assembly *a, uint32_t level, uint32_t index) {
    return a->writer->headers[level][level ? a->order[index] : index];
}

static slv_result order_faces(struct assembly *a) {
    slv_ptx_writer *writer = a->writer;
    uint32_t nfaces = writer->params.nfaces;
    const slv_env *env = &writer->env;
    slv_result result;
    for (uint32_t face = 0; writer->links && face < nfaces; face++) {
        uint8_t *record = writer->records + (size_t)face * PTX_FACE_INFO_SIZE;
        slv_ptx_face own = writer->links[face];
        own.res = (slv_res){(int8_t)record[0], (int8_t)record[1]};
        own.flags |= record[3] & SLV_FACE_CONSTANT;
        slvi_ptx_pack_record(&own, record);
    }
    if ((result = slvi_alloc(env, writer->path, nfaces, sizeof *a->ranks, &a->ranks)) ||
        (result = slvi_alloc(env, writer->path, nfaces, sizeof *a->order, &a->order)))
        return result;
    slvi_ptx_rank_faces(writer->records, nfaces, a->ranks);
    a->nlevels = 1;
    a->level_faces[0] = nfaces;
    for (uint32_t face = 0; face < nfaces; face++) {
        a->order[a->ranks[face]] = face;
        for (uint32_t level = 1; level < PTX_MAX_STORED_LEVELS && writer->headers[level][face];
             level++) {
            a->level_faces[level]++;
            if (level >= a->nlevels)
                a->nlevels = level + 1;
        }
    }
    return SLV_OK;
}

static slv_result zip_levels(struct assembly *a, struct libdeflate_compressor *deflater) {
    slv_ptx_writer *writer = a->writer;
    uint32_t *headers = NULL;
    slv_result result =
        slvi_alloc(&writer->env, writer->path, writer->params.nfaces, sizeof *headers, &headers);
    for (uint32_t level = 0; !result && level < a->nlevels; level++) {
        uint32_t count = a->level_faces[level];
        uint64_t size = 0;
        for (uint32_t i = 0; i < count; i++) {
            headers[i] = header_at(a, level, i);
            size += PTX_BLOCK_SIZE(headers[i]);
        }
        result =
            slvi_ptx_bytes_append_zip(&writer->env, writer->path, deflater, &a->tables, headers,
                                      (uint64_t)count * 4, UINT32_MAX, &a->table_sizes[level]);
        a->level_sizes[level] = size + a->table_sizes[level];
    }
    slvi_free(headers);
    return result;
}

/* The header and all tables in front of the levels. */
static slv_result make_front(struct assembly *a, struct libdeflate_compressor *deflater) {
    uint8_t header[PTX_HEADER_SIZE + PTX_EXTENDED_HEADER_SIZE] = {0};
    uint8_t *extended = header + PTX_HEADER_SIZE;
    uint8_t list[PTX_MAX_STORED_LEVELS * PTX_LEVEL_INFO_SIZE];
    slv_ptx_writer *writer = a->writer;
    const slv_ptx_writer_params *p = &writer->params;
    const slv_env *env = &writer->env;
    uint32_t faces_zipped = 0, constants_zipped = 0, list_size = a->nlevels * PTX_LEVEL_INFO_SIZE;
    uint64_t level_bytes = 0;
    slv_result result;
    if ((result = slvi_ptx_bytes_append(env, writer->path, &a->front, header, sizeof header)) ||
        (result = slvi_ptx_bytes_append_zip(env, writer->path, deflater, &a->front, writer->records,
                                            (uint64_t)p->nfaces * PTX_FACE_INFO_SIZE, UINT32_MAX,
                                            &faces_zipped)) ||
        (result = slvi_ptx_bytes_append_zip(
             env, writer->path, deflater, &a->front, writer->constants,
             (uint64_t)p->nfaces * writer->pixel_size, UINT32_MAX, &constants_zipped)))
        return result;
    for (uint32_t level = 0; level < a->nlevels; level++) {
        ptx_put_u64(list + level * PTX_LEVEL_INFO_SIZE, a->level_sizes[level]);
        ptx_put_u32(list + level * PTX_LEVEL_INFO_SIZE + 8, a->table_sizes[level]);
        ptx_put_u32(list + level * PTX_LEVEL_INFO_SIZE + 12, a->level_faces[level]);
        level_bytes += a->level_sizes[level];
    }
    if ((result = slvi_ptx_bytes_append(env, writer->path, &a->front, list, list_size)))
        return result;
    memcpy(header, "Ptex", 4);
    ptx_put_u32(header + 4, 1);
    ptx_put_u32(header + 8, p->mesh_type);
    ptx_put_u32(header + 12, p->type);
    ptx_put_u32(header + 16, (uint32_t)p->alpha_channel);
    ptx_put_u16(header + 20, p->nchannels);
    ptx_put_u16(header + 22, a->nlevels);
    ptx_put_u32(header + 24, p->nfaces);
    ptx_put_u32(header + 28, PTX_EXTENDED_HEADER_SIZE);
    ptx_put_u32(header + 32, faces_zipped);
    ptx_put_u32(header + 36, constants_zipped);
    ptx_put_u32(header + 40, list_size);
    ptx_put_u32(header + 44, 4);
    ptx_put_u64(header + 48, level_bytes);
    ptx_put_u32(header + 56, a->meta.small_zipped);
    ptx_put_u32(header + 60, a->meta.small_size);
    ptx_put_u16(extended, p->border_u);
    ptx_put_u16(extended + 4, p->border_v);
    ptx_put_u16(extended + 6, p->edge_filter);
    ptx_put_u32(extended + 8, a->meta.large_zipped);
    ptx_put_u32(extended + 12, a->meta.large_size);
    ptx_put_u64(extended + 16, a->meta.large_data);
    ptx_put_u64(extended + 32, a->front.size + level_bytes + a->meta.bytes.size);
    memcpy(a->front.data, header, sizeof header);
    return SLV_OK;
}

/* Cuts the levels into batches. With `batches` NULL they are only counted. */
static void cut_batches(struct assembly *a) {
    uint64_t position = a->front.size;
    a->nbatches = 0;
    for (uint32_t level = 0; level < a->nlevels; level++) {
        position += a->table_sizes[level];
        for (uint32_t first = 0, end; first < a->level_faces[level]; first = end) {
            uint64_t size = 0;
            for (end = first; end < a->level_faces[level]; end++) {
                uint64_t block = PTX_BLOCK_SIZE(header_at(a, level, end));
                if (end > first && size + block > BATCH)
                    break;
                size += block;
            }
            if (a->batches)
                a->batches[a->nbatches] = (struct batch){level, first, end, position, size};
            a->nbatches++;
            position += size;
        }
    }
}

/* A block on its way from the spill into a batch. */
struct move {
    uint64_t from, to;
    uint32_t size;
};

static int compare_moves(const void *a, const void *b) {
    const struct move *x = a, *y = b;
    return (x->from > y->from) - (x->from < y->from);
}

static slv_result gather(const ptx_spill *spill, const slv_env *env, struct move *moves,
                         uint32_t count, uint8_t *window, uint8_t *out) {
    slv_result result = SLV_OK;
    if (count)
        qsort(moves, count, sizeof *moves, compare_moves);
    for (uint32_t i = 0, end; i < count && !result; i = end) {
        uint64_t start = moves[i].from, stop = start + moves[i].size;
        end = i + 1;
        if (start < spill->budget || moves[i].size >= WINDOW) {
            result = slvi_ptx_spill_read(spill, env, start, moves[i].size, out + moves[i].to);
            continue;
        }
        while (end < count && moves[end].from <= stop + GAP &&
               moves[end].from + moves[end].size <= start + WINDOW) {
            stop = moves[end].from + moves[end].size;
            end++;
        }
        result = slvi_ptx_spill_read(spill, env, start, stop - start, window);
        for (uint32_t k = i; k < end && !result; k++)
            memcpy(out + moves[k].to, window + (moves[k].from - start), moves[k].size);
    }
    return result;
}

/* Files are written anywhere, by several threads; streams in order. */
static slv_result put(const struct assembly *a, const slv_env *env, const void *bytes,
                      uint64_t size, uint64_t position) {
    const slv_ptx_writer *writer = a->writer;
    if (!writer->output.write)
        return slvi_write_at(env, writer->path, a->descriptor, bytes, size, position);
    if (size && writer->output.write(writer->output.user, bytes, (size_t)size) != 0)
        return slvi_fail(env, SLV_ERROR_IO, "%s: could not be written", writer->path);
    return SLV_OK;
}

static slv_result write_batch(const struct assembly *a, const slv_env *env,
                              const struct batch *batch) {
    const slv_ptx_writer *writer = a->writer;
    struct move *moves = NULL;
    uint8_t *bytes = NULL;
    uint32_t count = 0;
    uint64_t at = 0;
    slv_result result =
        slvi_alloc(env, writer->path, batch->end - batch->first, sizeof *moves, &moves);
    if (!result)
        result = slvi_alloc(env, writer->path, batch->size + WINDOW, 1, &bytes);
    for (uint32_t i = batch->first; !result && i < batch->end; i++) {
        uint32_t face = batch->level ? a->order[i] : i;
        uint32_t size = PTX_BLOCK_SIZE(writer->headers[batch->level][face]);
        if (!size)
            continue;
        uint64_t from = writer->positions[face];
        for (uint32_t level = 0; level < batch->level; level++)
            from += PTX_BLOCK_SIZE(writer->headers[level][face]);
        moves[count++] = (struct move){from, at, size};
        at += size;
    }
    if (!result)
        result = gather(&writer->spill, env, moves, count, bytes + batch->size, bytes);
    if (!result)
        result = put(a, env, bytes, batch->size, batch->position);
    slvi_free(moves);
    slvi_free(bytes);
    return result;
}

static slv_result write_run(struct assembly *a, const slv_env *env, uint64_t first, uint64_t end) {
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        const struct batch *batch = &a->batches[i];
        result = write_batch(a, env, batch);
        if (!result && !batch->level)
            result =
                slvi_steps_add(&a->writer->steps, env, a->writer->path, batch->end - batch->first);
    }
    return result;
}

static slv_result write_batches(void *user, uint64_t first, uint64_t end) {
    struct assembly *a = user;
    ptx_range_log log;
    slv_env env = slvi_ptx_range_env(&a->writer->env, &a->errors, first, &log);
    return write_run(a, &env, first, end);
}

/* All but the batches; or, in order, all. */
static slv_result write_parts(struct assembly *a) {
    const slv_ptx_writer *writer = a->writer;
    const slv_env *env = &writer->env;
    bool in_order = writer->output.write != NULL;
    uint64_t position = a->front.size, table = 0;
    uint32_t next = 0;
    slv_result result = put(a, env, a->front.data, a->front.size, 0);
    for (uint32_t level = 0; !result && level < a->nlevels; level++) {
        uint32_t first = next;
        while (next < a->nbatches && a->batches[next].level == level)
            next++;
        result = put(a, env, a->tables.data + table, a->table_sizes[level], position);
        if (!result && in_order)
            result = write_run(a, env, first, next);
        table += a->table_sizes[level];
        position += a->level_sizes[level];
    }
    if (!result)
        result = put(a, env, a->meta.bytes.data, a->meta.bytes.size, position);
    return result;
}

static slv_result write_all(struct assembly *a) {
    const slv_ptx_writer *writer = a->writer;
    slv_output output = {.path = NULL};
    slv_result result;
    if (writer->output.write)
        return write_parts(a);
    if ((result = slvi_output_begin(&writer->env, writer->path, false, &output)))
        return result;
    a->descriptor = output.descriptor;
    if (!(result = write_parts(a)) &&
        !(result =
              slvi_ptx_parallel_for(&writer->env, &a->errors, a->nbatches, 1, write_batches, a)))
        result = slvi_output_commit(&output, writer->params.sync);
    slvi_output_discard(&output);
    return result;
}

static slv_source_face written_face(const void *user, uint32_t face) {
    const slv_ptx_writer *writer = user;
    slv_source_face out;
    slvi_ptx_unpack_record(writer->records + (size_t)face * PTX_FACE_INFO_SIZE,
                           writer->params.mesh_type == SLV_PTX_TRIANGLE, &out);
    return out;
}

static bool same_value(const void *user, uint32_t face, uint32_t other) {
    const slv_ptx_writer *writer = user;
    size_t size = writer->pixel_size;
    return (writer->records[(size_t)other * PTX_FACE_INFO_SIZE + 3] & SLV_FACE_CONSTANT) &&
           memcmp(writer->constants + face * size, writer->constants + other * size, size) == 0;
}

/* Sets the flag of constant faces among whose neighbours nothing but their value is found. */
static void flag_neighbourhoods(slv_ptx_writer *writer) {
    const slv_ptx_writer_params *p = &writer->params;
    slv_neighbourhood around = {writer, written_face, same_value, p->mesh_type == SLV_PTX_TRIANGLE,
                                p->border_u == SLV_BORDER_CLAMP && p->border_v == SLV_BORDER_CLAMP};
    for (uint32_t face = 0; face < p->nfaces; face++)
        if (slvi_neighbourhood_is_constant(&around, face))
            writer->records[(size_t)face * PTX_FACE_INFO_SIZE + 3] |= SLV_FACE_NEIGHBOURS_CONSTANT;
}

slv_result slvi_ptx_writer_assemble(slv_ptx_writer *writer) {
    struct assembly a = {.writer = writer};
    struct libdeflate_compressor *deflater = libdeflate_alloc_compressor(writer->compression);
    slv_result result = SLV_OK;
    if (!deflater)
        result =
            slvi_fail(&writer->env, SLV_ERROR_MEMORY, "%s: no memory to pack it", writer->path);
    if (result || (result = order_faces(&a)))
        goto done;
    flag_neighbourhoods(writer);
    if ((result = zip_levels(&a, deflater)) ||
        (result = slvi_ptx_meta_pack(&writer->env, writer->path, deflater, writer->meta,
                                     writer->nmeta, &a.meta)) ||
        (result = make_front(&a, deflater)))
        goto done;
    cut_batches(&a);
    if ((result =
             slvi_alloc(&writer->env, writer->path, a.nbatches, sizeof *a.batches, &a.batches)))
        goto done;
    cut_batches(&a);
    result = write_all(&a);
done:
    libdeflate_free_compressor(deflater);
    slvi_free(a.ranks);
    slvi_free(a.order);
    slvi_free(a.tables.data);
    slvi_free(a.front.data);
    slvi_free(a.meta.bytes.data);
    slvi_free(a.batches);
    return result;
}
