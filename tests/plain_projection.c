// kernel_projection for the plainest processor, under names of its own.
#define CK_ONE_CLONE
#define ck_projection_create plain_projection_create
#define ck_projection_destroy plain_projection_destroy
#define ck_projection_step plain_projection_step
#define ck_projection_read plain_projection_read
#define ck_projection_fits plain_projection_fits
#define ck_sweep_order plain_sweep_order
#include "../src/kernel_projection.c"
