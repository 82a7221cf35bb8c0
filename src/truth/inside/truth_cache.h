// Computed truths kept in files, so that each is solved once.
#ifndef CK_TRUTH_CACHE_H
#define CK_TRUTH_CACHE_H

#include "truth.h"

#include <stdio.h>

// A hash of all of a model that its truth depends on.
uint64_t ck_truth_cache_hash(const ck_Model *model);

// The paths and horizon of a computed truth, with what tells whether they are whole. Errors are the file's.
void ck_truth_write(const ck_Truth *truth, const ck_Model *model, FILE *file);

// False, with truth as it was, where they are damaged or another model's.
bool ck_truth_read(ck_Truth *truth, const ck_Model *model, FILE *file);

// Fills paths and horizon from directory/HASH.truth. False, with truth as it was, where there is no such file, it
// cannot be read, or, for an equilibrium, its forces do not balance.
bool ck_truth_cache_load(ck_Truth *truth, const ck_Model *model, const char *directory);

// Writes the file, making the directory where it is missing. The file appears whole or not at all.
// Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_truth_cache_save(const ck_Truth *truth, const ck_Model *model, const char *directory);

#endif
