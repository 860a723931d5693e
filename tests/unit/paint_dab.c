/* Dabs on surfaces: what several faces hold is what one flat face of the same texels holds,
 * whatever edges, corners and resolutions lie between, and nothing is covered twice or through a
 * plate. */
#include "kit/paint_kit.h"

#include <selvage/canvas.h>

#define TAU 6.28318530718

/* A surface with faces of some resolutions. */
typedef struct scene {
    slv_mesh *mesh;
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_res *res;
    uint32_t nfaces;
} scene;

static scene scene_of(shape *s, slv_scheme scheme, int log2) {
    slv_env env = test_env();
    scene out = {0};
    slv_mesh_view view = {.nverts = s->nverts,
                          .positions = s->positions,
                          .npolys = s->npolys,
                          .poly_sizes = s->sizes,
                          .poly_verts = s->verts};
    const slv_paint_surface_params params = {.scheme = scheme};
    MUST(slv_mesh_create(&env, &view, &out.mesh));
    MUST(slv_paint_surface_create(&env, out.mesh, &params, &out.surface));
    MUST(slv_painter_create(&env, out.surface, &out.painter));
    out.nfaces = slv_mesh_face_count(out.mesh);
    out.res = calloc(out.nfaces, sizeof *out.res);
    for (uint32_t i = 0; i < out.nfaces; i++)
        out.res[i] = (slv_res){(int8_t)log2, (int8_t)log2};
    shape_clear(s);
    return out;
}

static void scene_end(scene *s) {
    slv_painter_destroy(s->painter);
    slv_paint_surface_destroy(s->surface);
    slv_mesh_destroy(s->mesh);
    free(s->res);
}

static slv_patches cover(scene *s, const slv_dab *dab) {
    slv_patches out;
    MUST(slv_painter_cover(s->painter, s->res, dab, &out));
    for (uint32_t i = 1; i < out.count; i++)
        CHECK(out.list[i - 1].face < out.list[i].face);
    return out;
}

/* The coverage of a texel; zero where no patch has it. */
static float value_at(const slv_patches *patches, uint32_t face, uint32_t x, uint32_t y) {
    static uint32_t last; /* texels of a face are asked for one after the other */
    for (uint32_t i = 0; i < patches->count; i++) {
        const slv_patch *p = &patches->list[(last + i) % patches->count];
        if (p->face != face)
            continue;
        last = (last + i) % patches->count;
        return x - p->rect.x < p->rect.width && y - p->rect.y < p->rect.height
                   ? p->coverage[(y - p->rect.y) * p->rect.width + (x - p->rect.x)]
                   : 0;
    }
    return 0;
}

/* What a dab is `x` along and `y` across its axes from its middle: the profile of slv_dab, the rim
 * no narrower than `texel`. */
static double profile(const slv_dab *dab, double x, double y, double texel) {
    double r = dab->radius, a = dab->angle * TAU / 360, aspect = dab->aspect, h = dab->hardness;
    double along = x * cos(a) + y * sin(a), across = (y * cos(a) - x * sin(a)) * aspect;
    double square = along * along + across * across, inner = r * sqrt(h);
    if (r - inner < texel) {
        double grow = (texel - (r - inner)) / 2;
        r += grow;
        inner = r - texel;
    }
    if (square >= r * r)
        return 0;
    return square <= inner * inner ? 1 - (1 - h) * square / (inner * inner)
                                   : h * (r * r - square) / (r * r - inner * inner);
}

/* The largest difference of what is covered of the faces first..end-1 from the formula, a texel at
 * position p of space lying at flatten(p) of the plane. */
static double difference(scene *s, uint32_t first, uint32_t end, const slv_patches *patches,
                         const slv_dab *dab, double texel,
                         void (*flatten)(const float p[3], double out[2]), const double middle[2]) {
    double worst = 0;
    for (uint32_t face = first; face < end; face++)
        for (uint32_t y = 0; y < 1u << s->res[face].v; y++)
            for (uint32_t x = 0; x < 1u << s->res[face].u; x++) {
                float p[3];
                double at[2];
                slv_surface_point point = {(int32_t)face, ldexpf((float)x + 0.5f, -s->res[face].u),
                                           ldexpf((float)y + 0.5f, -s->res[face].v)};
                slv_paint_surface_at(s->surface, point, p, NULL, NULL);
                flatten(p, at);
                double want = profile(dab, at[0] - middle[0], at[1] - middle[1], texel);
                double d = fabs(want - (double)value_at(patches, face, x, y));
                worst = d > worst ? d : worst;
            }
    return worst;
}

static void flatten_plane(const float p[3], double out[2]) {
    out[0] = (double)p[0];
    out[1] = (double)p[1];
}

