/* Deflate for differences of neighbouring texels. Noise has nothing that repeats: it is packed as
 * literals, for which zlib's search finds only what costs more bits. In what is smooth the same
 * steps come again a row further, give or take a texel: looking there, and in a table of the latest
 * places of 8 bytes, finds as much as long chains do. */
#include "ptx/write/ptx_write.h"

#include "base/memory.h"

#include <math.h>

#define NLITERALS 286 /* bytes, the end of a block, lengths */
#define NDISTANCES 30
#define END_OF_BLOCK 256
#define NLENGTHS 19         /* symbols of which the codes' own description is made */
#define MAX_LITERAL_BITS 11 /* five fit into a word; readers look them up in one step */
#define MAX_LENGTH_BITS 7
#define BLOCK (1 << 15)
#define MAX_MATCH 258
#define FAR 32768
#define SMALL 16384 /* streams for which a thorough search costs little */
#define MIN_MATCH 4
#define MAX_STRING 48 /* bytes by which places are found */
#define HASH_BITS 13
#define TABLES 2
#define WAYS 2
#define LONG 32   /* a repeat that is not worth a search for a longer one, ... */
#define ENOUGH 24 /* ... or for one that begins a byte later */

/* So many literals, then a repeat; none if the length is 0. */
struct sequence {
    uint32_t literals;
    uint16_t length, distance;
};

struct ptx_deflater {
    uint32_t base; /* places below are of an earlier stream */
    uint32_t places[TABLES][1 << HASH_BITS][WAYS];
    struct sequence sequences[BLOCK / MIN_MATCH + 2];
};

static uint64_t load64(const uint8_t *p) {
    uint64_t v;
    memcpy(&v, p, sizeof v);
    return v;
}

/* Whether strings of bytes come again often enough for a search to pay. Every 16th position is
 * remembered; 16 positions in a row are looked up in some places, so that one of them meets a
 * remembered one whatever the distance of the repeat is. */
static bool bytes_repeat(const uint8_t *in, size_t size) {
    enum { LOG2 = 12, STEP = 16, STRING = 8 };
    uint32_t table[1 << LOG2] = {0}, windows = 0, hits = 0;
    const size_t spacing = size < SMALL ? 64 : 128;
    if (size < 1024)
        return true;
    for (size_t at = 0; at + STRING <= size; at += STEP)
        table[load64(in + at) * UINT64_C(0x9e3779b97f4a7c15) >> (64 - LOG2)] = (uint32_t)at + 1;
    for (size_t window = spacing / 2; window + STEP + STRING <= size; window += spacing) {
        bool hit = false;
        for (size_t at = window; at < window + STEP && !hit; at++) {
            uint64_t string = load64(in + at);
            size_t other = table[string * UINT64_C(0x9e3779b97f4a7c15) >> (64 - LOG2)];
            hit = other && other - 1 != at && load64(in + other - 1) == string &&
                  (other - 1 < at ? at - (other - 1) : other - 1 - at) <= FAR;
        }
        windows++;
        hits += hit;
    }
    return hits * 48 > windows;
}

struct code {
    uint16_t codes[NLITERALS]; /* with their bits reversed */
    uint8_t lengths[NLITERALS];
};

static uint32_t reverse(uint32_t code, unsigned length) {
    uint32_t out = 0;
    for (; length; length--, code >>= 1)
        out = out << 1 | (code & 1);
    return out;
}

/* A Huffman code for `count` symbols, none longer than `limit`. At least two get a code, since
 * readers refuse incomplete ones. */
