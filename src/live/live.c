#include "live.h"

#include "change.h"
#include "document.h"
#include "engines.h"
#include "files.h"
#include "scene.h"
#include "session.h"
#include "text.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// s that a frame may take, and letters of all that is changed.
#define MOST_SECONDS 20
#define MOST_WORDS (1 << 18)
#define MOST_FRAMES 1e6

typedef enum Order { STEP, RESET, QUIT } Order;

// What parent and child tell each other, in memory that they share.
typedef struct Talk {
    sem_t go, done;
    pid_t child;
    Order order;
    int frame;
    bool changes; // words are to be applied before the frame
    char words[MOST_WORDS];
    ck_Status status;
    ck_Error error;
    ck_StepResult step;
    double cpu, wall;
} Talk;

typedef struct Seat {
    struct ck_Live *live;
    ck_LiveEngine shown;
    ck_Settings wanted;
    Talk *talk;
    pthread_t thread;
    bool has_thread;
    volatile bool has_ended;
    ck_ChildResult end;
} Seat;

// One change, as it was asked for.
typedef struct Deed {
    int frame;
    char *words;
} Deed;

struct ck_Live {
    char *named; // the scene's file and words, as it was given
    char *file;  // the same that goes on for as long as anybody looks
    ck_Scene scene;
    ck_Model model;
    ck_Segment now; // with what is changed; words NULL: nothing is
    Seat seats[CK_LIVE_ENGINES];
    int count, frame;
    ck_Limits limits;
    char *words;     // of all changes so far
    bool is_changed; // since the last frame
    Deed *deeds;
    int deed_count;
};

// The engine's world as the scene begins, and its first frame.
static void begin(Seat *seat, ck_Session *session) {
    Talk *talk = seat->talk;
    ck_Settings used;
    talk->error = (ck_Error){0};
    talk->status =
        ck_session_begin(session, seat->shown.engine, &seat->live->model, &seat->wanted, &used, NULL, &talk->error);
    if (!talk->status) ck_session_read(session, &seat->shown.shown, 0);
}

static void take_step(Seat *seat, ck_Session *session, ck_Segment *segment) {
    Talk *talk = seat->talk;
    const double cpu = ck_process_cpu(), wall = ck_wall();
    if (talk->changes) {
        ck_Segment next;
        talk->status =
            ck_segment_build(&next, &seat->live->model, seat->live->file, talk->words, talk->frame, &talk->error);
        if (!talk->status) talk->status = ck_session_change(session, &next, &talk->error);
        // the world of before may still look at the segment of before
        ck_Segment *idle = talk->status ? &next : segment;
        ck_segment_free(idle);
        if (talk->status) return;
        *segment = next;
    }
    talk->step = ck_session_advance(session, talk->frame);
    if (talk->step == CK_STEP_OK) ck_session_read(session, &seat->shown.shown, 0);
    talk->cpu = ck_process_cpu() - cpu;
    talk->wall = ck_wall() - wall;
}

static void play(void *context) {
    Seat *seat = context;
    Talk *talk = seat->talk;
    ck_Session session = {0};
    ck_Segment segment = {0};
    talk->child = getpid();
    begin(seat, &session);
    for (sem_post(&talk->done); !sem_wait(&talk->go) && talk->order != QUIT; sem_post(&talk->done)) {
        if (talk->order == STEP) {
            take_step(seat, &session, &segment);
            continue;
        }
        ck_session_end(&session);
        ck_segment_free(&segment);
        begin(seat, &session);
    }
}

static void *sit(void *context) {
    Seat *seat = context;
    ck_Error error = {0};
    if (ck_child_run(&seat->end, play, seat, &seat->live->limits, &error)) {
        seat->end.end = CK_CHILD_ABORTED;
        snprintf(seat->end.reason, sizeof seat->end.reason, "%.200s", error.message);
    }
    seat->has_ended = true;
    sem_post(&seat->talk->done);
    return NULL;
}

// The status of an engine that goes on no more.
static void close_seat(Seat *seat, ck_RunStatus status, const char *reason) {
    seat->shown.runs = false;
    seat->shown.status = status;
    snprintf(seat->shown.reason, sizeof seat->shown.reason, "%.500s", reason);
}

