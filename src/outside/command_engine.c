// A command as an engine. bridge/README.md has the words that it is talked to with.
#include "export.h"
#include "outside_engine.h"
#include "outside_words.h"
#include "process.h"
#include "talk.h"
#include "text_pool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VERSION "clothcheck 1"
// Seconds in which a command must say what it is.
#define HELLO_SECONDS 10
#define MOST_SETTINGS (CK_OWN + CK_OWN_SETTINGS)

// One line of what it can be set.
typedef struct SettingText {
    char name[32], help[100];
    double least, most;
    bool is_whole;
} SettingText;

// What a command says of itself; in memory that is shared with the process that asks.
typedef struct Hello {
    char version[80], about[160];
    unsigned terms;
    SettingText settings[MOST_SETTINGS];
    int setting_count;
    bool is_raw, is_single;
} Hello;

typedef struct Command {
    char *line; // as a shell reads it
    Hello hello;
    ck_TextPool *pool;
    ck_Setting settings[MOST_SETTINGS + 1];
} Command;

typedef struct Session {
    ck_Talk talk;
    const Command *command;
    int particle_count;
    int rigid_count;
    double *raw; // [6*n + 7*rigid_count] of an answer in bytes
} Session;

static void take_terms(Hello *hello, ck_Talk *talk, char *words) {
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " ")) {
        int term = 0;
        while (term < CK_TERM_COUNT && strcmp(word, ck_term_words[term])) term++;
        if (term == CK_TERM_COUNT)
            ck_talk_refuse(talk, word,
                           "models with words of springs rigid damping gravity force drag velocity plane "
                           "sphere release");
        hello->terms |= 1u << term;
    }
}

static void take_setting(Hello *hello, ck_Talk *talk, const char *line) {
    SettingText *setting = &hello->settings[hello->setting_count];
    char kind[8];
    if (hello->setting_count == MOST_SETTINGS ||
        sscanf(line, "setting %31s %lf %lf %7s %99[^\n]", setting->name, &setting->least, &setting->most, kind,
               setting->help) != 5 ||
        !(setting->least <= setting->most) || (strcmp(kind, "whole") && strcmp(kind, "real")))
        ck_talk_refuse(talk, line, "setting NAME LEAST MOST whole|real HELP, at most 13 times");
    setting->is_whole = !strcmp(kind, "whole");
    hello->setting_count++;
}

typedef struct Question {
    const char *line;
    Hello *hello;
} Question;

// In a child process.
static void ask_hello(void *context) {
    const Question *question = context;
    Hello *hello = question->hello;
    ck_Talk talk;
    char line[400];
    ck_talk_start(&talk, question->line);
    fprintf(talk.to, VERSION "\nhello\n");
    ck_talk_ask(&talk, VERSION, NULL);
    for (;;) {
        ck_talk_line(&talk, line, sizeof line);
        if (!strcmp(line, "end")) break;
        if (!strncmp(line, "version ", 8))
            snprintf(hello->version, sizeof hello->version, "%.79s", line + 8);
        else if (!strncmp(line, "about ", 6))
            snprintf(hello->about, sizeof hello->about, "%.159s", line + 6);
        else if (!strncmp(line, "models ", 7))
            take_terms(hello, &talk, line + 7);
        else if (!strncmp(line, "setting ", 8))
            take_setting(hello, &talk, line);
        else if (!strcmp(line, "positions raw") || !strcmp(line, "positions text"))
            hello->is_raw = !strcmp(line, "positions raw");
        else if (!strcmp(line, "precision single") || !strcmp(line, "precision double"))
            hello->is_single = !strcmp(line, "precision single");
        else
            ck_talk_refuse(&talk, line, "version, about, models, setting, positions, precision or end");
    }
    ck_talk_end(&talk);
}

// CPU time of an empty message: each step has one.
static double measure_talk(Session *session) {
    const int pings = 20;
    double start = ck_talk_cpu(&session->talk);
    for (int i = 0; i < pings; i++) {
        fprintf(session->talk.to, "ping\n");
        ck_talk_ask(&session->talk, "ok", NULL);
    }
    return (ck_talk_cpu(&session->talk) - start) / pings;
}

static void send_settings(Session *session, const ck_Settings *wanted) {
    for (const ck_Setting *row = session->command->settings; row->name; row++)
        if (ck_settings_has(wanted, row->slot))
            fprintf(session->talk.to, "setting %s %.17g\n", row->name, ck_settings_get(wanted, row->slot));
}

