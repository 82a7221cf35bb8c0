// A compiled model written out in SI units, so that anybody can build the same scene anywhere.
#ifndef CK_EXPORT_H
#define CK_EXPORT_H

#include "model.h"
#include "status.h"

#include <stdio.h>

// As a scene file in JSON, which is YAML, too: a network of nodes and springs with values of their own. It loads as any
// scene does, into a model of the same numbers to the last bit: in 17 digits.
// Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_export_json(FILE *out, const ck_Model *model, ck_Error *error);

// As a Wavefront mesh: particles as v, structural springs as l, a cloth's cells as f; what else there is, as comments.
// Errors: CK_IO.
ck_Status ck_export_obj(FILE *out, const ck_Model *model, ck_Error *error);

// As tables in a directory: particles.csv, springs.csv, colliders.csv, scene.csv and,
// where pins or colliders move, moves.csv and collider_moves.csv. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_export_csv(const char *directory, const ck_Model *model, ck_Error *error);

// As lines of words, which an adapter can read with scanf; bridge/README.md has them. Errors are the stream's.
void ck_export_lines(FILE *out, const ck_Model *model);

// The word for a kind of springs: structural, shear, bend.
extern const char *const ck_export_kinds[CK_SPRING_KINDS];

#endif
