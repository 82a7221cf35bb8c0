// Scenes: whatever a file holds is a model of finite numbers, or an error that says where.
#include "fuzz.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40];
    ck_Scene scene;
    ck_Model model = {0};
    ck_Error error = {0};
    const int file = fuzz_file(path, data, size);
    ck_Status status = ck_scene_load(&scene, path, &error);
    if (!status) status = ck_model_build(&model, &scene, &error);
    if (status == CK_BAD_INPUT && strncmp(error.message, path, strlen(path))) abort();
    for (int i = 0; i < 3 * model.particle_count && !status; i++)
        if (!isfinite(model.position[i]) || !isfinite(model.velocity[i]) || !(model.mass[i / 3] > 0)) abort();
    for (int i = 0; i < model.spring_count && !status; i++)
        if (model.springs[i].a < 0 || model.springs[i].a >= model.particle_count || model.springs[i].b < 0 ||
            model.springs[i].b >= model.particle_count)
            abort();
    ck_model_free(&model);
    ck_scene_free(&scene);
    close(file);
    return 0;
}
