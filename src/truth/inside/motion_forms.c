#include "motion_forms.h"

#include "rest_forms.h"
#include "shape.h"
#include "springs.h"
#include "time_scale.h"
#include "vector.h"
#include "wind.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

// One mode of a rope of equal masses: its shape over particles 0 … n, its frequency and decay.
typedef struct Mode {
    double (*shape)(int n, int particle, double parameter);
    double parameter;
    double frequency; // rad/s, without damping
    double decay;     // 1/s, of the amplitude
} Mode;

// q'' + 2·decay·q' + frequency²·q = 0 from q = 0 and a given speed, below or above critical damping.
static void ring(const Mode *mode, double speed, double time, double *q, double *rate) {
    double square = mode->frequency * mode->frequency - mode->decay * mode->decay, fade = exp(-mode->decay * time);
    double root = sqrt(fabs(square)), sine = square > 0 ? sin(root * time) : sinh(root * time),
           cosine = square > 0 ? cos(root * time) : cosh(root * time);
    *q = root > 0 ? speed * fade * sine / root : speed * fade * time;
    *rate = speed * fade * cosine - mode->decay * *q;
}

// Adds what the mode makes of the start velocity.
static void add_mode(const ck_Model *model, const Mode *mode, double time, double *position, double *velocity) {
    int n = model->particle_count - 1;
    double start[3] = {0}, norm = 0;
    for (int i = 0; i <= n; i++) {
        if (model->pinned[i]) continue;
        double shape = mode->shape(n, i, mode->parameter);
        norm += shape * shape;
        ck_add_scaled(start, shape, model->velocity + 3 * i);
    }
    double q, rate;
    ring(mode, 1, time, &q, &rate);
    for (int i = 0; i <= n; i++) {
        if (model->pinned[i]) continue;
        double share = mode->shape(n, i, mode->parameter) / norm;
        ck_add_scaled(position + 3 * i, share * q, start);
        ck_add_scaled(velocity + 3 * i, share * rate, start);
    }
}

void ck_truth_start_from(const ck_Model *model, double *position, double *velocity) {
    memcpy(position, model->position, 3 * sizeof(double) * (size_t)model->particle_count);
    memset(velocity, 0, 3 * sizeof(double) * (size_t)model->particle_count);
}

// The most modes that a path is summed of: each frame costs their square.
#define MAX_MODES 1000

// A chain stopped from speed v strains its springs by at most v/(d·√(k/m)); below 1 no particle passes its neighbour.
static bool is_gentle(const ck_Model *model) {
    const ck_Spring *spring = &model->springs[0];
    return ck_length(model->velocity + 3) < 0.5 * spring->rest * sqrt(spring->stiffness / model->mass[0]);
}

static double sine_shape(int n, int particle, double parameter) {
    (void)n;
    return sin(parameter * particle);
}

static bool has_field(const ck_Model *model) {
    return model->terms & (CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_COLLIDERS | CK_TERM_RELEASE);
}

static bool has_equal_masses(const ck_Model *model) {
    for (int i = 1; i < model->particle_count; i++)
        if (fabs(model->mass[i] - model->mass[0]) > 1e-12 * model->mass[0]) return false;
    return true;
}

// |cos| of the angle between the start velocity of the last free particle and the rope.
static double velocity_along(const ck_Model *model) {
    double along[3];
    const double *velocity = model->velocity + 3;
    ck_subtract(along, model->position + 3, model->position);
    double scale = ck_length(along) * ck_length(velocity);
    return scale > 0 ? fabs(ck_dot(along, velocity)) / scale : NAN;
}

