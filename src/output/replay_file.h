// A replay as a file: the paths of a scene's runs and of its truth, thinned.
//
// replays/SCENE.replay begins with lines of text, as
//     clothcheck replay 1
//     scene cloth_on_sphere
//     columns 20                       of a cloth: particle = row*columns + column; else 0
//     particles 400
//     springs 760
//     triangles 0                      of a mesh; else 0
//     frames 61
//     paths 12
//     path native-verlet               one a path, in their order; "truth" where there is one
//     about A cloth falls on a ball.   one line, where the scene has a sentence
//     plane 0 -1 0 0 1 0               any number of these: point and normal, m
//     sphere 0 -1 0 0.3                and of these: centre and radius, m
//     box 0 -1 0 0.1 1 0 0 0 1 0 0 0 1 0.3 0.2 0.4   or capsule or cylinder: centre, radius, three axes, half the core
//     data
// and goes on with little-endian numbers: times [frames] float32, s; structural springs [springs][2] int32; their rest
// lengths [springs] float32, m; triangles [triangles][3] int32; positions [paths][frames][particles][3] float32, m, NaN
// after a run's last frame.
#ifndef CK_REPLAY_FILE_H
#define CK_REPLAY_FILE_H

#include "status.h"

#include <stddef.h>

// The most paths of one.
#define CK_REPLAY_MAX_PATHS 65

#define CK_REPLAY_DIRECTORY "replays"

typedef struct ck_Replay {
    char *bytes; // of the file; owned
    size_t size, header_size;
    const char *about; // the scene's sentence, in bytes
    size_t about_length;
    int particle_count, spring_count, triangle_count, frame_count, path_count;
} ck_Replay;

// The file of a scene in its directory. NULL when out of memory. Free the result.
char *ck_replay_name(const char *scene);

// Reads a scene's. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY. Free with ck_replay_free in any case.
ck_Status ck_replay_read(ck_Replay *replay, const char *directory, const char *scene, ck_Error *error);

// Accepts a zeroed replay.
void ck_replay_free(ck_Replay *replay);

// The bytes of springs, their rest lengths and triangles, and the numbers in a path's positions.
size_t ck_replay_body_bytes(const ck_Replay *replay);
size_t ck_replay_path_numbers(const ck_Replay *replay);

#endif
