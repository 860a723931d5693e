/* Finds the word that somebody meant. */
#include <selvage/words.h>

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 40 };

static bool same(char a, char b) {
    a = a == '_' ? '-' : a;
    b = b == '_' ? '-' : b;
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* Letters that were left out, put in, changed, or swapped with the next one (Damerau 1964). */
static unsigned distance(const char *a, size_t na, const char *b, size_t nb) {
    unsigned rows[3][LONGEST + 1];
    for (size_t j = 0; j <= nb; j++)
        rows[0][j] = (unsigned)j;
    for (size_t i = 1; i <= na; i++) {
        unsigned *now = rows[i % 3], *before = rows[(i + 2) % 3], *earlier = rows[(i + 1) % 3];
        now[0] = (unsigned)i;
        for (size_t j = 1; j <= nb; j++) {
            unsigned best = before[j - 1] + !same(a[i - 1], b[j - 1]);
            best = before[j] + 1 < best ? before[j] + 1 : best;
            best = now[j - 1] + 1 < best ? now[j - 1] + 1 : best;
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]) &&
                earlier[j - 2] + 1 < best)
                best = earlier[j - 2] + 1;
            now[j] = best;
        }
    }
    return rows[na % 3][nb];
}

/* A word that begins as another one does is as near as one with a single slip. */
static unsigned how_far(const char *typed, size_t length, const char *word, size_t size) {
    size_t dashes = strspn(typed, "-");
    if (length > LONGEST || size > LONGEST)
        return LONGEST;
    if (length < size && length >= dashes + 3 && distance(typed, length, word, length) == 0)
        return 1;
    return distance(typed, length, word, size);
}

const char *slv_words_hint(const char *typed, const char *words, char text[SLV_WORDS_HINT]) {
    size_t length = strcspn(typed, "="), letters = length - strspn(typed, "-"), size;
    unsigned least = letters < 3 ? 1 : letters < 6 ? 2 : 3;
    text[0] = 0;
    if (!letters || letters >= LONGEST)
        return text;
    for (const char *word = words; *word; word += size + (word[size] == '|')) {
        size = strcspn(word, "|");
        unsigned far = how_far(typed, length, word, size);
        if (far < least || (far == least && !text[0] && far < letters)) {
            least = far;
            snprintf(text, SLV_WORDS_HINT, "; did you mean '%.*s'?", (int)size, word);
        }
    }
    return text;
}
