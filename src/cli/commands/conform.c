#include "conform.h"
#include "command.h"
#include "process.h"
#include "tables.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Card {
    const ck_Arguments *arguments;
    const ck_Conform *conform;
    int properties[32], property_count; // that are asked for
    ck_ConformResult *results;          // [engines][property_count]
} Card;

static ck_Status choose_properties(Card *card, const ck_Arguments *arguments, ck_Error *error) {
    for (int i = 0; i < ck_conform_property_count(); i++) {
        bool is_wanted = !arguments->word_count;
        for (int k = 0; k < arguments->word_count; k++)
            is_wanted |= !fnmatch(arguments->words[k], ck_conform_property(i), 0);
        if (is_wanted) card->properties[card->property_count++] = i;
    }
    if (card->property_count) return CK_OK;
    char known[400] = "";
    size_t used = 0;
    for (int i = 0; i < ck_conform_property_count() && used < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", ck_conform_property(i));
    return ck_fail(error, CK_BAD_INPUT, "there is no property %s; known are %s", arguments->words[0], known);
}

static ck_Status ask_one(void *context, int index, ck_Error *error) {
    Card *card = context;
    const ck_Engine *engine = card->arguments->options.engines[index / card->property_count];
    int property = card->properties[index % card->property_count];
    ck_progress_show("%s: %s", engine->name, ck_conform_property(property));
    return ck_conform_ask(&card->results[index], card->conform, engine, property, error);
}

static ck_Status write_card(const Card *card, ck_Error *error) {
    ck_Csv csv = {0};
    ck_Status status = ck_csv_open(&csv, card->arguments->out, &ck_layouts[CK_CONFORM], error);
    for (int i = 0; i < card->arguments->options.engine_count * card->property_count && !status; i++)
        ck_conform_add(&card->results[i], card->arguments->options.engines[i / card->property_count],
                       card->properties[i % card->property_count], &csv);
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    if (!status) status = ck_machine_save(card->arguments->out, error);
    return status;
}

static void show_engine(ck_Answer *answer, const Card *card, int engine, int *failed) {
    const char *name = card->arguments->options.engines[engine]->name;
    int passed = 0, asked = 0;
    for (int i = 0; i < card->property_count; i++) {
        const ck_ConformResult *result = &card->results[engine * card->property_count + i];
        asked += result->verdict != CK_CONFORM_NONE;
        passed += result->verdict == CK_CONFORM_PASS;
        ck_answer_text(answer, name);
        ck_answer_text(answer, ck_conform_property(card->properties[i]));
        ck_answer_number(answer, result->value);
        ck_answer_number(answer, result->tolerance);
        ck_answer_text(answer, ck_conform_verdicts[result->verdict]);
        ck_answer_text(answer, result->reason);
    }
    ck_answer_line(answer, CK_ANSWER_SAYS, "%s: %d of %d", name, passed, asked);
    *failed += asked - passed;
}

static int show_card(ck_Answer *answer, const Card *card) {
    static const ck_AnswerColumn columns[] = {{"engine", "engine", -16, NULL},
                                              {"property", "property", -18, NULL},
                                              {"value", "value", 9, "%.2g"},
                                              {"tolerance", "within", 9, "%.2g"},
                                              {"verdict", "verdict", -8, NULL},
                                              {"reason", "why", -10, NULL},
                                              {NULL, NULL, 0, NULL}};
    int failed = 0;
    for (int engine = 0; engine < card->arguments->options.engine_count; engine++) {
        ck_answer_table(answer, "conform", NULL, columns);
        show_engine(answer, card, engine, &failed);
        ck_answer_gap(answer);
    }
    ck_answer_line(answer, CK_ANSWER_FILES, "%s/conform.csv", card->arguments->out);
    ck_answer_line(answer, CK_ANSWER_NEXT, "clothcheck report %s", card->arguments->out);
    return failed;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Conform conform = {0};
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    Card card = {.arguments = &arguments, .conform = &conform};
    if (!status) status = choose_properties(&card, &arguments, &error);
    if (!status) status = ck_conform_open(&conform, &arguments.options.limits, &error);
    ck_command_catch_signals();
    int count = arguments.options.engine_count * card.property_count, failed = 0;
    card.results = status ? NULL : calloc((size_t)count + 1, sizeof *card.results);
    if (!status && !card.results) status = ck_fail(&error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_parallel(count, ck_parallel_with_children(arguments.options.jobs), ask_one, &card, &error);
    ck_progress_clear();
    if (!status) status = write_card(&card, &error);
    if (!status) failed = show_card(&arguments.answer, &card);
    free(card.results);
    ck_conform_close(&conform);
    int ended = ck_command_end(&arguments, status, &error);
    return !ended && failed ? CK_EXIT_FAILED : ended;
}

const ck_Command ck_command_conform = {
    .name = "conform",
    .arguments = "[PROPERTY...]",
    .about = "an engine's conformance card: invariance, conservation, order, determinism",
    .help =
        "Asks each --engine for what physics asks of any solver: that place, direction, handedness, size and the order "
        "of\nsprings do not matter, that momentum is kept, that damping slows no fall, that it converges with its "
        "order, "
        "that energy\nstays without damping, and that two runs are alike. Each has a number, a tolerance by precision "
        "and order, and a\nverdict; exit status 1 where any fails. A PROPERTY may be a pattern, as 'translation*'.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_JOBS,
    .out = "out",
    .seconds = 60,
    .run = run,
};
