// What a user may set of an engine. 0 means: the engine's own documented rule decides.
#ifndef CK_SETTINGS_H
#define CK_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ck_Settings {
    uint32_t substeps;   // steps of the engine per frame (time.step of the scene)
    uint32_t iterations; // solver iterations per substep, where the method has them
    double relaxation;   // over-relaxation of an iterative solver, 1 … 1.5 helps
    double compliance;   // m/N of every spring, in place of 1/k; native-xpbd
    double klst;         // Bullet's linear stiffness of every link, at most 1, in place of the static map; bullet-pbd
    uint32_t mended;     // quirks of an origin to leave out, bits as `clothcheck list` counts them
    uint32_t reordered;  // 1: links in an order in which neighbours do not wait for each other; bullet-pbd
    uint32_t threads;    // that share a step, where the engine can; 0 and 1: none but the caller's
    uint32_t vectors;    // doubles of an instruction at most, but two always, in the loops over regular cloths
} ck_Settings;

// A setting by its name, as in scene files and --set.
typedef struct ck_SettingKey {
    const char *name;
    bool is_whole;
    double largest;
} ck_SettingKey;

typedef enum ck_Setting {
    CK_SET_SUBSTEPS,
    CK_SET_ITERATIONS,
    CK_SET_RELAXATION,
    CK_SET_COMPLIANCE,
    CK_SET_KLST,
    CK_SET_MENDED,
    CK_SET_REORDERED,
    CK_SET_THREADS,
    CK_SET_VECTORS,
    CK_SETTING_COUNT
} ck_Setting;

// The bit of a setting among those that an engine has.
#define CK_HAS(setting) (1u << (setting))

extern const ck_SettingKey ck_setting_keys[CK_SETTING_COUNT];

double ck_setting_get(const ck_Settings *settings, ck_Setting setting);
void ck_setting_set(ck_Settings *settings, ck_Setting setting, double value);

// CK_SETTING_COUNT where there is none of that name.
ck_Setting ck_setting_find(const char *name);

// Takes every setting over that is not 0.
void ck_settings_override(ck_Settings *settings, const ck_Settings *by);

#ifdef __cplusplus
}
#endif

#endif
