/* Options as a recipe: each is a field of it. */
#include "bake/bake_options.h"
#include "command/numbers.h"
#include "command/ptx_name.h"

#include <selvage/wrap.h>

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Options of sources that the source there is does not have. */
static int check_source(const cli_command *command, const bake_options *o) {
    const bool images = o->uv || o->vertex_color || o->texture || o->points;
    const bool rays = o->detail || (o->from && o->by), nearest = o->from && !o->by;
    const slv_pattern pattern = (slv_pattern)o->pattern;
    const struct {
        const char *option, *of;
        bool given, taken;
    } all[] = {{"--texture-encoding", "--uv, --texture, --vertex-color or --points",
                o->encoding_given, images},
               {"--wrap", "--uv, but no set of tiles", o->wrap_given,
                o->uv && !strstr(o->uv, SLV_BAKE_UDIM)},
               {"--round", "--uv, as it is of texture coordinates", o->round_given, o->uv != NULL},
               {"--distance", "--rays, --points or --from, but not --by rays", o->distance_given,
                o->from ? nearest : o->rays_given || o->points},
               {"--front", "--detail or --by rays, but not --cage, from which rays begin",
                o->front_given, rays && !o->cage},
               {"--back", "--detail or --by rays", o->back_given, rays},
               {"--samples", "--rays or --detail", o->samples != 0, o->rays_given || o->detail},
               {"--seed", "--rays, --pattern noise or face-color", o->seed_given,
                o->rays_given || (o->pattern_given && (pattern == SLV_PATTERN_NOISE ||
                                                       pattern == SLV_PATTERN_FACE_COLOR))},
               {"--frequency", "--pattern, but not face-color", o->frequency_given,
                o->pattern_given && pattern != SLV_PATTERN_FACE_COLOR},
               {"--detail-kind", "--detail MESH", o->detail_kind_given, o->detail != NULL}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].given && o->recipe)
            return cli_usage(command, "%s: a recipe says it in its source", all[i].option);
        else if (all[i].given && !all[i].taken)
            return cli_usage(command, "%s: goes with %s", all[i].option, all[i].of);
    return -1;
}

static int check(const cli_command *command, const bake_options *o) {
    slv_res res;
    int sources = (o->uv != NULL) + o->vertex_color + (o->points != NULL) + (o->texture != NULL) +
                  o->pattern_given + o->rays_given + o->surface_given + (o->detail != NULL);
    if (o->recipe && sources)
        return cli_usage(command, "--recipe says what is baked: --uv, --texture, --vertex-color, "
                                  "--points, --rays, --detail, --surface and --pattern go without "
                                  "it");
    if (o->recipe && o->from)
        return cli_usage(command, "--from: a recipe says it by \"carry\"");
    if (o->cage && !o->detail && !(o->from && o->by))
        return cli_usage(command, "--cage: --from with --by rays, or --detail, is missing");
    if (o->by_given && !o->from)
        return cli_usage(command, "--by: --from MESH is missing");
    if (!o->recipe && sources != 1)
        return cli_usage(command, "--uv IMAGE, --texture IN.ptx, --vertex-color, --points CLOUD, "
                                  "--rays, --detail MESH, --surface, --pattern or --recipe: one of "
                                  "them says what is baked");
    if (check_source(command, o) >= 0)
        return EXIT_USAGE;
    if ((o->front_given && !(o->front > 0)) || (o->back_given && !(o->back > 0)) ||
        (o->distance_given && !(o->distance > 0)) || (o->frequency_given && !(o->frequency > 0)))
        return cli_usage(command, "--front, --back, --distance and --frequency: expected more than "
                                  "0");
    if (CLI_STANDARD_ONCE(command, o->paths[0], o->uv, o->detail, o->points, o->from, o->recipe))
        return EXIT_USAGE;
    if (o->size_given + o->density_given + o->match_given + o->error_given + (o->bytes != NULL) +
            (o->texels != NULL) + (o->views != NULL) >
        1)
        return cli_usage(command, "--size, --density, --match, --error, --bytes, --texels and "
                                  "--views: one of them");
    if (!(o->texels_per_pixel >= 0) || (o->texels_per_pixel > 0 && !o->views && !o->recipe))
        return cli_usage(command, "--texels-per-pixel: expected more than 0, with --views");
    if (o->size_given && !value_resolution(o->size, &res))
        return cli_usage(command, "--size %ux%u: expected powers of two", o->size[0], o->size[1]);
    if (!value_resolution(o->min, &res) || (o->max_given && !value_resolution(o->max, &res)))
        return cli_usage(command, "--min-size and --max-size: expected powers of two");
    for (int k = 0; k < 2; k++)
        if ((o->max_given && o->min[k] > o->max[k]) || (o->size_given && o->min[k] > o->size[k]) ||
            (o->size_given && o->max_given && o->size[k] > o->max[k]))
            return cli_usage(command, "--min-size, --size and --max-size contradict each other");
    if ((o->density_given && !(o->density > 0)) || (o->match_given && !(o->match > 0)) ||
        (o->error_given && !(o->error > 0)))
        return cli_usage(command, "--density, --match and --error: expected more than 0");
    if (o->least_error && !o->texels && !o->bytes && !o->recipe)
        return cli_usage(command, "--least-error: --texels or --bytes is missing");
    if (!(o->max_miss >= 0 && o->max_miss <= 1))
        return cli_usage(command, "--max-miss: expected a share, 0 to 1");
    if (!(o->max_over >= 0 && o->max_over <= 1))
        return cli_usage(command, "--max-over: expected a share, 0 to 1");
    if (o->max_over_given && !o->error_given && !o->recipe)
        return cli_usage(command, "--max-over: --error is missing");
    if (o->miss_map && !ptx_name_is_safe(o->miss_map))
        return ptx_name_usage(command, o->miss_map);
    if (!o->uv && !o->texture && !o->recipe && o->match_given)
        return cli_usage(command, "--match: only images and textures have a resolution to match");
    if (o->no_reductions && o->reductions_given)
        return cli_usage(command, "--reductions and --no-reductions contradict each other");
    if ((o->error_given || o->least_error) && o->reductions_given &&
        o->reductions == SLV_PTX_SEAMS_ALL)
        return cli_usage(command, "--reductions all changes full resolution, which --error and "
                                  "--least-error measure: seamless, or plain");
    return -1;
}

