/* The command by itself: all that it does is in the library of its verbs. */
#include "verbs.h"

int main(int argc, char **argv) {
    return command_main(argc, argv);
}
