/* The creature of the demo scene: its cage, and which part each face belongs to. */
#ifndef ASSETS_CREATURE_H
#define ASSETS_CREATURE_H

#include "cage.h"

/* Where a face of the creature belongs. */
enum creature_part {
    PART_BODY,
    PART_TAIL,
    PART_NECK,
    PART_HEAD,
    PART_HORN,
    PART_LEG,
    PART_FOOT,
    PART_CREST
};

/* A small dragon: four legs with two toes each, a tail with four spikes, a head with jaws, ears and
 * horns. Closed, manifold; facing +x, y up, about 2 units tall with its soles just above y = 0.
 * `parts` has room for CAGE_MAX entries, one a face. False if there was no memory. */
bool creature_build(struct cage *cage, enum creature_part *parts);

#endif
