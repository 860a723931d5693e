/* Levels of faces come and go: what is read is taken, what has to go is made coarser, within the
 * budgets at every moment. */
#include "gl/live/residency.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/live/making.h"
#include "gl/live/move.h"

#include <string.h>

#define DEFAULT_BYTES (UINT64_C(256) << 20)
#define DEFAULT_UPLOAD (UINT64_C(4) << 20)
#define CORNER_BYTES                                                                               \
    256 /* that tables of values at corners grow by, at most, for a level of a face */
enum { DEFAULT_COARSE = 3, DEFAULT_READERS = 2, PATIENCE = 4, ARRAYS = 256, MOST_CHANGES = 16 };

static uint64_t stored_bytes(const slv_gl_residency *r, uint32_t face, uint32_t level) {
    const slv_texture_desc *desc = r->readers.desc;
    return slvi_texels_in(slv_res_level(r->full[face], level)) * desc->nchannels *
           slv_type_size(desc->type);
}

static void fill_params(const slv_gl_residency_params *given, slv_gl_residency_params *out) {
    if (given)
        *out = *given;
    out->texture.live = true;
    out->texture.binding = SLV_GL_BINDING_UNITS; /* handles would be others after each update, and
                                                    their table grows with arrays that come */
    out->gpu_bytes = out->gpu_bytes ? out->gpu_bytes : DEFAULT_BYTES;
    out->host_bytes = out->host_bytes ? out->host_bytes : DEFAULT_BYTES;
    out->upload_bytes = out->upload_bytes ? out->upload_bytes : DEFAULT_UPLOAD;
    out->coarse_log2 = out->coarse_log2 ? out->coarse_log2 : DEFAULT_COARSE;
    out->coarse_log2 = out->coarse_log2 < SLV_MAX_LOG2_RES ? out->coarse_log2 : SLV_MAX_LOG2_RES;
    out->readers = out->readers ? out->readers : DEFAULT_READERS;
    out->readers = out->readers < SLVI_MOST_READERS ? out->readers : SLVI_MOST_READERS;
}

/* What a face takes on the GPU at each resolution, about; and the finest that the driver has
 * textures for. */
static void measure_class(slv_gl_residency *r, slv_res res) {
    slv_gl_source source = r->texture->live->source;
    slv_env quiet = {0};
    uint64_t *each = &r->gpu_each[res.u][res.v];
    source.env = &quiet;
    for (uint32_t s = 0; s < r->texture->nstores && *each != UINT64_MAX; s++) {
        const slv_gl_store *store = &r->texture->stores[s];
        uint32_t items[SLV_FORM_ITEMS];
        bool squares = store->pools.form->items(store->made, 0, items) > 1;
        int8_t side = (int8_t)((res.u + res.v + 1) / 2);
        slv_res own = squares ? (slv_res){side, side} : res;
        uint64_t bytes = 0;
        bool fails = slvi_gl_class_bytes(&source, &store->pools, own, false, &bytes) != SLV_OK;
        *each = fails ? UINT64_MAX : *each + bytes * (squares ? 2 : 1);
    }
}

static slv_result measure_classes(slv_gl_residency *r) {
    for (int8_t u = 0; u < SLVI_CLASSES; u++)
        for (int8_t v = 0; v < SLVI_CLASSES; v++)
            measure_class(r, (slv_res){u, v});
    for (uint32_t f = 0; f < r->nfaces; f++) {
        slv_res res = r->full[f];
        while (r->gpu_each[res.u][res.v] == UINT64_MAX && r->finest[f] < r->coarse[f])
            res = slv_res_level(r->full[f], ++r->finest[f]);
    }
    return SLV_OK;
}

/* Reductions that the source has are there at once; they are exchanged for exact means where a face
 * is seen. They would not do with alpha: what is stored is multiplied by it. */
static slv_result read_coarse(void *user, uint64_t first, uint64_t end) {
    slv_gl_residency *r = user;
    const slv_texture_desc *desc = slv_texture_get_desc(r->store);
    slv_result result = SLV_OK;
    for (uint32_t face = (uint32_t)first; !result && face < end; face++) {
        void *texels = NULL;
        slv_res res = desc->res[face];
        if ((result = slvi_alloc_plain(&r->env, "texels of a face",
                                       stored_bytes(r, face, r->coarse[face]), 1, &texels)))
            return result;
        r->rough[face] = r->coarse[face] && desc->alpha_channel == SLV_NO_ALPHA;
        if (r->rough[face])
            result = slvi_readers_read_rough(&r->readers, face, res, texels);
        else
            result = slvi_readers_read(&r->readers, face, r->full[face], r->coarse[face], texels);
        if (!result)
            result = slv_texture_set_face(r->store, face, texels);
        slvi_free(texels);
    }
    return result;
}

