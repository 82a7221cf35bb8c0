#include "film.h"

#include "files.h"
#include "look.h"
#include "replay_file.h"
#include "replay_pack.h"
#include "template.h"
#include "tool.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <nettle/base64.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// A browser draws no taller picture than this: as many frames stand above each other in one.
#define MOST_HEIGHT 14000
// The part of a window that is no page, at most, px.
#define WINDOW_MARGIN 200

static const char *const browsers[] = {"chromium", "chromium-browser", "google-chrome"};
#define BROWSERS (sizeof browsers / sizeof *browsers)

static const char *find_browser(void) {
    for (size_t i = 0; i < BROWSERS; i++)
        if (ck_tool_is_there(browsers[i])) return browsers[i];
    return NULL;
}

static bool ends_with(const char *text, const char *ending) {
    const size_t length = strlen(text), tail = strlen(ending);
    return length > tail && !strcmp(text + length - tail, ending);
}

ck_Status ck_film_check(const char *out, ck_Error *error) {
    if (!ends_with(out, ".mp4") && !ends_with(out, ".gif"))
        return ck_fail(error, CK_BAD_INPUT, "%s: a film's name ends in .mp4 or .gif", out);
    if (!find_browser()) return ck_fail(error, CK_IO, "a film needs Debian's package chromium, which is not there");
    return ck_tool_is_there("ffmpeg")
               ? CK_OK
               : ck_fail(error, CK_IO, "a film needs Debian's package ffmpeg, which is not there");
}

typedef struct Page {
    const ck_Film *film;
    FILE *file;
    int frames, on_sheet;
} Page;

static ck_Status write_replay(const Page *page, ck_Error *error) {
    ck_Replay replay;
    char *packed = NULL;
    size_t size = 0;
    ck_Status status = ck_replay_read(&replay, page->film->replays, page->film->scene, error);
    if (!status) status = ck_replay_pack(&packed, &size, &replay, error);
    char *text = status ? NULL : malloc(BASE64_ENCODE_RAW_LENGTH(size) + 1);
    if (!status && !text) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        base64_encode_raw(text, size, (const uint8_t *)packed);
        fprintf(page->file, "<script type=\"application/octet-stream\" id=\"replay\">");
        fwrite(text, 1, BASE64_ENCODE_RAW_LENGTH(size), page->file);
        fprintf(page->file, "</script>\n");
    }
    free(text);
    free(packed);
    ck_replay_free(&replay);
    return status;
}

static ck_Status write_part(void *context, const char *word, ck_Error *error) {
    const Page *page = context;
    const ck_Film *film = page->film;
    if (strcmp(word, "film")) return CK_OK;
    fprintf(page->file,
            "<script type=\"application/json\" id=\"film\">{\"scene\":\"%s\",\"color\":\"%s\",\"width\":%d,"
            "\"height\":%d,\"fps\":%d,\"frames\":%d,\"onSheet\":%d,\"colors\":[",
            film->scene, film->color, film->width, film->height, film->fps, page->frames, page->on_sheet);
    for (int i = 0; i < CK_REPLAY_MAX_PATHS; i++) fprintf(page->file, "%s\"%s\"", i ? "," : "", ck_chart_look(i).color);
    fprintf(page->file, "]}</script>\n");
    return write_replay(page, error);
}

static ck_Status write_page(Page *page, const char *directory, ck_Error *error) {
    char sources[PATH_MAX], *path = ck_path_join(directory, "film.html");
    ck_Status status =
        path ? ck_template_sources(sources, sizeof sources, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !(page->file = fopen(path, "w"))) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (!status) status = ck_template_write(page->file, sources, "film.html", "film", write_part, page, error);
    if (page->file && fclose(page->file) && !status) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    free(path);
    return status;
}

// The line of the log that has a word, or its last one, into text. False where there is no such line.
static bool read_log(char *text, size_t size, const char *directory, const char *word) {
    char *path = ck_path_join(directory, "log"), *log = NULL;
    size_t length;
    const bool is_there = path && !ck_file_read(&log, &length, path, NULL);
    while (is_there && length && log[length - 1] == '\n') log[--length] = '\0';
    const char *found = !is_there ? NULL : word ? strstr(log, word) : strrchr(log, '\n') ? strrchr(log, '\n') + 1 : log;
    if (found) snprintf(text, size, "%.*s", (int)strcspn(found, "\n"), found);
    free(log);
    free(path);
    return found != NULL;
}

static ck_Status fail_with_log(const char *program, const char *directory, ck_Error *error) {
    char last[300] = "";
    read_log(last, sizeof last, directory, NULL);
    return ck_fail(error, CK_IO, "%s failed: %s", program, *last ? last : "it said nothing");
}

// A browser that starts rarely waits for ever for a service of its own; a sheet takes some 4 s.
#define MOST_SECONDS 60.0
#define MOST_TRIES 4