static void make_code(const uint32_t *frequencies, unsigned count, unsigned limit,
                      struct code *out) {
    uint64_t keys[NLITERALS], weights[2 * NLITERALS];
    uint16_t parents[2 * NLITERALS];
    uint8_t depths[2 * NLITERALS];
    uint32_t per_length[64] = {0}, next[16] = {0};
    unsigned used = 0;
    for (unsigned s = 0; s < count; s++) {
        out->lengths[s] = 0;
        if (frequencies[s])
            keys[used++] = (uint64_t)frequencies[s] << 16 | s;
    }
    for (unsigned s = 0; used < 2; s++)
        if (!frequencies[s])
            keys[used++] = UINT64_C(1) << 16 | s;
    for (unsigned i = 1; i < used; i++) { /* few, and in no bad order */
        uint64_t key = keys[i];
        unsigned k = i;
        for (; k && keys[k - 1] > key; k--)
            keys[k] = keys[k - 1];
        keys[k] = key;
    }
    for (unsigned i = 0; i < used; i++)
        weights[i] = keys[i] >> 16;
    unsigned leaf = 0, inner = used, end = used;
    while (end < 2 * used - 1) {
        uint64_t sum = 0;
        for (int child = 0; child < 2; child++) {
            bool take_leaf = leaf < used && (inner == end || weights[leaf] <= weights[inner]);
            unsigned node = take_leaf ? leaf++ : inner++;
            sum += weights[node];
            parents[node] = (uint16_t)end;
        }
        weights[end++] = sum;
    }
    depths[end - 1] = 0;
    for (unsigned i = end - 1; i-- > 0;) {
        depths[i] = (uint8_t)(depths[parents[i]] + 1);
        if (i < used)
            per_length[depths[i] < limit ? depths[i] : limit]++;
    }
    /* what was cut to the limit must be paid for by making others longer */
    uint32_t total = 0;
    for (unsigned length = 1; length <= limit; length++)
        total += per_length[length] << (limit - length);
    for (; total > 1u << limit; total--) {
        unsigned length = limit - 1;
        while (!per_length[length])
            length--;
        per_length[length]--;
        per_length[length + 1] += 2;
        per_length[limit]--;
    }
    for (unsigned i = 0, length = limit; i < used; i++) {
        while (!per_length[length])
            length--;
        per_length[length]--;
        out->lengths[keys[i] & 0xffff] = (uint8_t)length;
        next[length]++;
    }
    for (uint32_t length = 1, code = 0, first; length <= limit; length++) {
        first = code;
        code = (code + next[length]) << 1;
        next[length] = first;
    }
    for (unsigned s = 0; s < count; s++)
        if (out->lengths[s])
            out->codes[s] = (uint16_t)reverse(next[out->lengths[s]]++, out->lengths[s]);
}

/* Bits, from the lowest up; at most 7 are left between calls. */
struct bits {
    uint8_t *to;
    uint64_t word;
    unsigned count;
};

static inline void flush(struct bits *bits) {
    for (int i = 0; i < 8; i++)
        bits->to[i] = (uint8_t)(bits->word >> (8 * i));
    bits->to += bits->count >> 3;
    bits->word >>= bits->count & 56;
    bits->count &= 7;
}

static inline void put(struct bits *bits, uint64_t value, unsigned count) {
    bits->word |= value << bits->count;
    bits->count += count;
}

/* The lengths of all codes in runs: 16 repeats the one before, 17 and 18 are zeros. */
static unsigned describe(const uint8_t *lengths, unsigned count, uint8_t *symbols, uint8_t *extra) {
    unsigned n = 0;
    for (unsigned i = 0, run; i < count; i += run) {
        unsigned most = lengths[i] ? 7 : 138;
        for (run = 1; run < most && i + run < count && lengths[i + run] == lengths[i];)
            run++;
        if (!lengths[i] && run >= 3) {
            symbols[n] = run > 10 ? 18 : 17;
            extra[n++] = (uint8_t)(run - (run > 10 ? 11 : 3));
            continue;
        }
        symbols[n] = lengths[i];
        extra[n++] = 0;
        if (lengths[i] && run >= 4) {
            symbols[n] = 16;
            extra[n++] = (uint8_t)(run - 4);
        } else
            run = 1;
    }
    return n;
}