static slv_result list_faces(slv_gl_residency *r, slv_res *res) {
    const slv_source *source = &r->readers.source;
    slv_result result = SLV_OK;
    for (uint32_t f = 0; !result && f < r->nfaces; f++) {
        slv_source_face face;
        if ((result = source->fns->face(source->user, f, &face)))
            break;
        int longer = face.res.u > face.res.v ? face.res.u : face.res.v;
        int coarse = (int)r->params.coarse_log2;
        r->full[f] = face.res;
        r->coarse[f] = r->level[f] = r->wanted[f] =
            (uint8_t)(longer > coarse ? longer - coarse : 0);
        res[f] = slv_res_level(r->full[f], r->coarse[f]);
    }
    return result;
}

/* Bytes of a texel in memory: level 0 and the others, and what forms keep of their own. */
static uint64_t host_texel_of(const slv_gl_residency *r, const slv_texture_desc *desc) {
    const slv_gl_texture_params *params = &r->params.texture;
    uint64_t type = slv_type_size(desc->type), bytes = (4 * type + 2) / 3;
    const slv_strategy *one[1];
    uint32_t count;
    const slv_strategy *const *list = slvi_gl_strategies(params, one, &count);
    for (uint32_t i = 0; i < count; i++)
        bytes += list[i]->form()->refresh ? 3 * type : 0;
    return bytes * desc->nchannels;
}

/* What the store is to hold: colours as light. */
static slv_result describe(slv_gl_residency *r, slv_source_desc *found, slv_texture_desc *out) {
    slvi_readers *readers = &r->readers;
    slv_texture_encoding encoding = r->params.texture.encoding;
    slv_result result = readers->source.fns->describe(readers->source.user, found);
    if (result)
        return result;
    if (encoding == SLV_TEXTURE_AUTO)
        encoding = found->edge_filter == SLV_EDGE_FILTER_TANVEC ? SLV_TEXTURE_DATA
                                                                : slv_type_encoding(found->type);
    readers->type = found->type;
    readers->encoded = encoding == SLV_TEXTURE_SRGB;
    *out = (slv_texture_desc){.nfaces = found->nfaces,
                              .type = found->type,
                              .nchannels = found->nchannels,
                              .alpha_channel = found->alpha_channel,
                              .encoding = encoding};
    if (readers->encoded) {
        out->type = found->type == SLV_TYPE_U8 ? SLV_TYPE_HALF : SLV_TYPE_FLOAT;
        out->encoding = SLV_TEXTURE_LINEAR;
    }
    r->params.texture.encoding = out->encoding;
    r->params.texture.border_u = found->border_u;
    r->params.texture.border_v = found->border_v;
    r->params.texture.edge_filter = found->edge_filter;
    r->nfaces = found->nfaces;
    r->host_texel = host_texel_of(r, out);
    return SLV_OK;
}

static slv_result create_store(slv_gl_residency *r) {
    slv_source_desc found;
    slv_texture_desc desc;
    slv_res *res = NULL;
    slv_result result = describe(r, &found, &desc);
    if (result)
        return result;
    uint64_t n = found.nfaces;
    if ((result = slvi_alloc(&r->env, "faces", n, sizeof *r->full, &r->full)) ||
        (result = slvi_alloc(&r->env, "faces", n, sizeof *res, &res)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->level)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->coarse)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->finest)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->wanted)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->rough)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->seen)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->near)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->loading)) ||
        (result = slvi_alloc(&r->env, "faces", n, 1, &r->failed)) || (result = list_faces(r, res)))
        goto done;
    for (uint32_t f = 0; f < r->nfaces; f++)
        r->host_coarse += slvi_residency_host_of(r, f, r->coarse[f]);
    if (r->host_coarse > r->params.host_bytes) {
        result = slvi_fail(&r->env, SLV_ERROR_LIMIT,
                           "%s: the coarse levels take %llu bytes of memory, the limit is %llu",
                           found.name, (unsigned long long)r->host_coarse,
                           (unsigned long long)r->params.host_bytes);
        goto done;
    }
    desc.res = res;
    if ((result = slv_texture_create(&r->env, &desc, &r->store)))
        goto done;
    r->readers.desc = slv_texture_get_desc(r->store);
    result = slvi_parallel_for(&r->env, n, 64, read_coarse, r);
