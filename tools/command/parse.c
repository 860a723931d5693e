/* Command lines: options and their values, inputs, and where the output goes. */
#include "command/cli.h"
#include "command/numbers.h"
#include "command/words.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool parse_uint(const char *text, uint32_t min, uint32_t max, uint32_t *out,
                       const char **end) {
    char *after;
    errno = 0;
    unsigned long long value = strtoull(text, &after, 10);
    if (after == text || text[0] < '0' || text[0] > '9' || errno || value < min || value > max)
        return false;
    *out = (uint32_t)value;
    *end = after;
    return true;
}

static bool parse_value(const cli_option *option, const char *text) {
    const char *end = text + strlen(text);
    uint32_t *size = option->value;
    cli_list *list = option->value;
    double number;
    int choice;
    bool good = true;
    switch (option->kind) {
    case CLI_FLAG:
        break;
    case CLI_TEXT:
        *(const char **)option->value = text;
        good = *text != 0;
        break;
    case CLI_TEXTS:
        good = *text && list->count < CLI_LIST_ROOM;
        if (good)
            list->items[list->count++] = text;
        break;
    case CLI_UINT:
        good = parse_uint(text, option->min, option->max, option->value, &end);
        break;
    case CLI_FLOAT:
        good = value_ratio(text, &number, &end) && isfinite((float)number);
        if (good)
            *(float *)option->value = (float)number;
        break;
    case CLI_SIZE:
        good = parse_uint(text, option->min, option->max, &size[0], &end);
        size[1] = size[0];
        if (good && *end == 'x')
            good = parse_uint(end + 1, option->min, option->max, &size[1], &end);
        break;
    case CLI_CHOICE:
    case CLI_MODE:
        choice = words_index(option->choices, text, strlen(text));
        good = choice >= 0;
        *(int *)option->value = choice;
        break;
    case CLI_COLOR:
        good = value_color(text, option->value);
        break;
    }
    return good && *end == 0;
}

static int bad_value(const cli_command *command, const cli_option *option, const char *text) {
    int length = (int)strcspn(option->names, "|");
    char hint[SLV_WORDS_HINT];
    if (option->kind == CLI_CHOICE || option->kind == CLI_MODE)
        return cli_usage(command, "%.*s: unknown word '%s', expected %s%s", length, option->names,
                         text, option->choices, slv_words_hint(text, option->choices, hint));
    if (option->kind == CLI_COLOR)
        return cli_usage(command, "%.*s: '%s' is no colour: expected r,g,b[,a], #rrggbb or %s%s",
                         length, option->names, text, value_color_names,
                         slv_words_hint(text, value_color_names, hint));
    if (option->kind == CLI_UINT || option->kind == CLI_SIZE)
        return cli_usage(command, "%.*s: '%s' is not a %s from %u to %u", length, option->names,
                         text, option->kind == CLI_UINT ? "number" : "size", option->min,
                         option->max);
    return cli_usage(command, "%.*s: cannot read '%s'", length, option->names, text);
}

static int unknown_option(const cli_command *command, const char *argument) {
    char names[4096] = "--help", hint[SLV_WORDS_HINT];
    size_t used = strlen(names);
    for (uint32_t k = 0; k < command->noptions; k++) {
        const char *word = command->options[k].names, *former = strstr(word, "||");
        size_t more = former ? (size_t)(former - word) : strlen(word);
        if (used + more + 2 > sizeof names)
            break;
        names[used++] = '|';
        memcpy(names + used, word, more);
        names[used += more] = 0;
    }
    return cli_usage(command, "unknown option '%s'%s", argument,
                     slv_words_hint(argument, names, hint));
}

static const cli_option *find_option(const cli_command *command, const char *name, size_t length) {
    for (uint32_t k = 0; k < command->noptions; k++)
        if (words_index(command->options[k].names, name, length) >= 0)
            return &command->options[k];
    return NULL;
}

