#include "files.h"
#include "model.h"
#include "segment.h"

#include <string.h>

static uint64_t hash_path(uint64_t value, const ck_Path *path) {
    const double numbers[] = {path->kind,      path->from,      path->to,       path->vector[0],
                              path->vector[1], path->vector[2], path->frequency};
    value = ck_hash(value, numbers, sizeof numbers);
    return ck_hash(value, path->points, (size_t)path->point_count * sizeof *path->points);
}

static uint64_t hash_collider(uint64_t value, const ck_Collider *collider) {
    const double numbers[] = {collider->shape, collider->radius, collider->restitution, collider->friction};
    value = ck_hash(value, numbers, sizeof numbers);
    value = ck_hash(value, collider->point, sizeof collider->point);
    value = ck_hash(value, collider->normal, sizeof collider->normal);
    value = ck_hash(value, collider->axes, sizeof collider->axes);
    value = ck_hash(value, collider->half, sizeof collider->half);
    return collider->path ? hash_path(value, collider->path) : value;
}

uint64_t ck_model_hash(const ck_Model *model) {
    size_t count = (size_t)model->particle_count;
    uint64_t value = ck_hash(CK_HASH_START, model->position, 3 * count * sizeof(double));
    value = ck_hash(value, model->velocity, 3 * count * sizeof(double));
    value = ck_hash(value, model->mass, count * sizeof(double));
    value = ck_hash(value, model->pinned, count * sizeof(bool));
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        const double numbers[5] = {spring->a, spring->b, spring->rest, spring->stiffness, spring->damping};
        value = ck_hash(value, numbers, sizeof numbers);
        if (spring->pulls_only) value = ck_hash(value, &spring->pulls_only, sizeof spring->pulls_only);
    }
    for (int i = 0; i < model->hinge_count; i++) {
        const ck_Hinge *hinge = &model->hinges[i];
        const double numbers[2] = {hinge->stiffness, hinge->rest};
        value = ck_hash(value, hinge->particles, sizeof hinge->particles);
        value = ck_hash(value, hinge->weights, sizeof hinge->weights);
        value = ck_hash(value, numbers, sizeof numbers);
    }
    if (model->wind.face_count) {
        const ck_Wind *wind = &model->wind;
        const double numbers[] = {wind->velocity[0], wind->velocity[1], wind->velocity[2],
                                  wind->density,     wind->drag,        wind->lift};
        value = ck_hash(value, numbers, sizeof numbers);
        value = ck_hash(value, wind->faces, (size_t)wind->face_count * sizeof *wind->faces);
    }
    for (int i = 0; i < model->driven_count; i++) {
        value = ck_hash(value, &model->driven[i].particle, sizeof model->driven[i].particle);
        value = hash_path(value, model->driven[i].path);
    }
    for (int i = 0; i < model->collider_count; i++) value = hash_collider(value, &model->colliders[i]);
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        value = hash_collider(value, &rigid->shape);
        value = ck_hash(value, rigid->spin, sizeof rigid->spin);
        value = ck_hash(value, rigid->hung, (size_t)rigid->hung_count * sizeof *rigid->hung);
    }
    for (int i = 0; i < model->release_count; i++) {
        const ck_Release *release = &model->releases[i];
        value = ck_hash(value, &release->frame, sizeof release->frame);
        value = ck_hash(value, release->particles, (size_t)release->particle_count * sizeof *release->particles);
    }
    for (int i = 0; i < model->segment_count; i++) {
        const uint64_t part = ck_model_hash(&model->segments[i].model);
        value = ck_hash(value, &model->segments[i].frame, sizeof model->segments[i].frame);
        value = ck_hash(value, &part, sizeof part);
        value = ck_hash(value, model->segments[i].words, strlen(model->segments[i].words));
    }
    if (model->jitter > 0) {
        value = ck_hash(value, &model->jitter, sizeof model->jitter);
        value = ck_hash(value, &model->jitter_seed, sizeof model->jitter_seed);
    }
    const double numbers[] = {model->gravity[0], model->gravity[1], model->gravity[2], model->force[0], model->force[1],
                              model->force[2],   model->drag,       model->duration,   model->step};
    return ck_hash(value, numbers, sizeof numbers);
}
