/* What is said of outputs before they are written, and text made safe for where it goes. */
#ifndef SELVAGE_TOOLS_OUTPUT_H
#define SELVAGE_TOOLS_OUTPUT_H

#include "command/cli.h"

#include <jansson.h>
#include <stdio.h>

/* Says before the work what would be said after it: that `path` cannot be written, or that it is
 * one of the inputs, by whatever name, which would be lost. Of the inputs some may be NULL. */
slv_result output_check(const slv_env *env, const char *path, const char *const *inputs,
                        size_t ninputs);
/* The second part of that alone. */
slv_result output_check_inputs(const slv_env *env, const char *path, const char *const *inputs,
                               size_t ninputs);
/* The same where the first input may be replaced by its new self: if it is named alike. */
slv_result output_check_in_place(const slv_env *env, const char *path, const char *const *inputs,
                                 size_t ninputs);
/* Whether a file could be written there, or files be put into a folder of that name. */
slv_result output_try(const slv_env *env, const char *path);
slv_result output_try_folder(const slv_env *env, const char *path);
uint64_t output_file_bytes(const char *path); /* 0 if there is none */
/* Saves a large image, and says how far that is: packing it takes longer than making it. The flags
 * are those of cli_progress_fleeting. An interrupt leaves nothing. */
slv_result output_image(const slv_env *env, const char *path, const slv_image *image,
                        slv_image_params params, bool forced, bool quiet);
/* Logs one error line and returns `result`. */
slv_result output_fail(const slv_env *env, slv_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* For HTML text and quoted attributes. What is not UTF-8 becomes U+FFFD here and in JSON. */
void output_html(FILE *stream, const char *text);
/* For a terminal: control and direction characters and bytes that are not UTF-8 as \xNN, \u{NNNN}.
 * Returns false if only the first `max_chars` characters were printed. */
bool output_terminal(FILE *stream, const char *text, size_t size, size_t max_chars);
/* NULL if there is no memory, which jansson's setters pass on as their own failure. */
json_t *output_json_text(const char *text, size_t size);
/* The name of a file, as cli_shown has it. */
json_t *output_json_name(const char *path);
json_t *output_json_number(double value); /* null if it is not finite */
/* libmypaint prints on standard output where its times get mixed up by rounding: between these two,
 * in which the command itself says nothing there, that goes nowhere. */
int output_silence(void);
void output_restore(int silenced);
/* Prints and releases; NULL means that there was no memory for it. Returns an exit code. */
int output_print_json(const char *path, json_t *root);

#endif
