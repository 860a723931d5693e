/* Edits: records appended to a finished file, each replacing a face's data or adding metadata. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdlib.h>

enum { EDIT_FACE = 0, EDIT_META = 1 };

/* Room for one more edit. */
static slv_result reserve(slv_ptx *ptx) {
    if (ptx->nedits < ptx->edit_capacity)
        return SLV_OK;
    uint64_t capacity = ptx->edit_capacity ? 2 * (uint64_t)ptx->edit_capacity : 16;
    ptx_edit *edits = NULL;
    uint8_t *values = NULL;
    slv_result result = slvi_alloc(&ptx->env, ptx->name, capacity, sizeof *edits, &edits);
    if (!result)
        result = slvi_alloc(&ptx->env, ptx->name, capacity, ptx->pixel_size, &values);
    if (result) {
        slvi_free(edits);
        return result;
    }
    if (ptx->nedits) {
        memcpy(edits, ptx->edits, ptx->nedits * sizeof *edits);
        memcpy(values, ptx->edit_values, ptx->nedits * ptx->pixel_size);
    }
    slvi_free(ptx->edits);
    slvi_free(ptx->edit_values);
    ptx->edits = edits;
    ptx->edit_values = values;
    ptx->edit_capacity = (uint32_t)capacity;
    return SLV_OK;
}

static slv_result read_face_edit(slv_ptx *ptx, uint64_t position, uint32_t size, uint8_t *buffer) {
    uint64_t fixed = 4 + PTX_FACE_INFO_SIZE + 4 + (uint64_t)ptx->pixel_size;
    if (size < fixed)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: the face edit at offset %llu has %u bytes, it needs %llu", ptx->name,
                         (unsigned long long)position, size, (unsigned long long)fixed);
    slv_result result = slvi_ptx_read_bytes(&ptx->env, ptx, "face edit", position, fixed, buffer);
    if (result)
        return result;
    uint32_t index = ptx_get_u32(buffer), header = ptx_get_u32(buffer + 4 + PTX_FACE_INFO_SIZE);
    if (index >= ptx->info.nfaces)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: the edit at offset %llu is of face %u, but there are %u faces",
                         ptx->name, (unsigned long long)position, index, ptx->info.nfaces);
    if (PTX_BLOCK_SIZE(header) > size - fixed)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: face %u: its edit at offset %llu holds %llu bytes of texels, not %u",
                         ptx->name, index, (unsigned long long)position,
                         (unsigned long long)(size - fixed), PTX_BLOCK_SIZE(header));
    uint8_t *record = buffer + 4;
    record[3] &= SLV_FACE_CONSTANT | SLV_FACE_NEIGHBOURS_CONSTANT | SLV_FACE_SUBFACE;
    record[3] |= SLV_FACE_EDITED;
    if ((result = slvi_ptx_check_record(ptx, index, record)) || (result = reserve(ptx)))
        return result;
    ptx_edit *edit = &ptx->edits[ptx->nedits];
    *edit = (ptx_edit){
        .face = index, .turn = ptx->nedits, .header = header, .position = position + fixed};
    memcpy(edit->record, record, PTX_FACE_INFO_SIZE);
    memcpy(ptx->edit_values + ptx->nedits++ * ptx->pixel_size, buffer + 8 + PTX_FACE_INFO_SIZE,
           ptx->pixel_size);
    return SLV_OK;
}

static int compare_edits(const void *a, const void *b) {
    const ptx_edit *x = a, *y = b;
    if (x->face != y->face)
        return x->face < y->face ? -1 : 1;
    return (x->turn > y->turn) - (x->turn < y->turn);
}

/* Sorts the edits by face and keeps the last of each. */
static void finish_edits(slv_ptx *ptx) {
    uint32_t kept = 0;
    if (ptx->nedits)
        qsort(ptx->edits, ptx->nedits, sizeof *ptx->edits, compare_edits);
    for (uint32_t i = 0; i < ptx->nedits; i++)
        if (i + 1 == ptx->nedits || ptx->edits[i + 1].face != ptx->edits[i].face)
            ptx->edits[kept++] = ptx->edits[i];
    ptx->nedits = kept;
}

static slv_result read_meta_edit(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                                 uint64_t position, uint32_t size) {
    uint8_t sizes[8], *bytes = NULL;
    slv_result result = SLV_OK;
    if (size >= 8)
        result = slvi_ptx_read_bytes(&ptx->env, ptx, "metadata edit", position, 8, sizes);
    if (result)
        return result;
    if (size < 8 || ptx_get_u32(sizes) > size - 8)
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: the metadata edit at offset %llu is cut short at %u bytes", ptx->name,
                         (unsigned long long)position, size);
    uint32_t unpacked = ptx_get_u32(sizes + 4);
    result = slvi_ptx_read_zip(ptx, inflater, "metadata edit", position + 8, ptx_get_u32(sizes),
                               unpacked, &bytes);
    if (!result)
        result = slvi_ptx_meta_parse(ptx, "metadata edit", bytes, unpacked);
    slvi_free(bytes);
    return result;
}

slv_result slvi_ptx_read_edits(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                               uint64_t position, uint64_t end, bool open_ended) {
    uint8_t header[PTX_EDIT_HEADER_SIZE], *buffer = NULL;
    slv_result result =
        slvi_alloc(&ptx->env, ptx->name, 8 + PTX_FACE_INFO_SIZE + ptx->pixel_size, 1, &buffer);
    ptx->edit_end = position;
    while (!result && position < end) {
        /* files from before edits had a recorded size are scanned to their end, whatever is there
         */
        if (open_ended && end - position < PTX_EDIT_HEADER_SIZE)
            break;
        if ((result = slvi_ptx_read_bytes(&ptx->env, ptx, "edit", position, sizeof header, header)))
            break;
        uint32_t size = ptx_get_u32(header + 1);
        position += PTX_EDIT_HEADER_SIZE;
        if (!size)
            break;
        if (position > end || size > end - position) {
            result = slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                               "%s: truncated: the edit at offset %llu has %u bytes, but the edits "
                               "end at %llu",
                               ptx->name, (unsigned long long)(position - PTX_EDIT_HEADER_SIZE),
                               size, (unsigned long long)end);
            break;
        }
        ptx->info.has_edits = true;
        if (header[0] == EDIT_FACE)
            result = read_face_edit(ptx, position, size, buffer);
        else if (header[0] == EDIT_META)
            result = read_meta_edit(ptx, inflater, position, size);
        position += size;
        ptx->edit_end = position;
    }
    finish_edits(ptx);
    slvi_free(buffer);
    return result;
}
