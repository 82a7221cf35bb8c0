// Whether jobs are shared by threads, on times that are told: what the choice costs, whatever the times are.
#include "fixture.h"

#include "choice.h"

#include <math.h>

// s of a job: by its number, its work and whether it is shared.
typedef double (*Cost)(int job, double amount, bool is_shared);

typedef struct Total {
    double chosen, shared, alone; // s of all jobs, as they were run, and each way
    double work_shared;           // the share of the work that was shared
} Total;

static double amount_even(int job) {
    (void)job;
    return 16;
}

// Steps that adapt are many at once, and then one.
static double amount_uneven(int job) {
    return job % 2 ? 1 : 16;
}

static Total run(Cost cost, double (*amount_of)(int job), int jobs) {
    ck_Choice choice = {0};
    Total total = {0};
    double work = 0;
    for (int job = 0; job < jobs; job++) {
        const double amount = amount_of(job), shared = cost(job, amount, true), alone = cost(job, amount, false);
        total.shared += shared;
        total.alone += alone;
        total.chosen += choice.is_alone ? alone : shared;
        total.work_shared += choice.is_alone ? 0 : amount;
        work += amount;
        ck_choice_count(&choice, choice.is_alone ? alone : shared, amount);
    }
    total.work_shared /= work;
    return total;
}

// 10 µs a unit of work; half of that, and twice as much, with two threads.
static double gains(int job, double amount, bool is_shared) {
    (void)job;
    return amount * (is_shared ? 5e-6 : 1e-5);
}

static double loses(int job, double amount, bool is_shared) {
    (void)job;
    return amount * (is_shared ? 2e-5 : 1e-5);
}

// To begin costs as much as six units of work alone, so that large jobs gain and small ones lose.
static double gains_at_length(int job, double amount, bool is_shared) {
    (void)job;
    return is_shared ? 6e-5 + amount * 5e-6 : amount * 1e-5;
}

// Every hundredth job loses its processor for 4 ms, either way.
static double hiccups(int job, double amount, bool is_shared) {
    return gains(job, amount, is_shared) + (job % 100 == 37 ? 4e-3 : 0);
}

// Others take a processor for a while, in which threads wait for 4 ms a job.
static double is_busy(int job, double amount, bool is_shared) {
    return gains(job, amount, is_shared) + (is_shared && job > 5000 && job < 15000 ? 4e-3 : 0);
}

static double is_equal(int job, double amount, bool is_shared) {
    (void)is_shared;
    return amount * 1e-5 * (1 + 0.02 * sin(1.7 * job));
}

// Trials cost a fiftieth; beside that there are the first ones.
static void assert_near_best(const char *what, const Total *total, double best) {
    if (!(total->chosen < 1.03 * best + 0.02)) fail_msg("%s: %g s, where %g would do", what, total->chosen, best);
}

static void test_choice(void **state) {
    (void)state;
    const struct {
        const char *name;
        Cost cost;
        double (*amount_of)(int job);
    } cases[] = {{"gains", gains, amount_even},
                 {"loses", loses, amount_even},
                 {"gains, uneven", gains, amount_uneven},
                 {"loses, uneven", loses, amount_uneven},
                 {"gains at length, uneven", gains_at_length, amount_uneven},
                 {"hiccups", hiccups, amount_even},
                 {"equal", is_equal, amount_even}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const Total total = run(cases[i].cost, cases[i].amount_of, 20000);
        assert_near_best(cases[i].name, &total, fmin(total.shared, total.alone));
    }
}

// The best is to share but while it is busy: to leave takes some jobs, and to come back fifty times the last trial's
// four jobs of 4 ms.
static void test_busy(void **state) {
    (void)state;
    double best = 0;
    const Total total = run(is_busy, amount_even, 20000);
    for (int job = 0; job < 20000; job++) best += fmin(is_busy(job, 16, true), is_busy(job, 16, false));
    if (!(total.chosen < 1.03 * best + 0.05 + 0.8)) fail_msg("busy: %g s, where %g would do", total.chosen, best);
    assert_true(total.work_shared > 0.3 && total.work_shared < 0.55);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_choice), cmocka_unit_test(test_busy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
