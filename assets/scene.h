/* The demo scene as a whole: built, written as an OBJ file, textured. */
#ifndef ASSETS_SCENE_H
#define ASSETS_SCENE_H

#include "creature.h"

#include <selvage/bake.h>

enum { GROUND_SIDE = 32 };

/* The creature and the ground beneath it, and how finely each face is textured. The creature's
 * faces come first. */
struct scene {
    struct cage creature;
    enum creature_part parts[CAGE_MAX];
    point ground[(GROUND_SIDE + 1) * (GROUND_SIDE + 1)];
    uint32_t nfaces;
    slv_res *res; /* nfaces */
};

/* False if there was no memory. */
bool scene_build(struct scene *scene);
void scene_free(struct scene *scene);

/* Writes groups "creature" and "ground". */
slv_result scene_save_obj(const slv_env *env, const struct scene *scene, const char *path);

/* Stripes for the creature and earth for the ground, each face tinted by `face_tint`, at the
 * scene's resolutions. */
slv_result scene_bake(const slv_env *env, const struct scene *scene, const slv_surface *surface,
                      float face_tint, slv_texture **out);

#endif
