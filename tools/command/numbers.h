/* What numbers and colours look like on the command line. */
#ifndef SELVAGE_TOOLS_NUMBERS_H
#define SELVAGE_TOOLS_NUMBERS_H

#include <selvage/texture.h>

#include <stdbool.h>
#include <stdint.h>

/* 0.5 or 1/2; `*end` is what follows it. */
bool value_ratio(const char *text, double *out, const char **end);
/* "64M", "4096", "1.5G": k, M, G are powers of 1024. */
bool value_count(const char *text, uint64_t *out);
/* The resolution of a size, both sides of which are to be powers of two. */
bool value_resolution(const uint32_t size[2], slv_res *out);
/* One range off the front of a list: "12" or "12-40". */
bool value_range_read(const char **at, uint64_t *first, uint64_t *last);
/* Linear RGBA: r,g,b or r,g,b,a; a name such as red or none; #rgb or #rrggbb, which are sRGB. */
bool value_color(const char *text, float out[4]);
/* The names of value_color, "black|white|...". */
extern const char value_color_names[];

#endif
