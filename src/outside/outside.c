#include "outside_engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

void ck_outside_option(ck_OutsideEngine *made, const char *name, const char *line) {
    char *out = made->arguments, *end = out + sizeof made->arguments - 6;
    out += snprintf(out, sizeof made->arguments / 2, "--engine '%.60s=", name);
    for (; *line && out < end; line++) {
        // a quote ends the quotes, stands by itself, and begins them anew
        if (*line == '\'') out = stpcpy(out, "'\\'");
        *out++ = *line;
    }
    strcpy(out, "'");
}

void ck_outside_free(ck_Engine *engine) {
    ck_OutsideEngine *made = (ck_OutsideEngine *)(void *)engine;
    if (!made) return;
    if (made->free_source) made->free_source(made->source);
    free(made);
}
