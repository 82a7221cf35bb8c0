// A scene's text with changes: the first line is what follows the file's name, the rest the file.
#include "fuzz.h"

#include "scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40], word[600];
    const uint8_t *end = memchr(data, '\n', size);
    if (!end) return 0;
    ck_Scene scene;
    ck_Error error = {0};
    const int file = fuzz_file(path, end + 1, size - (size_t)(end + 1 - data));
    snprintf(word, sizeof word, "%s%.*s", path, (int)(end - data < 500 ? end - data : 500), (const char *)data);
    ck_Status status = ck_scene_load(&scene, word, &error);
    if (!status && !(*scene.file->name && strlen(scene.file->name) < 200)) abort();
    ck_scene_free(&scene);
    close(file);
    return 0;
}
