/* Words that are lists of words. */
#ifndef SELVAGE_TOOLS_WORDS_H
#define SELVAGE_TOOLS_WORDS_H

#include <selvage/words.h>

#include <stddef.h>

/* Whether `name` is one of the words of "a|b|c"; its index, or -1. */
int words_index(const char *words, const char *name, size_t length);

#endif
