#include "journal.h"

#include "files.h"

#include <csv.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_ROW 4096

typedef struct Reader {
    char question[MAX_ROW]; // the first row's only field
    char key[MAX_ROW];
    ck_JournalRow row;
    ck_ValueName name_at;
    int columns[3 + CK_JOURNAL_VALUES]; // of the file: where in values each goes, −1: nowhere
    int row_index, field;
    bool is_sound;      // all of the row so far is what a row holds
    const char *wanted; // the question; rows of another one are not kept
    void (*kept)(void *context, const char *key, const ck_JournalRow *row);
    void *context;
} Reader;

#define MAX_NAME 64

static int count_values(ck_ValueName name_at) {
    char name[MAX_NAME];
    int count = 0;
    while (name_at && name_at(count, name, sizeof name)) count++;
    return count;
}

static int find_value(ck_ValueName name_at, const char *wanted, size_t length) {
    char name[MAX_NAME];
    for (int i = 0; name_at && name_at(i, name, sizeof name); i++)
        if (strlen(name) == length && !memcmp(name, wanted, length)) return i;
    return -1;
}

static void take_field(void *text, size_t length, void *context) {
    Reader *reader = context;
    char number[64];
    int field = reader->field++;
    if (reader->row_index == 0) {
        if (field == 0) snprintf(reader->question, sizeof reader->question, "%.*s", (int)length, (char *)text);
        return;
    }
    if (reader->row_index == 1) {
        if (field < 3 + CK_JOURNAL_VALUES) reader->columns[field] = find_value(reader->name_at, text, length);
        return;
    }
    if (field == 0) snprintf(reader->key, sizeof reader->key, "%.*s", (int)length, (char *)text);
    if (field == 2) snprintf(reader->row.reason, sizeof reader->row.reason, "%.*s", (int)length, (char *)text);
    if (field == 0 || field == 2) return;
    snprintf(number, sizeof number, "%.*s", (int)length, (char *)text);
    char *end = number;
    if (field == 1) {
        const long status = strtol(number, &end, 10);
        reader->row.status = (int)status;
        reader->is_sound &= end != number && !*end && status >= 0 && status < CK_RUN_STATUS_COUNT;
    }
    if (field >= 3 && field < 3 + CK_JOURNAL_VALUES && reader->columns[field] >= 0) {
        const double value = length ? strtod(number, &end) : NAN;
        reader->row.values[reader->columns[field]] = value;
        reader->is_sound &= !length || (end != number && !*end);
    }
}

static size_t counting_length(const char *question) {
    const char *place = strstr(question, CK_JOURNAL_PLACE);
    return place ? (size_t)(place - question) : strlen(question);
}

bool ck_journal_is_same(const char *question, const char *other) {
    size_t length = counting_length(question);
    return length == counting_length(other) && !memcmp(question, other, length);
}

static void end_row(int end, void *context) {
    (void)end;
    Reader *reader = context;
    // one that is not is run again
    bool is_whole = reader->is_sound && reader->field == 3 + count_values(reader->name_at),
         is_asked = ck_journal_is_same(reader->question, reader->wanted);
    reader->row.is_done = true;
    if (reader->row_index > 1 && is_whole && is_asked && reader->kept)
        reader->kept(reader->context, reader->key, &reader->row);
    reader->row_index++;
    reader->field = 0;
    reader->is_sound = true;
}

// The whole lines of a file; what follows the last newline is cut off the file. NULL without memory.
static char *read_lines(int file, size_t *length) {
    struct stat about;
    *length = 0;
    if (fstat(file, &about)) return NULL;
    char *text = malloc((size_t)about.st_size + 1);
    ssize_t got = text ? pread(file, text, (size_t)about.st_size, 0) : 0;
    while (got > 0 && text[got - 1] != '\n') got--;
    *length = got > 0 ? (size_t)got : 0;
    return text;
}

static ck_Status parse(Reader *reader, const char *text, size_t length, ck_Error *error) {
    struct csv_parser parser;
    if (csv_init(&parser, 0)) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    csv_parse(&parser, text, length, take_field, end_row, reader);
    csv_fini(&parser, take_field, end_row, reader);
    csv_free(&parser);
    return CK_OK;
}

// One write, so that rows of several processes do not mix.
static ck_Status append(const ck_Journal *journal, const char *text, size_t length, ck_Error *error) {
    // a half row, where the disk is full, is dropped by who reads it
    if (ck_file_write(journal->file, text, length)) return CK_OK;
    return ck_fail(error, CK_IO, "%s: %s", journal->path, strerror(errno));
}

static size_t quote(char *out, size_t size, const char *text) {
    size_t length = csv_write(out, size, text, strlen(text));
    return length < size ? length : size - 1;
}

