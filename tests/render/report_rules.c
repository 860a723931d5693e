/* What the report concludes from numbers, with numbers made up for it; and where its camera goes.
 */
#include "kit/strategy_kit.h"
#include "kit/test.h"

#include "compare/engine/report_findings.h"
#include "compare/engine/report_verdict.h"

#include <unistd.h>

static report_data report;

/* A strategy with times, memory, and RMS errors at seams and in all, at each rate. */
static void add(const char *strategy, double ms, double megabytes, double seam, double outline) {
    report_strategy *row = &report.strategies[report.nstrategies++];
    memset(row, 0, sizeof *row);
    row->strategy = kit_strategy(strategy);
    row->median_ms = ms;
    row->stats.gpu_bytes = (uint64_t)(megabytes * 1e6);
    row->stats.texel_bytes = 1000000;
    for (uint32_t r = 0; r < report.nrates; r++) {
        report_errors *errors = row->rates[r].errors;
        row->rates[r].median_ms = ms;
        for (int i = 0; i < 100; i++) {
            report_errors_add(&errors[REPORT_RAYCAST], REPORT_EDGE, seam);
            report_errors_add(&errors[REPORT_RAYCAST], REPORT_OUTLINE, outline);
        }
    }
}

static void begin(uint32_t nrates) {
    static const uint32_t samples[] = {1, 2, 4, 8};
    memset(&report, 0, sizeof report);
    report.nrates = nrates;
    report.shown = nrates - 1;
    for (uint32_t r = 0; r < nrates; r++)
        report.rates[r] = (report_rate){samples[r], samples[r], 1};
    report.reference.used[REPORT_RAYCAST] = true;
    report.reference.first = REPORT_RAYCAST;
}

static const char *advised(void) {
    report_advice advice = report_advise(&report);
    CHECK(advice.measured);
    return report.strategies[advice.take].strategy->name;
}

static void check_advice(void) {
    begin(1);
    add("clamp", 1, 1, 0.10, 0.2);
    add("borders", 1.5, 9, 0.0105, 0.2);
    add("traverse", 3, 2, 0.010, 0.2);
    add("discard", 1.1, 1, 0.05, 0.2);
    CHECK(strcmp(advised(), "borders") == 0); /* 5 % worse, half the time */
    report.strategies[2].median_ms = 1.55;    /* hardly slower: less memory decides */
    CHECK(strcmp(advised(), "traverse") == 0);
    report.strategies[2].median_ms = 1.60; /* more than 5 % */
    CHECK(strcmp(advised(), "borders") == 0);
    begin(1);
    add("traverse", 3, 2, 0.0100, 0.2);
    add("borders", 1.5, 9, 0.0112, 0.2);
    CHECK(strcmp(advised(), "traverse") == 0); /* 12 % are too much, at any speed */
    add("discard", 2, 1, 0.0109, 0.9);
    CHECK(strcmp(advised(), "discard") == 0); /* outlines do not count */
    report.reference.first = REPORT_SOURCES;
    report.reference.used[REPORT_RAYCAST] = false;
    CHECK(!report_advise(&report).measured);
    begin(1);
    add("clamp", 1, 1, 0, 0);
    add("traverse", 2, 1, 0, 0);
    CHECK(strcmp(advised(), "clamp") == 0); /* no errors at all: the quickest */
}

static void set_error(uint32_t rate, uint32_t strategy, double error) {
    report_errors *errors = &report.strategies[strategy].rates[rate].errors[REPORT_RAYCAST];
    memset(errors, 0, sizeof *errors);
    for (int i = 0; i < 10; i++)
        report_errors_add(errors, REPORT_EDGE, error);
}

