#include "truth.h"

#include "bending_forms.h"
#include "capstan_path.h"
#include "contact_forms.h"
#include "motion_forms.h"
#include "names.h"
#include "process.h"
#include "rest_forms.h"
#include "roots.h"
#include "runge_kutta.h"
#include "swing_forms.h"
#include "truth_cache.h"
#include "vector.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define CLOSED "closed form"
// What a form must say that it knows.
#define EXTRAS                                                                                                         \
    (CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_MOVES |                          \
     CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_CHANGES)
// What an integrator knows of it.
#define INTEGRATED (EXTRAS & ~(unsigned)CK_TERM_CHANGES)

// Adding a truth is one function and one row here.
static const ck_TruthForm forms[] = {
    {"equilibrium", "equilibrium", "energy minimum by Newton with sparse Cholesky; spread over nudged starts", true,
     .terms = CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_COLLIDERS | CK_TERM_BODIES,
     .check = ck_truth_equilibrium_check, .solve = ck_truth_solve_equilibrium,
     .leaves_open = ck_truth_equilibrium_leaves_open},
    {"trajectory", "trajectory",
     "Runge-Kutta of the eighth order (Cooper and Verner 1972), bars as constraints, step halved until two runs agree "
     "to 1e-9",
     false, .terms = INTEGRATED, .is_chaotic = true, .check = ck_truth_trajectory_check,
     .solve = ck_truth_solve_trajectory, .work = ck_truth_trajectory_work},
    {"converged", "trajectory",
     "the same of the fourth order for a scene in contact: impacts, slip and stick located in time, Coulomb friction",
     false, .terms = INTEGRATED, .is_chaotic = true, .check = ck_truth_converged_check,
     .solve = ck_truth_solve_trajectory, .work = ck_truth_trajectory_work},
    {"rest", "invariants", "at rest, whatever the shape: nothing moves or penetrates, colliders carry what pins do not",
     true,
     .terms = CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_PULL_ONLY | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS |
              CK_TERM_BODIES,
     .check = ck_truth_rest_check},
    {"vertical_chain", CLOSED, "u_j = [m*g*(j*N - j*(j-1)/2) + j*M*g]/k: sum of the weights below each spring", true,
     .terms = CK_TERM_PULL_ONLY, .at = ck_truth_vertical_chain},
    {"catenary", CLOSED,
     "discrete elastic catenary: l_i = L + |T_i|/k, T_i = T_0 - sum of the weights before, shot to the far pin", true,
     .terms = CK_TERM_PULL_ONLY, .at = ck_truth_catenary, .off = ck_truth_catenary_off},
    {"cantilever", CLOSED,
     "elastica: EI*theta'' = -(w*(L - s) + P)*cos(theta), theta(0) given, theta'(L) = 0, shot from the tip", true,
     .at = ck_truth_cantilever, .off = ck_truth_cantilever_off},
    {"free_fall", CLOSED, "x = x_0 + v_0*t + a*t^2/2", false, .at = ck_truth_free_fall},
    {"terminal_speed", CLOSED, "v = v_t + (v_0 - v_t)*exp(-drag*t), v_t = a/drag", false,
     .at = ck_truth_terminal_speed},
    {"air_fall", CLOSED, "v = v_t*tanh(g*t/v_t), v_t = sqrt(2*m*g/(rho*C_d*A)): a level sheet let go in still air",
     false, .terms = CK_TERM_WIND, .at = ck_truth_air_fall},
    {"oscillator", CLOSED, "damped oscillator: u'' = -(k/m)*u - (c/m)*u'", false, .at = ck_truth_oscillator},
    {"longitudinal_modes", CLOSED, "fixed-free chain: w_j = 2*sqrt(k/m)*sin((2j-1)*pi/(2*(2N+1)))", false,
     .at = ck_truth_longitudinal_modes},
    {"taut_string", CLOSED, "beaded string: w_j = 2*sqrt(T/(m*d))*sin(j*pi/(2*(N+1)))", false,
     .at = ck_truth_taut_string, .is_linear = true, .off = ck_truth_taut_string_off},
    {"slinky", CLOSED, "free-free chain: w_j = 2*sqrt(k/m)*sin(j*pi/(2*N)) about a centre that falls freely", false,
     .terms = CK_TERM_RELEASE, .at = ck_truth_slinky},
    {"hanging_chain_modes", CLOSED, "w^2 = (g/l)*zeros of the Laguerre polynomial L_N; shapes L_i", false,
     .at = ck_truth_hanging_chain, .is_linear = true, .off = ck_truth_hanging_chain_off},
    {"pendulum", CLOSED, "sin(theta/2) = sin(theta_0/2)*cd(sqrt(g/L)*t); period 2*pi*sqrt(L/g)/AGM(1, cos(theta_0/2))",
     false, .at = ck_truth_pendulum, .nudge = ck_truth_nudge_pendulum},
    {"conical_pendulum", CLOSED, "circles at w = sqrt(g/h): cos(theta) = g/(w^2*l), l = L/(1 - m*w^2/k)", false,
     .at = ck_truth_conical_pendulum},
    {"plucked_mass", CLOSED, "m*y'' = -k*y^3/L^2: y = A*cn(A/L*sqrt(k/m)*t, 1/sqrt(2)), period 7.4163*L*sqrt(m/k)/A",
     false, .at = ck_truth_plucked_mass, .is_linear = true},
    {"bounce", CLOSED, "heights e^(2n)*h_0, rest after t_1 + 2*e*v_1/(g*(1 - e))", false, .terms = CK_TERM_PLANE,
     .at = ck_truth_bounce},
    {"slide", CLOSED, "s'' = g_t -+ mu*g_n; stop distance v^2/(2*(mu*g_n - g_t)); sticks for g_t <= mu*g_n", false,
     .terms = CK_TERM_PLANE, .at = ck_truth_slide},
    {"sphere_slide", CLOSED,
     "theta'' = (g/R)*sin(theta) up to cos(theta) = 2/3*cos(theta_0) + v_0^2/(3*g*R), then falls", false,
     .terms = CK_TERM_SPHERE, .at = ck_truth_sphere_slide, .nudge = ck_truth_nudge_sphere_slide},
    {"strike", CLOSED, "comes back at e times the speed it came with", false, .terms = CK_TERM_COLLIDERS,
     .at = ck_truth_strike},
    {"capstan", "rope on its arc",
     "springs and friction of a chain along the arc over a ball or across a cylinder; light: T_2 = T_1*e^(mu*pi)",
     false, .terms = CK_TERM_SPHERE | CK_TERM_SOLIDS, .off = ck_truth_capstan_off, .check = ck_truth_capstan_check,
     .solve = ck_truth_solve_capstan},
};

