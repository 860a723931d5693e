/* Words for how a mesh is subdivided, and moved. */
#include "base/names.h"

#include <selvage/tessellation.h>

#include <string.h>

static const char *const boundaries[] = {"default", "none", "edge-only", "edge-and-corner"};
static const char *const spaces[] = {"normal", "object", "tangent"};
static const char *const schemes[] = {"catmark", "bilinear", "loop"};

const char *slv_boundary_name(slv_boundary boundary) {
    return slvi_name_of(boundaries, SLVI_COUNT(boundaries), (int)boundary);
}

bool slv_boundary_from_name(const char *name, slv_boundary *out) {
    int value = 0;
    bool found = slvi_name_find(boundaries, SLVI_COUNT(boundaries), name, &value);
    if (found)
        *out = (slv_boundary)value;
    return found;
}

const char *slv_scheme_name(slv_scheme scheme) {
    return slvi_name_of(schemes, SLVI_COUNT(schemes), (int)scheme);
}

bool slv_scheme_from_name(const char *name, slv_scheme *out) {
    int value = 0;
    bool found = slvi_name_find(schemes, SLVI_COUNT(schemes), name, &value) ||
                 (name && strcmp(name, "catmull-clark") == 0); /* whose value is 0 */
    if (found)
        *out = (slv_scheme)value;
    return found;
}

const char *slv_displacement_space_name(slv_displacement_space space) {
    return slvi_name_of(spaces, SLVI_COUNT(spaces), (int)space);
}

bool slv_displacement_space_from_name(const char *name, slv_displacement_space *out) {
    int value = 0;
    bool found = slvi_name_find(spaces, SLVI_COUNT(spaces), name, &value);
    if (found)
        *out = (slv_displacement_space)value;
    return found;
}
