#include "outlier.h"

#include "statistics.h"

#include <math.h>

ck_Outlier ck_outlier_find(const ck_Comparison *comparison, const ck_Metric *metric) {
    ck_Outlier outlier = {.run = -1};
    int runs[CK_SCENE_MAX_ENGINES], count = 0;
    double apart[CK_SCENE_MAX_ENGINES][CK_SCENE_MAX_ENGINES], others[CK_SCENE_MAX_ENGINES],
        among[CK_SCENE_MAX_ENGINES * CK_SCENE_MAX_ENGINES];
    for (int i = 0; i < comparison->run_count; i++) {
        const ck_Run *run = &comparison->runs[i];
        if (run->engine->method == CK_METHOD_NONE || !ck_comparison_has_path(comparison, i)) continue;
        if (isnan(ck_metric_deviation(metric, &comparison->model, &run->trajectory, &run->trajectory,
                                      &comparison->truth.reference)))
            continue;
        runs[count++] = i;
    }
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            apart[i][j] =
                fabs(ck_metric_deviation(metric, &comparison->model, &comparison->runs[runs[i]].trajectory,
                                         &comparison->runs[runs[j]].trajectory, &comparison->truth.reference));
    if (count < 3) return outlier;
    int farthest = 0;
    for (int i = 0; i < count; i++) {
        int used = 0;
        for (int j = 0; j < count; j++)
            if (j != i) others[used++] = apart[i][j];
        double distance = ck_median(others, used);
        if (distance > outlier.distance || i == 0) {
            outlier.distance = distance;
            farthest = i;
        }
    }
    int used = 0;
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++)
            if (i != farthest && j != farthest) among[used++] = apart[i][j];
    outlier.run = runs[farthest];
    outlier.rest = ck_median(among, used);
    return outlier;
}
