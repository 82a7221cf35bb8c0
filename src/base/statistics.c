#include "statistics.h"

#include <math.h>
#include <stdlib.h>

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double ck_quantile(double *values, int count, double share) {
    if (count < 1) return NAN;
    qsort(values, (size_t)count, sizeof *values, compare_numbers);
    double at = share * (count - 1);
    int below = (int)at, above = below + 1 < count ? below + 1 : below;
    return values[below] + (at - below) * (values[above] - values[below]);
}

double ck_median(double *values, int count) {
    return ck_quantile(values, count, 0.5);
}

// The chance that a fair coin, thrown count times, shows heads at most so often.
static double chance_of_at_most(int heads, int count) {
    double term = pow(0.5, count), sum = 0;
    for (int i = 0; i <= heads; i++) {
        sum += term;
        term *= (double)(count - i) / (i + 1);
    }
    return sum;
}

void ck_median_interval(double *values, int count, double *low, double *high) {
    *low = *high = NAN;
    if (count < 2) return;
    qsort(values, (size_t)count, sizeof *values, compare_numbers);
    int outside = 0; // order statistics left out at either end
    while (2 * outside + 2 < count && 2 * chance_of_at_most(outside + 1, count) <= 0.05) outside++;
    if (2 * chance_of_at_most(outside, count) > 0.05) outside = 0;
    *low = values[outside];
    *high = values[count - 1 - outside];
}

double ck_slope(const double *x, const double *y, int count) {
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        mean_x += x[i] / count;
        mean_y += y[i] / count;
    }
    for (int i = 0; i < count; i++) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    return xx > 0 ? xy / xx : NAN;
}
