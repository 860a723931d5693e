/* Few draws: a batch begins with the pools of one face and grows by the pool that brings most other
 * faces closest to fitting in, until it is as wide as a draw can bind. */
#include "gl/store/group.h"

#include "base/memory.h"

#include <string.h>

/* Faces that one batch chooses from: those close together need the same pools, and with more of
 * them every step would take longer. */
#define WINDOW 32768u

struct group {
    const slv_gl_need *needs;
    uint32_t *first, *users; /* of each pool, the needs that have it: users[first[p]..] */
    uint64_t *score;         /* of each pool: how much it would help */
    uint8_t *missing;        /* of each need, pools that the batch lacks */
    bool *taken, *held;      /* of each need, has a batch; of each pool, is in the new batch */
    uint32_t *waiting;       /* needs without a batch, in order, from `head` to `count` */
    uint32_t head, count;
    uint32_t looked_at, end; /* how many of these the batch chooses from, and one past the last */
};

static slv_result begin(const slv_env *env, const slv_gl_need *needs, uint32_t count,
                        uint32_t npools, struct group *out) {
    uint64_t nusers = 0;
    slv_result result;
    for (uint32_t i = 0; i < count; i++)
        nusers += needs[i].npools;
    *out = (struct group){.needs = needs, .count = count};
    if ((result = slvi_alloc(env, "batches", npools + 2, sizeof *out->first, &out->first)) ||
        (result = slvi_alloc(env, "batches", nusers, sizeof *out->users, &out->users)) ||
        (result = slvi_alloc(env, "batches", npools, sizeof *out->score, &out->score)) ||
        (result = slvi_alloc(env, "batches", count, 1, &out->missing)) ||
        (result = slvi_alloc(env, "batches", count, sizeof *out->taken, &out->taken)) ||
        (result = slvi_alloc(env, "batches", npools, sizeof *out->held, &out->held)) ||
        (result = slvi_alloc(env, "batches", count, sizeof *out->waiting, &out->waiting)))
        return result;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < needs[i].npools; k++)
            out->first[needs[i].pools[k] + 2]++;
    for (uint32_t p = 0; p < npools; p++)
        out->first[p + 2] += out->first[p + 1];
    for (uint32_t i = 0; i < count; i++) {
        out->waiting[i] = i;
        for (uint32_t k = 0; k < needs[i].npools; k++)
            out->users[out->first[needs[i].pools[k] + 1]++] = i;
    }
    return SLV_OK;
}

static void end(struct group *group) {
    slvi_free(group->first);
    slvi_free(group->users);
    slvi_free(group->score);
    slvi_free(group->missing);
    slvi_free(group->taken);
    slvi_free(group->held);
    slvi_free(group->waiting);
}

/* What one more pool is worth to a face that lacks so many: four of those that lack two count as
 * one that lacks one. */
static uint64_t worth(uint32_t missing) {
    return (uint64_t)1 << 2 * (SLV_GL_MOST_NEEDED - missing);
}

static void count_need(struct group *group, uint32_t need, bool add) {
    const slv_gl_need *face = &group->needs[need];
    uint64_t value = worth(group->missing[need]);
    for (uint32_t k = 0; k < face->npools; k++)
        if (!group->held[face->pools[k]])
            group->score[face->pools[k]] += add ? value : 0 - value;
}

static void add_pool(struct group *group, slv_gl_batch_range *range, uint32_t pool) {
    uint32_t first = group->first[pool], last = group->first[pool + 1];
    while (last > first && group->users[last - 1] >= group->end)
        last--;
    for (uint32_t u = first; u < last; u++) {
        uint32_t need = group->users[u];
        if (!group->taken[need])
            count_need(group, need, false);
    }
    range->pools[range->npools++] = pool;
    group->held[pool] = true;
    for (uint32_t u = first; u < last; u++) {
        uint32_t need = group->users[u];
        if (!group->taken[need] && --group->missing[need])
            count_need(group, need, true);
    }
}

