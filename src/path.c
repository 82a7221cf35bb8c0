#include "path.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

char *ck_path_join(const char *directory, const char *name, const char *suffix) {
    size_t size = strlen(directory) + strlen(name) + strlen(suffix) + 2;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%s%s%s%s", directory, *name == '.' ? "" : "/", name, suffix);
    return path;
}

int ck_path_make(const char *directory) {
    char path[4096];
    if (snprintf(path, sizeof path, "%s", directory) >= (int)sizeof path) return errno = ENAMETOOLONG;
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        if (mkdir(path, 0777) && errno != EEXIST) return errno;
        *slash = '/';
    }
    return mkdir(path, 0777) && errno != EEXIST ? errno : 0;
}
