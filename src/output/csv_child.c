#include "csv_child.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// What the child tells its parent, in shared memory; its rows are in a file that nobody else sees.
typedef struct Told {
    ck_Status status;
    ck_Error error;
} Told;

typedef struct Job {
    ck_CsvWork work;
    void *context;
    int column_count, rows; // rows: the file
    Told *told;
} Job;

static void write_rows(void *context) {
    const Job *job = context;
    ck_Csv csv = {.column_count = job->column_count};
    csv.whole.file = fdopen(job->rows, "w");
    job->told->status = csv.whole.file ? job->work(&csv, job->context, &job->told->error)
                                       : ck_fail(&job->told->error, CK_NO_MEMORY, "out of memory");
    if (csv.whole.file && fclose(csv.whole.file) && !job->told->status)
        job->told->status = ck_fail(&job->told->error, CK_IO, "rows of a child: %s", strerror(errno));
}

// A write that fails is told by ck_csv_close.
static ck_Status copy_rows(FILE *out, int rows, ck_Error *error) {
    char block[8192];
    ssize_t got;
    for (off_t at = 0; (got = pread(rows, block, sizeof block, at)) > 0; at += got) fwrite(block, 1, (size_t)got, out);
    return got < 0 ? ck_fail(error, CK_IO, "rows of a child: %s", strerror(errno)) : CK_OK;
}

ck_Status ck_csv_from_child(ck_Csv *csv, ck_CsvWork work, void *context, const ck_Limits *limits, ck_Error *error) {
    Job job = {work, context, csv->column_count, memfd_create("rows", MFD_CLOEXEC), ck_shared_allocate(sizeof(Told))};
    ck_ChildResult child = {0};
    ck_Status status = CK_OK;
    if (job.rows < 0 || !job.told) status = ck_fail(error, CK_NO_MEMORY, "rows of a child: %s", strerror(errno));
    if (!status) status = ck_child_run(&child, write_rows, &job, limits, error);
    if (!status && child.end != CK_CHILD_DONE) status = ck_fail(error, CK_REFUSED, "%s", child.reason);
    if (!status && job.told->status) status = ck_fail(error, job.told->status, "%s", job.told->error.message);
    if (!status) status = copy_rows(csv->whole.file, job.rows, error);
    if (job.rows >= 0) close(job.rows);
    ck_shared_free(job.told, sizeof *job.told);
    return status;
}