static uint32_t best_pool(const struct group *group, uint32_t npools) {
    uint32_t best = npools;
    uint64_t most = 0;
    for (uint32_t p = 0; p < npools; p++) {
        if (group->score[p] > most && !group->held[p]) {
            most = group->score[p];
            best = p;
        }
    }
    return best;
}

/* Chooses the pools of a batch, from all those of the first face that waits or from its own pool
 * alone; returns how many faces fit in. */
static uint32_t choose_pools(struct group *group, slv_gl_batch_range *range, uint32_t npools,
                             uint32_t most, bool whole_seed) {
    const slv_gl_need *seed = &group->needs[group->waiting[group->head]];
    uint32_t left = group->count - group->head, pool = npools, fitting = 0;
    group->looked_at = left < WINDOW ? left : WINDOW;
    group->end = group->waiting[group->head + group->looked_at - 1] + 1;
    memset(group->score, 0, npools * sizeof *group->score);
    memset(group->held, 0, npools);
    range->npools = 0;
    for (uint32_t i = 0; i < group->looked_at; i++) {
        uint32_t need = group->waiting[group->head + i];
        group->missing[need] = (uint8_t)group->needs[need].npools;
        count_need(group, need, true);
    }
    for (uint32_t k = 0; k < (whole_seed ? seed->npools : 1); k++)
        add_pool(group, range, seed->pools[k]);
    while (range->npools < most && (pool = best_pool(group, npools)) < npools)
        add_pool(group, range, pool);
    for (uint32_t i = 0; i < group->looked_at; i++)
        fitting += !group->missing[group->waiting[group->head + i]];
    return fitting;
}

/* All but the first in one order: a software driver compiles a program for each sequence of pools
 * that are unlike to it, such as those of one texel. */
static void sort_pools(slv_gl_batch_range *range) {
    for (uint32_t i = 2; i < range->npools; i++) {
        uint32_t pool = range->pools[i], at = i;
        for (; at > 1 && range->pools[at - 1] > pool; at--)
            range->pools[at] = range->pools[at - 1];
        range->pools[at] = pool;
    }
}

/* Gives the batch the faces that fit in, and takes pools away again that none of them needs. */
static void take_faces(struct group *group, slv_gl_batch_range *range, uint32_t batch,
                       uint32_t *batch_of) {
    bool used[sizeof range->pools / sizeof *range->pools] = {true};
    uint32_t kept = group->head + group->looked_at, npools = 0;
    for (uint32_t i = group->head + group->looked_at; i-- > group->head;) {
        uint32_t need = group->waiting[i];
        const slv_gl_need *face = &group->needs[need];
        if (group->missing[need]) {
            group->waiting[--kept] = need;
            continue;
        }
        group->taken[need] = true;
        batch_of[face->face] = batch;
        range->count++;
        for (uint32_t k = 0; k < face->npools; k++)
            used[slvi_gl_slot_of(range, face->pools[k])] = true;
    }
    group->head = kept;
    for (uint32_t k = 0; k < range->npools; k++)
        if (used[k])
            range->pools[npools++] = range->pools[k];
    range->npools = npools;
    sort_pools(range);
}

/* The parameters are what a group of faces is, and where its batches go. */
slv_result slvi_gl_group(const slv_env *env, slv_gl_batches *batches, const slv_gl_need *needs,
                         uint32_t count, uint32_t npools, uint32_t most, bool subfaces,
                         uint32_t *batch_of) {
    struct group group;
    slv_result result = begin(env, needs, count, npools, &group);
    while (!result && group.head < group.count) {
        slv_gl_batch_range *range = NULL;
        if ((result = slvi_gl_add_batch(env, batches, &range)))
            break;
        uint32_t of_pool = choose_pools(&group, range, npools, most, false);
        if (choose_pools(&group, range, npools, most, true) < of_pool)
            choose_pools(&group, range, npools, most, false);
        take_faces(&group, range, batches->count - 1, batch_of);
        range->variant = slvi_gl_variant_for(range->npools, subfaces);
    }
    end(&group);
    return result;
}
