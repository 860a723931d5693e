/* A .ptx as images, one a face or one of all faces, with an index. */
#include "exchange/exchange_data.h"
#include "exchange/index.h"

#include <selvage/file.h>
#include <selvage/folder.h>
#include <selvage/image.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct export {
    const slv_ptx *ptx;
    const slvi_exchange_plan *plan;
    const char *folder;    /* one image a face; NULL: a sheet */
    const char *extension; /* of images, with its dot, as the caller spells it */
    bool exr, meta;
    slv_image *sheets; /* one a group */
    const uint32_t(*places)[2];
};

static bool is_lossy(slv_type type, bool exr) {
    return !exr && (type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT);
}

static slv_result save_face(const struct export *e, const slv_env *env, uint32_t face, slv_res res,
                            const float *values) {
    uint32_t nchannels = e->plan->target.nchannels;
    slv_image_params params = slvi_index_image_params(e->plan, e->exr);
    slv_result result = SLV_OK;
    for (uint32_t group = 0; group < slvi_index_groups(nchannels) && !result; group++) {
        char stem[32], name[64], path[1400];
        slv_image image = {0};
        snprintf(stem, sizeof stem, "face_%06u", face);
        slvi_index_image_name(name, sizeof name, stem, group, e->extension);
        snprintf(path, sizeof path, "%s/%s", e->folder, name);
        result = slv_image_create(env, 1u << res.u, 1u << res.v,
                                  slvi_index_group_size(nchannels, group), &image);
        if (!result) {
            slvi_index_to_image(values, res, nchannels, group, &image, 0, 0);
            result = slv_image_save(env, path, &image, &params);
        }
        slv_image_free(&image);
    }
    return result;
}

static slv_result export_face(void *user, const slv_env *env, uint32_t face,
                              const slv_ptx_face *info, void *texels) {
    const struct export *e = user;
    const slv_ptx_writer_params *target = &e->plan->target;
    slv_ptx_face changed = *info;
    const void *converted = texels;
    void *own;
    float *values = NULL;
    slv_result result = slvi_exchange_face(env, e->plan, face, &changed, &converted, &own);
    uint32_t place = (uint32_t)slvi_exchange_plan_place(e->plan, (int32_t)face);
    slv_res res = changed.flags & SLV_FACE_CONSTANT ? (slv_res){0, 0} : changed.res;
    size_t count = ((size_t)1 << (res.u + res.v)) * target->nchannels;
    if (!result)
        result = slvi_alloc_plain(env, e->plan->path, count, sizeof *values, &values);
    if (!result) {
        slv_type_to_float(target->type, converted, count, values);
        slvi_exchange_change(e->plan->encoding, slvi_index_pictures(e->plan, e->exr),
                             target->nchannels, target->alpha_channel, values,
                             count / target->nchannels);
        if (e->folder)
            result = save_face(e, env, place, res, values);
        else
            for (uint32_t group = 0; group < slvi_index_groups(target->nchannels); group++)
                slvi_index_to_image(values, res, target->nchannels, group, &e->sheets[group],
                                    e->places[place][0], e->places[place][1]);
    }
    slvi_free(values);
    slvi_free(own);
    return result;
}

/* Where a face's texels are, into its entry. */
static int describe_place(const struct export *e, uint32_t face, json_t *item) {
    uint32_t ngroups = slvi_index_groups(e->plan->target.nchannels);
    json_t *names;
    int failed = 0;
    if (e->places)
        return json_object_set_new(item, "x", json_integer(e->places[face][0])) |
               json_object_set_new(item, "y", json_integer(e->places[face][1]));
    names = json_array();
    for (uint32_t group = 0; group < ngroups; group++) {
        char one[32], name[64];
        snprintf(one, sizeof one, "face_%06u", face);
        slvi_index_image_name(name, sizeof name, one, group, e->extension);
        failed |= json_array_append_new(names, json_string(name));
    }
    return failed | json_object_set_new(item, "images", names);
}

/* The index, with every face's entry; `stem` names the images of a sheet. */
static slv_result describe(const slv_env *env, const struct export *e, const char *stem,
                           json_t **out) {
    const slvi_exchange_plan *plan = e->plan;
    unsigned nedges = plan->target.mesh_type == SLV_PTX_QUAD ? 4 : 3;
    json_t *root, *images = json_array();
    slv_result result = slvi_index_create(env, e->ptx, plan, e->meta, &root);
    int failed = 0;
    for (uint32_t group = 0; e->places && group < slvi_index_groups(plan->target.nchannels);
         group++) {
        char name[512];
        slvi_index_image_name(name, sizeof name, stem, group, e->extension);
        failed |= json_array_append_new(images, slvi_index_text(env, name));
    }
    failed |= json_object_set_new(root, "images", images);
    if (plan->encoding == SLV_TEXTURE_LINEAR || plan->encoding == SLV_TEXTURE_SRGB)
        failed |= json_object_set_new(
            root, "images_encoding",
            json_string(slv_texture_encoding_name(slvi_index_pictures(plan, e->exr))));
    for (uint32_t face = 0; face < plan->target.nfaces && !failed && !result; face++) {
        slv_ptx_face info;
        uint32_t from = slvi_exchange_plan_source(plan, face);
        if ((result = slv_ptx_get_face(e->ptx, from, &info)) ||
            (result = slvi_exchange_plan_move(plan, e->ptx, &info)))
            break;
        info.res = slvi_exchange_plan_res(plan, from, info.res);
        json_t *item = slvi_index_face(&info, nedges);
        failed = describe_place(e, face, item);
        failed |= json_array_append_new(json_object_get(root, "faces"), item);
    }
    if (!result && failed)
        result = slvi_index_no_memory(env, plan);
    if (result)
        json_decref(root);
    else
        *out = root;
    return result;
}

