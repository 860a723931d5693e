/* The verb diff: which faces of two files differ. */
#include "diff/diff.h"
#include "command/salvage.h"
#include "verbs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What to leave out is taken away here, so that all that follows counts and shows the same. */
static void ignore_what_is_allowed(struct diff *d) {
    uint8_t mask = d->texels ? SLV_DIFF_TEXELS | SLV_DIFF_MISSING : UINT8_MAX;
    for (uint32_t face = 0; face < d->nfaces; face++) {
        slv_face_diff *diff = &d->faces[face];
        diff->what &= mask;
        if (!(diff->what & SLV_DIFF_ADJACENCY))
            diff->edge = -1;
        d->ndifferent += diff->what != 0;
        if (diff->largest > d->largest) {
            d->largest = diff->largest;
            d->largest_face = (int32_t)face;
        }
    }
}

static void print_face(const struct diff *d, uint32_t face) {
    const slv_face_diff *f = &d->faces[face];
    const char *separator = ": ";
    printf("    face %u", face);
    if (f->what & SLV_DIFF_MISSING) {
        printf(": only in %s",
               face < slv_ptx_get_info(d->files[0])->nfaces ? "the first" : "the second");
        separator = ", ";
    }
    if (f->what & SLV_DIFF_RES) {
        printf("%s%u x %u and %u x %u texels", separator, 1u << f->res[0].u, 1u << f->res[0].v,
               1u << f->res[1].u, 1u << f->res[1].v);
        separator = ", ";
    }
    if (f->what & SLV_DIFF_SUBFACE) {
        printf("%sa sub-face in one only", separator);
        separator = ", ";
    }
    if (f->what & SLV_DIFF_ADJACENCY) {
        printf("%sedge %d has another neighbour", separator, f->edge);
        separator = ", ";
    }
    if (f->what & SLV_DIFF_TEXELS)
        printf("%s%llu of %llu texels, by up to %g (mean %.3g), most at texel %u,%u channel %u",
               separator, (unsigned long long)f->ndifferent,
               (unsigned long long)1 << (f->compared.u + f->compared.v), (double)f->largest,
               f->mean, f->x, f->y, f->channel);
    putchar('\n');
}

static void print_diff(const struct diff *d) {
    uint32_t shown = 0;
    if (d->equal) {
        if (d->largest > 0)
            printf("equal within the tolerance; the largest difference is %g, at face %d\n",
                   (double)d->largest, d->largest_face);
        else
            puts("equal");
        return;
    }
    for (uint32_t i = 0; i < d->nnotes; i++) {
        fputs("  ", stdout);
        output_terminal(stdout, d->notes[i], strlen(d->notes[i]), SIZE_MAX);
        putchar('\n');
    }
    if (d->ndifferent)
        printf("  faces: %u of %u differ\n", d->ndifferent, d->nfaces);
    for (uint32_t face = 0; face < d->nfaces && shown < d->show; face++)
        if (d->faces[face].what) {
            print_face(d, face);
            shown++;
        }
    if (d->ndifferent > shown)
        printf("    and %u more (--show)\n", d->ndifferent - shown);
    if (d->largest > 0)
        printf("  largest difference: %g, at face %d\n", (double)d->largest, d->largest_face);
    puts("different");
}

static json_t *face_json(const struct diff *d, uint32_t face) {
    const slv_face_diff *f = &d->faces[face];
    return json_pack(
        "{s:I, s:b, s:b, s:b, s:b, s:b, s:[I,I], s:[I,I], s:o, s:I, s:o, s:o, s:[I,I], s:I}",
        "face", (json_int_t)face, "texels", (f->what & SLV_DIFF_TEXELS) != 0, "resolution",
        (f->what & SLV_DIFF_RES) != 0, "adjacency", (f->what & SLV_DIFF_ADJACENCY) != 0, "subface",
        (f->what & SLV_DIFF_SUBFACE) != 0, "missing", (f->what & SLV_DIFF_MISSING) != 0, "size_a",
        (json_int_t)1 << f->res[0].u, (json_int_t)1 << f->res[0].v, "size_b",
        (json_int_t)1 << f->res[1].u, (json_int_t)1 << f->res[1].v, "edge",
        f->edge < 0 ? json_null() : json_integer(f->edge), "different_texels",
        (json_int_t)f->ndifferent, "largest", output_json_number((double)f->largest), "mean",
        output_json_number(f->mean), "at", (json_int_t)f->x, (json_int_t)f->y, "channel",
        (json_int_t)f->channel);
}

