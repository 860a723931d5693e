/* From a .ptx back to UV images: bands of rows, each pixel looked up where its middle lies on the
 * surface, on over the edges of islands, and the rest filled from what is nearest. */
#include "source/holes.h"
#include "uv/corners.h"
#include "uv/face_normals.h"
#include "uv/multiplied.h"
#include "uv/raster.h"
#include "uv/tangents.h"
#include "uv/tiles.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <selvage/image.h>
#include <selvage/wrap.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define REACH 2.0f /* pixels around an island that are looked up across the seam */
#define CACHE_BYTES (UINT64_C(256) << 20)
enum { BAND_ROWS = 32, NAME_ROOM = 4096, MOST_SHIFTS = 16 };

typedef struct unbake {
    const slv_unbake_params *params;
    slv_env env;
    const slv_ptx *ptx;
    slv_adjacency *adjacency;
    slv_texture_encoding encoding;
    float *corners;
    uint32_t nfaces, nchannels;
    int32_t alpha;
    const slv_mesh_face *mesh_faces;
    slvi_tangents *tangents; /* NULL: values are no normals */
    slv_surface *surface;
    slv_cache *cache;
    slv_file_id file;
    slvi_steps steps;
    bool udim;
    /* the image in the making */
    int32_t cell[2];
    slv_image image;
    uint8_t *missing;
    uint32_t nbands;
    uint32_t *first; /* of each band, and one past the last: in `faces` */
    uint32_t *faces; /* ascending in a band */
    pthread_mutex_t lock;
    slv_unbake_report *report;
} unbake;

/* ---- which faces come near which band ---- */

/* Rows of the image that a face comes near, in bands; false if none. A single image shows faces of
 * all cells, as those who repeat it do. */
static bool bands_of(const unbake *b, uint32_t face, int32_t shift, uint32_t *first,
                     uint32_t *last) {
    const float *c = b->corners + 8 * (size_t)face;
    float low = fminf(fminf(c[1], c[3]), fminf(c[5], c[7])),
          high = fmaxf(fmaxf(c[1], c[3]), fmaxf(c[5], c[7]));
    double top = ((double)b->cell[1] + shift + 1 - (double)high) * b->image.height - 3,
           bottom = ((double)b->cell[1] + shift + 1 - (double)low) * b->image.height + 3;
    if (bottom < 0 || top >= b->image.height)
        return false;
    *first = (uint32_t)fmax(top, 0) / BAND_ROWS;
    *last = (uint32_t)fmin(bottom, (double)b->image.height - 1) / BAND_ROWS;
    return true;
}

static void shifts_of(const unbake *b, uint32_t face, int axis, int32_t *first, int32_t *last) {
    const float *c = b->corners + 8 * (size_t)face + axis;
    *first = *last = 0;
    if (b->udim)
        return;
    *first = (int32_t)floorf(fminf(fminf(c[0], c[2]), fminf(c[4], c[6])));
    *last = (int32_t)floorf(fmaxf(fmaxf(c[0], c[2]), fmaxf(c[4], c[6])));
    *last = *last - *first > MOST_SHIFTS ? *first + MOST_SHIFTS : *last;
}

static slv_result sort_faces(unbake *b) {
    slv_result result =
        slvi_alloc(&b->env, "UV image: bands", b->nbands + 1, sizeof *b->first, &b->first);
    for (int pass = 0; pass < 2 && !result; pass++) {
        for (uint32_t face = 0; face < b->nfaces; face++) {
            int32_t low, high;
            uint32_t first, last;
            if (isnan(b->corners[8 * (size_t)face]))
                continue;
            shifts_of(b, face, 1, &low, &high);
            for (int32_t shift = low; shift <= high; shift++) {
                if (!bands_of(b, face, shift, &first, &last))
                    continue;
                for (uint32_t k = first; k <= last; k++)
                    if (pass)
                        b->faces[b->first[k]++] = face;
                    else
                        b->first[k]++;
            }
        }
        uint32_t sum = 0;
        for (uint32_t k = 0; !pass && k <= b->nbands; k++) {
            uint32_t count = b->first[k];
            b->first[k] = sum;
            sum += count;
        }
        if (!pass)
            result = slvi_alloc_plain(&b->env, "UV image: bands", sum, sizeof *b->faces, &b->faces);
    }
    for (uint32_t k = b->nbands; k > 0 && !result; k--)
        b->first[k] = b->first[k - 1];
    if (!result)
        b->first[0] = 0;
    return result;
}

