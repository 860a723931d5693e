/* Which faces a verb had to fill because they could not be read. */
#include "command/salvage.h"

#include <stdio.h>

enum { LIST_SIZE = 600 };

slv_result salvage_open(const slv_env *env, const char *path, bool salvage, slv_ptx **out) {
    const slv_ptx_open_params params = {.salvage = salvage};
    return slv_ptx_open_with(env, path, &params, out);
}

/* "3, 5-9, 12", as far as there is room. Returns how many faces there are. */
static uint32_t list_faces(const slv_ptx *ptx, char *out, size_t size) {
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces, count = 0;
    size_t length = 0;
    out[0] = 0;
    for (uint32_t face = 0, end; face < nfaces; face = end) {
        end = face + 1;
        if (!slv_ptx_is_salvaged(ptx, face))
            continue;
        while (end < nfaces && slv_ptx_is_salvaged(ptx, end))
            end++;
        count += end - face;
        if (length + 32 > size)
            continue;
        const char *separator = length ? ", " : "";
        length += (size_t)(end - face == 1
                               ? snprintf(out + length, size - length, "%s%u", separator, face)
                               : snprintf(out + length, size - length, "%s%u-%u", separator, face,
                                          end - 1));
        if (length + 32 > size)
            length += (size_t)snprintf(out + length, size - length, ", ...");
    }
    return count;
}

int salvage_tell(const slv_ptx *ptx) {
    char list[LIST_SIZE];
    uint64_t all = slv_ptx_salvaged_count(ptx);
    if (!all)
        return EXIT_OK;
    uint32_t faces = list_faces(ptx, list, sizeof list);
    if (!faces)
        return cli_error("%s: parts of it could not be read and are left out", slv_ptx_name(ptx));
    return cli_error("%s: %u of %u faces could not be read and are filled: %s%s", slv_ptx_name(ptx),
                     faces, slv_ptx_get_info(ptx)->nfaces, list,
                     all > faces ? "; other parts are left out" : "");
}
