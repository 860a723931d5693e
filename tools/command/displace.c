/* Opens what displaces a surface. */
#include "command/displace.h"

#include "command/lists.h"
#include "command/output.h"
#include "command/scene.h"

#include <string.h>

void displace_options_rows(displace_options *o, cli_option *out) {
    const cli_option rows[DISPLACE_OPTION_ROWS] = {
        {"--displacement", CLI_TEXT, &o->texture, "what moves the surface (the view's)", "FILE.ptx",
         0, 0, NULL},
        {"--displacement-channel", CLI_TEXT, &o->channel,
         "by name or number, the first of three of a vector (0); without a file, of the texture "
         "itself",
         "CHANNEL", 0, 0, NULL},
        {"--displacement-scale", CLI_FLOAT, &o->scale,
         "how far a value of 1 moves, in units of the mesh (1, or the view's)", "X", 0, 0,
         &o->scale_given},
        {"--displacement-bias|--displacement-offset", CLI_FLOAT, &o->bias,
         "added to values before they are scaled (0, or the view's)", "X", 0, 0, &o->bias_given},
        {"--displacement-space", CLI_CHOICE, &o->space,
         "along the normal; or by vectors of the object's or the surface's axes", names_spaces(), 0,
         0, &o->space_given},
        {"--displacement-filter", CLI_CHOICE, &o->filter, "how it is looked up (bspline)",
         names_filters(), 0, 0, &o->filter_given},
    };
    memcpy(out, rows, sizeof rows);
}

/* What the file says, and over it the options. */
static displace_settings merge(const displace_options *o, const displace_settings *settings,
                               const char *texture, const char *ptx) {
    displace_settings d = *settings;
    if (!texture && o->channel && !d.given)
        texture = ptx;
    if (!d.given) {
        d.scale = 1;
        d.filter = (slv_filter_params){.filter = SLV_FILTER_BSPLINE, .lerp = true};
    }
    if (texture)
        snprintf(d.texture, sizeof d.texture, "%s", texture);
    /* the view's channel is of the view's file */
    if (o->channel || texture || !d.channel[0])
        snprintf(d.channel, sizeof d.channel, "%s", o->channel ? o->channel : "0");
    d.given |= texture != NULL;
    d.scale = o->scale_given ? o->scale : d.scale;
    d.bias = o->bias_given ? o->bias : d.bias;
    d.space = o->space_given ? (slv_displacement_space)o->space : d.space;
    if (o->filter_given)
        d.filter.filter = (slv_filter)o->filter;
    return d;
}

/* Whether it is of this mesh, with its neighbours if they must `agree`: lookups over edges go to
 * them. */
static slv_result check_mesh(const slv_env *env, const char *path, bool agree,
                             const slv_mesh *mesh) {
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, path, &ptx);
    const bool triangles = !result && slv_ptx_get_info(ptx)->mesh_type == SLV_PTX_TRIANGLE;
    if (!result && (agree || (triangles && !scene_is_of_triangles(mesh))))
        result = slv_ptx_match_mesh(env, ptx, mesh);
    if (!result && triangles)
        result = scene_check_memory(env, ptx, NULL);
    slv_ptx_close(ptx);
    return result;
}

slv_result displace_open_settings(const slv_env *env, const displace_settings *d,
                                  const slv_adjacency *adjacency, const slv_mesh *mesh,
                                  displace_open *out) {
    slv_file_id file;
    slv_ptx_info info;
    memset(out, 0, sizeof *out);
    out->moves = d->given && d->scale != 0;
    slv_result result = out->moves ? slv_cache_create(env, NULL, &out->cache) : SLV_OK;
    if (!out->moves)
        return SLV_OK;
    if (result || (result = slv_cache_open(out->cache, d->texture, &file)) ||
        (result = slv_cache_get_info(out->cache, file, &info)))
        goto done;
    uint64_t displaced = (info.mesh_type == SLV_PTX_TRIANGLE ? 3 : 1) * (uint64_t)info.nfaces;
    if (displaced != slv_mesh_face_count(mesh)) {
        result =
            output_fail(env, SLV_ERROR_MISMATCH, "%s: displaces %llu faces, and the mesh has %u",
                        d->texture, (unsigned long long)displaced, slv_mesh_face_count(mesh));
        goto done;
    }
    if ((result = check_mesh(env, d->texture, !adjacency, mesh)))
        goto done;
    const value_channels channels = {info.nchannels, info.alpha_channel};
    int32_t channel = value_channel_find(d->channel, strlen(d->channel), channels);
    uint32_t width = d->space ? 3 : 1;
    if (channel < 0 || info.nchannels - (uint32_t)channel < width) {
        result =
            output_fail(env, SLV_ERROR_ARGUMENT,
                        "%s: displaces from channel '%s' on, and has not %u there but %u in all",
                        d->texture, d->channel, width, info.nchannels);
        goto done;
    }
    const slv_displacement_params params = {.space = d->space,
                                            .channel = (uint32_t)channel,
                                            .scale = d->scale,
                                            .bias = d->bias,
                                            .filter = &d->filter,
                                            .adjacency = adjacency};
    result = slv_displacement_open(out->cache, file, &params, &out->displacement);
done:
    if (result)
        displace_close(out);
    return result;
}

int displace_begin(const cli_command *command, const slv_env *env, const displace_options *options,
                   const displace_settings *settings, const char *ptx,
                   const slv_adjacency *adjacency, const slv_mesh *mesh, displace_open *out) {
    const char *texture = options->texture;
    int code = texture ? cli_settle_input(&texture) : EXIT_OK;
    const displace_settings d = merge(options, settings, texture, ptx);
    bool more = options->scale_given || options->bias_given || options->space_given ||
                options->filter_given;
    memset(out, 0, sizeof *out);
    if (code)
        return code;
    if (!d.given && more)
        return cli_usage(command, "nothing says what to displace by: --displacement FILE.ptx does, "
                                  "or --displacement-channel");
    if (strlen(options->texture ? options->texture : "") >= DISPLACE_PATH ||
        strlen(options->channel ? options->channel : "") >= DISPLACE_CHANNEL)
        return cli_usage(command, "--displacement: the name is too long");
    slv_result result = displace_open_settings(env, &d, adjacency, mesh, out);
    /* of a channel that the command line names it is the command line that is wrong */
    return result == SLV_ERROR_ARGUMENT && options->channel ? EXIT_USAGE
           : result                                         ? EXIT_FAILED
                                                            : EXIT_OK;
}

void displace_close(displace_open *displace) {
    slv_displacement_close(&displace->displacement);
    slv_cache_destroy(displace->cache);
    memset(displace, 0, sizeof *displace);
}
