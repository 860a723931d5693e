/* The sources of a recipe: what each kind may say, and opening them. */
#include "recipe/mix.h"
#include "recipe/recipe_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/wrap.h>

#include <math.h>
#include <string.h>

/* Sources are read the same way to be checked, with no mesh, and to be opened. */
typedef struct opening {
    recipe_reader r;
    slv_bake_recipe *recipe;
    const slv_mesh *mesh; /* NULL: only check */
    slv_surface *surface; /* of the mesh, once a source needs it */
    slv_scheme scheme;
} opening;

static slv_result open_node(opening *o, const json_t *node, const char *where, int depth,
                            slv_bake_source **out);
static slv_result open_child(opening *o, const json_t *node, const char *where, const char *key,
                             int depth, slv_bake_source **out);

/* Surfaces stay with the recipe, which outlives its sources. */
static slv_result need_surface(opening *o) {
    slv_bake_recipe *recipe = o->recipe;
    const slv_surface_params how = {.scheme = o->scheme};
    slv_result result = SLV_OK;
    if (o->surface)
        return SLV_OK;
    if (!recipe->surfaces)
        result = slvi_alloc(o->r.env, o->r.name, RECIPE_SURFACES, sizeof *recipe->surfaces,
                            &recipe->surfaces);
    if (!result && recipe->nsurfaces == RECIPE_SURFACES)
        result = slvi_fail(o->r.env, SLV_ERROR_LIMIT, "%s: more than %d meshes", o->r.name,
                           RECIPE_SURFACES);
    if (!result && !(result = slv_surface_create(o->r.env, o->mesh, &how, &o->surface)))
        recipe->surfaces[recipe->nsurfaces++] = o->surface;
    return result;
}

#define ONLY(...)                                                                                  \
    slvi_recipe_only(&o->r, where, node, (const char *const[]){__VA_ARGS__},                       \
                     sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *))

#define DEFINE_NAME(name, type, name_of)                                                           \
    static const char *name(int value) {                                                           \
        return name_of((type)value);                                                               \
    }
DEFINE_NAME(encoding_name, slv_texture_encoding, slv_texture_encoding_name)
DEFINE_NAME(wrap_name, slv_bake_wrap, slv_bake_wrap_name)
DEFINE_NAME(round_name, slv_wrap_round, slv_wrap_round_name)
DEFINE_NAME(rays_name, slv_bake_rays_kind, slv_bake_rays_kind_name)
DEFINE_NAME(detail_name, slv_bake_detail_kind, slv_bake_detail_kind_name)
DEFINE_NAME(surface_name, slv_bake_surface_kind, slv_bake_surface_kind_name)
DEFINE_NAME(pattern_name, slv_pattern, slv_pattern_name)
DEFINE_NAME(blend_name, slv_blend, slv_blend_name)
DEFINE_NAME(scheme_name, slv_scheme, slv_scheme_name)

static const char *by_name(int value) {
    return value == 0 ? "closest" : value == 1 ? "rays" : "unknown";
}

static slv_result number(const opening *o, const json_t *node, const char *where, const char *key,
                         double low, double high, float *out) {
    double value = (double)*out;
    slv_result result = slvi_recipe_number(&o->r, where, node, key, low, high, &value);
    *out = (float)value;
    return result;
}

static slv_result whole(const opening *o, const json_t *node, const char *where, const char *key,
                        double low, double high, uint32_t *out) {
    double value = *out;
    slv_result result = slvi_recipe_number(&o->r, where, node, key, low, high, &value);
    if (!result && value != floor(value))
        result = slvi_recipe_fail(&o->r, where, "%s: expected a whole number", key);
    *out = (uint32_t)value;
    return result;
}

static slv_result file_name(const opening *o, const json_t *node, const char *where,
                            const char *key, const char **out) {
    *out = json_string_value(json_object_get(node, key));
    return *out && **out ? SLV_OK
                         : slvi_recipe_fail(&o->r, where, "%s: expected the name of a file", key);
}

static slv_result open_uv(opening *o, const json_t *node, const char *where, int depth,
                          slv_bake_source **out) {
    const char *path;
    int encoding = 0, wrap = 0, round = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("uv", "texture-encoding", "wrap", "round")) ||
        (result = file_name(o, node, where, "uv", &path)) ||
        (result =
             slvi_recipe_word(&o->r, where, node, "texture-encoding", encoding_name, &encoding)) ||
        (result = slvi_recipe_word(&o->r, where, node, "wrap", wrap_name, &wrap)) ||
        (result = slvi_recipe_word(&o->r, where, node, "round", round_name, &round)) || !o->mesh)
        return result;
    const slv_bake_uv params = {.encoding = (slv_texture_encoding)encoding,
                                .wrap = (slv_bake_wrap)wrap,
                                .round_u = round & 1,
                                .round_v = round >> 1};
    return slv_bake_from_uv(o->r.env, o->mesh, path, &params, out);
}

