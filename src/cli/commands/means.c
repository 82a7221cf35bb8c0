#include "means.h"
#include "command.h"
#include "process.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static ck_Status ask(ck_MeansQuestion *question, const ck_Arguments *arguments, ck_Error *error) {
    const ck_CompareOptions *options = &arguments->options;
    if (arguments->word_count || arguments->scene_count)
        return ck_fail(error, CK_BAD_INPUT, "means takes no scene: it has a spring and a chain of its own");
    if (options->engines != arguments->engines || options->engine_count != 1)
        return ck_fail(error, CK_BAD_INPUT,
                       "means needs one --engine NAME, as in --engine bullet-stock --set kLST=0.5");
    *question = (ck_MeansQuestion){.engine = arguments->engines[0],
                                   .mass = arguments->mass,
                                   .frame = 1 / arguments->fps,
                                   .stiffness = arguments->stiffness,
                                   .damping = arguments->damping,
                                   .limits = options->limits};
    for (int i = 0; i < options->override_count; i++)
        if (options->overrides[i].engine == question->engine)
            ck_settings_override(&question->settings, &options->overrides[i].settings);
    return CK_OK;
}

static void show_quantity(ck_Answer *answer, const char *quantity, const char *unit, double acts, double theory) {
    ck_answer_text(answer, quantity);
    ck_answer_text(answer, unit);
    ck_answer_number(answer, acts);
    ck_answer_number(answer, theory);
    ck_answer_number(answer, isfinite(acts) && theory != 0 ? acts / theory - 1 : NAN);
}

static void show_law(ck_Answer *answer, const ck_Means *means) {
    static const ck_AnswerColumn columns[] = {{"quantity", "quantity", -34, NULL}, {"unit", "unit", -6, NULL},
                                              {"acts", "acts as", 12, "%.5g"},     {"theory", "theory", 12, "%.5g"},
                                              {"off", "off", 10, "%.1e"},          {NULL, NULL, 0, NULL}};
    ck_answer_table(answer, "means", NULL, columns);
    show_quantity(answer, "stiffness at rest", "N/m", means->measured.at_rest, means->theory.at_rest);
    show_quantity(answer, "stiffness in motion", "N/m", means->measured.moving, means->theory.moving);
    show_quantity(answer, "damping in motion", "N*s/m", means->measured.damping, means->theory.damping);
    show_quantity(answer, "stiffness at rest, chain of 10", "N/m", means->chain, means->theory.at_rest);
}

// The rows of one engine that say what it is set to.
static void show_ledger(ck_Answer *answer, const ck_Engine *engine, const ck_Ledger *ledger) {
    static const char *const quantities[] = {"structural stiffness", "spring damping", "time step"};
    for (int i = 0; i < ledger->count; i++)
        for (size_t k = 0; k < sizeof quantities / sizeof *quantities; k++) {
            const ck_LedgerRow *row = &ledger->rows[i];
            if (strcmp(row->quantity, quantities[k])) continue;
            ck_answer_text(answer, engine->name);
            ck_answer_text(answer, row->quantity);
            ck_answer_text(answer, row->native_parameter);
            ck_answer_number(answer, row->native_value);
            ck_answer_text(answer, ck_match_names[row->match]);
        }
}

static ck_Status show_alike(ck_Answer *answer, const ck_MeansQuestion *question, double stiffness, double damping,
                            ck_Error *error) {
    static const ck_AnswerColumn columns[] = {{"engine", "engine", -16, NULL},
                                              {"quantity", "quantity", -22, NULL},
                                              {"parameter", "set to act alike", -32, NULL},
                                              {"value", "=", 14, "%.7g"},
                                              {"match", "match", -12, NULL},
                                              {NULL, NULL, 0, NULL}};
    ck_answer_table(answer, "alike", "\nIn the other engines, by their own rule for the step:", columns);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Ledger ledger;
        ck_Error why = {0};
        if (engine == question->engine || engine->method == CK_METHOD_STILL || engine->method == CK_METHOD_SEED)
            continue;
        ck_progress_show("means: %s", engine->name);
        ck_Status status = ck_means_alike(&ledger, engine, question, stiffness, damping, &why);
        if (status == CK_NO_MEMORY || status == CK_IO) {
            *error = why;
            return status;
        }
        if (!status) show_ledger(answer, engine, &ledger);
    }
    ck_progress_clear();
    return CK_OK;
}

static void say(ck_Answer *answer, const ck_MeansQuestion *question, const ck_Means *means) {
    const char *name = question->engine->name;
    if (isinf(means->measured.at_rest))
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s: a spring of these settings gives way to no weight: it is a bar",
                       name);
    else
        ck_answer_line(answer, CK_ANSWER_SAYS,
                       "%s: on %g kg, at a step of %.4g ms, these settings act like a spring of %.4g N/m at rest", name,
                       question->mass, 1e3 * means->dt, means->measured.at_rest);
    if (!isnan(means->measured.moving))
        ck_answer_line(answer, CK_ANSWER_NOTE, "In motion they act like %.4g N/m with %.3g N*s/m of damping.",
                       means->measured.moving, means->measured.damping);
    const double rest = means->measured.at_rest, share = means->chain / rest;
    if (isfinite(rest) && isinf(means->chain))
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "A chain of ten stays where it is: what moves it in a step is rounded away.");
    else if (isfinite(rest) && fabs(share - 1) > 0.02)
        ck_answer_line(answer, CK_ANSWER_NOTE,
                       "In a chain of ten each acts with %.3g of that: its sweeps do not reach along a chain.", share);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_MeansQuestion question;
    ck_Means means;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status) status = ask(&question, &arguments, &error);
    if (!status) status = ck_means_measure(&means, &question, &error);
    if (!status) {
        ck_Answer *answer = &arguments.answer;
        show_law(answer, &means);
        const double rest = means.measured.at_rest, stiffness = isfinite(rest) ? rest : means.measured.moving;
        if (isfinite(stiffness))
            status = show_alike(answer, &question, stiffness, fmax(0, means.measured.damping), &error);
        say(answer, &question, &means);
        ck_answer_line(answer, CK_ANSWER_NEXT, "clothcheck list %s", question.engine->name);
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_means = {
    .name = "means",
    .arguments = "",
    .about = "an engine's settings as the stiffness and damping that they act like",
    .help =
        "Hangs one mass on one spring of --engine, with its settings (--set KEY=N), and steps it: the positions tell "
        "how\nstiff and how damped the spring acts, at rest and in motion, beside theory; then a chain of ten. Says "
        "what the\nother engines would be set to, to act alike.",
    .groups = CK_TAKES_FORM | CK_TAKES_RUNS | CK_TAKES_SPRING,
    .seconds = 30,
    .run = run,
};
