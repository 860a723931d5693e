/* A bake by several processes: rank 0 hands out blocks of faces, receives their texels and writes
 * the file; the others have no more than the block that they work on. */
#include "recipe/bake_data.h"

#include "base/log.h"

/* What a rank tells rank 0. */
typedef enum tale { TALE_READY = 0, TALE_BAKED, TALE_FAILED } tale;

typedef struct message {
    uint64_t tale, first, end;
} message;

/* What it is told: faces to bake, none to end. */
typedef struct order {
    uint64_t first, end;
} order;

static slv_result send(const bake *b, uint32_t to, const void *bytes, uint64_t size) {
    const slv_bake_team *team = b->job->team;
    return team->send(team->user, to, bytes, size)
               ? slvi_fail(&b->env, SLV_ERROR_IO, "bake: rank %u cannot be reached", to)
               : SLV_OK;
}

static slv_result receive(const bake *b, uint32_t *from, void *bytes, uint64_t size) {
    const slv_bake_team *team = b->job->team;
    return team->receive(team->user, from, bytes, size)
               ? slvi_fail(&b->env, SLV_ERROR_IO, "bake: other ranks cannot be reached")
               : SLV_OK;
}

static uint64_t texels_in(const bake *b) {
    return b->block.offsets[b->block.end - b->block.first];
}

/* A block from a rank, into the file. */
static slv_result take_block(bake *b, uint32_t from, const message *m) {
    slv_result result = slvi_bake_begin_block(b, (uint32_t)m->first, (uint32_t)m->end);
    if (result || (result = receive(b, &from, b->block.texels, texels_in(b) * b->texel_size)) ||
        (result = receive(b, &from, b->block.misses, texels_in(b))) ||
        (result = slvi_bake_part_keep(b)) || (result = slvi_bake_write_block(b)))
        return result;
    return slvi_steps_add(&b->steps, &b->env, "bake", texels_in(b));
}

/* `begun` is what came of beginning the file. After a failure the others are still told to end, at
 * the latest when they have baked a block, which is thrown away. */
slv_result slvi_bake_lead(bake *b, slv_result begun) {
    slv_result result = begun, lost = SLV_OK;
    for (uint32_t left = b->job->team->count - 1; left && !lost;) {
        uint32_t from = SLV_BAKE_ANY_RANK, first = 0, end = 0;
        message m;
        if ((lost = receive(b, &from, &m, sizeof m)))
            break;
        if (m.tale == TALE_FAILED) {
            left--;
            if (!result)
                result = slvi_fail(&b->env, SLV_ERROR_IO,
                                   "bake: rank %u could not go on: nothing is written", from);
            continue;
        }
        if (m.tale == TALE_BAKED) {
            slv_result took = take_block(b, from, &m);
            result = result ? result : took;
        }
        if (!result && slvi_bake_next_block(b, &first, &end)) {
            lost = send(b, from, &(order){first, end}, sizeof(order));
        } else {
            left--;
            lost = send(b, from, &(order){0, 0}, sizeof(order));
        }
    }
    return result ? result : lost;
}

slv_result slvi_bake_serve(bake *b) {
    message m = {TALE_READY, 0, 0};
    uint32_t zero = 0;
    order o;
    slv_result result;
    for (;;) {
        if ((result = send(b, 0, &m, sizeof m)))
            return result;
        if (m.tale == TALE_BAKED &&
            ((result = send(b, 0, b->block.texels, texels_in(b) * b->texel_size)) ||
             (result = send(b, 0, b->block.misses, texels_in(b)))))
            return result;
        if ((result = receive(b, &zero, &o, sizeof o)) || o.first >= o.end)
            return result;
        if ((result = slvi_bake_begin_block(b, (uint32_t)o.first, (uint32_t)o.end)) ||
            (result = slvi_bake_evaluate_block(b))) {
            m = (message){TALE_FAILED, 0, 0};
            slv_result told = send(b, 0, &m, sizeof m);
            return told ? told : result;
        }
        m = (message){TALE_BAKED, o.first, o.end};
    }
}

slv_result slvi_bake_share_plan(const slv_env *env, const slv_bake_job *job, slv_res *res,
                                uint32_t nfaces, slv_result planned) {
    const slv_bake_team *team = job->team;
    const bake b = {.job = job, .env = *env};
    uint64_t good = !planned;
    uint32_t zero = 0;
    slv_result result = planned;
    if (!team->rank) {
        for (uint32_t rank = 1; rank < team->count; rank++) {
            slv_result told = send(&b, rank, &good, sizeof good);
            if (!told && good)
                told = send(&b, rank, res, nfaces * sizeof *res);
            result = result ? result : told;
        }
        return result;
    }
    if ((result = receive(&b, &zero, &good, sizeof good)))
        return result;
    if (!good) /* which rank 0 says */
        return SLV_ERROR_CANCELLED;
    return receive(&b, &zero, res, nfaces * sizeof *res);
}
