/* The word that somebody meant. */
#ifndef SELVAGE_WORDS_H
#define SELVAGE_WORDS_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* "; did you mean 'x'?" with the word of `words`, "a|b|c", that is nearest to what was typed, or ""
 * if none is near: for the end of a message. Letters that were left out, put in, changed or swapped
 * count (Damerau 1964); what stands behind "=" does not. Returns `text`. Any thread. */
#define SLV_WORDS_HINT 96
SLV_API const char *slv_words_hint(const char *typed, const char *words, char text[SLV_WORDS_HINT]);

#ifdef __cplusplus
}
#endif

#endif
