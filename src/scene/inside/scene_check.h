// Holds a parsed file against the schema and names the first thing that is wrong, and what would be right.
#ifndef CK_SCENE_CHECK_H
#define CK_SCENE_CHECK_H

#include "document.h"
#include "status.h"

#include <cyaml/cyaml.h>

// Checks keys, types, required keys, the range of every number, and that there is exactly one body.
// libcyaml checks most of this too, but does not say which keys or values would be right.
ck_Status ck_scene_check(const ck_Document *document, const cyaml_schema_value_t *schema, ck_Error *error);

#endif