static bool pairs[16]; /* of edges that were seen to meet */

static void note_pairs(const scene *s) {
    const slv_face_adjacency *faces = slv_adjacency_faces(slv_paint_surface_adjacency(s->surface));
    for (uint32_t face = 0; face < s->nfaces; face++)
        for (unsigned edge = 0; edge < 4; edge++)
            if (faces[face].face[edge] >= 0)
                pairs[4 * edge + faces[face].edge[edge]] = true;
}

static void planes_of_many_faces(void) {
    static const float middles[][2] = {
        {2.1f, 1.9f}, {2, 2}, {2.5f, 2}, {1.13f, 2.96f}, {0.2f, 0.1f}};
    static const struct {
        float hardness, aspect, angle;
    } brushes[] = {{0.5f, 1, 0}, {0.1f, 1, 0}, {0.8f, 3, 30}, {1, 1, 0}};
    for (int turn = 0; turn < 2; turn++) {
        shape many = paint_rectangle(4, 4, 4, 4, turn);
        scene s = scene_of(&many, SLV_SCHEME_BILINEAR, 6);
        note_pairs(&s);
        for (uint32_t i = 0; i < s.nfaces; i += 3) { /* 1:1 to 1:16, and not square */
            s.res[i].u = (int8_t)(3 + i % 4);
            s.res[i].v = (int8_t)(2 + i % 5);
        }
        for (size_t m = 0; m < sizeof middles / sizeof *middles; m++)
            for (size_t b = 0; b < sizeof brushes / sizeof *brushes; b++) {
                float x = middles[m][0], y = middles[m][1], o[3] = {x, y, 1}, down[3] = {0, 0, -1};
                slv_paint_hit hit;
                REQUIRE(slv_paint_surface_hit(s.surface, o, down, &hit));
                CHECK(fabsf(hit.position[0] - x) < 1e-5f && fabsf(hit.position[1] - y) < 1e-5f);
                slv_dab dab = {.at = hit.point,
                               .radius = 1.1f,
                               .hardness = brushes[b].hardness,
                               .aspect = brushes[b].aspect,
                               .angle = brushes[b].angle,
                               .axis = {1, 0, 0}};
                slv_patches patches = cover(&s, &dab);
                slv_res here = s.res[hit.point.face];
                const double middle[2] = {(double)x, (double)y};
                double worst = difference(&s, 0, s.nfaces, &patches, &dab,
                                          sqrt(ldexp(1, -here.u - here.v)), flatten_plane, middle);
                CHECK_MSG(worst < 2.0 / 255, "turn %d, middle %zu, brush %zu: %g/255", turn, m, b,
                          255 * worst);
            }
        scene_end(&s);
    }
    for (int i = 0; i < 16; i++)
        CHECK_MSG(pairs[i], "no edges %d and %d meet", i / 4, i % 4);
}

/* A box from -1 to 1, as high as `height`. */
static shape box(float height) {
    shape s = shape_cube();
    for (uint32_t i = 0; i < s.nverts; i++)
        s.positions[3 * i + 2] *= height / 2;
    return s;
}

static slv_surface_point point_on(scene *s, float x, float y, float z, float dx, float dy,
                                  float dz) {
    float o[3] = {x + dx, y + dy, z + dz}, d[3] = {-dx, -dy, -dz};
    slv_paint_hit hit = {0};
    CHECK(slv_paint_surface_hit(s->surface, o, d, &hit));
    return hit.point;
}

static float plate_height = 2;
/* The box unrolled over the edges x = 1: its top, its side, its bottom. */
static void flatten_box(const float p[3], double out[2]) {
    double h = (double)plate_height / 2;
    out[0] = (double)p[0];
    out[1] = (double)p[1];
    if ((double)p[2] < h * 0.9999)
        out[0] = 1 + h - (double)p[2];
    if ((double)p[2] < -h * 0.9999)
        out[0] = 1 + 2 * h + (1 - (double)p[0]);
}

