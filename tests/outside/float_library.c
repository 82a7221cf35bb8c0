// The solver as a shared library.
#include "float_engine.h"
#include "plugin.h"

CK_PLUGIN(float_engine);