static void put_description(struct bits *bits, const struct code *literals,
                            const struct code *distances, bool last) {
    static const uint8_t order[NLENGTHS] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                            11, 4,  12, 3, 13, 2, 14, 1, 15};
    static const uint8_t extra_bits[3] = {2, 3, 7};
    uint8_t lengths[NLITERALS + NDISTANCES], symbols[NLITERALS + NDISTANCES];
    uint8_t extra[NLITERALS + NDISTANCES];
    uint32_t frequencies[NLENGTHS] = {0};
    unsigned nliterals = NLITERALS, ndistances = NDISTANCES, norder = NLENGTHS;
    struct code described;
    while (nliterals > 257 && !literals->lengths[nliterals - 1])
        nliterals--;
    while (ndistances > 1 && !distances->lengths[ndistances - 1])
        ndistances--;
    memcpy(lengths, literals->lengths, nliterals);
    memcpy(lengths + nliterals, distances->lengths, ndistances);
    unsigned n = describe(lengths, nliterals + ndistances, symbols, extra);
    for (unsigned i = 0; i < n; i++)
        frequencies[symbols[i]]++;
    make_code(frequencies, NLENGTHS, MAX_LENGTH_BITS, &described);
    while (norder > 4 && !described.lengths[order[norder - 1]])
        norder--;
    put(bits, last, 1);
    put(bits, 2, 2);
    put(bits, nliterals - 257, 5);
    put(bits, ndistances - 1, 5);
    put(bits, norder - 4, 4);
    flush(bits);
    for (unsigned i = 0; i < norder; i++) {
        put(bits, described.lengths[order[i]], 3);
        flush(bits);
    }
    for (unsigned i = 0; i < n; i++) {
        put(bits, described.codes[symbols[i]], described.lengths[symbols[i]]);
        if (symbols[i] >= 16)
            put(bits, extra[i], extra_bits[symbols[i] - 16]);
        flush(bits);
    }
}

static unsigned log2_of(uint32_t value) {
    return 31u - (unsigned)__builtin_clz(value);
}

/* The symbol, and how many more bits follow it with what value. */
static unsigned length_symbol(unsigned length, unsigned *count, unsigned *value) {
    unsigned rest = length - 3;
    *count = *value = 0;
    if (length == MAX_MATCH)
        return 285;
    if (rest < 8)
        return 257 + rest;
    *count = log2_of(rest) - 2;
    *value = rest & ((1u << *count) - 1);
    return 257 + 4 * *count + (rest >> *count);
}

static unsigned distance_symbol(unsigned distance, unsigned *count, unsigned *value) {
    unsigned rest = distance - 1;
    *count = *value = 0;
    if (rest < 4)
        return rest;
    *count = log2_of(rest) - 1;
    *value = rest & ((1u << *count) - 1);
    return 2 * *count + (rest >> *count);
}

static void count_bytes(const uint8_t *in, size_t size, uint32_t *out) {
    uint32_t counts[4][256] = {{0}};
    size_t i = 0;
    for (; i + 4 <= size; i += 4)
        for (int k = 0; k < 4; k++) /* neighbours are often equal, and would wait for each other */
            counts[k][in[i + (size_t)k]]++;
    for (; i < size; i++)
        counts[0][in[i]]++;
    for (int s = 0; s < 256; s++)
        out[s] = counts[0][s] + counts[1][s] + counts[2][s] + counts[3][s];
}

static inline const uint8_t *put_literals(struct bits *bits, const uint32_t *table,
                                          const uint8_t *in, size_t count) {
    for (; count >= 5; count -= 5, in += 5) {
        for (size_t k = 0; k < 5; k++)
            put(bits, table[in[k]] >> 8, table[in[k]] & 0xff);
        flush(bits);
    }
    for (; count; count--, in++) {
        put(bits, table[*in] >> 8, table[*in] & 0xff);
        flush(bits);
    }
    return in;
}

/* One block of literals and repeats; the sequences cover all of it. */
static void put_block(struct bits *bits, const uint8_t *in, const struct sequence *sequences,
                      size_t nsequences, bool last) {
    uint32_t frequencies[NLITERALS] = {0}, used[NDISTANCES] = {0}, table[NLITERALS];
    struct code literals, distances;
    unsigned count, value;
    if (nsequences == 1)
        count_bytes(in, sequences->literals, frequencies);
    else {
        const uint8_t *from = in;
        for (size_t i = 0; i < nsequences; i++) {
            for (uint32_t k = 0; k < sequences[i].literals; k++)
                frequencies[from[k]]++;
            from += sequences[i].literals + sequences[i].length;
            if (!sequences[i].length)
                continue;
            frequencies[length_symbol(sequences[i].length, &count, &value)]++;
            used[distance_symbol(sequences[i].distance, &count, &value)]++;
        }
    }
    frequencies[END_OF_BLOCK] = 1;
    make_code(frequencies, NLITERALS, MAX_LITERAL_BITS, &literals);
    make_code(used, NDISTANCES, MAX_LITERAL_BITS, &distances);
    put_description(bits, &literals, &distances, last);
    for (int s = 0; s < NLITERALS; s++)
        table[s] = literals.lengths[s] ? (uint32_t)literals.codes[s] << 8 | literals.lengths[s] : 0;
    struct bits b = *bits;
    for (size_t i = 0; i < nsequences; i++) {
        in = put_literals(&b, table, in, sequences[i].literals);
        if (!sequences[i].length)
            continue;
        unsigned symbol = length_symbol(sequences[i].length, &count, &value);
        put(&b, table[symbol] >> 8, table[symbol] & 0xff);
        put(&b, value, count);
        symbol = distance_symbol(sequences[i].distance, &count, &value);
        put(&b, distances.codes[symbol], distances.lengths[symbol]);
        put(&b, value, count);
        flush(&b);
        in += sequences[i].length;
    }
    put(&b, table[END_OF_BLOCK] >> 8, table[END_OF_BLOCK] & 0xff);
    flush(&b);
    *bits = b;
}