static void warn_of_loss(const slv_env *env, const struct export *e) {
    if (is_lossy(e->plan->target.type, e->exr))
        slvi_logf(env, SLV_LOG_WARNING, "PNG holds 0..1 in 16 bits, the texels are %s",
                  slv_type_name(e->plan->target.type));
}

static slv_result visit(const slv_env *env, struct export *e) {
    return slvi_exchange_visit(env, e->plan, e->ptx, export_face, e);
}

static slv_result to_folder(const slv_env *env, const slv_exchange_params *params, struct export *e,
                            const char *path) {
    slv_type type = e->plan->target.type;
    bool real = type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT;
    char index[1300];
    slv_folder *made;
    json_t *root;
    e->exr = params->images == SLV_EXCHANGE_BY_TYPE ? real : params->images == SLV_EXCHANGE_EXR;
    e->extension = e->exr ? ".exr" : ".png";
    slv_result result = slv_folder_begin(env, path, &made);
    if (result)
        return result;
    warn_of_loss(env, e);
    e->folder = slv_folder_path(made);
    snprintf(index, sizeof index, "%s/index.json", e->folder);
    if (!(result = visit(env, e)) && !(result = describe(env, e, NULL, &root)))
        result = slvi_index_write(env, index, root);
    return slv_folder_end(made, "index.json", result);
}

struct box {
    uint32_t face, width, height;
};

static int tallest_first(const void *left, const void *right) {
    const struct box *a = left, *b = right;
    if (a->height != b->height)
        return a->height > b->height ? -1 : 1;
    if (a->width != b->width)
        return a->width > b->width ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

/* Rows of faces, the tallest first: powers of two fill them without gaps but at the end. */
static slv_result place_faces(const slv_env *env, const struct export *e, const char *path,
                              uint32_t (*places)[2], uint32_t size[2]) {
    uint32_t nfaces = e->plan->target.nfaces;
    struct box *boxes;
    uint64_t area = 0, x = 0, y = 0, width = 1, height = 0;
    slv_result result = slvi_alloc(env, path, nfaces, sizeof *boxes, &boxes);
    if (result)
        return result;
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face info;
        uint32_t from = slvi_exchange_plan_source(e->plan, face);
        if ((result = slv_ptx_get_face(e->ptx, from, &info)))
            goto done;
        slv_res res = info.flags & SLV_FACE_CONSTANT
                          ? (slv_res){0, 0}
                          : slvi_exchange_plan_res(e->plan, from, info.res);
        boxes[face] = (struct box){face, 1u << res.u, 1u << res.v};
        area += (uint64_t)1 << (res.u + res.v);
        while (width < boxes[face].width)
            width *= 2;
    }
    while (width * width < area)
        width *= 2;
    qsort(boxes, nfaces, sizeof *boxes, tallest_first);
    for (uint32_t i = 0; i < nfaces; i++) {
        if (i == 0 || x + boxes[i].width > width) {
            y += height;
            x = 0;
            height = boxes[i].height;
        }
        places[boxes[i].face][0] = (uint32_t)x;
        places[boxes[i].face][1] = (uint32_t)y;
        x += boxes[i].width;
    }
    size[0] = (uint32_t)width;
    size[1] = nfaces ? (uint32_t)(y + height) : 1;
    if (width > 1 << SLV_MAX_LOG2_RES || y + height > 1 << SLV_MAX_LOG2_RES)
        result = slvi_fail(env, SLV_ERROR_LIMIT,
                           "%s: a sheet of %llu x %llu is too large: name a folder instead", path,
                           (unsigned long long)width, (unsigned long long)(y + height));
    uint64_t bytes = width * (y + height) * e->plan->target.nchannels * sizeof(float),
             available = slv_memory_available();
    if (!result && bytes >= available)
        result = slvi_fail(env, SLV_ERROR_LIMIT,
                           "%s: a sheet of %llu x %llu needs %.1f GiB of memory, where %.1f GiB "
                           "are to be had: name a folder instead",
                           path, (unsigned long long)width, (unsigned long long)(y + height),
                           (double)bytes / (1 << 30), (double)available / (1 << 30));
done:
    slvi_free(boxes);
    return result;
}

