#include "scaled_model.h"

#include "vector.h"

#include <stdlib.h>
#include <string.h>

static void *copy_of(const void *from, size_t count, size_t size) {
    void *copy = malloc(count * size + 1);
    if (copy && count) memcpy(copy, from, count * size);
    return copy;
}

static void divide(double *values, int count, double by) {
    for (int i = 0; i < count; i++) values[i] /= by;
}

static void scale_collider(ck_Collider *collider, double unit) {
    divide(collider->point, 3, unit);
    divide(&collider->radius, 1, unit);
    divide(collider->half, 3, unit);
}

static void scale_lengths(ck_Model *model, double unit) {
    divide(model->position, 3 * model->particle_count, unit);
    divide(model->velocity, 3 * model->particle_count, unit);
    divide(model->gravity, 3, unit);
    divide(model->force, 3, unit);
    divide(model->wind.velocity, 3, unit);
    divide(&model->wind.density, 1, 1 / (unit * unit * unit));
    divide(&model->size, 1, unit);
    divide(&model->spacing, 1, unit);
    for (int i = 0; i < model->spring_count; i++) divide(&model->springs[i].rest, 1, unit);
    for (int i = 0; i < model->hinge_count; i++) {
        divide(model->hinges[i].weights, 4, 1 / unit);
        divide(&model->hinges[i].stiffness, 1, unit * unit);
    }
    for (int i = 0; i < model->driven_count; i++) divide(model->driven[i].start, 3, unit);
    for (int i = 0; i < model->path_count; i++) {
        divide(model->paths[i].vector, 3, unit);
        for (int j = 0; j < model->paths[i].point_count; j++) divide(model->paths[i].points[j] + 1, 3, unit);
    }
    for (int i = 0; i < model->collider_count; i++) scale_collider(&model->colliders[i], unit);
    for (int i = 0; i < model->rigid_count; i++) {
        scale_collider(&model->rigid[i].shape, unit);
        divide(model->rigid[i].inertia, 3, unit * unit);
    }
}

static void scale_masses(ck_Model *model, double unit) {
    divide(&model->wind.density, 1, unit);
    divide(model->mass, model->particle_count, unit);
    divide(model->force, 3, unit);
    for (int i = 0; i < model->spring_count; i++) {
        divide(&model->springs[i].stiffness, 1, unit);
        divide(&model->springs[i].damping, 1, unit);
    }
    for (int i = 0; i < model->hinge_count; i++) divide(&model->hinges[i].stiffness, 1, unit);
    for (int i = 0; i < model->rigid_count; i++) divide(model->rigid[i].inertia, 3, unit);
}

// The power of two at or below a number.
static double power_below(double number) {
    return ldexp(1, ilogb(number));
}

static double length_unit(const ck_Model *model) {
    return power_below(model->size);
}

static double mass_unit(const ck_Model *model) {
    double total = 0;
    for (int i = 0; i < model->particle_count; i++) total += model->mass[i];
    return power_below(total / model->particle_count);
}

// Paths and their points, and what goes along them. False without memory.
static bool copy_paths(ck_Model *own, const ck_Model *model) {
    bool has_all = true;
    own->paths = copy_of(model->paths, (size_t)model->path_count, sizeof(ck_Path));
    own->driven = copy_of(model->driven, (size_t)model->driven_count, sizeof(ck_Driven));
    for (int i = 0; i < model->path_count && own->paths; i++) {
        const ck_Path *from = &model->paths[i];
        own->paths[i].points = copy_of(from->points, (size_t)from->point_count, sizeof *from->points);
        has_all &= own->paths[i].points != NULL;
    }
    if (!own->paths || !own->driven) return false;
    for (int i = 0; i < model->driven_count; i++)
        own->driven[i].path = own->paths + (model->driven[i].path - model->paths);
    for (int i = 0; i < model->collider_count && own->colliders; i++)
        if (model->colliders[i].path) own->colliders[i].path = own->paths + (model->colliders[i].path - model->paths);
    return has_all;
}

ck_Status ck_scaled_model_create(ck_ScaledModel *scaled, const ck_Model *model) {
    const size_t particles = (size_t)model->particle_count;
    *scaled = (ck_ScaledModel){.model = *model};
    ck_Model *own = &scaled->model;
    own->position = copy_of(model->position, 3 * particles, sizeof(double));
    own->velocity = copy_of(model->velocity, 3 * particles, sizeof(double));
    own->mass = copy_of(model->mass, particles, sizeof(double));
    own->pinned = copy_of(model->pinned, particles, sizeof(bool));
    own->springs = copy_of(model->springs, (size_t)model->spring_count, sizeof(ck_Spring));
    own->hinges = copy_of(model->hinges, (size_t)model->hinge_count, sizeof(ck_Hinge));
    own->colliders = copy_of(model->colliders, (size_t)model->collider_count, sizeof(ck_Collider));
    // the nodes that bodies hang on stay those of the model
    own->rigid = copy_of(model->rigid, (size_t)model->rigid_count, sizeof(ck_RigidBody));
    const bool has_paths = copy_paths(own, model);
    if (!has_paths || !own->position || !own->velocity || !own->mass || !own->pinned || !own->springs || !own->hinges ||
        !own->colliders || !own->rigid) {
        ck_scaled_model_free(scaled);
        return CK_NO_MEMORY;
    }
    scaled->length = length_unit(model);
    scaled->mass = mass_unit(model);
    scale_lengths(own, scaled->length);
    scale_masses(own, scaled->mass);
    return CK_OK;
}

void ck_scaled_model_ledger(ck_Ledger *ledger, const ck_Model *model) {
    const char *formula = "power of two below the size and the mean mass, so that all bodies are alike to the engine; "
                          "native values below are in SI";
    ck_ledger_add(ledger,
                  (ck_LedgerRow){"unit of length", 1, "m", "length", 1 / length_unit(model), formula, CK_EXACT});
    ck_ledger_add(ledger, (ck_LedgerRow){"unit of mass", 1, "kg", "mass", 1 / mass_unit(model), formula, CK_EXACT});
}

void ck_scaled_model_free(ck_ScaledModel *scaled) {
    for (int i = 0; i < scaled->model.path_count && scaled->model.paths; i++) free(scaled->model.paths[i].points);
    free(scaled->model.paths);
    free(scaled->model.driven);
    free(scaled->model.position);
    free(scaled->model.velocity);
    free(scaled->model.mass);
    free(scaled->model.pinned);
    free(scaled->model.springs);
    free(scaled->model.hinges);
    free(scaled->model.colliders);
    free(scaled->model.rigid);
    *scaled = (ck_ScaledModel){0};
}
