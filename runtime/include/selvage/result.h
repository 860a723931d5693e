/* Result codes and the environment that every constructor takes. */
#ifndef SELVAGE_RESULT_H
#define SELVAGE_RESULT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Of these headers; slv_version says it of the library that a program runs with. */
#define SLV_VERSION_MAJOR 0
#define SLV_VERSION_MINOR 1
#define SLV_VERSION_PATCH 0
#define SLV_VERSION (SLV_VERSION_MAJOR << 16 | SLV_VERSION_MINOR << 8 | SLV_VERSION_PATCH)

/* In front of what the libraries export. Builds of static libraries and programs that use them
 * define SLV_STATIC, which the packages for CMake and pkg-config do by themselves; builds of shared
 * libraries define SLV_BUILD. One library may declare as its own the functions of another: they are
 * then called through the linker's thunk. */
#if defined(SLV_STATIC)
#define SLV_API
#elif defined(_WIN32) || defined(__CYGWIN__)
#if defined(SLV_BUILD)
#define SLV_API __declspec(dllexport)
#else
#define SLV_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define SLV_API __attribute__((visibility("default")))
#else
#define SLV_API
#endif

/* In front of functions whose result says whether they failed: compilers warn where it is not
 * looked at. */
#if defined(__cplusplus) && __cplusplus >= 201703L
#define SLV_NODISCARD [[nodiscard]]
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ > 201710L
#define SLV_NODISCARD [[nodiscard]]
#elif defined(__GNUC__)
#define SLV_NODISCARD __attribute__((warn_unused_result))
#else
#define SLV_NODISCARD
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What a function that can fail returns. Success is zero, so `if (slv_x(...))` reads "if it
 * failed". A function that makes an object sets its last argument to NULL when it fails; other
 * outputs then hold nothing to rely on. */
typedef enum slv_result {
    SLV_OK = 0,
    SLV_ERROR_ARGUMENT, /* the caller passed something that the function's contract forbids */
    SLV_ERROR_MEMORY,   /* an allocation failed */
    SLV_ERROR_LIMIT,  /* the input asks for more than slv_env.max_bytes, or a format's own limit */
    SLV_ERROR_IO,     /* the operating system refused: missing file, full disk, no permission */
    SLV_ERROR_FORMAT, /* the bytes are not what they claim to be */
    SLV_ERROR_UNSUPPORTED, /* a valid input, but of a kind that this build cannot handle */
    SLV_ERROR_MISMATCH,    /* two inputs do not belong together (mesh and texture, say) */
    SLV_ERROR_GL,          /* no usable context, or the driver refused */
    SLV_ERROR_CANCELLED    /* a progress callback asked to stop */
} slv_result;

/* A short English phrase for a result; never NULL. */
SLV_API const char *slv_result_string(slv_result result);

/* How far a long call is: `done` of `total` steps, which grow and end at `total`, in no particular
 * unit. Called now and then, by one thread at a time, of which any may be the caller's own. False
 * ends the call soon, with SLV_ERROR_CANCELLED and nothing made or written. */
typedef bool (*slv_progress_fn)(void *user, uint64_t done, uint64_t total);

/* In parameters of long calls; without `report` nobody is asked. */
typedef struct slv_progress {
    slv_progress_fn report;
    void *user;
} slv_progress;

typedef enum slv_log_level { SLV_LOG_INFO, SLV_LOG_WARNING, SLV_LOG_ERROR } slv_log_level;

/* "info", "warning", "error". Like all functions of this kind it gives "unknown" for a value that
 * is none, and never NULL; those that end in _from_name say false for a word that is none. */
SLV_API const char *slv_log_level_name(slv_log_level level);

/* The environment of a call: where words go, who works, where memory comes from and how much of it.
 * All zero is a sensible default; NULL stands for all zero. Objects keep a copy, so that what it
 * points to must outlive them.
 *
 * `log` receives one line without a newline, naming the file, face and edge where there are such.
 * It may be called from worker threads, one at a time. A function that returns an error has logged
 * exactly one SLV_LOG_ERROR line that says why.
 *
 * `allocate` returns memory aligned as malloc's, or NULL if there is none; `release` takes it back.
 * Both or neither are set. They are called from any thread, several at once, and may outlive the
 * call: an object is released by the hooks that it was made with. What the libraries below allocate
 * (OpenSubdiv, with surfaces around it, OpenEXR, libdeflate, Embree, jansson, OpenGL) and the
 * address space that a cache reserves does not come from them.
 *
 * `execute` runs task(argument, i) for each i of 0..count-1, in any order and on any threads, and
 * returns when all are done; slv_threads_create makes one. Without it threads are started for each
 * call that has work for them. */
typedef struct slv_env {
    void (*log)(void *user, slv_log_level level, const char *message);
    void *log_user;
    uint32_t threads;   /* worker threads; 0 means one per processor */
    uint64_t max_bytes; /* most bytes that one object may hold, and while it is made; 0: 16 GiB */
    void *(*allocate)(void *user, size_t bytes);
    void (*release)(void *user, void *memory);
    void *memory_user;
    void (*execute)(void *user, uint32_t count, void (*task)(void *argument, uint32_t index),
                    void *argument);
    void *execute_user;
    uint64_t reserved[6]; /* zero; for what later versions add */
} slv_env;

/* Releases memory that a function says is to be released with slv_free. NULL is fine. */
SLV_API void slv_free(void *memory);

/* The most bytes of memory that this process can have now: what the machine has to spare, or what a
 * limit of its address space or of its control group leaves. An estimate: others want memory too.
 */
SLV_API uint64_t slv_memory_available(void);

/* The library's version, as SLV_VERSION is made. */
SLV_API uint32_t slv_version(void);

#ifdef __cplusplus
}
#endif

#endif
