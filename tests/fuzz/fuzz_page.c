// The report's page: of whatever CSVs there are, or an error. No text ends an element of the page, and what its scripts
// read is JSON. The first byte says which file the input is.
#include "fuzz.h"

#include "page.h"

#include <jansson.h>

static const char *const files[][2] = {
    {"runs.csv", "scene,engine,status,reason,time_step_s,substeps,iterations,simulated_s,cpu_median_s,cpu_iqr_s,"
                 "cpu_low_s,cpu_high_s,repeats,cpu_worst_step_s,realtime_factor,peak_rss_bytes,engine_version,method,"
                 "command\nr,native-verlet,ok,ran,0.1,1,,1,0.5,,,,1,0.1,2,1000,1,verlet,clothcheck run r\n"},
    {"metrics.csv", "scene,engine,metric,unit,value,truth,truth_kind,truth_uncertainty,error,predicted\n"
                    "r,native-verlet,sag,m,1,1.1,closed form,0,0.1,\n"},
};

static int count(const char *text, const char *part) {
    int found = 0;
    for (; (text = strcasestr(text, part)); text++) found++;
    return found;
}

// Elements of the page itself, by one of rows that hurt nobody.
static void check_page(bool is_first) {
    static int elements;
    FILE *file = fopen("index.html", "r");
    char *text = calloc(1, 1 << 23);
    if (!file || !text) abort();
    if (fread(text, 1, (1 << 23) - 1, file) == 0) abort();
    fclose(file);
    if (is_first) elements = count(text, "<script");
    if (count(text, "<script") != elements || count(text, "</script") != elements) abort();
    const char *from = strstr(text, "id=\"report\">"), *to = from ? strstr(from, "</script>") : NULL;
    if (!to) abort();
    from += strlen("id=\"report\">");
    json_t *contents = json_loadb(from, (size_t)(to - from), 0, NULL);
    if (!contents) abort();
    json_decref(contents);
    free(text);
}

static void write_page(bool is_first) {
    ck_ReportData data;
    ck_Error error = {0};
    bool drawn[1000] = {false};
    ck_Status status = ck_report_data_read(&data, ".", &error);
    if (!status && (data.scene_count > 20 || ck_page_write(&data, REPORTS, ".", drawn, "index.html", &error)))
        status = CK_BAD_INPUT;
    if (!status) check_page(is_first);
    ck_report_data_free(&data);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bool is_begun;
    if (!size) return 0;
    for (size_t i = 0; i < 2; i++) fuzz_write(files[i][0], (const uint8_t *)files[i][1], strlen(files[i][1]));
    if (!is_begun) write_page(true);
    is_begun = true;
    fuzz_write(files[data[0] % 2][0], data + 1, size - 1);
    write_page(false);
    return 0;
}
