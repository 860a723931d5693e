/* What belongs to no subject of its own: the version, words for results, memory given back. */
#include "base/memory.h"
#include "base/names.h"

#include <selvage/result.h>

void slv_free(void *memory) {
    slvi_free(memory);
}

uint32_t slv_version(void) {
    return SLV_VERSION;
}

const char *slv_log_level_name(slv_log_level level) {
    static const char *const names[] = {"info", "warning", "error"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)level);
}

const char *slv_result_string(slv_result result) {
    switch (result) {
    case SLV_OK:
        return "success";
    case SLV_ERROR_ARGUMENT:
        return "invalid argument";
    case SLV_ERROR_MEMORY:
        return "out of memory";
    case SLV_ERROR_LIMIT:
        return "over a limit";
    case SLV_ERROR_IO:
        return "input or output failed";
    case SLV_ERROR_FORMAT:
        return "malformed input";
    case SLV_ERROR_UNSUPPORTED:
        return "not supported";
    case SLV_ERROR_MISMATCH:
        return "inputs do not belong together";
    case SLV_ERROR_GL:
        return "OpenGL failed";
    case SLV_ERROR_CANCELLED:
        return "cancelled";
    }
    return "unknown result";
}
