// One line on the terminal that says how far a long command has come.
#ifndef CK_PROGRESS_H
#define CK_PROGRESS_H

// Writes the line over the last one, on stderr; nothing where that is no terminal.
void ck_progress_show(const char *format, ...) __attribute__((format(printf, 1, 2)));

// Takes the line away.
void ck_progress_clear(void);

#endif
