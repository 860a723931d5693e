/* A tube in the spelling of other programs: vertices once or in copies, texture coordinates shared,
 * one a corner or with a third number, indices from the end, groups, six digits that round one
 * place two ways. Welding leaves the same map with one coordinate a vertex. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/mesh.h>
#include <selvage/wrap.h>

enum { AROUND = 10, HIGH = 3, QUADS = AROUND * HIGH, PLACES = AROUND * (HIGH + 1) };
#define TURN 6.283185307179586

/* ONCE: a column of vertices less than of texture coordinates. TWICE: as many of both. CORNERS: a
 * texture coordinate for each corner of a face. SOUP: a vertex for each, too, before its face. */
enum { ONCE, TWICE, CORNERS, SOUP };

typedef struct dialect {
    const char *name, *head, *group, *v, *vt, *corner, *end;
    int kind;
    double last; /* u where the map ends */
} dialect;

static const dialect dialects[] = {
    {"Blender", "# Blender v3.6.5 OBJ File: 'tube.blend'\n# www.blender.org\nmtllib tube.mtl\n",
     "o Cylinder\nusemtl Material.001\ns 1\n", "v %.6f %.6f %.6f\n", "vt %.6f %.6f\n", " %d/%d/1",
     "\n", ONCE, 1},
    {"Maya",
     "# This file uses centimeters as units for non-parametric coordinates.\r\n\r\nmtllib "
     "tube.mtl\r\ng default\r\n",
     "s 1\r\ng pCylinder1\r\nusemtl initialShadingGroup\r\n", "v %.6f %.6f %.6f\r\n",
     "vt %.6f %.6f\r\n", " %d/%d/1", "\r\n", ONCE, 0.999999},
    {"Houdini", "# File exported by Houdini 19.5.303\n# 40 points\n# 30 primitives\n",
     "g tube1 side\n", "v %.9g %.9g %.9g\n", "vt %.9g %.9g 0\n", " %d/%d/1", "\n", CORNERS, 1},
    {"ZBrush",
     "#File exported by ZBrush version 2022\n#http://www.zbrush.com\n#Vertex Count 44\n#MRGB "
     "ffffffff\n",
     "g default\n", "v %.8f %.8f %.8f\n", "vt %.8f %.8f\n", " %d/%d", "\n", TWICE, 0.99999994},
    {"3ds Max", "# 3ds Max Wavefront OBJ Exporter v0.97b\n\n", "g tube\ns 1\n",
     "v  %.4f %.4f %.4f\n", "vt %.4f %.4f 0.0000\n", " %d/%d/1", " \n", TWICE, 1},
    {"a scanner", "", "", "v %.6f %.6f %.6f\n", "vt %.6f %.6f\n", " %d/%d", "\n", SOUP, 1},
};

/* Six digits of one number may be off by one where programs have computed it twice. */
static void write_vertex(FILE *file, const dialect *d, int x, int y, bool copy) {
    double a = TURN * (x % AROUND) / AROUND, off = copy && d->kind != ONCE ? 1e-6 : 0;
    fprintf(file, d->v, sin(a) - off, (double)y / HIGH, cos(a) - off);
}

static void write_coordinate(FILE *file, const dialect *d, int x, int y) {
    fprintf(file, d->vt, x == AROUND ? d->last : (double)x / AROUND, (double)y / HIGH);
}

