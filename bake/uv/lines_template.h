/* Sums of samples along lines; compiled once for each kind of processor, by its name
 * SLVI_VARIANT_NAME, the LANES that its vectors have, and two pixels as it has them in registers.
 */
#define JOIN(NAME, KIND) PASTE(NAME, KIND)
#define PASTE(NAME, KIND) NAME##_##KIND

typedef float floats __attribute__((vector_size(4 * LANES)));
typedef int32_t ints __attribute__((vector_size(4 * LANES)));

enum { AT_ONCE = 64 };

/* Where some samples of a line are: the pixel in the upper left of each, in bytes, and how far
 * beyond it. */
typedef struct places {
    _Alignas(32) int32_t at[AT_ONCE];
    _Alignas(32) float fx[AT_ONCE], fy[AT_ONCE];
} places;

/* So many at a time; those beyond `count` may lie anywhere, and nobody looks there. */
static inline void find_places(const uv_line *line, float row, uint32_t first, uint32_t count,
                               places *out) {
    static const int32_t numbers[] = {0, 1, 2, 3, 4, 5, 6, 7};
    ints steps;
    memcpy(&steps, numbers, sizeof steps);
    for (uint32_t i = 0; i < count; i += LANES) {
        const floats k = __builtin_convertvector(steps + (int32_t)(first + i), floats);
        const floats x = line->x + k * line->dx, y = line->y + k * line->dy;
        const floats left = __builtin_convertvector(__builtin_convertvector(x, ints), floats),
                     top = __builtin_convertvector(__builtin_convertvector(y, ints), floats);
        /* exact: a window has few pixels */
        *(ints *)(out->at + i) =
            __builtin_convertvector(top * row + left, ints) * (int32_t)sizeof(uv_pixel);
        *(floats *)(out->fx + i) = x - left;
        *(floats *)(out->fy + i) = y - top;
    }
}

/* What the right ones of the pixels around samples bring beyond the left ones is summed up by
 * itself: of pixels that are all alike the samples are the same to the bit. */
static inline __attribute__((always_inline)) void add_samples(const char *row, const char *next,
                                                              const places *where, uint32_t each,
                                                              uint32_t ntexels, uv_pixel *sums) {
    for (uint32_t texel = 0, i = 0; texel < ntexels; texel++) {
        uv_pixel near = {0}, beyond = sums[texel];
        for (uint32_t k = 0; k < each; k++, i++) {
            uv_pixel a, b;
            between_rows(row + where->at[i], next + where->at[i], where->fy[i], &a, &b);
            near += a;
            beyond += (b - a) * where->fx[i];
        }
        sums[texel] = near + beyond;
    }
}

/* Where samples lie is found for many of them before any pixel is read. */
void JOIN(slvi_uv_sum_line, SLVI_VARIANT_NAME)(const uv_window *window, const uv_line *line,
                                               uint32_t per_texel, uint32_t ntexels,
                                               uv_pixel *sums) {
    const char *row = (const char *)window->pixels, *next = row + window->width * sizeof(uv_pixel);
    const uint32_t most = per_texel < AT_ONCE ? per_texel : AT_ONCE, texels = AT_ONCE / most;
    places where;
    for (uint32_t first = 0; first < ntexels; first += texels) {
        const uint32_t count = ntexels - first < texels ? ntexels - first : texels;
        uv_pixel *to = sums + first;
        /* several times for one texel that has more */
        for (uint32_t k = 0; k < per_texel; k += most) {
            const uint32_t each = per_texel - k < most ? per_texel - k : most;
            find_places(line, (float)window->width, first * per_texel + k, count * each, &where);
            if (each == 4) /* two pixels a texel; the compiler counts for itself */
                add_samples(row, next, &where, 4, count, to);
            else if (each == 2)
                add_samples(row, next, &where, 2, count, to);
            else
                add_samples(row, next, &where, each, count, to);
        }
    }
}
