/* The words for the values of an enumeration. */
#ifndef SLV_BASE_NAMES_H
#define SLV_BASE_NAMES_H

#include <stdbool.h>
#include <stdint.h>

/* names[value], or "unknown" for a value that has none. */
const char *slvi_name_of(const char *const *names, uint32_t count, int value);
/* The value of a word; false, and *value as it was, if none has it. NULL is no word. */
bool slvi_name_find(const char *const *names, uint32_t count, const char *name, int *value);

#define SLVI_COUNT(array) (sizeof(array) / sizeof *(array))

#endif
