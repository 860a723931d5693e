/* Lists on the command line: of faces, and of channels. */
#ifndef SELVAGE_TOOLS_LISTS_H
#define SELVAGE_TOOLS_LISTS_H

#include "command/cli.h"

/* Faces first..last of a list such as 0-99,250. */
typedef struct value_range {
    uint32_t first, last;
} value_range;
typedef struct value_ranges {
    value_range *list; /* for free() */
    uint32_t count;
    uint64_t nfaces; /* in all, those that are listed twice counted twice */
} value_ranges;

/* Of a file with `nfaces`; the whole if `text` is NULL. Returns an exit code; what is wrong is said
 * as cli_usage does. The list is freed whatever that is. */
int value_faces(const cli_command *command, const char *option, const char *text, uint32_t nfaces,
                value_ranges *out);

/* One of the file's channels, or a value. */
typedef struct value_channel {
    int32_t source; /* -1: `value` */
    float value;
} value_channel;

/* What the channels of a file are called. */
typedef struct value_channels {
    uint32_t count;
    int32_t alpha; /* or SLV_NO_ALPHA */
} value_channels;

/* A list of numbers, ranges and names, r,g,b or rgb or 0-2: y is the one of a grey file, a its
 * alpha. With `constants` also =VALUE. Returns an exit code; `*list` is for free(). */
int value_channel_list(const cli_command *command, const char *option, const char *text,
                       value_channels file, bool constants, value_channel **list, uint32_t *count);
/* The channel of a name or number, or -1. */
int32_t value_channel_find(const char *text, size_t length, value_channels file);

#endif