/* Reads the option at argv[*at], and its value, which may be the next one. */
static int parse_option(const cli_command *command, int argc, char **argv, int *at) {
    const char *argument = argv[*at], *value = NULL;
    size_t length = strncmp(argument, "--", 2) == 0 ? strcspn(argument, "=") : strlen(argument);
    const cli_option *option = find_option(command, argument, length);
    if (!option)
        return unknown_option(command, argument);
    if (argument[length] == '=')
        value = argument + length + 1;
    if (option->kind == CLI_FLAG) {
        if (value)
            return cli_usage(command, "%.*s takes no value", (int)length, argument);
        *(bool *)option->value = true;
    } else if (option->kind == CLI_MODE && !value &&
               (*at + 1 >= argc ||
                words_index(option->choices, argv[*at + 1], strlen(argv[*at + 1])) < 0)) {
        *(int *)option->value = 0;
    } else {
        if (!value && *at + 1 < argc)
            value = argv[++*at];
        if (!value)
            return cli_usage(command, "%s needs a value", argument);
        if (!parse_value(option, value))
            return bad_value(command, option, value);
    }
    if (option->given)
        *option->given = true;
    return EXIT_OK;
}

static bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

/* What is written may be named by an option or stand behind the inputs; `extra` is an argument that
 * no input has taken, or NULL. */
static int take_output(const cli_command *command, const char *extra) {
    uint32_t *count = command->npositional;
    bool many = command->min_arguments < command->max_arguments;
    if (extra && !command->output)
        return cli_usage(command, "unexpected argument '%s'", extra);
    if (!command->output)
        return EXIT_OK;
    if (extra && *command->output)
        return cli_usage(command, "two names for what is written: %s and %s", extra,
                         *command->output);
    /* of two names the second is more likely an input that is misspelt */
    if (!extra && !*command->output && many && *count > command->min_arguments + 1 &&
        !exists(command->positional[*count - 1]))
        extra = command->positional[--*count];
    if (extra && command->output_is_new && exists(extra))
        return cli_usage(command,
                         "unexpected argument '%s': it is there already, and only --out "
                         "writes over what is",
                         extra);
    if (extra)
        *command->output = extra;
    bool spared = command->output_spared && *command->output_spared;
    if (command->output_needed && !spared && !*command->output)
        return cli_usage(command,
                         "the output is missing: name it behind the inputs, or with --out%s",
                         many ? " if it exists" : "");
    return EXIT_OK;
}

/* Returns -1, or an exit code. */
static int settle_inputs(const cli_command *command) {
    uint32_t count = *command->npositional;
    int code = cli_standard_once(command, command->positional, count);
    for (uint32_t i = 0; i < count && !code; i++)
        code = cli_settle_input(&command->positional[i]);
    return code ? code : -1;
}

int cli_parse(const cli_command *command, int argc, char **argv) {
    bool only_positional = false;
    const char *extra = NULL;
    *command->npositional = 0;
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i];
        int code;
        if (only_positional || argument[0] != '-' || !argument[1]) {
            if (!argument[0])
                return cli_usage(command, "an argument is empty, where a name is expected");
            if (*command->npositional < command->max_arguments)
                command->positional[(*command->npositional)++] = argument;
            else if (!extra)
                extra = argument;
            else
                return cli_usage(command, "unexpected argument '%s'", argument);
        } else if (strcmp(argument, "--") == 0) {
            only_positional = true;
        } else if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
            cli_print_help(command);
            return EXIT_OK;
        } else if (strcmp(argument, CLI_ROW_OPTION) == 0) {
            cli_print_row(command);
            return EXIT_OK;
        } else if (strcmp(argument, CLI_TABLE_OPTION) == 0) {
            cli_print_table(command);
            return EXIT_OK;
        } else if ((code = parse_option(command, argc, argv, &i))) {
            return code;
        }
    }
    int code = take_output(command, extra);
    if (code)
        return code;
    if (*command->npositional < command->min_arguments)
        return cli_usage(command, "expected %s", command->arguments);
    return settle_inputs(command);
}
