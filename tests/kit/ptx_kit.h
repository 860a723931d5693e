/* What the tests of .ptx files share. */
#ifndef SLV_PTX_KIT_H
#define SLV_PTX_KIT_H

#include "kit/remove_kit.h"
#include "kit/test.h"

#include <selvage/ptx.h>

#include <dirent.h>
#include <unistd.h>

static char ptx_kit_paths[2][1024];

/* A path in a folder of the test's own; two are valid at a time. */
static inline const char *scratch_path(const char *name) {
    static int turn;
    char *path = ptx_kit_paths[turn ^= 1];
    snprintf(path, sizeof ptx_kit_paths[0], "%s/selvage-%ld-%s", test_parent(), (long)getpid(),
             name);
    return path;
}

/* The folder of test data, or NULL. */
static inline const char *data_folder(void) {
    static char path[1024];
    const char *tests = getenv("SELVAGE_TESTS");
    snprintf(path, sizeof path, "%s/conformance/data", tests ? tests : "tests");
    return access(path, R_OK) == 0 ? path : NULL;
}

static inline uint8_t *read_whole(const char *path, size_t *size) {
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return NULL;
    fseek(stream, 0, SEEK_END);
    *size = (size_t)ftell(stream);
    rewind(stream);
    uint8_t *bytes = malloc(*size + 1);
    if (bytes && fread(bytes, 1, *size, stream) != *size) {
        free(bytes);
        bytes = NULL;
    }
    fclose(stream);
    return bytes;
}

static inline bool same_bytes(const char *a, const char *b) {
    size_t sizes[2] = {0};
    uint8_t *bytes[2] = {read_whole(a, &sizes[0]), read_whole(b, &sizes[1])};
    bool same =
        bytes[0] && bytes[1] && sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0;
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

/* Calls `visit` with every .ptx file of the test data and of the folder that SELVAGE_CONFORMANCE
 * names, with those that are in both once; in a short run every third of the second. */
static inline int each_sample(void (*visit)(const char *path)) {
    const char *folders[2] = {data_folder(), getenv("SELVAGE_CONFORMANCE")};
    int count = 0, turn = 0;
    for (int i = 0; i < 2; i++) {
        DIR *folder = folders[i] ? opendir(folders[i]) : NULL;
        struct dirent *entry;
        while (folder && (entry = readdir(folder))) {
            char path[2048], twin[2048];
            size_t length = strlen(entry->d_name);
            if (length < 4 || strcmp(entry->d_name + length - 4, ".ptx") != 0)
                continue;
            snprintf(path, sizeof path, "%s/%s", folders[i], entry->d_name);
            snprintf(twin, sizeof twin, "%s/%s", folders[0] ? folders[0] : "", entry->d_name);
            if (i == 1 && (same_bytes(path, twin) || test_skip((uint32_t)turn++, 3)))
                continue;
            visit(path);
            count++;
        }
        if (folder)
            closedir(folder);
    }
    return count;
}

/* A file in memory as a source. */
struct memory_file {
    const uint8_t *bytes;
    uint64_t size;
    int closed;
};

static inline int memory_read(void *user, uint64_t offset, void *buffer, size_t size) {
    const struct memory_file *file = user;
    if (offset > file->size || size > file->size - offset)
        return -1;
    memcpy(buffer, file->bytes + offset, size);
    return 0;
}

static inline void memory_close(void *user) {
    ((struct memory_file *)user)->closed++;
}

/* A grid of columns x rows quads over the unit square; where `pentagon`, the last face is a
 * pentagon. */
static inline slv_mesh *grid_mesh(uint32_t columns, uint32_t rows, bool pentagon) {
    uint32_t nverts = (columns + 1) * (rows + 1) + pentagon, npolys = columns * rows;
    float *positions = calloc(nverts, 3 * sizeof(float));
    int32_t *sizes = calloc(npolys, sizeof(int32_t)),
            *verts = calloc(npolys * 4 + 1, sizeof(int32_t));
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    for (uint32_t y = 0; y <= rows; y++)
        for (uint32_t x = 0; x <= columns; x++) {
            positions[3 * (y * (columns + 1) + x)] = (float)x / (float)columns;
            positions[3 * (y * (columns + 1) + x) + 1] = (float)y / (float)rows;
        }
    for (uint32_t i = 0; i < npolys; i++) {
        int32_t corner = (int32_t)(i / columns * (columns + 1) + i % columns);
        int32_t above = corner + (int32_t)columns + 1;
        int32_t quad[4] = {corner, corner + 1, above + 1, above};
        memcpy(verts + 4 * i, quad, sizeof quad);
        sizes[i] = 4;
    }
    if (pentagon) {
        positions[3 * (nverts - 1)] = positions[3 * (nverts - 1) + 1] = 1.5f;
        verts[4 * npolys] = verts[4 * npolys - 1];
        verts[4 * npolys - 1] = (int32_t)nverts - 1;
        sizes[npolys - 1] = 5;
    }
    slv_mesh_view view = {.nverts = nverts,
                          .positions = positions,
                          .npolys = npolys,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    free(positions);
    free(sizes);
    free(verts);
    return mesh;
}

#endif
