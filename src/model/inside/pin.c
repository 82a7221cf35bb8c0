// The names of pins: corners and edges of a cloth, numbers, places and groups.
#include "body.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// a rectangle of rows and columns, both ends included; −1 counts from the end
static const struct {
    const char *name;
    int row_from, row_to, column_from, column_to;
} cloth_pins[] = {
    {"top_left", 0, 0, 0, 0},         {"top_right", 0, 0, -1, -1},   {"bottom_left", -1, -1, 0, 0},
    {"bottom_right", -1, -1, -1, -1}, {"top_edge", 0, 0, 0, -1},     {"bottom_edge", -1, -1, 0, -1},
    {"left_edge", 0, -1, 0, 0},       {"right_edge", 0, -1, -1, -1},
};

static int from_end(int index, int count) {
    return index < 0 ? count + index : index;
}

static void choose_rectangle(int *chosen, int *count, size_t pin, int rows, int columns) {
    for (int row = from_end(cloth_pins[pin].row_from, rows); row <= from_end(cloth_pins[pin].row_to, rows); row++)
        for (int column = from_end(cloth_pins[pin].column_from, columns);
             column <= from_end(cloth_pins[pin].column_to, columns); column++)
            chosen[(*count)++] = row * columns + column;
}

// Particles that start on one side of a plane across an axis, as "y > 0.5", or in a box, as "box 0 0 0 1 1 1".
static void choose_place(int *chosen, int *count, const ck_Model *model, const char *pin) {
    double low[3] = {-INFINITY, -INFINITY, -INFINITY}, high[3] = {INFINITY, INFINITY, INFINITY}, bound;
    char axis, than;
    int used = 0;
    if (sscanf(pin, "box %lf %lf %lf %lf %lf %lf%n", low, low + 1, low + 2, high, high + 1, high + 2, &used) == 6) {
        if (pin[used]) return;
    } else if (sscanf(pin, "%c %c %lf%n", &axis, &than, &bound, &used) == 3 && !pin[used] && axis >= 'x' &&
               axis <= 'z' && (than == '<' || than == '>')) {
        *(than == '<' ? &high[axis - 'x'] : &low[axis - 'x']) = bound;
    } else {
        return;
    }
    for (int i = 0; i < model->particle_count; i++) {
        bool is_inside = true;
        for (int k = 0; k < 3; k++)
            is_inside &= model->position[3 * i + k] >= low[k] && model->position[3 * i + k] <= high[k];
        if (is_inside) chosen[(*count)++] = i;
    }
}

// The particles of a mesh that its file names together; each once, though a name may be that of several groups.
static ck_Status choose_group(int *chosen, int *count, const ck_Model *model, const char *pin) {
    bool *is_chosen = calloc((size_t)model->particle_count, sizeof *is_chosen);
    if (!is_chosen) return CK_NO_MEMORY;
    for (int i = 0; i < model->group_count; i++)
        for (int k = 0; k < model->groups[i].particle_count && !strcmp(model->groups[i].name, pin); k++)
            is_chosen[model->groups[i].particles[k]] = true;
    for (int i = 0; i < model->particle_count; i++)
        if (is_chosen[i]) chosen[(*count)++] = i;
    free(is_chosen);
    return CK_OK;
}

static ck_Status fail_pin(const ck_Model *model, const ck_Scene *scene, const char *pin, const char *path,
                          ck_Error *error) {
    const ck_SceneCloth *cloth = scene->file->cloth;
    if (cloth)
        return ck_scene_fail(scene, path, error,
                             "pin %s is not on the cloth; give a corner (top_left …), an edge (top_edge …), row:column "
                             "up to %u:%u, a number up to %d, a place as 'y > 0.5', or 'box' and six numbers",
                             pin, cloth->rows - 1, cloth->columns - 1, model->particle_count - 1);
    return ck_scene_fail(
        scene, path, error,
        "pin %s is not on the %s; give first, last, a number up to %d,%s a place as 'y > 0.5', or 'box' "
        "and six numbers",
        pin,
        scene->file->rope   ? "rope"
        : scene->file->mesh ? "mesh"
                            : "network",
        model->particle_count - 1, scene->file->mesh ? " a group of the file," : "");
}

ck_Status ck_model_resolve_pin(int *chosen, int *count, const ck_Model *model, const ck_Scene *scene, const char *pin,
                               const char *path, ck_Error *error) {
    const ck_SceneCloth *cloth = scene->file->cloth;
    *count = 0;
    if (cloth)
        for (size_t i = 0; i < sizeof cloth_pins / sizeof *cloth_pins; i++)
            if (!strcmp(pin, cloth_pins[i].name))
                choose_rectangle(chosen, count, i, (int)cloth->rows, (int)cloth->columns);
    choose_place(chosen, count, model, pin);
    if (!*count && choose_group(chosen, count, model, pin)) return CK_NO_MEMORY;
    if (!cloth && !strcmp(pin, "first")) chosen[(*count)++] = 0;
    if (!cloth && !strcmp(pin, "last")) chosen[(*count)++] = model->particle_count - 1;

    // row:column or a number, with nothing behind it
    unsigned row, column;
    int used = 0;
    bool digits = !*count && pin[0] && strspn(pin, "0123456789:") == strlen(pin);
    if (digits && cloth && sscanf(pin, "%9u:%9u%n", &row, &column, &used) == 2 && !pin[used] && row < cloth->rows &&
        column < cloth->columns)
        chosen[(*count)++] = (int)(row * cloth->columns + column);
    if (digits && sscanf(pin, "%9u%n", &row, &used) == 1 && !pin[used] && row < (unsigned)model->particle_count)
        chosen[(*count)++] = (int)row;
    return *count ? CK_OK : fail_pin(model, scene, pin, path, error);
}