static slv_result open_vertex(opening *o, const json_t *node, const char *where, int depth,
                              slv_bake_source **out) {
    int encoding = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("vertex-color", "texture-encoding")) ||
        (result =
             slvi_recipe_word(&o->r, where, node, "texture-encoding", encoding_name, &encoding)))
        return result;
    if (!json_is_true(json_object_get(node, "vertex-color")))
        return slvi_recipe_fail(&o->r, where, "vertex-color: expected true");
    if (!o->mesh)
        return SLV_OK;
    return slv_bake_from_vertex_colors(o->r.env, o->mesh, (slv_texture_encoding)encoding, out);
}

/* A field that another leaves nothing to do for. */
static slv_result without(const opening *o, const json_t *node, const char *where, const char *key,
                          const char *why) {
    return json_object_get(node, key)
               ? slvi_recipe_fail(&o->r, where, "%s: does nothing %s", key, why)
               : SLV_OK;
}

static slv_result open_cage(const opening *o, const json_t *node, const char *where,
                            slv_mesh **out) {
    const char *path;
    *out = NULL;
    if (!json_object_get(node, "cage"))
        return SLV_OK;
    slv_result result = file_name(o, node, where, "cage", &path);
    result =
        result ? result : without(o, node, where, "front", "with a cage, from which rays begin");
    return result || !o->mesh ? result : slv_mesh_load(o->r.env, path, out);
}

/* Of a scan with polygons: what its surface has in the nearest place, as it stands. */
static slv_result from_colored(const opening *o, const slv_mesh *scan,
                               const slv_bake_points *params, slv_bake_source **out) {
    const slv_bake_carry how = {.distance = params->distance, .scheme = SLV_SCHEME_BILINEAR};
    slv_bake_source *colors = NULL;
    slv_result result = slv_bake_from_vertex_colors(o->r.env, scan, params->encoding, &colors);
    return result ? result
                  : slv_bake_from_mesh(o->r.env, o->mesh, o->surface, scan, colors, &how, out);
}

static slv_result open_points(opening *o, const json_t *node, const char *where, int depth,
                              slv_bake_source **out) {
    slv_bake_points params = {0};
    const char *path;
    int encoding = 0;
    slv_mesh *points = NULL;
    slv_result result;
    (void)depth;
    if ((result = ONLY("points", "distance", "count", "texture-encoding")) ||
        (result = file_name(o, node, where, "points", &path)) ||
        (result = number(o, node, where, "distance", 1e-30, 1e30, &params.distance)) ||
        (result = whole(o, node, where, "count", 1, 64, &params.count)) ||
        (result =
             slvi_recipe_word(&o->r, where, node, "texture-encoding", encoding_name, &encoding)) ||
        !o->mesh || (result = need_surface(o)) ||
        (result = slv_mesh_load_points(o->r.env, path, &points)))
        return result;
    params.encoding = (slv_texture_encoding)encoding;
    if (!slv_mesh_get_view(points)->colors)
        result = slvi_fail(o->r.env, SLV_ERROR_MISMATCH, "%s: its points have no colours", path);
    if (!result && slv_mesh_face_count(points))
        result = without(o, node, where, "count", "of a scan with polygons");
    if (!result && slv_mesh_face_count(points))
        result = from_colored(o, points, &params, out);
    else if (!result)
        result = slv_bake_from_points(o->r.env, o->mesh, o->surface, points, &params, out);
    slv_mesh_destroy(points);
    return result;
}

static slv_result open_texture(opening *o, const json_t *node, const char *where, int depth,
                               slv_bake_source **out) {
    const char *path;
    int encoding = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("texture", "texture-encoding")) ||
        (result = file_name(o, node, where, "texture", &path)) ||
        (result =
             slvi_recipe_word(&o->r, where, node, "texture-encoding", encoding_name, &encoding)) ||
        !o->mesh)
        return result;
    return slv_bake_from_texture(o->r.env, o->mesh, path, (slv_texture_encoding)encoding, out);
}