done:
    slvi_free(res);
    return result;
}

uint64_t slvi_residency_gpu_bytes(const slv_gl_residency *r) {
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < r->texture->nstores; i++)
        bytes += r->texture->stores[i].bytes + r->texture->stores[i].coverage_bytes;
    for (uint32_t i = 0; i < r->texture->nreaches; i++)
        bytes += r->texture->reaches[i].reach.bytes;
    return bytes;
}

/* The coarse levels keep what they took when faces have others. */
uint64_t slvi_residency_host_bytes(const slv_gl_residency *r) {
    uint64_t bytes = r->host_coarse + r->loading_bytes;
    for (uint32_t f = 0; f < r->nfaces; f++)
        bytes += r->level[f] < r->coarse[f] ? slvi_residency_host_of(r, f, r->level[f]) : 0;
    return bytes;
}

static slv_result too_much(const slv_gl_residency *r, uint64_t bytes) {
    return slvi_fail(&r->env, SLV_ERROR_LIMIT,
                     "the coarse levels take %llu bytes on the GPU, the limit is %llu",
                     (unsigned long long)bytes, (unsigned long long)r->params.gpu_bytes);
}

/* The texture of the coarse levels, whose size is known before any of it goes to the GPU. */
static slv_result create_texture(slv_gl *gl, const slv_adjacency *adjacency, slv_gl_residency *r) {
    slv_gl_upload upload = {0};
    const slv_gl_given given = {r->store, adjacency, true,
                                r->readers.encoded && r->readers.type == SLV_TYPE_U8};
    slv_result result =
        slvi_gl_texture_prepare(gl, &r->env, &given, &r->params.texture, false, &r->texture);
    if (result)
        return result;
    uint64_t bytes = slvi_gl_making_bytes(r->texture);
    if (bytes > r->params.gpu_bytes)
        return too_much(r, bytes);
    while (!result && !upload.ready)
        result = slv_gl_texture_upload(r->texture, &r->env, UINT64_MAX, &upload);
    if (result)
        return result;
    r->texture->live->source.array_bytes = r->params.gpu_bytes / ARRAYS;
    r->gpu_coarse = slvi_residency_gpu_bytes(r); /* with coverage */
    if (r->gpu_coarse > r->params.gpu_bytes)
        return too_much(r, r->gpu_coarse);
    return measure_classes(r);
}

slv_result slv_gl_residency_create(slv_gl *gl, const slv_env *env, slv_source *source,
                                   const slv_adjacency *adjacency, const float *corners,
                                   const slv_gl_residency_params *params, slv_gl_residency **out) {
    slv_gl_residency *r = NULL;
    slv_result result = slvi_alloc(env, "residency", 1, sizeof *r, &r);
    *out = NULL;
    if (result) {
        slv_source_close(source);
        return result;
    }
    r->readers.source = *source;
    *source = (slv_source){0};
    fill_params(params, &r->params);
    if ((result = slvi_parallel_env_begin(env, &r->log, &r->env)))
        goto done;
    r->readers.env = r->env;
    if ((result = create_store(r)) ||
        (result = slvi_alloc_plain(env, "corners", 12 * (uint64_t)r->nfaces, sizeof *r->corners,
                                   &r->corners)))
        goto done;
    memcpy(r->corners, corners, 12 * (size_t)r->nfaces * sizeof *corners);
    if ((result = create_texture(gl, adjacency, r)))
        goto done;
    result = slvi_readers_begin(r->params.readers, &r->readers);
done:
    if (result) {
        slv_gl_residency_destroy(r);
        r = NULL;
    }
    *out = r;
    return result;
}

void slv_gl_residency_destroy(slv_gl_residency *r) {
    if (!r)
        return;
    slvi_readers_end(&r->readers);
    slv_gl_texture_destroy(r->texture);
    slv_texture_destroy(r->store);
    slvi_free(r->corners);
    slvi_free(r->full);
    slvi_free(r->level);
    slvi_free(r->coarse);
    slvi_free(r->finest);
    slvi_free(r->wanted);
    slvi_free(r->rough);
    slvi_free(r->seen);
    slvi_free(r->near);
    slvi_free(r->loading);
    slvi_free(r->failed);
    slvi_parallel_env_end(r->log);
    slvi_free(r);
}

slv_gl_texture *slv_gl_residency_texture(slv_gl_residency *residency) {
    return residency->texture;
}

