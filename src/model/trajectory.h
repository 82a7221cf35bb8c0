// Positions and velocities of all particles at every frame of a run.
#ifndef CK_TRAJECTORY_H
#define CK_TRAJECTORY_H

#include "model.h"
#include "rigid.h"
#include "status.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ck_Trajectory {
    int particle_count;
    int frame_count; // frames written, the start among them
    int capacity;
    double step;     // s between frames
    double *data;    // [capacity][2][3*n] positions, then velocities; shared with child processes
    size_t bytes;    // of data
    double *contact; // [capacity][3] N, of the colliders in the mean of the frame before, NaN until told; NULL: none
    ck_Turn *turn;   // [capacity][rigid_count] of each rigid body; NULL without any
    int rigid_count;
} ck_Trajectory;

// Room for a model's start and all its frames, in memory that a child process can fill; beyond 64 MiB it is a file in
// TMPDIR or /var/tmp that has no name.
// Errors: CK_NO_MEMORY. Free with ck_trajectory_free in any case.
ck_Status ck_trajectory_create(ck_Trajectory *trajectory, const ck_Model *model, ck_Error *error);

// Gives back the memory in which this process sees a large path, until it is read again: its values stay.
void ck_trajectory_rest(const ck_Trajectory *trajectory);

// Accepts a zeroed trajectory.
void ck_trajectory_free(ck_Trajectory *trajectory);

// [3*n] m and m/s of one frame.
double *ck_trajectory_position(const ck_Trajectory *trajectory, int frame);
double *ck_trajectory_velocity(const ck_Trajectory *trajectory, int frame);

// [rigid_count] of one frame; NULL without rigid bodies.
ck_Turn *ck_trajectory_turn(const ck_Trajectory *trajectory, int frame);

#ifdef __cplusplus
}
#endif

#endif
