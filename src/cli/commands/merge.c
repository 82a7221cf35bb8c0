#include "command.h"
#include "files.h"
#include "join.h"
#include "needs.h"
#include "precision.h"
#include "refine.h"
#include "stability_study.h"
#include "sweep.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_WORDS 128

typedef struct Kind {
    const ck_Command *command;
    ck_ValueName name_at; // of the values of its journal
} Kind;

static const Kind studies[] = {{&ck_command_precision, ck_precision_value},
                               {&ck_command_stability, ck_stability_value},
                               {&ck_command_needs, ck_needs_value},
                               {&ck_command_refine, ck_refine_value}};
#define STUDIES (sizeof studies / sizeof *studies)

// Runs the parts' own command: all its cases are there, so that it only writes what one run would have written.
static int run_question(const ck_Command *study, char *question, const char *scene, const char *out) {
    char *words[MAX_WORDS + 5];
    int count = 0;
    *strstr(question, "\t(scene ") = 0;
    for (char *word = strtok(question, "\t"); word && count < MAX_WORDS; word = strtok(NULL, "\t"))
        words[count++] = word;
    words[count++] = (char *)scene;
    words[count++] = "--kept";
    words[count++] = "--out";
    words[count++] = (char *)out;
    words[count] = NULL;
    return study->run(study, count, words);
}

// The study whose journal a directory holds; NULL where there is none.
static const Kind *find_study(const char *directory, char *question, size_t size) {
    char name[64];
    for (size_t i = 0; i < STUDIES; i++) {
        snprintf(name, sizeof name, "%s.journal", studies[i].command->name);
        if (!ck_journal_question(directory, name, question, size, NULL)) return &studies[i];
    }
    return NULL;
}

// Where the scene is that the question was asked of: as its hash says, whatever the file is called. False: not there.
static bool is_scene(const char *question) {
    unsigned long long wanted;
    const char *hash = strstr(question, "\t(scene "), *place = strstr(question, CK_JOURNAL_PLACE);
    ck_Scene scene = {0};
    if (!hash || !place || sscanf(hash, "\t(scene %16llx", &wanted) != 1) return false;
    ck_Status status = ck_scene_load(&scene, place + strlen(CK_JOURNAL_PLACE), NULL);
    bool is_same = !status && ck_hash(CK_HASH_START, scene.document.text, scene.document.length) == wanted;
    ck_scene_free(&scene);
    return is_same;
}

// The first of the parts whose scene file can be read here and is what it was; its question says where.
static ck_Status find_scene(const ck_Command *study, char *const *parts, int count, char *question, size_t size,
                            ck_Error *error) {
    char name[64];
    snprintf(name, sizeof name, "%s.journal", study->name);
    for (int i = 0; i < count; i++)
        if (!ck_journal_question(parts[i], name, question, size, NULL) && is_scene(question)) return CK_OK;
    const char *place = strstr(question, CK_JOURNAL_PLACE);
    return ck_fail(error, CK_BAD_INPUT,
                   "%s: is not there, or not as it was when %s was asked of it; merge in the folder where that was",
                   place ? place + strlen(CK_JOURNAL_PLACE) : "the scene", study->name);
}

static bool is_among(const char *directory, char *const *parts, int count) {
    char one[PATH_MAX], other[PATH_MAX];
    for (int i = 0; i < count; i++)
        if (realpath(directory, one) && realpath(parts[i], other) && !strcmp(one, other)) return true;
    return false;
}

static ck_Status check_parts(const ck_Arguments *arguments, ck_Error *error) {
    if (arguments->word_count < 2)
        return ck_fail(error, CK_BAD_INPUT, "merge takes OUT and the DIRs of the parts; %d are given",
                       arguments->word_count);
    if (is_among(arguments->words[0], arguments->words + 1, arguments->word_count - 1))
        return ck_fail(error, CK_BAD_INPUT, "%s: is a part, too; OUT must be a directory of its own",
                       arguments->words[0]);
    return CK_OK;
}

static bool has_cases(const char *part) {
    char *folder = ck_sweep_folder(part);
    const bool has = folder && !access(folder, F_OK);
    free(folder);
    return has;
}

// Parts that are no journal of a study of one scene: cases of a study of many, or a comparison's CSVs.
static int join(ck_Arguments *arguments, bool is_study) {
    ck_Error error = {0};
    char **parts = arguments->words + 1, *out = arguments->words[0];
    const int count = arguments->word_count - 1;
    ck_Status status = CK_OK;
    for (int i = 0; i < count && !status; i++)
        if (has_cases(parts[i]) != is_study)
            status = ck_fail(&error, CK_BAD_INPUT, "%s and %s are not parts of one command", parts[0], parts[i]);
    if (!status && ck_join_is_part(out) && (!is_study || !has_cases(out)))
        status = ck_fail(&error, CK_BAD_INPUT, "%s: holds results, which would be lost; give another OUT", out);
    if (!status) status = is_study ? ck_sweep_merge(out, parts, count, &error) : ck_join(out, parts, count, &error);
    if (!status && is_study) {
        ck_answer_line(&arguments->answer, CK_ANSWER_SAYS, "%s: has the cases of all parts", out);
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT,
                       "the command of the parts, with --out %s --kept in place of --shard", out);
    } else if (!status) {
        ck_answer_line(&arguments->answer, CK_ANSWER_FILES, "%s", out);
        ck_answer_line(&arguments->answer, CK_ANSWER_NEXT, "clothcheck report %s", out);
    }
    return ck_command_end(arguments, status, &error);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    char question[4096];
    const Kind *study = NULL;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    char **parts = arguments.words + 1;
    int count = arguments.word_count - 1;
    if (!status) status = check_parts(&arguments, &error);
    if (!status) status = ck_out_folder_claim(&arguments.folder, arguments.words[0], false, &error);
    if (!status) {
        if (has_cases(parts[0])) return join(&arguments, true);
        study = find_study(parts[0], question, sizeof question);
        if (!study && ck_join_is_part(parts[0])) return join(&arguments, false);
        if (!study) status = ck_fail(&error, CK_BAD_INPUT, "%s: holds no part of a study or of a comparison", parts[0]);
    }
    if (!status)
        status = ck_study_merge(arguments.words[0], study->command->name, study->name_at, (const char *const *)parts,
                                count, &error);
    if (!status) status = find_scene(study->command, parts, count, question, sizeof question, &error);
    char *out = arguments.word_count ? arguments.words[0] : NULL;
    ck_arguments_free(&arguments);
    if (status) return ck_command_fail(status, &error);
    char *place = strstr(question, CK_JOURNAL_PLACE);
    return run_question(study->command, question, place + strlen(CK_JOURNAL_PLACE), out);
}

const ck_Command ck_command_merge = {
    .name = "merge",
    .arguments = "OUT DIR...",
    .about = "joins the parts of a study or a comparison that was run with --shard",
    .help = "Joins the parts of a study or a comparison that were run with --shard into DIR..., and writes into OUT "
            "what one run would "
            "have\nwritten. Parts are of one study when they were asked the same of the same scene text, wherever its "
            "file was.",
    .run = run,
};
