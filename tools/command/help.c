/* What the command says of itself: a verb's help, and its part of the table in the documentation.
 */
#include "command/cli.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 79, INDENT = 28 };

/* Where a word may be broken besides at blanks: behind one of several choices. */
static size_t piece_length(const char *text) {
    size_t length = strcspn(text, " |,\n");
    return length + (text[length] == '|' || text[length] == ',');
}

/* Prints a text from `column` on, going on in further lines at `indent`. */
static void print_wrapped(const char *text, size_t column, size_t indent) {
    bool blank = false; /* before the next piece */
    while (*text) {
        size_t length = piece_length(text);
        if (column + blank + length > WIDTH && column > indent) {
            printf("\n%*s", (int)indent, "");
            column = indent;
            blank = false;
        }
        printf("%s%.*s", blank ? " " : "", (int)length, text);
        column += blank + length;
        text += length;
        blank = *text == ' ';
        text += blank;
    }
    putchar('\n');
}

static bool is_choice(const cli_option *option) {
    return option->kind == CLI_CHOICE || option->kind == CLI_MODE;
}

/* What stands for an option's value. */
static const char *value_word(const cli_option *option) {
    switch (option->kind) {
    case CLI_FLAG:
        return "";
    case CLI_CHOICE:
        return "WORD";
    case CLI_MODE:
        return "[WORD]";
    case CLI_SIZE:
        return "WxH";
    case CLI_COLOR:
        return "COLOUR";
    default:
        return option->choices ? option->choices : "N";
    }
}

/* The other names of an option, " (-o)"; those with two dashes are only synonyms, but for the one
 * that all verbs which write have: " (-s, --out, -o)". */
static const char *short_name(const cli_option *option, char *text, size_t size) {
    const char *at = strstr(option->names, "|-"), *out = strstr(option->names, "|--out|-o");
    text[0] = 0;
    if (out) {
        snprintf(text, size, " (%.*s%s--out, -o)", out == at ? 0 : (int)strcspn(at + 1, "|"),
                 at + 1, out == at ? "" : ", ");
        return text;
    }
    if (at && at[2] != '-')
        snprintf(text, size, " (%.*s)", (int)strcspn(at + 1, "|"), at + 1);
    return text;
}

static const char *exits_of(const cli_command *command) {
    return command->exits ? command->exits : "0 success, 1 failure, 2 wrong usage";
}

void cli_print_help(const cli_command *command) {
    char left[160], brief[40];
    snprintf(left, sizeof left, "selvage %s - ", command->name);
    fputs(left, stdout);
    print_wrapped(command->summary, strlen(left), 4);
    snprintf(left, sizeof left, "\nUsage: selvage %s ", command->name);
    fputs(left, stdout);
    print_wrapped(command->arguments, strlen(left) - 1, strlen(left) - 1);
    puts("\nOptions:");
    for (uint32_t i = 0; i < command->noptions; i++) {
        const cli_option *option = &command->options[i];
        const char *word = value_word(option);
        size_t length = (size_t)snprintf(
            left, sizeof left, "  %.*s%s%s%s", (int)strcspn(option->names, "|"), option->names,
            *word ? " " : "", word, short_name(option, brief, sizeof brief));
        if (length < INDENT)
            printf("%-*s", INDENT, left);
        else
            printf("%s\n%*s", left, INDENT, "");
        char text[1024];
        snprintf(text, sizeof text, "%s%s%s", option->help, is_choice(option) ? ": " : "",
                 is_choice(option) ? option->choices : "");
        print_wrapped(text, INDENT, INDENT);
    }
    printf("%-*s%s\n\n", INDENT, "  --help (-h)", "this text");
    fputs("Exit codes: ", stdout);
    print_wrapped(exits_of(command), 12, 12);
    printf("\nExamples:\n%s", command->examples);
}

/* A cell of a table: bars would end it. */
static void print_cell(const char *text) {
    for (; *text; text++) {
        if (*text == '|')
            putchar('\\');
        putchar(*text);
    }
}

void cli_print_row(const cli_command *command) {
    const char *exits = exits_of(command);
    printf("| [`%s`](#selvage-%s) | ", command->name, command->name);
    print_cell(command->reads ? command->reads : "nothing");
    fputs(" | ", stdout);
    print_cell(command->writes ? command->writes : "nothing but its answer");
    fputs(" | ", stdout);
    print_cell(exits);
    puts(" |");
}

void cli_print_table(const cli_command *command) {
    printf("### selvage %s\n\n`selvage %s ", command->name, command->name);
    printf("%s [options]`\n\n| option | value | |\n|---|---|---|\n", command->arguments);
    for (uint32_t i = 0; i < command->noptions; i++) {
        const cli_option *option = &command->options[i];
        const char *name = option->names;
        fputs("| ", stdout);
        for (size_t length; *name && *name != '|'; name += length + (name[length] == '|')) {
            length = strcspn(name, "|");
            printf("%s`%.*s`", name == option->names ? "" : ", ", (int)length, name);
        }
        fputs(" | ", stdout);
        print_cell(value_word(option));
        fputs(" | ", stdout);
        print_cell(option->help);
        if (is_choice(option)) {
            fputs(": ", stdout);
            print_cell(option->choices);
        }
        puts(" |");
    }
    putchar('\n');
}