static ck_Status ask(const ck_Journal *journal, const char *question, ck_Error *error) {
    char text[2 * MAX_ROW], name[MAX_NAME];
    if (ftruncate(journal->file, 0)) return ck_fail(error, CK_IO, "%s: %s", journal->path, strerror(errno));
    size_t length = quote(text, MAX_ROW, question);
    length += (size_t)snprintf(text + length, sizeof text - length, "\nkey,status,reason");
    for (int i = 0; journal->name_at(i, name, sizeof name) && length < sizeof text - MAX_NAME - 2; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, ",%s", name);
    text[length++] = '\n';
    return append(journal, text, length, error);
}

// A study that ends while another waits for its journal takes that journal away: the next one begins its own.
static ck_Status open_locked(ck_Journal *journal, ck_Error *error) {
    for (;;) {
        journal->file = open(journal->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
        if (journal->file < 0) return ck_fail(error, CK_IO, "%s: %s", journal->path, strerror(errno));
        if (!ck_file_lock(journal->file, false))
            return ck_fail(error, CK_BAD_INPUT, "%s: another study is running there; give another --out",
                           journal->path);
        if (ck_file_is_named(journal->file, journal->path)) return CK_OK;
        close(journal->file);
    }
}

ck_Status ck_journal_open(ck_Journal *journal, const char *directory, const char *name, const char *question,
                          ck_ValueName name_at, void (*kept)(void *context, const char *key, const ck_JournalRow *row),
                          void *context, ck_Error *error) {
    int failed = ck_path_make(directory);
    *journal = (ck_Journal){.file = -1, .path = ck_path_join(directory, name), .name_at = name_at};
    if (failed) return ck_fail(error, CK_IO, "%s: %s", directory, strerror(failed));
    if (!journal->path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    const ck_Status status = open_locked(journal, error);
    if (status) return status;
    size_t length;
    char *text = read_lines(journal->file, &length);
    if (!text) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    // one that was cut off in its first two rows is none
    const char *first = memchr(text, '\n', length);
    const bool is_asked = first && memchr(first + 1, '\n', length - (size_t)(first + 1 - text));
    free(text);
    if (!is_asked) return ask(journal, question, error);
    if (ftruncate(journal->file, (off_t)length)) return ck_fail(error, CK_IO, "%s: %s", journal->path, strerror(errno));
    return ck_journal_read(journal, question, kept, context, error);
}

ck_Status ck_journal_read(const ck_Journal *journal, const char *question,
                          void (*kept)(void *context, const char *key, const ck_JournalRow *row), void *context,
                          ck_Error *error) {
    size_t length;
    Reader *reader = calloc(1, sizeof *reader);
    char *text = read_lines(journal->file, &length);
    ck_Status status = reader && text ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        *reader = (Reader){.wanted = question, .kept = kept, .context = context, .name_at = journal->name_at};
        for (int i = 0; i < CK_JOURNAL_VALUES; i++) reader->row.values[i] = NAN;
        status = parse(reader, text, length, error);
    }
    if (!status && !ck_journal_is_same(reader->question, question))
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: holds an unfinished study that was asked otherwise (other options, scene or program); "
                         "finish that one, remove the file or give another --out",
                         journal->path);
    free(text);
    free(reader);
    return status;
}

ck_Status ck_journal_add(const ck_Journal *journal, const char *key, const ck_JournalRow *row, ck_Error *error) {
    char text[2 * MAX_ROW];
    int count = count_values(journal->name_at);
    size_t used = quote(text, MAX_ROW / 2, key);
    used += (size_t)snprintf(text + used, sizeof text - used, ",%d,", row->status);
    used += quote(text + used, MAX_ROW / 2, row->reason);
    for (int i = 0; i < count; i++)
        used += (size_t)(isnan(row->values[i]) ? snprintf(text + used, sizeof text - used, ",")
                                               : snprintf(text + used, sizeof text - used, ",%.17g", row->values[i]));
    text[used++] = '\n';
    return append(journal, text, used, error);
}

ck_Status ck_journal_question(const char *directory, const char *name, char *question, size_t size, ck_Error *error) {
    char *path = ck_path_join(directory, name);
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    size_t length = 0;
    char *text = file >= 0 ? read_lines(file, &length) : NULL;
    Reader *reader = calloc(1, sizeof *reader);
    ck_Status status = CK_OK;
    if (file < 0 || !length)
        status = ck_fail(error, CK_BAD_INPUT, "%s: there is no journal of a study", path ? path : directory);
    else if (!reader || !text)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        reader->wanted = "";
        status = parse(reader, text, length, error);
        snprintf(question, size, "%s", reader->question);
    }
    if (file >= 0) close(file);
    free(reader);
    free(text);
    free(path);
    return status;
}

void ck_journal_close(ck_Journal *journal, bool remove) {
    if (journal->path && remove) unlink(journal->path);
    if (journal->path && journal->file >= 0) close(journal->file);
    free(journal->path);
    *journal = (ck_Journal){.file = -1};
}
