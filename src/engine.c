#include "engine.h"

#include "engine_list.h"
#include "scene.h"

#include <math.h>
#include <string.h>

// Adding an engine is one file, one line here and one in engine_list.h.
static const ck_Engine *const engines[] = {
    &ck_native_verlet, &ck_native_narrow, &ck_native_bars, &ck_native_xpbd,     &ck_native_rope,
    &ck_seed_tecido,   &ck_seed_cloth,    &ck_bullet_pbd,  &ck_bullet_implicit, &ck_bullet_explicit,
    &ck_ode_quick,     &ck_ode_direct,    &ck_still,
};

ck_StepResult ck_engine_advance(const ck_Engine *engine, void *state, const ck_Model *model, int frame) {
    for (int i = 0; i < model->release_count && engine->release; i++)
        for (int j = 0; j < model->releases[i].particle_count && model->releases[i].frame == frame; j++)
            engine->release(state, model->releases[i].particles[j]);
    return engine->step(state);
}

void ck_engine_read(const ck_Engine *engine, const void *state, const ck_Trajectory *trajectory, int frame) {
    engine->read(state, ck_trajectory_position(trajectory, frame), ck_trajectory_velocity(trajectory, frame));
    if (!trajectory->contact) return;
    double *contact = trajectory->contact + 3 * (size_t)frame;
    for (int axis = 0; axis < 3; axis++) contact[axis] = NAN;
    if (engine->contact) engine->contact(state, contact);
}

_Static_assert(sizeof engines / sizeof *engines <= CK_SCENE_MAX_ENGINES, "raise CK_SCENE_MAX_ENGINES");

int ck_engine_count(void) {
    return sizeof engines / sizeof *engines;
}

const ck_Engine *ck_engine_at(int index) {
    return engines[index];
}

const ck_Engine *ck_engine_find(const char *name) {
    for (int i = 0; i < ck_engine_count(); i++)
        if (!strcmp(engines[i]->name, name)) return engines[i];
    return NULL;
}

const char *ck_engine_name(const void *table, int index) {
    (void)table;
    return index < ck_engine_count() ? engines[index]->name : NULL;
}

ck_Settings ck_engine_settings(const ck_Engine *engine, const ck_Model *model) {
    for (int i = 0; i < ck_engine_count(); i++)
        if (engines[i] == engine) return model->settings[i];
    return (ck_Settings){0};
}
