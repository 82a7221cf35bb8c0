#include "settings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

const ck_Setting *ck_setting_find(const ck_Setting *table, const char *name) {
    for (const ck_Setting *row = table; row && row->name; row++)
        if (!strcasecmp(row->name, name) || (row->also && !strcasecmp(row->also, name))) return row;
    return NULL;
}

bool ck_setting_takes(const ck_Setting *row, double value, char *wanted, size_t size) {
    snprintf(wanted, size, "a %snumber from %g to %.16g", row->is_whole ? "whole " : "", row->least, row->most);
    if (value == 0 && row->slot < CK_OWN) return true;
    return value >= row->least && value <= row->most && (!row->is_whole || floor(value) == value);
}

const char *ck_setting_name(const void *table, int index) {
    const ck_Setting *rows = table;
    for (int i = 0; rows && rows[i].name; i++)
        if (i == index) return rows[i].name;
    return NULL;
}

bool ck_settings_has(const ck_Settings *settings, int slot) {
    return slot < CK_OWN ? ck_settings_get(settings, slot) > 0 : settings->own_set >> (slot - CK_OWN) & 1;
}

double ck_settings_get(const ck_Settings *settings, int slot) {
    if (slot >= CK_OWN) return settings->own[slot - CK_OWN];
    switch (slot) {
    case CK_SUBSTEPS: return settings->substeps;
    case CK_ITERATIONS: return settings->iterations;
    case CK_RELAXATION: return settings->relaxation;
    case CK_SOFTNESS: return settings->softness;
    default: return settings->threads;
    }
}

void ck_settings_set(ck_Settings *settings, int slot, double value) {
    if (slot >= CK_OWN) {
        settings->own[slot - CK_OWN] = value;
        settings->own_set |= 1u << (slot - CK_OWN);
        return;
    }
    switch (slot) {
    case CK_SUBSTEPS: settings->substeps = (uint32_t)value; break;
    case CK_ITERATIONS: settings->iterations = (uint32_t)value; break;
    case CK_RELAXATION: settings->relaxation = value; break;
    case CK_SOFTNESS: settings->softness = value; break;
    default: settings->threads = (uint32_t)value;
    }
}

double ck_settings_own(const ck_Settings *settings, int index, double otherwise) {
    return ck_settings_has(settings, CK_OWN + index) ? settings->own[index] : otherwise;
}

void ck_settings_take_own(ck_Settings *used, const ck_Settings *wanted) {
    memcpy(used->own, wanted->own, sizeof used->own);
    used->own_set = wanted->own_set;
}

void ck_settings_override(ck_Settings *settings, const ck_Settings *by) {
    for (int slot = 0; slot < CK_OWN + CK_OWN_SETTINGS; slot++)
        if (ck_settings_has(by, slot)) ck_settings_set(settings, slot, ck_settings_get(by, slot));
}
