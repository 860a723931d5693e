/* The command `selvage sample`: what was written down comes out, in any form and order of work. */
#include "kit/tool_kit.h"

#define CUBE_QUERY "box 0 0 0 1 0 0 4 5 0.5 0.5 0.25 0 0 0.25"

static char *read_text(const char *path) {
    size_t size = 0;
    char *text = (char *)read_whole(path, &size);
    REQUIRE(text);
    text[size] = 0;
    return text;
}

/* Compares the numbers that follow in both texts; `between` them are the separators of one. */
static bool same_values(const char *expected, const char *found, const char *between) {
    for (int count = 0;; count++) {
        char *end[2];
        double a = strtod(expected, &end[0]);
        found += strspn(found, between);
        double b = strtod(found, &end[1]);
        if (end[0] == expected || end[1] == found)
            return count > 0 && end[0] == expected && end[1] == found;
        if (!(fabs(a - b) <= 1e-5 * fmax(1, fabs(a))))
            return false;
        expected = end[0] + strspn(end[0], " ");
        found = end[1];
        if (*expected == '\n')
            return *found == '\n' || *found == ']';
    }
}

/* Every line of the list, its values aside, and the values. */
static int compare_text(const char *list, const char *expected, const char *found) {
    int lines = 0, wrong = 0;
    for (; *expected && *found; lines++) {
        const char *arrow = strstr(expected, "->");
        REQUIRE(arrow);
        size_t length = (size_t)(arrow - expected) + 3;
        wrong += strncmp(expected, found, length) != 0 ||
                 !same_values(expected + length, found + length, " ");
        expected = strchr(expected, '\n') + 1;
        found = strchr(found, '\n') + 1;
    }
    CHECK_MSG(wrong == 0 && !*expected && !*found && lines > 0, "%s: %d of %d lines are wrong",
              list, wrong, lines);
    return lines;
}

static void compare_json(const char *list, const char *expected, const char *found) {
    char words[40];
    int line = 0, wrong = 0;
    for (; *expected; expected = strchr(expected, '\n') + 1) {
        snprintf(words, sizeof words, "{\"line\": %d, \"values\": [", ++line);
        const char *next = strstr(found, words);
        if (next)
            found = next + strlen(words);
        wrong += !next || !same_values(strstr(expected, "->") + 3, found, " ,");
    }
    snprintf(words, sizeof words, "\"count\": %d,", line);
    CHECK_MSG(wrong == 0 && strstr(found, words) && strstr(found, "\"failed\": 0,") &&
                  strstr(found, "\"complete\": true"),
              "%s: %d of %d lines are wrong", list, wrong, line);
}

static void check_list(const char *folder, const char *name) {
    char list[2048], file[2048];
    const char *premultiply = "";
    snprintf(list, sizeof list, "%s/%s", folder, name);
    snprintf(file, sizeof file, "%s", list);
    *strstr(file, ".filter.txt") = 0;
    size_t length = strlen(file);
    if (length > 8 && strcmp(file + length - 8, ".premult") == 0) {
        file[length - 8] = 0;
        premultiply = "--premultiply";
    }
    RUNS(0, "sample '%s.ptx' -i '%s' -o one.txt --threads 1 %s", file, list, premultiply);
    RUNS(0, "sample '%s.ptx' -o three.txt --threads 3 --cache 8 %s < '%s'", file, premultiply,
         list);
    RUNS(0, "sample '%s.ptx' --queries '%s' --json -o one.json %s", file, list, premultiply);
    CHECK(same_bytes(tool_path("one.txt"), tool_path("three.txt")));
    char *expected = read_text(list), *text = read_text(tool_path("one.txt")),
         *json = read_text(tool_path("one.json"));
    compare_text(name, expected, text);
    compare_json(name, expected, json);
    free(expected);
    free(text);
    free(json);
}