ck_Status ck_truth_longitudinal_modes(const ck_Model *model, double time, double *position, double *velocity,
                                      ck_Error *error) {
    bool fits = ck_shape_is_even_chain(model) && model->pin_count == 1 && model->pinned[0] && !has_field(model) &&
                has_equal_masses(model) && !(model->terms & CK_TERM_RIGID) && velocity_along(model) > 1 - 1e-12 &&
                model->particle_count <= MAX_MODES && ck_springs_start_at_rest(model) && is_gentle(model);
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a straight rope of at most 1000 equal springs and masses, pinned at its first "
                                     "particle, thrown along itself so gently that no spring turns over, and no other "
                                     "force than drag");
    if (status) return status;
    const int n = model->particle_count - 1;
    const ck_Spring *spring = &model->springs[0];
    ck_truth_start_from(model, position, velocity);
    for (int j = 1; j <= n; j++) {
        double frequency = 2 * sqrt(spring->stiffness / model->mass[0]) * sin((2 * j - 1) * pi / (2 * (2 * n + 1)));
        // spring damping is proportional to stiffness, so that each mode has a decay of its own
        double decay = 0.5 * (model->drag + spring->damping / spring->stiffness * frequency * frequency);
        add_mode(model, &(Mode){sine_shape, (2 * j - 1) * pi / (2 * n + 1), frequency, decay}, time, position,
                 velocity);
    }
    return CK_OK;
}

ck_Status ck_truth_oscillator(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    ck_Status status = ck_truth_need(model->particle_count == 2, model, error, "two particles");
    return status ? status : ck_truth_longitudinal_modes(model, time, position, velocity, error);
}

static double string_tension(const ck_Model *model) {
    return model->springs[0].stiffness * (model->spacing - model->springs[0].rest);
}

ck_Status ck_truth_taut_string(const ck_Model *model, double time, double *position, double *velocity,
                               ck_Error *error) {
    int last = model->particle_count - 1;
    bool fits = ck_shape_is_even_chain(model) && model->pin_count == 2 && model->pinned[0] && model->pinned[last] &&
                !has_field(model) && has_equal_masses(model) && !(model->terms & CK_TERM_RIGID) &&
                velocity_along(model) < 1e-12 && string_tension(model) > 0;
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a straight rope with prestretch, equal springs and masses, pinned at both ends, "
                                     "thrown sideways, and no other force than drag");
    if (status) return status;
    ck_truth_start_from(model, position, velocity);
    for (int j = 1; j < last; j++) {
        double frequency =
            2 * sqrt(string_tension(model) / (model->mass[0] * model->spacing)) * sin(j * pi / (2 * last));
        add_mode(model, &(Mode){sine_shape, j * pi / last, frequency, 0.5 * model->drag}, time, position, velocity);
    }
    return CK_OK;
}

// A slope s = v/c, c the wave speed, draws points along the string by up to s²/2 of its length, raises the tension by
// k·d·s²/2, and so the phase ω·t of the first mode by half that share, times the amplitude v/ω.
double ck_truth_taut_string_off(const ck_Model *model) {
    double tension = string_tension(model), wave = sqrt(tension * model->spacing / model->mass[0]),
           speed = ck_length(model->velocity + 3);
    double slope = speed / wave, share = 0.25 * model->springs[0].stiffness * model->spacing / tension * slope * slope;
    return 0.5 * slope * slope + share * speed * model->duration / model->size;
}

// A chain without pins in its modes cos((i + ½)·j·π/N), each from where it is at the start, about its falling centre.
static void add_free_mode(const ck_Model *model, int j, const double *along, double time, double *x, double *v) {
    const int count = model->particle_count;
    const ck_Spring *spring = &model->springs[0];
    double start = 0, norm = 0, q, rate;
    double frequency = 2 * sqrt(spring->stiffness / model->mass[0]) * sin(j * pi / (2 * count));
    for (int i = 0; i < count; i++) {
        double shape = cos((i + 0.5) * j * pi / count), from_first[3];
        ck_subtract(from_first, model->position + 3 * i, model->position);
        start += shape * (ck_dot(from_first, along) - i * spring->rest);
        norm += shape * shape;
    }
    // let go: the unit response from q = 1 at rest is q' + 2·decay·q of that from a unit speed
    const double decay = 0.5 * spring->damping / spring->stiffness * frequency * frequency;
    ring(&(Mode){.frequency = frequency, .decay = decay}, 1, time, &q, &rate);
    for (int i = 0; i < count; i++) {
        double share = start / norm * cos((i + 0.5) * j * pi / count);
        ck_add_scaled(x + 3 * i, share * (rate + 2 * decay * q), along);
        ck_add_scaled(v + 3 * i, -share * frequency * frequency * q, along);
    }
}

