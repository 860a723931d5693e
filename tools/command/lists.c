/* Reads lists of faces and of channels. */
#include "command/lists.h"

#include "command/numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t count_items(const char *text) {
    uint32_t count = 1;
    for (; text && *text; text++)
        count += *text == ',';
    return count;
}

int value_faces(const cli_command *command, const char *option, const char *text, uint32_t nfaces,
                value_ranges *out) {
    uint32_t count = count_items(text);
    *out = (value_ranges){.list = calloc(count, sizeof *out->list)};
    if (!out->list)
        return cli_error("no memory for a list of %u faces", count);
    if (!text) {
        out->count = nfaces > 0;
        out->nfaces = nfaces;
        out->list[0].last = nfaces - out->count;
        return EXIT_OK;
    }
    for (const char *at = text; out->count < count; at++) {
        uint64_t first, last;
        if (!value_range_read(&at, &first, &last) || (*at && *at != ','))
            return cli_usage(command, "%s: '%s' is not a list such as 0-99,250", option, text);
        if (!nfaces)
            return cli_usage(command, "%s: '%s': the file has no faces", option, text);
        if (last >= nfaces)
            return cli_usage(command, "%s: '%s': the file has faces 0 to %u", option, text,
                             nfaces - 1);
        out->list[out->count++] = (value_range){(uint32_t)first, (uint32_t)last};
        out->nfaces += last - first + 1;
    }
    return EXIT_OK;
}

/* The file's channel number `which` of those that are not alpha. */
static int32_t colour(uint32_t which, value_channels file) {
    int32_t at = (int32_t)which;
    at += file.alpha >= 0 && file.alpha <= at;
    return at < (int32_t)file.count ? at : -1;
}

static int32_t letter(char name, value_channels file) {
    static const char names[] = "rgb";
    const char *at = strchr(names, name);
    if (name == 'y')
        return file.count - (file.alpha >= 0) == 1 ? colour(0, file) : -1;
    if (name == 'a')
        return file.alpha >= 0 ? file.alpha : file.count == 4 ? 3 : file.count == 2 ? 1 : -1;
    return at && name ? colour((uint32_t)(at - names), file) : -1;
}

int32_t value_channel_find(const char *text, size_t length, value_channels file) {
    char *end;
    if (length == 1 && (*text < '0' || *text > '9'))
        return letter((char)(*text | 0x20), file);
    unsigned long index = *text >= '0' && *text <= '9' ? strtoul(text, &end, 10) : file.count;
    return index < file.count && end == text + length ? (int32_t)index : -1;
}

/* What is wrong with an item, at most so much of it. */
static int bad_channel(const cli_command *command, const char *option, const char *item,
                       size_t length, value_channels file) {
    char range[32] = "channel 0 only", named[64] = "";
    size_t used = 0;
    if (file.count > 1)
        snprintf(range, sizeof range, "channels 0 to %u", file.count - 1);
    for (const char *name = "yrgba"; *name; name++)
        if (letter(*name, file) >= 0)
            used += (size_t)snprintf(named + used, sizeof named - used, "%s%c",
                                     used ? ", " : ", also called ", *name);
    return cli_usage(command, "%s: '%.*s': the file has %s%s", option,
                     (int)(length < 60 ? length : 60), item, range, named);
}

/* One item: a number, a range, a name, names in a row, or =VALUE. Appends to the list, which has
 * room; returns false if it is none of these. */
static bool read_item(const char *item, size_t length, value_channels file, bool constants,
                      value_channel *list, uint32_t *count) {
    const char *at = item;
    uint64_t first, last;
    if (constants && *item == '=') {
        double value;
        bool good = value_ratio(item + 1, &value, &at) && at == item + length;
        list[(*count)++] = (value_channel){-1, good ? (float)value : 0};
        return good && isfinite((float)value);
    }
    if (value_range_read(&at, &first, &last) && at == item + length) {
        for (uint64_t c = first; c <= last && last < file.count; c++)
            list[(*count)++].source = (int32_t)c;
        return last < file.count;
    }
    for (size_t i = 0; i < length; i++) {
        int32_t source =
            item[i] >= '0' && item[i] <= '9' ? -1 : value_channel_find(item + i, 1, file);
        if (source < 0)
            return false;
        list[(*count)++].source = source;
    }
    return length > 0;
}

/* No item names more channels than the file has, or than it has letters. */
static uint64_t room_for(const char *text, value_channels file) {
    return strlen(text) + (uint64_t)count_items(text) * file.count;
}

int value_channel_list(const cli_command *command, const char *option, const char *text,
                       value_channels file, bool constants, value_channel **list, uint32_t *count) {
    enum { MOST = 65535 };
    uint64_t room = room_for(text, file);
    *count = 0;
    *list = room <= (uint64_t)MOST * 256 ? calloc((size_t)room + 1, sizeof **list) : NULL;
    if (!*list)
        return cli_error("%s: no memory for so many channels", option);
    for (const char *item = text;; item++) {
        size_t length = strcspn(item, ",");
        if (!read_item(item, length, file, constants, *list, count))
            return bad_channel(command, option, item, length, file);
        item += length;
        if (!*item)
            break;
    }
    if (*count > MOST)
        return cli_usage(command, "%s: more than %d", option, MOST);
    return EXIT_OK;
}