static void around_edges_of_boxes(void) {
    static const float heights[] = {2, 0.0006f};
    for (int i = 0; i < 2; i++) {
        shape b = box(plate_height = heights[i]);
        scene s = scene_of(&b, SLV_SCHEME_BILINEAR, 7);
        const double middle[2] = {0.7, 0.1};
        slv_dab dab = {.at = point_on(&s, 0.7f, 0.1f, plate_height / 2, 0, 0, 1),
                       .radius = 0.6f,
                       .hardness = 0.6f,
                       .aspect = 1,
                       .axis = {1, 0, 0}};
        for (int k = 0; k < 2; k++) {
            dab.aspect = k ? 2.5f : 1;
            dab.angle = k ? 70 : 0;
            slv_patches patches = cover(&s, &dab);
            uint32_t top = (uint32_t)dab.at.face;
            uint32_t bottom = (uint32_t)point_on(&s, 0.7f, 0.1f, -plate_height / 2, 0, 0, -1).face;
            uint32_t side = (uint32_t)point_on(&s, 1, 0.1f, 0, 1, 0, 0).face;
            uint32_t faces[3] = {top, side, bottom};
            for (int f = 0; f < 3; f++) {
                double worst = difference(&s, faces[f], faces[f] + 1, &patches, &dab, 2.0 / 128,
                                          flatten_box, middle);
                CHECK_MSG(worst < 2.0 / 255, "height %g, face %d, aspect %g: %g/255",
                          (double)plate_height, f, (double)dab.aspect, 255 * worst);
            }
        }
        /* one that does not reach the rim: nothing on the other side, which is a thousandth of the
         * brush away */
        dab.at = point_on(&s, 0.1f, 0.1f, plate_height / 2, 0, 0, 1);
        slv_patches patches = cover(&s, &dab);
        CHECK(patches.count == 1 && patches.list[0].face == (uint32_t)dab.at.face);
        scene_end(&s);
    }
}

/* Rays of length 1 from zero, each at right angles to the next: `valence` squares around a vertex.
 */
static void find_rays(int valence, double rays[][3]) {
    int zigzag = valence % 2 ? valence - 1 : valence;
    double step = valence % 2 ? TAU / 2 / (valence - 2) : TAU / valence, azimuth = 0;
    double lift = atan(sqrt(fmax(cos(step), 0)));
    if (valence == 3)
        lift = 0;
    for (int k = 0; k < valence; k++) {
        double e = k >= zigzag ? 0 : k % 2 ? -lift : lift;
        azimuth += k == 0 ? 0 : k >= zigzag ? TAU / 4 : step;
        rays[k][0] = cos(azimuth) * cos(e);
        rays[k][1] = sin(azimuth) * cos(e);
        rays[k][2] = sin(e);
    }
    for (int k = 0; valence == 3 && k < 3; k++)
        for (int i = 0; i < 3; i++)
            rays[k][i] = i == k;
}

static void around_corners(int valence) {
    double rays[8][3], worst = 0, sum = 0, jump = 0;
    uint64_t count = 0;
    shape f = {0};
    find_rays(valence, rays);
    shape_vertex(&f, 0, 0, 0);
    for (int k = 0; k < valence; k++) {
        const double *a = rays[k], *b = rays[(k + 1) % valence];
        shape_vertex(&f, (float)a[0], (float)a[1], (float)a[2]);
        shape_vertex(&f, (float)(a[0] + b[0]), (float)(a[1] + b[1]), (float)(a[2] + b[2]));
    }
    for (int k = 0; k < valence; k++) {
        int32_t q[4] = {0, 1 + 2 * k, 2 + 2 * k, 1 + 2 * ((k + 1) % valence)}, t[4];
        for (int i = 0; i < 4; i++)
            t[i] = q[(i + k) & 3];
        shape_polygon(&f, 4, t);
    }
    scene s = scene_of(&f, SLV_SCHEME_BILINEAR, 7);
    slv_dab dab = {.at = {0, 0.3f, 0.2f}, .radius = 0.8f, .hardness = 0.5f, .aspect = 1};
    slv_patches patches = cover(&s, &dab);
    double from = atan2(0.2, 0.3), r0 = hypot(0.3, 0.2);
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t y = 0; y < 128; y++)
            for (uint32_t x = 0; x < 128; x++) {
                float p[3];
                double a = 0, b = 0;
                slv_surface_point point = {(int32_t)face, ((float)x + 0.5f) / 128,
                                           ((float)y + 0.5f) / 128};
                slv_paint_surface_at(s.surface, point, p, NULL, NULL);
                for (int i = 0; i < 3; i++) {
                    a += (double)p[i] * rays[face][i];
                    b += (double)p[i] * rays[(face + 1) % (uint32_t)valence][i];
                }
                double turn = fabs(face * TAU / 4 + atan2(b, a) - from), r = hypot(a, b);
                turn = fmin(turn, valence * TAU / 4 - turn);
                double d = turn < TAU / 2 ? sqrt(r * r + r0 * r0 - 2 * r * r0 * cos(turn)) : r + r0;
                double e =
                    fabs(profile(&dab, d, 0, 1.0 / 128) - (double)value_at(&patches, face, x, y));
                worst = e > worst ? e : worst;
                sum += e;
                count += value_at(&patches, face, x, y) > 0;
            }
    /* what both sides of an edge say of it */
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour other[2];
            if (!slv_adjacency_neighbours(slv_paint_surface_adjacency(s.surface), (int32_t)face,
                                          edge, other))
                continue;
            for (int j = 0; j < 128; j++) {
                double side[2];
                for (int k = 0; k < 2; k++) {
                    unsigned e = k ? other->edge : edge;
                    int32_t i = k ? 127 - j : j, x[2], y[2];
                    for (int depth = 0; depth < 2; depth++) {
                        x[depth] = e == 1 ? 127 - depth : e == 3 ? depth : e == 0 ? i : 127 - i;
                        y[depth] = e == 0 ? depth : e == 2 ? 127 - depth : e == 1 ? i : 127 - i;
                    }
                    uint32_t which = k ? (uint32_t)other->face : face;
                    side[k] =
                        1.5 * (double)value_at(&patches, which, (uint32_t)x[0], (uint32_t)y[0]) -
                        0.5 * (double)value_at(&patches, which, (uint32_t)x[1], (uint32_t)y[1]);
                }
                jump = fmax(jump, fabs(side[0] - side[1]));
            }
        }
    CHECK_MSG(255 * jump < 1, "valence %d: edges differ by %g/255", valence, 255 * jump);
    CHECK(count > 10000);
    CHECK_MSG(255 * sum / (double)count < 1.5, "valence %d: off by %g/255 in the mean", valence,
              255 * sum / (double)count);
    CHECK_MSG(valence != 4 || 255 * worst < 0.1, "off by %g/255", 255 * worst);
    scene_end(&s);
}