/* A mesh, or the one inside of a texture. */
static slv_result load_mesh(const opening *o, const char *path, slv_mesh **out) {
    slv_ptx *ptx = NULL;
    if (!slv_ptx_is_name(path))
        return slv_mesh_load(o->r.env, path, out);
    slv_result result = slv_ptx_open(o->r.env, path, &ptx);
    result = result ? result : slv_ptx_load_mesh(o->r.env, ptx, out);
    slv_ptx_close(ptx);
    return result;
}

static slv_result open_carry(opening *o, const json_t *node, const char *where, int depth,
                             slv_bake_source **out) {
    slv_bake_carry params = {0};
    const char *path;
    int by = 0, scheme = (int)o->scheme;
    slv_bake_source *of = NULL;
    slv_mesh *other = NULL, *cage = NULL;
    slv_result result;
    if ((result = ONLY("carry", "mesh", "by", "distance", "front", "back", "scheme", "cage")) ||
        (result = file_name(o, node, where, "mesh", &path)) ||
        (result = slvi_recipe_word(&o->r, where, node, "by", by_name, &by)) ||
        (result = slvi_recipe_word(&o->r, where, node, "scheme", scheme_name, &scheme)) ||
        (result = number(o, node, where, "distance", 1e-30, 1e30, &params.distance)) ||
        (result = number(o, node, where, "front", 1e-30, 1e30, &params.front)) ||
        (result = number(o, node, where, "back", 1e-30, 1e30, &params.back)) ||
        (by && (result = without(o, node, where, "distance", "by rays"))) ||
        (!by && ((result = without(o, node, where, "front", "but by rays")) ||
                 (result = without(o, node, where, "back", "but by rays")) ||
                 (result = without(o, node, where, "cage", "but by rays")))))
        return result;
    if ((result = open_cage(o, node, where, &cage)) ||
        (o->mesh && ((result = need_surface(o)) || (result = load_mesh(o, path, &other))))) {
        slv_mesh_destroy(cage);
        return result;
    }
    opening there = {o->r, o->recipe, other, NULL, (slv_scheme)scheme};
    result = open_child(&there, node, where, "carry", depth, &of);
    params.rays = by == 1;
    params.scheme = (slv_scheme)scheme;
    params.cage = cage;
    params.cage_scheme = o->scheme;
    if (!result && o->mesh)
        result = slv_bake_from_mesh(o->r.env, o->mesh, o->surface, other, of, &params, out);
    slv_mesh_destroy(other);
    slv_mesh_destroy(cage);
    return result;
}

static slv_result open_rays(opening *o, const json_t *node, const char *where, int depth,
                            slv_bake_source **out) {
    slv_bake_rays rays = {0};
    int kind = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("rays", "samples", "distance", "seed")) ||
        (result = slvi_recipe_word(&o->r, where, node, "rays", rays_name, &kind)) ||
        (result = whole(o, node, where, "samples", 1, 65536, &rays.samples)) ||
        (result = whole(o, node, where, "seed", 0, UINT32_MAX, &rays.seed)) ||
        (result = number(o, node, where, "distance", 0, 1e30, &rays.distance)) || !o->mesh ||
        (result = need_surface(o)))
        return result;
    rays.kind = (slv_bake_rays_kind)kind;
    return slv_bake_from_rays(o->r.env, o->mesh, o->surface, &rays, out);
}

static slv_result open_detail(opening *o, const json_t *node, const char *where, int depth,
                              slv_bake_source **out) {
    slv_bake_detail detail = {0};
    const char *path;
    int kind = 0;
    slv_mesh *detailed = NULL, *cage = NULL;
    slv_result result;
    (void)depth;
    if ((result = ONLY("detail", "kind", "front", "back", "samples", "cage")) ||
        (result = file_name(o, node, where, "detail", &path)) ||
        (result = slvi_recipe_word(&o->r, where, node, "kind", detail_name, &kind)) ||
        (result = whole(o, node, where, "samples", 1, 16, &detail.samples)) ||
        (result = number(o, node, where, "front", 1e-30, 1e30, &detail.front)) ||
        (result = number(o, node, where, "back", 1e-30, 1e30, &detail.back)) ||
        (result = open_cage(o, node, where, &cage)) || !o->mesh || (result = need_surface(o)) ||
        (result = slv_mesh_load(o->r.env, path, &detailed))) {
        slv_mesh_destroy(cage);
        return result;
    }
    detail.kind = (slv_bake_detail_kind)kind;
    detail.cage = cage;
    detail.cage_scheme = o->scheme;
    result = slv_bake_from_detail(o->r.env, o->mesh, o->surface, detailed, &detail, out);
    slv_mesh_destroy(detailed);
    slv_mesh_destroy(cage);
    return result;
}

