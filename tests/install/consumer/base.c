/* A program of somebody else's that reads .ptx files and does nothing else. */
#include <selvage/ptx.h>

int main(void) {
    slv_ptx *ptx = NULL;
    return slv_ptx_open(0, "/no/such/file.ptx", &ptx) == SLV_ERROR_IO ? 0 : 1;
}