// A row of its ledger: "ledger exact 1000 N/m 0.5; structural stiffness; kLST; how the one follows from the other".
static void take_row(Session *session, ck_Ledger *ledger, const char *line) {
    char match[16], unit[16], quantity[64], parameter[100], formula[300] = "";
    ck_LedgerRow row = {.quantity = quantity, .unit = unit, .native_parameter = parameter, .formula = formula};
    int fields = sscanf(line, "ledger %15s %lf %15s %lf ; %63[^;]; %99[^;]; %299[^\n]", match, &row.wanted, unit,
                        &row.native_value, quantity, parameter, formula);
    row.match = CK_EXACT;
    while (row.match <= CK_IMPOSSIBLE && strcmp(match, ck_match_names[row.match])) row.match++;
    if (fields < 6 || row.match > CK_IMPOSSIBLE)
        ck_talk_refuse(&session->talk, line,
                       "ledger exact|approximate|impossible VALUE UNIT VALUE; QUANTITY; PARAMETER; FORMULA");
    ck_ledger_add(ledger, ck_text_pool_keep_row(session->command->pool, row));
}

// Reads what it uses and makes of the scene until it is ready. False where it refuses the scene, with the reason.
static bool take_answer(Session *session, ck_Settings *used, ck_Ledger *ledger, char *reason, size_t size) {
    char line[600], name[32], wanted[100];
    for (;;) {
        double value;
        ck_talk_line(&session->talk, line, sizeof line);
        if (!strcmp(line, "ready")) return true;
        if (!strncmp(line, "refuse ", 7)) {
            snprintf(reason, size, "%.300s", line + 7);
            return false;
        }
        if (!strncmp(line, "ledger ", 7)) {
            take_row(session, ledger, line);
            continue;
        }
        const ck_Setting *setting = NULL;
        if (sscanf(line, "uses %31s %lf", name, &value) == 2)
            setting = ck_setting_find(session->command->settings, name);
        if (!setting || !ck_setting_takes(setting, value, wanted, sizeof wanted))
            ck_talk_refuse(&session->talk, line, "uses SETTING VALUE, ledger ROW, ready or refuse REASON");
        ck_settings_set(used, setting->slot, value);
    }
}

static void end_session(void *state) {
    Session *session = state;
    ck_talk_end(&session->talk);
    free(session->raw);
    free(session);
}

