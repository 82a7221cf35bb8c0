#include "command.h"
#include "study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_WORDS 128

// Runs the parts' own command: all its cases are there, so that it only writes what one run would have written.
static int run_question(char *question, const char *out) {
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } studies[] = {
        {"precision", ck_command_precision}, {"stability", ck_command_stability}, {"needs", ck_command_needs}};
    char *words[MAX_WORDS + 4];
    int count = 0;
    char *end = strstr(question, "\t(scene ");
    if (end) *end = 0;
    for (char *word = strtok(question, "\t"); word && count < MAX_WORDS; word = strtok(NULL, "\t"))
        words[count++] = word;
    words[count++] = "--kept";
    words[count++] = "--out";
    words[count++] = (char *)out;
    words[count] = NULL;
    for (size_t i = 0; i < sizeof studies / sizeof *studies; i++)
        if (!strcmp(words[0], studies[i].name)) return studies[i].run(count, words);
    fprintf(stderr, "clothcheck: there is no study %s to write\n", words[0]);
    return CK_EXIT_USAGE;
}

// The study whose journal a directory holds.
static const char *find_study(const char *directory, char *question, size_t size, ck_Error *error) {
    static const char *const names[] = {"precision", "stability", "needs"};
    char name[64];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(name, sizeof name, "%s.journal", names[i]);
        if (!ck_journal_question(directory, name, question, size, error)) return names[i];
    }
    return NULL;
}

int ck_command_merge(int argc, char **argv) {
    if (argc < 3 || !strcmp(argv[1], "--help")) {
        fprintf(argc < 3 && (argc < 2 || strcmp(argv[1], "--help")) ? stderr : stdout,
                "clothcheck merge OUT DIR...\n\nJoins the parts of a study that were run with --shard into DIR..., and "
                "writes into OUT what one run would have\nwritten.\n");
        return argc >= 2 && !strcmp(argv[1], "--help") ? CK_EXIT_OK : CK_EXIT_USAGE;
    }
    ck_Error error = {0};
    char question[4096];
    const char *study = find_study(argv[2], question, sizeof question, &error);
    ck_Status status =
        study ? CK_OK : ck_fail(&error, CK_BAD_INPUT, "%s: holds no part of a study (NAME.journal)", argv[2]);
    if (!status) status = ck_study_merge(argv[1], study, (const char *const *)argv + 2, argc - 2, &error);
    return status ? ck_command_fail(status, &error) : run_question(question, argv[1]);
}