/* What an update may still take. */
struct allowance {
    uint64_t gpu, host; /* bytes of memory */
    uint64_t upload;    /* bytes of texels that change */
    bool any;           /* something was taken */
    bool waits;         /* something was read that there is no room for */
};

/* Gives a face another level if all that has to move for it has room. */
static slv_result change_level(slv_gl_residency *r, uint32_t face, uint32_t level,
                               const void *texels, struct allowance *left, bool *done) {
    slv_res res = slv_res_level(r->full[face], level);
    uint64_t before = slvi_residency_gpu_bytes(r), tables = 0;
    uint64_t host = level < r->coarse[face] ? slvi_residency_host_of(r, face, level) : 0;
    slv_result result = SLV_OK;
    if (level < r->level[face])
        tables = (uint64_t)CORNER_BYTES * (r->level[face] - level) * r->texture->nreaches;
    bool fits = left->gpu >= tables && left->host >= host;
    *done = false;
    for (uint32_t s = 0; !result && fits && s < r->texture->nstores; s++) {
        uint64_t taken = slvi_residency_gpu_bytes(r) - before + tables;
        fits = taken <= left->gpu;
        if (fits)
            result = slvi_gl_move_reserve(r->texture->live, &r->texture->stores[s], face, res,
                                          left->gpu - taken, &fits);
    }
    left->gpu -= slvi_residency_gpu_bytes(r) - before;
    if (result || !fits)
        return result;
    if ((result = slv_texture_set_resolution(r->store, face, res, texels)))
        return result;
    left->gpu -= tables;
    left->host -= host;
    uint64_t cost = stored_bytes(r, face, level), least = r->params.upload_bytes / MOST_CHANGES;
    cost = cost > least ? cost : least;
    left->upload -= cost < left->upload ? cost : left->upload;
    left->any = *done = true;
    r->level[face] = (uint8_t)level;
    return SLV_OK;
}

/* Makes a face coarser out of what it has: nothing is waited for when memory is needed. */
static slv_result coarsen(slv_gl_residency *r, uint32_t face, uint32_t level,
                          struct allowance *left) {
    void *texels = NULL;
    bool done = false;
    const slv_gl_live *live = r->texture->live;
    uint32_t below = level - r->level[face];
    slv_result result =
        slvi_alloc_plain(&r->env, "texels of a face", stored_bytes(r, face, level), 1, &texels);
    if (!result && live->scaled)
        result = slvi_readers_coarsen(&r->readers, r->store, face, below, texels);
    else if (!result)
        memcpy(texels, slv_levels_texels(live->levels, face, below), stored_bytes(r, face, level));
    if (!result)
        result = change_level(r, face, level, texels, left, &done);
    slvi_free(texels);
    return result;
}

static slv_result let_coarsen(slv_gl_residency *r, struct allowance *left) {
    slv_result result = SLV_OK;
    for (uint32_t f = 0; !result && f < r->nfaces && left->upload; f++) {
        uint32_t target = slvi_residency_target(r, f, r->step), level = r->level[f];
        if (target <= level)
            continue;
        result = coarsen(r, f, target, left);
        if (!result && r->level[f] == level && target < r->coarse[f]) /* that always has room */
            result = coarsen(r, f, r->coarse[f], left);
    }
    return result;
}

static void let_go(slv_gl_residency *r, slvi_load *load) {
    slvi_free(load->texels);
    r->loading_bytes -= load->bytes;
    r->loading[load->face] = false;
    *load = (slvi_load){0};
}

/* Takes what was read, and is still wanted. What needs more memory waits until there is some; if
 * that does not come, less is wanted. */
static slv_result take_loads(slv_gl_residency *r, struct allowance *left) {
    bool waits = false;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < SLVI_LOADS; i++) {
        slvi_load *load = &r->readers.loads[i];
        uint32_t face = load->face;
        if (load->state == SLVI_LOAD_FAILED) {
            r->failed[face] = true;
            r->nfailed++;
            let_go(r, load);
        }
        if (load->state != SLVI_LOAD_READ || !left->upload ||
            (left->any && load->bytes > left->upload))
            continue;
        bool finer = load->level < r->level[face], done = false;
        if (load->level > r->level[face] ||
            (finer && load->level < slvi_residency_target(r, face, r->step))) {
            let_go(r, load);
            continue;
        }
        if ((result = change_level(r, face, load->level, load->texels, left, &done)))
            break;
        waits |= !done;
        if (!done)
            continue;
        r->rough[face] = false;
        let_go(r, load);
    }
    left->waits = waits;
    return result;
}