static ck_Status open_command(const void *source, void **state, const ck_Model *model, const ck_Settings *wanted,
                              ck_Settings *used, ck_Ledger *ledger, ck_Error *error) {
    Session *session = calloc(1, sizeof *session);
    double *raw = calloc(6 * (size_t)model->particle_count + 7 * (size_t)model->rigid_count, sizeof *raw);
    if (!session || !raw) {
        free(session);
        free(raw);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *session = (Session){
        .command = source, .particle_count = model->particle_count, .rigid_count = model->rigid_count, .raw = raw};
    *used = (ck_Settings){0};
    ck_talk_start(&session->talk, session->command->line);
    fprintf(session->talk.to, VERSION "\n");
    ck_talk_ask(&session->talk, VERSION, NULL);
    double message = measure_talk(session);
    fprintf(session->talk.to, "begin\n");
    ck_export_lines(session->talk.to, model);
    send_settings(session, wanted);
    fprintf(session->talk.to, "end\n");
    char reason[310];
    ck_text_pool_clear(session->command->pool);
    if (!take_answer(session, used, ledger, reason, sizeof reason)) {
        end_session(session);
        return ck_fail(error, CK_REFUSED, "%s", reason);
    }
    ck_ledger_add(ledger,
                  (ck_LedgerRow){"message", 0, "s", "stdin, stdout", message,
                                 "CPU time of an empty message, which is in the cost of each frame", CK_APPROXIMATE});
    *state = session;
    return CK_OK;
}

static ck_StepResult step(void *state) {
    Session *session = state;
    fprintf(session->talk.to, "step\n");
    return ck_talk_ask(&session->talk, "ok", "diverged") ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static void take_text(Session *session) {
    char line[400];
    for (int i = 0; i < session->particle_count; i++) {
        double *x = session->raw + 3 * i, *v = session->raw + 3 * (session->particle_count + i);
        int used = 0;
        ck_talk_line(&session->talk, line, sizeof line);
        if (sscanf(line, "%lf %lf %lf %lf %lf %lf %n", x, x + 1, x + 2, v, v + 1, v + 2, &used) != 6 || line[used])
            ck_talk_refuse(&session->talk, line, "x y z vx vy vz of each particle");
    }
    for (int i = 0; i < session->rigid_count; i++) {
        double *q = session->raw + 6 * (size_t)session->particle_count + 7 * (size_t)i;
        int used = 0;
        ck_talk_line(&session->talk, line, sizeof line);
        if (sscanf(line, "%lf %lf %lf %lf %lf %lf %lf %n", q, q + 1, q + 2, q + 3, q + 4, q + 5, q + 6, &used) != 7 ||
            line[used])
            ck_talk_refuse(&session->talk, line, "w x y z and the spin of each rigid body");
    }
}

static void read_state(const void *state, double *position, double *velocity) {
    // only what it says is read: the talk goes on
    Session *session = (Session *)state;
    size_t count = 3 * (size_t)session->particle_count;
    fprintf(session->talk.to, "read\n");
    if (session->command->hello.is_raw)
        ck_talk_bytes(&session->talk, session->raw,
                      2 * count * sizeof(double) + (size_t)session->rigid_count * sizeof(ck_Turn));
    else
        take_text(session);
    memcpy(position, session->raw, count * sizeof(double));
    memcpy(velocity, session->raw + count, count * sizeof(double));
}

static void pace(void *state, double duration) {
    Session *session = state;
    fprintf(session->talk.to, "pace %.17g\n", duration);
}

// As it was when the state was read.
static void turn(const void *state, ck_Turn *turn) {
    const Session *session = state;
    memcpy(turn, session->raw + 6 * (size_t)session->particle_count, sizeof *turn * (size_t)session->rigid_count);
}

static void release(void *state, int particle) {
    Session *session = state;
    fprintf(session->talk.to, "release %d\n", particle);
}

static double cpu(const void *state) {
    const Session *session = state;
    return ck_talk_cpu(&session->talk);
}

static void free_command(void *source) {
    Command *command = source;
    free(command->line);
    ck_text_pool_free(command->pool);
    free(command);
}

// Its settings as a table: those that studies vary by their names, others as its own.
static void make_settings(Command *command) {
    static const struct {
        const char *name;
        int slot;
    } known[] = {{"substeps", CK_SUBSTEPS},
                 {"iterations", CK_ITERATIONS},
                 {"relaxation", CK_RELAXATION},
                 {"threads", CK_THREADS}};
    for (int i = 0, own = 0; i < command->hello.setting_count; i++) {
        const SettingText *text = &command->hello.settings[i];
        int slot = -1;
        for (size_t k = 0; k < sizeof known / sizeof *known; k++)
            if (!strcmp(text->name, known[k].name)) slot = known[k].slot;
        if (slot < 0 && own == CK_OWN_SETTINGS) continue;
        command->settings[i] = (ck_Setting){.name = text->name,
                                            .slot = slot < 0 ? CK_OWN + own++ : slot,
                                            .is_whole = text->is_whole,
                                            .least = text->least,
                                            .most = text->most,
                                            .unit = "1",
                                            .rule = "its own",
                                            .help = text->help};
    }
}

static ck_Status ask(Command *command, const char *name, ck_Error *error) {
    Hello *hello = ck_shared_allocate(sizeof *hello);
    ck_ChildResult result;
    if (!hello) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    const ck_Limits limits = {.seconds = HELLO_SECONDS, .spawns = true};
    ck_Status status = ck_child_run(&result, ask_hello, &(Question){command->line, hello}, &limits, error);
    if (!status && result.end != CK_CHILD_DONE)
        status = ck_fail(error, CK_BAD_INPUT, "--engine %s=%.200s does not answer hello: %s", name, command->line,
                         result.reason);
    command->hello = *hello;
    ck_shared_free(hello, sizeof *hello);
    return status;
}

ck_Status ck_outside_command(ck_Engine **engine, const char *name, const char *line, bool is_known, ck_Error *error) {
    *engine = NULL;
    ck_OutsideEngine *made = ck_outside_new(name);
    Command *command = calloc(1, sizeof *command);
    if (command) {
        command->line = strdup(line);
        command->pool = ck_text_pool_new();
    }
    ck_Status status =
        made && command && command->line && command->pool ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ask(command, name, error);
    if (status) {
        if (command) free_command(command);
        if (made) ck_outside_free(&made->engine);
        return status;
    }
    make_settings(command);
    made->source = command;
    made->free_source = free_command;
    if (*command->hello.about)
        snprintf(made->about, sizeof made->about, "%s", command->hello.about);
    else
        snprintf(made->about, sizeof made->about, "a command: %.140s", line);
    snprintf(made->version, sizeof made->version, "%s", command->hello.version);
    if (is_known)
        snprintf(made->arguments, sizeof made->arguments, "--engine %s", name);
    else
        ck_outside_option(made, name, line);
    made->outside.open = open_command;
    made->outside.source = command;
    made->outside.cpu = cpu;
    made->outside.spawns = true;
    made->engine.terms = command->hello.terms;
    made->engine.is_single = command->hello.is_single;
    made->engine.settings = command->settings;
    made->engine.step = step;
    made->engine.read = read_state;
    made->engine.turn = turn;
    if (command->hello.terms & CK_TERM_JITTER) made->engine.pace = pace;
    made->engine.release = release;
    made->engine.destroy = end_session;
    *engine = &made->engine;
    return CK_OK;
}
