// Contact of a regular cloth in rows: all particles in vectors, and those that may touch within a substep followed one
// by one, as where there are no rows.
#ifndef CK_VERLET_CONTACT_H
#define CK_VERLET_CONTACT_H

#include "explicit.h"
#include "native.h"

typedef struct ck_VerletContact ck_VerletContact;

// NULL in *contact where the scene has no colliders. Errors: CK_NO_MEMORY. Free with ck_verlet_contact_destroy.
ck_Status ck_verlet_contact_create(ck_VerletContact **contact, const ck_Native *native, ck_Error *error);
// Accepts NULL.
void ck_verlet_contact_destroy(ck_VerletContact *contact);

// As many substeps of cloth, which holds the state of native.
void ck_verlet_contact_step(ck_VerletContact *contact, ck_Native *native, ck_Explicit *cloth, uint32_t substeps);

#endif
