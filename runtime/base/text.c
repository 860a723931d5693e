/* Texts as all readers of them get them, and outputs as applications have them. */
#include "base/file.h"
#include "base/gzip.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"

#include <string.h>

static bool is_letter(unsigned char c) {
    return (c >= ' ' && c < 0x7F) || c == '\t' || c == '\n' || c == '\r';
}

const char *slv_text_encoding(const void *bytes, size_t size) {
    static const char two[] = "UTF-16", four[] = "UTF-32";
    const unsigned char *b = bytes;
    if (size >= 4 && (memcmp(b, "\xFF\xFE\0\0", 4) == 0 || memcmp(b, "\0\0\xFE\xFF", 4) == 0))
        return four;
    if (size >= 2 && (memcmp(b, "\xFF\xFE", 2) == 0 || memcmp(b, "\xFE\xFF", 2) == 0))
        return two;
    if (size < 4)
        return NULL;
    if ((is_letter(b[0]) && !b[1] && !b[2] && !b[3]) ||
        (!b[0] && !b[1] && !b[2] && is_letter(b[3])))
        return four;
    if ((is_letter(b[0]) && !b[1] && is_letter(b[2]) && !b[3]) ||
        (!b[0] && is_letter(b[1]) && !b[2] && is_letter(b[3])))
        return two;
    return NULL;
}

/* How some editors mark what kind of text it is, at its beginning. */
static slv_result skip_mark(const slv_env *env, const char *path, char *text, size_t *size) {
    if (*size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) {
        *size -= 3;
        memmove(text, text + 3, *size + 1);
        return SLV_OK;
    }
    const char *encoding = slv_text_encoding(text, *size);
    if (encoding)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "%s: is text in %s: save it as UTF-8, which is what can be read", path,
                         encoding);
    return SLV_OK;
}

static slv_result load(const slv_env *env, const char *path, char **text, size_t *size) {
    slv_result result = slvi_file_read(env, path, text, size);
    if (!result && !(result = slvi_gunzip(env, path, text, size)))
        result = skip_mark(env, path, *text, size);
    if (result) {
        slvi_free(*text);
        *text = NULL;
        *size = 0;
    }
    return result;
}

slv_result slv_text_load(const slv_env *env, const char *path, char **text, size_t *size) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load(&own, path, text, size));
}

static slv_result open_output(const slv_env *given, const char *path, bool streams,
                              slv_output **out) {
    slv_env env = slvi_env_or_default(given);
    slv_output *output;
    FILE *stream;
    *out = NULL;
    slv_result result = slvi_alloc(&env, path, 1, sizeof *output, &output);
    if (result)
        return result;
    if (!(result = slvi_output_begin(&env, path, streams, output)) &&
        (result = slvi_output_stream(output, &stream)))
        slvi_output_discard(output);
    if (result)
        slvi_free(output);
    else
        *out = output;
    return result;
}

slv_result slv_output_open(const slv_env *env, const char *path, slv_output **out) {
    return open_output(env, path, false, out);
}

slv_result slv_output_open_stream(const slv_env *env, const char *path, slv_output **out) {
    return open_output(env, path, true, out);
}

FILE *slv_output_stream(slv_output *output) {
    return output->stream;
}

slv_result slv_output_end(slv_output *output, slv_result result) {
    if (!output)
        return result;
    if (result)
        slvi_output_discard(output);
    else
        result = slvi_output_commit(output, false);
    slvi_free(output);
    return result;
}

slv_result slv_output_try(const slv_env *env, const char *path) {
    slv_output output;
    slv_result result = slvi_output_begin(env, path, false, &output);
    if (!result)
        slvi_output_discard(&output);
    return result;
}