static void write_tube(const dialect *d) {
    FILE *file = fopen(tool_path("in.obj"), "w");
    const int width = d->kind == TWICE ? AROUND + 1 : AROUND;
    REQUIRE(file);
    fputs(d->head, file);
    for (int i = 0; i < width * (HIGH + 1) && d->kind != SOUP; i++)
        write_vertex(file, d, i % width, i / width, i % width == AROUND);
    for (int i = 0; i < (AROUND + 1) * (HIGH + 1) && d->kind < CORNERS; i++)
        write_coordinate(file, d, i % (AROUND + 1), i / (AROUND + 1));
    for (int i = 0; i < 4 * QUADS && d->kind == CORNERS; i++)
        write_coordinate(file, d, i / 4 % AROUND + (i % 4 == 1 || i % 4 == 2),
                         i / 4 / AROUND + i % 4 / 2);
    fprintf(file, "vn 0.0000 1.0000 0.0000%s%s", d->end, d->group);
    for (int i = 0; i < QUADS; i++) {
        for (int k = 0; k < 4 && d->kind == SOUP; k++) {
            int x = i % AROUND + (k == 1 || k == 2), y = i / AROUND + k / 2;
            write_vertex(file, d, x, y, (i + k) % 3 == 0);
            write_coordinate(file, d, x, y);
        }
        fputs("f", file);
        for (int k = 0; k < 4; k++) {
            int x = i % AROUND + (k == 1 || k == 2), y = i / AROUND + k / 2;
            int vertex = 1 + y * width + x % width, coordinate = 1 + y * (AROUND + 1) + x;
            fprintf(file, d->corner, d->kind == SOUP ? k - 4 : vertex,
                    d->kind == SOUP      ? k - 4
                    : d->kind == CORNERS ? 4 * i + k + 1
                                         : coordinate);
        }
        fputs(d->end, file);
    }
    REQUIRE(fclose(file) == 0);
}

/* The faces have the same texture coordinates as before, by whole numbers. */
static void check_map(const char *name) {
    slv_env env = test_env();
    slv_mesh *before, *after;
    float *a, *b;
    double most = 0;
    MUST(slv_mesh_load(&env, tool_path("in.obj"), &before));
    MUST(slv_mesh_load(&env, tool_path("out.obj"), &after));
    const slv_mesh_view *from = slv_mesh_get_view(before), *to = slv_mesh_get_view(after);
    CHECK_MSG(to->nverts == PLACES && to->ntexcoords == PLACES && to->npolys == QUADS &&
                  to->ngroups == from->ngroups,
              "%s: %u vertices, %u coordinates, %u polygons, %u groups", name, to->nverts,
              to->ntexcoords, to->npolys, to->ngroups);
    MUST(slv_mesh_face_texcoords(&env, before, &a));
    MUST(slv_mesh_round_texcoords(&env, after, true, false, &b));
    for (int i = 0; i < 8 * QUADS; i++) {
        most = fmax(most, (double)fabsf(i % 2 ? a[i] - b[i] : slv_wrap_step(a[i], b[i])));
        CHECK(b[i] > -0.2f && b[i] < 1.2f);
    }
    CHECK_MSG(most < 1e-5, "%s: coordinates are %g off", name, most);
    slv_free(a);
    slv_free(b);
    slv_mesh_destroy(before);
    slv_mesh_destroy(after);
}

int main(void) {
    tool_begin();
    for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++) {
        const dialect *d = &dialects[i];
        static const int vertices[] = {PLACES, PLACES + HIGH + 1, PLACES, 4 * QUADS};
        char want[120];
        write_tube(d);
        RUNS(0, "wrap in.obj out.obj");
        snprintf(want, sizeof want, "out.obj: %d vertices of %d, %d duplicates welded", PLACES,
                 vertices[d->kind], vertices[d->kind] - PLACES);
        CHECK_MSG(strstr(tool_out, want), "%s: not '%s': %s", d->name, want, tool_out);
        /* vertices that are copies, and those that take two coordinates, are the same when drawn */
        const int drawn = d->kind == SOUP ? 4 * QUADS : PLACES + HIGH + 1;
        snprintf(want, sizeof want,
                 "as drawn, one for each texture coordinate: %d of %d, %d bytes saved", PLACES,
                 drawn, 32 * (drawn - PLACES));
        CHECK_MSG(strstr(tool_out, want), "%s: not '%s': %s", d->name, want, tool_out);
        CHECK_MSG(strstr(tool_out, "3 polygons go over the end of u, 0 over that of v"), "%s: %s",
                  d->name, tool_out);
        LACKS("single value");
        LACKS("beside");
        check_map(d->name);
        /* nothing is left to do */
        RUNS(0, "wrap out.obj again.obj");
        HAS("40 vertices of 40, 0 duplicates welded");
    }
    tool_end();
    return test_end();
}