static uint64_t draw_face(const unbake *b, const uv_band *band, uint32_t face) {
    int32_t u0, u1, v0, v1;
    uint64_t shared = 0;
    shifts_of(b, face, 0, &u0, &u1);
    shifts_of(b, face, 1, &v0, &v1);
    for (int32_t v = v0; v <= v1; v++)
        for (int32_t u = u0; u <= u1; u++) {
            uv_band moved = *band;
            moved.u += u;
            moved.v += v;
            shared += slvi_uv_draw(&moved, (int32_t)face, b->corners + 8 * (size_t)face, REACH);
        }
    return shared;
}

/* ---- values ---- */

/* Over the edge that a place lies beyond, to the neighbour, where there is one. */
static void cross_edge(const unbake *b, slv_lookup *l) {
    unsigned edge = l->v < 0 ? 0 : l->u > 1 ? 1 : l->v > 1 ? 2 : 3;
    slv_neighbour next[2];
    if (l->u >= 0 && l->u <= 1 && l->v >= 0 && l->v <= 1)
        return;
    float along = edge == 0 ? l->u : edge == 1 ? l->v : edge == 2 ? 1 - l->u : 1 - l->v;
    uint32_t count = slv_adjacency_neighbours(b->adjacency, (int32_t)l->face, edge, next);
    for (uint32_t i = 0; i < count; i++) {
        const slv_affine *m = &next[i].map;
        if (along < next[i].t0 || along > next[i].t1)
            continue;
        slv_affine linear = *m;
        linear.u0 = linear.v0 = 0;
        slv_affine_apply(m, l->u, l->v, &l->u, &l->v);
        slv_affine_apply(&linear, l->uw1, l->vw1, &l->uw1, &l->vw1);
        slv_affine_apply(&linear, l->uw2, l->vw2, &l->uw2, &l->vw2);
        l->face = (uint32_t)next[i].face;
        break;
    }
    l->u = fminf(fmaxf(l->u, 0), 1);
    l->v = fminf(fmaxf(l->v, 0), 1);
}

/* The normal that was found becomes what a normal map has there. */
static void to_map(const unbake *b, const uv_owner *o, float *value) {
    const float *c = b->corners + 8 * (size_t)o->face;
    float place[2];
    for (int axis = 0; axis < 2; axis++) {
        const float low = c[axis] + (c[2 + axis] - c[axis]) * o->u,
                    high = c[6 + axis] + (c[4 + axis] - c[6 + axis]) * o->u;
        place[axis] = low + (high - low) * o->v;
    }
    slvi_tangents_turn(b->tangents, b->mesh_faces[o->face].poly, place, value);
    for (int k = 0; k < 3; k++)
        value[k] = 0.5f + 0.5f * value[k];
}

static slv_result look_up(unbake *b, slv_sampler *sampler, const uv_band *band) {
    enum { AT_ONCE = 4096 };
    slv_lookup *lookups = NULL;
    float *values = NULL;
    void *workspace = NULL;
    uint32_t *places = NULL, n = b->nchannels;
    size_t count = (size_t)band->width * band->rows, at = 0;
    slv_result result;
    if ((result =
             slvi_alloc_plain(&b->env, "UV image: lookups", AT_ONCE, sizeof *lookups, &lookups)) ||
        (result = slvi_alloc_plain(&b->env, "UV image: lookups", AT_ONCE, n * sizeof *values,
                                   &values)) ||
        (result =
             slvi_alloc_plain(&b->env, "UV image: lookups", AT_ONCE, sizeof *places, &places)) ||
        (result = slvi_alloc_plain(&b->env, "UV image: lookups", slv_sample_workspace(AT_ONCE), 1,
                                   &workspace)))
        goto done;
    while (at < count && !result) {
        uint32_t used = 0;
        for (; at < count && used < AT_ONCE; at++) {
            const uv_owner *o = &band->owners[at];
            if (o->face < 0)
                continue;
            lookups[used] = (slv_lookup){b->file,  (uint32_t)o->face, o->u,     o->v,
                                         o->du[0], o->dv[0],          o->du[1], o->dv[1]};
            cross_edge(b, &lookups[used]);
            places[used++] = (uint32_t)at;
        }
        result = slv_sample_sorted(sampler, lookups, used, values, n, NULL, workspace);
        if (result)
            break;
        for (uint32_t i = 0; i < used; i++) {
            if (b->tangents)
                to_map(b, &band->owners[places[i]], values + (size_t)i * n);
            size_t pixel = (size_t)band->top * band->width + places[i];
            memcpy(b->image.pixels + pixel * n, values + (size_t)i * n, n * sizeof *values);
            b->missing[pixel] = 0;
        }
    }
done:
    slvi_free(lookups);
    slvi_free(values);
    slvi_free(places);
    slvi_free(workspace);
    return result;
}

