#include "engine.h"

#include <math.h>
#include <stddef.h>

const ck_Setting *ck_engine_setting(const ck_Engine *engine, int slot) {
    for (const ck_Setting *row = engine->settings; row && row->name; row++)
        if (row->slot == slot) return row;
    return NULL;
}

ck_Status ck_engine_create(const ck_Engine *engine, void **state, const ck_Model *model, const ck_Settings *wanted,
                           ck_Settings *used, ck_Ledger *ledger, ck_Error *error) {
    const ck_Outside *outside = engine->outside;
    return outside ? outside->open(outside->source, state, model, wanted, used, ledger, error)
                   : engine->create(state, model, wanted, used, ledger, error);
}

const char *ck_engine_version(const ck_Engine *engine) {
    return engine->outside ? engine->outside->version : engine->version();
}

bool ck_engine_lacks(const ck_Engine *engine, const ck_Model *model) {
    return model->terms & ~engine->terms & ~(unsigned)CK_TERM_CHANGES;
}

ck_StepResult ck_engine_advance(const ck_Engine *engine, void *state, const ck_Model *model, int frame) {
    for (int i = 0; i < model->release_count && engine->release; i++)
        for (int j = 0; j < model->releases[i].particle_count && model->releases[i].frame == frame; j++)
            engine->release(state, model->releases[i].particles[j]);
    if (!(model->terms & CK_TERM_JITTER) || !engine->pace) return engine->step(state);
    double parts[2];
    ck_StepResult result = CK_STEP_OK;
    ck_model_parts(model, frame, parts);
    for (int i = 0; i < 2 && result == CK_STEP_OK; i++) {
        engine->pace(state, parts[i]);
        result = engine->step(state);
    }
    return result;
}

void ck_engine_read(const ck_Engine *engine, const void *state, const ck_Trajectory *trajectory, int frame) {
    engine->read(state, ck_trajectory_position(trajectory, frame), ck_trajectory_velocity(trajectory, frame));
    ck_Turn *turn = ck_trajectory_turn(trajectory, frame);
    for (int i = 0; i < trajectory->rigid_count; i++) turn[i] = (ck_Turn){{NAN, NAN, NAN, NAN}, {NAN, NAN, NAN}};
    if (turn && engine->turn) engine->turn(state, turn);
    if (!trajectory->contact) return;
    double *contact = trajectory->contact + 3 * (size_t)frame;
    for (int axis = 0; axis < 3; axis++) contact[axis] = NAN;
    if (engine->contact) engine->contact(state, contact);
}
