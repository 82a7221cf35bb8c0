#include "report.h"

#include "chart.h"
#include "page.h"
#include "path.h"

#include <errno.h>
#include <ftw.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *place) {
    (void)about;
    (void)kind;
    (void)place;
    return remove(path);
}

static void remove_tree(const char *path) {
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

// Puts the new charts where the old ones were. Errors: CK_IO.
static ck_Status replace(const char *charts, const char *part, ck_Error *error) {
    remove_tree(charts);
    return rename(part, charts) ? ck_fail(error, CK_IO, "%s: %s", charts, strerror(errno)) : CK_OK;
}

ck_Status ck_report_write(const char *directory, ck_Error *error) {
    // gnuplot is run in another directory
    char sources[PATH_MAX];
    if (!realpath(CK_REPORT_SOURCES, sources))
        return ck_fail(error, CK_IO, "%s: %s; it must hold the scripts of charts and page", CK_REPORT_SOURCES,
                       strerror(errno));
    ck_ReportData data;
    ck_Status status = ck_report_data_read(&data, directory, error);
    char *charts = ck_path_join(directory, CK_CHART_DIRECTORY), *part = ck_path_part(directory, CK_CHART_DIRECTORY);
    bool *drawn = calloc((size_t)(data.scene_count + 1) * (size_t)ck_chart_count(), sizeof *drawn);
    if (!status && !(charts && part && drawn)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        status = ck_charts_draw(&data, part, sources, drawn, error);
        if (!status) status = ck_page_write(&data, sources, part, drawn, error);
        if (!status) status = replace(charts, part, error);
        if (status) remove_tree(part);
    }
    free(drawn);
    free(part);
    free(charts);
    ck_report_data_free(&data);
    return status;
}
