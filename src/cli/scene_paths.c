// Where scenes are: in scenes/ of the folder that the user is in, and where the program keeps those that came with it.
#include "change.h"
#include "command.h"

#include "files.h"
#include "names.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Scene files of this folder, or where it has none those that came with the program. Free with globfree in any case.
static void find_scenes(glob_t *found) {
    *found = (glob_t){0};
    if (!glob("scenes/*.yaml", 0, NULL, found)) return;
    char pattern[4200], data[4096];
    if (!ck_path_data(data, sizeof data)) return;
    snprintf(pattern, sizeof pattern, "%s/scenes/*.yaml", data);
    glob(pattern, 0, NULL, found);
}

static const char *scene_name(const void *table, int index) {
    const glob_t *found = table;
    return index < (int)found->gl_pathc ? strrchr(found->gl_pathv[index], '/') + 1 : NULL;
}

static ck_Status fail_scene(const char *name, ck_Error *error) {
    glob_t found;
    char hint[240];
    find_scenes(&found);
    for (size_t i = 0; i < found.gl_pathc; i++) *strrchr(found.gl_pathv[i], '.') = 0;
    ck_name_hint(hint, sizeof hint, name, scene_name, &found);
    globfree(&found);
    return ck_fail(error, CK_BAD_INPUT,
                   "there is no scenes/%s.yaml%s; give a path, or a name that 'clothcheck list' tells", name, hint);
}

ck_Status ck_scene_path(char **path, const char *scene, ck_Error *error) {
    const int length = ck_change_file_length(scene);
    const char *changes = scene + length;
    char name[4096], data[4096];
    snprintf(name, sizeof name, "%.*s", length, scene);
    bool is_bare = !strchr(name, '/') && !strchr(name, '.');
    char *file = NULL;
    if (asprintf(&file, is_bare ? "scenes/%s.yaml" : "%s", name) < 0) file = NULL;
    if (file && is_bare && access(file, F_OK) && ck_path_data(data, sizeof data)) {
        free(file);
        if (asprintf(&file, "%s/scenes/%s.yaml", data, name) < 0) file = NULL;
    }
    if (!file || asprintf(path, "%s%s", file, changes) < 0) *path = NULL;
    const bool is_there = file && (!is_bare || !access(file, F_OK));
    free(file);
    if (!*path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (is_there) return CK_OK;
    free(*path);
    *path = NULL;
    return fail_scene(name, error);
}

ck_Status ck_arguments_add_scene(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    char **scenes = realloc(arguments->scenes, sizeof *scenes * (size_t)(arguments->scene_count + 1));
    if (!scenes) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    arguments->scenes = scenes;
    ck_Status status = ck_scene_path(&scenes[arguments->scene_count], scene, error);
    if (!status) arguments->scene_count++;
    return status;
}

ck_Status ck_arguments_all_scenes(ck_Arguments *arguments, ck_Error *error) {
    glob_t found;
    if (arguments->scene_count) return CK_OK;
    find_scenes(&found);
    ck_Status status = found.gl_pathc ? CK_OK
                                      : ck_fail(error, CK_BAD_INPUT,
                                                "no SCENE is given and there is none in scenes/; give the paths of "
                                                "scene files");
    for (size_t i = 0; i < found.gl_pathc && !status; i++)
        status = ck_arguments_add_scene(arguments, found.gl_pathv[i], error);
    globfree(&found);
    return status;
}
