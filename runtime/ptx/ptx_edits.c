/* Edits: records appended to a finished file, each replacing a face's data or adding metadata. */
#include "ptx/ptx_file.h"

#include <stdlib.h>

enum { EDIT_FACE = 0, EDIT_META = 1 };

static slv_result read_face_edit(slv_ptx *ptx, uint64_t position, uint32_t size, uint8_t *buffer) {
    uint64_t fixed = 4 + PTX_FACE_INFO_SIZE + 4 + (uint64_t)ptx->pixel_size;
    slv_ptx_face face;
    if (size < fixed)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: the face edit at offset %llu has %u bytes, it needs %llu", ptx->name,
                        (unsigned long long)position, size, (unsigned long long)fixed);
    slv_result result = ptx_read_bytes(&ptx->env, ptx, "face edit", position, fixed, buffer);
    if (result)
        return result;
    uint32_t index = ptx_get_u32(buffer), header = ptx_get_u32(buffer + 4 + PTX_FACE_INFO_SIZE);
    if (index >= ptx->info.nfaces)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: the edit at offset %llu is of face %u, but there are %u faces",
                        ptx->name, (unsigned long long)position, index, ptx->info.nfaces);
    if (PTX_BLOCK_SIZE(header) > size - fixed)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: face %u: its edit at offset %llu holds %llu bytes of texels, not %u",
                        ptx->name, index, (unsigned long long)position,
                        (unsigned long long)(size - fixed), PTX_BLOCK_SIZE(header));
    if ((result = ptx_parse_face(ptx, index, buffer + 4, &face)))
        return result;
    face.flags |= SLV_FACE_EDITED;
    ptx->faces[index] = face;
    ptx->levels[0].headers[index] = header;
    ptx->levels[0].positions[index] = position + fixed;
    memcpy(ptx->constants + index * ptx->pixel_size, buffer + 8 + PTX_FACE_INFO_SIZE,
           ptx->pixel_size);
    return SLV_OK;
}

static slv_result read_meta_edit(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                                 uint64_t position, uint32_t size) {
    uint8_t sizes[8], *bytes = NULL;
    slv_result result = SLV_OK;
    if (size >= 8)
        result = ptx_read_bytes(&ptx->env, ptx, "metadata edit", position, 8, sizes);
    if (result)
        return result;
    if (size < 8 || ptx_get_u32(sizes) > size - 8)
        return slv_fail(&ptx->env, SLV_ERROR_FORMAT,
                        "%s: the metadata edit at offset %llu is cut short at %u bytes", ptx->name,
                        (unsigned long long)position, size);
    uint32_t unpacked = ptx_get_u32(sizes + 4);
    result = ptx_read_zip(ptx, inflater, "metadata edit", position + 8, ptx_get_u32(sizes),
                          unpacked, &bytes);
    if (!result)
        result = ptx_meta_parse(ptx, "metadata edit", bytes, unpacked);
    free(bytes);
    return result;
}

slv_result ptx_read_edits(slv_ptx *ptx, struct libdeflate_decompressor *inflater, uint64_t position,
                          uint64_t end, bool open_ended) {
    uint8_t header[PTX_EDIT_HEADER_SIZE], *buffer = NULL;
    slv_result result =
        slv_alloc(&ptx->env, ptx->name, 8 + PTX_FACE_INFO_SIZE + ptx->pixel_size, 1, &buffer);
    while (!result && position < end) {
        /* files from before edits had a recorded size are scanned to their end, whatever is there
         */
        if (open_ended && end - position < PTX_EDIT_HEADER_SIZE)
            break;
        if ((result = ptx_read_bytes(&ptx->env, ptx, "edit", position, sizeof header, header)))
            break;
        uint32_t size = ptx_get_u32(header + 1);
        position += PTX_EDIT_HEADER_SIZE;
        if (!size)
            break;
        if (position > end || size > end - position) {
            result = slv_fail(&ptx->env, SLV_ERROR_FORMAT,
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
    }
    free(buffer);
    return result;
}
