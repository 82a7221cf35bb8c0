// Journals of studies that were killed, or damaged since.
#include "fuzz.h"

#include "journal.h"

#include <fcntl.h>

static bool value_name(int index, char *name, size_t size) {
    static const char *const names[] = {"error", "cpu_s"};
    if (index > 1) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

static void keep(void *context, const char *key, const ck_JournalRow *row) {
    (void)context, (void)key;
    if (row->status < 0 || row->status >= CK_RUN_STATUS_COUNT || strlen(row->reason) >= sizeof row->reason) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40];
    ck_Error error = {0};
    const int file = fuzz_file(path, data, size);
    const ck_Journal journal = {.file = file, .path = path, .name_at = value_name};
    ck_journal_read(&journal, "question", keep, NULL, &error);
    close(file);
    return 0;
}
