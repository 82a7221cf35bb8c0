#include "studies.h"

#include "files.h"
#include "sweeps.h"
#include "tables.h"
#include "tune.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What was asked, the scene's text and the program: what tells a journal's cases apart from anything else.
static void write_question(ck_StudyCommand *command) {
    const ck_Document *document = &command->comparison->scene.document;
    snprintf(command->question, sizeof command->question, "%s\t(scene %016llx, %s)" CK_JOURNAL_PLACE "%s",
             command->arguments->question, (unsigned long long)ck_hash(CK_HASH_START, document->text, document->length),
             ck_machine_build(), command->comparison->path);
}

static ck_Status find_truth(ck_Comparison *comparison, const ck_Arguments *arguments, ck_Error *error) {
    char *cache = ck_path_join(arguments->out, "truths");
    if (!cache) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status =
        ck_truth_create(&comparison->truth, &comparison->model, cache, &arguments->options.limits, error);
    free(cache);
    return status;
}

ck_Status ck_study_command_open(const ck_StudyCommand *command, ck_Csv *csv, ck_LayoutName layout, ck_Error *error) {
    ck_Status status = ck_csv_open(csv, command->arguments->out, &ck_layouts[layout], error);
    if (status || !command->arguments->appends) return status;
    return ck_kept_copy(&command->kept, csv, &ck_layouts[layout], error);
}

int ck_study_command(const ck_Command *command, ck_LayoutName layout, int argc, char **argv,
                     ck_Status (*run)(const ck_StudyCommand *command, ck_Error *error)) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Comparison comparison = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    // each of several is a case of a study
    for (int i = 0; i < CK_STUDY_RUNS && !status && arguments.scene_count > 1; i++)
        if (!strcmp(ck_study_runs[i], argv[0])) return ck_sweeps_of_scenes(&arguments, (ck_StudyRun)i);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "%s takes one SCENE; %d are given", argv[0], arguments.scene_count);
    if (!status) status = ck_comparison_load(&comparison, arguments.scenes[0], &error);
    ck_command_catch_signals();
    int failed = status ? 0 : ck_path_make(arguments.out);
    if (failed) status = ck_fail(&error, CK_IO, "%s: %s", arguments.out, strerror(failed));
    ck_StudyCommand study = {.arguments = &arguments,
                             .answer = &arguments.answer,
                             .comparison = &comparison,
                             .kept = {arguments.out, &comparison, 1, &arguments.options, layout == CK_TUNE}};
    if (!status && !arguments.forces)
        status = ck_kept_check(&study.kept, &ck_layouts[layout], arguments.appends, &error);
    // before anything that takes time
    if (!status && layout == CK_TUNE && !arguments.like && !arguments.target)
        status = ck_tune_check(&comparison, arguments.error, &error);
    if (!status) status = find_truth(&comparison, &arguments, &error);
    if (!status) {
        write_question(&study);
        status = run(&study, &error);
    }
    if (!status) status = ck_machine_save(arguments.out, &error);
    ck_comparison_free(&comparison);
    return ck_command_end(&arguments, status, &error);
}

static ck_StudyOptions options_of(const ck_StudyCommand *command, int jobs) {
    const ck_Arguments *arguments = command->arguments;
    int wanted = arguments->options.jobs ? arguments->options.jobs : jobs ? jobs : (int)sysconf(_SC_NPROCESSORS_ONLN);
    return (ck_StudyOptions){arguments->out,   command->question, wanted > 0 ? wanted : 1,
                             arguments->shard, arguments->shards, arguments->runs_nothing};
}

ck_Status ck_study_command_run(const ck_StudyCommand *command, const ck_Study *study, int jobs, ck_JournalRow **rows,
                               ck_Error *error) {
    const ck_StudyOptions options = options_of(command, jobs);
    *rows = calloc((size_t)study->case_count + 1, sizeof **rows);
    if (!*rows) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    return ck_study_run(study, &options, *rows, error);
}

void ck_study_command_done(const ck_StudyCommand *command, const ck_Study *study, const char *files) {
    const ck_StudyOptions options = options_of(command, 1);
    if (options.shards <= 1) ck_study_forget(study, &options);
    ck_answer_line(command->answer, CK_ANSWER_FILES, "%s/{%s}", options.directory, files);
    ck_answer_line(command->answer, CK_ANSWER_NEXT, "clothcheck report %s", options.directory);
}