/* How many bytes are equal, up to `limit`. */
static inline unsigned match_length(const uint8_t *a, const uint8_t *b, unsigned limit) {
    unsigned length = 0;
    while (length + 8 <= limit) {
        uint64_t difference = load64(a + length) ^ load64(b + length);
        if (difference)
            return length + ((unsigned)__builtin_ctzll(difference) >> 3);
        length += 8;
    }
    while (length < limit && a[length] == b[length])
        length++;
    return length;
}

struct search {
    struct ptx_deflater *deflater;
    const uint8_t *in;
    size_t size;
    size_t rows[4]; /* distances at which repeats are likely; 0 for none */
    size_t latest;  /* the last one that was used */
    /* Short strings of few symbols are everywhere; long ones lead to what repeats for long. */
    unsigned strings[TABLES];
    float literal_bits;
};

static inline uint32_t *places_of(const struct search *s, size_t at, int table) {
    const uint8_t *p = s->in + at;
    unsigned length = s->strings[table];
    uint64_t hash = load64(p);
    if (length <= 8)
        hash <<= 64 - 8 * length;
    else {
        hash = (hash ^ hash >> 29) * UINT64_C(0xbf58476d1ce4e5b9) + load64(p + length - 8);
        if (length > 16)
            hash = (hash ^ hash >> 29) * UINT64_C(0xbf58476d1ce4e5b9) + load64(p + length / 2 - 4);
    }
    hash = (hash ^ hash >> 32) * UINT64_C(0x9e3779b97f4a7c15);
    return s->deflater->places[table][hash >> (64 - HASH_BITS)];
}

static inline void remember(const struct search *s, size_t at, uint32_t *places) {
    for (int way = WAYS - 1; way > 0; way--)
        places[way] = places[way - 1];
    places[0] = s->deflater->base + (uint32_t)at;
}

struct repeat {
    unsigned length;
    size_t distance;
    float gain; /* bits saved */
};

static inline void try_distance(const struct search *s, size_t at, size_t distance, unsigned limit,
                                struct repeat *best) {
    const uint8_t *here = s->in + at;
    if (!distance || distance > at)
        return;
    const uint8_t *there = here - distance;
    if (best->length && here[best->length - 1] != there[best->length - 1])
        return;
    unsigned found = match_length(here, there, limit);
    if (found < MIN_MATCH || found < best->length)
        return;
    float cost = distance == s->latest ? 8.0f : 8.0f + 0.6f * (float)log2_of((uint32_t)distance);
    float gain = (float)found * s->literal_bits - cost;
    if (gain > best->gain)
        *best = (struct repeat){found, distance, gain};
}

/* The best repeat at a place that has MAX_STRING bytes left; none has a length of 0. */
static inline struct repeat find(const struct search *s, size_t at, size_t end) {
    unsigned limit = end - at < MAX_MATCH ? (unsigned)(end - at) : MAX_MATCH;
    unsigned enough = limit < LONG ? limit : LONG;
    struct repeat best = {0};
    try_distance(s, at, s->latest, limit, &best);
    for (int i = 0; i < 4 && best.length < limit; i++)
        try_distance(s, at, s->rows[i], limit, &best);
    for (int table = TABLES - 1; table >= 0; table--) {
        uint32_t *places = places_of(s, at, table);
        for (int way = 0; way < WAYS && best.length < enough; way++) {
            if (places[way] < s->deflater->base)
                break;
            size_t back = at - (places[way] - s->deflater->base);
            if (back <= FAR)
                try_distance(s, at, back, limit, &best);
        }
        remember(s, at, places);
    }
    return best;
}