// Waits for a child's answer, and takes down how it fared.
static void hear(Seat *seat) {
    Talk *talk = seat->talk;
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += MOST_SECONDS;
    while (sem_timedwait(&talk->done, &until))
        if (errno == ETIMEDOUT) {
            kill(talk->child, SIGKILL);
            sem_wait(&talk->done); // its end
            close_seat(seat, CK_RUN_TIMED_OUT, "a frame took longer than 20 s");
            return;
        }
    if (seat->has_ended) {
        close_seat(seat, CK_RUN_ABORTED, *seat->end.reason ? seat->end.reason : "it ended");
        return;
    }
    seat->shown.cpu = talk->cpu;
    seat->shown.wall = talk->wall;
    if (talk->status)
        close_seat(seat, talk->status == CK_NO_MEMORY ? CK_RUN_OUT_OF_MEMORY : CK_RUN_REFUSED, talk->error.message);
    else if (talk->step)
        close_seat(seat, CK_RUN_DIVERGED, "it left the finite numbers");
}

static ck_Status start_seat(Seat *seat, ck_Error *error) {
    ck_Model single = seat->live->model;
    single.frame_count = 0;
    seat->talk = ck_shared_allocate(sizeof *seat->talk);
    if (!seat->talk) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    sem_init(&seat->talk->go, 1, 0);
    sem_init(&seat->talk->done, 1, 0);
    ck_Status status = ck_trajectory_create(&seat->shown.shown, &single, error);
    if (status) return status;
    seat->shown.shown.frame_count = 1;
    seat->shown.runs = true;
    if (ck_engine_lacks(seat->shown.engine, &seat->live->model)) {
        close_seat(seat, CK_RUN_UNSUPPORTED, "it does not model all of the scene");
        return CK_OK;
    }
    if (pthread_create(&seat->thread, NULL, sit, seat)) return ck_fail(error, CK_IO, "cannot start a thread");
    seat->has_thread = true;
    hear(seat);
    return CK_OK;
}

// As many frames as a scene may have, under its own name.
static ck_Status name_long(ck_Live *live, ck_Error *error) {
    ck_Scene scene;
    ck_Status status = ck_scene_load(&scene, live->named, error);
    if (!status && asprintf(&live->file, "%s@time.duration=%.17g@name=%s", live->named,
                            MOST_FRAMES * scene.file->time.step, scene.file->name) < 0)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_scene_free(&scene);
    return status;
}

ck_Status ck_live_start(ck_Live **out, const char *file, const ck_Engine *const *engines, const ck_Settings *wanted,
                        int count, const ck_Limits *limits, ck_Error *error) {
    ck_Live *live = *out = calloc(1, sizeof *live);
    if (!live) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    live->named = strdup(file);
    live->words = strdup("");
    live->limits = *limits;
    live->limits.seconds = 1e9; // a frame has its own
    if (!live->named || !live->words) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = name_long(live, error);
    if (!status) status = ck_scene_load(&live->scene, live->file, error);
    if (!status) status = ck_model_build_part(&live->model, &live->scene, error);
    if (!status) status = ck_model_check_outside(&live->model, &live->scene, error);
    for (int i = 0; i < count && i < CK_LIVE_ENGINES && !status; i++) {
        Seat *seat = &live->seats[live->count++];
        seat->live = live;
        seat->shown.engine = engines[i];
        seat->wanted = wanted[i];
        // so that it tells of its end as others do
        live->limits.spawns |= engines[i]->outside && engines[i]->outside->spawns;
        status = start_seat(seat, error);
    }
    return status;
}

static void end_deeds(ck_Live *live) {
    for (int i = 0; i < live->deed_count; i++) free(live->deeds[i].words);
    live->deed_count = 0;
}