static slv_result fill_bands(void *user, uint64_t first, uint64_t end) {
    unbake *b = user;
    const slv_filter_params filter = {.filter = b->params->filter ? b->params->filter
                                                                  : SLV_FILTER_BILINEAR};
    slv_sampler *sampler = NULL;
    slv_result result = slv_sampler_create(b->cache, &filter, &sampler);
    for (uint64_t k = first; k < end && !result; k++) {
        uv_band band = {.u = b->cell[0],
                        .v = b->cell[1],
                        .width = b->image.width,
                        .height = b->image.height,
                        .top = (uint32_t)k * BAND_ROWS};
        band.rows = band.height - band.top < BAND_ROWS ? band.height - band.top : BAND_ROWS;
        size_t count = (size_t)band.width * band.rows;
        uint64_t shared = 0, inside = 0;
        if ((result = slvi_alloc_plain(&b->env, "UV image: band", count, sizeof *band.owners,
                                       &band.owners)))
            break;
        for (size_t i = 0; i < count; i++)
            band.owners[i].face = -1;
        for (uint32_t i = b->first[k]; i < b->first[k + 1]; i++)
            if (i == b->first[k] || b->faces[i] != b->faces[i - 1])
                shared += draw_face(b, &band, b->faces[i]);
        for (size_t i = 0; i < count; i++)
            inside += band.owners[i].face >= 0 && band.owners[i].distance <= 0;
        if (!(result = look_up(b, sampler, &band)))
            result = slvi_steps_add(&b->steps, &b->env, "unbake", band.rows);
        slvi_free(band.owners);
        pthread_mutex_lock(&b->lock);
        b->report->inside += inside;
        b->report->shared += shared;
        pthread_mutex_unlock(&b->lock);
    }
    slv_sampler_destroy(sampler);
    return result;
}

/* ---- images ---- */

static slv_result save(unbake *b, const char *path) {
    const slv_ptx_info *info = slv_ptx_get_info(b->ptx);
    slv_image_params params = {.bits = b->params->bits};
    if (!params.bits && slv_image_format_of_name(path) == SLV_IMAGE_EXR)
        params.bits = info->type == SLV_TYPE_FLOAT ? 32 : 16;
    else if (!params.bits)
        params.bits = info->type == SLV_TYPE_U8 ? 8 : 16;
    params.encoding = b->encoding == SLV_TEXTURE_DATA ? SLV_ENCODE_RAW : SLV_ENCODE_SRGB;
    bool png = slv_image_format_of_name(path) == SLV_IMAGE_PNG;
    uint32_t n = b->nchannels;
    /* numbers go into a PNG as they stand, not multiplied by alpha */
    for (size_t i = 0; png && b->alpha >= 0 && params.encoding == SLV_ENCODE_RAW &&
                       i < (size_t)b->image.width * b->image.height;
         i++)
        for (uint32_t c = 0; c + 1 < n && b->image.pixels[i * n + n - 1] > 0; c++)
            b->image.pixels[i * n + c] /= b->image.pixels[i * n + n - 1];
    return slv_image_save(&b->env, path, &b->image, &params);
}

static slv_result make_image(unbake *b, const char *path) {
    uint32_t width = b->params->width, height = b->params->height;
    slv_result result = slv_image_create(&b->env, width, height, b->nchannels, &b->image);
    if (result)
        return result;
    b->nbands = (height + BAND_ROWS - 1) / BAND_ROWS;
    result = slvi_alloc_plain(&b->env, path, (uint64_t)width * height, 1, &b->missing);
    if (!result) {
        memset(b->missing, 1, (size_t)width * height);
        if (!(result = sort_faces(b)))
            result = slvi_parallel_for(&b->env, b->nbands, 1, fill_bands, b);
    }
    if (!result)
        result = slvi_holes_fill(&b->env, b->nchannels, width, height, b->missing, b->image.pixels);
    if (!result && !(result = save(b, path)))
        b->report->images++;
    slvi_free(b->missing);
    slvi_free(b->first);
    slvi_free(b->faces);
    slv_image_free(&b->image);
    b->missing = NULL;
    b->first = b->faces = NULL;
    return result;
}

