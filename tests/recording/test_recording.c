// Recordings: every form gives the same path, what lies between is exact for parabolas, and each bad file one clear
// error.
#include "fixture.h"

#include "recording.h"

#include <unistd.h>

// A rope of three, all free, that falls from a start speed: what its particles do is made up here.
static const char scene[] = "name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 10}\n"
                            "velocity: [0.5, -1, 0.25]\ntime: {duration: 1, step: 0.1}\n";

static double at(int particle, int axis, double time) {
    static const double start[] = {0.5, -1, 0.25}, bend[] = {1, -4.905, 0.3};
    double from = axis == 1 ? -0.1 * particle : 0;
    return from + start[axis] * time + (1 + 0.1 * particle) * bend[axis] * time * time;
}

static double speed(int particle, int axis, double time) {
    static const double start[] = {0.5, -1, 0.25}, bend[] = {1, -4.905, 0.3};
    return start[axis] + 2 * (1 + 0.1 * particle) * bend[axis] * time;
}

// Times that are the scene's, or not, in no even distance, and end where it does.
static const double times[] = {0, 0.1, 0.15, 0.3, 0.42, 0.5, 0.61, 0.8, 0.9, 1.0};
#define TIMES ((int)(sizeof times / sizeof *times))

static void assert_path(const char *path, const ck_Model *model, double interval, double within, const char *wanted) {
    ck_Recording recording;
    ck_Trajectory trajectory;
    ck_Error error = {0};
    char note[200];
    if (ck_recording_read(&recording, path, model, interval, &error)) fail_msg("%s", error.message);
    if (ck_recording_path(&trajectory, &recording, model, note, sizeof note, &error)) fail_msg("%s", error.message);
    assert_int_equal(trajectory.frame_count, model->frame_count + 1);
    for (int frame = 0; frame < trajectory.frame_count; frame++)
        for (int i = 0; i < model->particle_count; i++)
            for (int axis = 0; axis < 3; axis++) {
                double time = frame * model->step;
                assert_near("position", ck_trajectory_position(&trajectory, frame)[3 * i + axis], at(i, axis, time),
                            within);
                // a difference of positions over a step
                assert_near("velocity", ck_trajectory_velocity(&trajectory, frame)[3 * i + axis], speed(i, axis, time),
                            within / model->step * 10);
            }
    assert_string_equal(note, wanted);
    ck_trajectory_free(&trajectory);
    ck_recording_free(&recording);
}

// A row a point, the last first, columns in an order of their own, one that means nothing, and CRLF.
static char *tidy(bool with_velocity, bool with_start) {
    char text[8000];
    size_t used = (size_t)sprintf(text, "z,frame,particle%s,time_s,x,y\r\n", with_velocity ? ",vx,vy,vz" : "");
    for (int k = TIMES - 1; k >= !with_start; k--)
        for (int i = 0; i < 3; i++) {
            used += (size_t)sprintf(text + used, "%.17g,x%d,%d", at(i, 2, times[k]), k, i);
            for (int axis = 0; axis < 3 && with_velocity; axis++)
                used += (size_t)sprintf(text + used, ",%.17g", speed(i, axis, times[k]));
            used += (size_t)sprintf(text + used, ",%.17g,%.17g,%.17g\r\n", times[k], at(i, 0, times[k]),
                                    at(i, 1, times[k]));
        }
    return fixture_file(text);
}

static char *wide(void) {
    char text[8000];
    size_t used = (size_t)sprintf(text, "time_s");
    for (int i = 0; i < 9; i++) used += (size_t)sprintf(text + used, ",%c%d", 'x' + i % 3, i / 3);
    for (int k = 0; k < TIMES; k++) {
        used += (size_t)sprintf(text + used, "\n%.17g", times[k]);
        for (int i = 0; i < 9; i++) used += (size_t)sprintf(text + used, ",%.17g", at(i / 3, i % 3, times[k]));
    }
    return fixture_file(text); // its last line has no end
}

