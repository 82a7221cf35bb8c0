// Settings of engines by what a command line calls them.
#ifndef CK_ASKED_SETTINGS_H
#define CK_ASKED_SETTINGS_H

#include "command.h"

// --set ENGINE.KEY=NUMBER, or KEY=NUMBER after one --engine. Errors: CK_BAD_INPUT, with the keys that there are.
ck_Status ck_arguments_add_setting(ck_Arguments *arguments, const char *text, ck_Error *error);

#endif
