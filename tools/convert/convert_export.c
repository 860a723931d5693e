#include "convert/convert_index.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct export {
    const convert_plan *plan;
    const char *folder; /* one image a face; NULL: a sheet */
    bool exr;
    slv_image *sheets; /* one a group */
    const uint32_t(*places)[2];
};

static bool is_lossy(slv_type type, bool exr) {
    return !exr && (type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT);
}

static slv_result save_face(const struct export *e, const slv_env *env, uint32_t face, slv_res res,
                            const float *values) {
    uint32_t nchannels = e->plan->target.nchannels;
    slv_image_params params = index_image_params(e->plan->target.type, e->exr);
    slv_result result = SLV_OK;
    for (uint32_t group = 0; group < index_groups(nchannels) && !result; group++) {
        char stem[32], name[64], path[1400];
        slv_image image = {0};
        snprintf(stem, sizeof stem, "face_%06u", face);
        index_image_name(name, sizeof name, stem, group, e->exr);
        snprintf(path, sizeof path, "%s/%s", e->folder, name);
        result = slv_image_create(env, 1u << res.u, 1u << res.v, index_group_size(nchannels, group),
                                  &image);
        if (!result) {
            index_to_image(values, res, nchannels, group, &image, 0, 0);
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
    slv_result result = convert_face(env, e->plan, face, &changed, &converted, &own);
    slv_res res = changed.flags & SLV_FACE_CONSTANT ? (slv_res){0, 0} : changed.res;
    size_t count = ((size_t)1 << (res.u + res.v)) * target->nchannels;
    if (!result && !(values = malloc(count * sizeof *values)))
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its image",
                             e->plan->path, face);
    if (!result) {
        slv_type_to_float(target->type, converted, count, values);
        if (e->folder)
            result = save_face(e, env, face, res, values);
        else
            for (uint32_t group = 0; group < index_groups(target->nchannels); group++)
                index_to_image(values, res, target->nchannels, group, &e->sheets[group],
                               e->places[face][0], e->places[face][1]);
    }
    free(values);
    free(own);
    return result;
}

/* The index, with every face's entry; `places` is NULL for a folder. */
static json_t *describe(const convert_options *options, const convert_plan *plan,
                        const slv_ptx *ptx, const char *stem, bool exr,
                        const uint32_t (*places)[2]) {
    json_t *root = index_create(ptx, plan, !options->no_meta);
    json_t *faces = json_object_get(root, "faces"), *images = json_array();
    uint32_t ngroups = index_groups(plan->target.nchannels);
    int failed = !root;
    for (uint32_t group = 0; places && group < ngroups; group++) {
        char name[512];
        index_image_name(name, sizeof name, stem, group, exr);
        failed |= json_array_append_new(images, output_json_text(name, strlen(name)));
    }
    failed |= json_object_set_new(root, "images", images);
    for (uint32_t face = 0; face < plan->target.nfaces && !failed; face++) {
        slv_ptx_face info;
        failed = slv_ptx_get_face(ptx, face, &info) != SLV_OK;
        info.res = convert_plan_res(plan, face, info.res);
        json_t *item =
            failed ? NULL : index_face(&info, plan->target.mesh_type == SLV_PTX_QUAD ? 4 : 3);
        if (places) {
            failed |= json_object_set_new(item, "x", json_integer(places[face][0]));
            failed |= json_object_set_new(item, "y", json_integer(places[face][1]));
        } else {
            json_t *names = json_array();
            for (uint32_t group = 0; group < ngroups; group++) {
                char one[32], name[64];
                snprintf(one, sizeof one, "face_%06u", face);
                index_image_name(name, sizeof name, one, group, exr);
                failed |= json_array_append_new(names, json_string(name));
            }
            failed |= json_object_set_new(item, "images", names);
        }
        failed |= json_array_append_new(faces, item);
    }
    if (!failed)
        return root;
    json_decref(root);
    return NULL;
}

int convert_to_folder(const slv_env *env, const convert_options *options, const convert_plan *plan,
                      const slv_ptx *ptx, const char *folder) {
    slv_type type = plan->target.type;
    bool real = type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT;
    struct export e = {.plan = plan, .exr = options->format_given ? options->format == 1 : real};
    output_folder made;
    char path[1300];
    int code = output_folder_begin(folder, &made);
    if (code)
        return code;
    if (is_lossy(type, e.exr))
        cli_warning("PNG holds 0..1 in 16 bits, the texels are %s", slv_type_name(type));
    e.folder = made.beside;
    snprintf(path, sizeof path, "%s/index.json", made.beside);
    code = slv_ptx_visit_faces(env, ptx, export_face, &e) ? EXIT_FAILED : EXIT_OK;
    if (!code)
        code = index_write(env, path, describe(options, plan, ptx, NULL, e.exr, NULL));
    return output_folder_end(&made, "index.json", code);
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
static int place_faces(const convert_plan *plan, const slv_ptx *ptx, const char *path,
                       uint32_t (*places)[2], uint32_t size[2]) {
    uint32_t nfaces = plan->target.nfaces;
    struct box *boxes = calloc((size_t)nfaces + 1, sizeof *boxes);
    uint64_t area = 0, x = 0, y = 0, width = 1, height = 0;
    int code = EXIT_OK;
    if (!boxes)
        return cli_error("%s: no memory to place %u faces", path, nfaces);
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face info;
        if ((code = slv_ptx_get_face(ptx, face, &info) ? EXIT_FAILED : EXIT_OK))
            goto done;
        slv_res res = info.flags & SLV_FACE_CONSTANT ? (slv_res){0, 0}
                                                     : convert_plan_res(plan, face, info.res);
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
        code = cli_error("%s: a sheet of %llu x %llu is too large: name a folder instead", path,
                         (unsigned long long)width, (unsigned long long)(y + height));
done:
    free(boxes);
    return code;
}

/* Whether there is no file of that name, or an index, which may be written anew. */
static bool may_be_index(const char *path) {
    json_error_t error;
    struct stat status;
    if (lstat(path, &status) != 0 && errno == ENOENT)
        return true;
    json_t *root = json_load_file(path, 0, &error);
    const char *kind = json_string_value(json_object_get(root, "kind"));
    bool good = kind && strcmp(kind, INDEX_KIND) == 0;
    json_decref(root);
    return good;
}

/* The pictures and the index go into the folder `made`. */
static int save_sheets(const struct export *e, const slv_env *env, const convert_options *options,
                       const slv_ptx *ptx, const char *stem, const output_folder *made) {
    const slv_ptx_writer_params *target = &e->plan->target;
    slv_image_params params = index_image_params(target->type, e->exr);
    const char *slash = strrchr(stem, '/'), *base = slash ? slash + 1 : stem;
    char name[1100], path[2400];
    for (uint32_t group = 0; group < index_groups(target->nchannels); group++) {
        index_image_name(name, sizeof name, base, group, e->exr);
        snprintf(path, sizeof path, "%s/%s", made->beside, name);
        if (output_image(env, path, &e->sheets[group], params, options->progress,
                         options->quiet || options->json))
            return EXIT_FAILED;
    }
    snprintf(path, sizeof path, "%s/%s.json", made->beside, base);
    return index_write(env, path, describe(options, e->plan, ptx, base, e->exr, e->places));
}

int convert_to_sheet(const slv_env *env, const convert_options *options, const convert_plan *plan,
                     const slv_ptx *ptx, const char *path) {
    size_t length = strlen(path) - 4; /* .png or .exr */
    struct export e = {.plan = plan, .exr = path[length + 1] == 'e' || path[length + 1] == 'E'};
    uint32_t nfaces = plan->target.nfaces, ngroups = index_groups(plan->target.nchannels);
    uint32_t size[2] = {1, 1};
    uint32_t(*places)[2] = calloc((size_t)nfaces + 1, sizeof *places);
    output_folder made;
    char stem[1024], name[1100];
    int code = EXIT_FAILED;
    e.sheets = calloc(ngroups, sizeof *e.sheets);
    if (!places || !e.sheets || length >= sizeof stem) {
        cli_error("%s: no memory for %u faces", path, nfaces);
        goto done;
    }
    snprintf(stem, sizeof stem, "%.*s", (int)length, path);
    snprintf(name, sizeof name, "%s.json", stem);
    if (!may_be_index(name)) {
        cli_error("%s: is there already and is no index of a sheet: name another sheet", name);
        goto done;
    }
    if (place_faces(plan, ptx, path, places, size))
        goto done;
    e.places = (const uint32_t(*)[2])places;
    if (is_lossy(plan->target.type, e.exr))
        cli_warning("PNG holds 0..1 in 16 bits, the texels are %s",
                    slv_type_name(plan->target.type));
    for (uint32_t group = 0; group < ngroups; group++)
        if (slv_image_create(env, size[0], size[1], index_group_size(plan->target.nchannels, group),
                             &e.sheets[group]))
            goto done;
    if (slv_ptx_visit_faces(env, ptx, export_face, &e) || output_files_begin(path, &made))
        goto done;
    cli_progress_end(&plan->totals->progress);
    const char *slash = strrchr(name, '/');
    code = save_sheets(&e, env, options, ptx, stem, &made);
    code = output_folder_end(&made, slash ? slash + 1 : name, code);
done:
    for (uint32_t group = 0; e.sheets && group < ngroups; group++)
        slv_image_free(&e.sheets[group]);
    free(e.sheets);
    free(places);
    return code;
}
