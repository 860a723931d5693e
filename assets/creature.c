/* The creature of the demo scene, grown rib by rib from nose to tail. */
#include "creature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cross-section of the trunk: its middle, half its width and height, and where the trunk is
 * heading, in degrees. */
struct rib {
    float x, y, z, width, height, pitch, yaw;
};

/* From the rump to the brow. */
static const struct rib trunk[] = {
    {-1.00f, 1.10f, 0.00f, 0.20f, 0.21f, -4, 0}, {-0.87f, 1.09f, 0.00f, 0.31f, 0.32f, -2, 0},
    {-0.52f, 1.09f, 0.00f, 0.35f, 0.35f, 0, 0},  {-0.20f, 1.12f, 0.00f, 0.29f, 0.28f, 2, 0},
    {0.12f, 1.11f, 0.00f, 0.33f, 0.35f, 0, 0},   {0.44f, 1.12f, 0.00f, 0.39f, 0.43f, 6, 0},
    {0.76f, 1.22f, 0.00f, 0.32f, 0.36f, 28, 0},  {0.96f, 1.41f, 0.01f, 0.19f, 0.23f, 48, 6},
    {1.09f, 1.61f, 0.03f, 0.15f, 0.17f, 62, 12}, {1.21f, 1.81f, 0.06f, 0.15f, 0.17f, 45, 18},
    {1.37f, 1.94f, 0.11f, 0.23f, 0.21f, 5, 22},  {1.58f, 1.93f, 0.19f, 0.21f, 0.18f, -12, 22},
};
enum { RUMP = 0, HIPS = 2, SHOULDERS = 6, NECK_END = 9, SKULL = 10, TRUNK_RIBS = 12 };

/* From the rump to the tip, the headings still pointing forwards. */
static const struct rib tail[] = {
    {-1.25f, 1.03f, 0.00f, 0.15f, 0.16f, 20, 0},
    {-1.58f, 0.88f, -0.04f, 0.122f, 0.13f, 24, 12},
    {-1.95f, 0.75f, -0.13f, 0.098f, 0.10f, 12, 14},
    {-2.30f, 0.73f, -0.18f, 0.080f, 0.08f, -14, -4},
    {-2.58f, 0.89f, -0.13f, 0.064f, 0.064f, -42, -16},
    {-2.75f, 1.13f, -0.06f, 0.062f, 0.062f, -62, -18},
};
enum { TAIL_RIBS = sizeof tail / sizeof *tail };

/* A cross-section of a leg, flat: its middle (z outwards), half its length along x and its width
 * along z. */
struct joint {
    float x, y, z, length, width;
};

enum { LEG_JOINTS = 4 };
static const struct joint hind_leg[LEG_JOINTS] = {
    {-0.62f, 0.68f, 0.28f, 0.175f, 0.115f},
    {-0.74f, 0.40f, 0.29f, 0.092f, 0.080f},
    {-0.80f, 0.17f, 0.29f, 0.072f, 0.072f},
    {-0.74f, 0.02f, 0.29f, 0.110f, 0.105f},
};
static const struct joint front_leg[LEG_JOINTS] = {
    {0.64f, 0.68f, 0.27f, 0.135f, 0.105f},
    {0.61f, 0.42f, 0.28f, 0.088f, 0.080f},
    {0.57f, 0.17f, 0.28f, 0.070f, 0.072f},
    {0.63f, 0.02f, 0.28f, 0.110f, 0.105f},
};

static section section_of_rib(const struct rib *rib) {
    const float radians = 0.01745329252f;
    float pitch = rib->pitch * radians, yaw = rib->yaw * radians;
    point up = {-sinf(pitch) * cosf(yaw), cosf(pitch), -sinf(pitch) * sinf(yaw)};
    point across = {-sinf(yaw), 0, cosf(yaw)};
    return (section){point_make(rib->x, rib->y, rib->z), point_scale(across, rib->width),
                     point_scale(up, rib->height)};
}

struct builder {
    struct cage *cage;
    enum creature_part *parts;
    int marked;
};

/* Everything added since the last call belongs to `part`. */
static void mark(struct builder *builder, enum creature_part part) {
    while (builder->marked < builder->cage->nquads)
        builder->parts[builder->marked++] = part;
}

/* Extrudes a few faces in short steps, each moved and scaled; what horns, ears, toes and spikes are
 * made of. */
