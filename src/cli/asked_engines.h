// Engines by what a command line calls them.
#ifndef CK_ASKED_ENGINES_H
#define CK_ASKED_ENGINES_H

#include "command.h"

// Adds the engines that text names to those that are asked for: a name or pattern of those of the program and, where it
// fits none, of the adapters beside it; NAME=ENGINE, the same under a second name; NAME=COMMAND, NAME=LIBRARY.so or
// LIBRARY.so.
ck_Status ck_arguments_add_engines(ck_Arguments *arguments, const char *text, ck_Error *error);

// CK_BAD_INPUT, with the names that there are.
ck_Status ck_engine_unknown(const char *name, ck_Error *error);

// Calls visit for each program beside this one that is an engine and whose name fits a pattern, until it says no.
// Returns how often.
int ck_adapters_visit(const char *pattern, bool (*visit)(void *context, const char *name, const char *path),
                      void *context);

// Asks such a program what it is. Errors: those of ck_outside_command. Free with ck_outside_free.
ck_Status ck_adapter_open(ck_Engine **engine, const char *name, const char *path, ck_Error *error);

#endif
