/* Pictures to hold others against, and which pixels lie at seams. */
#include "command/output.h"
#include "compare/engine/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FACTOR = EXPERIMENT_SUPERSAMPLING,
    SUPPORT = 2, /* pixels to each side */
    TAPS = 2 * SUPPORT * FACTOR,
    TILE = 192
};

static double weight_at(int tap) {
    return slv_pixel_filter_weight(SLV_PIXEL_MITCHELL, (tap + 0.5) / FACTOR - SUPPORT);
}

static void make_weights(float weights[TAPS]) {
    double sum = 0;
    for (int k = 0; k < TAPS; k++)
        sum += weight_at(k);
    for (int k = 0; k < TAPS; k++)
        weights[k] = (float)(weight_at(k) / sum);
}

/* A large picture with a margin of SUPPORT pixels, filtered down; the taps of a pixel begin half a
 * pixel after those of the margin. */
static slv_result filter_down(const slv_env *env, const slv_image *large, const float *weights,
                              slv_image *out, uint32_t left, uint32_t top, uint32_t width,
                              uint32_t height) {
    slv_image across = {0};
    slv_result result = slv_image_create(env, width, large->height, 4, &across);
    for (uint32_t y = 0; y < large->height && !result; y++) {
        for (uint32_t x = 0; x < width; x++) {
            const float *from =
                large->pixels + 4 * ((size_t)y * large->width + x * FACTOR + FACTOR / 2);
            float sum[4] = {0};
            for (int k = 0; k < TAPS; k++)
                for (int c = 0; c < 4; c++)
                    sum[c] += weights[k] * from[4 * k + c];
            memcpy(across.pixels + 4 * ((size_t)y * width + x), sum, sizeof sum);
        }
    }
    for (uint32_t y = 0; y < height && !result; y++) {
        for (uint32_t x = 0; x < width; x++) {
            const float *from = across.pixels + 4 * ((size_t)(y * FACTOR + FACTOR / 2) * width + x);
            float sum[4] = {0};
            for (int k = 0; k < TAPS; k++)
                for (int c = 0; c < 4; c++)
                    sum[c] += weights[k] * from[4 * (size_t)k * width + (size_t)c];
            memcpy(out->pixels + 4 * ((size_t)(top + y) * out->width + left + x), sum, sizeof sum);
        }
    }
    slv_image_free(&across);
    return result;
}

/* Tile by tile, since the whole would be 64 times the size. */
static slv_result supersample(experiment *e, const slv_frame *frame, slv_image *image) {
    float weights[TAPS];
    slv_result result = experiment_aim(e, &frame->camera);
    if (result || (result = slv_image_create(e->env, frame->width, frame->height, 4, image)))
        return result;
    make_weights(weights);
    for (uint32_t top = 0; top < frame->height && !result; top += TILE) {
        for (uint32_t left = 0; left < frame->width && !result; left += TILE) {
            uint32_t width = frame->width - left < TILE ? frame->width - left : TILE;
            uint32_t height = frame->height - top < TILE ? frame->height - top : TILE;
            double w = frame->width, h = frame->height;
            slv_frame part = *frame;
            slv_image large = {0};
            part.strategy = report_supersampled_with();
            part.msaa = 1;
            part.width = (width + 2 * SUPPORT) * FACTOR;
            part.height = (height + 2 * SUPPORT) * FACTOR;
            part.camera = orbit_part(&frame->camera, ((double)left - SUPPORT) / w,
                                     ((double)top - SUPPORT) / h, (left + width + SUPPORT) / w,
                                     (top + height + SUPPORT) / h);
            result = slv_gl_renderer_draw(e->renderer, e->env, e->texture, &part, &large, NULL);
            if (!result)
                result = filter_down(e->env, &large, weights, image, left, top, width, height);
            slv_image_free(&large);
            if (!result)
                result = experiment_ask(e);
        }
    }
    return result;
}

/* A ray-cast picture under way. */
typedef struct cast {
    const experiment *e;
    bool cancelled;
} cast;

/* A cancellation is told of by whoever wanted it. */
static void log_unless_cancelled(void *user, slv_log_level level, const char *message) {
    const cast *c = user;
    const slv_env *env = c->e->env;
    if (!c->cancelled && env->log)
        env->log(env->log_user, level, message);
}

