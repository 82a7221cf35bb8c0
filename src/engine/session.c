#include "session.h"

#include "change.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_session_begin(ck_Session *session, const ck_Engine *engine, const ck_Model *model,
                           const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger, ck_Error *error) {
    *session = (ck_Session){.engine = engine, .model = model, .wanted = *wanted};
    return ck_engine_create(engine, &session->state, model, wanted, used, ledger, error);
}

// Settings among a change's words, as settings.ENGINE.KEY or settings.all.KEY.
static void take_settings(ck_Settings *wanted, const ck_Engine *engine, const char *words) {
    ck_Change change;
    for (int place = 0; ck_change_next(words, &place, &change);) {
        char key[200], number[40];
        snprintf(key, sizeof key, "%.*s", change.key_length, change.key);
        snprintf(number, sizeof number, "%.*s", change.value_length, change.value);
        char *of = strncmp(key, "settings.", 9) ? NULL : key + 9, *dot = of ? strrchr(of, '.') : NULL;
        if (!dot) continue;
        *dot = 0;
        const ck_Setting *row =
            strcmp(of, engine->name) && strcmp(of, "all") ? NULL : ck_setting_find(engine->settings, dot + 1);
        if (row) ck_settings_set(wanted, row->slot, strtod(number, NULL));
    }
}

// How bodies are turned since the scene's start: the world knows it from its own.
static void read_turns(const ck_Session *session, ck_Turn *turn) {
    const int count = session->model->rigid_count;
    for (int i = 0; i < count; i++) turn[i] = (ck_Turn){{NAN, NAN, NAN, NAN}, {NAN, NAN, NAN}};
    if (!count || !session->engine->turn) return;
    session->engine->turn(session->state, turn);
    for (int i = 0; i < count && session->now; i++) {
        double axes[3][3];
        for (int k = 0; k < 3; k++) ck_rigid_rotate(axes[k], turn[i].rotation, session->now->rigid[i].shape.axes[k]);
        ck_rigid_rotation(turn[i].rotation, &session->model->rigid[i], axes);
    }
}

static void end_model(ck_Model *model) {
    if (model) ck_model_end_resumed(model);
    free(model);
}

ck_Status ck_session_change(ck_Session *session, const ck_Segment *segment, ck_Error *error) {
    const size_t count = 3 * (size_t)session->model->particle_count, bodies = (size_t)session->model->rigid_count;
    double *position = malloc(2 * count * sizeof *position);
    ck_Turn *turn = malloc((bodies + 1) * sizeof *turn);
    ck_Model *next = calloc(1, sizeof *next);
    ck_Settings wanted = session->wanted, used;
    void *state = NULL;
    ck_Status status = CK_NO_MEMORY;
    if (position && turn && next) {
        session->engine->read(session->state, position, position + count);
        read_turns(session, turn);
        status = ck_model_resume(next, segment, position, position + count, turn);
    }
    take_settings(&wanted, session->engine, segment->words);
    if (status)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    else if (ck_engine_lacks(session->engine, next))
        status = ck_fail(error, CK_REFUSED, "%s does not model what the change adds", session->engine->name);
    else
        status = ck_engine_create(session->engine, &state, next, &wanted, &used, NULL, error);
    free(position);
    free(turn);
    if (status) {
        end_model(next);
        return status;
    }
    session->engine->destroy(session->state);
    end_model(session->now);
    session->state = state;
    session->now = next;
    session->begun = segment->frame;
    return CK_OK;
}

ck_StepResult ck_session_advance(ck_Session *session, int frame) {
    const ck_Segment *segment = ck_model_segment_at(session->model, frame);
    // a recording has been through it
    const bool is_recorded = session->engine->outside && session->engine->outside->is_recorded;
    if (segment && !is_recorded) {
        const ck_Status status = ck_session_change(session, segment, &session->refusal);
        if (status) return status == CK_NO_MEMORY ? CK_STEP_NO_MEMORY : CK_STEP_DIVERGED;
    }
    const ck_Model *model = session->now ? session->now : session->model;
    return ck_engine_advance(session->engine, session->state, model, frame - session->begun);
}

void ck_session_read(const ck_Session *session, const ck_Trajectory *trajectory, int frame) {
    ck_engine_read(session->engine, session->state, trajectory, frame);
    if (session->now && trajectory->rigid_count) read_turns(session, ck_trajectory_turn(trajectory, frame));
}

void ck_session_end(ck_Session *session) {
    if (session->state) session->engine->destroy(session->state);
    end_model(session->now);
    *session = (ck_Session){0};
}
