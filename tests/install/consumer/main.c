/* A program that uses two of the installed libraries. */
#include <selvage/bake.h>
#include <selvage/ptx.h>

#include <stdio.h>

int main(void) {
    slv_ptx *ptx = NULL;
    float rgba[4];
    slv_procedural_evaluate(&(slv_procedural){0}, 0, (const float[3]){0, 0, 0}, rgba);
    printf("selvage %u: %s\n", (unsigned)slv_version(), slv_result_string(SLV_ERROR_IO));
    return slv_ptx_open(NULL, "/no/such/file.ptx", &ptx) == SLV_ERROR_IO && rgba[3] == 1 ? 0 : 1;
}
