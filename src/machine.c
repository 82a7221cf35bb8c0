#include "machine.h"

#include "engine.h"
#include "loops.h"

#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

static void add(ck_Csv *csv, const char *key, const char *value) {
    ck_csv_text(csv, key);
    ck_csv_text(csv, value);
}

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

void ck_machine_write(ck_Csv *csv) {
    char text[256];
    read_processor(text, sizeof text);
    add(csv, "processor", text);
    ck_csv_text(csv, "cores");
    ck_csv_count(csv, (uint64_t)sysconf(_SC_NPROCESSORS_ONLN));
    struct utsname system;
    if (!uname(&system)) {
        snprintf(text, sizeof text, "%s %s %s", system.sysname, system.release, system.machine);
        add(csv, "system", text);
    }
    add(csv, "compiler", "gcc " __VERSION__);
    add(csv, "flags", CK_FLAGS);
    // round otherwise where they do not fuse
    add(csv, "vectors", ck_loops_at(0)->vectors);
    add(csv, "clothcheck", CK_VERSION);
    for (int i = 0; i < ck_engine_count(); i++) {
        snprintf(text, sizeof text, "engine %s", ck_engine_at(i)->name);
        add(csv, text, ck_engine_at(i)->version());
    }
    time_t now = time(NULL);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime(&now));
    add(csv, "date", text);
}
