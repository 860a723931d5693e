/* Edits appended to a file, and files written again without them. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

#include <sys/stat.h>

#define NFACES 6

static const char *make_file(const char *name, bool with_meta) {
    slv_env env = test_env();
    const char *path = scratch_path(name);
    slv_ptx_writer_params p = {
        .mesh_type = SLV_PTX_QUAD, .nchannels = 3, .alpha_channel = SLV_NO_ALPHA, .nfaces = NFACES};
    slv_ptx_writer *writer = NULL;
    uint8_t texels[256 * 3];
    for (int i = 0; i < 256 * 3; i++)
        texels[i] = (uint8_t)(i / 3);
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_OK);
    for (uint32_t face = 0; face < NFACES; face++) {
        slv_ptx_face info = {.res = {4, 4}, .adjacency.face = {-1, -1, -1, -1}};
        texels[0] = (uint8_t)face;
        REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
    }
    slv_ptx_meta meta = {"note", SLV_META_STRING, 3, "old"};
    if (with_meta)
        REQUIRE(slv_ptx_writer_set_meta(writer, &meta) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    return path;
}

/* Gives face `face` 4x2 texels that begin with `value`; with `note`, one constant face and metadata
 * too. */
static slv_ptx_writer *edit(const char *path, uint32_t face, uint8_t value, const char *note) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    uint8_t texels[24] = {value, 1, 2};
    slv_ptx_face info = {.res = {2, 1}, .adjacency.face = {-1, 1, -1, -1}};
    REQUIRE(slv_ptx_writer_edit(&env, path, NULL, &writer) == SLV_OK);
    REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
    if (note) {
        float large[500] = {1.5f};
        slv_ptx_meta meta = {"note", SLV_META_STRING, (uint32_t)strlen(note), note};
        REQUIRE(slv_ptx_writer_set_meta(writer, &meta) == SLV_OK);
        meta = (slv_ptx_meta){"large", SLV_META_FLOAT, 500, large};
        REQUIRE(slv_ptx_writer_set_meta(writer, &meta) == SLV_OK);
        memset(texels, value, sizeof texels);
        REQUIRE(slv_ptx_writer_write_face(writer, 5, &info, texels) == SLV_OK);
    }
    return writer;
}

static void finish(slv_ptx_writer *writer) {
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
}

static uint8_t first_byte(const slv_ptx *ptx, uint32_t face) {
    uint8_t texels[256 * 3];
    slv_ptx_face f;
    REQUIRE(slv_ptx_get_face(ptx, face, &f) == SLV_OK);
    REQUIRE(slv_ptx_read_face(ptx, face, f.res, texels) == SLV_OK);
    return texels[0];
}

static void check_edited(const slv_ptx *ptx, int flag) {
    slv_ptx_face face;
    REQUIRE(slv_ptx_get_face(ptx, 2, &face) == SLV_OK);
    CHECK(face.res.u == 2 && face.res.v == 1 && face.flags == flag && face.adjacency.face[1] == 1);
    CHECK(first_byte(ptx, 2) == 91 && first_byte(ptx, 3) == 93 && first_byte(ptx, 1) == 1);
    REQUIRE(slv_ptx_get_face(ptx, 5, &face) == SLV_OK);
    CHECK((face.flags & SLV_FACE_CONSTANT) && first_byte(ptx, 5) == 91);
    const slv_ptx_meta *meta = slv_ptx_find_meta(ptx, "note");
    CHECK(meta && !strcmp(meta->values, "new"));
    meta = slv_ptx_find_meta(ptx, "large");
    CHECK(meta && meta->count == 500 && ((const float *)meta->values)[0] == 1.5f);
    slv_res one = {0, 0};
    uint8_t average[3];
    REQUIRE(slv_ptx_read_face(ptx, 2, one, average) == SLV_OK);
    CHECK(average[0] == 91 / 8 && average[1] == 0);
}

