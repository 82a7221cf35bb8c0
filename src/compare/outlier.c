#include "comparison.h"

#include "statistics.h"

#include <math.h>
#include <string.h>

#define APART 3
#define LEAST 1e-3

// The runs that count, and the metric of each.
typedef struct Field {
    const ck_Comparison *comparison;
    const ck_Metric *metric;
    int runs[CK_COMPARISON_MAX_ENGINES];
    double values[CK_COMPARISON_MAX_ENGINES];
    int count;
} Field;

static Field gather(const ck_Comparison *comparison, const ck_Metric *metric) {
    Field field = {.comparison = comparison, .metric = metric};
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->engine->method == CK_METHOD_STILL || run->status != CK_RUN_OK ||
            !ck_run_has_all_frames(&comparison->runs[i]))
            continue;
        double value = ck_metric_value(metric, &comparison->model, &run->trajectory, &comparison->truth.reference);
        double own = ck_metric_deviation(metric, &comparison->model, &run->trajectory, &run->trajectory,
                                         &comparison->truth.reference);
        if (isnan(own)) continue;
        field.values[field.count] = value;
        field.runs[field.count++] = i;
    }
    return field;
}

static double apart(const Field *field, int one, int other) {
    const ck_Comparison *comparison = field->comparison;
    return fabs(ck_metric_deviation(field->metric, &comparison->model, &comparison->runs[field->runs[one]].trajectory,
                                    &comparison->runs[field->runs[other]].trajectory, &comparison->truth.reference));
}

// The run of the largest of some distances, beside the median of the rest.
static ck_Outlier farthest(const Field *field, const double *distances) {
    int far = 0, used = 0;
    double others[CK_COMPARISON_MAX_ENGINES];
    for (int i = 1; i < field->count; i++)
        if (distances[i] > distances[far]) far = i;
    for (int i = 0; i < field->count; i++)
        if (i != far) others[used++] = distances[i];
    return (ck_Outlier){.run = far, .distance = distances[far], .rest = ck_median(others, used)};
}

static ck_Outlier by_truth(const Field *field, double truth) {
    double errors[CK_COMPARISON_MAX_ENGINES];
    for (int i = 0; i < field->count; i++) errors[i] = fabs(field->values[i] - truth);
    ck_Outlier outlier = farthest(field, errors);
    outlier.has_truth = true;
    return outlier;
}

static ck_Outlier by_others(const Field *field) {
    double distances[CK_COMPARISON_MAX_ENGINES], others[CK_COMPARISON_MAX_ENGINES],
        among[CK_COMPARISON_MAX_ENGINES * CK_COMPARISON_MAX_ENGINES];
    for (int i = 0; i < field->count; i++) {
        int used = 0;
        for (int j = 0; j < field->count; j++)
            if (j != i) others[used++] = apart(field, i, j);
        distances[i] = ck_median(others, used);
    }
    ck_Outlier outlier = farthest(field, distances);
    int used = 0;
    for (int i = 0; i < field->count; i++)
        for (int j = i + 1; j < field->count; j++)
            if (i != outlier.run && j != outlier.run) among[used++] = apart(field, i, j);
    outlier.rest = ck_median(among, used);
    return outlier;
}

ck_Outlier ck_outlier_find(const ck_Comparison *comparison, const ck_Metric *metric) {
    Field field = gather(comparison, metric);
    ck_Outlier none = {.run = -1};
    if (field.count < 3) return none;
    double truth = ck_metric_truth(metric, &comparison->model, &comparison->truth.reference);
    double uncertainty = ck_truth_uncertainty(&comparison->truth, &comparison->model, metric);
    ck_Outlier outlier = isnan(truth) ? by_others(&field) : by_truth(&field, truth);
    double scale = strcmp(metric->unit, "1") ? fabs(isnan(truth) ? field.values[0] : truth) : 1;
    bool stands_apart = outlier.distance > APART * outlier.rest && outlier.distance > LEAST * scale &&
                        !(outlier.distance <= uncertainty);
    if (!stands_apart) return none;
    outlier.run = field.runs[outlier.run];
    return outlier;
}