static void check_lists(void) {
    const char *folders[2] = {data_folder(), getenv("SELVAGE_CONFORMANCE")};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        DIR *folder = folders[i] ? opendir(folders[i]) : NULL;
        struct dirent *entry;
        while (folder && (entry = readdir(folder))) {
            size_t length = strlen(entry->d_name);
            if (length < 11 || strcmp(entry->d_name + length - 11, ".filter.txt") != 0)
                continue;
            char twins[2][2048];
            for (int k = 0; k < 2; k++)
                snprintf(twins[k], sizeof twins[k], "%s/%s", folders[k] ? folders[k] : "",
                         entry->d_name);
            if (i == 1 && same_bytes(twins[0], twins[1]))
                continue;
            check_list(folders[i], entry->d_name);
            count++;
        }
        if (folder)
            closedir(folder);
    }
    CHECK_MSG(count >= 20, "%d lists", count);
}

/* More than one chunk of lines, each line many times, comments and Windows' line ends between. */
static void check_long_list(void) {
    const int times = TEST_SANITIZED || test_brief() ? 30 : 120;
    char list[2048];
    snprintf(list, sizeof list, "%s/cube_u16_rgba.filter.txt", data_folder());
    char *expected = read_text(list);
    FILE *queries = fopen(tool_path("long.txt"), "w"), *whole = fopen(tool_path("whole.txt"), "w");
    REQUIRE(queries && whole);
    for (int i = 0; i < times; i++) {
        fprintf(queries, "# %d\n\n", i);
        for (const char *line = expected; *line; line = strchr(line, '\n') + 1) {
            int length = (int)(strstr(line, " ->") - line);
            fprintf(queries, i % 2 ? "%.*s\n" : "%.*s  \r\n", length, line);
        }
        fputs(expected, whole);
    }
    fprintf(queries, "  \t" CUBE_QUERY);
    CHECK(fclose(queries) == 0 && fclose(whole) == 0);
    free(expected);
    for (int threads = 1; threads <= 3; threads += 2)
        RUNS(0, "sample '%s/cube_u16_rgba.ptx' -o %d.txt --threads %d < long.txt", data_folder(),
             threads, threads);
    CHECK(same_bytes(tool_path("1.txt"), tool_path("3.txt")));
    RUNS(0, "sample '%s/cube_u16_rgba.ptx' -i long.txt --progress -o again.txt", data_folder());
    HAS("sample: 100% after");
    CHECK(same_bytes(tool_path("1.txt"), tool_path("again.txt")));
    char *found = read_text(tool_path("1.txt")), *text = read_text(tool_path("whole.txt"));
    char *last = strstr(found, "  \t" CUBE_QUERY " -> ");
    REQUIRE(last);
    *last = 0;
    CHECK(compare_text("long.txt", text, found) == times * 600);
    free(found);
    free(text);
}

static void check_malformed(void) {
    static const struct {
        const char *line, *problem;
    } cases[] = {
        {"boxes 0 0 0 1 0 0 4 5 0 0 0 0 0 0", "'boxes' is no filter"},
        {"box 2 0 0 1 0 0 4 5 0 0 0 0 0 0", "lerp: '2' is not a whole number from 0 to 1"},
        {"bicubic 0 1.5 0 1 0 0 4 5 0 0 0 0 0 0", "sharpness: '1.5' does not lie in 0 to 1"},
        {"box 0 x 0 1 0 0 4 5 0 0 0 0 0 0", "sharpness: 'x' is not a number"},
        {"box 0 0 0.5 1 0 0 4 5 0 0 0 0 0 0", "noedgeblend: '0.5' is not a whole number"},
        {"box 0 0 0 -1 0 0 4 5 0 0 0 0 0 0", "width: '-1' is not finite, or negative"},
        {"box 0 0 0 1 inf 0 4 5 0 0 0 0 0 0", "blur: 'inf' is not finite"},
        {"box 0 0 0 1 0 -1 4 5 0 0 0 0 0 0", "firstchan: '-1' is not a whole number"},
        {"box 0 0 0 1 0 0 4294967296 5 0 0 0 0 0 0", "nchan: '4294967296' is not"},
        {"box 0 0 0 1 0 0 4 5.5 0 0 0 0 0 0", "faceid: '5.5' is not a whole number"},
        {"box 0 0 0 1 0 0 4 5 0 0,5 0 0 0 0", "v: '0,5' is not a number"},
        {"box 0 0 0 1 0 0 4 5 0 0 0 0 0", "vw2 is missing: expected 15 values, found 14"},
        {"-> 1 2 3", "the filter is missing"},
        {"box 0 0 0 1 0 0 4 5 0 0 0 0 0 0 0 -> 1", "'0' comes after vw2"},
        {"box 0 0 0 1 0 0 4 5 0 0 0 0 0 \033[2Jx", "'?[2Jx' is not a number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s\n# comment\n%s\n%s\n", CUBE_QUERY, cases[i].line,
                 CUBE_QUERY);
        tool_write_file("bad.txt", text, strlen(text));
        tool_write_file("kept.txt", "old", 3);
        RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i bad.txt -o kept.txt", data_folder());
        HAS("selvage: bad.txt:3: ");
        HAS(cases[i].problem);
        char *kept = read_text(tool_path("kept.txt"));
        CHECK(strcmp(kept, "old") == 0);
        free(kept);
        CHECK(access(tool_path("kept.txt.tmp"), F_OK) != 0);
    }
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' < bad.txt", data_folder());
    HAS("selvage: standard input:3: ");
    HAS(CUBE_QUERY " -> 0.");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' --json < bad.txt", data_folder());
    HAS("\"count\": 1,");
    HAS("\"complete\": false");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' --bench < bad.txt", data_folder());
    HAS("standard input:3: ");
    LACKS("a second");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' < /dev/zero", data_folder());
    HAS("standard input:1: the line is longer than");
}

