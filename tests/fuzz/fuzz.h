// What the fuzz targets share: an input as a file, and a model to read against.
#ifndef CK_FUZZ_H
#define CK_FUZZ_H

#include "model.h"
#include "scene.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

// A file in memory that holds the input; its name goes to path. Close the number.
static inline int fuzz_file(char path[40], const uint8_t *data, size_t size) {
    const int file = memfd_create("input", 0);
    if (file < 0 || write(file, data, size) != (ssize_t)size) abort();
    snprintf(path, 40, "/proc/self/fd/%d", file);
    return file;
}

// A folder of this process's own, made once; tests/fuzz/run clears it away.
static inline const char *fuzz_folder(void) {
    static char folder[4096];
    const char *place = getenv("TMPDIR");
    if (*folder) return folder;
    snprintf(folder, sizeof folder, "%s/clothcheck-fuzz-XXXXXX", place ? place : "/tmp");
    if (!mkdtemp(folder)) abort();
    return folder;
}

// The input as a file of that name, in that folder, where the process stays from then on.
static inline void fuzz_write(const char *name, const uint8_t *data, size_t size) {
    static int is_there;
    if (!is_there && (chdir(fuzz_folder()) || mkdir("replays", 0777))) abort();
    is_there = 1;
    FILE *file = fopen(name, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file)) abort();
}

// The model of a scene of this many bytes, made once.
static inline const ck_Model *fuzz_model(const char *text) {
    static ck_Scene scene;
    static ck_Model model;
    char path[40];
    if (model.name) return &model;
    const int file = fuzz_file(path, (const uint8_t *)text, strlen(text));
    if (ck_scene_load(&scene, path, NULL) || ck_model_build(&model, &scene, NULL)) abort();
    close(file);
    return &model;
}

#endif
