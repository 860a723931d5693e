/* OpenEXR files in all forms that OpenEXR's own library writes, for tests. */
#ifndef SLV_TEST_EXR_WRITER_H
#define SLV_TEST_EXR_WRITER_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct exr_form {
    int compression; /* 0 to EXR_COMPRESSIONS - 1 */
    int tile;        /* side of the tiles; 0: scanlines */
    int levels;      /* of tiles: 0 one, 1 mipmap, 2 ripmap; the others hold something else */
    int line_order;  /* 0 increasing, 1 decreasing, 2 random (of tiles) */
    int floats;      /* else half */
    int display[4], data[4]; /* windows: x and y of the first pixel, x and y of the last */
    const char *channels;    /* "RGBA", in the order of the pixels */
    const char *layer;       /* "" or "beauty." */
    int extra;               /* channels that nobody asks for beside them */
    int decoys;              /* parts before the one with the image; there is one after it, too */
} exr_form;

enum { EXR_COMPRESSIONS = 10 };
const char *exr_compression_name(int compression);
int exr_is_lossy(const exr_form *form);

/* Both return 0 if OpenEXR throws; pixels are those of the data window, in floats. */
int exr_write(const char *path, const exr_form *form, const float *pixels);
/* By OpenEXR's reader of files, all at once. */
int exr_read(const char *path, const exr_form *form, float *pixels);

enum {
    EXR_DEEP,
    EXR_DEEP_TILES,
    EXR_UINT,
    EXR_SUBSAMPLED,
    EXR_CHROMA,
    EXR_TWO_LAYERS,
    EXR_NO_COLOUR,
    EXR_ODD_COUNT
};
/* A file of one of these kinds. */
int exr_write_odd(const char *path, int kind);

#ifdef __cplusplus
}
#endif

#endif
