#include "answer.h"

#include "names.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What stands before and after a sentence, and its list in JSON.
typedef struct LineForm {
    const char *key, *before, *markdown_before, *markdown_after;
} LineForm;

static const LineForm lines[CK_ANSWER_LINES] = {
    [CK_ANSWER_SAYS] = {"answers", "=> ", "\n**", "**\n"},
    [CK_ANSWER_NOTE] = {"notes", "  ", "- ", "\n"},
    [CK_ANSWER_FILES] = {"files", "CSVs: ", "\nCSVs: ", "\n"},
    [CK_ANSWER_NEXT] = {"next", "Next: ", "\nNext: `", "`\n"},
};

// JSON holds UTF-8 alone.
static json_t *string_of(const char *text) {
    char *plain = strdup(text);
    if (!plain) return NULL;
    ck_text_plain(plain);
    json_t *string = json_string(plain);
    free(plain);
    return string;
}

// Takes over item; jansson returns nothing but that it failed where there is no memory.
static void add_item(ck_Answer *answer, json_t *list, json_t *item) {
    if (!item || json_array_append_new(list, item)) answer->has_failed = true;
}

static json_t *list_of(ck_Answer *answer, const char *key) {
    json_t *list = json_object_get(answer->root, key);
    if (list) return list;
    list = json_array();
    if (!list || json_object_set_new(answer->root, key, list)) answer->has_failed = true;
    return list;
}

void ck_answer_open(ck_Answer *answer, ck_AnswerForm form, const char *command) {
    *answer = (ck_Answer){.form = form};
    if (form != CK_ANSWER_JSON) return;
    answer->root = json_pack("{s:s, s:s}", "command", command, "version", CK_VERSION);
    answer->has_failed = !answer->root;
}

static void start_markdown(const ck_AnswerColumn *columns) {
    printf("|");
    for (int i = 0; columns[i].key; i++) printf(" %s |", columns[i].title);
    printf("\n|");
    for (int i = 0; columns[i].key; i++) printf(columns[i].format ? "---:|" : "---|");
    printf("\n");
}

void ck_answer_table(ck_Answer *answer, const char *key, const char *title, const ck_AnswerColumn *columns) {
    answer->columns = columns;
    answer->column = 0;
    if (answer->form == CK_ANSWER_JSON) {
        answer->rows = list_of(answer, key);
        return;
    }
    bool is_markdown = answer->form == CK_ANSWER_MARKDOWN;
    if (title) printf(is_markdown ? "\n%s\n\n" : "%s\n", title);
    if (is_markdown && !title) printf("\n");
    if (is_markdown) {
        start_markdown(columns);
        return;
    }
    for (int i = 0; columns[i].key; i++) printf("%s%*s", i ? " " : "", columns[i].width, columns[i].title);
    printf("\n");
}

static void put_cell(ck_Answer *answer, const char *text) {
    const ck_AnswerColumn *column = &answer->columns[answer->column++];
    bool is_first = answer->column == 1, is_last = !answer->columns[answer->column].key;
    if (answer->form == CK_ANSWER_TERMINAL)
        printf("%s%*s%s", is_first ? "" : " ", is_last && column->width < 0 ? 0 : column->width, text,
               is_last ? "\n" : "");
    else {
        printf(is_first ? "| " : " ");
        for (; *text; text++) printf(*text == '|' ? "\\%c" : "%c", *text);
        printf(is_last ? " |\n" : " |");
    }
    if (is_last) answer->column = 0;
}

static void put_json(ck_Answer *answer, json_t *value) {
    if (!answer->column) {
        answer->row = json_object();
        add_item(answer, answer->rows, answer->row);
    }
    if (!value || json_object_set_new(answer->row, answer->columns[answer->column++].key, value))
        answer->has_failed = true;
    if (!answer->columns[answer->column].key) answer->column = 0;
}

void ck_answer_text(ck_Answer *answer, const char *text) {
    if (answer->has_failed) return;
    if (answer->form == CK_ANSWER_JSON)
        put_json(answer, string_of(text));
    else
        put_cell(answer, text);
}

void ck_answer_number(ck_Answer *answer, double number) {
    char text[40] = "-";
    if (answer->has_failed) return;
    if (answer->form == CK_ANSWER_JSON) {
        // JSON has no infinity either
        put_json(answer, isfinite(number) ? json_real(number) : json_null());
        return;
    }
    const char *format = answer->columns[answer->column].format;
    // what does not fit into a column of decimals is told in three digits
    if (!isnan(number)) snprintf(text, sizeof text, fabs(number) < 1e6 ? format : "%.3g", number);
    put_cell(answer, text);
}

void ck_answer_line(ck_Answer *answer, ck_AnswerLine kind, const char *format, ...) {
    char text[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const LineForm *form = &lines[kind];
    if (answer->has_failed) return;
    if (answer->form == CK_ANSWER_JSON)
        add_item(answer, list_of(answer, form->key), string_of(text));
    else if (answer->form == CK_ANSWER_MARKDOWN)
        printf("%s%s%s", form->markdown_before, text, form->markdown_after);
    else
        printf("%s%s\n", form->before, text);
}

void ck_answer_block(ck_Answer *answer, const char *key, const char *text) {
    if (answer->has_failed) return;
    if (answer->form != CK_ANSWER_JSON)
        printf(answer->form == CK_ANSWER_MARKDOWN ? "\n```\n%s```\n" : "%s", text);
    else if (json_object_set_new(answer->root, key, string_of(text)))
        answer->has_failed = true;
}

void ck_answer_gap(ck_Answer *answer) {
    if (answer->form == CK_ANSWER_JSON) return;
    printf("\n");
    fflush(stdout);
}

ck_Status ck_answer_close(ck_Answer *answer, ck_Error *error) {
    char *text = NULL;
    ck_Status status = CK_OK;
    if (answer->root && !answer->has_failed) text = json_dumps(answer->root, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    if (answer->form == CK_ANSWER_JSON && !text) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (text) printf("%s\n", text);
    free(text);
    if (!status && (fflush(stdout) || ferror(stdout)))
        status = ck_fail(error, CK_IO, "standard output: %s", strerror(errno));
    ck_answer_discard(answer);
    return status;
}

void ck_answer_discard(ck_Answer *answer) {
    json_decref(answer->root);
    answer->root = NULL;
}
