/* Bytes from, or to, something that is no file. */
#ifndef SELVAGE_STREAM_H
#define SELVAGE_STREAM_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where bytes come from. `read` fills the whole buffer, from any offset, and returns 0, or else
 * something else; several threads may call it at once. */
typedef struct slv_stream_in {
    int (*read)(void *user, uint64_t offset, void *buffer, size_t size);
    void (*close)(void *user); /* may be NULL; called once, also when opening fails */
    void *user;
    uint64_t size; /* of all there is */
} slv_stream_in;

/* Where bytes go, from the first to the last, in pieces of any size: nothing is asked for but to
 * take them, so that a pipe or a socket will do. `write` takes all of a piece and returns 0;
 * anything else ends the call that writes with SLV_ERROR_IO. It is called on the thread of that
 * call. What has been taken when a call fails is no complete file. */
typedef struct slv_stream_out {
    int (*write)(void *user, const void *bytes, size_t size);
    void *user;
} slv_stream_out;

#ifdef __cplusplus
}
#endif

#endif