/* What fails does not keep the others back. */
static void check_failing(void) {
    static const char queries[] = CUBE_QUERY "\n"
                                             "box 0 0 0 1 0 0 4 6 0.5 0.5 0 0 0 0 -> 1 2 3\n"
                                             "box 0 0 0 1 0 0 4 -1 0.5 0.5 0 0 0 0\n"
                                             "box 0 0 0 1 0 0 4 1 nan 0.5 0 0 0 0\n"
                                             "box 0 0 0 1 0 0 4 1 0.5 -inf 0 0 0 0\n"
                                             "box 0 0 0 1 0 0 4 1 0.5 0.5 nan 0 0 0\n"
                                             "box 0 0 0 0 0 0 4 1 0.5 0.5 inf 0 0 0\n"
                                             "box 0 0 0 1 0 7 1 1 0.5 0.5 0 0 0 0\n"
                                             "box 0 0 0 1 0 0 4 1 0.5 0.5 inf 0 0 0\n" CUBE_QUERY;
    static const char *const reasons[] = {"face 6 does not exist, there are 6",
                                          "face -1 does not exist",
                                          "u is not finite",
                                          "v is not finite",
                                          "the footprint is not a number",
                                          "the footprint is not a number",
                                          "channel 7 does not exist, there are 4"};
    tool_write_file("failing.txt", queries, sizeof queries - 1);
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i failing.txt -o answers.txt", data_folder());
    for (int i = 0; i < 7; i++) {
        char message[160];
        snprintf(message, sizeof message, "selvage: failing.txt:%d: %s", i + 2, reasons[i]);
        HAS(message);
    }
    LACKS("failing.txt:9");
    char *text = read_text(tool_path("answers.txt"));
    CHECK(strstr(text, "\nbox 0 0 0 1 0 0 4 6 0.5 0.5 0 0 0 0 -> error: face 6 does not exist, "
                       "there are 6\n"));
    CHECK(strstr(text, "\nbox 0 0 0 1 0 0 4 1 0.5 0.5 inf 0 0 0 -> 0."));
    const char *end = strrchr(text, 'b');
    CHECK(end && strncmp(text, end, strcspn(text, "\n")) == 0);
    free(text);
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i failing.txt --json", data_folder());
    HAS("{\"line\": 3, \"error\": \"face -1 does not exist, there are 6\"}");
    HAS("\"count\": 10,");
    HAS("\"failed\": 7,");
    HAS("\"complete\": true");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i failing.txt --bench", data_folder());
    HAS("failing.txt:4: u is not finite");
    HAS("Lookups       3, with 1 set of parameters");
    FILE *many = fopen(tool_path("many.txt"), "w");
    REQUIRE(many);
    for (int i = 0; i < 30; i++)
        fputs("box 0 0 0 1 0 0 4 6 0.5 0.5 0 0 0 0\n", many);
    CHECK(fclose(many) == 0);
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i many.txt -o answers.txt", data_folder());
    HAS("many.txt:20: face 6");
    LACKS("many.txt:21: ");
    HAS("many.txt: 30 lookups failed, the first 20 are shown");
}