int ck_truth_count(void) {
    return sizeof forms / sizeof *forms;
}

const ck_TruthForm *ck_truth_form_at(int index) {
    return &forms[index];
}

const ck_TruthForm *ck_truth_form_find(const char *name) {
    for (int i = 0; i < ck_truth_count(); i++)
        if (!strcmp(forms[i].name, name)) return &forms[i];
    return NULL;
}

static const char *form_name(const void *table, int index) {
    (void)table;
    return index < ck_truth_count() ? forms[index].name : NULL;
}

static ck_Status fail_unknown(const ck_Model *model, ck_Error *error) {
    char known[400], hint[80];
    return ck_fail(error, CK_BAD_INPUT, "%s: there is no truth %s%s; known are %s", model->name, model->truth,
                   ck_name_hint(hint, sizeof hint, model->truth, form_name, NULL),
                   ck_name_list(known, sizeof known, form_name, NULL));
}

ck_Status ck_truth_check(const ck_Model *model, ck_Error *error) {
    if (!model->truth) return CK_OK;
    const ck_TruthForm *form = ck_truth_form_find(model->truth);
    if (!form) return fail_unknown(model, error);
    unsigned beyond = model->terms & EXTRAS & ~form->terms;
    for (int bit = 0; bit < CK_TERM_COUNT; bit++)
        if (beyond & (1u << bit))
            return ck_fail(error, CK_BAD_INPUT, "%s: truth %s knows no %s; take another, or none", model->name,
                           model->truth, ck_term_names[bit]);
    if (form->check) return form->check(model, error);
    if (!form->at) return CK_OK;
    double *state = malloc(6 * sizeof(double) * (size_t)model->particle_count);
    if (!state) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    ck_Status status = form->at(model, 0, state, state + 3 * model->particle_count, error);
    free(state);
    return status;
}

// What a reference may cost beside a closed form: some seconds.
#define MOST_WORK 1e8
// Of a spring or particle that is evaluated once.
#define SECONDS_OF_WORK 5e-9

// A linear theory has an amplitude: where the scene can be integrated, the difference to that says how far it is off.
static ck_Status add_reference(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    ck_ReferencePath path;
    if (ck_reference_work(model) > MOST_WORK) return CK_OK;
    ck_Error why = {0};
    ck_Status status = ck_reference_path_create(&path, model, &why);
    if (!status) {
        truth->paths[truth->path_count++] = path.fine;
        path.fine = (ck_Trajectory){0};
    }
    ck_reference_path_free(&path);
    return status == CK_NO_MEMORY ? ck_fail(error, status, "%s", why.message) : CK_OK;
}

