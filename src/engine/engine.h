// The one interface behind which every solver stands.
#ifndef CK_ENGINE_H
#define CK_ENGINE_H

#include "code.h"
#include "ledger.h"
#include "model.h"
#include "scaled_model.h"
#include "settings.h"
#include "status.h"
#include "trajectory.h"

#ifdef __cplusplus
extern "C" {
#endif

// How a step ended. Divergence is a result, not an error.
typedef enum ck_StepResult { CK_STEP_OK, CK_STEP_DIVERGED, CK_STEP_NO_MEMORY } ck_StepResult;

// The integrator's family: it decides what theory predicts of an engine's error.
typedef enum ck_Method {
    CK_METHOD_UNKNOWN,           // nothing is predicted
    CK_METHOD_STILL,             // moves nothing
    CK_METHOD_VELOCITY_VERLET,   // explicit, second order
    CK_METHOD_STOERMER_BARS,     // Störmer–Verlet with position constraints, second order in the field
    CK_METHOD_STOERMER_DIRECT,   // the same, all constraints solved at once
    CK_METHOD_STOERMER_LINES,    // the same with compliant constraints, line by line
    CK_METHOD_XPBD,              // symplectic Euler prediction, compliant position constraints
    CK_METHOD_BULLET_PBD,        // symplectic Euler prediction, Bullet's link projection
    CK_METHOD_IMPLICIT_EULER,    // backward Euler, Newton
    CK_METHOD_SYMPLECTIC_EULER,  // explicit springs, implicit damping
    CK_METHOD_SEED,              // an origin, with its quirks
    CK_METHOD_SEMI_IMPLICIT_ODE, // velocity constraints along directions frozen at the start of the step
} ck_Method;

// What an engine is that is no part of the program.
typedef struct ck_Outside {
    // In place of create, with source as what it knows of itself.
    ck_Status (*open)(const void *source, void **state, const ck_Model *model, const ck_Settings *wanted,
                      ck_Settings *used, ck_Ledger *ledger, ck_Error *error);
    const void *source;
    const char *version;   // in place of version
    const char *arguments; // what a command line names it by, after clothcheck run SCENE
    bool is_recorded;      // what it does is fixed: it is not run again, at another step or to be timed
    double frame_cost;     // s of CPU that a frame cost where it was recorded; NaN: not known
    // s of CPU that it has used so far, where it works in another process; NULL: it works in this one.
    double (*cpu)(const void *state);
    bool spawns; // it starts a program
} ck_Outside;

typedef struct ck_Engine {
    const char *name;
    const char *about;  // the method in a few words
    const char *family; // whose code it is: "native", "Bullet", "ODE"
    const char *(*version)(void);
    ck_Method method;
    unsigned terms;             // ck_Term bits it can model
    const ck_Setting *settings; // ends with a NULL name; NULL: it has none
    bool is_single;             // it computes in single precision
    bool is_stock;              // as its users run it: nothing is corrected, and nothing is promised of it
    int order;                  // order of convergence of its elastic motion; 0: it models no elasticity
    int damped_order;           // of that where springs are damped; 0: the same
    int rest_order;             // of its rest; 0: it is exact at any step, or models no elasticity
    int damped_rest_order;      // of its rest where springs are damped
    bool chains_keep_order;     // dampers change neither where springs are a chain

    // Translates the model into the engine's own parameters, in one named function, and builds its world.
    //   wanted  what the user sets, 0 where the engine's rule decides;  used  out, nothing left at 0 that the engine
    //   has ledger  out, may be NULL
    // Errors: CK_REFUSED with a reason, CK_NO_MEMORY. *state is only set on success.
    ck_Status (*create)(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error);
    // Advances by one frame (model->step), or what pace has set. Callers use ck_engine_advance, which lets due pins go
    // first.
    ck_StepResult (*step)(void *state);
    // Sets how long the next steps are, s, at most model->step, each of as many substeps. NULL: it takes frames alone.
    void (*pace)(void *state, double duration);
    // Position and velocity at the same time, in the model's particle order: [3*n] m, [3*n] m/s.
    void (*read)(const void *state, double *position, double *velocity);
    // Lets a pinned particle go, at rest, or with the speed that it is moved with. NULL where the engine cannot.
    void (*release)(void *state, int particle);
    // The mean force of all colliders on the body over the last frame, [3] N. NULL where the engine does not tell.
    void (*contact)(const void *state, double *force);
    // How its rigid bodies are turned, [rigid_count]. NULL where the engine does not tell.
    void (*turn)(const void *state, ck_Turn *turn);
    // A text, the state's own, that a reader of the result must know, such as that a speed was clamped; NULL: nothing.
    // May be NULL.
    const char *(*remark)(const void *state);
    void (*destroy)(void *state);
    // Fills in what its program to paste needs besides the model, in units of its own, and the settings used: text,
    // extension and values. NULL: there is none. Errors: CK_BAD_INPUT where it cannot say that scene, CK_NO_MEMORY.
    ck_Status (*code)(ck_Code *code, const ck_ScaledModel *scaled, const ck_Settings *used, ck_Error *error);
    const ck_Outside *outside; // NULL: it is part of the program
} ck_Engine;

// Builds an engine's world: its create, or what it has in its place. Arguments and errors are those of create.
ck_Status ck_engine_create(const ck_Engine *engine, void **state, const ck_Model *model, const ck_Settings *wanted,
                           ck_Settings *used, ck_Ledger *ledger, ck_Error *error);

const char *ck_engine_version(const ck_Engine *engine);

// The row of an engine's table for a slot; NULL where it has none.
const ck_Setting *ck_engine_setting(const ck_Engine *engine, int slot);

// True where the model has a term that the engine lacks.
bool ck_engine_lacks(const ck_Engine *engine, const ck_Model *model);

// Lets go the pins that are due at this frame, then advances by one, in the steps that it comes in. The first frame is
// 0.
ck_StepResult ck_engine_advance(const ck_Engine *engine, void *state, const ck_Model *model, int frame);

// Reads a frame: positions, velocities and, where there are colliders, their force; NaN where the engine does not tell.
void ck_engine_read(const ck_Engine *engine, const void *state, const ck_Trajectory *trajectory, int frame);

#ifdef __cplusplus
}
#endif

#endif
