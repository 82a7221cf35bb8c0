// kernel_explicit for the plainest processor, under names of its own.
#define CK_ONE_CLONE
#define ck_explicit_create plain_explicit_create
#define ck_explicit_destroy plain_explicit_destroy
#define ck_explicit_step plain_explicit_step
#define ck_explicit_read plain_explicit_read
#include "../src/kernel_explicit.c"