// NumPy's own bytes: version 1, a header padded to 64.
static char *npy(bool is_float, double interval, int frames, const char *shape) {
    char header[64], *path = fixture_file("");
    int length = 118;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    sprintf(header, "{'descr': '%s', 'fortran_order': False, 'shape': ", is_float ? "<f4" : "<f8");
    fwrite("\x93NUMPY\x01\x00", 1, 8, file);
    fputc(length, file);
    fputc(0, file);
    int written = fprintf(file, "%s(%d%s), }", header, frames, shape);
    for (; written < length - 1; written++) fputc(' ', file);
    fputc('\n', file);
    for (int frame = 0; frame < frames; frame++)
        for (int i = 0; i < 9; i++) {
            double number = at(i / 3, i % 3, frame * interval);
            float single = (float)number;
            fwrite(is_float ? (void *)&single : (void *)&number, is_float ? 4 : 8, 1, file);
        }
    fclose(file);
    return path;
}

static void drop(char *path) {
    unlink(path);
    free(path);
}

// Parabolas are what velocities are derived by, and cubics hold them: exact to rounding.
static void test_forms(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, scene);
    const ck_Model *model = &fixture.model;
    const char *between = "velocities derived from positions; 4 frames interpolated between 10 recorded ones";
    char *path = tidy(true, true);
    assert_path(path, model, 0, 1e-13, "4 frames interpolated between 10 recorded ones");
    drop(path);
    path = tidy(false, true);
    assert_path(path, model, 0, 1e-13, between);
    drop(path);
    path = tidy(true, false);
    assert_path(path, model, 0, 1e-13, "its start is the scene's; 4 frames interpolated between 10 recorded ones");
    drop(path);
    path = wide();
    assert_path(path, model, 0, 1e-13, between);
    drop(path);
    path = npy(false, 0.1, 11, ", 3, 3");
    assert_path(path, model, 0, 1e-13, "velocities derived from positions");
    drop(path);
    // half as many, and twice as many
    path = npy(false, 0.2, 6, ", 3, 3");
    assert_path(path, model, 0.2, 1e-13,
                "velocities derived from positions; 5 frames interpolated between 6 recorded ones");
    drop(path);
    path = npy(false, 0.05, 21, ", 3, 3");
    assert_path(path, model, 0.05, 1e-13, "velocities derived from positions");
    drop(path);
    // float32 of positions up to 6: half a unit in the last place
    path = npy(true, 0.1, 11, ", 3, 3");
    assert_path(path, model, 0, 3e-7, "velocities derived from positions");
    drop(path);
    fixture_free(&fixture);
}

// A run that left the finite numbers is one: its path ends there.
static void test_diverged(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, scene);
    ck_Recording recording;
    ck_Trajectory trajectory;
    ck_Error error = {0};
    char note[200];
    char *path = fixture_file("time_s,particle,x,y,z\n0,0,0,0,0\n0,1,0,0,0\n0,2,0,0,0\n0.1,0,0,0,0\n0.1,1,0,0,0\n"
                              "0.1,2,0,0,0\n0.2,0,0,0,0\n0.2,1,nan,0,0\n0.2,2,0,0,0\n");
    assert_int_equal(ck_recording_read(&recording, path, &fixture.model, 0, &error), CK_OK);
    assert_int_equal(ck_recording_path(&trajectory, &recording, &fixture.model, note, sizeof note, &error), CK_OK);
    // the state before cannot have its parabola
    assert_true(trajectory.frame_count >= 1 && trajectory.frame_count <= 2);
    ck_trajectory_free(&trajectory);
    ck_recording_free(&recording);
    drop(path);
    fixture_free(&fixture);
}

#define HEADER "time_s,particle,x,y,z\n"
#define FIRST HEADER "0,0,0,0,0\n0,1,0,0,0\n0,2,0,0,0\n"

