/* Findings from many threads, and the report that is the same for any number of them. */
#include "ptx/check/check.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct kept {
    slv_check_finding *list;
    uint32_t count, capacity;
};

struct check_findings {
    pthread_mutex_t lock;
    slv_env env; /* says nothing */
    uint32_t max_kept;
    bool no_memory;
    struct kept kinds[SLV_CHECK_KINDS];
    uint64_t counts[SLV_CHECK_KINDS], warnings[SLV_CHECK_KINDS];
};

const char *slv_check_kind_name(slv_check_kind kind) {
    static const char *const names[SLV_CHECK_KINDS] = {
        [SLV_CHECK_STRUCTURE] = "structure",   [SLV_CHECK_TEXELS] = "texels",
        [SLV_CHECK_VALUES] = "values",         [SLV_CHECK_ADJACENCY] = "adjacency",
        [SLV_CHECK_SUBFACES] = "sub-faces",    [SLV_CHECK_FLAGS] = "flags",
        [SLV_CHECK_REDUCTIONS] = "reductions", [SLV_CHECK_SEAMS] = "seams",
        [SLV_CHECK_META] = "metadata",         [SLV_CHECK_MESH] = "mesh"};
    return (unsigned)kind < SLV_CHECK_KINDS ? names[kind] : "unknown";
}

slv_result slvi_check_findings_create(const slv_env *env, uint32_t max_kept, check_findings **out) {
    slv_result result = slvi_alloc(env, "findings", 1, sizeof **out, out);
    if (result)
        return result;
    pthread_mutex_init(&(*out)->lock, NULL);
    (*out)->max_kept = max_kept;
    (*out)->env = slvi_env_or_default(env);
    (*out)->env.log = NULL;
    return SLV_OK;
}

void slvi_check_findings_destroy(check_findings *findings) {
    if (!findings)
        return;
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++)
        slvi_free(findings->kinds[kind].list);
    pthread_mutex_destroy(&findings->lock);
    slvi_free(findings);
}

static int compare(const void *left, const void *right) {
    const slv_check_finding *a = left, *b = right;
    if (a->face != b->face)
        return a->face < b->face ? -1 : 1;
    if (a->edge != b->edge)
        return a->edge < b->edge ? -1 : 1;
    if (a->level != b->level)
        return a->level < b->level ? -1 : 1;
    return strcmp(a->message, b->message);
}

/* Which findings are kept must not depend on when they came: always the first by place. */
static void cut(struct kept *kept, uint32_t max_kept) {
    if (kept->count)
        qsort(kept->list, kept->count, sizeof *kept->list, compare);
    if (kept->count > max_kept)
        kept->count = max_kept;
}

static slv_check_finding *make_room(check_findings *findings, struct kept *kept) {
    if (kept->count / 2 >= findings->max_kept)
        cut(kept, findings->max_kept);
    if (kept->count == kept->capacity) {
        uint32_t capacity = kept->capacity ? 2 * kept->capacity : 16;
        if (slvi_grow(&findings->env, "findings", capacity, sizeof *kept->list, &kept->list))
            return NULL;
        kept->capacity = capacity;
    }
    return &kept->list[kept->count++];
}

void slvi_check_find(check_findings *findings, const slv_check_finding *finding, const char *format,
                     ...) {
    pthread_mutex_lock(&findings->lock);
    slv_check_finding *kept = make_room(findings, &findings->kinds[finding->kind]);
    findings->counts[finding->kind]++;
    findings->warnings[finding->kind] += finding->warning;
    if (kept) {
        va_list args;
        va_start(args, format);
        *kept = *finding;
        vsnprintf(kept->message, sizeof kept->message, format, args);
        va_end(args);
    } else {
        findings->no_memory = true;
    }
    pthread_mutex_unlock(&findings->lock);
}

void slvi_check_findings_mend(check_findings *findings, slv_check_kind kind) {
    struct kept *kept = &findings->kinds[kind];
    pthread_mutex_lock(&findings->lock);
    for (uint32_t i = 0; i < kept->count; i++)
        kept->list[i].repairable = true;
    pthread_mutex_unlock(&findings->lock);
}

slv_result slvi_check_findings_report(const slv_env *env, check_findings *findings,
                                      slv_ptx_report *report) {
    slv_check_finding *list = NULL;
    uint32_t count = 0;
    if (findings->no_memory)
        return slvi_fail(env, SLV_ERROR_MEMORY, "no memory for the findings of the check");
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++) {
        cut(&findings->kinds[kind], findings->max_kept);
        count += findings->kinds[kind].count;
    }
    slv_result result = slvi_alloc(env, "findings", count, sizeof *list, &list);
    if (result)
        return result;
    for (int kind = 0; kind < SLV_CHECK_KINDS; kind++) {
        const struct kept *kept = &findings->kinds[kind];
        if (kept->count)
            memcpy(list + report->nfindings, kept->list, kept->count * sizeof *list);
        report->nfindings += kept->count;
        report->counts[kind] = findings->counts[kind];
        report->warnings[kind] = findings->warnings[kind];
    }
    report->findings = list;
    return SLV_OK;
}

bool slvi_check_is_of_file(slv_result result) {
    return result == SLV_ERROR_FORMAT || result == SLV_ERROR_UNSUPPORTED ||
           result == SLV_ERROR_MISMATCH;
}

static void keep_error(void *user, slv_log_level level, const char *message) {
    check_log *log = user;
    size_t length = log->prefix ? strlen(log->prefix) : 0;
    if (level != SLV_LOG_ERROR)
        return;
    if (length && strncmp(message, log->prefix, length) == 0) {
        message += length;
        while (*message == ':' || *message == ' ')
            message++;
    }
    snprintf(log->message, sizeof log->message, "%s", message);
}

slv_env slvi_check_log_env(const slv_env *env, check_log *log, const char *prefix) {
    slv_env inner = *env;
    log->message[0] = 0;
    log->prefix = prefix;
    inner.log = keep_error;
    inner.log_user = log;
    return inner;
}

void slv_ptx_report_destroy(slv_ptx_report *report) {
    if (!report)
        return;
    /* the list is const to those who read the report */
    slvi_free((void *)(uintptr_t)report->findings);
    slvi_free(report);
}