void ck_live_end(ck_Live *live) {
    for (int i = 0; live && i < live->count; i++) {
        Seat *seat = &live->seats[i];
        if (seat->has_thread) {
            seat->talk->order = QUIT;
            sem_post(&seat->talk->go);
            // one that hangs would not hear it
            if (seat->talk->child > 0 && !seat->shown.runs) kill(seat->talk->child, SIGKILL);
            pthread_join(seat->thread, NULL);
        }
        ck_trajectory_free(&seat->shown.shown);
        ck_shared_free(seat->talk, sizeof *seat->talk);
    }
    if (!live) return;
    end_deeds(live);
    free(live->deeds);
    ck_segment_free(&live->now);
    ck_model_free(&live->model);
    ck_scene_free(&live->scene);
    free(live->words);
    free(live->named);
    free(live->file);
    free(live);
}

ck_Status ck_live_set_rate(ck_Live **live, double rate, ck_Error *error) {
    const ck_Live *before = *live;
    const ck_Engine *engines[CK_LIVE_ENGINES];
    ck_Settings wanted[CK_LIVE_ENGINES];
    const int named = ck_change_file_length(before->named);
    char change[60], *changes = strdup(before->named + named), *file = NULL;
    ck_Live *next = NULL;
    ck_Status status = CK_OK;
    snprintf(change, sizeof change, "@time.fps=%.17g", rate);
    for (int i = 0; i < before->count; i++) {
        engines[i] = before->seats[i].shown.engine;
        wanted[i] = before->seats[i].wanted;
    }
    if (!changes || !ck_change_merge(&changes, change) || asprintf(&file, "%.*s%s", named, before->named, changes) < 0)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    else
        status = ck_live_start(&next, file, engines, wanted, before->count, &before->limits, error);
    free(changes);
    free(file);
    // the one that nobody looks at any more
    ck_live_end(status ? next : *live);
    if (!status) *live = next;
    return status;
}

int ck_live_count(const ck_Live *live) {
    return live->count;
}

const ck_LiveEngine *ck_live_engine(const ck_Live *live, int index) {
    return &live->seats[index].shown;
}

const ck_Model *ck_live_model(const ck_Live *live) {
    return live->now.words ? &live->now.model : &live->model;
}

const ck_Scene *ck_live_scene(const ck_Live *live) {
    return &live->scene;
}

int ck_live_frame(const ck_Live *live) {
    return live->frame;
}

// Changes of one frame are one, as a scene has them.
static bool note_deed(ck_Live *live, const char *words) {
    Deed *last = live->deed_count ? &live->deeds[live->deed_count - 1] : NULL;
    if (last && last->frame == live->frame) return ck_change_merge(&last->words, words);
    Deed *grown = realloc(live->deeds, sizeof *grown * ((size_t)live->deed_count + 1));
    if (!grown) return false;
    live->deeds = grown;
    grown[live->deed_count] = (Deed){live->frame, strdup(words)};
    return grown[live->deed_count++].words != NULL;
}

