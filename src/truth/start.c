#include "start.h"

#include "equilibrium.h"

#include <stdlib.h>
#include <string.h>

// Seconds of falling at most, in frames of the scene; what is not at rest then is left to Newton.
#define MOST_FRAMES 20000
// Of the spacing, for a start that only symmetry holds up.
#define NUDGE 1e-3

static ck_Status settle(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    ck_Model held = *model;
    held.collider_count = held.release_count = held.driven_count = held.path_count = 0;
    held.terms &= ~(unsigned)(CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS);
    held.terms &= ~(unsigned)CK_TERM_BODIES;
    held.frame_count = MOST_FRAMES;
    // rigid bodies wait where they are
    held.rigid_count = 0;
    held.pinned = malloc((size_t)model->particle_count * sizeof *held.pinned);
    if (!held.pinned) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < model->particle_count; i++)
        held.pinned[i] = model->pinned[i] || i >= ck_model_cloth_count(model);
    ck_Equilibrium equilibrium;
    ck_Error why = {0};
    ck_Status status = ck_equilibrium_release(&equilibrium, &held, 0, 0, &why);
    // a body as symmetric as it was drawn may balance where it would not stay
    if (status == CK_REFUSED) {
        ck_equilibrium_free(&equilibrium);
        status = ck_equilibrium_release(&equilibrium, &held, NUDGE * model->spacing, 1, &why);
    }
    if (!status) memcpy(model->position, equilibrium.position, 3 * sizeof(double) * (size_t)model->particle_count);
    ck_equilibrium_free(&equilibrium);
    free(held.pinned);
    if (status == CK_REFUSED) return ck_scene_fail(scene, "start", error, "%s", why.message);
    return status ? ck_fail(error, status, "%s", why.message) : ck_model_check_outside(model, scene, error);
}

ck_Status ck_start_build(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    ck_Status status = ck_model_build(model, scene, error);
    return status || !model->starts_settled ? status : settle(model, scene, error);
}