static slv_result open_surface(opening *o, const json_t *node, const char *where, int depth,
                               slv_bake_source **out) {
    int kind = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("surface")) ||
        (result = slvi_recipe_word(&o->r, where, node, "surface", surface_name, &kind)) ||
        !o->mesh || (result = need_surface(o)))
        return result;
    return slv_bake_from_surface(o->r.env, o->surface, (slv_bake_surface_kind)kind, out);
}

static slv_result open_pattern(opening *o, const json_t *node, const char *where, int depth,
                               slv_bake_source **out) {
    slv_procedural p = {0};
    int kind = 0;
    uint32_t n = 0;
    slv_result result;
    (void)depth;
    p.color0[3] = p.color1[3] = 1;
    if ((result = ONLY("pattern", "frequency", "direction", "offset", "warp", "octaves", "seed",
                       "color0", "color1", "face-tint")) ||
        (result = slvi_recipe_word(&o->r, where, node, "pattern", pattern_name, &kind)) ||
        (result = number(o, node, where, "frequency", 1e-30, 1e30, &p.frequency)) ||
        (result = number(o, node, where, "warp", 0, 1e6, &p.warp)) ||
        (result = number(o, node, where, "face-tint", 0, 1, &p.face_tint)) ||
        (result = whole(o, node, where, "octaves", 1, 16, &p.octaves)) ||
        (result = whole(o, node, where, "seed", 0, UINT32_MAX, &p.seed)) ||
        (result = slvi_recipe_floats(&o->r, where, node, "direction", 3, 3, p.direction, NULL)) ||
        (result = slvi_recipe_floats(&o->r, where, node, "offset", 3, 3, p.offset, NULL)) ||
        (result = slvi_recipe_floats(&o->r, where, node, "color0", 3, 4, p.color0, &n)) ||
        (result = slvi_recipe_floats(&o->r, where, node, "color1", 3, 4, p.color1, &n)))
        return result;
    p.pattern = (slv_pattern)kind;
    if (!json_object_get(node, "color0"))
        memset(p.color0, 0, sizeof p.color0);
    if (!json_object_get(node, "color1"))
        memset(p.color1, 0, sizeof p.color1);
    if (!o->mesh || (result = need_surface(o)))
        return result;
    return slv_bake_from_pattern(o->r.env, o->surface, &p, out);
}

static slv_result open_constant(opening *o, const json_t *node, const char *where, int depth,
                                slv_bake_source **out) {
    float values[SLVI_BAKE_MAX_CHANNELS];
    uint32_t n = 0;
    slv_result result;
    (void)depth;
    if ((result = ONLY("constant")) ||
        (result = slvi_recipe_floats(&o->r, where, node, "constant", 1, SLVI_BAKE_MAX_CHANNELS,
                                     values, &n)) ||
        !o->mesh)
        return result;
    return slvi_mix_constant(o->r.env, slv_mesh_face_count(o->mesh), values, n, out);
}

/* A source in a field of another. */
static slv_result open_child(opening *o, const json_t *node, const char *where, const char *key,
                             int depth, slv_bake_source **out) {
    const json_t *child = json_object_get(node, key);
    char path[200];
    if (!child)
        return slvi_recipe_fail(&o->r, where, "%s: is missing", key);
    if (depth >= RECIPE_DEPTH)
        return slvi_recipe_fail(&o->r, where, "is nested deeper than %d", RECIPE_DEPTH);
    snprintf(path, sizeof path, "%.150s.%s", where, key);
    return open_node(o, child, path, depth + 1, out);
}

static slv_result open_blend(opening *o, const json_t *node, const char *where, int depth,
                             slv_bake_source **out) {
    slv_bake_source *bottom = NULL, *top = NULL, *mask = NULL;
    float opacity = 1;
    int blend = 0;
    slv_result result;
    if ((result = ONLY("blend", "bottom", "top", "mask", "opacity")) ||
        (result = slvi_recipe_word(&o->r, where, node, "blend", blend_name, &blend)) ||
        (result = number(o, node, where, "opacity", 0, 1, &opacity)) ||
        (result = open_child(o, node, where, "bottom", depth, &bottom)) ||
        (result = open_child(o, node, where, "top", depth, &top)) ||
        (json_object_get(node, "mask") &&
         (result = open_child(o, node, where, "mask", depth, &mask))) ||
        !o->mesh) {
        slv_bake_source_destroy(bottom);
        slv_bake_source_destroy(top);
        slv_bake_source_destroy(mask);
        return result;
    }
    return slvi_mix_blend(o->r.env, (slv_blend)blend, opacity, bottom, top, mask, out);
}