ck_Status ck_live_change(ck_Live *live, const char *words, ck_Error *error) {
    char *merged = strdup(live->words);
    ck_Segment next = {0};
    if (!merged || !ck_change_merge(&merged, words)) {
        free(merged);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    ck_Status status = strlen(merged) < MOST_WORDS ? CK_OK : ck_fail(error, CK_BAD_INPUT, "more than can be changed");
    if (!status) status = ck_segment_build(&next, &live->model, live->file, merged, live->frame, error);
    if (!status && !note_deed(live, words)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (status) {
        ck_segment_free(&next);
        free(merged);
        return status;
    }
    ck_segment_free(&live->now);
    live->now = next;
    free(live->words);
    live->words = merged;
    live->is_changed = true;
    return CK_OK;
}

// Gives all that run an order, and waits for all.
static void order_all(ck_Live *live, Order order) {
    for (int i = 0; i < live->count; i++) {
        Seat *seat = &live->seats[i];
        if (!seat->shown.runs) continue;
        seat->talk->order = order;
        seat->talk->frame = live->frame;
        seat->talk->changes = live->is_changed;
        if (live->is_changed) snprintf(seat->talk->words, MOST_WORDS, "%s", live->words);
        sem_post(&seat->talk->go);
    }
    for (int i = 0; i < live->count; i++)
        if (live->seats[i].shown.runs) hear(&live->seats[i]);
}

void ck_live_step(ck_Live *live) {
    order_all(live, STEP);
    live->is_changed = false;
    live->frame++;
}

void ck_live_reset(ck_Live *live) {
    for (int i = 0; i < live->count; i++) {
        Seat *seat = &live->seats[i];
        // one that failed on the way may fare better this time
        seat->shown.runs |= seat->has_thread && !seat->has_ended;
        seat->talk->step = CK_STEP_OK;
        seat->shown.status = CK_RUN_OK;
        seat->shown.reason[0] = 0;
    }
    ck_segment_free(&live->now);
    *live->words = 0;
    live->is_changed = false;
    end_deeds(live);
    live->frame = 0;
    order_all(live, RESET);
}

// Puts a value in the text of a scene, as after its file.
static ck_Status put(ck_Document *document, const char *key, const char *value, ck_Error *error) {
    const ck_Change change = {key, value, (int)strlen(key), (int)strlen(value)};
    ck_Status status = ck_change_apply(document, &change, error);
    return status ? status : ck_document_parse(document, error);
}

static char *changes_text(const ck_Live *live) {
    ck_Text text;
    if (!ck_text_begin(&text)) return NULL;
    FILE *out = text.file;
    fprintf(out, "[");
    for (int i = 0; i < live->deed_count; i++) {
        const Deed *deed = &live->deeds[i];
        // one that nothing has been stepped with is not yet done
        if (deed->frame >= live->frame) continue;
        fprintf(out, "%s{at: %.17g, set: \"", i ? ",\n  " : "", deed->frame * live->model.step);
        for (const char *letter = deed->words; *letter; letter++)
            fprintf(out, *letter == '"' || *letter == '\\' ? "\\%c" : "%c", *letter);
        fprintf(out, "\"}");
    }
    fprintf(out, "]");
    return ck_text_end(&text) ? text.bytes : NULL;
}

// The settings that the session began with, where the scene has others or none.
static ck_Status put_settings(const ck_Live *live, ck_Document *document, ck_Error *error) {
    ck_Status status = CK_OK;
    for (int i = 0; i < live->count; i++) {
        const ck_Engine *engine = live->seats[i].shown.engine;
        const ck_Settings *wanted = &live->seats[i].wanted, own = ck_engine_scene_settings(engine, &live->scene);
        for (const ck_Setting *row = engine->settings; row && row->name && !status; row++) {
            const double value = ck_settings_get(wanted, row->slot);
            char key[200], text[40];
            if (!ck_settings_has(wanted, row->slot) ||
                (ck_settings_has(&own, row->slot) && ck_settings_get(&own, row->slot) == value))
                continue;
            snprintf(key, sizeof key, "settings.%s.%s", engine->name, row->name);
            snprintf(text, sizeof text, "%.17g", value);
            status = put(document, key, text, error);
        }
    }
    return status;
}

ck_Status ck_live_save(const ck_Live *live, const char *folder, const char *name, ck_Error *error) {
    ck_Document document;
    char duration[40], *changes = changes_text(live);
    if (live->frame < 1) {
        free(changes);
        return ck_fail(error, CK_BAD_INPUT, "nothing has been stepped yet: there is nothing to save");
    }
    ck_Status status = changes ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status loaded = ck_document_load(&document, live->named, live->scene.document.kind, error);
    if (!status) status = loaded;
    snprintf(duration, sizeof duration, "%.17g", live->frame * live->model.step);
    if (!status) status = put(&document, "time.duration", duration, error);
    if (!status && live->scene.file->truth) status = put(&document, "truth", "none", error);
    if (!status) status = put_settings(live, &document, error);
    if (!status) status = put(&document, "changes", changes, error);
    ck_WholeFile whole = {0};
    if (!status) status = ck_whole_file_open(&whole, folder, name, error);
    if (!status) {
        fwrite(document.text, 1, document.length, whole.file);
        status = ck_whole_file_close(&whole, error);
    }
    ck_whole_file_discard(&whole);
    ck_document_free(&document);
    free(changes);
    return status;
}
