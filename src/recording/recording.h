// Positions that another program, or a camera, recorded: read from a file, and brought to a scene's frames.
#ifndef CK_RECORDING_H
#define CK_RECORDING_H

#include "model.h"
#include "status.h"
#include "trajectory.h"

// Where a particle was seen, and how fast it was.
typedef struct ck_RecordedPoint {
    double time; // s
    int particle;
    double at[3], velocity[3]; // m, m/s
    int line;                  // of the file; of .npy its frame, counted from 1
} ck_RecordedPoint;

typedef struct ck_Recording {
    const char *path; // of the file, for errors
    ck_RecordedPoint *points;
    int point_count, capacity;
    bool has_velocity;
} ck_Recording;

// Reads a file of one of three forms:
//   CSV, a row a point:   the columns time_s, particle, x, y, z and, together or not at all, vx, vy, vz
//   CSV, a row a frame:   the columns time_s, x0, y0, z0, x1 … and vx0, vy0, vz0 …, of every particle
//   NumPy's .npy:         [frames][particles][3] of float32 or float64, frames interval apart, the first at 0
// in any order of columns; others are left alone. Metres and seconds. A coordinate may be nan.
//   interval  s; 0: the scene's step
// Errors: CK_BAD_INPUT with file, line and column; CK_IO, CK_NO_MEMORY. Free with ck_recording_free in any case.
ck_Status ck_recording_read(ck_Recording *recording, const char *path, const ck_Model *model, double interval,
                            ck_Error *error);
void ck_recording_free(ck_Recording *recording);

// The recording at the scene's frames, by cubics between its own; velocities that it lacks are those of parabolas. A
// start that it lacks is the scene's, and so are particles that are pinned all the time. From the first coordinate on
// that is no number the path has no frames.
//   note  out: what was made up, in words; empty: nothing
// Errors: CK_BAD_INPUT where particles or times are missing or stand twice; CK_NO_MEMORY. Free path in any case.
ck_Status ck_recording_path(ck_Trajectory *path, const ck_Recording *recording, const ck_Model *model, char *note,
                            size_t size, ck_Error *error);

// The cubic through two states h apart at the share t of the way: positions and, unless NULL, velocities of one axis.
static inline double ck_between(double x, double v, double y, double w, double h, double t, double *velocity) {
    if (velocity) *velocity = 6 * t * (1 - t) * (y - x) / h + (1 - t) * (1 - 3 * t) * v + t * (3 * t - 2) * w;
    return x * (1 + t * t * (2 * t - 3)) + y * t * t * (3 - 2 * t) + h * t * (1 - t) * ((1 - t) * v - t * w);
}

#endif
