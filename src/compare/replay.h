// The paths of a comparison's runs and of its truth, thinned to what is worth looking at. One file a scene;
// replay_file.h has its format.
#ifndef CK_REPLAY_H
#define CK_REPLAY_H

#include "comparison.h"
#include "replay_file.h"

// Writes a finished comparison's replay below a directory: every k-th frame and the last, so that there are at most 61
// and the file has some 4 MiB. Errors: CK_IO, CK_NO_MEMORY, and then there is none.
ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, ck_Error *error);

#endif
