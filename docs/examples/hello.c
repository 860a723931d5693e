/* What a .ptx holds.   cc hello.c $(pkg-config --cflags --libs selvage) */
#include <selvage/ptx.h>
#include <stdio.h>

int main(int argc, char **argv) {
    slv_ptx *ptx = NULL;
    if (argc != 2 || slv_ptx_open(NULL, argv[1], &ptx))
        return 1;
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    printf("%u faces, %u channels of %s\n", info->nfaces, info->nchannels,
           slv_type_name(info->type));
    slv_ptx_close(ptx);
    return 0;
}