static void check_findings(void) {
    report_finding f[REPORT_FINDINGS];
    begin(4);
    add("traverse", 4, 1, 0.01, 0);
    add("discard", 2, 1, 0.01, 0);
    const double as_toth[4] = {0.013, 0.011, 0.0101, 0.0095};
    for (uint32_t r = 0; r < 4; r++) {
        set_error(r, 0, 0.01);
        set_error(r, 1, as_toth[r]);
        report_errors_add(&report.apart[r], REPORT_INTERIOR, 0.1 / (r + 1));
        report.strategies[0].rates[r].median_ms = 4 + r;
        report.strategies[1].rates[r].median_ms = 2 + 0.5 * r;
    }
    report_find_out(&report, f);
    for (int i = 0; i < REPORT_FINDINGS; i++)
        CHECK_MSG(f[i].judgement == REPORT_REPRODUCED, "%s: %s: %s", f[i].claim,
                  report_judgement_name(f[i].judgement), f[i].numbers);

    set_error(1, 1, 0.00985); /* at two samples discard is ahead by less than 2 % */
    set_error(2, 1, 0.0115);  /* at four behind by more than 10 % */
    set_error(3, 1, 0.0105);  /* and at eight by more than 2 % */
    report_errors_add(&report.apart[3], REPORT_INTERIOR, 0.5); /* and less like traverse */
    report.strategies[1].rates[2].median_ms = 4.5;
    report_find_out(&report, f);
    CHECK(f[0].judgement == REPORT_UNDECIDED && f[1].judgement == REPORT_REFUTED &&
          f[2].judgement == REPORT_REFUTED && f[3].judgement == REPORT_REFUTED);
    CHECK(f[4].judgement == REPORT_REPRODUCED && f[5].judgement == REPORT_REFUTED);
    set_error(1, 1, 0.009);
    report_find_out(&report, f);
    CHECK(f[0].judgement == REPORT_REFUTED); /* though it holds at one */

    report.nrates = 1;
    report_find_out(&report, f);
    CHECK(f[0].judgement == REPORT_REPRODUCED && f[4].judgement == REPORT_REPRODUCED);
    for (int i = 1; i < REPORT_FINDINGS; i++)
        CHECK(i == 4 || f[i].judgement == REPORT_UNMEASURED);
    report.nstrategies = 1;
    report_find_out(&report, f);
    for (int i = 0; i < REPORT_FINDINGS; i++)
        CHECK(f[i].judgement == REPORT_UNMEASURED && !f[i].numbers[0]);
}

/* Close views are judged by the jumps of magnified lookups. */
static void check_verdict(void) {
    begin(1);
    add("clamp", 1, 1, 0, 0);
    add("borders", 2, 5, 0, 0);
    add("traverse", 3, 2, 0, 0);
    const float all[3] = {0.5f, 0.02f, 0.001f}, equal[3] = {0.5f, 0.001f, 0};
    for (int k = 0; k < 3; k++)
        report.strategies[k].seams[0] = (slv_gl_seam){
            .max = all[k], .equal_max = equal[k], .nedges = 10, .nequal = 5, .face = 0};
    report_verdict v = report_judge(&report);
    CHECK(v.outcome == REPORT_SEAMLESS && v.best == 2 && v.baseline == 0);
    report.strategies[2].seams[0].max = 0.1f;
    v = report_judge(&report);
    CHECK(v.outcome == REPORT_EQUAL_ONLY && v.best == 1); /* both are; it is the quicker */
    report.strategies[1].seams[0].equal_max = report.strategies[2].seams[0].equal_max = 0.1f;
    v = report_judge(&report);
    CHECK(v.outcome == REPORT_ALL_VISIBLE && v.best == 1);
    for (int k = 0; k < 3; k++)
        report.strategies[k].seams[0].nedges = report.strategies[k].seams[0].nequal = 0;
    v = report_judge(&report);
    CHECK(v.outcome == REPORT_NO_SEAMS && v.best == 0);
}

