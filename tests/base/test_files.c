// Files that appear whole or not at all, and what killed processes leave; texts that are no UTF-8.
#include "fixture.h"

#include "files.h"
#include "names.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

static char directory[] = "/tmp/clothcheck-files-XXXXXX";

static bool is_there(const char *name) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return !access(path, F_OK);
}

static void touch(const char *name) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("half", file);
    fclose(file);
}

static void drop(const char *name) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    unlink(path);
}

// Another process writes while one begins; then it is killed, and the next finds what it left.
static void test_left_behind(void **state) {
    (void)state;
    int ready[2];
    char name[60], byte;
    ck_WholeFile whole;
    assert_int_equal(pipe(ready), 0);
    const pid_t other = fork();
    if (!other) {
        if (!ck_whole_file_open(&whole, directory, "a.csv", NULL)) fputs("some rows", whole.file);
        fflush(whole.file);
        if (write(ready[1], "x", 1) < 0) _exit(1);
        for (;;) pause();
    }
    assert_int_equal(read(ready[0], &byte, 1), 1);
    snprintf(name, sizeof name, "a.csv.%d.part", (int)other);
    touch("a.csv.1.part");
    touch("film.001.part");
    touch("mine.part");
    touch("notes.x1.part");
    for (int killed = 0; killed <= 1; killed++) {
        if (killed) kill(other, SIGKILL);
        if (killed) waitpid(other, NULL, 0);
        assert_true(is_there(name));
        assert_int_equal(ck_whole_file_open(&whole, directory, "a.csv", NULL), CK_OK);
        fputs("all rows", whole.file);
        assert_true(is_there("a.csv") == killed);
        assert_int_equal(ck_whole_file_close(&whole, NULL), CK_OK);
        assert_true(is_there("a.csv"));
        // who writes keeps its file, whoever begins the same
        assert_true(is_there(name) == !killed);
        assert_false(is_there("a.csv.1.part"));
    }
    // names of others are not ours to remove
    assert_true(is_there("mine.part") && is_there("notes.x1.part") && is_there("film.001.part"));
    drop("mine.part");
    drop("notes.x1.part");
    drop("film.001.part");
    drop("a.csv");
}

static void test_discarded(void **state) {
    (void)state;
    char name[60];
    ck_WholeFile whole;
    assert_int_equal(ck_whole_file_open(&whole, directory, "c.csv", NULL), CK_OK);
    snprintf(name, sizeof name, "c.csv.%d.part", (int)getpid());
    assert_true(is_there(name));
    ck_whole_file_discard(&whole);
    assert_false(is_there(name) || is_there("c.csv"));
}

static void test_plain_text(void **state) {
    (void)state;
    static const struct {
        const char *text, *plain;
    } cases[] = {
        {"plain", "plain"},
        {"caf\xc3\xa9, \xe2\x88\x9a\xe2\x88\x9e, \xf0\x9f\x98\x80", NULL},
        {"caf\xe9", "caf?"},
        {"caf\xc3", "caf?"},
        {"\xc0\xaf", "??"},                // a slash that is longer than it need be
        {"\xed\xa0\x80", "???"},           // half of a pair
        {"\xf4\x90\x80\x80", "????"},      // beyond the last
        {"\xc3\xa9 and \xff", "?? and ?"}, // all of what is broken anywhere
        {"\xf0\x80\x80\xaf \xe0\x80\xaf", "???? ???"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[60];
        snprintf(text, sizeof text, "%s", cases[i].text);
        ck_text_plain(text);
        assert_string_equal(text, cases[i].plain ? cases[i].plain : cases[i].text);
    }
}

static void test_shell(void **state) {
    (void)state;
    static const char *const words[] = {"plain-1.yaml", "a b", "it's", "$(reboot)",   "a\nb",
                                        "cr\r'\\",      "",    "*",    "caf\xc3\xa9", "--engine=x y"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char word[100], command[200], said[100] = "";
        ck_text_shell(word, sizeof word, words[i]);
        // a row of a CSV has one line
        assert_null(strpbrk(word, "\r\n"));
        snprintf(command, sizeof command, "bash -c \"$(cat <<'END'\nprintf %%s %s\nEND\n)\"", word);
        FILE *shell = popen(command, "r");
        assert_non_null(shell);
        said[fread(said, 1, sizeof said - 1, shell)] = 0;
        assert_int_equal(pclose(shell), 0);
        assert_string_equal(said, words[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_left_behind), cmocka_unit_test(test_discarded),
                                       cmocka_unit_test(test_plain_text), cmocka_unit_test(test_shell)};
    if (!mkdtemp(directory)) return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    rmdir(directory);
    return failed;
}
