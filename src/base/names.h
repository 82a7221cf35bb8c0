// Names as people type them: the known one that an unknown one was meant to be.
#ifndef CK_NAMES_H
#define CK_NAMES_H

#include <stddef.h>

// What names of scenes and engines are made of, so that they can name files.
#define CK_PLAIN_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-."

// A name of a table by its number; NULL beyond the last.
typedef const char *(*ck_NameAt)(const void *table, int index);

// The nearest by letters left out, added, exchanged or swapped, at most one in three; else one that begins as typed.
// NULL where none is near.
const char *ck_name_nearest(const char *typed, ck_NameAt name_at, const void *table);

// Writes "; did you mean NAME?", or nothing where none is near. Returns out.
const char *ck_name_hint(char *out, size_t size, const char *typed, ck_NameAt name_at, const void *table);

// Writes all names, with commas between them. Returns out.
const char *ck_name_list(char *out, size_t size, ck_NameAt name_at, const void *table);

// Texts of others, as reasons quote them: where one is no UTF-8, its bytes beyond ASCII become question marks.
// Source: RFC 3629.
void ck_text_plain(char *text);

// Writes a word as a shell reads it: plain where it can be, else in quotes, with control characters as $'\n' has them.
// Returns how long that is, less than size, where what does not fit is cut off.
size_t ck_text_shell(char *out, size_t size, const char *word);

#endif