/* Texels that do not unpack: the library says so, once a lookup. */
static void check_damaged(void) {
    tool_write_noise("damaged.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 5);
    slv_ptx *ptx = tool_open("damaged.ptx");
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces;
    slv_ptx_close(ptx);
    size_t size = 0;
    uint8_t *bytes = read_whole(tool_path("damaged.ptx"), &size);
    REQUIRE(bytes && size > 4000);
    memset(bytes + size / 3, 0xff, 400);
    tool_write_file("damaged.ptx", bytes, size);
    free(bytes);
    FILE *stream = fopen(tool_path("faces.txt"), "w");
    REQUIRE(stream);
    for (uint32_t face = 0; face < nfaces; face++)
        fprintf(stream, "point 0 0 0 1 0 0 0 %u 0.5 0.5 0 0 0 0\n", face);
    CHECK(fclose(stream) == 0);
    for (int threads = 1; threads <= 3; threads += 2) {
        RUNS(1, "sample damaged.ptx -i faces.txt -o %d.txt --threads %d", threads, threads);
        HAS("selvage: faces.txt:");
        HAS(": damaged.ptx: face ");
    }
    CHECK(same_bytes(tool_path("1.txt"), tool_path("3.txt")));
    char *text = read_text(tool_path("1.txt"));
    uint32_t failed = 0, lines = 0;
    for (const char *line = text; *line; line = strchr(line, '\n') + 1, lines++)
        failed += strncmp(strstr(line, "->"), "-> error: damaged.ptx: face ", 28) == 0;
    CHECK_MSG(lines == nfaces && failed > 0 && failed < nfaces, "%u of %u failed", failed, lines);
    free(text);
}

/* Both lines of a pair ask for the same. */
static void check_equal(const char *a, const char *b) {
    char values[2][256] = {{0}};
    const char *lines[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        tool_write_file("query.txt", lines[i], strlen(lines[i]));
        RUNS(0, "sample '%s/cube_u16_rgba.ptx' -i query.txt", data_folder());
        const char *arrow = strstr(tool_out, "-> 0.");
        REQUIRE(arrow);
        snprintf(values[i], sizeof values[i], "%s", arrow);
    }
    CHECK_MSG(strcmp(values[0], values[1]) == 0, "%s: %s%s: %s", a, values[0], b, values[1]);
}

static void check_parameters(void) {
    check_equal("gaussian 0 0 0 0 0.1 0 4 5 0.4 0.6 0.3 0.1 0.2 0.5",
                "gaussian 0 0 0 1 0.1 0 4 5 0.4 0.6 0 0 0 0");
    check_equal("box 0 0 0 1 0 1 99 5 0.4 0.6 0.3 0.1 0.2 0.5",
                "box 0 0 0 1 0 1 3 5 0.4 0.6 0.3 0.1 0.2 0.5");
    check_equal("box 0 0 0 1 0 2 0 5 0.4 0.6 0.3 0.1 0.2 0.5",
                "box 0 0 0 1 0 2 2 5 0.4 0.6 0.3 0.1 0.2 0.5");
    check_equal("mitchell 0 7 0 1 0 0 4 5 0.4 0.6 0.03 0 0 0.03",
                "mitchell 0 0 0 1 0 0 4 5 0.4 0.6 0.03 0 0 0.03");
    /* a width of 0 is not one of 1 */
    RUNS(0, "sample '%s/cube_u16_rgba.ptx' -i query.txt -o 1.txt", data_folder());
    static const char narrow[] = "mitchell 0 0 0 0 0 0 4 5 0.4 0.6 0.5 0 0 0.5";
    static const char wide[] = "mitchell 0 0 0 1 0 0 4 5 0.4 0.6 0.5 0 0 0.5";
    char answers[2][256];
    for (int i = 0; i < 2; i++) {
        tool_write_file("query.txt", i ? wide : narrow, sizeof wide - 1);
        RUNS(0, "sample '%s/cube_u16_rgba.ptx' -i query.txt", data_folder());
        snprintf(answers[i], sizeof answers[i], "%s", strstr(tool_out, "->"));
    }
    CHECK(strcmp(answers[0], answers[1]) != 0);
}

static void check_bench(void) {
    static const char *const names[2][3] = {{"One by one", "Batched", "Sorted"},
                                            {"\"one_by_one\":", "\"batched\":", "\"sorted\":"}};
    for (int json = test_brief(); json < 2; json++) { /* each takes seconds */
        RUNS(0, "sample '%s/cube_u16_rgba.ptx' -i '%s/cube_u16_rgba.filter.txt' --bench %s",
             data_folder(), data_folder(), json ? "--json --threads 1" : "--threads 3");
        for (int i = 0; i < 3; i++) {
            const char *at = strstr(tool_out, names[json][i]);
            CHECK_MSG(at && strtod(at + strlen(names[json][i]), NULL) > 0, "%s in %s",
                      names[json][i], tool_out);
        }
        if (json)
            HAS("\"threads\": 1,");
        else
            HAS("Threads       3\n");
        LACKS("->");
    }
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' --bench -o rates.txt < /dev/null", data_folder());
    HAS("no lookups to repeat");
    CHECK(access(tool_path("rates.txt"), F_OK) != 0);
}

/* Whoever feeds lines one by one is answered one by one; a reader that fails, or an end before the
 * time, leaves nothing behind. */
static void check_streams(void) {
    const char *bin = getenv("SELVAGE_BIN");
    char line[4096];
    snprintf(line, sizeof line,
             "cd '%s' && mkfifo to from && timeout 60 sh -c \"'%s/selvage' sample "
             "'%s/cube_u16_rgba.ptx' <to >from & exec 3>to 4<from; echo '%s' >&3; read one <&4; "
             "echo 'point 0 0 0 1 0 0 1 0 0 0 0 0 0 0' >&3; read two <&4; exec 3>&-; wait; "
             "echo \\$one, \\$two >both.txt\"",
             test_folder, bin ? bin : "bin", data_folder(), CUBE_QUERY);
    CHECK(system(line) == 0);
    char *text = read_text(tool_path("both.txt"));
    CHECK_MSG(strncmp(text, CUBE_QUERY " -> 0.", strlen(CUBE_QUERY) + 6) == 0 &&
                  strstr(text, ", point 0 0 0 1 0 0 1 0 0 0 0 0 0 0 -> 0."),
              "%s", text);
    free(text);
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i '%s/cube_u16_rgba.filter.txt' >/dev/full",
         data_folder(), data_folder());
    HAS("cannot write the answer: No space left on device");
    snprintf(line, sizeof line,
             "cd '%s' && sleep 3 | timeout 1 '%s/selvage' sample '%s/cube_u16_rgba.ptx' -o stopped",
             test_folder, bin ? bin : "bin", data_folder());
    CHECK(system(line) != 0);
    CHECK(access(tool_path("stopped"), F_OK) != 0 && access(tool_path("stopped.tmp"), F_OK) != 0);
}

