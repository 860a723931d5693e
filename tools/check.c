/* The verb check: what is wrong with a .ptx, and a mended copy. */
#include "command/output.h"
#include "command/ptx_name.h"
#include "verbs.h"

#include <string.h>

struct check {
    const char *path, *mesh, *repair;
    float seams;
    bool seams_given, strict, tables, json, quiet, progress;
    uint32_t shown, threads;
};

/* What the findings add up to. */
struct verdict {
    uint64_t errors, warnings, repairable;
    bool good;
    const char *words;
};

static struct verdict judge(const struct check *c, const slv_ptx_report *report) {
    struct verdict verdict = {.good = true, .words = "sound"};
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++) {
        verdict.errors += report->counts[kind] - report->warnings[kind];
        verdict.warnings += report->warnings[kind];
    }
    for (uint32_t i = 0; i < report->nfindings; i++)
        verdict.repairable += report->findings[i].repairable;
    if (!report->opened || report->counts[SLV_CHECK_STRUCTURE])
        verdict.words = "unreadable";
    else if (verdict.errors)
        verdict.words = "damaged";
    else if (verdict.warnings > report->counts[SLV_CHECK_SEAMS])
        verdict.words = "sound, with warnings";
    else if (verdict.warnings)
        verdict.words = "sound, with seams";
    verdict.good = !verdict.errors && !(c->strict && verdict.warnings);
    return verdict;
}

static void print_report(const struct check *c, const char *path, const slv_ptx_report *report) {
    struct verdict verdict = judge(c, report);
    output_terminal(stdout, cli_shown(path), strlen(cli_shown(path)), SIZE_MAX);
    putchar('\n');
    for (uint32_t i = 0, end; i < report->nfindings; i = end) {
        slv_check_kind kind = report->findings[i].kind;
        for (end = i; end < report->nfindings && report->findings[end].kind == kind;)
            end++;
        printf("  %s: %llu finding%s\n", slv_check_kind_name(kind),
               (unsigned long long)report->counts[kind], report->counts[kind] == 1 ? "" : "s");
        uint32_t shown = end - i < c->shown ? end - i : c->shown;
        for (uint32_t k = i; k < i + shown; k++) {
            const slv_check_finding *finding = &report->findings[k];
            fputs(finding->warning ? "    warning: " : "    ", stdout);
            output_terminal(stdout, finding->message, strlen(finding->message), SIZE_MAX);
            fputs(finding->repairable ? " (--repair can help)\n" : "\n", stdout);
        }
        if (report->counts[kind] > shown)
            printf("    and %llu more\n", (unsigned long long)report->counts[kind] - shown);
    }
    if (report->nseams) {
        printf("  seams: %llu compared", (unsigned long long)report->nseams);
        if (report->worst_seam.face >= 0)
            printf(", the largest difference is %g at face %d edge %d",
                   (double)report->worst_seam.amount, report->worst_seam.face,
                   report->worst_seam.edge);
        putchar('\n');
    }
    printf("  verdict: %s", verdict.words);
    if (verdict.errors || verdict.warnings)
        printf(" (%llu error%s, %llu warning%s)", (unsigned long long)verdict.errors,
               verdict.errors == 1 ? "" : "s", (unsigned long long)verdict.warnings,
               verdict.warnings == 1 ? "" : "s");
    putchar('\n');
}

static json_t *number_or_null(int32_t value) {
    return value < 0 ? json_null() : json_integer(value);
}

static json_t *finding_json(const slv_check_finding *finding) {
    return json_pack(
        "{s:s, s:s, s:o, s:o, s:o, s:o, s:b, s:o}", "kind", slv_check_kind_name(finding->kind),
        "severity", finding->warning ? "warning" : "error", "face", number_or_null(finding->face),
        "edge", number_or_null(finding->edge), "level", number_or_null(finding->level), "amount",
        output_json_number((double)finding->amount), "repairable", (int)finding->repairable,
        "message", output_json_text(finding->message, strlen(finding->message)));
}

static json_t *report_json(const struct check *c, const char *path, const slv_ptx_report *report) {
    struct verdict verdict = judge(c, report);
    json_t *findings = json_array(), *counts = json_object();
    for (uint32_t i = 0; i < report->nfindings; i++)
        if (json_array_append_new(findings, finding_json(&report->findings[i])))
            goto failed;
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++)
        if (json_object_set_new(counts, slv_check_kind_name((slv_check_kind)kind),
                                json_integer((json_int_t)report->counts[kind])))
            goto failed;
    return json_pack(
        "{s:i, s:o, s:s, s:b, s:I, s:I, s:o, s:o, s:{s:I, s:o, s:o, s:o}}", "schema", 1, "path",
        output_json_name(path), "verdict", verdict.words, "good", (int)verdict.good, "errors",
        (json_int_t)verdict.errors, "warnings", (json_int_t)verdict.warnings, "counts", counts,
        "findings", findings, "seams", "compared", (json_int_t)report->nseams, "largest",
        output_json_number((double)report->worst_seam.amount), "face",
        number_or_null(report->worst_seam.face), "edge", number_or_null(report->worst_seam.edge));
failed:
    json_decref(findings);
    json_decref(counts);
    return NULL;
}

static int check_one(const struct check *c, const slv_env *env, const char *path,
                     const slv_mesh *mesh, slv_ptx_report **out) {
    cli_progress progress = cli_progress_fleeting("check", c->progress, c->quiet || c->json);
    slv_ptx_check_params params = {.mesh = mesh,
                                   .seams = c->seams_given,
                                   .seam_tolerance = c->seams,
                                   .no_texels = c->tables,
                                   .progress = {cli_progress_report, &progress}};
    slv_result result = slv_ptx_check(env, path, &params, out);
    cli_progress_end(&progress);
    return result ? EXIT_FAILED : EXIT_OK;
}

