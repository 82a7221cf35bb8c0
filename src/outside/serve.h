// The other end of a command: an engine that answers the words of bridge/README.md.
#ifndef CK_SERVE_H
#define CK_SERVE_H

#include "engine.h"

// Answers on standard output what is asked on standard input, until it says quit or ends. Returns an exit status.
int ck_serve(const ck_Engine *engine);

#endif
