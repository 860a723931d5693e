/* Blocks that were baked, kept in a file until the bake is complete, so that a killed one goes on
 * where it was. A header that says of which bake, and records: faces, a checksum, texels, misses.
 */
#include "recipe/bake_data.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static const char MAGIC[8] = {'S', 'L', 'V', 'B', 'A', 'K', 'E', '1'};

typedef struct header {
    char magic[8];
    uint64_t bake; /* a hash of all that decides its bytes */
} header;

typedef struct record {
    uint32_t first, end;
    uint64_t sum;
} record;

struct bake_part {
    int descriptor;
    uint64_t size; /* up to where all is whole */
};

static uint64_t hash(uint64_t state, const void *bytes, uint64_t size) {
    const uint8_t *at = bytes;
    for (; size >= 8; at += 8, size -= 8) {
        uint64_t word;
        memcpy(&word, at, 8);
        state = (state ^ word) * UINT64_C(0x9e3779b97f4a7c15);
        state ^= state >> 29;
    }
    for (; size; at++, size--)
        state = (state ^ *at) * UINT64_C(0x100000001b3);
    return state ^ state >> 32;
}

static uint64_t identity(const bake *b) {
    const char *key = b->job->resume_key ? b->job->resume_key : "";
    uint32_t kind[4] = {(uint32_t)b->report->type, b->source->desc.nchannels,
                        (uint32_t)b->report->encoding, b->source->nfaces};
    uint64_t state = hash(17, key, strlen(key));
    state = hash(state, kind, sizeof kind);
    return hash(state, b->res, b->source->nfaces * sizeof *b->res);
}

static uint64_t texels_in(const bake *b) {
    return b->block.offsets[b->block.end - b->block.first];
}

static uint64_t sum_of(const bake *b) {
    uint64_t n = texels_in(b);
    return hash(hash(b->block.first, b->block.texels, n * b->texel_size), b->block.misses, n);
}

/* Takes in one record; false where what follows is not whole. */
static bool take(bake *b, uint64_t length, slv_result *result) {
    bake_part *part = b->part;
    record r;
    if (length - part->size < sizeof r ||
        slvi_read_at(part->descriptor, &r, sizeof r, part->size) || r.first >= r.end ||
        r.end > b->source->nfaces)
        return false;
    uint64_t texels = 0;
    for (uint32_t face = r.first; face < r.end; face++)
        texels += slvi_bake_texels_of(b->res[face]);
    uint64_t bytes = texels * (b->texel_size + 1);
    if (length - part->size - sizeof r < bytes ||
        (*result = slvi_bake_begin_block(b, r.first, r.end)))
        return false;
    uint64_t at = part->size + sizeof r;
    if (slvi_read_at(part->descriptor, b->block.texels, texels * b->texel_size, at) ||
        slvi_read_at(part->descriptor, b->block.misses, texels, at + texels * b->texel_size) ||
        sum_of(b) != r.sum)
        return false;
    for (uint64_t i = 0; i < texels; i++)
        if (b->block.misses[i] >= SLV_BAKE_MISSES)
            return false;
    memset(b->done + r.first, 1, r.end - r.first);
    part->size = at + bytes;
    if (!(*result = slvi_bake_write_block(b)))
        *result = slvi_steps_add(&b->steps, &b->env, "bake", texels);
    return !*result;
}

slv_result slvi_bake_part_open(bake *b) {
    const char *path = b->job->resume;
    header own = {.bake = identity(b)}, found;
    slv_result result = SLV_OK;
    if (!path)
        return SLV_OK;
    memcpy(own.magic, MAGIC, sizeof MAGIC);
    if ((result = slvi_alloc(&b->env, path, 1, sizeof *b->part, &b->part)))
        return result;
    b->part->descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    off_t length = b->part->descriptor < 0 ? -1 : lseek(b->part->descriptor, 0, SEEK_END);
    if (length < 0)
        return slvi_fail(&b->env, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
    if (length) {
        bool known = !slvi_read_at(b->part->descriptor, &found, sizeof found, 0) &&
                     memcmp(found.magic, MAGIC, sizeof MAGIC) == 0;
        if (!known)
            return slvi_fail(&b->env, SLV_ERROR_FORMAT,
                             "%s: is no bake that was begun, and is not written over", path);
        if (found.bake == own.bake) {
            b->part->size = sizeof own;
            while (take(b, (uint64_t)length, &result))
                ;
        } else {
            slvi_logf(&b->env, SLV_LOG_WARNING,
                      "%s: was begun with other files or settings: all faces are baked", path);
        }
    }
    if (!result && ftruncate(b->part->descriptor, (off_t)b->part->size) != 0)
        result = slvi_fail(&b->env, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
    if (!result && !b->part->size &&
        !(result = slvi_write_at(&b->env, path, b->part->descriptor, &own, sizeof own, 0)))
        b->part->size = sizeof own;
    return result;
}

slv_result slvi_bake_part_keep(bake *b) {
    const char *path = b->job->resume;
    bake_part *part = b->part;
    if (!part)
        return SLV_OK;
    uint64_t texels = texels_in(b), at = part->size + sizeof(record);
    const record r = {b->block.first, b->block.end, sum_of(b)};
    slv_result result;
    if ((result = slvi_write_at(&b->env, path, part->descriptor, b->block.texels,
                                texels * b->texel_size, at)) ||
        (result = slvi_write_at(&b->env, path, part->descriptor, b->block.misses, texels,
                                at + texels * b->texel_size)) ||
        (result = slvi_write_at(&b->env, path, part->descriptor, &r, sizeof r, part->size)))
        return result;
    part->size = at + texels * (b->texel_size + 1);
    return SLV_OK;
}

void slvi_bake_part_remove(bake *b) {
    if (b->part)
        unlink(b->job->resume);
}

void slvi_bake_part_close(bake *b) {
    if (b->part && b->part->descriptor >= 0)
        close(b->part->descriptor);
    slvi_free(b->part);
    b->part = NULL;
}
