#include "engine.h"

#include "engine_list.h"

#include <string.h>

// Adding an engine is one file, one line here and one in engine_list.h.
static const ck_Engine *const engines[] = {
    &ck_native_verlet,   &ck_native_bars, &ck_native_xpbd, &ck_bullet_pbd,
    &ck_bullet_implicit, &ck_ode_quick,   &ck_ode_direct,  &ck_null_engine,
};

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

ck_Settings ck_engine_settings(const ck_Engine *engine, const ck_Model *model) {
    for (int i = 0; i < ck_engine_count(); i++)
        if (engines[i] == engine) return model->settings[i];
    return (ck_Settings){0};
}
