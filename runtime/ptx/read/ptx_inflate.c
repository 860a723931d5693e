/* Inflating streams that hold nothing but literals, as the noise of painted texels is packed: two
 * of them can be looked up at once, where a general decoder must be ready for a repeat after each.
 */
#include "ptx/read/ptx_texels.h"

#define MAX_BITS 11
#define MASK ((1u << MAX_BITS) - 1)
#define NLITERALS 257
#define END_OF_BLOCK 256
#define NLENGTHS 19
#define FEWEST 4096

/* What the next bits mean: how many bits they take, how many literals they are, those
 * themselves. The end of a block is none, and takes nothing, so that it can be met again and
 * again. */
struct codes {
    uint32_t entries[1u << MAX_BITS];
    unsigned end_bits;
};
#define ENTRY(first, second, bits, count)                                                          \
    ((uint32_t)(bits) | (uint32_t)(count) << 8 | (uint32_t)(first) << 16 | (uint32_t)(second) << 24)

struct input {
    const uint8_t *at, *end;
    uint64_t word;
    unsigned count; /* bits in the word */
};

static inline void refill(struct input *in) {
    if (in->end - in->at >= 8) {
        uint64_t next;
        memcpy(&next, in->at, sizeof next);
        in->word |= next << in->count;
        in->at += (63 - in->count) >> 3;
        in->count |= 56;
        return;
    }
    while (in->count <= 56 && in->at < in->end) {
        in->word |= (uint64_t)*in->at++ << in->count;
        in->count += 8;
    }
}

static inline void drop(struct input *in, unsigned count) {
    in->word >>= count;
    in->count -= count;
}

/* A few bits of a header; what is missing at the end of the input is zero, and noticed later. */
static unsigned take(struct input *in, unsigned count) {
    unsigned value = (unsigned)(in->word & ((1u << count) - 1));
    if (in->count < count)
        refill(in);
    value = (unsigned)(in->word & ((1u << count) - 1));
    if (in->count < count)
        in->word = in->count = 0;
    else
        drop(in, count);
    return value;
}

/* A table of all codes by their first `limit` bits: the symbol << 4 | the length. False unless the
 * code is complete and no longer than that. */
static bool make_table(const uint8_t *lengths, unsigned count, unsigned limit, uint16_t *table) {
    uint32_t per_length[16] = {0}, next[16], total = 0;
    for (unsigned s = 0; s < count; s++)
        per_length[lengths[s]]++;
    for (unsigned length = 1, code = 0; length < 16; length++) {
        if (length > limit) {
            if (per_length[length])
                return false;
            continue;
        }
        next[length] = code;
        code = (code + per_length[length]) << 1;
        total += per_length[length] << (limit - length);
    }
    if (total != 1u << limit)
        return false;
    for (unsigned s = 0; s < count; s++) {
        unsigned length = lengths[s], code, reversed = 0;
        if (!length)
            continue;
        code = next[length]++;
        for (unsigned bit = 0; bit < length; bit++)
            reversed |= (code >> bit & 1) << (length - 1 - bit);
        for (; reversed < 1u << limit; reversed += 1u << length)
            table[reversed] = (uint16_t)(s << 4 | length);
    }
    return true;
}

static bool read_code(struct input *in, struct codes *codes) {
    static const uint8_t order[NLENGTHS] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                            11, 4,  12, 3, 13, 2, 14, 1, 15};
    uint8_t described[NLENGTHS] = {0}, lengths[NLITERALS + 32] = {0};
    uint16_t table[1u << MAX_BITS], small[128];
    unsigned nliterals = take(in, 5), ndistances = take(in, 5) + 1, norder = take(in, 4) + 4;
    unsigned total = NLITERALS + ndistances;
    if (nliterals)
        return false;
    for (unsigned i = 0; i < norder; i++)
        described[order[i]] = (uint8_t)take(in, 3);
    if (!make_table(described, NLENGTHS, 7, small))
        return false;
    for (unsigned i = 0; i < total;) {
        refill(in);
        unsigned found = small[in->word & 127], symbol = found >> 4, run = 1, value = symbol;
        if (in->count < (found & 15))
            return false;
        drop(in, found & 15);
        if (symbol >= 16) {
            value = 0;
            if (symbol == 16) {
                if (!i)
                    return false;
                value = lengths[i - 1];
            }
            run = symbol == 18 ? 11 + take(in, 7) : 3 + take(in, symbol == 16 ? 2 : 3);
        }
        if (run > total - i)
            return false;
        for (; run; run--)
            lengths[i++] = (uint8_t)value;
    }
    if (!lengths[END_OF_BLOCK] || !make_table(lengths, NLITERALS, MAX_BITS, table))
        return false;
    codes->end_bits = lengths[END_OF_BLOCK];
    for (unsigned i = 0; i <= MASK; i++) {
        unsigned first = table[i], bits = first & 15;
        unsigned second = table[i >> bits], both = bits + (second & 15);
        if (first >> 4 == END_OF_BLOCK)
            codes->entries[i] = 0;
        else if (both <= MAX_BITS && second >> 4 != END_OF_BLOCK)
            codes->entries[i] = ENTRY(first >> 4, second >> 4, both, 2);
        else
            codes->entries[i] = ENTRY(first >> 4, 0, bits, 1);
    }
    return true;
}

/* The literals of one block, up to its end; *out moves on. */
static bool read_block(struct input *in, const struct codes *codes, uint8_t **out,
                       const uint8_t *end) {
    struct input i = *in;
    uint8_t *to = *out;
    uint32_t entry = 1;
    while (i.end - i.at >= 8 && end - to >= 10 && entry) {
        refill(&i);
        for (int k = 0; k < 5; k++) {
            entry = codes->entries[i.word & MASK];
            to[0] = (uint8_t)(entry >> 16);
            to[1] = (uint8_t)(entry >> 24);
            to += entry >> 8 & 3;
            drop(&i, entry & 63);
        }
    }
    for (;;) {
        refill(&i);
        entry = codes->entries[i.word & MASK];
        unsigned bits = entry ? entry & 63 : codes->end_bits, count = entry >> 8 & 3;
        if (bits > i.count || (size_t)(end - to) < count)
            return false;
        drop(&i, bits);
        if (!count)
            break;
        for (unsigned k = 0; k < count; k++)
            *to++ = (uint8_t)(entry >> (16 + 8 * k));
    }
    *in = i;
    *out = to;
    return true;
}

bool slvi_ptx_inflate_literals(const uint8_t *in, size_t size, uint8_t *out, size_t out_size) {
    struct codes codes;
    struct input input = {.at = in + 2, .end = in + size};
    uint8_t *to = out;
    /* a table is worth its making only for many; the first block says quickly whether it is one of
     * ours */
    if (out_size < FEWEST || size < 12 || (in[0] & 15) != 8 ||
        ((unsigned)in[0] << 8 | in[1]) % 31 || in[1] & 32 || (in[2] >> 1 & 3) != 2 || in[2] >> 3)
        return false;
    for (bool last = false; !last;) {
        last = take(&input, 1);
        if (take(&input, 2) != 2 || !read_code(&input, &codes) ||
            !read_block(&input, &codes, &to, out + out_size))
            return false;
    }
    const uint8_t *checksum = input.at - input.count / 8;
    return to == out + out_size && input.end - checksum >= 4 &&
           libdeflate_adler32(1, out, out_size) ==
               ((uint32_t)checksum[0] << 24 | (uint32_t)checksum[1] << 16 |
                (uint32_t)checksum[2] << 8 | checksum[3]);
}
