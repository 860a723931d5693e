/* The report in a browser: it works its own controls (#selftest), without a word on the console, in
 * light and dark, and needs nothing but its file. */
#include "kit/command_kit.h"
#include "kit/cube_kit.h"

#include <jansson.h>

#include <time.h>

static kit_scratch scratch;
static kit_run run;

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})

static const char *find_browser(void) {
    static const char *const paths[] = {"/usr/bin/chromium", "/usr/bin/chromium-browser",
                                        "/usr/bin/google-chrome"};
    const char *given = getenv("SELVAGE_BROWSER");
    if (given && *given)
        return given;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        if (access(paths[i], X_OK) == 0)
            return paths[i];
    return NULL;
}

/* The page's own account of itself, or NULL. The attribute's quotes are escaped. */
static json_t *read_selftest(void) {
    static const char key[] = "data-selftest=\"", quote[] = "&quot;";
    char text[4096];
    size_t length = 0;
    const char *at = strstr(run.out, key);
    if (!at)
        return NULL;
    for (at += sizeof key - 1; *at && *at != '"' && length + 1 < sizeof text;) {
        bool escaped = strncmp(at, quote, sizeof quote - 1) == 0;
        text[length++] = escaped ? '"' : *at;
        at += escaped ? sizeof quote - 1 : 1;
    }
    text[length] = 0;
    return json_loads(text, 0, NULL);
}

static double brightness(const json_t *outcome, const char *key) {
    int r = -1, g = -1, b = -1;
    const char *color = json_string_value(json_object_get(outcome, key));
    CHECK_MSG(color && sscanf(color, "rgb(%d, %d, %d)", &r, &g, &b) == 3, "%s is '%s'", key,
              color ? color : "");
    return (r + g + b) / 765.0;
}

/* `width` pixels wide, in light or dark. */
static void check_page(const char *browser, const char *page, bool dark, const char *width) {
    static const char *const truths[] = {"slider", "clipped", "swapped", "decoded", "zoomed"};
    char address[KIT_PATH + 32], size[32], profile[KIT_PATH];
    snprintf(address, sizeof address, "file://%s#selftest", page);
    snprintf(size, sizeof size, "--window-size=%s,900", width);
    snprintf(profile, sizeof profile, "--user-data-dir=%.*s/profile", KIT_PATH - 32, scratch.root);
    for (int attempt = 0; attempt < 3; attempt++) {
        kit_run_program(&scratch, NULL,
                        ARGUMENTS("/usr/bin/timeout", "90", browser, "--headless", "--no-sandbox",
                                  "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                                  "--disable-extensions", "--host-resolver-rules=MAP * ~NOTFOUND",
                                  "--enable-logging=stderr", profile, size,
                                  dark ? "--blink-settings=preferredColorScheme=0"
                                       : "--blink-settings=preferredColorScheme=1",
                                  "--virtual-time-budget=20000", "--dump-dom", address),
                        &run);
        if (run.code == 0 && strstr(run.out, "data-selftest"))
            break; /* browsers do not always start on a busy machine */
    }
    const char *said = strstr(run.err, ":CONSOLE");
    CHECK_MSG(!said, "on the console: %.300s", said ? said : "");
    json_t *outcome = read_selftest();
    CHECK_MSG(outcome, "exit code %d, and no account of itself; the browser says: %.600s", run.code,
              run.err);
    REQUIRE(outcome);
    for (size_t i = 0; i < sizeof truths / sizeof *truths; i++)
        CHECK_MSG(json_is_true(json_object_get(outcome, truths[i])), "%s, %s wide: not %s",
                  dark ? "dark" : "light", width, truths[i]);
    CHECK(json_integer_value(json_object_get(outcome, "pictures")) == 2);
    CHECK_MSG(json_is_false(json_object_get(outcome, "sideways")), "%s wide: scrolls sideways",
              width);
    CHECK(json_is_true(json_object_get(outcome, "dark")) == dark);
    double paper = brightness(outcome, "paper"), ink = brightness(outcome, "ink");
    CHECK_MSG(dark ? paper < 0.25 && ink > 0.75 : paper > 0.75 && ink < 0.25,
              "%s: paper %.2f, ink %.2f", dark ? "dark" : "light", paper, ink);
    json_decref(outcome);
}

int main(void) {
    const char *browser = find_browser();
    char ptx[KIT_PATH], page[KIT_PATH];
    kit_scratch_make(&scratch);
    cube_write(kit_join(ptx, scratch.root, "cube.ptx"));
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", ptx, "-q", "--quick", "--size", "128x72", "--frames", "2",
                          "--tess", "4", "--reference-samples", "16", "-o", "report"),
                &run);
    CHECK_MSG(run.code == 0, "compare: exit code %d: %s", run.code, run.err);
    REQUIRE(run.code == 0);
    kit_join(page, scratch.folder, "report/report.html");
    char moved[KIT_PATH];
    REQUIRE(rename(page, kit_join(moved, scratch.root, "mailed.html")) == 0);
    /* what can be said without a browser: the page refers to nothing outside of itself */
    char *text = kit_read(moved, NULL);
    CHECK(strstr(text, "default-src 'none'") && strstr(text, "prefers-color-scheme: dark"));
    CHECK(!strstr(text, "src=\"http") && !strstr(text, "href=\"http") && !strstr(text, "url("));
    free(text);
    if (!browser) {
        fprintf(stderr, "no browser to open it in: install chromium, or name one in "
                        "SELVAGE_BROWSER\n");
        test_remove(scratch.root);
        return test_end();
    }
    check_page(browser, moved, false, "1200");
    check_page(browser, moved, true, "1200");
    check_page(browser, moved, true, "420");
    test_remove(scratch.root);
    return test_end();
}