static const struct {
    const char *text, *message;
} bad_files[] = {
    {"", "holds no positions"},
    {HEADER, "holds no positions"},
    {"time,particle,x,y,z\n0,0,0,0,0\n", ":1: the header has no column time_s; it must have time_s, particle, x, y"},
    {"time_s,particle,x,y\n0,0,0,0\n", ":1: the header has no column z"},
    {"time_s,x0,y0,z0,\r\rvzy\rv,2,2\n", ":1: there is a carriage return within the line"},
    {"time_s,particle,x,y,z,x\n0,0,0,0,0,0\n", ":1: the header has twice the column x"},
    {"time_s,particle,x,y,z,vx\n0,0,0,0,0,0\n", ":1: the header has no column vy"},
    {"time_s,x0,y0,z0,x2,y2,z2\n", ":1: the header has no column x1"},
    {"time_s,x0,y0,z0,x7,y7,z7\n", ":1: there is a particle 7; the scene has 0 to 2"},
    {"time_s,x0,y0,z0\n0,1,2,3\n1,1,2,3\n", "at time_s 0 2 of 3 particles are missing, particle 1 among them"},
    {HEADER "0,0,wide,0,0\n", ":2: column 3 (x): must be a number, not 'wide'"},
    {HEADER "0,0,1,0\n", ":2: 4 columns where the header has 5"},
    {HEADER "0,0,1,0,2,3\n", ":2: 6 columns where the header has 5"},
    {HEADER "0,3,1,0,2\n", ":2: particle is 3; the scene has 0 to 2"},
    {HEADER "0,0.5,1,0,2\n", ":2: particle is 0.5"},
    {HEADER "-1,0,1,0,2\n", ":2: time_s is -1; the scene goes from 0 to 1 s"},
    {HEADER "1.2,0,1,0,2\n", ":2: time_s is 1.2"},
    {HEADER "nan,0,1,0,2\n", ":2: column 1 (time_s): must be a number"},
    {HEADER "0,0,\"1,0,2\n", ":2: a quoted field has no end"},
    {FIRST "0.5,0,0,0,0\n0.5,1,0,0,0\n0.5,2,0,0,0\n", "ends at time_s 0.5; the scene goes to 1 s"},
    {FIRST "1,0,0,0,0\n1,2,0,0,0\n", "at time_s 1 1 of 3 particles are missing, particle 1 among them"},
    {FIRST "1,0,0,0,0\n1,1,0,0,0\n1,1,0,0,0\n1,2,0,0,0\n", ":7: particle 1 stands twice at time_s 1"},
    {"\x93NUMPY", "the header has no column x"},
    {"\x93NUMPY\x01", "must be an array of float32 or float64 in C order, of shape (frames, 3, 3)"},
};

static void assert_bad(const char *path, const ck_Model *model, const char *message) {
    ck_Recording recording;
    ck_Trajectory trajectory = {0};
    ck_Error error = {0};
    char note[200];
    ck_Status status = ck_recording_read(&recording, path, model, 0, &error);
    if (!status) status = ck_recording_path(&trajectory, &recording, model, note, sizeof note, &error);
    if (status != CK_BAD_INPUT || !strstr(error.message, message))
        fail_msg("wanted '%s': %d, %s", message, status, error.message);
    ck_trajectory_free(&trajectory);
    ck_recording_free(&recording);
}

static void test_bad(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, scene);
    for (size_t i = 0; i < sizeof bad_files / sizeof *bad_files; i++) {
        char *path = fixture_file(bad_files[i].text);
        assert_bad(path, &fixture.model, bad_files[i].message);
        drop(path);
    }
    char *path = npy(false, 0.1, 11, ", 4, 3");
    assert_bad(path, &fixture.model, "of shape (frames, 3, 3), not (11, 4, 3)");
    drop(path);
    path = npy(false, 0.1, 11, ", 3, 3");
    assert_int_equal(truncate(path, 300), 0);
    assert_bad(path, &fixture.model, "holds 172 bytes of numbers where its shape needs 792");
    drop(path);
    path = npy(false, 0.1, 30, ", 3, 3");
    assert_bad(path, &fixture.model,
               "30 frames, 0.1 s apart, go beyond the scene's 1 s; --interval says how far apart");
    drop(path);
    ck_Recording recording;
    ck_Error error = {0};
    assert_int_equal(ck_recording_read(&recording, "/none/there.csv", &fixture.model, 0, &error), CK_IO);
    ck_recording_free(&recording);
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_diverged),
        cmocka_unit_test(test_bad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
