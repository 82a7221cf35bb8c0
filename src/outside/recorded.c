// A recording as an engine: its path is found when it is read, and played frame by frame.
#include "names.h"
#include "outside_engine.h"
#include "recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Recorded {
    ck_Trajectory path;
    char note[200]; // how the path was made of the recording
} Recorded;

typedef struct Player {
    const Recorded *recorded;
    int frame;
} Player;

static ck_Status open_recorded(const void *source, void **state, const ck_Model *model, const ck_Settings *wanted,
                               ck_Settings *used, ck_Ledger *ledger, ck_Error *error) {
    (void)wanted, (void)ledger;
    const Recorded *recorded = source;
    *used = (ck_Settings){0};
    if (recorded->path.particle_count != model->particle_count || recorded->path.step != model->step)
        return ck_fail(error, CK_REFUSED, "it was recorded of another scene");
    Player *player = calloc(1, sizeof *player);
    if (!player) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    player->recorded = recorded;
    *state = player;
    return CK_OK;
}

// A path ends where a coordinate was no number.
static ck_StepResult step(void *state) {
    Player *player = state;
    if (player->frame + 1 >= player->recorded->path.frame_count) return CK_STEP_DIVERGED;
    player->frame++;
    return CK_STEP_OK;
}

static void read_state(const void *state, double *position, double *velocity) {
    const Player *player = state;
    const ck_Trajectory *path = &player->recorded->path;
    size_t bytes = 3 * sizeof(double) * (size_t)path->particle_count;
    memcpy(position, ck_trajectory_position(path, player->frame), bytes);
    memcpy(velocity, ck_trajectory_velocity(path, player->frame), bytes);
}

// What it says of pins and collisions is in the path.
static void release(void *state, int particle) {
    (void)state, (void)particle;
}

static const char *remark(const void *state) {
    const Player *player = state;
    return *player->recorded->note ? player->recorded->note : NULL;
}

static void destroy(void *state) {
    free(state);
}

static void free_recorded(void *source) {
    Recorded *recorded = source;
    ck_trajectory_free(&recorded->path);
    free(recorded);
}

static ck_Status fill(ck_OutsideEngine *made, const char *path, double interval, const ck_Model *model,
                      ck_Error *error) {
    ck_Recording recording;
    Recorded *recorded = calloc(1, sizeof *recorded);
    if (!recorded) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    made->source = recorded;
    made->free_source = free_recorded;
    ck_Status status = ck_recording_read(&recording, path, model, interval, error);
    if (!status)
        status = ck_recording_path(&recorded->path, &recording, model, recorded->note, sizeof recorded->note, error);
    if (!status && !recorded->path.frame_count)
        status = ck_fail(error, CK_BAD_INPUT, "%s: its first frame holds a coordinate that is no number", path);
    ck_recording_free(&recording);
    return status;
}

ck_Status ck_outside_recording(ck_Engine **engine, const char *name, const char *path, double interval,
                               double frame_cost, const ck_Model *model, ck_Error *error) {
    *engine = NULL;
    ck_OutsideEngine *made = ck_outside_new(name);
    if (!made) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = fill(made, path, interval, model, error);
    if (status) {
        ck_outside_free(&made->engine);
        return status;
    }
    snprintf(made->about, sizeof made->about, "a recording: %.140s", path);
    snprintf(made->version, sizeof made->version, "recorded");
    char word[260];
    ck_text_shell(word, sizeof word, path);
    size_t used = (size_t)snprintf(made->arguments, sizeof made->arguments, "--path %s --name %s", word, name);
    if (!isnan(frame_cost))
        used += (size_t)snprintf(made->arguments + used, sizeof made->arguments - used, " --cost-ms %.17g",
                                 1e3 * frame_cost);
    if (interval > 0) snprintf(made->arguments + used, sizeof made->arguments - used, " --interval %.17g", interval);
    made->outside.open = open_recorded;
    made->outside.source = made->source;
    made->outside.is_recorded = true;
    made->outside.frame_cost = frame_cost;
    made->engine.terms = ~0u;
    made->engine.step = step;
    made->engine.read = read_state;
    made->engine.release = release;
    made->engine.remark = remark;
    made->engine.destroy = destroy;
    *engine = &made->engine;
    return CK_OK;
}