static void sessions(bool with_meta) {
    slv_env env = test_env();
    const char *path = make_file("edit.ptx", with_meta), *clean = scratch_path("clean.ptx");
    slv_ptx *ptx = NULL, *before = NULL;
    slv_ptx_writer *second = NULL;
    REQUIRE(slv_ptx_open(&env, path, &before) == SLV_OK);
    slv_ptx_writer *writer = edit(path, 2, 90, NULL);
    CHECK(slv_ptx_writer_edit(&env, path, NULL, &second) == SLV_ERROR_IO && !second);
    CHECK(strstr(test_last_log, "edited already"));
    slv_ptx_writer_destroy(writer); /* abandoned */
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(!slv_ptx_get_info(ptx)->has_edits);
    slv_ptx_close(ptx);
    finish(edit(path, 2, 90, NULL));
    finish(edit(path, 2, 91, "new"));
    finish(edit(path, 3, 93, NULL));
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(slv_ptx_get_info(ptx)->has_edits);
    check_edited(ptx, SLV_FACE_EDITED);
    CHECK(first_byte(before, 2) == 2); /* who had it open sees what was there */
    slv_ptx_close(before);
    REQUIRE(slv_ptx_rewrite(&env, ptx, clean, NULL) == SLV_OK);
    REQUIRE(slv_ptx_rewrite(&env, ptx, path, NULL) == SLV_OK);
    check_edited(ptx, SLV_FACE_EDITED);
    slv_ptx_close(ptx);
    for (int i = 0; i < 2; i++) {
        REQUIRE(slv_ptx_open(&env, i ? path : clean, &ptx) == SLV_OK);
        CHECK(!slv_ptx_get_info(ptx)->has_edits && slv_ptx_get_info(ptx)->nlevels == 3);
        check_edited(ptx, 0);
        slv_ptx_close(ptx);
    }
    remove(path);
    remove(clean);
}

/* Whatever of an edit was written before its editor died: the file as it was, or, once the header
 * says so, the edit. And the next edit works. */
static void torn(void) {
    slv_env env = test_env();
    const char *path = make_file("torn.ptx", true);
    size_t old_size = 0, new_size = 0;
    uint8_t *old = read_whole(path, &old_size);
    finish(edit(path, 2, 77, "x"));
    uint8_t *new = read_whole(path, &new_size);
    REQUIRE(old && new &&new_size > old_size);
    for (size_t end = old_size; end <= new_size; end++) {
        FILE *stream = fopen(path, "wb");
        REQUIRE(stream && fwrite(old, 1, old_size, stream) == old_size &&
                fwrite(new + old_size, 1, end - old_size, stream) == end - old_size);
        fclose(stream);
        slv_ptx *ptx = NULL;
        REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
        CHECK(!slv_ptx_get_info(ptx)->has_edits && first_byte(ptx, 2) == 2);
        slv_ptx_close(ptx);
        if (end % 50)
            continue;
        finish(edit(path, 1, 78, NULL));
        REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
        CHECK(slv_ptx_get_info(ptx)->has_edits && first_byte(ptx, 2) == 2 &&
              first_byte(ptx, 1) == 78);
        slv_ptx_close(ptx);
    }
    /* a file from before edits had a recorded size */
    memset(old + 88, 0, 16);
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream && fwrite(old, 1, old_size, stream) == old_size);
    fclose(stream);
    finish(edit(path, 1, 79, NULL));
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    CHECK(first_byte(ptx, 1) == 79);
    slv_ptx_close(ptx);
    free(old);
    free(new);
    remove(path);
}

static void replaced(void) {
    slv_env env = test_env();
    const char *path = make_file("replaced.ptx", true);
    slv_ptx_writer *writer = edit(path, 2, 90, NULL);
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_rewrite(&env, ptx, path, NULL) == SLV_OK);
    slv_ptx_close(ptx);
    CHECK(slv_ptx_writer_finish(writer) == SLV_ERROR_IO);
    CHECK(strstr(test_last_log, "replaced"));
    slv_ptx_writer_destroy(writer);
    CHECK(slv_ptx_writer_edit(&env, "/nowhere/x.ptx", NULL, &writer) == SLV_ERROR_IO);
    remove(path);
}

int main(void) {
    sessions(true);
    sessions(false);
    torn();
    replaced();
    return test_end();
}