static bool go_on(void *user, uint64_t done, uint64_t total) {
    cast *c = user;
    (void)done;
    (void)total;
    c->cancelled |= experiment_ask(c->e) != SLV_OK;
    return !c->cancelled;
}

/* Of the texture, or of images if they are not NULL. */
static slv_result need_reference(experiment *e, const slv_camera *camera,
                                 const slv_uv_images *images) {
    const slv_tessellation_params surface = experiment_tessellation(e->report, e->scene, camera);
    const slv_reference_params params = {.tessellation = &surface,
                                         .encoding = e->encoding,
                                         .alpha = e->scene->alpha,
                                         .border_u = e->scene->border_u,
                                         .border_v = e->scene->border_v,
                                         .edge_filter = e->scene->edge_filter,
                                         .images = images};
    slv_reference **reference = images ? &e->map_reference : &e->reference;
    bool *aimed = images ? &e->map_aimed : &e->reference_aimed;
    slv_result result = experiment_aim(e, camera);
    if (result || (*reference && (surface.segments || *aimed)))
        return result;
    result = *reference ? slv_reference_tessellate(*reference, e->env, e->scene->mesh,
                                                   e->scene->surface, &surface)
                        : slv_reference_create(e->env, e->scene->mesh, e->scene->surface,
                                               images ? NULL : e->scene->texture,
                                               e->scene->adjacency, &params, reference);
    *aimed = !result;
    return result;
}

static slv_result cast_rays(experiment *e, const slv_reference *reference, slv_pixel_filter filter,
                            const slv_frame *frame, slv_image *image, double *estimate) {
    slv_reference_stats stats = {0};
    cast watched = {.e = e};
    const slv_reference_frame picture = {.camera = frame->camera,
                                         .width = frame->width,
                                         .height = frame->height,
                                         .shading = frame->shading,
                                         .ka = frame->ka,
                                         .kd = frame->kd,
                                         .filter = filter,
                                         .samples = e->report->reference.samples,
                                         .progress = {go_on, &watched}};
    slv_env env = *e->env;
    env.log = log_unless_cancelled;
    env.log_user = &watched;
    slv_result result = slv_reference_render(reference, &env, &picture, image, NULL, &stats);
    *estimate = stats.error;
    return result;
}

slv_result experiment_reference(experiment *e, report_source source, const slv_frame *frame,
                                slv_image *image, double *estimate) {
    *estimate = NAN;
    if (source == REPORT_SUPERSAMPLED)
        return supersample(e, frame, image);
    slv_result result = need_reference(e, &frame->camera, NULL);
    return result ? result
                  : cast_rays(e, e->reference,
                              source == REPORT_MITCHELL ? SLV_PIXEL_MITCHELL : SLV_PIXEL_BOX, frame,
                              image, estimate);
}

slv_result experiment_map_reference(experiment *e, const slv_uv_images *images,
                                    const slv_frame *frame, slv_image *image, double *estimate) {
    slv_result result = need_reference(e, &frame->camera, images);
    return result ? result : cast_rays(e, e->map_reference, SLV_PIXEL_BOX, frame, image, estimate);
}

/* How far the lookup of a hit reaches in u and v: half of the footprint, and half a texel of the
 * coarser of the two levels that it would blend. */
static void find_reach(const slv_reference_hit *hit, slv_res res, uint32_t anisotropy,
                       double reach[2]) {
    double width = ldexp(1, res.u), height = ldexp(1, res.v), longest, shortest;
    double a = hypot((double)hit->du[0] * width, (double)hit->dv[0] * height);
    double b = hypot((double)hit->du[1] * width, (double)hit->dv[1] * height);
    longest = fmax(a, b);
    shortest = fmax(fmin(a, b), longest / (anisotropy ? anisotropy : 1));
    double texel = shortest > 1 ? exp2(ceil(log2(shortest))) : 1;
    reach[0] = (fabs((double)hit->du[0]) + fabs((double)hit->du[1]) + texel / width) / 2;
    reach[1] = (fabs((double)hit->dv[0]) + fabs((double)hit->dv[1]) + texel / height) / 2;
}

