/* Evaluation of lookup tables of contact figures over normal force and track curvature. C99, no
   allocation, no state. The arithmetic is that of the Rust library kufe-lut, operation by operation. */
#ifndef KUFE_LUT_H
#define KUFE_LUT_H

#include <math.h>

#if defined(__GNUC__)
#define KUFE_LUT_UNUSED __attribute__((unused))
#else
#define KUFE_LUT_UNUSED
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

/* One quantity. Rows of constant force: node (i, j) is number i * n_curvature + j. */
typedef struct {
  int n_fz;                /* breakpoints of the force, at least 1 */
  int n_curvature;         /* breakpoints of the curvature, at least 1 */
  const double *fz;        /* forces [N], increasing */
  const double *log_fz;    /* their natural logarithms */
  const double *curvature; /* curvatures [1/m] or reduced curvatures, increasing */
  const double *flush;     /* 0, or what defines reduced curvatures: flush curvature [1/m], scale [1/(m N)], and
                              the curvatures [1/m] of 0 and of 1 */
  const double *values;    /* plain values */
  const double *jets;      /* value, slopes and twist of the smooth mode, four a node */
  int logarithmic;         /* whether the jets are of the values' logarithms */
} kufe_lut_table;

/* A looked-up value; out_of_range is 1 where an input was clipped or NaN. */
typedef struct {
  double value;
  int out_of_range;
} kufe_lut_looked;

typedef struct {
  int low, high;
  double clipped;
  int outside;
} kufe_lut_place_;

static KUFE_LUT_UNUSED kufe_lut_place_ kufe_lut_find_(const double *axis, int n, double value) {
  kufe_lut_place_ place;
  int last = n - 1;
  if (value >= axis[last]) {
    place.low = place.high = last;
    place.clipped = axis[last];
    place.outside = value > axis[last];
  } else if (value <= axis[0]) {
    place.low = 0;
    place.high = last < 1 ? last : 1;
    place.clipped = axis[0];
    place.outside = value < axis[0];
  } else {
    int low = 0, high = last;
    while (high - low > 1) {
      int middle = low + (high - low) / 2;
      if (value < axis[middle]) high = middle;
      else low = middle;
    }
    place.low = low;
    place.high = high;
    place.clipped = value;
    place.outside = 0;
  }
  return place;
}

static KUFE_LUT_UNUSED double kufe_lut_part_(const double *axis, int low, int high, double value) {
  return low == high ? 0.0 : (value - axis[low]) / (axis[high] - axis[low]);
}

static KUFE_LUT_UNUSED kufe_lut_looked kufe_lut_nan_(void) {
  kufe_lut_looked looked;
  looked.value = (double)NAN;
  looked.out_of_range = 1;
  return looked;
}

/* exp(asinh(|x|)). */
static KUFE_LUT_UNUSED double kufe_lut_far_(double x) { return fabs(x) + sqrt(1.0 + x * x); }

/* The place on the second axis of a force and a curvature: the curvature itself, or the reduced curvature
   (s(curvature) - s(from)) / (s(to) - s(from)) with s(k) = asinh((k - flush) / (scale * fz)); from < flush < to. */
static KUFE_LUT_UNUSED double kufe_lut_place_on_(const double *flush, double fz, double curvature) {
  double width, x, below, whole, part;
  if (!flush) return curvature;
  width = flush[1] * fz;
  below = kufe_lut_far_((flush[2] - flush[0]) / width);
  whole = log(kufe_lut_far_((flush[3] - flush[0]) / width) * below);
  x = (curvature - flush[0]) / width;
  part = x < 0.0 ? log(below / kufe_lut_far_(x)) : log(kufe_lut_far_(x) * below);
  return part / whole;
}

