/* Faces whose texture coordinates are missing, beyond reason or too far apart, named. */
#include "uv/corners.h"

#include "base/log.h"

#include <math.h>

#define FARTHEST 65536.0f /* texture coordinates, in units: floats have 1/128 left there */

uv_lacking slvi_uv_check_corners(float *corners, uint32_t nfaces) {
    uv_lacking lacking = {0};
    for (uint32_t face = 0; face < nfaces; face++) {
        float *own = corners + 8 * (size_t)face;
        bool none = false, far = false;
        for (int i = 0; i < 8; i++) {
            none |= isnan(own[i]);
            far |= fabsf(own[i]) > FARTHEST;
        }
        if (none && !lacking.none++)
            lacking.first_none = face;
        if (!none && far && !lacking.far++)
            lacking.first_far = face;
        if (none || far)
            own[0] = NAN;
    }
    return lacking;
}

void slvi_uv_warn_of_lacking(const slv_env *env, const char *path, const uv_lacking *lacking,
                             uint32_t nfaces) {
    if (lacking->none)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "%s: %u of %u faces have no texture coordinates (vt), and show nothing of it: the "
            "first is face %u",
            path, lacking->none, nfaces, lacking->first_none);
    if (lacking->far)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "%s: %u of %u faces have texture coordinates (vt) beyond %.0f, and show nothing of "
            "it: the first is face %u",
            path, lacking->far, nfaces, (double)FARTHEST, lacking->first_far);
}

static bool is_wide(const float *own, int axis) {
    float low = own[axis], high = own[axis];
    for (int c = 1; c < 4; c++) {
        low = fminf(low, own[2 * c + axis]);
        high = fmaxf(high, own[2 * c + axis]);
    }
    return high - low > 0.5f - 1e-5f;
}

/* Which way round the corners run. */
static bool is_backward(const float *own) {
    const double ax = (double)own[4] - (double)own[0], ay = (double)own[5] - (double)own[1],
                 bx = (double)own[6] - (double)own[2], by = (double)own[7] - (double)own[3];
    return ax * by < ay * bx;
}

void slvi_uv_warn_of_wide(const slv_env *env, const char *path, const float *corners,
                          uint32_t nfaces, const bool round[2]) {
    const bool any = round[0] || round[1];
    uint32_t backward = 0, count = 0, first = 0;
    for (uint32_t face = 0; face < nfaces && !any; face++)
        backward += is_backward(corners + 8 * (size_t)face);
    for (uint32_t face = 0; face < nfaces; face++) {
        const float *own = corners + 8 * (size_t)face;
        bool wide = false;
        for (int axis = 0; axis < 2 && !isnan(own[0]); axis++)
            wide |= (round[axis] || !any) && is_wide(own, axis);
        if (!any) /* of a map, of which others run the same way, or an island that is so large */
            wide = wide && is_backward(own) != (backward > nfaces / 2);
        first = wide && !count ? face : first;
        count += wide;
    }
    if (count && any)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "%s: %u of %u faces span half of the map or more along what goes round, and may be "
            "taken the wrong way: the first is face %u",
            path, count, nfaces, first);
    else if (count && count < nfaces - count)
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: %u of %u faces span half of the map or more and run the other way than the "
                  "rest, as over the end of a map that goes round, which is not said (--round): "
                  "the first is face %u",
                  path, count, nfaces, first);
}

bool slvi_uv_stays(const float *corners, uint32_t nfaces, int axis) {
    for (uint32_t face = 0; face < nfaces; face++, corners += 8)
        for (int c = 0; c < 4 && !isnan(corners[0]); c++)
            if (corners[2 * c + axis] < 0 || corners[2 * c + axis] > 1)
                return false;
    return true;
}