static json_t *diff_json(const struct diff *d) {
    json_t *notes = json_array(), *faces = json_array();
    for (uint32_t i = 0; i < d->nnotes; i++)
        if (json_array_append_new(notes, output_json_text(d->notes[i], strlen(d->notes[i]))))
            goto failed;
    for (uint32_t face = 0; face < d->nfaces; face++)
        if (d->faces[face].what && json_array_append_new(faces, face_json(d, face)))
            goto failed;
    return json_pack("{s:i, s:o, s:o, s:b, s:o, s:I, s:I, s:o, s:o, s:o, s:o}", "schema", 1, "a",
                     output_json_name(d->paths[0]), "b", output_json_name(d->paths[1]), "equal",
                     (int)d->equal, "tolerance", output_json_number((double)d->tolerance), "faces",
                     (json_int_t)d->nfaces, "different_faces", (json_int_t)d->ndifferent, "largest",
                     output_json_number((double)d->largest), "largest_face",
                     d->largest_face < 0 ? json_null() : json_integer(d->largest_face),
                     "differences", notes, "face_list", faces);
failed:
    json_decref(notes);
    json_decref(faces);
    return NULL;
}

/* As diff(1) has it. */
enum { EXIT_DIFFERENT = 1, EXIT_TROUBLE = 2 };

static int run_diff(struct diff *d) {
    slv_env env = cli_env(d->threads);
    cli_progress progress = cli_progress_fleeting("diff", d->progress, d->quiet || d->json);
    slv_ptx_diff_params params = {.tolerance = d->tolerance,
                                  .progress = {cli_progress_report, &progress}};
    int code = EXIT_TROUBLE;
    d->largest_face = -1;
    if (d->images && output_try_folder(&env, d->images))
        goto done;
    for (int i = 0; i < 2; i++)
        if (salvage_open(&env, d->paths[i], d->salvage, &d->files[i]))
            goto done;
    for (int i = 0; i < 2; i++)
        if (slv_ptx_get_info(d->files[i])->nfaces > d->nfaces)
            d->nfaces = slv_ptx_get_info(d->files[i])->nfaces;
    d->faces = calloc((size_t)d->nfaces + 1, sizeof *d->faces);
    if (!d->faces) {
        cli_error("no memory to compare %u faces", d->nfaces);
        goto done;
    }
    if (slv_ptx_diff(&env, d->files[0], d->files[1], &params, d->faces))
        goto done;
    cli_progress_end(&progress);
    ignore_what_is_allowed(d);
    if (diff_files(d))
        goto done;
    d->equal = !d->nnotes && !d->ndifferent;
    if (d->images && diff_save_images(&env, d))
        goto done;
    if (!d->json && !d->quiet)
        print_diff(d);
    if (d->json && output_print_json(d->paths[0], diff_json(d)))
        goto done;
    /* an answer that cannot be written is no answer */
    code = cli_answered(EXIT_OK) ? EXIT_TROUBLE : d->equal ? EXIT_OK : EXIT_DIFFERENT;
    for (int i = 0; i < 2; i++)
        if (salvage_tell(d->files[i]) && !code)
            code = EXIT_DIFFERENT;
done:
    cli_progress_end(&progress);
    for (int i = 0; i < 2; i++)
        slv_ptx_close(d->files[i]);
    for (uint32_t i = 0; i < d->nnotes; i++)
        free(d->notes[i]);
    free(d->notes);
    free(d->faces);
    return code;
}

int verb_diff(int argc, char **argv) {
    struct diff d = {.show = 20};
    uint32_t narguments = 0;
    const cli_option options[] = {
        {"--tolerance", CLI_FLOAT, &d.tolerance,
         "how far two values may differ, integers as 0..1 (0)", "X", 0, 0, NULL},
        {"--texels", CLI_FLAG, &d.texels,
         "texels only: types, sizes, neighbours and metadata may differ", NULL, 0, 0, NULL},
        {"--images|--out|-o|--output", CLI_TEXT, &d.images,
         "a folder for a picture of every face that differs", "FOLDER", 0, 0, NULL},
        {"--format", CLI_CHOICE, &d.format,
         "png (16 bit, the largest difference white) or exr (the differences themselves) (png)",
         "png|exr", 0, 0, NULL},
        {"--show", CLI_UINT, &d.show, "faces to print (20)", NULL, 0, UINT32_MAX, NULL},
        CLI_SALVAGE(&d.salvage),
        CLI_JSON(&d.json),
        CLI_PROGRESS(&d.progress),
        CLI_THREADS(&d.threads),
        CLI_QUIET(&d.quiet, "print nothing: the exit code says it"),
    };
    const cli_command command = {
        .name = "diff",
        .summary = "say which faces of two .ptx files differ, how much and where",
        .arguments = "A.ptx B.ptx [FOLDER|-o FOLDER]",
        .reads = "two textures",
        .writes = "a folder of pictures if it is named; as an argument it must not exist yet",
        .exits = "0 equal, 1 different, 2 trouble or wrong usage",
        .examples = "  selvage diff before.ptx after.ptx\n"
                    "  selvage diff teapot.ptx teapot16.ptx --texels --tolerance 0.002\n"
                    "  selvage diff before.ptx after.ptx --images differences --format exr\n"
                    "  selvage diff before.ptx after.ptx --json | jq '.face_list[].face'\n",
        CLI_TAKES(options, 2, 2, d.paths, &narguments),
        .output = &d.images,
        .output_is_new = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (d.tolerance < 0)
        return cli_usage(&command, "--tolerance: expected 0 or more");
    return run_diff(&d);
}
