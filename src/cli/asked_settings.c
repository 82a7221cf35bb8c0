#include "asked_settings.h"

#include "asked_engines.h"
#include "names.h"

#include <stdio.h>
#include <stdlib.h>

static ck_Status fail_unknown_key(const char *text, const char *key, const ck_Engine *engine, ck_Error *error) {
    char known[200], hint[80];
    return ck_fail(error, CK_BAD_INPUT, "--set %s: %s has no %s%s; it has %s", text, engine->name, key,
                   ck_name_hint(hint, sizeof hint, key, ck_setting_name, engine->settings),
                   engine->settings ? ck_name_list(known, sizeof known, ck_setting_name, engine->settings)
                                    : "no settings");
}

ck_Status ck_arguments_add_setting(ck_Arguments *arguments, const char *text, ck_Error *error) {
    char name[64], key[32], wanted[100], *end;
    int used = 0;
    ck_CompareOptions *options = &arguments->options;
    // the engine goes without saying where one is asked for
    if (options->engines == arguments->engines && options->engine_count == 1 &&
        sscanf(text, "%31[^.=]=%n", key, &used) == 1 && used)
        snprintf(name, sizeof name, "%s", arguments->engines[0]->name);
    else if (sscanf(text, "%63[^.=].%31[^.=]=%n", name, key, &used) != 2 || !used)
        return ck_fail(error, CK_BAD_INPUT,
                       "--set %s: it must read ENGINE.KEY=NUMBER, as in ode-quick.substeps=16, or KEY=NUMBER after one "
                       "--engine",
                       text);
    if (options->override_count == sizeof arguments->overrides / sizeof *arguments->overrides)
        return ck_fail(error, CK_BAD_INPUT, "--set is given more than %d times", options->override_count);
    ck_Override *override = &arguments->overrides[options->override_count++];
    *override = (ck_Override){.engine = ck_engine_find(name)};
    if (!override->engine) return ck_engine_unknown(name, error);
    const ck_Setting *setting = ck_setting_find(override->engine->settings, key);
    if (!setting) return fail_unknown_key(text, key, override->engine, error);
    double number = strtod(text + used, &end);
    bool is_taken = ck_setting_takes(setting, number, wanted, sizeof wanted);
    // a scene may leave a setting to the rule by 0; here that would leave the scene's
    if (end == text + used || *end || !is_taken || (number == 0 && setting->least > 0))
        return ck_fail(error, CK_BAD_INPUT, "--set %s.%s = %s: it must be %s", name, key, text + used, wanted);
    ck_settings_set(&override->settings, setting->slot, number);
    return CK_OK;
}
