/* Finds a word in a list of words. */
#include "command/words.h"

#include <string.h>

/* Other names of words. */
static const char *const others[][2] = {{"catmull-clark", "catmark"}};

int words_index(const char *words, const char *name, size_t length) {
    int index = 0;
    for (const char *word = words; *word; index++) {
        size_t here = strcspn(word, "|");
        if (here == length && strncmp(word, name, length) == 0)
            return index;
        word += here + (word[here] == '|');
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strlen(others[i][0]) == length && strncmp(others[i][0], name, length) == 0)
            return words_index(words, others[i][1], strlen(others[i][1]));
    return -1;
}
