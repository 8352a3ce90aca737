/* SPDX-License-Identifier: MIT */
#include "cli/study_figures.h"

#include <math.h>
#include <stdlib.h>

static int by_float(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static int by_double(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void study_error_measure(const float *picture, const float *reference1, const float *reference2,
                         size_t pixels, float *scratch, study_error *out_error)
{
    size_t count = 3 * pixels;
    double square = 0.0, relative = 0.0, bias = 0.0;
    for (size_t i = 0; i < count; i++) {
        double x = (double)picture[i], r1 = (double)reference1[i], r2 = (double)reference2[i];
        double r = (r1 + r2) / 2.0, product = (x - r1) * (x - r2);
        square += product;
        relative += product / (r * r + 0.01);
        bias += x - r;
        scratch[i] = (float)fabs(x - r);
    }
    qsort(scratch, count, sizeof *scratch, by_float);
    double n = (double)count;
    size_t rank = (size_t)ceil(0.999 * n);
    *out_error = (study_error){.mse = square / n,
                               .relative_mse = relative / n,
                               .bias = bias / n,
                               .largest = (double)scratch[count - 1],
                               .p999 = (double)scratch[rank - 1]};
}

double study_reference_mse(const float *reference1, const float *reference2, size_t pixels)
{
    double sum = 0.0;
    for (size_t i = 0; i < 3 * pixels; i++) {
        double d = (double)reference1[i] - (double)reference2[i];
        sum += d * d;
    }
    return sum / (4.0 * 3.0 * (double)pixels);
}

/* Where the centre of `to` lies among `count` centres: the one below and the share of the next. */
static uint32_t centre_below(double to, uint32_t count, double *out_share)
{
    double at = fl_clamp(to - 0.5, 0.0, (double)(count - 1));
    uint32_t below = (uint32_t)at;
    *out_share = at - below;
    return below;
}

void study_resize(const float *from, uint32_t from_width, uint32_t from_height, float *out,
                  uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; y++) {
        double sy, sx;
        uint32_t y0 = centre_below((y + 0.5) * from_height / height, from_height, &sy);
        uint32_t y1 = fl_min_u32(y0 + 1, from_height - 1);
        for (uint32_t x = 0; x < width; x++) {
            uint32_t x0 = centre_below((x + 0.5) * from_width / width, from_width, &sx);
            uint32_t x1 = fl_min_u32(x0 + 1, from_width - 1);
            for (uint32_t c = 0; c < 3; c++) {
                double a = (double)from[3 * ((size_t)y0 * from_width + x0) + c];
                double b = (double)from[3 * ((size_t)y0 * from_width + x1) + c];
                double d = (double)from[3 * ((size_t)y1 * from_width + x0) + c];
                double e = (double)from[3 * ((size_t)y1 * from_width + x1) + c];
                double upper = a + (b - a) * sx, lower = d + (e - d) * sx;
                out[3 * ((size_t)y * width + x) + c] = (float)(upper + (lower - upper) * sy);
            }
        }
    }
}

/* Between ranks, of sorted values. */
static double quantile(const double *sorted, uint32_t count, double share)
{
    double at = share * (count - 1);
    uint32_t below = (uint32_t)at, above = fl_min_u32(below + 1, count - 1);
    return sorted[below] + (sorted[above] - sorted[below]) * (at - below);
}

study_spread study_spread_of(double *values, uint32_t count)
{
    study_spread s = {.count = count};
    if (!count)
        return s;
    qsort(values, count, sizeof *values, by_double);
    for (uint32_t i = 0; i < count; i++)
        s.mean += values[i] / count;
    double squares = 0.0;
    for (uint32_t i = 0; i < count; i++)
        squares += (values[i] - s.mean) * (values[i] - s.mean);
    if (count > 1)
        s.standard_error = sqrt(squares / (count - 1) / count);
    s.lowest = values[0];
    s.median = quantile(values, count, 0.5);
    s.quartile1 = quantile(values, count, 0.25);
    s.quartile3 = quantile(values, count, 0.75);
    return s;
}

study_root study_root_of(const study_spread *mean_square)
{
    double value = sqrt(fl_max(mean_square->mean, 0.0));
    return (study_root){value, value > 0.0 ? mean_square->standard_error / (2.0 * value) : 0.0};
}

double study_t_quantile(uint32_t degrees_of_freedom)
{
    static const double exact[] = {0.0,    12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469,
                                   2.3646, 2.3060,  2.2622, 2.2281, 2.2010, 2.1788, 2.1604,
                                   2.1448, 2.1314,  2.1199, 2.1098, 2.1009, 2.0930, 2.0860};
    if (degrees_of_freedom < FL_COUNT_OF(exact))
        return exact[degrees_of_freedom];
    return 1.959964 + 2.3724 / degrees_of_freedom + 2.82 / pow(degrees_of_freedom, 2.0);
}

study_ratio study_ratio_of(const double *values, const double *base, uint32_t count)
{
    study_ratio r = {0};
    double sum = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        if (!(values[i] > 0.0 && base[i] > 0.0))
            return r;
        sum += log(values[i] / base[i]);
    }
    if (!count)
        return r;
    double mean = sum / count;
    for (uint32_t i = 0; i < count; i++) {
        double d = log(values[i] / base[i]) - mean;
        squares += d * d;
    }
    r.is_known = true;
    r.value = r.low = r.high = exp(mean);
    if (count > 1) {
        double half = study_t_quantile(count - 1) * sqrt(squares / (count - 1) / count);
        r.has_interval = true;
        r.low = exp(mean - half);
        r.high = exp(mean + half);
        r.is_significant = r.low > 1.0 || r.high < 1.0;
    }
    return r;
}

