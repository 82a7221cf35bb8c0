// A fabric's values as springs and masses of a pattern, the same sheet at any resolution.
#include "body.h"

#include "springs.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double poisson_of(const ck_SceneMaterial *material) {
    return material->poisson ? *material->poisson : 1.0 / 3;
}

const ck_SceneSprings *ck_body_springs(const ck_Scene *scene) {
    static const ck_SceneSprings unit = {.stiffness = 1, .shear = 1}, lines = {.stiffness = 1};
    const ck_SceneMaterial *material = scene->file->material;
    return !material ? scene->file->springs : poisson_of(material) > 0 ? &unit : &lines;
}

ck_Status ck_body_mass(double *mass, const ck_Scene *scene, double own, double area, const char *path,
                       ck_Error *error) {
    const ck_SceneMaterial *material = scene->file->material;
    const double density = material ? material->density : 0;
    *mass = own > 0 ? own : density * area;
    if ((own > 0) != (density > 0)) return CK_OK;
    return ck_scene_fail(scene, path, error,
                         own > 0 ? "%s has a mass, and the material a density; keep one"
                                 : "%s has no mass; give it one, or the material a density",
                         path);
}

double ck_body_share_area(ck_Model *model, double density) {
    double whole = 0;
    memset(model->mass, 0, sizeof *model->mass * (size_t)model->particle_count);
    for (int i = 0; i < model->triangle_count; i++) {
        const int *corners = model->triangles[i];
        double normal[3];
        ck_triangle_normal(normal, model->position + 3 * corners[0], model->position + 3 * corners[1],
                           model->position + 3 * corners[2]);
        const double area = 0.5 * ck_length(normal);
        whole += area;
        for (int k = 0; k < 3; k++) model->mass[corners[k]] += density * area / 3;
    }
    return whole;
}

static bool is_at_border(int index, int count) {
    return index == 0 || index == count - 1;
}

// A grid's springs along rows and columns have k, half of it at the border, and its diagonals kd, or the one of a cross
// 2·kd: with C = Eh/(1 − ν²), kd = ν·C and k = (1 − ν)·C. Masses by the area around each particle.
// Source: energy k·(ε₁₁² + ε₂₂²)/2 + kd·(ε₁₁ + ε₂₂)²/2 + 2·kd·ε₁₂² an area.
static void set_grid(ck_Model *model, const ck_SceneMaterial *material, bool is_cross) {
    const int columns = model->columns, rows = model->particle_count / columns;
    const double poisson = poisson_of(material), across = material->membrane / (1 - poisson * poisson);
    double mass = 0;
    for (int i = 0; i < model->particle_count; i++) mass += model->mass[i];
    for (int i = 0; i < model->spring_count; i++) {
        ck_Spring *spring = &model->springs[i];
        const int row = spring->a / columns, column = spring->a % columns;
        const bool is_row = spring->b / columns == row,
                   is_border = is_row ? is_at_border(row, rows) : is_at_border(column, columns);
        spring->stiffness = spring->kind == CK_SHEAR ? (is_cross ? 2 : 1) * poisson * across
                                                     : (is_border ? 0.5 : 1) * (1 - poisson) * across;
    }
    for (int i = 0; i < model->particle_count; i++)
        model->mass[i] = mass / ((rows - 1.0) * (columns - 1.0)) * (is_at_border(i / columns, rows) ? 0.5 : 1) *
                         (is_at_border(i % columns, columns) ? 0.5 : 1);
}

// Shares the whole mass by the area of faces.
static void share_mass(ck_Model *model) {
    double mass = 0;
    for (int i = 0; i < model->particle_count; i++) mass += model->mass[i];
    ck_body_share_area(model, mass / ck_body_share_area(model, 1));
}

// Each edge has Eh times the area of its faces over its length's square: of equilateral triangles √3/2·Eh.
// Source: Van Gelder 1998, Approximate simulation of elastic membranes by triangulated spring meshes.
static ck_Status set_faces(ck_Model *model, const ck_SceneMaterial *material) {
    // the springs of each particle, as lists by its first end
    int *first = malloc(sizeof *first * ((size_t)model->particle_count + (size_t)model->spring_count + 1));
    if (!first) return CK_NO_MEMORY;
    int *next = first + model->particle_count;
    for (int i = 0; i < model->particle_count; i++) first[i] = -1;
    for (int i = 0; i < model->spring_count; i++) {
        ck_Spring *spring = &model->springs[i];
        const int least = spring->a < spring->b ? spring->a : spring->b;
        spring->stiffness = 0;
        next[i] = first[least];
        first[least] = i;
    }
    for (int i = 0; i < 3 * model->triangle_count; i++) {
        const int *corners = model->triangles[i / 3], a = corners[i % 3], b = corners[(i + 1) % 3];
        double normal[3];
        ck_triangle_normal(normal, model->position + 3 * corners[0], model->position + 3 * corners[1],
                           model->position + 3 * corners[2]);
        for (int s = first[a < b ? a : b]; s >= 0; s = next[s]) {
            ck_Spring *spring = &model->springs[s];
            if ((spring->a == a && spring->b == b) || (spring->a == b && spring->b == a))
                spring->stiffness += material->membrane * 0.5 * ck_length(normal) / (spring->rest * spring->rest);
        }
    }
    free(first);
    return CK_OK;
}

static ck_Status check(const ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneFile *file = scene->file;
    const ck_SceneMaterial *material = file->material;
    if (file->springs)
        return ck_scene_fail(scene, "springs", error, "springs and material both say what springs are; keep one");
    if (!file->cloth && !file->mesh)
        return ck_scene_fail(scene, "material", error, "a material is of a sheet: a cloth or a mesh");
    if (file->cloth && (file->cloth->rows < 2 || file->cloth->columns < 2))
        return ck_scene_fail(scene, "cloth", error, "a sheet has two rows and two columns at least");
    if (!model->columns && fabs(poisson_of(material) - 1.0 / 3) > 0.01)
        return ck_scene_fail(scene, "material.poisson", error,
                             "material.poisson is %g; springs along triangles are 1/3, whatever their stiffness: give "
                             "0.333, or a cloth of another pattern",
                             poisson_of(material));
    if (model->columns && !(poisson_of(material) < 1))
        return ck_scene_fail(scene, "material.poisson", error,
                             "material.poisson is %g; springs along squares and diagonals have one below 1",
                             poisson_of(material));
    return CK_OK;
}

ck_Status ck_model_set_material(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneMaterial *material = scene->file->material;
    if (!material) return CK_OK;
    ck_Status status = check(model, scene, error);
    if (status) return status;
    const ck_SceneCloth *cloth = scene->file->cloth;
    const bool is_cross = cloth && cloth->pattern && !strcmp(cloth->pattern, "cross");
    model->membrane = material->membrane;
    model->poisson = model->columns ? poisson_of(material) : 1.0 / 3;
    if (model->columns) {
        set_grid(model, material, is_cross);
    } else {
        if (cloth) share_mass(model); // a mesh's is shared already
        status = set_faces(model, material);
    }
    for (int i = 0; i < model->spring_count; i++)
        model->springs[i].damping = material->retardation * model->springs[i].stiffness;
    return status;
}