// The nudge of a start, as a share, whose growth ends the horizon of a closed form, as it does a reference path's.
#define NUDGE 1e-9
#define GROWTH 1e4

static ck_Status find_horizon(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    ck_Model nudged = *model;
    size_t count = 3 * (size_t)model->particle_count;
    double *memory = malloc(3 * count * sizeof *memory), *at = memory + count;
    if (!memory) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    memcpy(memory, model->position, count * sizeof *memory);
    nudged.position = memory;
    truth->form->nudge(&nudged, NUDGE);
    ck_Status status = CK_OK;
    for (int frame = 0; frame <= model->frame_count && !status; frame++) {
        double apart = 0;
        status = truth->form->at(&nudged, frame * model->step, at, at + count, error);
        for (size_t i = 0; i < count && !status; i += 3)
            apart = fmax(apart, ck_distance(at + i, ck_trajectory_position(&truth->paths[0], frame) + i));
        if (apart > GROWTH * NUDGE * model->size) break;
        truth->reference.horizon = frame;
    }
    free(memory);
    return status;
}

// Samples a closed form at the model's frames; a static one once.
static ck_Status sample(ck_Truth *truth, const ck_Model *model, ck_Error *error) {
    ck_Trajectory *path = &truth->paths[0];
    ck_Status status = ck_trajectory_create(path, model, error);
    int frames = truth->form->is_static ? 1 : model->frame_count + 1;
    for (int frame = 0; frame < frames && !status; frame++) {
        status = ck_child_check(error);
        if (status) break;
        status = truth->form->at(model, frame * model->step, ck_trajectory_position(path, frame),
                                 ck_trajectory_velocity(path, frame), error);
        path->frame_count = frame + 1;
    }
    truth->path_count = 1;
    truth->reference.horizon = path->frame_count - 1;
    if (!status && truth->form->is_linear) status = add_reference(truth, model, error);
    if (!status && truth->form->nudge) status = find_horizon(truth, model, error);
    return status;
}

// What a child that solves for a truth tells its parent, beside the paths that it writes.
typedef struct Answer {
    ck_Status status;
    ck_Error why;
} Answer;

typedef struct Question {
    const ck_Truth *truth;
    const ck_Model *model;
    FILE *file;
    Answer *answer;
} Question;

static void answer_in_child(void *context) {
    const Question *question = context;
    ck_Truth truth = *question->truth;
    Answer *answer = question->answer;
    answer->status = truth.form->solve(&truth, question->model, &answer->why);
    if (answer->status) return;
    ck_truth_write(&truth, question->model, question->file);
    if (fflush(question->file)) answer->status = ck_fail(&answer->why, CK_IO, "%s", strerror(errno));
}

// What cannot end in time is told before it begins.
static ck_Status check_work(const ck_Truth *truth, const ck_Model *model, const ck_Limits *limits, ck_Error *error) {
    const double seconds = truth->form->work ? SECONDS_OF_WORK * truth->form->work(model) : 0;
    return seconds <= limits->seconds
               ? CK_OK
               : ck_fail(error, CK_REFUSED, "%s: its truth would take some %.3g s; --time-limit is %g s", model->name,
                         seconds, limits->seconds);
}

// In a child, as no work of ours knows how long it takes. CK_REFUSED, too, where it passes a limit.
static ck_Status solve_within(ck_Truth *truth, const ck_Model *model, const ck_Limits *limits, ck_Error *error) {
    const int memory = memfd_create("truth", MFD_CLOEXEC);
    FILE *file = memory >= 0 ? fdopen(memory, "w+b") : NULL;
    Answer *answer = ck_shared_allocate(sizeof *answer);
    ck_ChildResult child;
    ck_Status status = CK_OK;
    if (!file || !answer) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_child_run(&child, answer_in_child, &(Question){truth, model, file, answer}, limits, error);
    if (!status && child.end != CK_CHILD_DONE)
        status = ck_fail(error, CK_REFUSED, "%s: its truth was given up: %s", model->name, child.reason);
    else if (!status && answer->status)
        status = ck_fail(error, answer->status, "%s", answer->why.message);
    if (!status) rewind(file);
    if (!status && !ck_truth_read(truth, model, file))
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    if (file)
        fclose(file);
    else if (memory >= 0)
        close(memory);
    ck_shared_free(answer, sizeof *answer);
    return status;
}