/* How urgent a level is that is to be read: those that lack most first. */
enum { FAR, NEAR, EXACT, NONE };
static uint32_t urgency(const slv_gl_residency *r, uint32_t face, uint32_t target) {
    uint32_t level = r->level[face];
    if (r->failed[face] || target > level)
        return NONE;
    if (target == level)
        return r->rough[face] && r->seen[face] ? EXACT : NONE;
    return level - target > 1 ? FAR : NEAR;
}

/* Asks for the levels that are to come. */
static void ask(slv_gl_residency *r, uint32_t *waiting, uint32_t *pending) {
    uint32_t next = 0;
    *waiting = *pending = 0;
    for (uint32_t i = 0; i < SLVI_LOADS; i++)
        *pending += r->readers.loads[i].state != SLVI_LOAD_FREE;
    for (uint32_t pass = FAR; pass < NONE; pass++) {
        for (uint32_t f = 0; f < r->nfaces; f++) {
            uint32_t target = slvi_residency_target(r, f, r->step);
            if (urgency(r, f, target) != pass)
                continue;
            ++*waiting;
            while (next < SLVI_LOADS && r->readers.loads[next].state != SLVI_LOAD_FREE)
                next++;
            uint64_t bytes = stored_bytes(r, f, target);
            if (r->loading[f] || next == SLVI_LOADS ||
                (r->loading_bytes && r->loading_bytes + bytes > r->params.host_bytes / 8))
                continue;
            r->readers.loads[next] =
                (slvi_load){SLVI_LOAD_WAITING, f, target, r->full[f], NULL, bytes};
            r->loading[f] = true;
            r->loading_bytes += bytes;
            ++*pending;
        }
    }
    pthread_cond_broadcast(&r->readers.more);
}

/* Less is wanted where what is there cannot be used. */
static void press(slv_gl_residency *r, bool stuck) {
    r->stuck = stuck ? r->stuck + 1 : 0;
    if (r->stuck < PATIENCE || r->step == SLVI_LAST_STEP)
        return;
    r->least = r->extra ? 0 : r->step + 1;
    r->extra = r->stuck = 0;
    r->sated = true;
}

static struct allowance allowance_of(const slv_gl_residency *r) {
    uint64_t gpu = slvi_residency_gpu_bytes(r), host = slvi_residency_host_bytes(r);
    return (struct allowance){.gpu = r->params.gpu_bytes > gpu ? r->params.gpu_bytes - gpu : 0,
                              .host = r->params.host_bytes > host ? r->params.host_bytes - host : 0,
                              .upload = r->params.upload_bytes};
}

slv_result slv_gl_residency_update(slv_gl_residency *r, const slv_env *env,
                                   const slv_camera *camera, uint32_t width, uint32_t height,
                                   slv_gl_residency_state *out) {
    slv_gl_residency_state state = {0};
    uint32_t pending = 0, crowded = 0;
    struct allowance left = allowance_of(r);
    if (!slvi_camera_is_finite(camera))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "a camera that is not finite");
    slv_result result = slvi_gl_need_current(r->texture->gl, env);
    if (result)
        return result;
    slvi_residency_plan(r, camera, width, height);
    slv_gl_transfer before = slvi_gl_transfer_begin(r->texture->gl);
    result = let_coarsen(r, &left);
    pthread_mutex_lock(&r->readers.lock);
    if (!result)
        result = take_loads(r, &left);
    if (!result)
        ask(r, &state.waiting, &pending);
    pthread_mutex_unlock(&r->readers.lock);
    r->texture->live->room = left.gpu;
    if (!result)
        result = slv_gl_texture_update(r->texture, env, NULL);
    for (uint32_t s = 0; s < r->texture->nstores; s++) {
        slvi_gl_move_sweep(&r->texture->live->source, &r->texture->stores[s]);
        crowded += r->texture->stores[s].waiting.count;
    }
    slvi_gl_transfer_end(r->texture->gl, &before);
    press(r, !left.any && (left.waits || crowded));
    state.gpu_bytes = slvi_residency_gpu_bytes(r);
    state.host_bytes = slvi_residency_host_bytes(r);
    state.failed = r->nfailed;
    state.bias = r->step > 2 ? r->step - 2 : 0;
    /* where not even that helps nothing will */
    bool helpless = r->step == SLVI_LAST_STEP && r->stuck >= PATIENCE;
    state.settled = !result && (helpless || (!state.waiting && !pending && !left.any && !crowded &&
                                             !slvi_residency_want_more(r)));
    if (out)
        *out = state;
    return result;
}
