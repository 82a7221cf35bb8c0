// What was claimed of the two origins, as sweeps over what the claim leaves open; and what each of their quirks costs.
#ifndef CK_CLAIMS_H
#define CK_CLAIMS_H

#include "csv_writer.h"
#include "model.h"
#include "scene.h"
#include "status.h"

// Adds a row for each claim, value and metric: value at the end, and the range of it over the last quarter.
//   scenes    directory of the seeds' scene files
//   progress  may be NULL
// Cost: some two minutes. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_claims_write(ck_Csv *csv, const char *scenes, void (*progress)(const char *claim, double value),
                          ck_Error *error);

// Adds a row for each quirk: what the origin makes of a small experiment with it and without, and what physics does.
// Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_quirks_write(ck_Csv *csv, const char *scenes, ck_Error *error);

// Loads a scene by its name from a directory. Free both in any case. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_claims_load(ck_Scene *scene, ck_Model *model, const char *scenes, const char *name, ck_Error *error);

#endif