/* Piecewise bilinear with clipping, as Simulink's n-D Lookup Table (linear point-slope, clip, use last value). */
static KUFE_LUT_UNUSED kufe_lut_looked kufe_lut_bilinear(const kufe_lut_table *t, double fz,
                                                         double curvature) {
  kufe_lut_looked looked;
  kufe_lut_place_ x, y;
  double tx, ty, v00, v10, v01, v11, left, right;
  int n = t->n_curvature;
  if (isnan(fz) || isnan(curvature)) return kufe_lut_nan_();
  x = kufe_lut_find_(t->fz, t->n_fz, fz);
  y = kufe_lut_find_(t->curvature, n, kufe_lut_place_on_(t->flush, x.clipped, curvature));
  tx = kufe_lut_part_(t->fz, x.low, x.high, x.clipped);
  ty = kufe_lut_part_(t->curvature, y.low, y.high, y.clipped);
  v00 = t->values[x.low * n + y.low];
  v10 = t->values[x.high * n + y.low];
  v01 = t->values[x.low * n + y.high];
  v11 = t->values[x.high * n + y.high];
  left = v00 + (v10 - v00) * tx;
  right = v01 + (v11 - v01) * tx;
  looked.value = left + (right - left) * ty;
  looked.out_of_range = x.outside || y.outside;
  return looked;
}

/* C1, and monotone where the table is: bicubic Hermite patches over log force and curvature. */
static KUFE_LUT_UNUSED kufe_lut_looked kufe_lut_smooth(const kufe_lut_table *t, double fz,
                                                       double curvature) {
  kufe_lut_looked looked;
  kufe_lut_place_ x, y;
  const double *a, *b, *c, *d;
  double hx, hy, tx, ty, sx, sy, x0, x1, x2, y0, y1, y2;
  double low, high, low_slope, high_slope, rise, start;
  int n = t->n_curvature;
  if (isnan(fz) || isnan(curvature)) return kufe_lut_nan_();
  x = kufe_lut_find_(t->fz, t->n_fz, fz);
  y = kufe_lut_find_(t->curvature, n, kufe_lut_place_on_(t->flush, x.clipped, curvature));
  hx = t->log_fz[x.high] - t->log_fz[x.low];
  hy = t->curvature[y.high] - t->curvature[y.low];
  tx = kufe_lut_part_(t->log_fz, x.low, x.high, log(x.clipped));
  ty = kufe_lut_part_(t->curvature, y.low, y.high, y.clipped);
  a = t->jets + 4 * (x.low * n + y.low);
  b = t->jets + 4 * (x.high * n + y.low);
  c = t->jets + 4 * (x.low * n + y.high);
  d = t->jets + 4 * (x.high * n + y.high);
  sx = 1.0 - tx;
  x0 = tx * tx * (3.0 - 2.0 * tx);
  x1 = hx * tx * sx * sx;
  x2 = -(hx * tx * tx * sx);
  sy = 1.0 - ty;
  y0 = ty * ty * (3.0 - 2.0 * ty);
  y1 = hy * ty * sy * sy;
  y2 = -(hy * ty * ty * sy);
  low = (b[0] - a[0]) * x0 + a[1] * x1 + b[1] * x2;
  high = (c[0] - a[0]) + ((d[0] - c[0]) * x0 + c[1] * x1 + d[1] * x2);
  low_slope = a[2] + ((b[2] - a[2]) * x0 + a[3] * x1 + b[3] * x2);
  high_slope = c[2] + ((d[2] - c[2]) * x0 + c[3] * x1 + d[3] * x2);
  rise = low + ((high - low) * y0 + low_slope * y1 + high_slope * y2);
  start = t->values[x.low * n + y.low];
  looked.value = t->logarithmic ? start * exp(rise) : start + rise;
  looked.out_of_range = x.outside || y.outside;
  return looked;
}

/* Track curvature [1/m], positive in a valley, from speed [m/s] and pitch rate [rad/s], positive nose
   down: the inverse of r = -v / pitch_rate, 0 at a standstill. */
static KUFE_LUT_UNUSED double kufe_lut_curvature_from_pitch(double speed, double pitch_rate) {
  const double min_speed = 1.0;
  if (fabs(speed) >= min_speed) return 0.0 - pitch_rate / speed;
  return 0.0 - pitch_rate * speed / (min_speed * min_speed);
}

#endif
