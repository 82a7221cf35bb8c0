// A replay as a video: engines side by side, with their names, the scene's sentence and the time. A headless browser
// draws the frames with what the page draws its replays with, ffmpeg joins them.
#ifndef CK_FILM_H
#define CK_FILM_H

#include "status.h"

typedef struct ck_Film {
    const char *replays; // directory that holds replays/SCENE.replay
    const char *scene;   // its name
    double seconds;      // of the scene
    const char *color;   // strain, distance, speed or engine
    int width, height, fps;
} ck_Film;

// Errors: CK_IO, which says what is missing, where one of the programs is not there.
ck_Status ck_film_check(const char *out, ck_Error *error);

// Draws a film in a directory, where much is left beside it, and gives it the name out, which ends in .mp4 or .gif.
//   progress  called with the frames that are drawn, and all of them; may be NULL
// Errors: CK_BAD_INPUT, CK_IO with what the program says that failed, CK_NO_MEMORY. out is whole or not there.
ck_Status ck_film_write(const ck_Film *film, const char *directory, const char *out,
                        void (*progress)(int drawn, int count), ck_Error *error);

#endif
