/* The pass that puts pictures of light onto the screen: side by side or apart, encoded, with what
 * lies over them. */
#ifndef SELVAGE_STUDIO_SCREEN_H
#define SELVAGE_STUDIO_SCREEN_H

#include "studio/picture/picture.h"

typedef struct studio_screen studio_screen;

slv_result studio_screen_create(const slv_env *env, studio_screen **out);
void studio_screen_destroy(studio_screen *screen);
/* Of two textures, of which the second is read where two strategies are shown. `same_size`: as
 * large as the screen. */
slv_result studio_screen_put(studio_screen *screen, const slv_env *env, const studio_shot *shot,
                             const unsigned pictures[2], bool same_size, unsigned framebuffer);

/* A program of two texts; 0: the driver's words are in the log. */
unsigned studio_program(const slv_env *env, const char *vertex, const char *fragment);

#endif
