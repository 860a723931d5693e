/* Lists of words, "a|b|c", put together. */
#ifndef SLV_BASE_WORDS_H
#define SLV_BASE_WORDS_H

#include <selvage/words.h>

#include <stdio.h>
#include <string.h>

/* Puts a word behind those of a list, as far as it has room. */
static inline void slvi_words_add(char *list, size_t size, const char *word) {
    size_t used = strlen(list);
    snprintf(list + used, size - used, "%s%s", used ? "|" : "", word);
}

#endif
