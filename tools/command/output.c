/* Whether outputs can be written, and text made safe for HTML, JSON and terminals. */
#include "command/output.h"

#include <selvage/bake.h>
#include <selvage/folder.h>
#include <selvage/session.h>

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NOT_UTF8 UINT32_MAX

slv_result output_fail(const slv_env *env, slv_result result, const char *format, ...) {
    char line[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    if (env && env->log)
        env->log(env->log_user, SLV_LOG_ERROR, line);
    return result;
}

uint64_t output_file_bytes(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 ? (uint64_t)status.st_size : 0;
}

slv_result output_image(const slv_env *env, const char *path, const slv_image *image,
                        slv_image_params params, bool forced, bool quiet) {
    cli_progress progress = cli_progress_fleeting("writing", forced, quiet);
    params.progress = (slv_progress){cli_progress_report, &progress};
    cli_catch_interrupts();
    slv_result result = slv_image_save(env, path, image, &params);
    cli_progress_end(&progress);
    return result;
}

/* Whether a file is one of a set of tiles, NAME.<UDIM>.ENDING. */
static bool is_tile(const char *set, const struct stat *there) {
    const char *at = strstr(set, SLV_BAKE_UDIM);
    char name[4096];
    struct stat input;
    for (int tile = 1001; at && tile <= 9999; tile++) {
        snprintf(name, sizeof name, "%.*s%d%s", (int)(at - set), set, tile,
                 at + strlen(SLV_BAKE_UDIM));
        if (stat(name, &input) == 0 && there->st_dev == input.st_dev &&
            there->st_ino == input.st_ino)
            return true;
    }
    return false;
}

/* Whether a file lies in a folder that is a session, of which all is needed. */
static bool is_in_session(const char *path, const char *session, const struct stat *folder) {
    char parent[4096];
    struct stat there;
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) + 1 : 2;
    snprintf(parent, sizeof parent, "%.*s", length, slash ? path : "./");
    return slv_session_is(session) && stat(parent, &there) == 0 && there.st_dev == folder->st_dev &&
           there.st_ino == folder->st_ino;
}

slv_result output_check_inputs(const slv_env *env, const char *path, const char *const *inputs,
                               size_t ninputs) {
    struct stat there, input;
    for (size_t i = 0; i < ninputs && stat(path, &there) == 0; i++)
        if (inputs[i] && is_tile(inputs[i], &there))
            return output_fail(env, SLV_ERROR_ARGUMENT, "%s: is one of %s, and would be lost", path,
                               inputs[i]);
        else if (!inputs[i] || stat(cli_input(inputs[i]), &input) != 0)
            continue;
        else if (S_ISDIR(input.st_mode) && is_in_session(path, inputs[i], &input))
            return output_fail(env, SLV_ERROR_ARGUMENT,
                               "%s: is part of the session %s, and would be lost", path, inputs[i]);
        else if (S_ISREG(input.st_mode) && there.st_dev == input.st_dev &&
                 there.st_ino == input.st_ino)
            return strcmp(path, inputs[i]) == 0
                       ? output_fail(env, SLV_ERROR_ARGUMENT,
                                     "%s: is read, and would be lost if it were written", path)
                       : output_fail(env, SLV_ERROR_ARGUMENT,
                                     "%s: is the same file as %s, which would be lost", path,
                                     strcmp(inputs[i], "-") == 0 ? "the standard input"
                                                                 : inputs[i]);
    return SLV_OK;
}

/* A kill in that moment shall leave nothing either. */
static void hold_signals(sigset_t *before) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, before);
}

slv_result output_try(const slv_env *env, const char *path) {
    sigset_t before;
    hold_signals(&before);
    slv_result result = slv_output_try(env, path);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return result;
}

slv_result output_try_folder(const slv_env *env, const char *path) {
    slv_folder *folder;
    sigset_t before;
    hold_signals(&before);
    slv_result result = slv_folder_begin(env, path, &folder);
    if (!result)
        result = slv_folder_end(folder, NULL, SLV_ERROR_CANCELLED) == SLV_ERROR_CANCELLED
                     ? SLV_OK
                     : SLV_ERROR_IO;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return result;
}

slv_result output_check_in_place(const slv_env *env, const char *path, const char *const *inputs,
                                 size_t ninputs) {
    bool same = strcmp(path, inputs[0]) == 0;
    return output_check_inputs(env, path, inputs + same, ninputs - same);
}

