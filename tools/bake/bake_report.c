/* What is told of a bake: its sizes, what has no value, and the exit code. */
#include "bake/bake_options.h"
#include "command/output.h"

#include <math.h>
#include <string.h>

static bool measures(const slv_bake_job *job) {
    return job->max_error > 0 || job->least_error;
}

static void print_misses(FILE *stream, const slv_bake_report *report) {
    const char *between = "";
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        if (report->misses[i]) {
            fprintf(stream, "%s%s %llu", between, slv_bake_miss_name((slv_bake_miss)i),
                    (unsigned long long)report->misses[i]);
            between = ", ";
        }
}

static uint64_t missing(const slv_bake_report *report) {
    return report->texels - report->misses[SLV_BAKE_HIT];
}

static void print_result(const bake_options *o, const slv_bake_job *job,
                         const slv_bake_report *report, const slv_bake_source *source) {
    uint32_t ntiles = 0;
    const slv_bake_tile *tiles = slv_bake_source_tiles(source, &ntiles);
    output_terminal(stdout, o->paths[1], strlen(o->paths[1]), SIZE_MAX);
    printf(": %llu faces (%llu constant), %u channels of %s, %llu texels, %.4g MiB unpacked\n"
           "  faces of %ux%u to %ux%u texels\n",
           (unsigned long long)report->faces, (unsigned long long)report->constant_faces,
           slv_bake_source_get_desc(source)->nchannels, slv_type_name(report->type),
           (unsigned long long)report->texels, (double)report->bytes / 1048576,
           1u << report->smallest.u, 1u << report->smallest.v, 1u << report->largest.u,
           1u << report->largest.v);
    if (measures(job))
        printf("  within %.4g of the source at samples, %.4g between them\n", (double)report->error,
               (double)report->error_bound);
    if (report->faces_over && job->max_error > 0)
        printf("  %llu faces are not within %g even at the largest size that they may have\n",
               (unsigned long long)report->faces_over, (double)job->max_error);
    for (uint32_t i = 0; i < ntiles; i++)
        if (tiles[i].number && tiles[i].width)
            printf("  tile %u: %ux%u, %u faces\n", tiles[i].number, tiles[i].width, tiles[i].height,
                   tiles[i].faces);
    if (missing(report)) {
        printf("  without a value: ");
        print_misses(stdout, report);
        putchar('\n');
    }
}

static json_t *bake_json(const bake_options *o, const slv_bake_job *job,
                         const slv_bake_report *report, const slv_bake_source *source) {
    json_t *misses = json_object(), *list = json_array();
    uint32_t ntiles = 0;
    const slv_bake_tile *tiles = slv_bake_source_tiles(source, &ntiles);
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        json_object_set_new(misses, slv_bake_miss_name((slv_bake_miss)i),
                            json_integer((json_int_t)report->misses[i]));
    for (uint32_t i = 0; i < ntiles; i++)
        json_array_append_new(
            list, json_pack("{s:o, s:I, s:I, s:I}", "tile",
                            tiles[i].number ? json_integer(tiles[i].number) : json_null(), "width",
                            (json_int_t)tiles[i].width, "height", (json_int_t)tiles[i].height,
                            "faces", (json_int_t)tiles[i].faces));
    return json_pack(
        "{s:i, s:o, s:I, s:I, s:I, s:s, s:s, s:I, s:I, s:[i,i], s:[i,i], s:I, s:o, "
        "s:o, s:o, s:o, s:o}",
        "schema", 1, "path", output_json_name(o->paths[1]), "faces", (json_int_t)report->faces,
        "constant_faces", (json_int_t)report->constant_faces, "channels",
        (json_int_t)slv_bake_source_get_desc(source)->nchannels, "type",
        slv_type_name(report->type), "encoding", slv_texture_encoding_name(report->encoding),
        "texels", (json_int_t)report->texels, "bytes", (json_int_t)report->bytes, "smallest",
        1 << report->smallest.u, 1 << report->smallest.v, "largest", 1 << report->largest.u,
        1 << report->largest.v, "missing", (json_int_t)missing(report), "misses", misses, "tiles",
        list, "error", measures(job) ? output_json_number((double)report->error) : json_null(),
        "error_bound",
        measures(job) ? output_json_number((double)report->error_bound) : json_null(), "faces_over",
        measures(job) ? json_integer((json_int_t)report->faces_over) : json_null());
}