/* Cuts a block into sequences. */
static size_t find_sequences(struct search *s, size_t first, size_t end) {
    struct sequence *out = s->deflater->sequences;
    size_t count = 0, literals = first, at = first;
    size_t stop = s->size < MAX_STRING ? 0 : s->size - MAX_STRING;
    stop = stop < end - MIN_MATCH ? stop : end - MIN_MATCH;
    while (at < stop) {
        struct repeat best = find(s, at, end), next;
        if (!best.length) {
            at++;
            continue;
        }
        /* one byte on there may be a better one */
        while (best.length < ENOUGH && at + 1 < stop &&
               (next = find(s, at + 1, end)).gain > best.gain) {
            at++;
            best = next;
        }
        out[count++] = (struct sequence){(uint32_t)(at - literals), (uint16_t)best.length,
                                         (uint16_t)best.distance};
        s->latest = best.distance;
        literals = at + best.length;
        for (at += 2; at < literals && at < stop; at += 2)
            for (int table = 0; table < TABLES; table++)
                remember(s, at, places_of(s, at, table));
        at = literals;
    }
    out[count++] = (struct sequence){(uint32_t)(end - literals), 0, 0};
    return count;
}

/* Bits for a literal if there were nothing else. */
static float entropy(const uint8_t *in, size_t size) {
    uint32_t counts[256];
    float sum = 0.0f;
    count_bytes(in, size, counts);
    for (int s = 0; s < 256; s++)
        if (counts[s])
            sum -= (float)counts[s] * log2f((float)counts[s] / (float)size);
    return sum / (float)size;
}

slv_result slvi_ptx_deflater_create(const slv_env *env, const char *path,
                                    struct ptx_deflater **out) {
    slv_result result = slvi_alloc(env, path, 1, sizeof **out, out);
    if (!result)
        (*out)->base = 1;
    return result;
}

size_t slvi_ptx_deflate_bound(size_t size) {
    /* a code of equal lengths would need 9 bits; ours is never longer in sum */
    return size + size / 8 + (size / BLOCK + 1) * 400 + 64;
}

size_t slvi_ptx_deflate(struct ptx_deflater *deflater, const uint8_t *in, size_t size, size_t row,
                        size_t step, uint8_t *out) {
    size_t nblocks = (size + BLOCK - 1) / BLOCK, part = (size + nblocks - 1) / nblocks;
    bool search = bytes_repeat(in, size);
    float bits_each = search ? entropy(in, size) : 0.0f;
    struct search s = {.deflater = deflater,
                       .in = in,
                       .size = size,
                       /* what is left between repeats is the rarer symbols, but not by much */
                       .literal_bits = 0.85f * bits_each,
                       .rows = {row, row + step, row > step ? row - step : 0, step}};
    struct bits bits = {.to = out + 2};
    for (int i = 0; i < 4; i++)
        if (s.rows[i] > FAR)
            s.rows[i] = 0;
    if ((search && (bits_each > 4.0f || size < SMALL)) || size > UINT32_MAX / 4)
        return 0;
    for (int table = 0; search && table < TABLES; table++) {
        float wanted = (table ? 44.0f : 24.0f) / (bits_each + 0.1f);
        s.strings[table] = wanted < MIN_MATCH                  ? MIN_MATCH
                           : wanted > MAX_STRING / (2 - table) ? MAX_STRING / (2u - (unsigned)table)
                                                               : (unsigned)wanted;
    }
    if (deflater->base > UINT32_MAX / 2) {
        memset(deflater->places, 0, sizeof deflater->places);
        deflater->base = 1;
    }
    out[0] = 0x78; /* deflate, 32 KiB */
    out[1] = 0x5e;
    for (size_t at = 0; at < size; at += part) {
        size_t end = size - at < part ? size : at + part, count = 1;
        if (search)
            count = find_sequences(&s, at, end);
        else
            deflater->sequences[0] = (struct sequence){(uint32_t)(end - at), 0, 0};
        put_block(&bits, in + at, deflater->sequences, count, end == size);
    }
    deflater->base += (uint32_t)size;
    bits.count += bits.count ? 8 - bits.count : 0;
    flush(&bits);
    uint32_t checksum = libdeflate_adler32(1, in, size);
    for (int shift = 24; shift >= 0; shift -= 8)
        *bits.to++ = (uint8_t)(checksum >> shift);
    return (size_t)(bits.to - out);
}