static void grow(struct builder *builder, const int *faces, int nfaces, const point *moves,
                 const float *scales, int steps, enum creature_part part) {
    struct patch patch = patch_of(builder->cage, faces, nfaces);
    for (int i = 0; i < steps; i++) {
        patch_extrude(builder->cage, &patch);
        patch_shift(builder->cage, &patch, moves[i], scales[i]);
    }
    mark(builder, part);
    for (int i = 0; i < nfaces; i++)
        builder->parts[faces[i]] = part;
}

/* Two patches of 2 x 2 quads back to back: the ends of a trunk of no length. */
static void build_ends(struct cage *cage, struct patch *front, struct patch *rear) {
    int grid[2][3][3];
    for (int side = 0; side < 2; side++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 3; i++) {
                bool shared = side && !(i == 1 && j == 1);
                float round = i != 1 && j != 1 ? 0.8f : 1.0f;
                point p = {0, (float)(j - 1) * round, (float)(i - 1) * round};
                grid[side][j][i] = shared ? grid[0][j][i] : cage_add_point(cage, p);
            }
    int faces[2][4];
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 4; k++) {
            int i = k & 1, j = k >> 1;
            int(*g)[3] = grid[side];
            faces[side][k] =
                side ? cage_add_quad(cage, g[j][i], g[j][i + 1], g[j + 1][i + 1], g[j + 1][i])
                     : cage_add_quad(cage, g[j][i], g[j + 1][i], g[j + 1][i + 1], g[j][i + 1]);
        }
    *front = patch_of(cage, faces[0], 4);
    *rear = patch_of(cage, faces[1], 4);
    patch_measure(cage, front, point_make(0, 0, 1), point_make(0, 1, 0));
    patch_measure(cage, rear, point_make(0, 0, 1), point_make(0, 1, 0));
}

static bool face_has_point(const struct cage *cage, int face, int vertex) {
    const int32_t *quad = cage->quads[face];
    return quad[0] == vertex || quad[1] == vertex || quad[2] == vertex || quad[3] == vertex;
}

static void build_leg(struct builder *builder, const int *hip, const struct joint *joints,
                      float side) {
    struct cage *cage = builder->cage;
    struct patch leg = patch_of(cage, hip, 2);
    patch_measure(cage, &leg, point_make(0, 0, 1), point_make(1, 0, 0));
    /* The first of the two faces is the inner one; what both share is the middle of the leg's
     * section. */
    for (int i = 0; i < leg.npoints; i++) {
        bool inner = face_has_point(cage, hip[0], leg.points[i]);
        bool outer = face_has_point(cage, hip[1], leg.points[i]);
        leg.a[i] = (float)outer - (float)inner;
        leg.b[i] = copysignf(inner && outer ? 1.1f : 0.8f, leg.b[i]);
    }
    for (int i = 0; i < LEG_JOINTS; i++) {
        const struct joint *j = &joints[i];
        section where = {point_make(j->x, j->y, side * j->z), point_make(0, 0, side * j->width),
                         point_make(j->length, 0, 0)};
        patch_extrude_to(cage, &leg, &where);
    }
    mark(builder, PART_LEG);
    int toes[2] = {patch_side(&leg, cage, -0.5f, 1), patch_side(&leg, cage, 0.5f, 1)};
    for (int i = 0; i < leg.nsides; i++)
        builder->parts[leg.first_side + i] = PART_FOOT;
    for (int i = 0; i < 2; i++) {
        point forward = {0.14f, -0.025f, side * (i ? 0.03f : -0.03f)};
        const float narrow = 0.6f;
        grow(builder, &toes[i], 1, &forward, &narrow, 1, PART_FOOT);
    }
    for (int i = 0; i < leg.nfaces; i++)
        builder->parts[leg.faces[i]] = PART_FOOT;
}

static void build_tail(struct builder *builder, struct patch *rear) {
    for (int i = 0; i < TAIL_RIBS; i++) {
        section where = section_of_rib(&tail[i]);
        patch_extrude_to(builder->cage, rear, &where);
    }
    mark(builder, PART_TAIL);
    for (int i = 0; i < rear->nfaces; i++) {
        point away = point_sub(
            cage_face_centre(builder->cage, rear->faces[i]),
            point_make(tail[TAIL_RIBS - 1].x, tail[TAIL_RIBS - 1].y, tail[TAIL_RIBS - 1].z));
        point out = point_add(point_scale(away, 4.0f), point_make(-0.04f, 0.12f, 0.02f));
        const float narrow = 0.3f;
        grow(builder, &rear->faces[i], 1, &out, &narrow, 1, PART_CREST);
    }
}

/* Snout and jaw leave the front of the head as two patches, so that there is a mouth between them.
 */
