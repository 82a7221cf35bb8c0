#include "tables.h"

#include "engines.h"
#include "files.h"
#include "loops.h"
#include "names.h"

#include <csv.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

static void read_processor(char *out, size_t size) {
    char line[256];
    snprintf(out, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) || !colon) continue;
        colon[strcspn(colon, "\n")] = 0;
        snprintf(out, size, "%s", colon + 2);
        break;
    }
    if (file) fclose(file);
}

// How wide the instructions are that a peer's library was built with, as its packagers left it.
static void tell_library(ck_MachineFact tell, void *context, const char *name, const char *files,
                         const char *registers) {
    char key[64], value[1024];
    snprintf(key, sizeof key, "library %s", name);
    snprintf(value, sizeof value, "%s; registers of %s", files, registers);
    tell(context, key, value);
}

extern const char ck_commit[];

const char *ck_machine_build(void) {
    static char build[80];
    if (!*build) snprintf(build, sizeof build, "clothcheck %s, %s", CK_VERSION, ck_commit);
    return build;
}

// The first line of a file that the system keeps; "unknown" where there is none.
static void read_line(char *out, size_t size, const char *path) {
    FILE *file = fopen(path, "re");
    if (!file || !fgets(out, (int)size, file)) snprintf(out, size, "unknown");
    out[strcspn(out, "\n")] = 0;
    if (file) fclose(file);
}

void ck_machine_tell(ck_MachineFact tell, void *context) {
    char text[256], key[64];
    read_processor(text, sizeof text);
    tell(context, "processor", text);
    snprintf(text, sizeof text, "%ld", sysconf(_SC_NPROCESSORS_ONLN));
    tell(context, "cores", text);
    snprintf(text, sizeof text, "%.0f MiB", (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 1048576);
    tell(context, "memory", text);
    read_line(text, sizeof text, "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
    tell(context, "governor", text);
    struct utsname system;
    if (!uname(&system)) {
        snprintf(text, sizeof text, "%s %s %s", system.sysname, system.release, system.machine);
        tell(context, "system", text);
    }
    tell(context, "compiler", "gcc " __VERSION__);
    tell(context, "flags", CK_FLAGS);
    // round otherwise where they do not fuse
    tell(context, "vectors", ck_loops_at(0)->vectors);
    tell_library(tell, context, "Bullet", CK_BULLET_FILES, CK_BULLET_REGISTERS);
    tell_library(tell, context, "ODE", CK_ODE_FILES, CK_ODE_REGISTERS);
    snprintf(text, sizeof text, "CHOLMOD %d.%d.%d, libcsv %d.%d.%d, %s", CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION,
             CHOLMOD_SUBSUB_VERSION, CSV_MAJOR, CSV_MINOR, CSV_RELEASE, CK_OTHER_LIBRARIES);
    tell(context, "libraries", text);
    tell(context, "clothcheck", CK_VERSION);
    tell(context, "commit", ck_commit);
    for (int i = 0; i < ck_engine_count(); i++) {
        // of others runs.csv tells the version: they may join what is there
        if (ck_engine_at(i)->outside) continue;
        snprintf(key, sizeof key, "engine %s", ck_engine_at(i)->name);
        tell(context, key, ck_engine_version(ck_engine_at(i)));
    }
}

// Processes that want a core, by the minute.
static char load_before[64];

void ck_machine_begin(void) {
    read_line(load_before, sizeof load_before, "/proc/loadavg");
}

// The words of this process, as a shell reads them.
static void tell_command(ck_MachineFact tell, void *context) {
    char *words = NULL, line[4096];
    size_t size, used = 0;
    if (ck_file_read(&words, &size, "/proc/self/cmdline", NULL)) size = 0;
    for (size_t at = 0; at < size && used + 2 < sizeof line; at += strlen(words + at) + 1) {
        if (at) line[used++] = ' ';
        used += ck_text_shell(line + used, sizeof line - used, words + at);
    }
    line[used] = 0;
    free(words);
    tell(context, "command", line);
}

bool ck_machine_is_of_run(const char *key) {
    return !strcmp(key, "command") || !strcmp(key, "date") || !strncmp(key, "load ", 5);
}

// What is of this run alone.
static void tell_run(ck_MachineFact tell, void *context) {
    char text[64];
    tell_command(tell, context);
    if (*load_before) tell(context, "load before", load_before);
    read_line(text, sizeof text, "/proc/loadavg");
    tell(context, "load after", text);
    time_t now = time(NULL);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime(&now));
    tell(context, "date", text);
}

static void add_fact(void *csv, const char *key, const char *value) {
    ck_csv_text(csv, key);
    ck_csv_text(csv, value);
}

void ck_machine_write(ck_Csv *csv) {
    ck_machine_tell(add_fact, csv);
    tell_run(add_fact, csv);
}

ck_Status ck_machine_save(const char *directory, ck_Error *error) {
    ck_Csv csv = {0};
    ck_Status status = ck_csv_open(&csv, directory, &ck_layouts[CK_MACHINE], error);
    if (!status) ck_machine_write(&csv);
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    return status;
}
