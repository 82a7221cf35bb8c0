#include "bench.h"
#include "command.h"
#include "files.h"
#include "process.h"
#include "tables.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void show_progress(const char *body, const char *engine) {
    ck_progress_show("%s: %s", body, engine);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Arguments arguments;
    ck_Error error = {0};
    ck_Csv csv = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    const char *out = arguments.out;
    ck_BenchOptions options = {.rounds = arguments.rounds,
                               .budget = 20,
                               .largest = arguments.largest,
                               .only = arguments.only,
                               .progress = show_progress};
    int failed = status ? 0 : ck_path_make(out);
    if (failed) status = ck_fail(&error, CK_IO, "%s: %s", out, strerror(failed));
    if (!status) status = ck_csv_open(&csv, out, &ck_layouts[CK_BENCH], &error);
    ck_command_catch_signals();
    if (!status) status = ck_bench_write(&csv, &options, &error);
    ck_progress_clear();
    if (!status) status = ck_csv_close(&csv, &error);
    if (!status) status = ck_machine_save(out, &error);
    ck_csv_discard(&csv);
    if (!status) status = ck_answer_bench(&arguments.answer, out, &error);
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_FILES, "%s/bench.csv", out);
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck report %s", out);
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_bench = {
    .name = "bench",
    .arguments = "",
    .about = "how fast the engines are: per spring, per step, and as a cloth grows",
    .help =
        "Times all engines, interleaved, on cloths of 20x20, 64x64 and 256x256, on those of 20x20 and 64x64 slung\n"
        "around a ball, on meshes of 289, 3,025 and 29,929 nodes, a rope of 1000 and 128 ropes of 32, and\n"
        "native-verlet as a cloth grows. Of cloths of 20x20 and 64x64 that are let go, with springs of 1e3 and 1e6\n"
        "N/m, each engine's cheapest settings within 1 % and 0.1 % of a fine reference: `bench --only costs`. Writes\n"
        "bench.csv into --out.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_BENCH,
    .out = "out",
    .run = run,
};
