/* Words that are lists of words, and the one that was meant. */
#ifndef SELVAGE_TOOLS_WORDS_H
#define SELVAGE_TOOLS_WORDS_H

#include <stddef.h>

/* Whether `name` is one of the words of "a|b|c"; its index, or -1. */
int words_index(const char *words, const char *name, size_t length);

/* "; did you mean 'x'?" with the word of "a|b|c" that is nearest to what was typed, or "" if none
 * is near. Returns `text`. */
#define WORDS_HINT 96
const char *words_hint(const char *typed, const char *words, char text[WORDS_HINT]);

#endif
