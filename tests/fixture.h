// Scenes as text, and engines stepped in this process: what most tests start from.
#ifndef FIXTURE_H
#define FIXTURE_H

// cmocka.h needs these four before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "comparison.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Writes text to a new temporary file and returns its path, which the caller unlinks and frees.
char *fixture_file(const char *text);

// Loads a scene from text; fails the test where it is wrong.
void fixture_load(ck_Comparison *comparison, const char *text);

// Steps an engine through all frames of a model, in this process. Fails the test if it does not get there.
//   settings  NULL: automatic
void fixture_run(ck_Trajectory *trajectory, const ck_Model *model, const ck_Engine *engine, const ck_Settings *settings,
                 ck_Settings *used);

// True where the engine models all that the scene names.
bool fixture_supports(const ck_Engine *engine, const ck_Model *model);

// True for engines that claim to be right: neither one that does nothing nor an origin with its quirks.
bool fixture_is_solver(const ck_Engine *engine);

// False where the engine refuses such a body.
bool fixture_takes(const ck_Engine *engine, const ck_Model *model);

// Fails the test unless |value − wanted| ≤ tolerance, and prints what was compared.
void assert_near(const char *what, double value, double wanted, double tolerance);

#endif