/* For a given rate the model is linear in floor^2 and scale^2: weighted least squares with both at
 * least 0. Returns the sum of squared relative deviations. */
static double fit_at_rate(const double *samples, const double *mse, uint32_t count, bool with_floor,
                          study_fit *fit)
{
    double s11 = 0.0, s1x = 0.0, sxx = 0.0, s1 = 0.0, sx = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        double x = pow(samples[i], -2.0 * fit->rate) / mse[i], one = 1.0 / mse[i];
        s11 += one * one;
        s1x += one * x;
        sxx += x * x;
        s1 += one;
        sx += x;
    }
    double determinant = s11 * sxx - s1x * s1x, floor2 = 0.0, scale2;
    if (with_floor && determinant > 1e-12 * s11 * sxx)
        floor2 = fl_max(0.0, (s1 * sxx - sx * s1x) / determinant);
    scale2 = fl_max(0.0, (sx - floor2 * s1x) / sxx);
    if (with_floor && scale2 == 0.0)
        floor2 = s1 / s11;
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        double d = (floor2 + scale2 * pow(samples[i], -2.0 * fit->rate)) / mse[i] - 1.0;
        sum += d * d;
    }
    fit->floor = sqrt(floor2);
    fit->scale = sqrt(scale2);
    return sum;
}

static bool is_fittable(const double *mse, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!(mse[i] > 0.0))
            return false;
    return count >= 4;
}

study_fit study_fit_rate(const double *samples, const double *mse, uint32_t count)
{
    study_fit best = {0};
    double least = (double)INFINITY;
    for (int step = 60; is_fittable(mse, count) && step <= 200; step++) {
        study_fit fit = {.is_known = true, .rate = 0.005 * step};
        double sum = fit_at_rate(samples, mse, count, false, &fit);
        if (sum < least) {
            least = sum;
            best = fit;
        }
    }
    return best;
}

study_fit study_fit_floor(const double *samples, const double *mse, uint32_t count, double rate)
{
    study_fit fit = {.is_known = is_fittable(mse, count), .rate = rate};
    if (fit.is_known)
        fit_at_rate(samples, mse, count, true, &fit);
    return fit;
}

double study_product_mse(const float *picture, const float *reference1, const float *reference2,
                         size_t pixels)
{
    double sum = 0.0;
    for (size_t i = 0; i < 3 * pixels; i++)
        sum += ((double)picture[i] - (double)reference1[i]) *
               ((double)picture[i] - (double)reference2[i]);
    return sum / (3.0 * (double)pixels);
}

double study_floor_mse(const float *sum, uint32_t count, double mse_sum, const float *reference1,
                       const float *reference2, size_t pixels)
{
    double total = 0.0;
    for (size_t i = 0; i < 3 * pixels; i++)
        total += ((double)sum[i] - count * (double)reference1[i]) *
                 ((double)sum[i] - count * (double)reference2[i]);
    return (total / (3.0 * (double)pixels) - mse_sum) / ((double)count * (count - 1));
}

double study_slope_of(const double *samples, const double *rmse, uint32_t count)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        double x = log2(samples[i]), y = log2(rmse[i]);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return count < 2 ? (double)NAN : (count * sxy - sx * sy) / (count * sxx - sx * sx);
}
