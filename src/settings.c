#include "settings.h"

#include <string.h>

const ck_SettingKey ck_setting_keys[CK_SETTING_COUNT] = {
    [CK_SET_SUBSTEPS] = {"substeps", true, 1e6},
    [CK_SET_ITERATIONS] = {"iterations", true, 1e6},
    [CK_SET_RELAXATION] = {"relaxation", false, 1e6},
    [CK_SET_COMPLIANCE] = {"compliance", false, 1e6},
    [CK_SET_KLST] = {"klst", false, 1},
    [CK_SET_MENDED] = {"mended", true, 1e6},
    [CK_SET_REORDERED] = {"reordered", true, 1},
    [CK_SET_THREADS] = {"threads", true, 64},
    [CK_SET_VECTORS] = {"vectors", true, 64},
};

double ck_setting_get(const ck_Settings *settings, ck_Setting setting) {
    switch (setting) {
    case CK_SET_SUBSTEPS: return settings->substeps;
    case CK_SET_ITERATIONS: return settings->iterations;
    case CK_SET_RELAXATION: return settings->relaxation;
    case CK_SET_COMPLIANCE: return settings->compliance;
    case CK_SET_KLST: return settings->klst;
    case CK_SET_MENDED: return settings->mended;
    case CK_SET_REORDERED: return settings->reordered;
    case CK_SET_THREADS: return settings->threads;
    default: return settings->vectors;
    }
}

void ck_setting_set(ck_Settings *settings, ck_Setting setting, double value) {
    switch (setting) {
    case CK_SET_SUBSTEPS: settings->substeps = (uint32_t)value; break;
    case CK_SET_ITERATIONS: settings->iterations = (uint32_t)value; break;
    case CK_SET_RELAXATION: settings->relaxation = value; break;
    case CK_SET_COMPLIANCE: settings->compliance = value; break;
    case CK_SET_KLST: settings->klst = value; break;
    case CK_SET_MENDED: settings->mended = (uint32_t)value; break;
    case CK_SET_REORDERED: settings->reordered = (uint32_t)value; break;
    case CK_SET_THREADS: settings->threads = (uint32_t)value; break;
    default: settings->vectors = (uint32_t)value; break;
    }
}

ck_Setting ck_setting_find(const char *name) {
    int setting = 0;
    while (setting < CK_SETTING_COUNT && strcmp(ck_setting_keys[setting].name, name)) setting++;
    return setting;
}

void ck_settings_override(ck_Settings *settings, const ck_Settings *by) {
    for (int i = 0; i < CK_SETTING_COUNT; i++)
        if (ck_setting_get(by, i) > 0) ck_setting_set(settings, i, ck_setting_get(by, i));
}