// A rope that is straight, and of equal parts: along, unit, and centre, the mean of what each is past its rest, m.
static bool is_straight(const ck_Model *model, double *along, double *centre) {
    const int count = model->particle_count;
    const ck_Spring *first = &model->springs[0];
    if (!ck_shape_is_chain(model)) return false;
    ck_subtract(along, model->position + 3 * (count - 1), model->position);
    const double length = ck_length(along);
    for (int axis = 0; axis < 3; axis++) along[axis] /= length;
    *centre = 0;
    bool straight = length > 0;
    for (int i = 0; i < count && straight; i++) {
        double from_first[3];
        ck_subtract(from_first, model->position + 3 * i, model->position);
        const double far = ck_dot(from_first, along);
        *centre += (far - i * first->rest) / count;
        straight = fabs(ck_length(from_first) - far) <= 1e-12 * length;
    }
    for (int i = 1; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        straight &= fabs(spring->rest / first->rest - 1) < 1e-12 && spring->damping == first->damping;
        straight &= fabs(spring->stiffness / first->stiffness - 1) < 1e-12;
    }
    return straight;
}

static bool is_let_go_whole(const ck_Model *model) {
    for (int i = 0; i < model->particle_count; i++)
        if (ck_model_is_held(model, i)) return false;
    for (int i = 0; i < model->release_count; i++)
        if (model->releases[i].frame > 0) return false;
    return true;
}

ck_Status ck_truth_slinky(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    const unsigned others = CK_TERM_RIGID | CK_TERM_DRAG | CK_TERM_VELOCITY | CK_TERM_COLLIDERS;
    const int count = model->particle_count;
    double along[3], centre = 0, field[3];
    bool fits = is_straight(model, along, &centre) && count <= MAX_MODES && has_equal_masses(model) &&
                is_let_go_whole(model) && !(model->terms & others);
    ck_Status status = ck_truth_need(fits, model, error,
                                     "a straight rope of at most 1000 equal springs and masses, let go whole at the "
                                     "start, and no other force than gravity and damping along springs");
    if (status) return status;
    ck_model_field(model, 0, field);
    for (int i = 0; i < count; i++) {
        memcpy(position + 3 * i, model->position, 3 * sizeof(double));
        ck_add_scaled(position + 3 * i, centre + i * model->springs[0].rest, along);
        ck_add_scaled(position + 3 * i, 0.5 * time * time, field);
        memset(velocity + 3 * i, 0, 3 * sizeof(double));
        ck_add_scaled(velocity + 3 * i, time, field);
    }
    for (int j = 1; j < count; j++) add_free_mode(model, j, along, time, position, velocity);
    for (int i = 1; i < count; i++) {
        double side[3];
        ck_subtract(side, position + 3 * i, position + 3 * i - 3);
        if (ck_dot(side, along) <= 0)
            return ck_fail(error, CK_BAD_INPUT,
                           "%s: truth slinky ends where coils meet, here before %.3g s; stiffen it, or end the scene "
                           "sooner",
                           model->name, time);
    }
    return CK_OK;
}

// Laguerre polynomial by its three-term recurrence.
static double laguerre(int degree, double x) {
    double before = 1, now = 1 - x;
    if (degree == 0) return before;
    for (int k = 1; k < degree; k++) {
        double next = ((2 * k + 1 - x) * now - k * before) / (k + 1);
        before = now;
        now = next;
    }
    return now;
}

