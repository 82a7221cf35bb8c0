#include "outside_engine.h"

#include "names.h"

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
    char word[sizeof made->arguments];
    snprintf(word, sizeof word, "%.60s%s%.300s", name ? name : "", name ? "=" : "", line);
    const size_t used = (size_t)snprintf(made->arguments, sizeof made->arguments, "--engine ");
    ck_text_shell(made->arguments + used, sizeof made->arguments - used, word);
}

void ck_outside_free(ck_Engine *engine) {
    ck_OutsideEngine *made = (ck_OutsideEngine *)(void *)engine;
    if (!made) return;
    if (made->free_source) made->free_source(made->source);
    free(made);
}
