/* Changes what lies inside zlib streams, which checksums keep plain mutations out of: one of an
 * input's streams is unpacked, changed and packed again into no more bytes than it had. The
 * checksums of PNG chunks are put right as well. */
#include <libdeflate.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { MAX_PLAIN = 1 << 18 };

/* Kept from call to call: making them takes longer than a run. */
static uint8_t plain[MAX_PLAIN], again[MAX_PLAIN];
static struct libdeflate_decompressor *inflater;
static struct libdeflate_compressor *deflater;

int LLVMFuzzerInitialize(int *argc, char ***argv);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc, (void)argv;
    inflater = libdeflate_alloc_decompressor();
    deflater = libdeflate_alloc_compressor(12);
    return inflater && deflater ? 0 : 1;
}

/* The first stream from a place on, going around: its start, and in *zipped and *unpacked its
 * lengths; `size` if there is none. */
static size_t find_stream(const uint8_t *data, size_t size, size_t from, size_t *zipped,
                          size_t *unpacked) {
    size_t found = size;
    for (size_t i = 0; found == size && i < size; i++) {
        size_t at = (from + i) % size;
        if (size - at < 8 || data[at] != 0x78 || (data[at] << 8 | data[at + 1]) % 31)
            continue;
        if (libdeflate_zlib_decompress_ex(inflater, data + at, size - at, plain, MAX_PLAIN, zipped,
                                          unpacked) == LIBDEFLATE_SUCCESS &&
            *unpacked)
            found = at;
    }
    return found;
}

/* Values that sizes, counts and indices turn bad with. */
static void set_word(size_t size, unsigned seed) {
    static const uint32_t words[] = {0, 1, 0xffffffff, 0x7fffffff, 0x3fffffff, 0xc0000000, 0x10100};
    uint32_t word = words[seed / 16 % 7];
    size_t at = seed / 128 % size, length = size - at < 4 ? size - at : 4;
    memcpy(plain + at, &word, seed & 8 ? 1 : length);
}

static bool mutate_stream(uint8_t *data, size_t size, unsigned seed) {
    size_t zipped, unpacked, packed = 0;
    size_t at = find_stream(data, size, seed % size, &zipped, &unpacked);
    if (at < size) {
        if (seed & 4) {
            set_word(unpacked, seed);
        } else {
            size_t length = LLVMFuzzerMutate(plain, unpacked, unpacked);
            memset(plain + length, 0, unpacked - length);
        }
        packed = libdeflate_zlib_compress(deflater, plain, unpacked, again, zipped);
    }
    if (packed) {
        memcpy(data + at, again, packed);
        memset(data + at + packed, 0, zipped - packed);
    }
    return packed > 0;
}

static void mend_png(uint8_t *data, size_t size) {
    for (size_t at = 8; at + 12 <= size;) {
        uint32_t length = (uint32_t)data[at] << 24 | (uint32_t)data[at + 1] << 16 |
                          (uint32_t)data[at + 2] << 8 | data[at + 3];
        if (length > size - at - 12)
            return;
        uint32_t sum = libdeflate_crc32(0, data + at + 4, length + 4);
        for (int i = 0; i < 4; i++)
            data[at + 8 + length + (size_t)i] = (uint8_t)(sum >> (24 - 8 * i));
        at += 12 + (size_t)length;
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    if (!(seed & 1) || !size || !mutate_stream(data, size, seed / 2))
        size = LLVMFuzzerMutate(data, size, max_size);
    if (size > 8 && memcmp(data, "\x89PNG", 4) == 0)
        mend_png(data, size);
    return size;
}
