/* Reading words and numbers out of text. */
#include "mesh/text_scan.h"

#include <math.h>

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* How many bytes a backslash and the line end after it take, \n, \r or both; 0 if there is none.
 * The text's end is one too. */
static size_t joined_line_end(const slv_scan *scan) {
    size_t left = (size_t)(scan->end - scan->next);
    if (left == 1 && scan->next[0] == '\\')
        return 1;
    if (left < 2 || scan->next[0] != '\\' || !is_line_end(scan->next[1]))
        return 0;
    return left > 2 && scan->next[1] == '\r' && scan->next[2] == '\n' ? 3 : 2;
}

bool slvi_scan_at_break(const slv_scan *scan) {
    return scan->next == scan->end || is_blank(*scan->next) || is_line_end(*scan->next) ||
           joined_line_end(scan);
}

bool slvi_scan_more(slv_scan *scan) {
    while (scan->next < scan->end) {
        size_t joined = joined_line_end(scan);
        if (joined) {
            scan->next += joined;
            scan->line++;
        } else if (is_blank(*scan->next)) {
            scan->next++;
        } else {
            return !is_line_end(*scan->next) && *scan->next != '#';
        }
    }
    return false;
}

void slvi_scan_next_line(slv_scan *scan) {
    while (scan->next < scan->end && !is_line_end(*scan->next)) {
        size_t joined = joined_line_end(scan);
        scan->line += joined != 0;
        scan->next += joined ? joined : 1;
    }
    if (scan->next == scan->end)
        return;
    bool crlf = *scan->next == '\r' && scan->end - scan->next >= 2 && scan->next[1] == '\n';
    scan->next += crlf ? 2 : 1;
    scan->line++;
}

size_t slvi_scan_word(slv_scan *scan, const char **word) {
    *word = scan->next;
    while (!slvi_scan_at_break(scan))
        scan->next++;
    return (size_t)(scan->next - *word);
}

static bool take_sign(slv_scan *scan) {
    bool negative = scan->next < scan->end && *scan->next == '-';
    if (negative || (scan->next < scan->end && *scan->next == '+'))
        scan->next++;
    return negative;
}

bool slvi_scan_int(slv_scan *scan, int64_t *out) {
    bool negative = take_sign(scan);
    int64_t value = 0;
    const char *first = scan->next;
    for (; scan->next < scan->end && is_digit(*scan->next); scan->next++) {
        if (value > (INT64_MAX - 9) / 10)
            return false;
        value = value * 10 + (*scan->next - '0');
    }
    *out = negative ? -value : value;
    return scan->next > first;
}

/* Decimal digits gathered into an integer, with the power of ten that it lacks. */
typedef struct decimal {
    uint64_t digits;
    int64_t exponent;
    bool any;
} decimal;

static void take_digits(slv_scan *scan, decimal *d, bool fraction) {
    for (; scan->next < scan->end && is_digit(*scan->next); scan->next++) {
        d->any = true;
        if (d->digits < UINT64_C(1000000000000000000)) {
            d->digits = d->digits * 10 + (uint64_t)(*scan->next - '0');
            d->exponent -= fraction;
        } else {
            d->exponent += !fraction;
        }
    }
}

static bool take_exponent(slv_scan *scan, decimal *d) {
    if (scan->next == scan->end || (*scan->next != 'e' && *scan->next != 'E'))
        return true;
    scan->next++;
    bool negative = take_sign(scan);
    int64_t value = 0;
    const char *first = scan->next;
    for (; scan->next < scan->end && is_digit(*scan->next); scan->next++)
        if (value < 100000000)
            value = value * 10 + (*scan->next - '0');
    d->exponent += negative ? -value : value;
    return scan->next > first;
}

/* Exact, and so correctly rounded to double, for up to 15 digits and 22 decimal places, as files
 * have them; beyond that a few units in double's last place off, which float does not see. */
static double scale_by_ten(uint64_t digits, int64_t exponent) {
    static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    double value = (double)digits;
    if (!digits || exponent < -100)
        return 0;
    if (exponent > 100)
        return INFINITY;
    for (; exponent > 22; exponent -= 22)
        value *= tens[22];
    for (; exponent < -22; exponent += 22)
        value /= tens[22];
    return exponent < 0 ? value / tens[-exponent] : value * tens[exponent];
}

bool slvi_scan_double(slv_scan *scan, double *out) {
    bool negative = take_sign(scan);
    decimal d = {0, 0, false};
    take_digits(scan, &d, false);
    if (scan->next < scan->end && *scan->next == '.') {
        scan->next++;
        take_digits(scan, &d, true);
    }
    if (!d.any || !take_exponent(scan, &d))
        return false;
    double value = scale_by_ten(d.digits, d.exponent);
    /* Halfway to the next power of two after the largest float, where rounding would give infinity.
     */
    if (value >= 0x1.ffffffp127)
        return false;
    *out = negative ? -value : value;
    return true;
}