static report_label corner_label(const slv_adjacency *adjacency, int32_t face, unsigned corner) {
    slv_ring ring = slv_adjacency_ring(adjacency, face, corner, NULL);
    if (ring.count == 1)
        return REPORT_INTERIOR;
    if (slv_adjacency_is_t_corner(adjacency, face, corner))
        return REPORT_REGULAR;
    return ring.count == (ring.closed ? 4 : 2) ? REPORT_REGULAR : REPORT_EXTRAORDINARY;
}

void experiment_reaches(const experiment *e, const slv_reference_hit *hit, bool over[4]) {
    double reach[2];
    find_reach(hit, slv_texture_get_desc(e->scene->texture)->res[hit->face], e->report->anisotropy,
               reach);
    over[0] = (double)hit->v < reach[1];
    over[1] = 1 - (double)hit->u < reach[0];
    over[2] = 1 - (double)hit->v < reach[1];
    over[3] = (double)hit->u < reach[0];
}

uint8_t experiment_seam_label(const experiment *e, const slv_reference_hit *hit) {
    const slv_adjacency *adjacency = e->scene->adjacency;
    const slv_face_adjacency *meets = &slv_adjacency_faces(adjacency)[hit->face];
    report_label label = REPORT_INTERIOR;
    bool over[4];
    experiment_reaches(e, hit, over);
    for (unsigned k = 0; k < 4; k++) {
        report_label one = over[k] && meets->face[k] >= 0 ? REPORT_EDGE : REPORT_INTERIOR;
        if (over[k] && over[(k + 3) % 4]) {
            report_label corner = corner_label(adjacency, hit->face, k);
            one = corner > one ? corner : one;
        }
        label = one > label ? one : label;
    }
    return (uint8_t)label;
}

/* Whether what the pixel's corners see is off the plane that its middle sees. */
static bool is_outline(const slv_reference_hit *hit, const slv_reference_hit *corners,
                       uint32_t stride, double pixel) {
    double slack = 2 * pixel + 0.25 * (fabs((double)hit->ddepth[0]) + fabs((double)hit->ddepth[1]));
    for (uint32_t k = 0; k < 4; k++) {
        const slv_reference_hit *corner = corners + (k >> 1) * stride + (k & 1);
        double expected = (double)hit->depth + (k & 1 ? 0.5 : -0.5) * (double)hit->ddepth[0] +
                          (k >> 1 ? 0.5 : -0.5) * (double)hit->ddepth[1];
        if (corner->face < 0 || fabs((double)corner->depth - expected) > slack)
            return true;
    }
    return false;
}

slv_result experiment_classify(experiment *e, const slv_frame *frame, experiment_label_fn label,
                               uint8_t **labels) {
    uint32_t width = frame->width, height = frame->height;
    slv_reference_hit *hits = calloc((size_t)width * height, sizeof *hits);
    slv_reference_hit *corners = calloc((size_t)(width + 1) * (height + 1), sizeof *corners);
    slv_camera between =
        orbit_part(&frame->camera, -0.5 / width, -0.5 / height, 1 + 0.5 / width, 1 + 0.5 / height);
    const float *window = frame->camera.window;
    slv_result result;
    *labels = malloc((size_t)width * height);
    if (!hits || !corners || !*labels) {
        result = output_fail(e->env, SLV_ERROR_MEMORY, "no memory for %u x %u pixels' labels",
                             width, height);
        goto done;
    }
    if ((result = need_reference(e, &frame->camera, NULL)) ||
        (result = slv_reference_trace(e->reference, e->env, &frame->camera, width, height, hits)) ||
        (result =
             slv_reference_trace(e->reference, e->env, &between, width + 1, height + 1, corners)))
        goto done;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            const slv_reference_hit *hit = hits + (size_t)y * width + x;
            double pixel = (double)(window[1] - window[0]) / width *
                           (frame->camera.perspective ? (double)hit->depth : 1);
            bool outline = hit->face < 0 ||
                           is_outline(hit, corners + (size_t)y * (width + 1) + x, width + 1, pixel);
            (*labels)[(size_t)y * width + x] = outline ? REPORT_OUTLINE : label(e, hit);
        }
    }
done:
    free(hits);
    free(corners);
    if (result) {
        free(*labels);
        *labels = NULL;
    }
    return result;
}
