/* The shortest useful program: what a .ptx holds.   cc hello.c $(pkg-config --cflags --libs selvage) */
#include <selvage/ptx.h>

#include <stdio.h>
#include <stdlib.h>

static void print(void *user, slv_log_level level, const char *message) {
    (void)user;
    fprintf(stderr, "%s%s\n", level == SLV_LOG_WARNING ? "warning: " : "", message);
}

int main(int argc, char **argv) {
    slv_env env = {.log = print}; /* NULL in its place: no messages, all defaults */
    slv_ptx *ptx = NULL;
    slv_ptx_face face;
    if (argc != 2 || slv_ptx_open(&env, argv[1], &ptx) || slv_ptx_get_face(ptx, 0, &face))
        return 1; /* what went wrong has been printed */
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    size_t width = (size_t)1 << face.res.u, height = (size_t)1 << face.res.v;
    printf("%u faces of %u x %s; face 0 is %zu x %zu\n", info->nfaces, info->nchannels,
           slv_type_name(info->type), width, height);

    size_t count = width * height * info->nchannels; /* row 0 is v = 0, channels interleaved */
    void *texels = malloc(count * slv_type_size(info->type));
    float first = 0;
    int failed = !texels || slv_ptx_read_face(ptx, 0, face.res, texels);
    if (!failed) {
        slv_type_to_float(info->type, texels, 1, &first); /* integers become 0..1 */
        printf("its first value is %g\n", (double)first);
    }
    free(texels);
    slv_ptx_close(ptx);
    return failed;
}
