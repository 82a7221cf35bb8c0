#include "page.h"

#include "chart.h"
#include "engines.h"
#include "files.h"
#include "finding.h"
#include "look.h"
#include "process.h"
#include "replay_pack.h"
#include "template.h"

#include <errno.h>
#include <nettle/base64.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

typedef struct Page {
    const ck_ReportData *data;
    const char *charts;
    const bool *drawn;
    ck_Findings findings;
    FILE *file;
    char nonce[33]; // that its scripts and styles are known by, so that no text of a CSV is run as one
} Page;

// Text of a JSON string, on one line.
static void write_text(FILE *file, const char *text) {
    fputc('"', file);
    for (const char *letter = text; *letter; letter++)
        fprintf(file,
                (unsigned char)*letter < ' '        ? " "
                : *letter == '"' || *letter == '\\' ? "\\%c"
                : *letter == '<'                    ? "\\u003c"
                                                    : "%c",
                *letter);
    fputc('"', file);
}

static void write_html(FILE *file, const char *text) {
    for (; *text; text++) {
        if (strchr("&<>\"", *text))
            fprintf(file, "&#%d;", *text);
        else
            fputc(*text, file);
    }
}

// Compresses into *out. Errors: CK_NO_MEMORY. Free *out in any case.
static ck_Status compress_bytes(char **out, size_t *out_size, const char *bytes, size_t size, ck_Error *error) {
    z_stream stream = {0};
    *out = NULL;
    // 15 + 16: the largest window, with gzip's header
    if (deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    size_t most = deflateBound(&stream, size);
    *out = malloc(most);
    stream.next_in = (Bytef *)bytes;
    stream.avail_in = (uInt)size;
    stream.next_out = (Bytef *)*out;
    stream.avail_out = (uInt)most;
    int result = *out ? deflate(&stream, Z_FINISH) : Z_MEM_ERROR;
    *out_size = stream.total_out;
    deflateEnd(&stream);
    return result == Z_STREAM_END ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// Adds bytes under a name that scripts of the page find them by, and a text about them that is there without unpacking.
static ck_Status pack(const Page *page, const char *name, const char *about, const char *bytes, size_t size,
                      ck_Error *error) {
    if (ck_child_interrupted) return ck_fail(error, CK_IO, "interrupted; no report was written");
    char *small;
    size_t small_size;
    ck_Status status = compress_bytes(&small, &small_size, bytes, size, error);
    char *text = status ? NULL : malloc(BASE64_ENCODE_RAW_LENGTH(small_size) + 1);
    if (!status && !text) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        base64_encode_raw(text, small_size, (const uint8_t *)small);
        fprintf(page->file, "<script type=\"application/gzip\" id=\"file:%s\" data-about=\"", name);
        write_html(page->file, about);
        fprintf(page->file, "\">");
        fwrite(text, 1, BASE64_ENCODE_RAW_LENGTH(small_size), page->file);
        fprintf(page->file, "</script>\n");
    }
    free(text);
    free(small);
    return status;
}

static ck_Status pack_file(const Page *page, const char *directory, const char *file, ck_Error *error) {
    char *path = ck_path_join(directory, file), *bytes = NULL;
    size_t size;
    ck_Status status = path ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_file_read(&bytes, &size, path, error);
    if (!status) status = pack(page, file, "", bytes, size, error);
    free(bytes);
    free(path);
    return status;
}

static bool has_replay(const Page *page, const char *scene) {
    char *path;
    if (asprintf(&path, "%s/" CK_REPLAY_DIRECTORY "/%s.replay", page->data->directory, scene) < 0) return false;
    bool is_there = ck_report_table(page->data, CK_RUNS) && access(path, F_OK) == 0;
    free(path);
    return is_there;
}

static ck_Status pack_replay(const Page *page, const char *scene, ck_Error *error) {
    ck_Replay replay;
    char *packed = NULL, name[200];
    size_t size;
    ck_Status status = ck_replay_read(&replay, page->data->directory, scene, error);
    if (!status) status = ck_replay_pack(&packed, &size, &replay, error);
    char *about = status ? NULL : strndup(replay.about, replay.about_length);
    if (!status && !about) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    snprintf(name, sizeof name, "%s.replay", scene);
    if (!status) status = pack(page, name, about, packed, size, error);
    free(about);
    free(packed);
    ck_replay_free(&replay);
    return status;
}

static void write_engines(const Page *page) {
    fprintf(page->file, "\"engines\":[");
    for (int i = 0; i < page->data->engine_count; i++) {
        ck_Look look = ck_chart_look(i);
        const ck_Engine *engine = ck_engine_find(page->data->engines[i]);
        fprintf(page->file, "%s{\"name\":\"%s\",\"color\":\"%s\",\"sign\":\"%s\",\"hasCode\":%s}", i ? "," : "",
                page->data->engines[i], look.color, look.sign, engine && engine->code ? "true" : "false");
    }
    fprintf(page->file, "]");
}

static void write_charts(const Page *page, int scene) {
    bool is_first = true;
    fprintf(page->file, "[");
    for (int i = 0; i < ck_chart_count(); i++) {
        const ck_Chart *chart = ck_chart_at(i);
        char file[200];
        if (!page->drawn[scene * ck_chart_count() + i]) continue;
        ck_chart_file(file, sizeof file, chart, scene < page->data->scene_count ? page->data->scenes[scene] : NULL);
        fprintf(page->file,
                "%s{\"name\":\"%s\",\"file\":\"%s\",\"width\":%d,\"height\":%d,\"title\":", is_first ? "" : ",",
                chart->name, file, chart->width, chart->height);
        write_text(page->file, chart->title);
        fprintf(page->file, "}");
        is_first = false;
    }
    fprintf(page->file, "]");
}

static ck_Status find_results(Page *page, ck_Error *error) {
    const ck_CsvTable *tables[CK_REPORT_LAYOUTS];
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) tables[i] = ck_report_table(page->data, i);
    return ck_findings_find(&page->findings, tables, error);
}

