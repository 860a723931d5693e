/* What a surface is displaced by: as a view file or options say, and opened. */
#ifndef SELVAGE_TOOLS_DISPLACE_H
#define SELVAGE_TOOLS_DISPLACE_H

#include "command/cli.h"

enum { DISPLACE_PATH = 4096, DISPLACE_CHANNEL = 32 };

/* What a view file says; its path is relative to that file's folder. */
typedef struct displace_settings {
    bool given;
    char texture[DISPLACE_PATH], channel[DISPLACE_CHANNEL];
    float scale, bias;
    slv_displacement_space space;
    slv_filter_params filter;
} displace_settings;

/* What options say; those that are given come first. */
typedef struct displace_options {
    const char *texture, *channel;
    float scale, bias;
    int space, filter;
    bool scale_given, bias_given, space_given, filter_given;
} displace_options;

enum { DISPLACE_OPTION_ROWS = 6 };
/* DISPLACE_OPTION_ROWS rows for a verb's table. */
void displace_options_rows(displace_options *options, cli_option *rows);

/* A displacement with what it reads from. */
typedef struct displace_open {
    slv_cache *cache;
    slv_displacement displacement;
    bool moves; /* there is one, and its scale is not 0 */
} displace_open;

/* Opens what both say, if either says anything: a texture of the mesh's faces or triangles, `ptx`
 * itself where only a channel is named. `adjacency` has the neighbours that it takes, and must
 * outlive it; NULL: its own, which must be the mesh's. Returns an exit code; displace_close
 * releases it, after a failure too.
 */
int displace_begin(const cli_command *command, const slv_env *env, const displace_options *options,
                   const displace_settings *settings, const char *ptx,
                   const slv_adjacency *adjacency, const slv_mesh *mesh, displace_open *out);
/* The same of settings alone; what is wrong with them is in the log, and there is nothing to
 * release then. */
slv_result displace_open_settings(const slv_env *env, const displace_settings *settings,
                                  const slv_adjacency *adjacency, const slv_mesh *mesh,
                                  displace_open *out);
void displace_close(displace_open *displace);

#endif
