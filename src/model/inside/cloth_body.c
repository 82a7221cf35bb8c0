// A rectangle of cloth: a grid with springs along rows, columns and diagonals, or rows of triangles.
#include "body.h"

#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum Pattern { SQUARE, CROSS, TRIANGLE, PATTERNS } Pattern;
static const char *const pattern_names[PATTERNS] = {"square", "cross", "triangle"};

// the springs that start at a node, towards growing row and column
static const struct {
    int row, column;
    ck_SpringKind kind;
} cloth_springs[] = {
    {0, 1, CK_STRUCTURAL}, {1, 0, CK_STRUCTURAL}, {1, 1, CK_SHEAR}, {1, -1, CK_SHEAR}, {0, 2, CK_BEND}, {2, 0, CK_BEND},
};
#define CLOTH_SPRINGS (sizeof cloth_springs / sizeof *cloth_springs)

// is_cross: of the two diagonals of a square one, in turns, so that every second particle has four and the others none.
static void add_cloth_springs(ck_Model *model, const ck_SceneCloth *cloth, const ck_SceneSprings *springs,
                              bool is_cross) {
    int rows = (int)cloth->rows, columns = (int)cloth->columns;
    for (size_t s = 0; s < CLOTH_SPRINGS; s++) {
        double length = cloth->spacing * hypot(cloth_springs[s].row, cloth_springs[s].column);
        for (int row = 0; row < rows; row++)
            for (int column = 0; column < columns; column++) {
                int to_row = row + cloth_springs[s].row, to_column = column + cloth_springs[s].column;
                if (to_row >= rows || to_column >= columns || to_column < 0) continue;
                if (is_cross && cloth_springs[s].kind == CK_SHEAR && (row + column) % 2) continue;
                ck_body_add_spring(model, springs, row * columns + column, to_row * columns + to_column, length,
                                   cloth_springs[s].kind);
            }
    }
}

// The springs of triangles: along rows, and from each particle to two of the row below. Every second row stands half a
// spacing farther on.
static ck_Status add_triangles(ck_Model *model, const ck_SceneCloth *cloth, const ck_SceneSprings *springs) {
    const int rows = (int)cloth->rows, columns = (int)cloth->columns;
    model->triangles = malloc(2 * (size_t)model->particle_count * sizeof *model->triangles);
    if (!model->triangles) return CK_NO_MEMORY;
    for (int i = 0; i < model->particle_count; i++) {
        const int row = i / columns, column = i % columns, shift = row % 2;
        const int below = i + columns, ends[3] = {column + 1 < columns ? i + 1 : -1,
                                                  row + 1 < rows && column - 1 + shift >= 0 ? below - 1 + shift : -1,
                                                  row + 1 < rows && column + shift < columns ? below + shift : -1};
        for (int k = 0; k < 3 && springs; k++)
            if (ends[k] >= 0) ck_body_add_spring(model, springs, i, ends[k], cloth->spacing, CK_STRUCTURAL);
        if (row + 1 == rows || column + 1 == columns) continue;
        // between this row's pair and the one below, of which one stands between the other
        const int faces[2][3] = {{i, shift ? below + 1 : below, i + 1}, {shift ? i : i + 1, below, below + 1}};
        memcpy(model->triangles[model->triangle_count], faces, sizeof faces);
        model->triangle_count += 2;
    }
    return CK_OK;
}

static ck_Status read_pattern(Pattern *pattern, const ck_Scene *scene, ck_Error *error) {
    const char *name = scene->file->cloth->pattern;
    *pattern = SQUARE;
    while (name && *pattern < PATTERNS && strcmp(name, pattern_names[*pattern])) (*pattern)++;
    return *pattern < PATTERNS ? CK_OK
                               : ck_scene_fail(scene, "cloth.pattern", error,
                                               "cloth.pattern is %s; it must be square, cross or triangle", name);
}

static void place(ck_Model *model, const ck_SceneCloth *cloth, Pattern pattern, const double *across,
                  const double *down) {
    const double origin[3] = {0}, row_distance = cloth->spacing * (pattern == TRIANGLE ? sqrt(0.75) : 1);
    for (int i = 0; i < model->particle_count; i++) {
        const int row = i / (int)cloth->columns, column = i % (int)cloth->columns;
        double *position = model->position + 3 * i;
        memcpy(position, cloth->origin ? cloth->origin : origin, sizeof origin);
        ck_add_scaled(position, cloth->spacing * (column + (pattern == TRIANGLE ? 0.5 * (row % 2) : 0)), across);
        ck_add_scaled(position, row_distance * row, down);
    }
}

static ck_Status set_mass(ck_Model *model, const ck_Scene *scene, Pattern pattern, ck_Error *error) {
    const ck_SceneCloth *cloth = scene->file->cloth;
    const double cells = (cloth->rows - 1.0) * (cloth->columns - 1.0),
                 area = cells * cloth->spacing * cloth->spacing * (pattern == TRIANGLE ? sqrt(0.75) : 1);
    double mass;
    ck_Status status = ck_body_mass(&mass, scene, cloth->mass, area, "cloth", error);
    for (int i = 0; i < model->particle_count && !status; i++) model->mass[i] = mass / model->particle_count;
    return status;
}

ck_Status ck_model_build_cloth(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneCloth *cloth = scene->file->cloth;
    const ck_SceneSprings *springs = ck_body_springs(scene);
    const double right[3] = {1, 0, 0}, downwards[3] = {0, -1, 0};
    double across[3], down[3];
    Pattern pattern;
    ck_Status status = ck_model_unit(across, cloth->across ? cloth->across : right, scene, "cloth.across", error);
    if (!status) status = ck_model_unit(down, cloth->down ? cloth->down : downwards, scene, "cloth.down", error);
    if (!status) status = read_pattern(&pattern, scene, error);
    if (status) return status;
    if (fabs(ck_dot(across, down)) > 1e-9)
        return ck_scene_fail(scene, "cloth", error, "cloth.across and cloth.down must be at right angles");
    double particles = (double)cloth->rows * cloth->columns;
    status = ck_body_allocate(model, scene, "cloth", particles, CLOTH_SPRINGS * particles, error);
    if (status) return status;
    place(model, cloth, pattern, across, down);
    model->body = pattern == TRIANGLE ? CK_MESH : CK_CLOTH;
    model->columns = pattern == TRIANGLE ? 0 : (int)cloth->columns;
    model->spacing = cloth->spacing;
    model->size = cloth->spacing * fmax(1, fmax(cloth->rows, cloth->columns) - 1);
    status = set_mass(model, scene, pattern, error);
    if (!status && pattern == TRIANGLE) return add_triangles(model, cloth, springs);
    if (!status && springs) add_cloth_springs(model, cloth, springs, pattern == CROSS);
    return status;
}
