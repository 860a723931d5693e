/* The verbs: a new one is a row here, and a file or a folder of its name that defines verb_NAME. */
#ifndef SELVAGE_TOOLS_VERBS_H
#define SELVAGE_TOOLS_VERBS_H

#define SELVAGE_VERBS(VERB)                                                                        \
    VERB(new, "make a blank texture for a mesh")                                                   \
    VERB(bake, "make a texture of images, rays, a detailed mesh")                                  \
    VERB(unbake, "draw a .ptx into UV images, or the tiles of a set")                              \
    VERB(wrap, "make texture coordinates that go round, and weld duplicated vertices")             \
    VERB(paint, "apply a script of strokes to a texture")                                          \
    VERB(session, "paint in layers that nothing can lose")                                         \
    VERB(studio, "see, compare and paint a .ptx in a window")                                      \
    VERB(render, "draw a .ptx on its subdivision surface into a PNG or EXR")                       \
    VERB(compare, "measure the seam strategies against each other and write a report")             \
    VERB(reference, "ray-cast a .ptx: the picture that strategies are measured against")           \
    VERB(pick, "say which face and texel a place in a picture shows")                              \
    VERB(info, "say what a .ptx or a mesh holds")                                                  \
    VERB(check, "say whether a .ptx is sound, naming face and edge of what is not")                \
    VERB(diff, "say which faces of two .ptx files differ, how much and where")                     \
    VERB(convert, "change type, channels or size of a .ptx; images in and out")                    \
    VERB(merge, "join several .ptx files into one")                                                \
    VERB(split, "take a .ptx apart again: the inverse of merge")                                   \
    VERB(transfer, "carry texels over to a changed model")                                         \
    VERB(sample, "filtered lookups in a .ptx, a line each; how many a second")

/* Each returns an exit code; argv[0] is the verb. */
#define VERB(name, summary) int verb_##name(int argc, char **argv);
SELVAGE_VERBS(VERB)
#undef VERB

/* The command, as main() runs it: argv[1] is the verb. Prints to stdout and stderr, returns the
 * exit code and never exits, so that a test can call it in a process of its own. */
int command_main(int argc, char **argv);

#endif
