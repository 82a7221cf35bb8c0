// The parts of an engine from outside, in one allocation.
#ifndef CK_OUTSIDE_ENGINE_H
#define CK_OUTSIDE_ENGINE_H

#include "outside.h"

typedef struct ck_OutsideEngine {
    ck_Engine engine; // its address is that of the whole
    ck_Outside outside;
    char name[64], about[160], version[80], arguments[400];
    void *source; // of outside
    void (*free_source)(void *source);
} ck_OutsideEngine;

// With a name of its own, and of everything else nothing. NULL when out of memory.
ck_OutsideEngine *ck_outside_new(const char *name);

// Notes how a command line names it: --engine NAME=LINE, or LINE alone where name is NULL, in quotes for a shell.
void ck_outside_option(ck_OutsideEngine *made, const char *name, const char *line);

#endif
