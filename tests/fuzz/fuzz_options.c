// Command lines: words between line ends, of the command that the first byte chooses. No program is started for them.
#include "fuzz.h"

#include "command.h"
#include "outside.h"

#define WORDS 60

static const ck_Command *const commands[] = {
    &ck_command_compare, &ck_command_run,  &ck_command_check,  &ck_command_precision, &ck_command_tune,
    &ck_command_study,   &ck_command_fit,  &ck_command_bench,  &ck_command_score,     &ck_command_view,
    &ck_command_film,    &ck_command_code, &ck_command_report, &ck_command_means,     &ck_command_export,
};

ck_Status ck_outside_command(ck_Engine **engine, const char *name, const char *line, bool is_known, ck_Error *error) {
    (void)engine, (void)name, (void)line, (void)is_known;
    return ck_fail(error, CK_BAD_INPUT, "no programs here");
}

ck_Status ck_outside_library(ck_Engine **engine, const char *name, const char *path, ck_Error *error) {
    (void)engine, (void)name, (void)path;
    return ck_fail(error, CK_BAD_INPUT, "no libraries here");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *words[WORDS + 1], *text = calloc(size + 1, 1), *rest = text;
    int count = 0;
    ck_Arguments arguments;
    ck_Error error = {0};
    if (!text || !size) {
        free(text);
        return 0;
    }
    const ck_Command *command = commands[data[0] % (sizeof commands / sizeof *commands)];
    memcpy(text, data + 1, size - 1);
    // no folder is made elsewhere
    for (size_t i = 0; i + 1 < size; i++)
        if (text[i] == '/' || !text[i]) text[i] = '_';
    words[count++] = (char *)command->name;
    for (char *word; count < WORDS && (word = strsep(&rest, "\n"));) words[count++] = word;
    words[count] = NULL;
    const ck_Status status = ck_arguments_read(&arguments, command, count, words, &error);
    if (status && !*error.message) abort();
    ck_arguments_free(&arguments);
    free(text);
    return 0;
}
