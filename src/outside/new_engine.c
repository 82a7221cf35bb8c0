#include "code.h"
#include "files.h"
#include "outside.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern const char ck_template_engine[], ck_template_cmake[], ck_template_check[], ck_template_readme[];

static ck_Status write_file(const char *directory, const char *file, const char *text, const char *name,
                            ck_Error *error) {
    ck_WholeFile whole;
    ck_Code code = {.text = text};
    ck_code_text(&code, "name", name);
    ck_Status status = ck_whole_file_open(&whole, directory, file, error);
    if (!status) {
        ck_code_fill(whole.file, &code);
        status = ck_whole_file_close(&whole, error);
    }
    ck_whole_file_discard(&whole);
    return status;
}

ck_Status ck_outside_new_engine(const char *name, ck_Error *error) {
    char file[80], path[200];
    // it becomes a target of CMake and the name of an engine
    if (!*name || strlen(name) > 40 ||
        strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") != strlen(name))
        return ck_fail(error, CK_BAD_INPUT,
                       "an engine cannot be named '%.60s': take at most 40 letters, digits, _ and -", name);
    if (!access(name, F_OK)) return ck_fail(error, CK_BAD_INPUT, "%s: is there already; give another name", name);
    snprintf(file, sizeof file, "%s.c", name);
    const struct {
        const char *file, *text;
    } files[] = {{file, ck_template_engine},
                 {"CMakeLists.txt", ck_template_cmake},
                 {"check", ck_template_check},
                 {"README.md", ck_template_readme}};
    ck_PartFolder folder;
    ck_Status status = ck_part_folder_open(&folder, ".", name, error);
    for (size_t i = 0; i < sizeof files / sizeof *files && !status; i++)
        status = write_file(folder.path, files[i].file, files[i].text, name, error);
    snprintf(path, sizeof path, "%s/check", folder.path ? folder.path : name);
    if (!status && chmod(path, 0755)) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (!status && rename(folder.path, name)) status = ck_fail(error, CK_IO, "%s: %s", name, strerror(errno));
    ck_part_folder_close(&folder);
    return status;
}
