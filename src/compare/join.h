// The parts of a comparison that was run with --shard, joined into what one run would have written.
#ifndef CK_JOIN_H
#define CK_JOIN_H

#include "status.h"

#include <stdbool.h>

// True where a folder holds a comparison's results.
bool ck_join_is_part(const char *directory);

// Writes the six CSVs and the replays of parts into directory: the first scene of each part, the second of each …
// Errors: CK_BAD_INPUT where a scene is in two parts, or they are of unlike machines or builds; CK_IO, CK_NO_MEMORY.
ck_Status ck_join(const char *directory, char *const *parts, int part_count, ck_Error *error);

#endif