/* Faces that no tile can show whole. */
static void tell_outside(const unbake *b, const char *path) {
    uint32_t count = 0, first = 0;
    for (uint32_t face = 0; face < b->nfaces; face++) {
        const float *c = b->corners + 8 * (size_t)face;
        bool outside = false;
        for (int i = 0; i < 8 && !isnan(c[0]); i++)
            outside |= c[i] < 0 || c[i] > (float)(i % 2 ? UV_CELLS_V : UV_CELLS_U);
        if (outside && !count++)
            first = face;
    }
    if (count)
        slvi_logf(
            &b->env, SLV_LOG_WARNING,
            "%s: %u faces, the first %u, lie where no tile is (u below 0 or above %d, v below "
            "0 or above %d), and are not, or not whole, in any",
            path, count, first, UV_CELLS_U, UV_CELLS_V);
}

static slv_result make_images(unbake *b, const char *path) {
    const char *mark = strstr(path, SLV_BAKE_UDIM);
    int32_t *count = NULL;
    uint32_t needed = 0;
    slv_result result = SLV_OK;
    if (!mark) {
        slvi_steps_begin(&b->steps, b->params->progress, b->params->height);
        result = make_image(b, path);
        slvi_steps_end(&b->steps);
        return result;
    }
    if ((result = slvi_uv_count_cells(&b->env, b->corners, b->nfaces, &count)))
        return result;
    for (int32_t cell = 0; cell < UV_CELLS_U * UV_CELLS_V; cell++)
        needed += count[cell] > 0;
    if (!needed)
        result = slvi_fail(&b->env, SLV_ERROR_MISMATCH,
                           "%s: no face has texture coordinates where tiles are (u 0 to 10, v from "
                           "0)",
                           path);
    if (!result)
        tell_outside(b, path);
    slvi_steps_begin(&b->steps, b->params->progress, (uint64_t)needed * b->params->height);
    for (int32_t cell = 0; !result && cell < UV_CELLS_U * UV_CELLS_V; cell++) {
        char name[NAME_ROOM];
        if (count[cell] <= 0)
            continue;
        b->cell[0] = cell % UV_CELLS_U;
        b->cell[1] = cell / UV_CELLS_U;
        result = slvi_uv_tile_name(&b->env, path, cell, name, sizeof name);
        if (!result)
            result = make_image(b, name);
    }
    slvi_steps_end(&b->steps);
    slvi_free(count);
    return result;
}

static slv_result open_texels(unbake *b) {
    const slv_cache_params params = {.max_bytes = CACHE_BYTES};
    slv_source texels, turned, light, multiplied;
    slv_result result = slv_cache_create(&b->env, &params, &b->cache);
    if (result || (result = slv_ptx_as_source(&b->env, b->ptx, &texels)))
        return result;
    if (!b->surface)
        turned = texels;
    else if ((result = slvi_uv_face_normals(&b->env, b->surface, &texels, &turned)))
        return result;
    if (!(result = slv_source_decode(&b->env, &turned, b->encoding, &light)) &&
        !(result = slvi_uv_multiplied(&b->env, &light, &multiplied)))
        result = slv_cache_open_source(b->cache, &multiplied, NULL, &b->file);
    return result;
}

/* The power of two that has about as many pixels as there are texels in the faces it shows. */
static uint32_t side_for(const unbake *b) {
    double texels = 0, area = 0;
    for (uint32_t face = 0; face < b->nfaces; face++) {
        const float *c = b->corners + 8 * (size_t)face;
        slv_ptx_face info;
        if (isnan(c[0]) || slv_ptx_get_face(b->ptx, face, &info))
            continue;
        texels += exp2(info.res.u + info.res.v);
        area += 0.5 * fabs(((double)c[4] - (double)c[0]) * ((double)c[7] - (double)c[3]) -
                           ((double)c[6] - (double)c[2]) * ((double)c[5] - (double)c[1]));
    }
    double side = area > 0 ? log2(texels / area) / 2 : 10;
    return 1u << (side > 0 ? side < 14 ? (uint32_t)lround(side) : 14 : 0);
}