static slv_result open_levels(opening *o, const json_t *node, const char *where, int depth,
                              slv_bake_source **out) {
    slvi_levels_of levels = {.in = {0, 1}, .out = {0, 1}, .gamma = 1};
    const json_t *clamp = json_object_get(node, "clamp");
    slv_bake_source *of = NULL;
    slv_result result;
    if ((result = ONLY("levels", "in", "out", "gamma", "clamp")) ||
        (result = slvi_recipe_floats(&o->r, where, node, "in", 2, 2, levels.in, NULL)) ||
        (result = slvi_recipe_floats(&o->r, where, node, "out", 2, 2, levels.out, NULL)) ||
        (result = number(o, node, where, "gamma", 1e-3, 1e3, &levels.gamma)))
        return result;
    if (clamp && !json_is_boolean(clamp))
        return slvi_recipe_fail(&o->r, where, "clamp: expected true or false");
    if (levels.in[0] == levels.in[1])
        return slvi_recipe_fail(&o->r, where, "in: expected two different numbers");
    levels.unclamped = json_is_false(clamp);
    if ((result = open_child(o, node, where, "levels", depth, &of)) || !o->mesh)
        return result;
    return slvi_mix_levels(o->r.env, &levels, of, out);
}

static slv_result open_channels(opening *o, const json_t *node, const char *where, int depth,
                                slv_bake_source **out) {
    float list[SLVI_BAKE_MAX_CHANNELS];
    uint32_t channels[SLVI_BAKE_MAX_CHANNELS], n = 0;
    slv_bake_source *of = NULL;
    slv_result result;
    if ((result = ONLY("channels", "of")) ||
        (result = slvi_recipe_floats(&o->r, where, node, "channels", 1, SLVI_BAKE_MAX_CHANNELS,
                                     list, &n)))
        return result;
    for (uint32_t c = 0; c < n; c++) {
        if (!(list[c] >= 0 && list[c] < SLVI_BAKE_MAX_CHANNELS) || list[c] != floorf(list[c]))
            return slvi_recipe_fail(&o->r, where, "channels: expected numbers 0 to 3");
        channels[c] = (uint32_t)list[c];
    }
    if ((result = open_child(o, node, where, "of", depth, &of)) || !o->mesh)
        return result;
    return slvi_mix_channels(o->r.env, channels, n, of, out);
}

/* The field that says which kind of source an object is. Recursive, by open_child. */
static slv_result open_node(opening *o, const json_t *node, const char *where, int depth,
                            slv_bake_source **out) {
    static const struct {
        const char *key;
        slv_result (*open)(opening *, const json_t *, const char *, int, slv_bake_source **);
    } kinds[] = {{"uv", open_uv},
                 {"vertex-color", open_vertex},
                 {"points", open_points},
                 {"texture", open_texture},
                 {"carry", open_carry},
                 {"rays", open_rays},
                 {"detail", open_detail},
                 {"surface", open_surface},
                 {"pattern", open_pattern},
                 {"constant", open_constant},
                 {"blend", open_blend},
                 {"levels", open_levels},
                 {"channels", open_channels}};
    *out = NULL;
    if (!json_is_object(node))
        return slvi_recipe_fail(&o->r, where, "expected an object");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (json_object_get(node, kinds[i].key))
            return kinds[i].open(o, node, where, depth, out);
    return slvi_recipe_fail(&o->r, where,
                            "has none of uv, vertex-color, points, texture, carry, rays, detail, "
                            "surface, pattern, constant, blend, levels and channels, one of which "
                            "says what it is");
}

slv_result slvi_recipe_check_sources(const recipe_reader *r, slv_bake_recipe *recipe) {
    opening o = {.r = *r, .recipe = recipe};
    slv_bake_source *none = NULL;
    const json_t *source = json_object_get(recipe->root, "source");
    if (!source)
        return slvi_recipe_fail(r, "recipe", "source: is missing, which says what is baked");
    return open_node(&o, source, "source", 0, &none);
}

slv_result slv_bake_recipe_source(const slv_env *given, slv_bake_recipe *recipe,
                                  const slv_mesh *mesh, slv_bake_source **out) {
    slv_env env = slvi_env_or_default(given);
    opening o = {{&env, "recipe"}, recipe, mesh, NULL, recipe->job.scheme};
    *out = NULL;
    if (!mesh)
        return slvi_fail(&env, SLV_ERROR_ARGUMENT, "recipe: no mesh");
    return open_node(&o, json_object_get(recipe->root, "source"), "source", 0, out);
}