/* Hills, alike on all faces, so that they meet. */
static slv_result hills(void *user, int32_t face, float spacing, size_t count, const float *uv,
                        float *out) {
    (void)user;
    (void)face;
    (void)spacing;
    for (size_t i = 0; i < count; i++)
        out[i] = 0.5f * sinf(3.14159265f * uv[2 * i]) * sinf(3.14159265f * uv[2 * i + 1]);
    return SLV_OK;
}

/* A ray at a surface that is moved meets it where it is seen, and says where that is on the surface
 * as it was: right below, since the hills are moved along its normal. */
static void hills_of_a_plane(void) {
    const slv_displacement displacement = {.space = SLV_DISPLACE_NORMAL, .evaluate = hills};
    shape plane = paint_rectangle(3, 3, 3, 3, 1);
    scene s = scene_of(&plane, SLV_SCHEME_BILINEAR, 4);
    slv_env env = test_env();
    slv_paint_surface *moved;
    const slv_paint_surface_params params = {
        .scheme = SLV_SCHEME_BILINEAR, .segments = 64, .displacement = &displacement};
    MUST(slv_paint_surface_create(&env, s.mesh, &params, &moved));
    float high[3], low[3], highest = 0;
    slv_paint_surface_bounds(moved, low, high);
    CHECK(fabsf(high[2] - 0.5f) < 1e-3f && fabsf(low[2]) < 1e-6f);
    for (int i = 0; i < 900; i++) {
        const float o[3] = {0.1f + 0.1f * (float)(i % 30), 0.1f + 0.1f * (float)(i / 30), 2},
                    d[3] = {0.3f, -0.2f, -1};
        float base[3];
        slv_paint_hit hit;
        if (!slv_paint_surface_hit(moved, o, d, &hit)) {
            CHECK(o[0] > 2.3f || o[1] < 0.5f); /* beside the plane */
            continue;
        }
        CHECK(slv_paint_surface_at(s.surface, hit.point, base, NULL, NULL));
        for (int k = 0; k < 3; k++)
            CHECK(fabsf(o[k] + hit.distance * d[k] - hit.position[k]) < 1e-4f);
        const float u = base[0] - floorf(base[0]), v = base[1] - floorf(base[1]);
        const float hill = 0.5f * sinf(3.14159265f * u) * sinf(3.14159265f * v);
        CHECK_MSG(
            fabsf(base[0] - hit.position[0]) < 1e-3f && fabsf(base[1] - hit.position[1]) < 1e-3f &&
                fabsf(hill - hit.position[2]) < 2e-3f,
            "ray %d: %g %g %g above %g %g", i, (double)hit.position[0], (double)hit.position[1],
            (double)hit.position[2], (double)base[0], (double)base[1]);
        highest = fmaxf(highest, hit.position[2]);
    }
    CHECK(highest > 0.45f);
    slv_paint_surface_destroy(moved);
    scene_end(&s);
}

int main(void) {
    planes_of_many_faces();
    hills_of_a_plane();
    around_edges_of_boxes();
    for (int valence = 3; valence <= 8; valence++)
        around_corners(valence);
    return test_end();
}