static void write_findings(const Page *page) {
    fprintf(page->file, "\"findings\":[");
    for (int i = 0; i < page->findings.count; i++) {
        const ck_Finding *finding = &page->findings.items[i];
        fprintf(page->file, "%s{\"kind\":\"%s\",\"text\":", i ? "," : "", finding->kind);
        write_text(page->file, finding->text);
        fprintf(page->file, ",\"command\":");
        write_text(page->file, finding->command);
        fprintf(page->file, "}");
    }
    fprintf(page->file, "]");
}

// What the page is of, for its scripts.
static void write_contents(const Page *page) {
    const ck_ReportData *data = page->data;
    fprintf(page->file, "<script type=\"application/json\" id=\"report\">{\"version\":\"%s\",", CK_VERSION);
    write_engines(page);
    fprintf(page->file, ",\"scenes\":[");
    for (int i = 0; i < data->scene_count; i++) {
        fprintf(page->file, "%s{\"name\":\"%s\",\"has_replay\":%s,\"charts\":", i ? "," : "", data->scenes[i],
                has_replay(page, data->scenes[i]) ? "true" : "false");
        write_charts(page, i);
        fprintf(page->file, "}");
    }
    fprintf(page->file, "],\"charts\":");
    write_charts(page, data->scene_count);
    fprintf(page->file, ",\"tables\":[");
    for (int i = 0, count = 0; i < CK_REPORT_LAYOUTS; i++) {
        if (!ck_report_table(data, i)) continue;
        fprintf(page->file, "%s{\"file\":\"%s\",\"rows\":%d,\"about\":", count++ ? "," : "", ck_layouts[i].file,
                data->tables[i].row_count);
        write_text(page->file, ck_layouts[i].about);
        fprintf(page->file, "}");
    }
    fprintf(page->file, "],");
    write_findings(page);
    fprintf(page->file, "}</script>\n");
}

static ck_Status pack_charts(const Page *page, ck_Error *error) {
    ck_Status status = CK_OK;
    for (int scene = 0; scene <= page->data->scene_count; scene++)
        for (int i = 0; i < ck_chart_count() && !status; i++) {
            char name[200], file[220];
            if (!page->drawn[scene * ck_chart_count() + i]) continue;
            ck_chart_file(name, sizeof name, ck_chart_at(i),
                          scene < page->data->scene_count ? page->data->scenes[scene] : NULL);
            snprintf(file, sizeof file, "%s.svg", name);
            status = pack_file(page, page->charts, file, error);
            snprintf(file, sizeof file, "%s.axes", name);
            if (!status) status = pack_file(page, page->charts, file, error);
        }
    return status;
}

// A larger CSV would make the page slow to open.
#define MOST_PACKED ((off_t)8 << 20)

static bool is_packed(const Page *page, int layout) {
    struct stat about;
    char *path = ck_path_join(page->data->directory, ck_layouts[layout].file);
    const bool is_small = path && !stat(path, &about) && about.st_size <= MOST_PACKED;
    free(path);
    return ck_report_table(page->data, layout) && layout != CK_SERIES && is_small;
}

