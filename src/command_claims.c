#include "claims.h"
#include "command.h"
#include "path.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void show_progress(const char *claim, double value) {
    fprintf(stderr, "\r\033[K%s: %g", claim, value);
}

static void print_help(void) {
    printf("clothcheck claims [--out DIR]\n\nTests what was claimed of the two origins: writes claims.csv, sweeps over "
           "what each claim leaves open, and\nquirks.csv, what each of their quirks costs, into DIR (default out). "
           "Takes some minutes.\n\n"
           "  --out DIR   write the CSVs into DIR\n  --help      this text\n");
}

static ck_Status write_tables(const char *out, ck_Error *error) {
    ck_Csv claims = {0}, quirks = {0};
    int failed = ck_path_make(out);
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", out, strerror(failed)) : CK_OK;
    if (!status) status = ck_csv_open(&quirks, out, &ck_layouts[CK_QUIRKS], error);
    if (!status) status = ck_csv_open(&claims, out, &ck_layouts[CK_CLAIMS], error);
    if (!status) status = ck_quirks_write(&quirks, "scenes", error);
    if (!status) status = ck_claims_write(&claims, "scenes", isatty(STDERR_FILENO) ? show_progress : NULL, error);
    if (isatty(STDERR_FILENO)) fprintf(stderr, "\r\033[K");
    if (!status) status = ck_csv_close(&quirks, error);
    if (!status) status = ck_csv_close(&claims, error);
    ck_csv_discard(&quirks);
    ck_csv_discard(&claims);
    return status;
}

int ck_command_claims(int argc, char **argv) {
    const char *out = "out";
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--help")) {
            print_help();
            return CK_EXIT_OK;
        }
        if (strcmp(argv[i], "--out") || i + 1 == argc) {
            ck_Error error = {0};
            return ck_command_fail(
                ck_fail(&error, CK_BAD_INPUT, "%s: claims takes --out DIR and nothing else", argv[i]), &error);
        }
        out = argv[++i];
    }
    ck_Error error = {0};
    ck_Status status = write_tables(out, &error);
    if (status) return ck_command_fail(status, &error);
    printf("CSVs: %s\n", out);
    return CK_EXIT_OK;
}
