// What a user may set of an engine. Each engine has a table of its own, in its own users' words.
#ifndef CK_SETTINGS_H
#define CK_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CK_OWN_SETTINGS 8

// Values: those that studies vary in any engine, and the engine's own. What is not set, the engine's rule decides.
typedef struct ck_Settings {
    uint32_t substeps;           // steps of the engine a frame; 0: not set, as for the next four
    uint32_t iterations;         // solver iterations a substep
    uint32_t threads;            // that share a step
    double relaxation;           // over-relaxation of an iterative solver
    double softness;             // in place of what the scene's stiffness comes to, in the engine's own measure
    double own[CK_OWN_SETTINGS]; // by the engine's own numbers
    unsigned own_set;            // a bit each
} ck_Settings;

// Where ck_Settings keeps a value.
typedef enum ck_Slot {
    CK_SUBSTEPS,
    CK_ITERATIONS,
    CK_RELAXATION,
    CK_SOFTNESS,
    CK_THREADS,
    CK_OWN, // own[0], and so on
} ck_Slot;

// One row of an engine's table, which ends with a NULL name.
typedef struct ck_Setting {
    const char *name; // as the engine's users know it
    int slot;         // a ck_Slot, or CK_OWN and more
    bool is_whole;
    double least, most;
    const char *unit;
    const char *rule;   // what decides where it is not set
    const char *help;   // what it is
    const char *also;   // another name that is understood; NULL: none
    bool leaves_theory; // once it is set, nothing is predicted of the engine
} ck_Setting;

// A row by its name or its other one; NULL where the table, which may be NULL, has none.
const ck_Setting *ck_setting_find(const ck_Setting *table, const char *name);

// Whether a row takes a value; wanted, out, says in words what it takes. 0 leaves what cannot be 0 to the rule.
bool ck_setting_takes(const ck_Setting *row, double value, char *wanted, size_t size);

// Names by their number, as ck_name_list reads them; NULL beyond the last.
const char *ck_setting_name(const void *table, int index);

bool ck_settings_has(const ck_Settings *settings, int slot);
// 0 where it is not set.
double ck_settings_get(const ck_Settings *settings, int slot);
void ck_settings_set(ck_Settings *settings, int slot, double value);

// An engine's own, by its number; otherwise, where it is not set.
double ck_settings_own(const ck_Settings *settings, int index, double otherwise);

// Takes an engine's own settings over, as they are wanted.
void ck_settings_take_own(ck_Settings *used, const ck_Settings *wanted);

// Takes over every setting that is set.
void ck_settings_override(ck_Settings *settings, const ck_Settings *by);

#ifdef __cplusplus
}
#endif

#endif
