/* Words and numbers of a text file, line by line, without regard to the locale. */
#ifndef SLV_MESH_TEXT_SCAN_H
#define SLV_MESH_TEXT_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* `next` never passes `end`. A backslash before a line's end joins the next line to it. */
typedef struct slv_scan {
    const char *next, *end;
    uint32_t line; /* 1-based */
} slv_scan;

/* Skips blanks and joined line ends; true if a word follows on the line. */
bool slvi_scan_more(slv_scan *scan);
/* Skips the rest of the line and its end. */
void slvi_scan_next_line(slv_scan *scan);
/* Takes a word up to the next blank. */
size_t slvi_scan_word(slv_scan *scan, const char **word);

/* These parse at `next`, pass what they took and return false, having taken an unspecified amount,
 * where there is no such number or it does not fit its type. What follows the number is the
 * caller's affair. */
bool slvi_scan_int(slv_scan *scan, int64_t *out);
/* In the range of float. */
bool slvi_scan_double(slv_scan *scan, double *out);

/* True at the end of a word: blank, line end, joined line end or end of text. */
bool slvi_scan_at_break(const slv_scan *scan);

#endif
