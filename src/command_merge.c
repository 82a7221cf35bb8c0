#include "command.h"
#include "study.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_WORDS 128

static const struct Mergeable {
    const char *name;
    int (*run)(int argc, char **argv);
} studies[] = {{"precision", ck_command_precision}, {"stability", ck_command_stability}, {"needs", ck_command_needs}};
#define STUDIES (sizeof studies / sizeof *studies)

// Runs the parts' own command: all its cases are there, so that it only writes what one run would have written.
static int run_question(const struct Mergeable *study, char *question, const char *out) {
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
    return study->run(count, words);
}

// The study whose journal a directory holds; NULL where there is none.
static const struct Mergeable *find_study(const char *directory, char *question, size_t size) {
    char name[64];
    for (size_t i = 0; i < STUDIES; i++) {
        snprintf(name, sizeof name, "%s.journal", studies[i].name);
        if (!ck_journal_question(directory, name, question, size, NULL)) return &studies[i];
    }
    return NULL;
}

static bool is_among(const char *directory, char *const *parts, int count) {
    char one[PATH_MAX], other[PATH_MAX];
    for (int i = 0; i < count; i++)
        if (realpath(directory, one) && realpath(parts[i], other) && !strcmp(one, other)) return true;
    return false;
}

int ck_command_merge(int argc, char **argv) {
    bool asks_help = argc > 1 && !strcmp(argv[1], "--help");
    if (argc < 3 || asks_help) {
        fprintf(asks_help ? stdout : stderr,
                "clothcheck merge OUT DIR...\n\nJoins the parts of a study that were run with --shard into DIR..., and "
                "writes into OUT what one run would have\nwritten.\n");
        return asks_help ? CK_EXIT_OK : CK_EXIT_USAGE;
    }
    ck_Error error = {0};
    char question[4096];
    if (is_among(argv[1], argv + 2, argc - 2)) {
        ck_Status same =
            ck_fail(&error, CK_BAD_INPUT, "%s: is a part, too; OUT must be a directory of its own", argv[1]);
        return ck_command_fail(same, &error);
    }
    const struct Mergeable *study = find_study(argv[2], question, sizeof question);
    ck_Status status =
        study ? CK_OK : ck_fail(&error, CK_BAD_INPUT, "%s: holds no part of a study (NAME.journal)", argv[2]);
    if (!status) status = ck_study_merge(argv[1], study->name, (const char *const *)argv + 2, argc - 2, &error);
    return status ? ck_command_fail(status, &error) : run_question(study, question, argv[1]);
}
