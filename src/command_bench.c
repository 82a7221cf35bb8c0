#include "bench.h"
#include "command.h"
#include "path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void show_progress(const char *body, const char *engine) {
    fprintf(stderr, "\r\033[K%s: %s", body, engine);
}

static void print_help(void) {
    printf("clothcheck bench [--out DIR] [--rounds N] [--largest N]\n\nTimes all engines, interleaved, on cloths of "
           "20x20, "
           "64x64 and 256x256 and a rope of 1000, and native-verlet\nas a cloth grows; writes bench.csv.\n\n"
           "  --out DIR      write the CSV into DIR (default out)\n"
           "  --rounds N     repeats, 1 to 99 (default 7)\n"
           "  --largest N    side of the largest cloth in the growth, 16 to 2048 (default 1024)\n"
           "  --help         this text\n");
}

static ck_Status read_count(int *count, const char *option, const char *text, int low, int high, ck_Error *error) {
    char *end;
    long value = strtol(text, &end, 10);
    if (end == text || *end || value < low || value > high)
        return ck_fail(error, CK_BAD_INPUT, "%s %s: it must be a whole number from %d to %d", option, text, low, high);
    *count = (int)value;
    return CK_OK;
}

static ck_Status read_arguments(int argc, char **argv, ck_BenchOptions *options, const char **out, ck_Error *error) {
    ck_Status status = CK_OK;
    for (int i = 1; i < argc && !status; i += 2) {
        bool has_value = i + 1 < argc;
        if (has_value && !strcmp(argv[i], "--out"))
            *out = argv[i + 1];
        else if (has_value && !strcmp(argv[i], "--rounds"))
            status = read_count(&options->rounds, argv[i], argv[i + 1], 1, 99, error);
        else if (has_value && !strcmp(argv[i], "--largest"))
            status = read_count(&options->largest, argv[i], argv[i + 1], 16, 2048, error);
        else
            status = ck_fail(error, CK_BAD_INPUT, "%s: bench takes --out DIR, --rounds N and --largest N", argv[i]);
    }
    return status;
}

int ck_command_bench(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help")) {
            print_help();
            return CK_EXIT_OK;
        }
    ck_BenchOptions options = {.rounds = 7, .budget = 20, .largest = 1024};
    if (isatty(STDERR_FILENO)) options.progress = show_progress;
    const char *out = "out";
    ck_Error error = {0};
    ck_Csv csv = {0};
    ck_Status status = read_arguments(argc, argv, &options, &out, &error);
    int failed = status ? 0 : ck_path_make(out);
    if (failed) status = ck_fail(&error, CK_IO, "%s: %s", out, strerror(failed));
    if (!status) status = ck_csv_open(&csv, out, &ck_layouts[CK_BENCH], &error);
    if (!status) status = ck_bench_write(&csv, &options, &error);
    if (options.progress) fprintf(stderr, "\r\033[K");
    if (!status) status = ck_csv_close(&csv, &error);
    ck_csv_discard(&csv);
    if (status) return ck_command_fail(status, &error);
    printf("CSV: %s/bench.csv\n", out);
    return CK_EXIT_OK;
}
