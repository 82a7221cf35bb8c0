#include "outside_engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

ck_OutsideEngine *ck_outside_new(const char *name) {
    ck_OutsideEngine *made = calloc(1, sizeof *made);
    if (!made) return NULL;
    snprintf(made->name, sizeof made->name, "%s", name);
    made->outside = (ck_Outside){.version = made->version, .arguments = made->arguments, .frame_cost = NAN};
    made->engine = (ck_Engine){.name = made->name,
                               .about = made->about,
                               .family = "outside",
                               .method = CK_METHOD_UNKNOWN,
                               .outside = &made->outside};
    return made;
}

void ck_outside_free(ck_Engine *engine) {
    ck_OutsideEngine *made = (ck_OutsideEngine *)(void *)engine;
    if (!made) return;
    if (made->free_source) made->free_source(made->source);
    free(made);
}
