#include "slurm.h"

#include "files.h"
#include "names.h"
#include "text.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// A preempted part, or one out of time, is told 30 s before it ends; its cases are free from then on.
static void write_part(FILE *out, const ck_SlurmOptions *options, const char *folder) {
    fprintf(out, "#SBATCH --job-name=%s\n#SBATCH --array=1-%d", options->name, options->array);
    if (options->limit > 0) fprintf(out, "%%%d", options->limit);
    fprintf(out, "\n#SBATCH --cpus-per-task=%d\n#SBATCH --requeue\n#SBATCH --signal=B:TERM@30\n", options->cores);
    if (options->time) fprintf(out, "#SBATCH --time=%s\n", options->time);
    fprintf(out, "#SBATCH --output=%s/slurm-%%A_%%a.log\n", folder);
}

static void write_end(FILE *out, const ck_SlurmOptions *options, const char *folder) {
    fprintf(out, "#SBATCH --job-name=%s-results\n#SBATCH --cpus-per-task=1\n#SBATCH --requeue\n", options->name);
    fprintf(out, "#SBATCH --output=%s/slurm-%%j.log\n", folder);
}

char *ck_slurm_script(const ck_SlurmOptions *options, int is_end) {
    char program[PATH_MAX] = "clothcheck", here[PATH_MAX], quoted[2 * PATH_MAX];
    ck_Text text;
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length > 0) program[length] = 0;
    if (!ck_text_begin(&text)) return NULL;
    FILE *out = text.file;
    fprintf(out, "#!/bin/sh\n");
    // sbatch reads quotes as a shell does
    ck_text_shell(quoted, sizeof quoted, options->folder);
    if (is_end)
        write_end(out, options, quoted);
    else
        write_part(out, options, quoted);
    if (options->partition) fprintf(out, "#SBATCH --partition=%s\n", options->partition);
    fprintf(out, "#SBATCH --open-mode=append\n");
    if (getcwd(here, sizeof here)) {
        ck_text_shell(quoted, sizeof quoted, here);
        fprintf(out, "cd %s || exit 1\n", quoted);
    }
    ck_text_shell(quoted, sizeof quoted, program);
    fprintf(out, "exec %s %s\n", quoted, is_end ? options->end : options->part);
    return ck_text_end(&text) ? text.bytes : NULL;
}

static ck_Status write_script(const ck_SlurmOptions *options, int is_end, char **path, ck_Error *error) {
    const char *name = is_end ? "slurm_results.sh" : "slurm_part.sh";
    char *text = ck_slurm_script(options, is_end);
    ck_WholeFile whole = {0};
    *path = ck_path_join(options->folder, name);
    ck_Status status = text && *path ? ck_whole_file_open(&whole, options->folder, name, error)
                                     : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) fputs(text, whole.file);
    if (!status) status = ck_whole_file_close(&whole, error);
    ck_whole_file_discard(&whole);
    free(text);
    return status;
}

// What sbatch prints with --parsable is the job's number.
static ck_Status submit(const char *script, long after, long *job, ck_Error *error) {
    char quoted[2 * PATH_MAX], line[3 * PATH_MAX], said[400] = "", dependency[80] = "";
    ck_text_shell(quoted, sizeof quoted, script);
    // whatever became of the parts
    if (after) snprintf(dependency, sizeof dependency, " --dependency=afterany:%ld", after);
    snprintf(line, sizeof line, "sbatch --parsable%s %s 2>&1", dependency, quoted);
    FILE *out = popen(line, "re");
    if (!out) return ck_fail(error, CK_IO, "sbatch cannot be started: %s", strerror(errno));
    const size_t got = fread(said, 1, sizeof said - 1, out);
    said[got] = 0;
    const int ended = pclose(out);
    char *end;
    *job = strtol(said, &end, 10);
    if (!ended && *job > 0) return CK_OK;
    said[strcspn(said, "\n")] = 0;
    if (WIFEXITED(ended) && WEXITSTATUS(ended) == 127)
        return ck_fail(error, CK_IO, "sbatch is not there: --slurm needs a machine from which Slurm takes jobs");
    return ck_fail(error, CK_IO, "sbatch failed: %s", *said ? said : "it said nothing");
}

ck_Status ck_slurm_submit(const ck_SlurmOptions *options, long jobs[2], ck_Error *error) {
    char *part = NULL, *end = NULL;
    ck_Status status = write_script(options, 0, &part, error);
    if (!status) status = write_script(options, 1, &end, error);
    if (!status) status = submit(part, 0, &jobs[0], error);
    if (!status) status = submit(end, jobs[0], &jobs[1], error);
    free(part);
    free(end);
    return status;
}
