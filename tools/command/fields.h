/* Fields of JSON files that nobody reads, which are most likely slips. */
#ifndef SELVAGE_TOOLS_FIELDS_H
#define SELVAGE_TOOLS_FIELDS_H

#include <selvage/result.h>

#include <jansson.h>

/* Warns of every field of an object that is none of `known`, "a|b|c", naming the nearest that is.
 * `what` says where it is. Returns how many there are. */
uint32_t fields_warn(const slv_env *env, const char *what, const json_t *object, const char *known);

#endif
