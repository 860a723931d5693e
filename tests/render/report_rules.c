/* What the report concludes from numbers, with numbers made up for it; and where its camera goes.
 */
#include "kit/strategy_kit.h"
#include "kit/test.h"

#include "compare/engine/busy.h"
#include "compare/engine/report_findings.h"
#include "compare/report/report_words.h"

#include <unistd.h>

static report_data report;

/* A strategy with times, memory, and RMS errors at seams and in all, at each rate. */
static void add(const char *strategy, double ms, double megabytes, double seam, double outline) {
    report_strategy *row = &report.strategies[report.nstrategies++];
    memset(row, 0, sizeof *row);
    row->strategy = kit_strategy(strategy);
    row->median_ms = ms;
    row->ratio = (interval){ms, ms, ms};
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

/* Of a strategy that errs by `inside` and `seams`, jumps by `jump`, all in 1/255, and takes so much
 * memory and time. */
static report_figures figures(double inside, double seams, double jump, double megabytes,
                              double low, double high) {
    return (report_figures){.exact = {inside / 255, seams / 255, jump / 255, megabytes * 1e6},
                            .time = {(low + high) / 2, low, high}};
}

#define ADVISE(...)                                                                                \
    report_advise_figures((const report_figures[]){__VA_ARGS__},                                   \
                          sizeof(const report_figures[]){__VA_ARGS__} / sizeof(report_figures))

/* Each factor decides where nothing else differs, and only where it may. */
static void check_winners(void) {
    report_advice a;
    a = ADVISE(figures(2, 5, 9, 10, 1, 1), figures(1, 5, 9, 10, 1, 1));
    CHECK(a.measured && a.take == 1 && a.ntied == 1 && fabs(a.low[0] - 1) < 1e-9 && a.low[1] == 0);
    a = ADVISE(figures(1, 10, 9, 10, 1, 1), figures(1, 5, 9, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1 && fabs(a.points[0][REPORT_ERROR_SEAMS] - 1) < 1e-9);
    a = ADVISE(figures(1, 5, 16, 10, 1, 1), figures(1, 5, 0.5, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1 && fabs(a.points[0][REPORT_CLOSE_UP] - 1) < 1e-6);
    a = ADVISE(figures(1, 5, 9, 40, 1, 1), figures(1, 5, 9, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1 && fabs(a.points[0][REPORT_MEMORY] - 1) < 1e-9);
    a = ADVISE(figures(1, 5, 9, 10, 5, 5), figures(1, 5, 9, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1 && fabs(a.points[0][REPORT_TIME] - 0.5) < 1e-9);
    /* what nobody sees is no difference, and nor is a little time */
    a = ADVISE(figures(0.01, 0.02, 0.5, 10, 1.2, 1.2), figures(0.2, 0.2, 0, 10, 1, 1));
    CHECK(a.take == 0 && a.ntied == 2 && a.high[0] == 0 && a.high[1] == 0);
    /* twice the error is worth four times the memory, and sixteen times the time above the margin
     */
    a = ADVISE(figures(1, 5, 9, 39, 1, 1), figures(1, 10, 9, 10, 1, 1));
    CHECK(a.take == 0);
    a = ADVISE(figures(1, 5, 9, 46, 1, 1), figures(1, 10, 9, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1);
    a = ADVISE(figures(1, 5, 9, 10, 15, 15), figures(1, 10, 9, 10, 1, 1));
    CHECK(a.take == 0 && a.ntied == 1);
    a = ADVISE(figures(1, 5, 9, 10, 30, 30), figures(1, 10, 9, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1);
}

/* Noise widens intervals: that makes ties, and does not change who is taken. */
static void check_noise(void) {
    const report_figures clamp = figures(0.2, 5, 120, 10.6, 1, 1),
                         borders = figures(0.2, 2.4, 15, 62, 1.1, 1.2),
                         traverse = figures(0.2, 2.5, 0, 11.6, 1.3, 1.5),
                         aligned = figures(0.4, 3.9, 0.5, 13.6, 1, 1.1);
    report_advice calm = ADVISE(clamp, borders, traverse, aligned);
    CHECK(calm.take == 2 && calm.ntied == 1);
    uint64_t seed = 7;
    for (int run = 0; run < 1000; run++) {
        report_figures noisy[4] = {clamp, borders, traverse, aligned};
        for (int k = 1; k < 4; k++) {
            double width = 1 + (double)(test_random(&seed) % 1000) / 1000;
            double shift = 0.8 + (double)(test_random(&seed) % 400) / 1000;
            noisy[k].time.low *= shift / width;
            noisy[k].time.high *= shift * width;
        }
        report_advice one = report_advise_figures(noisy, 4);
        CHECK_MSG(one.take == 2, "run %d takes %u", run, one.take);
    }
    /* so wide that time could turn it: both are named, and the one that is better besides time */
    report_advice a = ADVISE(figures(1, 5, 9, 10, 1, 40), figures(1, 5.5, 9, 10, 0.9, 1.1));
    CHECK(a.take == 0 && a.ntied == 2 && a.tied[0] && a.tied[1]);
    /* certain beyond all noise, time does decide */
    a = ADVISE(figures(1, 5, 9, 10, 30, 40), figures(1, 5.5, 9, 10, 0.9, 1.1));
    CHECK(a.take == 1 && a.ntied == 1);
}

static void check_missing(void) {
    report_advice a = ADVISE(figures(NAN, NAN, 9, 10, 1, 1), figures(NAN, NAN, 3, 10, 1, 1));
    CHECK(!a.measured);
    a = ADVISE(figures(1, NAN, NAN, 10, 1, 1), figures(3, NAN, NAN, 10, 1, 1));
    CHECK(a.measured && a.take == 0 && a.ntied == 1);
    a = ADVISE(figures(1, INFINITY, 0, 10, 1, 1), figures(3, 1, 0, 10, 1, 1));
    CHECK(a.take == 1 && a.ntied == 1);
    a = ADVISE(figures(0, 0, 0, 10, 1, 1), figures(0, 0, 0, 10, 1, 1), figures(9, 0, 0, 10, 1, 1));
    CHECK(a.take == 0 && a.ntied == 2 && !a.tied[2]);
}

static void check_advice(void) {
    char *text = NULL;
    size_t size = 0;
    begin(1);
    add("clamp", 1, 1, 0.10, 0.2);
    add("borders", 1.5, 9, 0.0105, 0.2);
    add("traverse", 1.2, 2, 0.010, 0.9); /* outlines do not count */
    add("hybrid", 1.2, 2, 0.010, 0.2);
    report_advice advice = report_advise(&report);
    CHECK(advice.measured && advice.take == 2 && advice.ntied == 2);
    FILE *stream = open_memstream(&text, &size);
    REQUIRE(stream);
    report_write_advice(stream, &report, &advice);
    report_write_rule(stream, &report, &advice);
    REQUIRE(fclose(stream) == 0);
    CHECK_MSG(strstr(text, "<strong>traverse</strong>, which is tied with hybrid: 0.50 points"),
              "%s", text);
    CHECK_MSG(strstr(text, "0.5 for memory") && strstr(text, ">borders</th>"), "%s", text);
    free(text);
    report.reference.first = REPORT_SOURCES;
    report.reference.used[REPORT_RAYCAST] = false;
    CHECK(!report_advise(&report).measured && !report_advise_cameras(&report).measured);
}

static void check_intervals(void) {
    double values[40];
    for (int i = 0; i < 40; i++)
        values[i] = 40 - i;
    interval all = interval_of(values, 40);
    CHECK(all.median == 20.5 && all.low == 14 && all.high == 27); /* tables of the sign test */
    CHECK(interval_coverage(40) > 0.95 && interval_coverage(40) < 0.97);
    double few[] = {3, 1, 2}, nine[] = {9, 8, 7, 6, 1, 2, 3, 4, 5}, one = 4;
    interval three = interval_of(few, 3), some = interval_of(nine, 9),
             single = interval_of(&one, 1);
    CHECK(three.median == 2 && three.low == 1 && three.high == 3);
    CHECK(fabs(interval_coverage(3) - 0.75) < 1e-9 && interval_coverage(1) == 0);
    CHECK(some.median == 5 && some.low == 2 && some.high == 8);
    CHECK(fabs(interval_coverage(9) - (1 - 20.0 / 512)) < 1e-9);
    CHECK(single.median == 4 && single.low == 4 && single.high == 4);
    CHECK(interval_coverage(100000) >= 0.95);
}

static void check_busy(void) {
    double ticks = 0;
    CHECK(busy_parse("cpu  100 20 30 4000 50 6 7 8 9 9\ncpu0 1 2 3 4\n", &ticks) && ticks == 171);
    CHECK(busy_parse("cpu 1 2 3 4\n", &ticks) && ticks == 6); /* as old kernels have it */
    CHECK(!busy_parse("", &ticks) && !busy_parse("intr 4 5 6 7", &ticks));
    busy_sample from = {.clock = 10, .all = 100, .own = 5},
                to = {.clock = 20, .all = 118, .own = 8};
    CHECK(busy_others(&from, &to) == 1.5 && busy_others(&to, &from) == 0);
    to.all = NAN;
    CHECK(busy_others(&from, &to) == 0);
    to.all = 102; /* clocks of different grain */
    CHECK(busy_others(&from, &to) == 0);
    from = busy_now();
    CHECK(from.clock > 0 && from.own > 0);
    report.others = 0.05;
    CHECK(!report_disturbed(&report));
    report.others = 0.5;
    CHECK(report_disturbed(&report));
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
    CHECK(v.outcome == REPORT_EQUAL_ONLY && v.best == 2); /* both are; it is the smaller */
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
    check_intervals();
    check_busy();
    check_winners();
    check_noise();
    check_missing();
    check_advice();
    check_findings();
    check_verdict();
    check_orbit();
    return test_end();
}
