// A replay in few bytes, for a page.
#ifndef CK_REPLAY_PACK_H
#define CK_REPLAY_PACK_H

#include "replay_file.h"

// Packs a replay in numbers that deflate well: the header, times, springs and rest lengths as in the file; then for
// each path a byte, a box [2][3] float32, m, least and largest corner, and its positions as codes of 24 bits, of which
// first all low bytes, then all middle and all high ones. Paths near the first whole one have a box in common, others
// one of their own. Code 2^21 is no position, c below it stands for least + (largest − least)·c/(2^21 − 1): a millionth
// of the box, which strains can be told from. Codes are written as differences, modulo 2^24 and zigzag, to the frame
// before; where the path's byte is 1, also less the same difference of the first path. Before the first frame codes are
// 0.
// Errors: CK_NO_MEMORY. Free *packed in any case.
ck_Status ck_replay_pack(char **packed, size_t *size, const ck_Replay *replay, ck_Error *error);

#endif
