// The faces that air acts on.
#include "body.h"

#include <stdlib.h>
#include <string.h>

// Four of every square of a grid, halved along either diagonal, in air of half the density: so each corner has a
// quarter.
static void halve_squares(ck_Model *model) {
    const int columns = model->columns, rows = model->particle_count / columns;
    for (int i = 0; i < model->particle_count; i++) {
        const int row = i / columns, column = i % columns, below = i + columns;
        if (row + 1 == rows || column + 1 == columns) continue;
        const int faces[4][3] = {
            {i, below, i + 1}, {i + 1, below, below + 1}, {i, below, below + 1}, {i, below + 1, i + 1}};
        memcpy(model->wind.faces[model->wind.face_count], faces, sizeof faces);
        model->wind.face_count += 4;
    }
}

ck_Status ck_model_set_wind(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneWind *from = scene->file->wind;
    if (!from) return CK_OK;
    if (!model->triangle_count && model->columns < 2)
        return ck_scene_fail(
            scene, "wind", error,
            "wind acts on faces, which this body has none of; give a cloth, a mesh or network.triangles");
    ck_Wind *wind = &model->wind;
    *wind = (ck_Wind){.density = from->density > 0 ? from->density : 1.225, .drag = from->drag, .lift = from->lift};
    if (from->velocity) memcpy(wind->velocity, from->velocity, sizeof wind->velocity);
    const size_t count = model->triangle_count ? (size_t)model->triangle_count : 4 * (size_t)model->particle_count;
    wind->faces = malloc(count * sizeof *wind->faces);
    if (!wind->faces) return CK_NO_MEMORY;
    if (model->triangle_count) {
        memcpy(wind->faces, model->triangles, count * sizeof *wind->faces);
        wind->face_count = model->triangle_count;
    } else {
        halve_squares(model);
        wind->density *= 0.5;
    }
    return CK_OK;
}