static void number(json_t *object, bool given, const char *key, double value) {
    if (given)
        json_object_set_new(object, key, json_real(value));
}

static void whole(json_t *object, bool given, const char *key, uint64_t value) {
    if (given)
        json_object_set_new(object, key, json_integer((json_int_t)value));
}

static void word(json_t *object, bool given, const char *key, const char *value) {
    if (given)
        json_object_set_new(object, key, json_string(value));
}

static void size(json_t *object, bool given, const char *key, const uint32_t value[2]) {
    if (given)
        json_object_set_new(object, key, json_pack("[i,i]", (int)value[0], (int)value[1]));
}

static json_t *source_of(const bake_options *o) {
    json_t *source = json_object();
    if (o->uv) {
        word(source, true, "uv", cli_input(o->uv));
        word(source, o->encoding_given, "texture-encoding",
             slv_texture_encoding_name((slv_texture_encoding)o->encoding));
        word(source, o->wrap_given, "wrap", slv_bake_wrap_name((slv_bake_wrap)o->wrap));
        word(source, o->round_given, "round", slv_wrap_round_name((slv_wrap_round)o->round));
    } else if (o->vertex_color) {
        json_object_set_new(source, "vertex-color", json_true());
        word(source, o->encoding_given, "texture-encoding",
             slv_texture_encoding_name((slv_texture_encoding)o->encoding));
    } else if (o->texture) {
        word(source, true, "texture", o->texture);
        word(source, o->encoding_given, "texture-encoding",
             slv_texture_encoding_name((slv_texture_encoding)o->encoding));
    } else if (o->points) {
        word(source, true, "points", cli_input(o->points));
        number(source, o->distance_given && !o->from, "distance", (double)o->distance);
        word(source, o->encoding_given, "texture-encoding",
             slv_texture_encoding_name((slv_texture_encoding)o->encoding));
    } else if (o->detail) {
        word(source, true, "detail", cli_input(o->detail));
        word(source, o->detail_kind_given, "kind",
             slv_bake_detail_kind_name((slv_bake_detail_kind)o->detail_kind));
        number(source, o->front_given && !o->from, "front", (double)o->front);
        number(source, o->back_given && !o->from, "back", (double)o->back);
        word(source, o->cage && !o->from, "cage", o->cage);
        whole(source, o->samples != 0, "samples", o->samples);
    } else if (o->rays_given) {
        word(source, true, "rays", slv_bake_rays_kind_name((slv_bake_rays_kind)o->rays));
        number(source, o->distance_given && !o->from, "distance", (double)o->distance);
        whole(source, o->samples != 0, "samples", o->samples);
        whole(source, o->seed_given, "seed", o->seed);
    } else if (o->surface_given) {
        word(source, true, "surface",
             slv_bake_surface_kind_name((slv_bake_surface_kind)o->surface));
    } else {
        word(source, true, "pattern", slv_pattern_name((slv_pattern)o->pattern));
        number(source, o->frequency_given, "frequency", (double)o->frequency);
        whole(source, o->seed_given, "seed", o->seed);
    }
    return source;
}