/* The mesh inside is the one to trust only if the table contradicts it or itself. */
static bool needs_geometry(const slv_ptx_report *report) {
    return report->counts[SLV_CHECK_ADJACENCY] || report->counts[SLV_CHECK_SUBFACES] ||
           report->counts[SLV_CHECK_MESH];
}

static int write_copy(const struct check *c, const slv_env *env, const slv_ptx_report *report,
                      const slv_mesh *given) {
    slv_ptx *ptx = NULL;
    slv_mesh *inside = NULL;
    int code = EXIT_FAILED;
    const slv_ptx_open_params lenient = {.lenient = true};
    for (uint32_t i = 0; i < report->nfindings; i++) {
        const slv_check_finding *finding = &report->findings[i];
        if (finding->kind == SLV_CHECK_STRUCTURE ||
            (finding->kind == SLV_CHECK_TEXELS && !finding->repairable))
            return cli_error("%s: what cannot be read cannot be repaired: %s", c->path,
                             finding->message);
    }
    if (slv_ptx_open_with(env, c->path, &lenient, &ptx))
        return EXIT_FAILED;
    cli_progress progress = cli_progress_fleeting("repair", c->progress, c->quiet || c->json);
    const slv_ptx_writer_params params = {.progress = {cli_progress_report, &progress}};
    cli_catch_interrupts();
    if ((given || !needs_geometry(report) || !slv_ptx_find_mesh(env, ptx, &inside, NULL)) &&
        !slv_ptx_repair(env, ptx, given ? given : inside, c->repair, &params))
        code = EXIT_OK;
    cli_progress_end(&progress);
    slv_mesh_destroy(inside);
    slv_ptx_close(ptx);
    return code;
}

static int run_check(struct check *c) {
    slv_env env = cli_env(c->threads);
    slv_mesh *mesh = NULL;
    slv_ptx_report *report = NULL, *copy = NULL;
    json_t *root = NULL;
    int code = EXIT_FAILED;
    const char *const inputs[] = {c->path, c->mesh};
    if (c->repair &&
        (output_check_in_place(&env, c->repair, inputs, 2) || output_try(&env, c->repair)))
        goto done;
    if (c->mesh && slv_mesh_load(&env, cli_input(c->mesh), &mesh))
        goto done;
    if (check_one(c, &env, c->path, mesh, &report))
        goto done;
    bool good = judge(c, report).good;
    if (!c->json && !c->quiet)
        print_report(c, c->path, report);
    if (c->repair) {
        if (write_copy(c, &env, report, mesh) || check_one(c, &env, c->repair, mesh, &copy))
            goto done;
        good = judge(c, copy).good;
        if (!c->json && !c->quiet)
            print_report(c, c->repair, copy);
    }
    if (c->json) {
        root = report_json(c, c->path, report);
        if (copy && json_object_set_new(root, "repaired", report_json(c, c->repair, copy))) {
            json_decref(root);
            root = NULL;
        }
        if (output_print_json(c->path, root))
            goto done;
    }
    code = good ? EXIT_OK : EXIT_FAILED;
done:
    slv_ptx_report_destroy(report);
    slv_ptx_report_destroy(copy);
    slv_mesh_destroy(mesh);
    return code;
}

int verb_check(int argc, char **argv) {
    struct check c = {.shown = 20};
    uint32_t narguments = 0;
    const cli_option options[] = {
        {"--mesh|-m", CLI_TEXT, &c.mesh, "compare with this control mesh too", "FILE.obj", 0, 0,
         NULL},
        {"--seams", CLI_FLOAT, &c.seams,
         "also compare both sides of every shared edge at full resolution; how far they may "
         "differ, integers as 0..1",
         "X", 0, 0, &c.seams_given},
        {"--tables", CLI_FLAG, &c.tables, "look at the tables only, not at texels", NULL, 0, 0,
         NULL},
        {"--repair|-r|--out|-o|--output", CLI_TEXT, &c.repair,
         "write a copy: reductions, averages and flags made anew, adjacency from the mesh",
         "OUT.ptx", 0, 0, NULL},
        {"--strict", CLI_FLAG, &c.strict, "warnings count as errors", NULL, 0, 0, NULL},
        {"--show", CLI_UINT, &c.shown, "findings of each kind to print (20)", NULL, 0, 1000, NULL},
        CLI_JSON(&c.json),
        CLI_PROGRESS(&c.progress),
        CLI_THREADS(&c.threads),
        CLI_QUIET(&c.quiet, "print nothing: the exit code says it"),
    };
    const cli_command command = {
        .name = "check",
        .summary = "say whether a .ptx is sound, naming face and edge of what is not",
        .arguments = "FILE.ptx [OUT.ptx|-o OUT.ptx]",
        .reads = "a texture; a mesh if it is named",
        .writes = "a mended copy if it is named; as an argument it must not exist yet",
        .exits = "0 sound, 1 not sound or failure, 2 wrong usage",
        .examples = "  selvage check teapot.ptx\n"
                    "  selvage check cow.ptx --mesh cow.obj --seams 0.02\n"
                    "  selvage check broken.ptx --repair mended.ptx\n"
                    "  selvage check teapot.ptx --json | jq '.findings[] | .face'\n",
        CLI_TAKES(options, 1, 1, &c.path, &narguments),
        .output = &c.repair,
        .output_is_new = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (c.seams < 0)
        return cli_usage(&command, "--seams: expected 0 or more");
    if (c.tables && c.seams_given)
        return cli_usage(&command, "--seams looks at texels, --tables does not");
    if (c.repair && !ptx_name_is_safe(c.repair))
        return ptx_name_usage(&command, c.repair);
    return run_check(&c);
}
