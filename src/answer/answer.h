// A command's answer: tables, sentences and the next command to type, for a terminal, as Markdown or as JSON.
#ifndef CK_ANSWER_H
#define CK_ANSWER_H

#include "status.h"

#include <stdbool.h>

typedef enum ck_AnswerForm { CK_ANSWER_TERMINAL, CK_ANSWER_MARKDOWN, CK_ANSWER_JSON } ck_AnswerForm;

// One kind of sentence. In JSON each is a list of its own.
typedef enum ck_AnswerLine {
    CK_ANSWER_SAYS,  // what the command was asked for
    CK_ANSWER_NOTE,  // what should be known beside it
    CK_ANSWER_FILES, // what was written
    CK_ANSWER_NEXT,  // a command to type next
    CK_ANSWER_LINES
} ck_AnswerLine;

typedef struct ck_AnswerColumn {
    const char *key;    // in JSON; NULL: there is no more
    const char *title;  // on the terminal and in Markdown
    int width;          // on the terminal; negative: to the left
    const char *format; // of a number on the terminal and in Markdown; NULL: the column holds text
} ck_AnswerColumn;

struct json_t;

typedef struct ck_Answer {
    ck_AnswerForm form;
    struct json_t *root, *rows, *row; // of JSON: all of it, the table and the row begun
    bool has_failed;                  // there was no memory for JSON
    const ck_AnswerColumn *columns;   // of the table begun
    int column;
} ck_Answer;

// Starts the answer of a command. End with ck_answer_close or ck_answer_discard.
void ck_answer_open(ck_Answer *answer, ck_AnswerForm form, const char *command);

// Starts a table. In JSON rows join those of an earlier table of that key.
//   title  a line above it, not in JSON; NULL: none;  columns  must outlive the answer
void ck_answer_table(ck_Answer *answer, const char *key, const char *title, const ck_AnswerColumn *columns);

// The next cell of the table; a row ends by itself. NaN is a dash, and null in JSON.
void ck_answer_text(ck_Answer *answer, const char *text);
void ck_answer_number(ck_Answer *answer, double number);

// A sentence of a kind.
void ck_answer_line(ck_Answer *answer, ck_AnswerLine kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Lines to copy, as of a scene file; they end with a newline.
void ck_answer_block(ck_Answer *answer, const char *key, const char *text);

// An empty line, between scenes; nothing in JSON.
void ck_answer_gap(ck_Answer *answer);

// Writes what is left of it to stdout. Errors: CK_NO_MEMORY, CK_IO.
ck_Status ck_answer_close(ck_Answer *answer, ck_Error *error);

// Frees it. Accepts a zeroed or closed one.
void ck_answer_discard(ck_Answer *answer);

#endif
