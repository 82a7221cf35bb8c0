#include "study_command.h"

#include "hash.h"
#include "path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What was asked, in words that tell it apart from anything else: the command without what only says where and how
// fast, the scene's text and the program. Words stand between tabs, as they may hold spaces.
static void write_question(ck_StudyCommand *command, int argc, char **argv) {
    static const char *const silent[] = {"--out", "--jobs", "--shard"};
    const ck_Document *document = &command->comparison->scene.document;
    size_t size = sizeof command->question, used = 0;
    for (int i = 0; i < argc && used < size; i++) {
        bool is_silent = false;
        for (size_t k = 0; k < sizeof silent / sizeof *silent; k++) is_silent |= !strcmp(argv[i], silent[k]);
        if (is_silent)
            i++;
        else
            used += (size_t)snprintf(command->question + used, size - used, "%s%s", used ? "\t" : "", argv[i]);
    }
    if (used < size)
        snprintf(command->question + used, size - used, "\t(scene %016llx, clothcheck %s)",
                 (unsigned long long)ck_hash(CK_HASH_START, document->text, document->length), CK_VERSION);
}

static ck_Status find_truth(ck_Comparison *comparison, const ck_Arguments *arguments, ck_Error *error) {
    char *cache = ck_path_join(arguments->out, "truths");
    if (!cache) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_truth_create(&comparison->truth, &comparison->model, cache, error);
    free(cache);
    return status;
}

int ck_study_command(int argc, char **argv, const char *help, unsigned groups, double seconds,
                     ck_Status (*run)(const ck_StudyCommand *command, ck_Error *error)) {
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help")) {
            printf("%s\n\n", help);
            ck_arguments_help(groups);
            return CK_EXIT_OK;
        }
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Comparison comparison = {0};
    char **given = malloc(sizeof *given * (size_t)argc);
    if (given) memcpy(given, argv, sizeof *given * (size_t)argc); // getopt moves what it reads
    ck_Status status = ck_arguments_read(&arguments, argc, argv, groups, &error);
    if (!arguments.out) arguments.out = "out";
    if (arguments.options.limits.seconds == ck_limits_default().seconds) arguments.options.limits.seconds = seconds;
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "%s takes one SCENE; %d are given", argv[0], arguments.scene_count);
    if (!status && !given) status = ck_fail(&error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_comparison_load(&comparison, arguments.scenes[0], &error);
    ck_command_catch_signals();
    int failed = status ? 0 : ck_path_make(arguments.out);
    if (failed) status = ck_fail(&error, CK_IO, "%s: %s", arguments.out, strerror(failed));
    if (!status) status = find_truth(&comparison, &arguments, &error);
    if (!status) {
        ck_StudyCommand command = {.arguments = &arguments, .comparison = &comparison};
        write_question(&command, argc, given);
        status = run(&command, &error);
    }
    ck_comparison_free(&comparison);
    ck_arguments_free(&arguments);
    free(given);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

static ck_StudyOptions options_of(const ck_StudyCommand *command, int jobs) {
    const ck_Arguments *arguments = command->arguments;
    int wanted = arguments->jobs ? arguments->jobs : jobs ? jobs : (int)sysconf(_SC_NPROCESSORS_ONLN);
    return (ck_StudyOptions){arguments->out,   command->question, wanted > 0 ? wanted : 1,
                             arguments->shard, arguments->shards, isatty(STDERR_FILENO)};
}

ck_Status ck_study_command_run(const ck_StudyCommand *command, const ck_Study *study, int jobs, ck_JournalRow **rows,
                               ck_Error *error) {
    const ck_StudyOptions options = options_of(command, jobs);
    *rows = calloc((size_t)study->case_count + 1, sizeof **rows);
    if (!*rows) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    return ck_study_run(study, &options, *rows, error);
}

void ck_study_command_free(ck_JournalRow *rows) {
    free(rows);
}

void ck_study_command_done(const ck_StudyCommand *command, const ck_Study *study, const char *files) {
    const ck_StudyOptions options = options_of(command, 1);
    if (options.shards <= 1) ck_study_forget(study, &options);
    printf("CSVs: %s/{%s}\n", options.directory, files);
}