// One picture of many frames.
static ck_Status try_sheet(int *end, const Page *page, int sheet, const char *directory, ck_Error *error) {
    char picture[40], size[60], address[PATH_MAX + 40], profile[PATH_MAX + 40], place[PATH_MAX];
    if (!realpath(directory, place)) return ck_fail(error, CK_IO, "%s: %s", directory, strerror(errno));
    snprintf(picture, sizeof picture, "--screenshot=sheet%d.png", sheet);
    snprintf(size, sizeof size, "--window-size=%d,%d", page->film->width,
             page->on_sheet * page->film->height + WINDOW_MARGIN);
    snprintf(profile, sizeof profile, "--user-data-dir=%s/browser", place);
    snprintf(address, sizeof address, "file://%s/film.html#%d", place, sheet);
    ck_path_remove(profile + strlen("--user-data-dir="));
    // the sandbox cannot be had by root; the page is our own
    const char *words[] = {find_browser(),
                           "--headless",
                           "--hide-scrollbars",
                           "--force-device-scale-factor=1",
                           "--disable-gpu",
                           "--enable-unsafe-swiftshader",
                           "--no-first-run",
                           "--no-default-browser-check",
                           "--disable-background-networking",
                           "--disable-component-update",
                           "--disable-extensions",
                           "--disable-sync",
                           "--disable-features=OptimizationHints,OptimizationGuideOnDeviceModel,MediaRouter,Translate",
                           "--enable-logging=stderr",
                           profile,
                           size,
                           picture,
                           address,
                           geteuid() ? NULL : "--no-sandbox",
                           NULL};
    if (!words[0]) return ck_fail(error, CK_IO, "the browser is gone");
    return ck_tool_run(end, words, directory, "log", MOST_SECONDS, error);
}

static ck_Status draw_sheet(const Page *page, int sheet, const char *directory, ck_Error *error) {
    char name[40], complaint[300];
    int end = CK_TOOL_LATE;
    ck_Status status = CK_OK;
    for (int i = 0; i < MOST_TRIES && end == CK_TOOL_LATE && !status; i++)
        status = try_sheet(&end, page, sheet, directory, error);
    snprintf(name, sizeof name, "sheet%d.png", sheet);
    char *path = ck_path_join(directory, name);
    // a picture is made of whatever a script has left
    if (!status && read_log(complaint, sizeof complaint, directory, "Uncaught"))
        status = ck_fail(error, CK_IO, "the film's page failed: %s", complaint);
    if (!status && end == CK_TOOL_LATE)
        status = ck_fail(error, CK_IO, "the browser drew no picture in %d times %g s", MOST_TRIES, MOST_SECONDS);
    if (!status && (end || !path || access(path, R_OK))) status = fail_with_log("the browser", directory, error);
    free(path);
    return status;
}

static ck_Status join_sheets(const Page *page, const char *directory, bool is_gif, ck_Error *error) {
    const ck_Film *film = page->film;
    char rate[40], frames[20], filter[300];
    snprintf(rate, sizeof rate, "%d/%d", film->fps, page->on_sheet);
    snprintf(frames, sizeof frames, "%d", page->frames);
    snprintf(filter, sizeof filter, "crop=%d:%d:0:0,untile=1x%d%s", film->width, page->on_sheet * film->height,
             page->on_sheet, is_gif ? ",split[a][b];[a]palettegen[p];[b][p]paletteuse" : ",format=yuv420p");
    const char *words[] = {"ffmpeg",
                           "-v",
                           "error",
                           "-y",
                           "-framerate",
                           rate,
                           "-start_number",
                           "0",
                           "-i",
                           "sheet%d.png",
                           "-vf",
                           filter,
                           "-frames:v",
                           frames,
                           is_gif ? "film.gif" : "film.mp4",
                           NULL};
    int end;
    ck_Status status = ck_tool_run(&end, words, directory, "log", 0, error);
    return !status && end ? fail_with_log("ffmpeg", directory, error) : status;
}

ck_Status ck_film_write(const ck_Film *film, const char *directory, const char *out,
                        void (*progress)(int drawn, int count), ck_Error *error) {
    const bool is_gif = ends_with(out, ".gif");
    Page page = {film, NULL, (int)lrint(film->seconds * film->fps) + 1, MOST_HEIGHT / film->height};
    if (page.on_sheet > page.frames) page.on_sheet = page.frames;
    ck_Status status = ck_film_check(out, error);
    if (!status) status = write_page(&page, directory, error);
    for (int sheet = 0; sheet * page.on_sheet < page.frames && !status; sheet++) {
        if (progress) progress(sheet * page.on_sheet, page.frames);
        status = draw_sheet(&page, sheet, directory, error);
    }
    if (!status) status = join_sheets(&page, directory, is_gif, error);
    char *made = ck_path_join(directory, is_gif ? "film.gif" : "film.mp4");
    if (!status && (!made || rename(made, out))) status = ck_fail(error, CK_IO, "%s: %s", out, strerror(errno));
    free(made);
    return status;
}
