#include "template.h"

#include "files.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_template_sources(char *sources, size_t size, ck_Error *error) {
    char data[PATH_MAX], named[PATH_MAX + 10], found[PATH_MAX];
    const bool has_data = ck_path_data(data, sizeof data);
    snprintf(named, sizeof named, "%s/reports", data);
    if (!has_data || !realpath(named, found))
        return ck_fail(error, CK_IO, "%s: %s; it must hold the scripts of charts and page", named, strerror(errno));
    snprintf(sources, size, "%s", found);
    return CK_OK;
}

static ck_Status include(FILE *file, const char *sources, const char *name, ck_Error *error) {
    static const char three[] = "three/";
    bool is_three = !strncmp(name, three, strlen(three));
    char *path, *bytes;
    size_t size;
    if (asprintf(&path, "%s%s%s", is_three ? CK_THREE_DIRECTORY : sources, is_three ? "/" : "/page/",
                 is_three ? name + strlen(three) : name) < 0)
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_file_read(&bytes, &size, path, error);
    if (!status) fwrite(bytes, 1, size, file);
    free(bytes);
    free(path);
    return status;
}

// A line of the template, with the nonce where it has its place.
static void write_line(FILE *file, const char *line, const char *nonce) {
    static const char word[] = "@nonce";
    for (const char *place; (place = strstr(line, word)); line = place + strlen(word))
        fprintf(file, "%.*s%s", (int)(place - line), line, nonce);
    fprintf(file, "%s\n", line);
}

ck_Status ck_template_write(FILE *file, const char *sources, const char *name, const char *nonce,
                            ck_Status (*part)(void *context, const char *word, ck_Error *error), void *context,
                            ck_Error *error) {
    static const char include_word[] = "@include ";
    char *path, *text = NULL;
    size_t size;
    if (asprintf(&path, "%s/page/%s", sources, name) < 0) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_file_read(&text, &size, path, error);
    char *rest = text;
    for (char *line; !status && (line = strsep(&rest, "\n"));) {
        if (!strncmp(line, include_word, strlen(include_word)))
            status = include(file, sources, line + strlen(include_word), error);
        else if (*line == '@' && part)
            status = part(context, line + 1, error);
        else
            write_line(file, line, nonce);
    }
    free(text);
    free(path);
    return status;
}
