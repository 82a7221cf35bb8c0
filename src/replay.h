// The paths of a comparison's runs and of its truth, thinned to what is worth looking at. One file a scene.
//
// replays/SCENE.replay begins with lines of text, as
//     clothcheck replay 1
//     scene cloth_on_sphere
//     columns 20                       of a cloth: particle = row*columns + column; else 0
//     particles 400
//     springs 760
//     frames 61
//     paths 12
//     path native-verlet               one a path, in their order; "truth" where there is one
//     plane 0 -1 0 0 1 0               any number of these: point and normal, m
//     sphere 0 -1 0 0.3                and of these: centre and radius, m
//     data
// and goes on with little-endian numbers: times [frames] float32, s; structural springs [springs][2] int32; their rest
// lengths [springs] float32, m; positions [paths][frames][particles][3] float32, m, NaN after a run's last frame.
#ifndef CK_REPLAY_H
#define CK_REPLAY_H

#include "comparison.h"

#define CK_REPLAY_DIRECTORY "replays"

typedef struct ck_Replay {
    char *bytes; // of the file; owned
    size_t size, header_size;
    int particle_count, spring_count, frame_count, path_count;
} ck_Replay;

// Writes a finished comparison's replay below a directory: every k-th frame and the last, so that there are at most 61
// and the file has some 4 MiB. Errors: CK_IO, CK_NO_MEMORY, and then there is none.
ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, ck_Error *error);

// Reads a scene's. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY. Free with ck_replay_free in any case.
ck_Status ck_replay_read(ck_Replay *replay, const char *directory, const char *scene, ck_Error *error);

// Accepts a zeroed replay.
void ck_replay_free(ck_Replay *replay);

// The bytes of the springs and their rest lengths, and the numbers in a path's positions.
size_t ck_replay_spring_bytes(const ck_Replay *replay);
size_t ck_replay_path_numbers(const ck_Replay *replay);

#endif
