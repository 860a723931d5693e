/* A tiny path tracer: lookups in a texture in memory, with footprints from ray differentials.
 *
 *   cc trace.c $(pkg-config --cflags --libs selvage) -lm -o trace
 *   ./trace cube.obj trace.png
 *
 * A mesh's limit surface under a white sky, checked; light bounces off it up to twice. */
#include <selvage/filter.h>
#include <selvage/half.h>
#include <selvage/image.h>
#include <selvage/tessellation.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 128, SAMPLES = 4, BOUNCES = 3, SEGMENTS = 8, LOG2 = 6 };

typedef struct scene {
    slv_surface *surface;
    slv_tessellation grid;
    float (*boxes)[2][3]; /* of each face */
    slv_sampler *sampler;
    slv_file_id file;
    uint32_t random;
} scene;

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void cross(const float a[3], const float b[3], float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}
static float uniform(scene *s) { /* 0..1, without end (Marsaglia 2003) */
    s->random ^= s->random << 13;
    s->random ^= s->random >> 17;
    s->random ^= s->random << 5;
    return (float)(s->random >> 8) / 16777216;
}

static bool meets_box(const float box[2][3], const slv_ray_differential *ray, float nearest) {
    float enter = 0, leave = nearest;
    for (int c = 0; c < 3; c++) {
        float a = (box[0][c] - ray->origin[c]) / ray->direction[c];
        float b = (box[1][c] - ray->origin[c]) / ray->direction[c];
        enter = fmaxf(enter, fminf(a, b));
        leave = fminf(leave, fmaxf(a, b));
    }
    return enter <= leave;
}

/* The first triangle along a ray (Moeller and Trumbore 1997), and where on its face that is. */
static bool find_hit(const scene *s, const slv_ray_differential *ray, float *distance,
                     slv_surface_point *at) {
    uint32_t indices[6 * SEGMENTS * SEGMENTS];
    *distance = FLT_MAX;
    for (uint32_t f = 0; f < s->grid.nfaces; f++) {
        if (!meets_box((const float(*)[3])s->boxes[f], ray, *distance))
            continue;
        uint32_t count = slv_tessellation_indices(&s->grid, f, indices);
        for (uint32_t i = 0; i < count; i += 3) {
            const slv_vertex *v[3];
            float e1[3], e2[3], from[3], p[3], q[3], weights[3], uv[2] = {0, 0};
            for (int k = 0; k < 3; k++)
                v[k] = &s->grid.vertices[indices[i + k]];
            for (int c = 0; c < 3; c++) {
                e1[c] = v[1]->position[c] - v[0]->position[c];
                e2[c] = v[2]->position[c] - v[0]->position[c];
                from[c] = ray->origin[c] - v[0]->position[c];
            }
            cross(ray->direction, e2, p);
            cross(from, e1, q);
            float volume = dot(e1, p), t = dot(e2, q) / volume;
            weights[1] = dot(from, p) / volume;
            weights[2] = dot(ray->direction, q) / volume;
            weights[0] = 1 - weights[1] - weights[2];
            if (!(weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0) ||
                !(t > 1e-4f && t < *distance))
                continue;
            for (int k = 0; k < 3; k++)
                for (int c = 0; c < 2; c++)
                    uv[c] += weights[k] * slv_half_to_float(v[k]->uv[c]);
            *distance = t;
            *at = (slv_surface_point){(int32_t)f, uv[0], uv[1]};
        }
    }
    return *distance < FLT_MAX;
}

/* From the surface into a random direction of Lambert's law. What a diffuse bounce sees is blurred
 * over all directions: each sample answers for a wide cone. */
static void bounce(scene *s, const float normal[3], slv_ray_differential *ray) {
    float angle = 6.2831853f * uniform(s), height = 2 * uniform(s) - 1;
    float round = sqrtf(1 - height * height);
    float ball[3] = {round * cosf(angle), round * sinf(angle), height}, side[3], up[3];
    for (int c = 0; c < 3; c++)
        ray->direction[c] = ball[c] + 1.001f * normal[c];
    float length = sqrtf(dot(ray->direction, ray->direction));
    for (int c = 0; c < 3; c++)
        ray->direction[c] /= length;
    cross(ray->direction,
          fabsf(ray->direction[0]) < 0.7f ? (float[3]){1, 0, 0} : (float[3]){0, 1, 0}, side);
    cross(ray->direction, side, up);
    for (int c = 0; c < 3; c++) {
        ray->direction_dx[c] = 0.3f * side[c];
        ray->direction_dy[c] = 0.3f * up[c];
    }
}

static slv_result trace(scene *s, slv_ray_differential ray, float light[3]) {
    float through[3] = {1, 1, 1}, distance;
    slv_surface_point at;
    for (int b = 0; b <= BOUNCES; b++) {
        float du[3], dv[3], normal[3], color[3];
        if (!find_hit(s, &ray, &distance, &at)) {
            for (int c = 0; c < 3; c++)
                light[c] += through[c]; /* the sky */
            break;
        }
        slv_result result = slv_surface_evaluate(
            s->surface, 1, &at, &(slv_surface_arrays){.du = du, .dv = dv, .normals = normal});
        slv_lookup lookup = {.file = s->file, .face = (uint32_t)at.face, .u = at.u, .v = at.v};
        slv_ray_differential_transfer(&ray, distance, normal);
        slv_footprint_from_differentials(ray.origin_dx, ray.origin_dy, du, dv, &lookup);
        if (!result)
            result = slv_sample(s->sampler, &lookup, color);
        if (result)
            return result;
        for (int c = 0; c < 3; c++) {
            normal[c] = dot(normal, ray.direction) > 0 ? -normal[c] : normal[c];
            through[c] *= color[c];
        }
        bounce(s, normal, &ray);
    }
    return SLV_OK;
}