static ck_Status solve(ck_Truth *truth, const ck_Model *model, const char *cache, const ck_Limits *limits,
                       ck_Error *error) {
    if (cache && ck_truth_cache_load(truth, model, cache)) return CK_OK;
    ck_Error why = {0};
    ck_Status status = limits ? check_work(truth, model, limits, &why) : CK_OK;
    if (!status) status = limits ? solve_within(truth, model, limits, &why) : truth->form->solve(truth, model, &why);
    if (status == CK_REFUSED) {
        snprintf(truth->kind, sizeof truth->kind, "none: %.*s", (int)sizeof truth->kind - 8, why.message);
        for (int i = 0; i < truth->path_count; i++) ck_trajectory_free(&truth->paths[i]);
        truth->path_count = 0;
        return CK_OK;
    }
    if (status) return ck_fail(error, status, "%s", why.message);
    // a cache that cannot be written costs time, not truth
    if (cache) ck_truth_cache_save(truth, model, cache);
    return CK_OK;
}

ck_Status ck_truth_without(ck_Truth *truth, const ck_Model *model, const char *kind, ck_Error *error) {
    *truth = (ck_Truth){0};
    ck_Status status = ck_truth_check(model, error);
    if (status || !model->truth) return status;
    truth->form = ck_truth_form_find(model->truth);
    truth->reference.is_static = truth->form->is_static;
    snprintf(truth->kind, sizeof truth->kind, "%s", kind);
    return CK_OK;
}

ck_Status ck_truth_create(ck_Truth *truth, const ck_Model *model, const char *cache, const ck_Limits *limits,
                          ck_Error *error) {
    *truth = (ck_Truth){0};
    ck_Status status = ck_truth_check(model, error);
    if (status || !model->truth) return status;
    truth->form = ck_truth_form_find(model->truth);
    truth->reference.is_static = truth->form->is_static;
    const char *note = truth->form->leaves_open ? truth->form->leaves_open(model) : NULL;
    snprintf(truth->kind, sizeof truth->kind, "%s%s%s", truth->form->kind, note ? ", " : "", note ? note : "");
    truth->reference.is_invariant = !truth->form->at && !truth->form->solve;
    if (truth->reference.is_invariant) return CK_OK;
    status = truth->form->at ? sample(truth, model, error) : solve(truth, model, cache, limits, error);
    truth->reference.trajectory = truth->paths[0];
    if (truth->form->off && !(truth->form->is_linear && truth->path_count > 1)) truth->off = truth->form->off(model);
    if (!status && truth->path_count && !truth->form->is_static)
        truth->reference.comes_to_rest = ck_metric_comes_to_rest(model, &truth->reference.trajectory);
    bool is_cut =
        !status && truth->path_count && !truth->form->is_static && truth->reference.horizon < model->frame_count;
    truth->reference.ends = is_cut && !truth->form->is_chaotic;
    if (is_cut && truth->reference.ends)
        snprintf(truth->kind, sizeof truth->kind, "%s to %.3g s, as it is unstable", truth->form->kind,
                 truth->reference.horizon * model->step);
    else if (is_cut)
        snprintf(truth->kind, sizeof truth->kind, "%s, points to %.3g s, then an ensemble of %d", truth->form->kind,
                 truth->reference.horizon * model->step, truth->path_count);
    return status;
}

double ck_truth_uncertainty(const ck_Truth *truth, const ck_Model *model, const ck_Metric *metric) {
    double value = ck_metric_truth(metric, model, &truth->reference);
    if (isnan(value)) return NAN;
    // what a form is off in positions it is, as a share, in what is read off them
    double spread = fmax(DBL_EPSILON, truth->off) * fmax(strcmp(metric->unit, "1") ? 0 : 1, fabs(value));
    if (metric->unsure) spread = fmax(spread, metric->unsure(model, &truth->reference.trajectory));
    bool is_ensemble = truth->form->is_chaotic && truth->path_count > 2;
    for (int i = 1; i < truth->path_count; i++) {
        // a path of one frame has no whole-run metrics
        if (!metric->at && truth->reference.is_static) continue;
        if (is_ensemble && metric->to_horizon && i > 1) continue;
        double other = ck_metric_value(metric, model, &truth->paths[i], &truth->reference);
        if (isnan(other)) continue;
        double reading = metric->unsure ? metric->unsure(model, &truth->paths[i]) : 0;
        spread = fmax(spread, (is_ensemble && !metric->to_horizon ? 2 : 1) * fabs(other - value) + reading);
    }
    return spread;
}

void ck_truth_free(ck_Truth *truth) {
    for (int i = 0; i < truth->path_count; i++) ck_trajectory_free(&truth->paths[i]);
    *truth = (ck_Truth){0};
}
