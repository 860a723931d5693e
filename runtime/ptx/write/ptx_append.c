/* Edits appended to a file. They lie behind what its header says is there, until they are complete
 * and one write of the header takes them in: whoever kills an editor leaves the old file or the new
 * one. */
#include "ptx/write/ptx_write.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define EDIT_FIELDS (PTX_HEADER_SIZE + 24) /* where the size and the position of the edits are */
#define FLUSH (UINT64_C(1) << 20)

enum { EDIT_FACE = 0, EDIT_META = 1 };

/* Records on their way into the file. */
struct append {
    slv_ptx_writer *writer;
    ptx_bytes bytes;
    uint64_t position;
};

static slv_result flush(struct append *append) {
    slv_ptx_writer *writer = append->writer;
    slv_result result = slvi_write_at(&writer->env, writer->path, writer->edited,
                                      append->bytes.data, append->bytes.size, append->position);
    append->position += append->bytes.size;
    append->bytes.size = 0;
    return result;
}

static slv_result append_face(struct append *append, uint32_t face) {
    slv_ptx_writer *writer = append->writer;
    uint8_t head[PTX_EDIT_HEADER_SIZE + 4 + PTX_FACE_INFO_SIZE + 4] = {EDIT_FACE};
    uint32_t header = writer->headers[0][face], block = PTX_BLOCK_SIZE(header);
    uint64_t size = 8 + PTX_FACE_INFO_SIZE + writer->pixel_size + block;
    ptx_put_u32(head + 1, (uint32_t)size);
    ptx_put_u32(head + 5, face);
    memcpy(head + 9, writer->records + (size_t)face * PTX_FACE_INFO_SIZE, PTX_FACE_INFO_SIZE);
    ptx_put_u32(head + 9 + PTX_FACE_INFO_SIZE, header);
    slv_result result =
        slvi_ptx_bytes_append(&writer->env, writer->path, &append->bytes, head, sizeof head);
    if (!result)
        result = slvi_ptx_bytes_append(&writer->env, writer->path, &append->bytes,
                                       writer->constants + face * writer->pixel_size,
                                       writer->pixel_size);
    if (!result)
        result = slvi_ptx_bytes_reserve(&writer->env, writer->path, &append->bytes, block);
    if (!result)
        result = slvi_ptx_spill_read(&writer->spill, &writer->env, writer->positions[face], block,
                                     append->bytes.data + append->bytes.size);
    if (!result)
        append->bytes.size += block;
    return !result && append->bytes.size >= FLUSH ? flush(append) : result;
}

static slv_result append_meta(struct append *append) {
    slv_ptx_writer *writer = append->writer;
    uint8_t head[PTX_EDIT_HEADER_SIZE + 8] = {EDIT_META};
    ptx_bytes plain = {0};
    uint32_t zipped = 0;
    uint64_t start = append->bytes.size;
    struct libdeflate_compressor *deflater = libdeflate_alloc_compressor(writer->compression);
    slv_result result = SLV_OK;
    if (!deflater)
        result =
            slvi_fail(&writer->env, SLV_ERROR_MEMORY, "%s: no memory to pack it", writer->path);
    if (!result &&
        !(result = slvi_ptx_meta_pack_edit(&writer->env, writer->path, writer->meta, writer->nmeta,
                                           &plain)) &&
        !(result =
              slvi_ptx_bytes_append(&writer->env, writer->path, &append->bytes, head, sizeof head)))
        result = slvi_ptx_bytes_append_zip(&writer->env, writer->path, deflater, &append->bytes,
                                           plain.data, plain.size, UINT32_MAX - 8, &zipped);
    if (!result) {
        uint8_t *record = append->bytes.data + start;
        ptx_put_u32(record + 1, zipped + 8);
        ptx_put_u32(record + 5, zipped);
        ptx_put_u32(record + 9, (uint32_t)plain.size);
    }
    libdeflate_free_compressor(deflater);
    slvi_free(plain.data);
    return result;
}

static slv_result put_fields(const slv_ptx_writer *writer, uint64_t end) {
    uint8_t fields[16];
    ptx_put_u64(fields, end - writer->edit_position);
    ptx_put_u64(fields + 8, writer->edit_position);
    return slvi_write_at(&writer->env, writer->path, writer->edited, fields, sizeof fields,
                         EDIT_FIELDS);
}

static slv_result append_all(struct append *append) {
    slv_ptx_writer *writer = append->writer;
    slv_result result = SLV_OK;
    for (uint32_t face = 0; !result && face < writer->params.nfaces; face++)
        if (!writer->given[face] || !(result = append_face(append, face)))
            result = slvi_steps_add(&writer->steps, &writer->env, writer->path, 1);
    if (!result && writer->nmeta)
        result = append_meta(append);
    return result ? result : flush(append);
}

slv_result slvi_ptx_writer_append(slv_ptx_writer *writer) {
    struct append append = {.writer = writer, .position = writer->edit_end};
    struct stat edited, named;
    uint8_t fields[16];
    if (fstat(writer->edited, &edited) != 0 || stat(writer->path, &named) != 0 ||
        edited.st_dev != named.st_dev || edited.st_ino != named.st_ino)
        return slvi_fail(&writer->env, SLV_ERROR_IO, "%s: was replaced while it was being edited",
                         writer->path);
    int reason = slvi_read_at(writer->edited, fields, sizeof fields, EDIT_FIELDS);
    if (reason)
        return slvi_fail(&writer->env, slvi_io_error(reason),
                         "%s: its header could not be read: %s", writer->path, strerror(reason));
    slv_result result = SLV_OK;
    /* old files have no end of their edits: all that follows would count, half written or not */
    if (!ptx_get_u64(fields + 8))
        result = put_fields(writer, writer->edit_end);
    if (!result)
        result = append_all(&append);
    if (!result && writer->params.sync && fdatasync(writer->edited) != 0)
        result = slvi_fail(&writer->env, slvi_io_error(errno), "%s: write failed: %s", writer->path,
                           strerror(errno));
    if (!result && append.position > writer->edit_end)
        result = put_fields(writer, append.position);
    slvi_free(append.bytes.data);
    uint64_t end = result ? (uint64_t)edited.st_size : append.position;
    if (!result && writer->params.sync && fdatasync(writer->edited) != 0)
        result = slvi_fail(&writer->env, slvi_io_error(errno), "%s: write failed: %s", writer->path,
                           strerror(errno));
    /* what a killed editor left, or this one when it failed; nobody sees it, so nothing is lost if
     * it stays */
    if (end >= writer->edit_end)
        (void)!ftruncate(writer->edited, (off_t)end);
    if (!result)
        slvi_beside_sweep(writer->path);
    return result;
}