static slv_result draw(scene *s, const slv_env *env, const char *path) {
    slv_camera camera = slv_camera_orbit(s->grid.bounds_min, s->grid.bounds_max, 35, 25, 40, 1);
    const float *m = camera.world_to_camera, *window = camera.window;
    float step = (window[1] - window[0]) / SIZE;
    slv_image image = {0};
    slv_result result = slv_image_create(env, SIZE, SIZE, 3, &image);
    for (uint32_t i = 0; i < SIZE * SIZE * SAMPLES && !result; i++) {
        uint32_t pixel = i / SAMPLES;
        float x = window[0] + step * ((float)(pixel % SIZE) + uniform(s)), light[3] = {0};
        float y = window[3] - step * ((float)(pixel / SIZE) + uniform(s));
        slv_ray_differential ray = {0};
        for (int c = 0; c < 3; c++) { /* the matrix turns and moves: its inverse is its transpose */
            ray.origin[c] = -(m[c] * m[3] + m[4 + c] * m[7] + m[8 + c] * m[11]);
            ray.direction[c] = m[c] * x + m[4 + c] * y - m[8 + c];
            ray.direction_dx[c] = m[c] * step;
            ray.direction_dy[c] = -m[4 + c] * step;
        }
        result = trace(s, ray, light);
        for (int c = 0; c < 3; c++)
            image.pixels[3 * pixel + c] += light[c] / SAMPLES;
    }
    if (!result)
        result = slv_image_save(env, path, &image, NULL);
    slv_image_free(&image);
    return result;
}

/* A store of light in floats, checked in two colours a face. */
static slv_result make_texture(const slv_env *env, uint32_t nfaces, slv_texture **out) {
    enum { WIDTH = 1 << LOG2 };
    static float texels[WIDTH * WIDTH * 3];
    slv_res *res = malloc(nfaces * sizeof *res);
    slv_texture_desc desc = {nfaces, SLV_TYPE_FLOAT, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    for (uint32_t f = 0; res && f < nfaces; f++)
        res[f] = (slv_res){LOG2, LOG2};
    slv_result result = res ? slv_texture_create(env, &desc, out) : SLV_ERROR_MEMORY;
    for (uint32_t f = 0; f < nfaces && !result; f++) {
        for (uint32_t i = 0; i < WIDTH * WIDTH; i++) {
            bool dark = (i % WIDTH / 16 + i / WIDTH / 16) % 2;
            for (uint32_t c = 0; c < 3; c++)
                texels[3 * i + c] = dark ? 0.2f : f % 3 == c ? 0.9f : 0.6f;
        }
        result = slv_texture_set_face(*out, f, texels);
    }
    free(res);
    return result;
}

static void print_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "%s\n", message);
}

int main(int argc, char **argv) {
    slv_env env = {.log = print_log};
    slv_filter_params filter = {.filter = SLV_FILTER_ANISOTROPIC};
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_texture *texture = NULL;
    slv_source source = {0};
    slv_cache *cache = NULL;
    scene s = {.random = 1};
    slv_result result = SLV_ERROR_ARGUMENT;
    if (argc != 3) {
        fprintf(stderr, "usage: trace MESH.obj OUT.png\n");
        return 2;
    }
    if ((result = slv_mesh_load(&env, argv[1], &mesh)) ||
        (result = slv_mesh_adjacency(&env, mesh, &adjacency)) ||
        (result = slv_surface_create(&env, mesh, NULL, &s.surface)) ||
        (result = slv_tessellate(&env, mesh, s.surface, adjacency, SEGMENTS, &s.grid)) ||
        (result = make_texture(&env, s.grid.nfaces, &texture)) ||
        (result = slv_texture_as_source(&env, texture, adjacency, NULL, &source)) ||
        (result = slv_cache_create(&env, NULL, &cache)) ||
        (result = slv_cache_open_source(cache, &source, NULL, &s.file)) ||
        (result = slv_sampler_create(cache, &filter, &s.sampler)))
        goto done;
    s.boxes = malloc(s.grid.nfaces * sizeof *s.boxes);
    for (uint32_t f = 0; s.boxes && f < s.grid.nfaces; f++)
        for (int c = 0; c < 3; c++) {
            s.boxes[f][0][c] = FLT_MAX;
            s.boxes[f][1][c] = -FLT_MAX;
            for (uint32_t i = s.grid.first[f]; i < s.grid.first[f + 1]; i++) {
                float at = s.grid.vertices[i].position[c];
                s.boxes[f][0][c] = fminf(s.boxes[f][0][c], at);
                s.boxes[f][1][c] = fmaxf(s.boxes[f][1][c], at);
            }
        }
    result = s.boxes ? draw(&s, &env, argv[2]) : SLV_ERROR_MEMORY;
done:
    free(s.boxes);
    slv_sampler_destroy(s.sampler);
    slv_cache_destroy(cache); /* which closes the source */
    slv_texture_destroy(texture);
    slv_tessellation_free(&s.grid);
    slv_surface_destroy(s.surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    return result != SLV_OK;
}
