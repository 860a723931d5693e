/* Reads ratios, ranges and colours. */
#include "command/numbers.h"

#include "command/words.h"

#include <selvage/texture.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool value_ratio(const char *text, double *out, const char **end) {
    char *after;
    double value = strtod(text, &after);
    if (after == text || !isfinite(value))
        return false;
    if (*after == '/' && after[1] >= '0' && after[1] <= '9') {
        double below = strtod(after + 1, &after);
        if (!(below > 0) || !isfinite(below))
            return false;
        value /= below;
    }
    *out = value;
    *end = after;
    return true;
}

const char value_color_names[] = "black|white|grey|gray|red|green|blue|yellow|cyan|magenta|orange|"
                                 "none|transparent";

/* In the order of the names: red, green, blue and alpha, as the web has them. */
static const uint8_t named[][4] = {
    {0, 0, 0, 255},     {255, 255, 255, 255}, {128, 128, 128, 255}, {128, 128, 128, 255},
    {255, 0, 0, 255},   {0, 128, 0, 255},     {0, 0, 255, 255},     {255, 255, 0, 255},
    {0, 255, 255, 255}, {255, 0, 255, 255},   {255, 165, 0, 255},   {0, 0, 0, 0},
    {0, 0, 0, 0},
};

/* From sRGB to light. */
static void read_bytes(const uint8_t rgba[4], float out[4]) {
    for (int c = 0; c < 4; c++)
        out[c] = (float)rgba[c] / 255.0f;
    slv_texels_decode(3, SLV_NO_ALPHA, out, 1);
}

/* #rgb or #rrggbb. */
static bool read_hex(const char *text, float out[4]) {
    size_t length = strlen(text);
    uint8_t rgba[4] = {0, 0, 0, 255};
    if ((length != 3 && length != 6) || strspn(text, "0123456789abcdefABCDEF") != length)
        return false;
    for (size_t c = 0; c < 3; c++) {
        char digits[3] = {text[length == 3 ? c : 2 * c], text[length == 3 ? c : 2 * c + 1], 0};
        rgba[c] = (uint8_t)strtoul(digits, NULL, 16);
    }
    read_bytes(rgba, out);
    return true;
}

bool value_color(const char *text, float out[4]) {
    float color[4] = {0, 0, 0, 1};
    int name = words_index(value_color_names, text, strlen(text)), count = 0;
    const char *at = text;
    if (name >= 0) {
        read_bytes(named[name], out);
        return true;
    }
    if (*text == '#')
        return read_hex(text + 1, out);
    do {
        double value;
        if (!value_ratio(at + (count > 0), &value, &at) || !isfinite((float)value))
            return false;
        color[count] = (float)value;
    } while (++count < 4 && *at == ',');
    if (count < 3 || *at)
        return false;
    memcpy(out, color, sizeof color);
    return true;
}

static bool read_number(const char **at, uint64_t *out) {
    bool good = **at >= '0' && **at <= '9';
    char *end;
    *out = strtoull(*at, &end, 10);
    *at = end;
    return good;
}

bool value_range_read(const char **at, uint64_t *first, uint64_t *last) {
    if (!read_number(at, first))
        return false;
    *last = *first;
    if (**at != '-')
        return true;
    (*at)++;
    return read_number(at, last) && *last >= *first;
}

bool value_count(const char *text, uint64_t *out) {
    static const char units[] = "kMG";
    double number;
    const char *end;
    if (!value_ratio(text, &number, &end) || !(number > 0))
        return false;
    const char *unit = *end ? strchr(units, *end == 'K' ? 'k' : *end) : NULL;
    if (*end && (!unit || end[1]))
        return false;
    for (const char *at = units; unit && at <= unit; at++)
        number *= 1024;
    if (!(number >= 1) || number > 1e18)
        return false;
    *out = (uint64_t)number;
    return true;
}

bool value_resolution(const uint32_t size[2], slv_res *out) {
    int log2[2];
    for (int k = 0; k < 2; k++) {
        for (log2[k] = 0; log2[k] < SLV_MAX_LOG2_RES && 1u << log2[k] < size[k];)
            log2[k]++;
        if (size[k] != 1u << log2[k])
            return false;
    }
    *out = (slv_res){(int8_t)log2[0], (int8_t)log2[1]};
    return true;
}
