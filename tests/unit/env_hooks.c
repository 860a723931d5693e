/* With hooks in the environment, the library's own code takes no memory from anywhere else, and
 * gives all of it back through them. */
#if !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* dladdr */
#endif

#include "kit/calls_kit.h"
#include "kit/memory_kit.h"

#include <dlfcn.h>
#include <malloc.h>

#if !TEST_SANITIZED
/* Programs' own malloc serves libraries too; whoever called it is looked up while a test asks for
 * it. Under sanitizers it is theirs. */
/* takes the place of the C library's for other libraries too */
#define INTERPOSED __attribute__((visibility("default"), noinline))

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

static atomic_bool watching;
static atomic_uint strays;

static void look_at(const void *caller) {
    Dl_info info;
    if (!atomic_exchange(&watching, false))
        return;
    if (dladdr(caller, &info) && info.dli_fname && strstr(info.dli_fname, "libselvage")) {
        fprintf(stderr, "memory without hooks: %s near %s, at %#lx\n", info.dli_fname,
                info.dli_sname ? info.dli_sname : "?",
                (unsigned long)((const char *)caller - (const char *)info.dli_fbase));
        atomic_fetch_add(&strays, 1);
    }
    atomic_store(&watching, true);
}

INTERPOSED void *malloc(size_t size) {
    look_at(__builtin_return_address(0));
    return __libc_malloc(size);
}

INTERPOSED void *calloc(size_t count, size_t size) {
    look_at(__builtin_return_address(0));
    return __libc_calloc(count, size);
}

INTERPOSED void *realloc(void *memory, size_t size) {
    look_at(__builtin_return_address(0));
    return __libc_realloc(memory, size);
}

static void watch(bool on) {
    atomic_store(&watching, on);
}

static unsigned stray_count(void) {
    return atomic_load(&strays);
}
#else
static void watch(bool on) {
    (void)on;
}

static unsigned stray_count(void) {
    return 0;
}
#endif

static void check_call(const calls_entry *entry, uint32_t threads) {
    memory_count count = {.fails = 0};
    slv_env env = memory_env(&count);
    unsigned before = stray_count();
    env.threads = threads;
    calls_prepare();
    watch(true);
    slv_result result = entry->call(&env);
    watch(false);
    CHECK_MSG(result == SLV_OK, "%s: %s", entry->name, count.message);
    CHECK_MSG(count.asked > 0 && count.live == 0, "%s: %ld of %ld pieces of memory are left",
              entry->name, (long)count.live, (long)count.asked);
    CHECK_MSG(stray_count() == before, "%s: memory without hooks", entry->name);
}

/* Objects are released by the hooks that they were made with, whatever becomes of the environment.
 */
static void check_owner(void) {
    memory_count first = {.fails = 0}, second = {.fails = 0};
    slv_env env = memory_env(&first), other = memory_env(&second);
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    REQUIRE(!slv_ptx_open(&env, calls.ptx, &ptx));
    memset(&env, 0, sizeof env);
    REQUIRE(!slv_ptx_load_texture(&other, ptx, &texture));
    CHECK(first.live > 0 && second.live > 0);
    slv_ptx_close(ptx);
    CHECK(first.live == 0 && second.live > 0);
    slv_texture_destroy(texture);
    CHECK(second.live == 0);
}

/* What is handed out goes back through slv_free, which knows where to. */
static void check_free(void) {
    memory_count count = {.fails = 0};
    slv_env env = memory_env(&count);
    void *bytes = NULL;
    size_t size;
    REQUIRE(!slv_image_encode_png(&env, &calls.image, NULL, &bytes, &size));
    CHECK(count.live > 0);
    slv_free(bytes);
    CHECK(count.live == 0);
    slv_free(NULL);
}

int main(void) {
    calls_begin();
    for (int i = 0; i < CALLS_COUNT; i++) {
        check_call(&calls_all[i], 1);
        check_call(&calls_all[i], 3);
    }
    check_owner();
    check_free();
    calls_end();
    return test_end();
}
