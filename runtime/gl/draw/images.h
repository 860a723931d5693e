/* Images by texture coordinates on the GPU, in batches of faces that one of them is on. */
#ifndef SLV_GL_DRAW_IMAGES_H
#define SLV_GL_DRAW_IMAGES_H

#include "gl/store/batches.h"

#include <selvage/gl_images.h>

/* A batch of faces with what it binds. */
typedef struct slv_gl_image_batch {
    GLuint texture;
    int32_t u, v; /* the square of texture coordinates that is drawn */
    int mode;     /* as in draw/images.glsl */
} slv_gl_image_batch;

struct slv_gl_images {
    slv_gl *gl;
    uint64_t serial, bytes;
    uint32_t nfaces, ntextures;
    GLuint *textures; /* those of no size are 0; the last is one pixel that stands for them */
    GLuint sampler, corners;
    uint8_t *srgb; /* slvi_gl_srgb_fill's while images are uploaded; NULL if none is of sRGB */
    slv_gl_batches batches;
    slv_gl_image_batch *squares; /* of each batch */
    GLint taps;    /* places of a footprint that the shader looks up, where the sampler does not */
    bool round[2]; /* u, v */
    char *lookups, *hand_on; /* GLSL, of fragments and of vertices */
};

/* What all batches share, and one of them for a program with the images' lookups. */
void slvi_gl_images_bind(const slv_gl_images *images);
void slvi_gl_images_bind_batch(const slv_gl_images *images, uint32_t batch, GLuint program);
void slvi_gl_images_unbind(const slv_gl_images *images);

#endif
