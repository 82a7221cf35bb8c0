#include "report.h"

#include "chart.h"
#include "files.h"
#include "page.h"
#include "template.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

// Charts are files that a report has written, or the user's own things lie among them and would be lost.
static ck_Status check_charts(const char *charts, ck_Error *error) {
    static const char *const endings[] = {".svg", ".png", ".pdf", ".csv", ".gp", ".log", ".axes"};
    DIR *directory = opendir(charts);
    ck_Status status = CK_OK;
    if (!directory && errno != ENOENT) return ck_fail(error, CK_IO, "%s: %s", charts, strerror(errno));
    for (struct dirent *entry; directory && !status && (entry = readdir(directory));) {
        const char *ending = strrchr(entry->d_name, '.');
        bool is_own = entry->d_name[0] == '.';
        for (size_t i = 0; i < sizeof endings / sizeof *endings && !is_own; i++)
            is_own = ending && !strcmp(ending, endings[i]);
        if (!is_own)
            status = ck_fail(error, CK_BAD_INPUT, "%s/%s: is no chart; move it away, for charts/ is written anew",
                             charts, entry->d_name);
    }
    if (directory) closedir(directory);
    return status;
}

// Where charts and page are before they have their names, and what was there before.
typedef struct Places {
    ck_PartFolder work;
    char *charts, *new_charts, *old_charts, *page, *new_page;
} Places;

static ck_Status open_places(Places *places, const char *directory, ck_Error *error) {
    *places =
        (Places){.charts = ck_path_join(directory, CK_CHART_DIRECTORY), .page = ck_path_join(directory, "index.html")};
    ck_Status status = ck_part_folder_open(&places->work, directory, "report", error);
    if (status) return status;
    places->new_charts = ck_path_join(places->work.path, CK_CHART_DIRECTORY);
    places->old_charts = ck_path_join(places->work.path, "old");
    places->new_page = ck_path_join(places->work.path, "index.html");
    const bool is_found =
        places->charts && places->new_charts && places->old_charts && places->page && places->new_page;
    return is_found ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

static void close_places(Places *places) {
    ck_part_folder_close(&places->work);
    free(places->charts);
    free(places->new_charts);
    free(places->old_charts);
    free(places->page);
    free(places->new_page);
}

// Charts and page take the place of the old ones together, or not at all. Errors: CK_IO.
static ck_Status replace(const Places *places, ck_Error *error) {
    bool had_charts = !rename(places->charts, places->old_charts);
    bool failed = rename(places->new_charts, places->charts) || rename(places->new_page, places->page);
    if (!failed) return CK_OK;
    ck_Status status = ck_fail(error, CK_IO, "%s: %s", places->page, strerror(errno));
    ck_path_remove(places->charts);
    if (had_charts && rename(places->old_charts, places->charts))
        status =
            ck_fail(error, CK_IO, "%s: the charts that were there are lost; report draws them again", places->charts);
    return status;
}

ck_Status ck_report_write(const char *directory, double paper_width, ck_Error *error) {
    char sources[PATH_MAX];
    ck_Status found = ck_template_sources(sources, sizeof sources, error);
    if (found) return found;
    ck_ReportData data;
    Places places = {0};
    bool *drawn = NULL;
    ck_Status status = ck_report_data_read(&data, directory, error);
    if (!status) drawn = calloc((size_t)(data.scene_count + 1) * (size_t)ck_chart_count(), sizeof *drawn);
    if (!status && !drawn) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = open_places(&places, directory, error);
    if (!status) status = check_charts(places.charts, error);
    if (!status) status = ck_charts_draw(&data, places.new_charts, sources, paper_width, drawn, error);
    if (!status) status = ck_page_write(&data, sources, places.new_charts, drawn, places.new_page, error);
    if (!status) status = replace(&places, error);
    close_places(&places);
    free(drawn);
    ck_report_data_free(&data);
    return status;
}