static ck_Status write_report(const Page *page, ck_Error *error) {
    const ck_ReportData *data = page->data;
    write_contents(page);
    ck_Status status = CK_OK;
    // series of a whole comparison would make the page slow to open: they lie beside it
    for (int i = 0; i < CK_REPORT_LAYOUTS && !status; i++)
        if (is_packed(page, i)) status = pack_file(page, data->directory, ck_layouts[i].file, error);
    // what was summed up for the chart is what the page's first table is of
    if (!status && data->summary_count) status = pack_file(page, page->charts, "summary.csv", error);
    if (!status) status = pack_charts(page, error);
    for (int i = 0; i < data->scene_count && !status; i++)
        if (has_replay(page, data->scenes[i])) status = pack_replay(page, data->scenes[i], error);
    return status;
}

// The same for the same results, and what no text among them can know of itself.
static void choose_nonce(Page *page) {
    struct sha256_ctx hash;
    uint8_t digest[16];
    sha256_init(&hash);
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) {
        const ck_CsvTable *table = ck_report_table(page->data, i);
        const size_t count = table ? ((size_t)table->row_count + 1) * (size_t)table->width : 0;
        for (size_t k = 0; k < count; k++)
            sha256_update(&hash, strlen(table->fields[k]) + 1, (const uint8_t *)table->fields[k]);
    }
    sha256_digest(&hash, sizeof digest, digest);
    for (size_t i = 0; i < sizeof digest; i++) snprintf(page->nonce + 2 * i, 3, "%02x", digest[i]);
}

static void link_charts(const Page *page, int scene) {
    const char *name = scene < page->data->scene_count ? page->data->scenes[scene] : NULL;
    bool is_first = true;
    for (int i = 0; i < ck_chart_count(); i++) {
        const ck_Chart *chart = ck_chart_at(i);
        char file[200];
        if (!page->drawn[scene * ck_chart_count() + i]) continue;
        ck_chart_file(file, sizeof file, chart, name);
        fprintf(page->file, "%s<a href=\"" CK_CHART_DIRECTORY "/%s.svg\">", is_first ? "<li>" : ", ", file);
        write_html(page->file, name ? name : "all scenes");
        fprintf(page->file, ": ");
        write_html(page->file, chart->title);
        fprintf(page->file, "</a>");
        is_first = false;
    }
    if (!is_first) fprintf(page->file, "</li>\n");
}

// For who runs no scripts: results in words, and the charts and tables that lie beside the page.
static void write_plain(const Page *page) {
    fprintf(page->file, "<noscript>\n<h2>What to know</h2>\n<ul>\n");
    for (int i = 0; i < page->findings.count; i++) {
        fprintf(page->file, "<li>");
        write_html(page->file, page->findings.items[i].text);
        fprintf(page->file, "</li>\n");
    }
    fprintf(page->file, "</ul>\n<h2>Charts</h2>\n<ul>\n");
    for (int scene = page->data->scene_count; scene >= 0; scene--) link_charts(page, scene);
    fprintf(page->file, "</ul>\n<h2>Tables</h2>\n<ul>\n");
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) {
        if (!ck_report_table(page->data, i)) continue;
        fprintf(page->file, "<li><a href=\"%s\">%s</a>: ", ck_layouts[i].file, ck_layouts[i].file);
        write_html(page->file, ck_layouts[i].about);
        fprintf(page->file, "</li>\n");
    }
    fprintf(page->file, "</ul>\n</noscript>\n");
}

static ck_Status write_part(void *context, const char *word, ck_Error *error) {
    if (!strcmp(word, "plain")) write_plain(context);
    return strcmp(word, "report") ? CK_OK : write_report(context, error);
}

ck_Status ck_page_write(const ck_ReportData *data, const char *sources, const char *charts, const bool *drawn,
                        const char *path, ck_Error *error) {
    Page page = {.data = data, .charts = charts, .drawn = drawn};
    ck_Status status = find_results(&page, error);
    if (!status) choose_nonce(&page);
    if (!status && !(page.file = fopen(path, "w"))) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (!status) status = ck_template_write(page.file, sources, "page.html", page.nonce, write_part, &page, error);
    if (page.file) {
        bool failed = fflush(page.file) || ferror(page.file);
        failed |= fclose(page.file) != 0;
        if (!status && failed) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
        if (status) unlink(path);
    }
    ck_findings_free(&page.findings);
    return status;
}
