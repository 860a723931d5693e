/* Each allocation of the libraries below (libpng, OpenEXR, OpenSubdiv, libdeflate, the C library)
 * fails once within each call: no crash, no leak, no end of waiting; if the call fails, then with
 * SLV_ERROR_MEMORY and one line in the log. Some of them get by without. */
#include "kit/calls_kit.h"

#include <errno.h>

#if TEST_SANITIZED
int main(void) {
    CHECK(true); /* sanitizers have a malloc of their own */
    return test_end();
}
#else

/* takes the place of the C library's for other libraries too */
#define INTERPOSED __attribute__((visibility("default"), noinline))

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

static bool armed;
static long asked, fails, live;

static bool fails_now(void) {
    if (!armed || ++asked != fails)
        return false;
    errno = ENOMEM;
    return true;
}

static void *counted(void *memory) {
    live += armed && memory;
    return memory;
}

INTERPOSED void *malloc(size_t size) {
    return fails_now() ? NULL : counted(__libc_malloc(size));
}

INTERPOSED void *calloc(size_t count, size_t size) {
    return fails_now() ? NULL : counted(__libc_calloc(count, size));
}

INTERPOSED void *realloc(void *memory, size_t size) {
    if (fails_now())
        return NULL;
    void *moved = __libc_realloc(memory, size);
    live += armed && !memory && moved;
    return moved;
}

INTERPOSED void *aligned_alloc(size_t alignment, size_t size) {
    return fails_now() ? NULL : counted(__libc_memalign(alignment, size));
}

INTERPOSED int posix_memalign(void **out, size_t alignment, size_t size) {
    *out = fails_now() ? NULL : counted(__libc_memalign(alignment, size));
    return *out ? 0 : ENOMEM;
}

INTERPOSED void free(void *memory) {
    live -= armed && memory;
    __libc_free(memory);
}

/* Runs a call of which one allocation fails; 0: none. */
static slv_result run(const calls_entry *entry, long at) {
    slv_env env = {.log = calls_log, .threads = 1};
    calls_prepare();
    calls_errors = 0;
    calls_message[0] = 0;
    asked = live = 0;
    fails = at;
    armed = true;
    slv_result result = entry->call(&env);
    armed = false;
    return result;
}

/* Embree ends the process when it gets no memory (std::terminate, out of a destructor of its own).
 */
static bool is_left_out(const calls_entry *entry) {
    return entry->call == call_reference || entry->call == call_transfer ||
           entry->call == call_dabs || entry->call == call_lay || entry->call == call_stroke ||
           entry->call == call_fill || entry->call == call_script || entry->call == call_document ||
           entry->call == call_session || entry->call == call_session_moves ||
           entry->call == call_bake_rays;
}

/* OpenSubdiv's factory of refiners, which holds them by a plain pointer, loses one that it cannot
 * finish; OpenEXR's C++ library what it had of a file's parts. */
static bool loses(const calls_entry *entry) {
    return entry->call == call_catmark || entry->call == call_bilinear ||
           entry->call == call_triangles || entry->call == call_exr ||
           entry->call == call_transfer_from || entry->call == call_streams ||
           entry->call == call_blank || entry->call == call_bake_recipe ||
           entry->call == call_bake_colors || entry->call == call_unbake_normals;
}

/* OpenEXRCore tells want of memory as damage where it packs, libpng as a failure of any kind,
 * jansson at times as a text that ends too early. */
static bool hides_why(const calls_entry *entry) {
    return entry->call == call_exr || entry->call == call_png || entry->call == call_folder ||
           entry->call == call_sheet || entry->call == call_split || entry->call == call_brush ||
           entry->call == call_streams || entry->call == call_bake_recipe;
}

int main(void) {
    calls_begin();
    for (int i = 0; i < CALLS_COUNT; i++) {
        const calls_entry *entry = &calls_all[i];
        if (is_left_out(entry))
            continue;
        run(entry, 0); /* what libraries keep for good, they have now */
        slv_result result = run(entry, 0);
        CHECK_MSG(result == SLV_OK && live == 0, "%s: %s, %ld pieces of memory are left",
                  entry->name, slv_result_string(result), live);
        /* of very many every so manieth, from another start in each call */
        long most = asked, step = most / test_effort(100) + 1;
        for (long at = 1 + i % step; at <= most; at += step) {
            result = run(entry, at);
            CHECK_MSG(result == SLV_OK || result == SLV_ERROR_MEMORY || hides_why(entry),
                      "%s, allocation %ld of %ld: %s, %s", entry->name, at, most,
                      slv_result_string(result), calls_message);
            CHECK_MSG(calls_errors == (result != SLV_OK), "%s, allocation %ld of %ld: %u lines, %s",
                      entry->name, at, most, calls_errors, calls_message);
            CHECK_MSG(live == 0 || loses(entry),
                      "%s, allocation %ld of %ld: %ld pieces of memory are left", entry->name, at,
                      most, live);
        }
        fprintf(stderr, "%-12s %ld allocations\n", entry->name, most);
    }
    calls_end();
    return test_end();
}
#endif