/* What lies on another mesh, which distances are about then. */
static json_t *carried(const bake_options *o, json_t *of) {
    json_t *source;
    if (!o->from)
        return of;
    source = json_object();
    json_object_set_new(source, "carry", of);
    word(source, true, "mesh", cli_input(o->from));
    word(source, o->by_given, "by", o->by ? "rays" : "closest");
    number(source, o->distance_given, "distance", (double)o->distance);
    number(source, o->front_given, "front", (double)o->front);
    number(source, o->back_given, "back", (double)o->back);
    word(source, o->cage != NULL, "cage", o->cage);
    return source;
}

/* Fields for all options that were given. Returns -1 or an exit code. */
static int changes_of(const cli_command *command, const bake_options *o, json_t *changes) {
    uint64_t texels = 0, bytes = 0;
    if (o->texels && !value_count(o->texels, &texels))
        return cli_usage(command, "--texels: expected a number, 4M, not '%s'", o->texels);
    if (o->bytes && !value_count(o->bytes, &bytes))
        return cli_usage(command, "--bytes: expected a number, 64M, not '%s'", o->bytes);
    if (!o->recipe)
        json_object_set_new(changes, "source", carried(o, source_of(o)));
    size(changes, o->size_given, "size", o->size);
    size(changes, o->min_given, "min-size", o->min);
    size(changes, o->max_given, "max-size", o->max);
    number(changes, o->density_given, "density", (double)o->density);
    number(changes, o->match_given, "match", (double)o->match);
    word(changes, o->views != NULL, "views", cli_input(o->views));
    number(changes, o->texels_per_pixel > 0, "texels-per-pixel", (double)o->texels_per_pixel);
    number(changes, o->error_given, "error", (double)o->error);
    number(changes, o->max_miss_given, "max-miss", (double)o->max_miss);
    number(changes, o->max_over_given, "max-over", (double)o->max_over);
    whole(changes, o->texels != NULL, "texels", texels);
    whole(changes, o->bytes != NULL, "bytes", bytes);
    whole(changes, o->compression != 0, "compression", o->compression);
    word(changes, o->type_given, "type", slv_type_name((slv_type)o->type));
    word(changes, o->scheme_given, "scheme", slv_scheme_name((slv_scheme)o->scheme));
    word(changes, o->reductions_given, "reductions",
         slv_ptx_seams_name((slv_ptx_seams)o->reductions));
    if (o->least_error)
        json_object_set_new(changes, "least-error", json_true());
    if (o->no_reductions)
        json_object_set_new(changes, "reductions", json_false());
    return -1;
}

int bake_recipe_make(const cli_command *command, const slv_env *env, const bake_options *o,
                     slv_bake_recipe **out) {
    json_t *changes = NULL;
    char *text = NULL;
    int code = check(command, o);
    if (code >= 0)
        return code;
    changes = json_object();
    if ((code = changes_of(command, o, changes)) < 0) {
        text = json_dumps(changes, JSON_COMPACT);
        if (!text)
            code = cli_error("a name that is no UTF-8, or no memory for the recipe");
        else if (slv_bake_recipe_load(env, cli_input(o->recipe), text, out))
            code = EXIT_FAILED;
    }
    free(text);
    json_decref(changes);
    return code;
}

static int append(char *text, size_t room, const char *path) {
    struct stat status;
    if (stat(path, &status) != 0)
        return snprintf(text, room, "%s\n", path);
    return snprintf(text, room, "%s %lld %lld.%09ld\n", path, (long long)status.st_size,
                    (long long)status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

char *bake_recipe_key(const slv_bake_recipe *recipe, const bake_options *o) {
    enum { MORE = 100 };
    const char *text = slv_bake_recipe_text(recipe), *path, *mesh = o->paths[0];
    size_t room = strlen(text) + strlen(mesh) + 3 * MORE;
    for (uint32_t i = 0; (path = slv_bake_recipe_file(recipe, i)); i++)
        room += strlen(path) + MORE;
    char *key = malloc(room);
    if (!key)
        return NULL;
    size_t used = (size_t)snprintf(key, room, "%s\n", text);
    used += (size_t)append(key + used, room - used, mesh);
    for (uint32_t i = 0; (path = slv_bake_recipe_file(recipe, i)); i++)
        used += (size_t)append(key + used, room - used, path);
    return key;
}
