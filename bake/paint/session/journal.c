/* The journal: appended to, and never believed beyond its last whole line. */
#include "session/session_data.h"

#include "base/file.h"
#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <libdeflate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* A line ends with ,"n":12,"crc":"0123abcd"} */
#define CRC_KEY ",\"crc\":\""
#define CRC_SIZE (sizeof CRC_KEY - 1 + 8 + 2)

/* CRC-32 of IEEE 802.3. */
uint32_t slvi_crc(uint32_t crc, const void *data, size_t size) {
    return size ? libdeflate_crc32(crc, data, size) : crc;
}

slv_result slvi_journal_open(const slv_env *env, const char *path, bool read, bool *missing,
                             slvi_journal *journal) {
    const int flags = (read ? O_RDONLY : O_RDWR) | O_CLOEXEC | O_NOFOLLOW;
    struct stat status;
    size_t size = strlen(path) + 1;
    *journal = (slvi_journal){.env = *env, .file = -1, .next = 1};
    slv_result result = slvi_alloc(env, "journal", size, 1, &journal->path);
    if (result)
        return result;
    memcpy(journal->path, path, size);
    journal->file = open(path, flags);
    bool none = journal->file < 0 && errno == ENOENT;
    if (missing)
        *missing = none;
    if (none && read)
        return SLV_OK;
    if (none)
        journal->file = open(path, flags | O_CREAT, 0666);
    if (journal->file < 0 || fstat(journal->file, &status) != 0 || !S_ISREG(status.st_mode))
        return slvi_fail(env, SLV_ERROR_IO, "%s: %s", path,
                         journal->file < 0 ? strerror(errno) : "is no file");
    if (flock(journal->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return slvi_fail(env, SLV_ERROR_IO,
                         "%s: this session is open already, here or in another process", path);
    journal->size = (uint64_t)status.st_size;
    return SLV_OK;
}

void slvi_journal_close(slvi_journal *journal) {
    if (journal->path && journal->file >= 0)
        close(journal->file);
    slvi_free(journal->path);
    *journal = (slvi_journal){.file = -1};
}

/* Whether a line, without its end, is as it was written. */
static bool is_whole(const char *line, size_t size, slvi_journal_line *out) {
    char expected[16];
    if (size < CRC_SIZE || line[0] != '{' ||
        memcmp(line + size - CRC_SIZE, CRC_KEY, sizeof CRC_KEY - 1) != 0)
        return false;
    size_t end = size - CRC_SIZE, at = end;
    snprintf(expected, sizeof expected, "%08" PRIx32 "\"}", slvi_crc(0, line, end));
    if (memcmp(line + size - 10, expected, 10) != 0)
        return false;
    while (at && line[at - 1] >= '0' && line[at - 1] <= '9')
        at--;
    if (at < 6 || end - at > 18 || at == end || memcmp(line + at - 5, ",\"n\":", 5) != 0)
        return false;
    for (size_t i = at; i < end; i++)
        out->number = out->number * 10 + (uint64_t)(line[i] - '0');
    out->size = at - 5;
    return true;
}

slv_result slvi_journal_scan(const slvi_journal *journal, slvi_journal_text *out) {
    uint64_t room = 0, size = journal->size, last = 0;
    *out = (slvi_journal_text){0};
    slv_result result = slvi_alloc_plain(&journal->env, "journal", size + 1, 1, &out->text);
    if (result)
        return result;
    int reason = size ? slvi_read_at(journal->file, out->text, size, 0) : 0;
    if (reason)
        return slvi_fail(&journal->env, slvi_io_error(reason), "%s: %s", journal->path,
                         strerror(reason));
    out->text[size] = 0;
    while (out->end < size) {
        const char *line = out->text + out->end, *stop = memchr(line, '\n', size - out->end);
        slvi_journal_line found = {.at = out->end};
        if (!stop || !is_whole(line, (size_t)(stop - line), &found) || found.number <= last)
            break;
        if (out->count == room) {
            room += room / 2 + 64;
            if ((result =
                     slvi_grow(&journal->env, "journal", room, sizeof *out->lines, &out->lines)))
                return result;
        }
        out->lines[out->count++] = found;
        last = found.number;
        out->end += (uint64_t)(stop - line) + 1;
    }
    return SLV_OK;
}

static bool begins(const slvi_journal_text *text, uint64_t i, const char *with) {
    return text->lines[i].size == strlen(with) &&
           memcmp(text->text + text->lines[i].at, with, strlen(with)) == 0;
}

bool slvi_journal_survivors(const slvi_journal_text *text, uint64_t line, uint64_t *live,
                            uint64_t *count, uint64_t *undone, bool *whole) {
    *count = *undone = 0;
    *whole = true;
    for (uint64_t i = 0; i < text->count; i++) {
        if (text->lines[i].number <= line)
            continue;
        if (text->lines[i].number != line + 1) {
            *whole = false;
            break;
        }
        line++;
        if (begins(text, i, "{\"op\":\"undo\"")) {
            if (!*count)
                return false;
            --*count;
            ++*undone;
        } else if (begins(text, i, "{\"op\":\"redo\"")) {
            if (!*undone)
                return false;
            ++*count;
            --*undone;
        } else {
            live[(*count)++] = i;
            *undone = 0;
        }
    }
    return true;
}

void slvi_journal_free(slvi_journal_text *text) {
    slvi_free(text->text);
    slvi_free(text->lines);
}

slv_result slvi_journal_cut(slvi_journal *journal, uint64_t end) {
    if (end == journal->size)
        return SLV_OK;
    if (ftruncate(journal->file, (off_t)end) != 0)
        return slvi_fail(&journal->env, SLV_ERROR_IO, "%s: %s", journal->path, strerror(errno));
    journal->size = end;
    return SLV_OK;
}

static slv_result append(slvi_journal *journal, const char *text, size_t size) {
    slv_result result =
        slvi_write_at(&journal->env, journal->path, journal->file, text, size, journal->size);
    if (!result && !journal->relaxed && fdatasync(journal->file) != 0)
        result = slvi_fail(&journal->env, SLV_ERROR_IO, "%s: %s", journal->path, strerror(errno));
    if (!result) {
        journal->size += size;
        journal->next++;
    } else if (ftruncate(journal->file, (off_t)journal->size) != 0) {
        slvi_logf(&journal->env, SLV_LOG_WARNING, "%s: an unfinished line stays at its end",
                  journal->path);
    }
    return result;
}

slv_result slvi_journal_append(slvi_journal *journal, const json_t *line) {
    char *body = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(17)), *text = NULL;
    size_t length = body ? strlen(body) : 0, room = length + 64;
    slv_result result;
    if (length < 3) /* an object with something in it */
        result =
            slvi_fail(&journal->env, SLV_ERROR_MEMORY, "%s: no memory for a line", journal->path);
    else
        result = slvi_alloc_plain(&journal->env, "journal", room, 1, &text);
    if (!result) {
        memcpy(text, body, length - 1);
        size_t end = length - 1;
        end += (size_t)snprintf(text + end, room - end, ",\"n\":%" PRIu64, journal->next);
        uint32_t crc = slvi_crc(0, text, end);
        end += (size_t)snprintf(text + end, room - end, CRC_KEY "%08" PRIx32 "\"}\n", crc);
        result = append(journal, text, end);
    }
    free(body);
    slvi_free(text);
    return result;
}