slv_result output_check(const slv_env *env, const char *path, const char *const *inputs,
                        size_t ninputs) {
    slv_result result = output_check_inputs(env, path, inputs, ninputs);
    return result ? result : output_try(env, path);
}

/* Takes one character off the front (RFC 3629), or one byte if that is not the start of one. */
static uint32_t next_character(const unsigned char **at, const unsigned char *end) {
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *p = (*at)++;
    int length = *p < 0x80 ? 1 : *p >= 0xC2 && *p < 0xE0 ? 2 : *p >= 0xE0 && *p < 0xF0 ? 3 : 4;
    if (length == 1)
        return *p;
    if (*p < 0xC2 || *p > 0xF4 || end - p < length)
        return NOT_UTF8;
    uint32_t code = *p & (0x7Fu >> length);
    for (int i = 1; i < length; i++) {
        if ((p[i] & 0xC0) != 0x80)
            return NOT_UTF8;
        code = code << 6 | (p[i] & 0x3Fu);
    }
    if (code < least[length] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000))
        return NOT_UTF8;
    *at = p + length;
    return code;
}

void output_html(FILE *stream, const char *text) {
    const unsigned char *at = (const unsigned char *)text, *end = at + strlen(text);
    while (at < end) {
        const unsigned char *start = at;
        uint32_t code = next_character(&at, end);
        switch (code) {
        case '&':
            fputs("&amp;", stream);
            break;
        case '<':
            fputs("&lt;", stream);
            break;
        case '>':
            fputs("&gt;", stream);
            break;
        case '"':
            fputs("&quot;", stream);
            break;
        case '\'':
            fputs("&#39;", stream);
            break;
        default:
            if (code == NOT_UTF8 || code < 0x20 || (code >= 0x7F && code < 0xA0))
                fputs("\xEF\xBF\xBD", stream);
            else
                fwrite(start, 1, (size_t)(at - start), stream);
        }
    }
}

bool output_terminal(FILE *stream, const char *text, size_t size, size_t max_chars) {
    const unsigned char *at = (const unsigned char *)text, *end = at + size;
    for (size_t count = 0; at < end; count++) {
        if (count == max_chars)
            return false;
        const unsigned char *start = at;
        uint32_t code = next_character(&at, end);
        bool turns_text = (code >= 0x202A && code <= 0x202E) ||
                          (code >= 0x2066 && code <= 0x2069) || code == 0x200E || code == 0x200F ||
                          code == 0x061C;
        bool breaks_line = code == 0x2028 || code == 0x2029;
        if (code == NOT_UTF8 || code < 0x20 || code == 0x7F)
            fprintf(stream, "\\x%02x", *start);
        else if ((code >= 0x80 && code < 0xA0) || turns_text || breaks_line)
            fprintf(stream, "\\u{%04x}", code);
        else
            fwrite(start, 1, (size_t)(at - start), stream);
    }
    return true;
}

json_t *output_json_text(const char *text, size_t size) {
    const unsigned char *at = (const unsigned char *)text, *end = at + size;
    char *clean = size < SIZE_MAX / 4 ? malloc(3 * size + 1) : NULL, *to = clean;
    if (!clean)
        return NULL;
    while (at < end) {
        const unsigned char *start = at;
        bool good = next_character(&at, end) != NOT_UTF8;
        size_t length = good ? (size_t)(at - start) : 3;
        memcpy(to, good ? (const void *)start : "\xEF\xBF\xBD", length);
        to += length;
    }
    json_t *string = json_stringn(clean, (size_t)(to - clean));
    free(clean);
    return string;
}

json_t *output_json_name(const char *path) {
    const char *shown = cli_shown(path);
    return output_json_text(shown, strlen(shown));
}

json_t *output_json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

int output_print_json(const char *path, json_t *root) {
    int code = EXIT_OK;
    if (!root)
        return cli_error("%s: no memory to describe it", path);
    if (json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0)
        putchar('\n');
    else if (!ferror(stdout))
        code = cli_error("%s: no memory to print it", path);
    json_decref(root);
    return code;
}

int output_silence(void) {
    fflush(stdout);
    int kept = dup(STDOUT_FILENO), nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept >= 0 && nothing >= 0)
        dup2(nothing, STDOUT_FILENO);
    if (nothing >= 0)
        close(nothing);
    return kept;
}

void output_restore(int silenced) {
    fflush(stdout);
    if (silenced < 0)
        return;
    dup2(silenced, STDOUT_FILENO);
    close(silenced);
}