/* The pictures and the index go into the folder `made`. */
static slv_result save_sheets(const slv_env *env, const struct export *e, slv_progress progress,
                              const char *stem, const char *made) {
    const slv_ptx_writer_params *target = &e->plan->target;
    slv_image_params params = slvi_index_image_params(e->plan, e->exr);
    const char *slash = strrchr(stem, '/'), *base = slash ? slash + 1 : stem;
    char name[1100], path[2400];
    slv_result result = SLV_OK;
    json_t *root;
    params.progress = progress;
    for (uint32_t group = 0; group < slvi_index_groups(target->nchannels) && !result; group++) {
        slvi_index_image_name(name, sizeof name, base, group, e->extension);
        snprintf(path, sizeof path, "%s/%s", made, name);
        result = slv_image_save(env, path, &e->sheets[group], &params);
    }
    snprintf(path, sizeof path, "%s/%s.json", made, base);
    if (result || (result = describe(env, e, base, &root)))
        return result;
    return slvi_index_write(env, path, root);
}

static slv_result to_sheet(const slv_env *env, const slv_exchange_params *params, struct export *e,
                           const char *path) {
    size_t length = strlen(path) < 4 ? 0 : strlen(path) - 4; /* without its ending */
    uint32_t nfaces = e->plan->target.nfaces, nchannels = e->plan->target.nchannels,
             ngroups = slvi_index_groups(nchannels), size[2] = {1, 1};
    uint32_t(*places)[2] = NULL;
    slv_folder *made = NULL;
    char stem[1024], name[1100];
    slv_result result;
    slv_image_format format = slv_image_format_of_name(path);
    if (format == SLV_IMAGE_NONE)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: its name must end in .png or .exr", path);
    if (length >= sizeof stem)
        return slvi_fail(env, SLV_ERROR_IO, "%s: the name is too long", path);
    e->extension = path + length;
    e->exr = format == SLV_IMAGE_EXR;
    snprintf(stem, sizeof stem, "%.*s", (int)length, path);
    snprintf(name, sizeof name, "%s.json", stem);
    if ((result = slvi_alloc(env, path, nfaces, sizeof *places, &places)) ||
        (result = slvi_alloc(env, path, ngroups, sizeof *e->sheets, &e->sheets)) ||
        (result = slvi_index_may_be(env, name)))
        goto done;
    /* what cannot be written is said before the work */
    if ((result = slv_output_try(env, path)) || (result = slv_output_try(env, name)) ||
        (result = slv_folder_begin_beside(env, path, &made)) ||
        (result = place_faces(env, e, path, places, size)))
        goto done;
    e->places = (const uint32_t(*)[2])places;
    warn_of_loss(env, e);
    for (uint32_t group = 0; group < ngroups; group++)
        if ((result = slv_image_create(env, size[0], size[1],
                                       slvi_index_group_size(nchannels, group), &e->sheets[group])))
            goto done;
    if (!(result = visit(env, e)))
        result = save_sheets(env, e, params->sheet_progress, stem, slv_folder_path(made));
done:
    result = slv_folder_end(made, strrchr(name, '/') ? strrchr(name, '/') + 1 : name, result);
    for (uint32_t group = 0; e->sheets && group < ngroups; group++)
        slv_image_free(&e->sheets[group]);
    slvi_free(e->sheets);
    slvi_free(places);
    return result;
}

static slv_result export(const slv_env *given, const slv_exchange *source,
                         const slv_exchange_params *params, const char *path,
                         slv_exchange_stats *stats, bool sheet) {
    static const slv_exchange_params none = {0};
    slvi_exchange_totals totals;
    slvi_exchange_plan plan;
    if (!source->ptx)
        return slvi_fail(given, SLV_ERROR_UNSUPPORTED, "%s: from images only a .ptx can be made",
                         source->path);
    slv_env env = slvi_budget_begin(given);
    params = params ? params : &none;
    struct export e = {.ptx = source->ptx, .plan = &plan, .meta = !params->no_meta};
    slvi_exchange_begin(&totals, params->progress, 0);
    slv_result result =
        slvi_exchange_plan_make(&env, params, source->path, &source->params, &totals, &plan);
    totals.steps.total = plan.target.nfaces;
    plan.encoding = plan.encoding ? plan.encoding : source->encoding;
    if (!result)
        result = slvi_exchange_check_memory(&env, &plan, source->ptx);
    if (!result)
        result = sheet ? to_sheet(&env, params, &e, path) : to_folder(&env, params, &e, path);
    slvi_exchange_end(&env, &totals, result, &plan.target, stats);
    slvi_exchange_plan_free(&plan);
    return slvi_budget_end(&env, result);
}

slv_result slv_exchange_to_folder(const slv_env *env, const slv_exchange *source,
                                  const slv_exchange_params *params, const char *folder,
                                  slv_exchange_stats *stats) {
    return export(env, source, params, folder, stats, false);
}

slv_result slv_exchange_to_sheet(const slv_env *env, const slv_exchange *source,
                                 const slv_exchange_params *params, const char *path,
                                 slv_exchange_stats *stats) {
    return export(env, source, params, path, stats, true);
}
