/* Words for how a mesh is subdivided. */
#include "base/names.h"

#include <selvage/surface.h>

#include <string.h>

static const char *const boundaries[] = {"default", "none", "edge-only", "edge-and-corner"};
static const char *const schemes[] = {"catmark", "bilinear"};

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