static void build_jaws(struct builder *builder, const struct patch *front, const section *brow) {
    int upper[2], lower[2], nupper = 0, nlower = 0;
    for (int i = 0; i < front->nfaces; i++) {
        point from = point_sub(cage_face_centre(builder->cage, front->faces[i]), brow->centre);
        if (point_dot(from, brow->up) > 0 && nupper < 2)
            upper[nupper++] = front->faces[i];
        else if (nlower < 2)
            lower[nlower++] = front->faces[i];
    }
    const point snout[2] = {{0.21f, -0.03f, 0.085f}, {0.16f, -0.03f, 0.065f}};
    const point jaw[2] = {{0.17f, -0.09f, 0.07f}, {0.12f, -0.04f, 0.05f}};
    const float snout_scale[2] = {0.85f, 0.8f}, jaw_scale[2] = {0.75f, 0.7f};
    grow(builder, upper, 2, snout, snout_scale, 2, PART_HEAD);
    grow(builder, lower, 2, jaw, jaw_scale, 2, PART_HEAD);
}

static void build_horns_and_ears(struct builder *builder, const int *horns, const int *ears,
                                 const section *skull) {
    for (int i = 0; i < 2; i++) {
        point out = point_scale(skull->across, i ? 1.0f : -1.0f);
        const point horn[3] = {
            point_add(point_make(-0.05f, 0.10f, -0.02f), point_scale(out, 0.15f)),
            point_add(point_make(-0.10f, 0.12f, -0.04f), point_scale(out, 0.25f)),
            point_add(point_make(-0.02f, 0.16f, -0.01f), point_scale(out, 0.05f))};
        point ear = point_add(point_make(-0.15f, 0.05f, -0.06f), point_scale(out, 1.2f));
        const float horn_scale[3] = {0.6f, 0.7f, 0.35f}, ear_scale = 0.4f;
        grow(builder, &horns[i], 1, horn, horn_scale, 3, PART_HORN);
        grow(builder, &ears[i], 1, &ear, &ear_scale, 1, PART_HORN);
    }
}

static void build_control(struct cage *cage, enum creature_part *parts) {
    struct builder builder = {cage, parts, 0};
    struct patch front, rear;
    int hips[2][2][2], back[TRUNK_RIBS][2], horns[2] = {0}, ears[2] = {0};
    section where = section_of_rib(&trunk[RUMP]), brow;
    build_ends(cage, &front, &rear);
    patch_place(cage, &rear, &where);
    for (int i = RUMP + 1; i < TRUNK_RIBS; i++) {
        where = section_of_rib(&trunk[i]);
        patch_extrude_to(cage, &front, &where);
        mark(&builder, i <= SHOULDERS ? PART_BODY : i <= NECK_END ? PART_NECK : PART_HEAD);
        for (int k = 0; k < 2; k++) {
            float side = k ? 1.0f : -1.0f;
            back[i][k] = patch_side(&front, cage, side * 0.5f, 1);
            if (i == HIPS || i == SHOULDERS) {
                hips[i == SHOULDERS][k][0] = patch_side(&front, cage, side * 0.5f, -1);
                hips[i == SHOULDERS][k][1] = patch_side(&front, cage, side, -0.5f);
            }
            if (i == SKULL) {
                horns[k] = back[i][k];
                ears[k] = patch_side(&front, cage, side, 0.5f);
            }
        }
    }
    brow = where;
    build_tail(&builder, &rear);
    for (int k = 0; k < 2; k++) {
        build_leg(&builder, hips[0][k], hind_leg, k ? 1.0f : -1.0f);
        build_leg(&builder, hips[1][k], front_leg, k ? 1.0f : -1.0f);
    }
    build_jaws(&builder, &front, &brow);
    where = section_of_rib(&trunk[SKULL]);
    build_horns_and_ears(&builder, horns, ears, &where);
    for (int i = HIPS + 1; i < SHOULDERS; i++) {
        point spine = {-0.16f, 0.26f, 0};
        const float narrow = 0.12f;
        grow(&builder, back[i], 2, &spine, &narrow, 1, PART_CREST);
    }
}

bool creature_build(struct cage *cage, enum creature_part *parts) {
    struct cage *control = calloc(1, sizeof *control);
    if (!control)
        return false;
    build_control(control, parts);
    cage_refine(control, cage);
    for (int f = cage->nquads; f-- > 0;)
        parts[f] = parts[f / 4];
    bool whole = !cage->full;
    free(control);
    return whole;
}
