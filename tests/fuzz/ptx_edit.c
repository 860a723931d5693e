/* Edits appended to a .ptx of any bytes: the file stays as it was, or has them. */
#include "kit/fuzz_kit.h"

static bool same_as_file(const char *name, const uint8_t *data, size_t size) {
    FILE *stream = fopen(fuzz_path(name), "rb");
    FUZZ_REQUIRE(stream, "%s is gone", name);
    uint8_t *bytes = malloc(size + 1);
    bool same = bytes && fread(bytes, 1, size + 1, stream) == size &&
                (!size || memcmp(bytes, data, size) == 0);
    free(bytes);
    fclose(stream);
    return same;
}

/* A face, a constant face or metadata, as the control says. */
static slv_result change(slv_ptx_writer *writer, const slv_ptx_info *info, uint32_t control,
                         uint32_t *edited) {
    uint32_t face = info->nfaces ? (control >> 8) % info->nfaces : 0;
    bool triangle = info->mesh_type == SLV_PTX_TRIANGLE;
    int8_t u = control >> 4 & 3, v = triangle ? u : (int8_t)(control >> 6 & 3);
    size_t pixel = slv_type_size(info->type) * info->nchannels;
    slv_ptx_face f = {.res = {u, v}, .adjacency = {{-1, -1, -1, -1}, {0, 0, 0, 0}}};
    slv_ptx_meta meta = {.key = "fuzz", .type = SLV_META_STRING, .count = 4, .values = "cafe"};
    slv_result result = SLV_OK;
    *edited = UINT32_MAX;
    if (control & 1) {
        uint8_t *texels = calloc(pixel, (size_t)1 << (u + v));
        FUZZ_REQUIRE(texels, "no memory");
        texels[0] = (uint8_t)control;
        if (control & 2)
            f.flags = SLV_FACE_CONSTANT;
        result = FUZZ_CALL(slv_ptx_writer_write_face(writer, face, &f, texels));
        free(texels);
        if (!result)
            *edited = face;
    }
    if (!result && (control & 4 || !(control & 1)))
        result = FUZZ_CALL(slv_ptx_writer_set_meta(writer, &meta));
    return result;
}

static void look_again(const slv_env *env, uint32_t edited, uint32_t control) {
    slv_ptx *ptx = NULL;
    slv_ptx_face face;
    FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_open(env, fuzz_path("in.ptx"), &ptx)),
                 "cannot be opened after an edit: %s", fuzz_last);
    FUZZ_REQUIRE(slv_ptx_get_info(ptx)->has_edits, "no edits");
    if (control & 4 || !(control & 1)) {
        const slv_ptx_meta *meta = slv_ptx_find_meta(ptx, "fuzz");
        FUZZ_REQUIRE(meta && meta->count == 4 && memcmp(meta->values, "cafe", 4) == 0,
                     "the new metadata is not there");
    }
    /* damaged tables stay damaged */
    if (edited != UINT32_MAX && !FUZZ_CALL(slv_ptx_load_tables(ptx)) &&
        !FUZZ_CALL(slv_ptx_get_face(ptx, edited, &face))) {
        size_t pixel =
            slv_type_size(slv_ptx_get_info(ptx)->type) * slv_ptx_get_info(ptx)->nchannels;
        uint8_t *texels = malloc(pixel << (face.res.u + face.res.v));
        FUZZ_REQUIRE(texels && face.flags & SLV_FACE_EDITED, "face %u is not edited", edited);
        FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_read_face(ptx, edited, face.res, texels)) &&
                         texels[0] == (uint8_t)control,
                     "face %u does not have its new texels: %s", edited, fuzz_last);
        free(texels);
    }
    slv_ptx_close(ptx);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint32_t control = fuzz_control(data, &size), edited;
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes = {data, size};
    slv_ptx_writer *writer = NULL;
    slv_ptx *before = fuzz_open(&env, &bytes, false);
    fuzz_write("in.ptx", data, size);
    if (!FUZZ_CALL(slv_ptx_writer_edit(&env, fuzz_path("in.ptx"), NULL, &writer)) &&
        !change(writer, slv_ptx_get_info(before), control, &edited) && control & 8 &&
        !FUZZ_CALL(slv_ptx_writer_finish(writer))) {
        slv_ptx_writer_destroy(writer);
        look_again(&env, edited, control);
    } else {
        slv_ptx_writer_destroy(writer);
        FUZZ_REQUIRE(same_as_file("in.ptx", data, size), "an edit that failed left its traces");
    }
    slv_ptx_close(before);
    fuzz_clear(1);
    return 0;
}
