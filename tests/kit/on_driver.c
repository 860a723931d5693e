/* on_driver NAME PROGRAM: runs a test that draws if EGL's driver is the one named, and is skipped
 * if it is another, so that no test passes for a driver that it never met. */
#include <selvage/gl_context.h>

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SKIPPED = 77 };

int main(int argc, char **argv) {
    slv_env env = {0};
    slv_gl *gl = NULL;
    if (argc < 3) {
        fprintf(stderr, "usage: on_driver NAME PROGRAM\n");
        return 2;
    }
    /* EGL alone: Mesa's OSMesa crashes where it is told to take zink */
    if (slv_gl_create(&env, SLV_GL_EGL, &gl)) {
        fprintf(stderr, "skipped: EGL has no context with %s\n", argv[1]);
        return SKIPPED;
    }
    const char *renderer = slv_gl_get_info(gl)->renderer;
    if (strncmp(renderer, argv[1], strlen(argv[1])) != 0) {
        fprintf(stderr, "skipped: the driver is %s, not %s\n", renderer, argv[1]);
        slv_gl_destroy(gl);
        return SKIPPED;
    }
    fprintf(stderr, "on %s\n", renderer);
    slv_gl_destroy(gl);
    execv(argv[2], argv + 2);
    perror(argv[2]);
    return 1;
}