static void check_usage(void) {
    RUNS(2, "sample");
    RUNS(2, "sample a.ptx b.ptx");
    RUNS(2, "sample a.ptx --cache 7");
    RUNS(1, "sample missing.ptx < /dev/null");
    HAS("missing.ptx");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i missing.txt", data_folder());
    HAS("selvage: missing.txt: No such file");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -i .", data_folder());
    HAS("selvage: .: not a regular file");
    RUNS(1, "sample '%s/cube_u16_rgba.ptx' -o none/x.txt < /dev/null", data_folder());
    HAS("none/x.txt");
    RUNS(0, "sample '%s/cube_u16_rgba.ptx' < /dev/null", data_folder());
    CHECK(!tool_out[0]);
    RUNS(0, "sample '%s/cube_u16_rgba.ptx' --json < /dev/null", data_folder());
    HAS("\"lookups\": [],");
    RUNS(0, "sample --help");
    HAS("Examples:");
    HAS("FILTER lerp sharpness noedgeblend width blur firstchan nchan\n  faceid u v uw1 vw1 uw2 "
        "vw2");
    RUNS(0, "--help");
    HAS("  sample ");
}

int main(void) {
    REQUIRE(data_folder());
    tool_begin();
    check_usage();
    check_lists();
    check_long_list();
    check_malformed();
    check_failing();
    check_damaged();
    check_parameters();
    check_bench();
    check_streams();
    tool_end();
    return test_end();
}
