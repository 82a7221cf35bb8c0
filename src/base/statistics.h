// Order statistics and straight lines, by one rule each.
#ifndef CK_STATISTICS_H
#define CK_STATISTICS_H

// The share-quantile of so many values, by linear interpolation between order statistics; sorts them. NaN without any.
// Source: Hyndman and Fan 1996, type 7, which is R's default.
double ck_quantile(double *values, int count, double share);

// ck_quantile at one half.
double ck_median(double *values, int count);

// The slope of the line of least squares through points; NaN with fewer than two different x.
double ck_slope(const double *x, const double *y, int count);

// Two of the values between which the median of what they are drawn from lies with 95 %, whatever its distribution: the
// least and the most where there are fewer than six. Sorts them; NaN where there are none.
void ck_median_interval(double *values, int count, double *low, double *high);

#endif
