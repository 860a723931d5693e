/* The words of enumerations as options take them: those by which the library calls their values. */
#ifndef SELVAGE_TOOLS_NAMES_H
#define SELVAGE_TOOLS_NAMES_H

/* Lists "a|b|c" in the order of the values, from 0 on. */
const char *names_types(void);
const char *names_encodings(void);
const char *names_borders(void);
const char *names_edge_filters(void);
const char *names_schemes(void);
const char *names_boundaries(void);
const char *names_shadings(void);
const char *names_alpha_modes(void);
const char *names_contexts(void); /* those that can be asked for */
const char *names_pixel_filters(void);
const char *names_filters(void);
const char *names_spaces(void); /* of displacements */
const char *names_wraps(void);
const char *names_rounds(void); /* which texture coordinates go round */
const char *names_seams(void);
const char *names_patterns(void);
const char *names_bake_surfaces(void);
const char *names_bake_rays(void);
const char *names_bake_details(void);
const char *names_unbake_normals(void);

#endif
