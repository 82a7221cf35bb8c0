#include "names.h"

#include <ctype.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define MOST_LETTERS 40

static int least(int a, int b) {
    return a < b ? a : b;
}

static int letter(const char *text, int index) {
    return tolower((unsigned char)text[index]);
}

// Letters to leave out, add, exchange or swap with their neighbour, each pair of neighbours once.
static int distance(const char *a, const char *b) {
    int rows = (int)strlen(a), columns = (int)strlen(b), steps[MOST_LETTERS + 1][MOST_LETTERS + 1];
    if (rows > MOST_LETTERS || columns > MOST_LETTERS) return INT_MAX;
    for (int i = 0; i <= rows; i++)
        for (int j = 0; j <= columns; j++) {
            steps[i][j] = i ? i : j;
            if (!i || !j) continue;
            steps[i][j] = least(least(steps[i - 1][j], steps[i][j - 1]) + 1,
                                steps[i - 1][j - 1] + (letter(a, i - 1) != letter(b, j - 1)));
            if (i > 1 && j > 1 && letter(a, i - 1) == letter(b, j - 2) && letter(a, i - 2) == letter(b, j - 1))
                steps[i][j] = least(steps[i][j], steps[i - 2][j - 2] + 1);
        }
    return steps[rows][columns];
}

const char *ck_name_nearest(const char *typed, ck_NameAt name_at, const void *table) {
    const char *nearest = NULL, *begun = NULL, *name;
    int length = (int)strlen(typed), best = length < 3 ? 1 : length / 3;
    for (int i = 0; (name = name_at(table, i)); i++) {
        int steps = distance(typed, name);
        bool begins = !strncmp(typed, name, (size_t)length);
        if (steps <= best && (!nearest || steps < best || begins)) nearest = name, best = steps;
        if (!begun && length >= 3 && begins) begun = name;
    }
    return nearest ? nearest : begun;
}

const char *ck_name_hint(char *out, size_t size, const char *typed, ck_NameAt name_at, const void *table) {
    const char *nearest = ck_name_nearest(typed, name_at, table);
    snprintf(out, size, nearest ? "; did you mean %s?" : "", nearest);
    return out;
}

const char *ck_name_list(char *out, size_t size, ck_NameAt name_at, const void *table) {
    const char *name;
    *out = 0;
    for (size_t i = 0, used = 0; (name = name_at(table, (int)i)) && used < size; i++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "", name);
    return out;
}

// How long a character of UTF-8 is that begins there; 0: none does.
static int character_length(const unsigned char *at) {
    const int length = at[0] < 0x80                    ? 1
                       : at[0] >= 0xc2 && at[0] < 0xe0 ? 2
                       : (at[0] & 0xf0) == 0xe0        ? 3
                       : at[0] >= 0xf0 && at[0] < 0xf5 ? 4
                                                       : 0;
    for (int i = 1; i < length; i++)
        if ((at[i] & 0xc0) != 0x80) return 0;
    // too long for what it says, a half of a pair, or beyond the last
    const bool is_none = (at[0] == 0xe0 && at[1] < 0xa0) || (at[0] == 0xed && at[1] >= 0xa0) ||
                         (at[0] == 0xf0 && at[1] < 0x90) || (at[0] == 0xf4 && at[1] >= 0x90);
    return is_none ? 0 : length;
}

void ck_text_plain(char *text) {
    unsigned char *bytes = (unsigned char *)text;
    for (int length; *bytes && (length = character_length(bytes)); bytes += length) continue;
    for (bool is_broken = *bytes; is_broken && *text; text++)
        if ((unsigned char)*text >= 0x80) *text = '?';
}

size_t ck_text_shell(char *out, size_t size, const char *word) {
    bool is_plain = *word && !word[strspn(word, CK_PLAIN_LETTERS "/=:,+@%")], has_controls = false;
    for (const char *letter = word; *letter; letter++) has_controls |= (unsigned char)*letter < 0x20 || *letter == 0x7f;
    size_t used = (size_t)snprintf(out, size, "%s", is_plain ? "" : has_controls ? "$'" : "'");
    for (const char *letter = word; *letter && used + 6 < size; letter++) {
        const bool is_escaped = has_controls && strchr("\\'", *letter);
        if ((unsigned char)*letter < 0x20 || *letter == 0x7f)
            used += (size_t)snprintf(out + used, size - used, "\\x%02x", (unsigned char)*letter);
        else if (*letter == '\'' && !has_controls)
            // a quote ends the quotes, stands by itself, and begins them anew
            used += (size_t)snprintf(out + used, size - used, "'\\''");
        else
            used += (size_t)snprintf(out + used, size - used, is_escaped ? "\\%c" : "%c", *letter);
    }
    if (!is_plain) used += (size_t)snprintf(out + used, size - used, "'");
    return used;
}
