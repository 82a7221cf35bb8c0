#include "view.h"
#include "command.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// Without a display there is nothing to open it in; whoever has one may still say no.
static void open_browser(const char *address) {
    if (!getenv("DISPLAY") && !getenv("WAYLAND_DISPLAY")) return;
    const pid_t child = fork();
    if (child != 0) return;
    setsid();
    const int nothing = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3 && nothing >= 0; stream++) dup2(nothing, stream);
    execlp("xdg-open", "xdg-open", address, (char *)NULL);
    _exit(127);
}

static void ready(void *context, const char *address) {
    const ck_Arguments *arguments = context;
    printf("%s\n=> open this address in a browser of this machine; it is served to nobody else. Ctrl-C ends it.\n"
           "Next: \"Save as scene\" writes %s/NAME.yaml; clothcheck compare %s/NAME.yaml runs the same again\n",
           address, arguments->out, arguments->out);
    fflush(stdout);
    if (!arguments->opens_nothing) open_browser(address);
}

// Those that are asked for, or the best known of each family that take the scene.
static int choose_engines(const ck_Arguments *arguments, const ck_Engine **engines) {
    static const char *const usual[] = {"native-verlet", "native-xpbd", "bullet-pbd", "ode-quick"};
    int count = 0;
    if (arguments->options.engines == arguments->engines) {
        for (int i = 0; i < arguments->options.engine_count && count < CK_LIVE_ENGINES; i++)
            engines[count++] = arguments->engines[i];
        return count;
    }
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
        if (ck_engine_find(usual[i])) engines[count++] = ck_engine_find(usual[i]);
    return count;
}

// Tells who does not take the scene. False where nobody does.
static bool tell_engines(const ck_Live *live) {
    int run = 0;
    for (int i = 0; i < ck_live_count(live); i++) {
        const ck_LiveEngine *engine = ck_live_engine(live, i);
        run += engine->runs;
        if (!engine->runs)
            printf("  %s %s: %s\n", engine->engine->name, ck_run_status_names[engine->status], engine->reason);
    }
    return run > 0;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Comparison comparison = {0};
    ck_Live *live = NULL;
    const ck_Engine *engines[CK_LIVE_ENGINES];
    ck_Settings wanted[CK_LIVE_ENGINES];
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT, "view takes one SCENE; %d are given; 'clothcheck list' tells them",
                         arguments.scene_count);
    if (!arguments.out) arguments.out = ".";
    if (!status) status = ck_comparison_load(&comparison, arguments.scenes[0], &error);
    const int count = status ? 0 : choose_engines(&arguments, engines);
    for (int i = 0; i < count; i++)
        wanted[i] = ck_comparison_settings(engines[i], &comparison.scene, &arguments.options);
    ck_command_catch_signals();
    if (!status)
        status = ck_live_start(&live, arguments.scenes[0], engines, wanted, count, &arguments.options.limits, &error);
    if (!status && !tell_engines(live)) status = ck_fail(&error, CK_BAD_INPUT, "no engine takes the scene");
    const ck_ViewOptions options = {arguments.port, arguments.out, arguments.begins_paused, arguments.speed};
    if (!status) status = ck_view_run(&live, &options, ready, &arguments, &error);
    ck_live_end(live);
    ck_comparison_free(&comparison);
    ck_arguments_free(&arguments);
    return status ? ck_command_fail(status, &error) : CK_EXIT_OK;
}

const ck_Command ck_command_view = {
    .name = "view",
    .arguments = "SCENE",
    .about = "the scene live in the browser, engines side by side; pull, lock, change",
    .help =
        "Serves a page on this machine alone in which engines step a scene together, at the pace of real time where "
        "they can.\nA click locks a particle or lets it go, dragging pulls it; forces, springs and settings change "
        "while it runs. \"Save as scene\"\nwrites what was done as a scene that does the same again, to the last "
        "bit. Without --engine: native-verlet, native-xpbd,\nbullet-pbd and ode-quick.",
    .groups = CK_TAKES_RUNS | CK_TAKES_OUT | CK_TAKES_VIEW,
    .seconds = 900,
    .run = run,
};