static void check_tallies(void) {
    report_errors errors = {0}, more = {0};
    report_errors_add(&errors, REPORT_INTERIOR, 0);
    report_errors_add(&errors, REPORT_EDGE, 3.0 / 255);
    report_errors_add(&more, REPORT_REGULAR, 0.3);
    report_errors_add(&more, REPORT_OUTLINE, INFINITY);
    report_errors_merge(&errors, &more);
    report_tally seams = report_errors_part(&errors, REPORT_SEAMS);
    CHECK(seams.npixels == 2 && seams.over[0] == 2 && seams.over[1] == 1 && seams.max == 0.3);
    CHECK(fabs(report_rms(&seams) - sqrt((9.0 / 65025 + 0.09) / 2)) < 1e-12);
    CHECK(report_share(&errors, 0) == 0.75 && report_share(&errors, 40) == 0.25);
    CHECK(isnan(report_rms(&(report_tally){0})));
    const float zero[3] = {0, 0, 0}, three[3] = {1, 2, 2}, bad[3] = {NAN, 0, 0};
    CHECK(report_distance(zero, three) == 3 && report_distance(zero, bad) == INFINITY);
    CHECK(report_error_step(0) == 1.0 / 1024 && report_error_step(40) == 1);
}

static double distance_from(const slv_camera *camera, const float *point) {
    const float *m = camera->world_to_camera + 8;
    return -((double)m[0] * (double)point[0] + (double)m[1] * (double)point[1] +
             (double)m[2] * (double)point[2] + (double)m[3]);
}

static void check_orbit(void) {
    orbit path = {.azimuth = 30,
                  .turn = 360,
                  .elevation = 20,
                  .tilt = 15,
                  .fov = 35,
                  .dolly = 2.5f,
                  .bounds_min = {-1, -1, -1},
                  .bounds_max = {3, 1, 1},
                  .aspect = 1.5f};
    const float middle[3] = {1, 0, 0};
    slv_camera start = slv_camera_orbit(path.bounds_min, path.bounds_max, 30, 20, 35, 1.5f);
    slv_camera first = orbit_camera(&path, 0), last = orbit_camera(&path, 1);
    CHECK(memcmp(&start, &first, sizeof start) == 0);
    double nearest = INFINITY, farthest = 0, frames = distance_from(&start, middle);
    for (int i = 0; i < 16; i++)
        CHECK(fabsf(first.world_to_camera[i] - last.world_to_camera[i]) < 1e-4f);
    for (int i = 0; i < 400; i++) {
        slv_camera at = orbit_camera(&path, i / 400.0);
        double distance = distance_from(&at, middle), reach = 0;
        for (int k = 0; k < 3; k++)
            reach += fabs((double)at.world_to_camera[8 + k]) * (k ? 1 : 2);
        CHECK_MSG(distance > reach, "frame %d is inside the box", i);
        CHECK(fabsf(at.world_to_camera[9] -
                    sinf((20 + 15 * sinf(6 * 3.14159265f * (float)i / 400)) * 3.14159265f / 180)) <
              1e-4f);
        nearest = fmin(nearest, distance);
        farthest = fmax(farthest, distance);
    }
    CHECK(nearest < frames * 0.6 && farthest > frames * 2);
    path.fov = 0;
    slv_camera flat = orbit_camera(&path, 0.25);
    start = slv_camera_orbit(path.bounds_min, path.bounds_max, 120, 5, 0, 1.5f);
    for (int i = 0; i < 4; i++)
        CHECK(fabsf(flat.window[i] * 2.5f / start.window[i] - 1) < 1e-4f);
    path.dolly = 1;
    path.tilt = 0;
    flat = orbit_camera(&path, 0.25);
    start = slv_camera_orbit(path.bounds_min, path.bounds_max, 120, 20, 0, 1.5f);
    for (int i = 0; i < 16; i++)
        CHECK(fabsf(flat.world_to_camera[i] - start.world_to_camera[i]) < 1e-5f);

    slv_camera part = orbit_part(&first, 0.25, 0.5, 0.75, 1);
    CHECK(fabsf(part.window[0] - first.window[0] / 2) < 1e-6f && fabsf(part.window[3]) < 1e-6f &&
          part.window[2] == first.window[2]);
    slv_camera moved = orbit_shifted(&first, 150, 100, 1, 1);
    float pixel = (first.window[1] - first.window[0]) / 150;
    CHECK(fabsf(moved.window[0] - first.window[0] - pixel) < 1e-6f &&
          fabsf(moved.window[3] - first.window[3] + pixel) < 1e-6f);
}

int main(void) {
    check_tallies();
    check_advice();
    check_findings();
    check_verdict();
    check_orbit();
    return test_end();
}
