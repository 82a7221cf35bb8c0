// A solver of one's own as a shared library: an engine, by the interface that the program's own have, and one symbol.
//
//     const ck_Engine mine = {.name = "mine", .create = create, .step = step, …};
//     CK_PLUGIN(mine);
//
// The library is loaded into the process of a run only. It may call what the installed headers declare: the program has
// it. Its engine's strings may be its own.
#ifndef CK_PLUGIN_H
#define CK_PLUGIN_H

#include "engine.h"

#ifdef __cplusplus
extern "C" {
#endif

// Raised where the interface changes.
#ifndef CK_PLUGIN_VERSION
#define CK_PLUGIN_VERSION 5
#endif

typedef struct ck_Plugin {
    unsigned version;
    size_t engine_size, model_size, settings_size; // as the library was compiled
    const ck_Engine *engine;
} ck_Plugin;

#define CK_PLUGIN_SYMBOL "clothcheck_plugin"
#define CK_PLUGIN(engine)                                                                                              \
    extern const ck_Plugin clothcheck_plugin;                                                                          \
    const ck_Plugin clothcheck_plugin = {CK_PLUGIN_VERSION, sizeof(ck_Engine), sizeof(ck_Model), sizeof(ck_Settings),  \
                                         &(engine)}

#ifdef __cplusplus
}
#endif

#endif