// The j-th zero, j = 1 …, between the sign changes of a scan: neighbouring zeros of degree ≤ 60 lie more than 0.02
// apart near 0 and farther above, and the largest is below 4N + 2.
static double laguerre_zero(int degree, int j) {
    double step = 0.2 / (degree + 1), low = 0;
    for (; j > 0; low += step)
        if (laguerre(degree, low) * laguerre(degree, low + step) <= 0) j--;
    double high = low;
    low -= step;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        if (laguerre(degree, low) * laguerre(degree, middle) <= 0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

// counted from the free end
static double laguerre_shape(int n, int particle, double parameter) {
    return laguerre(n - particle, parameter);
}

// Links keep their length: one that leans by d sideways is d²/2l less deep, to second order. So its energy is what the
// modes' is.
static void lift(const ck_Model *model, double *position, double *velocity) {
    double along[3], rise = 0, rate = 0;
    ck_subtract(along, model->position + 3, model->position);
    for (int axis = 0; axis < 3; axis++) along[axis] /= model->spacing;
    for (int i = 1; i < model->particle_count; i++) {
        double lean[3], turn[3];
        ck_subtract(lean, position + 3 * i, position + 3 * i - 3);
        ck_subtract(turn, velocity + 3 * i, velocity + 3 * i - 3);
        // what is above has been lifted already
        ck_tangential(lean, lean, along);
        ck_tangential(turn, turn, along);
        rise += ck_dot(lean, lean) / (2 * model->spacing);
        rate += ck_dot(lean, turn) / model->spacing;
        ck_add_scaled(position + 3 * i, -rise, along);
        ck_add_scaled(velocity + 3 * i, -rate, along);
    }
}

// Springs that start at rest length bounce about their stretch under the weight below, in the longitudinal modes.
static void add_bounce(const ck_Model *model, double time, double *position, double *velocity) {
    const int n = model->particle_count - 1;
    const ck_Spring *spring = &model->springs[0];
    double along[3], weight = model->mass[0] * ck_length(model->gravity);
    ck_subtract(along, model->position + 3, model->position);
    for (int axis = 0; axis < 3; axis++) along[axis] /= model->spacing;
    for (int j = 1; j <= n; j++) {
        double parameter = (2 * j - 1) * pi / (2 * n + 1), rest = 0, norm = 0, q, rate;
        double frequency = 2 * sqrt(spring->stiffness / model->mass[0]) * sin(0.5 * parameter);
        double decay = 0.5 * (model->drag + spring->damping / spring->stiffness * frequency * frequency);
        for (int i = 1; i <= n; i++) {
            double shape = sine_shape(n, i, parameter);
            rest += shape * weight * (i * (double)n - 0.5 * i * (i - 1.0)) / spring->stiffness;
            norm += shape * shape;
        }
        // let go from −rest: the step response is rest·(1 − q' − 2·decay·q) of the unit impulse response q
        ring(&(Mode){sine_shape, parameter, frequency, decay}, 1, time, &q, &rate);
        for (int i = 1; i <= n; i++) {
            double share = sine_shape(n, i, parameter) * rest / norm;
            ck_add_scaled(position + 3 * i, share * (1 - rate - 2 * decay * q), along);
            ck_add_scaled(velocity + 3 * i, share * frequency * frequency * q, along);
        }
    }
}

ck_Status ck_truth_hanging_chain(const ck_Model *model, double time, double *position, double *velocity,
                                 ck_Error *error) {
    double along[3], g = ck_length(model->gravity);
    bool fits = ck_shape_is_even_chain(model) && model->pin_count == 1 && model->pinned[0] && has_equal_masses(model) &&
                model->particle_count <= 61 && ck_springs_start_at_rest(model) && g > 0 &&
                velocity_along(model) < 1e-12 &&
                !(model->terms & (CK_TERM_FORCE | CK_TERM_COLLIDERS | CK_TERM_RELEASE));
    if (fits) {
        ck_subtract(along, model->position + 3, model->position);
        fits = ck_dot(along, model->gravity) > (1 - 1e-12) * ck_length(along) * g;
    }
    ck_Status status = ck_truth_need(
        fits, model, error,
        "a rope of at most 61 equal masses and springs at rest length, hanging straight from its first particle in "
        "gravity, thrown sideways, and no other force than drag");
    if (status) return status;
    const int n = model->particle_count - 1;
    ck_truth_start_from(model, position, velocity);
    for (int j = 1; j <= n; j++) {
        double zero = laguerre_zero(n, j);
        add_mode(model, &(Mode){laguerre_shape, zero, sqrt(g / model->spacing * zero), 0.5 * model->drag}, time,
                 position, velocity);
    }
    lift(model, position, velocity);
    if (!(model->terms & CK_TERM_RIGID)) add_bounce(model, time, position, velocity);
    return CK_OK;
}

// Let go unstretched, it bounces to twice the strain at rest. Swinging by an angle s = v/√(g·L), which the thinning
// tension about doubles at the free end, lifts points by (2s)²/2. Both change frequencies by half their share, and so
// the phase ω·t times the amplitude v/ω.
double ck_truth_hanging_chain_off(const ck_Model *model) {
    double speed = ck_length(model->velocity + 3), g = ck_length(model->gravity);
    double strain = isinf(model->springs[0].stiffness)
                        ? 0
                        : ck_stability_load(model) / model->springs[0].stiffness / model->spacing;
    double angle = speed / sqrt(g * model->size);
    return 2 * strain + 2 * angle * angle + (strain + angle * angle) * speed * model->duration / model->size;
}

ck_Status ck_truth_terminal_speed(const ck_Model *model, double time, double *position, double *velocity,
                                  ck_Error *error) {
    ck_Status status = ck_truth_need(ck_shape_is_falling(model) && model->drag > 0, model, error,
                                     "a body without pins, colliders and noise, with drag");
    if (status) return status;
    double fade = exp(-model->drag * time);
    ck_truth_start_from(model, position, velocity);
    for (int i = 0; i < model->particle_count; i++) {
        double terminal[3], surplus[3];
        ck_model_field(model, i, terminal);
        for (int axis = 0; axis < 3; axis++) terminal[axis] /= model->drag;
        ck_subtract(surplus, model->velocity + 3 * i, terminal);
        ck_add_scaled(position + 3 * i, time, terminal);
        ck_add_scaled(position + 3 * i, (1 - fade) / model->drag, surplus);
        ck_add_scaled(velocity + 3 * i, 1, terminal);
        ck_add_scaled(velocity + 3 * i, fade, surplus);
    }
    return CK_OK;
}

// The area of the faces, m², and by how much a particle's share of it is off its share of the mass; NaN where they do
// not all lie across the direction.
static double area_across(const ck_Model *model, const double *direction, double *off) {
    double *shares = calloc((size_t)model->particle_count, sizeof *shares), mass = 0, across = 0;
    if (!shares) return NAN;
    const double area = ck_wind_share_area(model, shares);
    for (int i = 0; i < model->wind.face_count; i++) {
        const int *corners = model->wind.faces[i];
        double normal[3];
        ck_triangle_normal(normal, model->position + 3 * corners[0], model->position + 3 * corners[1],
                           model->position + 3 * corners[2]);
        across += 0.5 * fabs(ck_dot(normal, direction));
    }
    for (int i = 0; i < model->particle_count; i++) mass += model->mass[i];
    *off = 0;
    for (int i = 0; i < model->particle_count; i++)
        *off = fmax(*off, fabs(shares[i] / area - model->mass[i] / mass) * model->particle_count);
    free(shares);
    return area - across > 1e-9 * area ? NAN : area;
}

ck_Status ck_truth_air_fall(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error) {
    double field[3], direction[3], off = INFINITY, mass = 0;
    ck_model_mean_field(model, field);
    const double g = ck_length(field);
    bool fits = g > 0 && model->wind.face_count && model->wind.drag > 0 && !ck_wind_blows(model) && !model->pin_count &&
                !(model->terms & (CK_TERM_DRAG | CK_TERM_VELOCITY | CK_TERM_FORCE)) && ck_springs_start_at_rest(model);
    for (int axis = 0; axis < 3; axis++) direction[axis] = g > 0 ? field[axis] / g : 0;
    const double area = fits ? area_across(model, direction, &off) : NAN;
    ck_Status status =
        ck_truth_need(area > 0 && off < 1e-9, model, error,
                      "a flat sheet across gravity that starts at rest in still air, without pins, noise "
                      "and other drag, whose masses are by area, as those of a material");
    if (status) return status;
    for (int i = 0; i < model->particle_count; i++) mass += model->mass[i];
    const double terminal = sqrt(2 * mass * g / (model->wind.density * model->wind.drag * area)),
                 times = g * time / terminal,
                 // log(cosh(x)), without its overflow
        fallen = terminal * terminal / g * (times + log1p(exp(-2 * times)) - log(2)), speed = terminal * tanh(times);
    ck_truth_start_from(model, position, velocity);
    for (int i = 0; i < model->particle_count; i++) {
        ck_add_scaled(position + 3 * i, fallen, direction);
        ck_add_scaled(velocity + 3 * i, speed, direction);
    }
    return CK_OK;
}
