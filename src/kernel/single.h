// The names that files compiled for single precision give to what they define.
#ifndef CK_SINGLE_H
#define CK_SINGLE_H

#define ck_rows_of ck_rows_of_single
#define ck_rows_allocate ck_rows_allocate_single
#define ck_rows_load ck_rows_load_single
#define ck_rows_store ck_rows_store_single
#define ck_rows_add ck_rows_add_single
#define ck_rows_shift ck_rows_shift_single
#define ck_origin_follows ck_origin_follows_single
#define ck_rows_mark_paired ck_rows_mark_paired_single
#define ck_explicit_rows ck_explicit_rows_single
#define ck_projection_rows ck_projection_rows_single
#define ck_projection_lines ck_projection_lines_single
#define ck_projection_run ck_projection_run_single

#endif