static slv_result check(unbake *b, const slv_mesh *mesh, const char *path) {
    const slv_ptx_info *info = slv_ptx_get_info(b->ptx);
    if (info->mesh_type != SLV_PTX_QUAD)
        return slvi_fail(&b->env, SLV_ERROR_UNSUPPORTED,
                         "%s: is made of textures of quads, not of triangles", path);
    if (info->nchannels > 4 || (info->nchannels % 2 == 0) != (info->alpha_channel >= 0) ||
        (info->alpha_channel >= 0 && (uint32_t)info->alpha_channel != info->nchannels - 1))
        return slvi_fail(&b->env, SLV_ERROR_UNSUPPORTED,
                         "%s: images have 1 or 3 channels, and alpha behind them, but the texture "
                         "has %u%s: convert --channels takes some of them",
                         path, info->nchannels, info->alpha_channel >= 0 ? " with alpha" : "");
    if (b->params->normals &&
        (info->nchannels != 3 || info->type == SLV_TYPE_U8 || info->type == SLV_TYPE_U16 ||
         b->params->normals > SLV_UNBAKE_FACE_NORMALS))
        return slvi_fail(&b->env, SLV_ERROR_UNSUPPORTED,
                         "%s: a normal map is made of three channels of half or float, which have "
                         "a sign, but the texture has %u of %s",
                         path, info->nchannels, slv_type_name(info->type));
    if ((b->params->round_u || b->params->round_v) && (b->udim || b->params->normals))
        return slvi_fail(&b->env, SLV_ERROR_ARGUMENT,
                         "%s: coordinates that go round take one image, which repeats, no set of "
                         "tiles, and make no normal map",
                         path);
    if (slv_image_format_of_name(path) == SLV_IMAGE_NONE)
        return slvi_fail(&b->env, SLV_ERROR_ARGUMENT, "%s: images are written as .png or .exr",
                         path);
    return slv_ptx_match_mesh(&b->env, b->ptx, mesh);
}

static slv_result begin_normals(unbake *b, const slv_mesh *mesh) {
    const slv_surface_params params = {.scheme = b->params->scheme};
    slv_result result = SLV_OK;
    b->mesh_faces = slv_mesh_faces(mesh);
    if (b->params->normals)
        result = slvi_tangents_create(&b->env, mesh, &b->tangents);
    if (!result && b->params->normals == SLV_UNBAKE_FACE_NORMALS)
        result = slv_surface_create(&b->env, mesh, &params, &b->surface);
    return result;
}

static slv_result run(unbake *b, const slv_mesh *mesh, const char *path,
                      slv_unbake_params *params) {
    slv_result result = check(b, mesh, path);
    if (result || (result = slv_mesh_adjacency(&b->env, mesh, &b->adjacency)) ||
        (result = slv_mesh_round_texcoords(&b->env, mesh, params->round_u, params->round_v,
                                           &b->corners)))
        return result;
    const uv_lacking lacking = slvi_uv_check_corners(b->corners, b->nfaces);
    b->report->without = lacking.none + lacking.far;
    if (b->nfaces && b->report->without == b->nfaces)
        return slvi_fail(&b->env, SLV_ERROR_MISMATCH,
                         "%s: the mesh has no texture coordinates (vt) to draw it with", path);
    slvi_uv_warn_of_wide(&b->env, path, b->corners, b->nfaces,
                         (const bool[2]){params->round_u, params->round_v});
    if (!params->width)
        params->width = params->height = side_for(b);
    if (!params->height)
        params->height = params->width;
    b->report->width = params->width;
    b->report->height = params->height;
    if ((result = begin_normals(b, mesh)) || (result = open_texels(b)))
        return result;
    pthread_mutex_init(&b->lock, NULL);
    result = make_images(b, path);
    pthread_mutex_destroy(&b->lock);
    return result;
}

const char *slv_unbake_normals_name(slv_unbake_normals normals) {
    static const char *const names[] = {"values", "object-normal", "face-normal"};
    return (unsigned)normals <= SLV_UNBAKE_FACE_NORMALS ? names[normals] : "unknown";
}

slv_result slv_unbake(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                      const slv_unbake_params *params, const char *path,
                      slv_unbake_report *report) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_unbake_params own_params = params ? *params : (slv_unbake_params){0};
    slv_unbake_report own;
    slv_parallel_log *log = NULL;
    unbake b = {.params = &own_params,
                .ptx = ptx,
                .nfaces = info->nfaces,
                .nchannels = info->nchannels,
                .alpha = info->alpha_channel,
                .encoding = own_params.encoding,
                .udim = strstr(path, SLV_BAKE_UDIM) != NULL,
                .report = report ? report : &own};
    *b.report = (slv_unbake_report){0};
    slv_result result = slvi_parallel_env_begin(env, &log, &b.env);
    if (result)
        return result;
    if (own_params.normals)
        b.encoding = SLV_TEXTURE_DATA;
    if (!b.encoding)
        result = slv_ptx_get_encoding(ptx, &b.encoding);
    if (!result)
        result = run(&b, mesh, path, &own_params);
    slv_cache_destroy(b.cache);
    slv_surface_destroy(b.surface);
    slvi_tangents_destroy(b.tangents);
    slv_adjacency_destroy(b.adjacency);
    slvi_free(b.corners);
    slvi_parallel_env_end(log);
    return result;
}
