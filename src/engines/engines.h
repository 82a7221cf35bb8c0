// The table of engines.
#ifndef CK_ENGINES_H
#define CK_ENGINES_H

#include "engine.h"
#include "scene.h"

// In the order of the reports.
int ck_engine_count(void);
const ck_Engine *ck_engine_at(int index);

// Adds an engine from outside the program, which must outlive all use. Errors: CK_BAD_INPUT where its name is taken or
// not plain, or there are too many.
ck_Status ck_engines_add(const ck_Engine *engine, ck_Error *error);

// Adds an engine of the table a second time, under another name, to be run at other settings beside itself: what a
// scene sets for the one counts for the other. Errors: those of ck_engines_add.
ck_Status ck_engines_add_copy(const ck_Engine **copy, const char *name, const ck_Engine *of, ck_Error *error);

// The engine that one is a copy of; NULL: none.
const ck_Engine *ck_engine_original(const ck_Engine *engine);

// NULL where there is no such engine.
const ck_Engine *ck_engine_find(const char *name);

// Names by their number, as ck_name_hint reads them; NULL beyond the last.
const char *ck_engine_name(const void *table, int index);

// Whether all that a scene sets is of an engine there is, a setting that it has, and in its range.
// Errors: CK_BAD_INPUT with file:line:column.
ck_Status ck_engines_check(const ck_Scene *scene, ck_Error *error);

// The settings that a checked scene holds for an engine.
ck_Settings ck_engine_scene_settings(const ck_Engine *engine, const ck_Scene *scene);

#endif
