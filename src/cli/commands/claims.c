#include "claims.h"
#include "command.h"
#include "files.h"
#include "process.h"
#include "tables.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void show_progress(const char *claim, double value) {
    ck_progress_show("%s: %g", claim, value);
}

static ck_Status write_tables(const char *out, ck_Error *error) {
    ck_Csv claims = {0}, quirks = {0};
    char data[4000], scenes[4096];
    int failed = ck_path_make(out);
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", out, strerror(failed)) : CK_OK;
    if (!ck_path_data(data, sizeof data) && !status)
        status = ck_fail(error, CK_IO, "%s: is not there; it must hold the origins' scenes", data);
    snprintf(scenes, sizeof scenes, "%s/scenes", data);
    if (!status) status = ck_csv_open(&quirks, out, &ck_layouts[CK_QUIRKS], error);
    if (!status) status = ck_csv_open(&claims, out, &ck_layouts[CK_CLAIMS], error);
    if (!status) status = ck_quirks_write(&quirks, scenes, error);
    if (!status) status = ck_claims_write(&claims, scenes, show_progress, error);
    ck_progress_clear();
    if (!status) status = ck_csv_close(&quirks, error);
    if (!status) status = ck_csv_close(&claims, error);
    ck_csv_discard(&quirks);
    ck_csv_discard(&claims);
    return status;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    const char *out = arguments.out;
    ck_command_catch_signals();
    if (!status) status = write_tables(out, &error);
    if (!status) status = ck_machine_save(out, &error);
    if (!status) status = ck_answer_quirks(&arguments.answer, out, &error);
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_FILES, "%s/{claims.csv, quirks.csv}", out);
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck report %s", out);
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_claims = {
    .name = "claims",
    .arguments = "",
    .about = "what was claimed of the two origins, and what their quirks cost",
    .help = "Tests what was claimed of the two origins: writes claims.csv, sweeps over what each claim leaves open, "
            "and\nquirks.csv, what each of their quirks costs, into --out. Takes some minutes.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT,
    .out = "out",
    .run = run,
};