/* Says that more texels than may have no value. */
static int judge(const bake_options *o, float max_miss, const slv_bake_report *report) {
    if (!((double)missing(report) > (double)max_miss * (double)report->texels))
        return EXIT_OK;
    char text[256] = "";
    size_t used = 0;
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        if (report->misses[i])
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %llu", used ? ", " : "",
                                     slv_bake_miss_name((slv_bake_miss)i),
                                     (unsigned long long)report->misses[i]);
    return cli_error("%s: is written, but %llu of %llu texels have no value (%s), more than "
                     "--max-miss %g; --miss-map shows where",
                     o->paths[1], (unsigned long long)missing(report),
                     (unsigned long long)report->texels, text, (double)max_miss);
}

/* Likewise of faces that are further from the source than was asked for. */
static int judge_error(const bake_options *o, const slv_bake_job *job, float max_over,
                       const slv_bake_report *report) {
    if (!(job->max_error > 0) ||
        !((double)report->faces_over > (double)max_over * (double)report->faces))
        return EXIT_OK;
    return cli_error("%s: is written, but %llu of %llu faces are not within %g of the source even "
                     "at the largest size that they may have, more than --max-over %g",
                     o->paths[1], (unsigned long long)report->faces_over,
                     (unsigned long long)report->faces, (double)job->max_error, (double)max_over);
}

int bake_report_tell(const bake_options *o, const slv_bake_recipe *recipe,
                     const slv_bake_report *report, const slv_bake_source *source) {
    const slv_bake_job *job = slv_bake_recipe_job(recipe);
    int over = judge_error(o, job, slv_bake_recipe_max_over(recipe), report),
        missing_too = judge(o, slv_bake_recipe_max_miss(recipe), report),
        code = over ? over : missing_too;
    if (o->json && output_print_json(o->paths[1], bake_json(o, job, report, source)))
        return EXIT_FAILED;
    if (!o->json && !o->quiet)
        print_result(o, job, report, source);
    return code;
}

/* Whether a polygon encloses no area, which is told from the longest of its sides. */
static bool is_flat(const slv_mesh_view *view, const int32_t *verts, int32_t count) {
    double area[3] = {0}, longest = 0;
    for (int32_t i = 0; i < count; i++) {
        const float *o = view->positions + 3 * (size_t)verts[0],
                    *a = view->positions + 3 * (size_t)verts[i],
                    *b = view->positions + 3 * (size_t)verts[(i + 1) % count];
        double x[3], y[3], side = 0;
        for (int k = 0; k < 3; k++) {
            x[k] = (double)a[k] - (double)o[k];
            y[k] = (double)b[k] - (double)o[k];
            side += (y[k] - x[k]) * (y[k] - x[k]);
        }
        for (int k = 0; k < 3; k++)
            area[k] += x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
        longest = fmax(longest, side);
    }
    return sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]) <= 1e-9 * longest;
}

void bake_mesh_tell(const slv_env *env, const char *path, const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    const int32_t *verts = view->poly_verts;
    uint32_t flat = 0, first = 0;
    slv_mesh_stats stats;
    for (uint32_t poly = 0; poly < view->npolys; verts += view->poly_sizes[poly++]) {
        if (!is_flat(view, verts, view->poly_sizes[poly]))
            continue;
        first = flat ? first : poly;
        flat++;
    }
    if (flat)
        cli_warning("%s: %u polygons have no area, the first is %u: their texels are baked, and "
                    "nobody will see them",
                    path, flat, first);
    if (!slv_mesh_get_stats(env, mesh, &stats) && stats.nnonmanifold_edges)
        cli_warning("%s: %u edges have more than two polygons: they are baked as boundaries, at "
                    "which faces do not agree",
                    path, stats.nnonmanifold_edges);
}
