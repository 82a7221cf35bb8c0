#include "fixture_program.h"

#include "fixture.h"

#include <sys/wait.h>
#include <unistd.h>

char fixture_directory[] = "/tmp/clothcheck-test-XXXXXX";

int fixture_make_directory(void **state) {
    (void)state;
    return mkdtemp(fixture_directory) ? 0 : -1;
}

int fixture_remove_directory(void **state) {
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -rf %s", fixture_directory);
    return system(command);
}

pid_t fixture_start(const char *arguments) {
    char command[1000];
    snprintf(command, sizeof command, "cd %s/.. && exec %s %s >%s/output 2>&1", SCENE_DIRECTORY, PROGRAM, arguments,
             fixture_directory);
    pid_t child = fork();
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command, NULL);
        _exit(127);
    }
    assert_true(child > 0);
    return child;
}

int fixture_program(const char *arguments) {
    int status;
    waitpid(fixture_start(arguments), &status, 0);
    if (!WIFEXITED(status)) fail_msg("%s: ended by signal %d", arguments, WTERMSIG(status));
    return WEXITSTATUS(status);
}

char *fixture_read(const char *name) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s", fixture_directory, name);
    FILE *file = fopen(path, "r");
    if (!file) return NULL;
    char *text = calloc(1, 1 << 22);
    size_t length = fread(text, 1, (1 << 22) - 1, file);
    text[length] = 0;
    fclose(file);
    return text;
}

void fixture_assert_output(const char *wanted) {
    char *output = fixture_read("output");
    if (!output || !strstr(output, wanted)) fail_msg("wanted '%s' in: %s", wanted, output ? output : "nothing");
    free(output);
}
