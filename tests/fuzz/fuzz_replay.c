// Replays: a file that is none is refused; one that is taken can be packed for a page.
#include "fuzz.h"

#include "replay_pack.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    ck_Replay replay = {0};
    char *packed = NULL;
    size_t length = 0;
    fuzz_write("replays/input.replay", data, size);
    if (!ck_replay_read(&replay, ".", "input", NULL) && ck_replay_pack(&packed, &length, &replay, NULL)) abort();
    free(packed);
    ck_replay_free(&replay);
    return 0;
}
