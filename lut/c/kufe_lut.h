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

/* An interpolated value; out_of_range is 1 where an input was clipped or NaN. */
typedef struct {
  double value;
  int out_of_range;
} kufe_lut_interpolated;

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

static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_nan_(void) {
  kufe_lut_interpolated found;
  found.value = (double)NAN;
  found.out_of_range = 1;
  return found;
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

/* Where a force and a curvature, no NaN, lie. */
static KUFE_LUT_UNUSED void kufe_lut_places_(const kufe_lut_table *t, double fz, double curvature,
                                             kufe_lut_place_ *x, kufe_lut_place_ *y) {
  *x = kufe_lut_find_(t->fz, t->n_fz, fz);
  *y = kufe_lut_find_(t->curvature, t->n_curvature, kufe_lut_place_on_(t->flush, x->clipped, curvature));
}

/* Bilinear between the values of a cell. */
static KUFE_LUT_UNUSED double kufe_lut_plane_(const kufe_lut_table *t, const double *values,
                                              const kufe_lut_place_ *x, const kufe_lut_place_ *y) {
  int n = t->n_curvature;
  double tx = kufe_lut_part_(t->fz, x->low, x->high, x->clipped);
  double ty = kufe_lut_part_(t->curvature, y->low, y->high, y->clipped);
  double v00 = values[x->low * n + y->low], v10 = values[x->high * n + y->low];
  double v01 = values[x->low * n + y->high], v11 = values[x->high * n + y->high];
  double left = v00 + (v10 - v00) * tx, right = v01 + (v11 - v01) * tx;
  return left + (right - left) * ty;
}

/* Weights of the far value and of both slopes in a cubic Hermite piece. */
static KUFE_LUT_UNUSED void kufe_lut_hermite_(double t, double h, double *w0, double *w1, double *w2) {
  double s = 1.0 - t;
  *w0 = t * t * (3.0 - 2.0 * t);
  *w1 = h * t * s * s;
  *w2 = -(h * t * t * s);
}

/* Bicubic Hermite patch over log force and curvature, less its value at the lower corner. */
static KUFE_LUT_UNUSED double kufe_lut_rise_(const kufe_lut_table *t, const double *jets,
                                             const kufe_lut_place_ *x, const kufe_lut_place_ *y) {
  const double *a, *b, *c, *d;
  double x0, x1, x2, y0, y1, y2, low, high, low_slope, high_slope;
  int n = t->n_curvature;
  double hx = t->log_fz[x->high] - t->log_fz[x->low];
  double hy = t->curvature[y->high] - t->curvature[y->low];
  double tx = kufe_lut_part_(t->log_fz, x->low, x->high, log(x->clipped));
  double ty = kufe_lut_part_(t->curvature, y->low, y->high, y->clipped);
  a = jets + 4 * (x->low * n + y->low);
  b = jets + 4 * (x->high * n + y->low);
  c = jets + 4 * (x->low * n + y->high);
  d = jets + 4 * (x->high * n + y->high);
  kufe_lut_hermite_(tx, hx, &x0, &x1, &x2);
  kufe_lut_hermite_(ty, hy, &y0, &y1, &y2);
  low = (b[0] - a[0]) * x0 + a[1] * x1 + b[1] * x2;
  high = (c[0] - a[0]) + ((d[0] - c[0]) * x0 + c[1] * x1 + d[1] * x2);
  low_slope = a[2] + ((b[2] - a[2]) * x0 + a[3] * x1 + b[3] * x2);
  high_slope = c[2] + ((d[2] - c[2]) * x0 + c[3] * x1 + d[3] * x2);
  return low + ((high - low) * y0 + low_slope * y1 + high_slope * y2);
}

/* Piecewise bilinear with clipping, as Simulink's n-D Lookup Table (linear point-slope, clip, use last value). */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_bilinear(const kufe_lut_table *t, double fz,
                                                         double curvature) {
  kufe_lut_interpolated found;
  kufe_lut_place_ x, y;
  if (isnan(fz) || isnan(curvature)) return kufe_lut_nan_();
  kufe_lut_places_(t, fz, curvature, &x, &y);
  found.value = kufe_lut_plane_(t, t->values, &x, &y);
  found.out_of_range = x.outside || y.outside;
  return found;
}

/* C1, and monotone where the table is: bicubic Hermite patches over log force and curvature. */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_smooth(const kufe_lut_table *t, double fz,
                                                       double curvature) {
  kufe_lut_interpolated found;
  kufe_lut_place_ x, y;
  double rise, start;
  if (isnan(fz) || isnan(curvature)) return kufe_lut_nan_();
  kufe_lut_places_(t, fz, curvature, &x, &y);
  rise = kufe_lut_rise_(t, t->jets, &x, &y);
  start = t->values[x.low * t->n_curvature + y.low];
  found.value = t->logarithmic ? start * exp(rise) : start + rise;
  found.out_of_range = x.outside || y.outside;
  return found;
}

/* An axis along which layers lie: speeds or temperatures of the ice. */
typedef struct {
  int n;                /* breakpoints, 0 without the axis */
  const double *values; /* breakpoints, increasing */
  const double *scaled; /* as the smooth mode sees them */
  const double *slopes; /* of every cell, weights of the (up to) four layers around it in the slopes at both ends */
  int logarithmic;      /* whether scaled holds logarithms */
} kufe_lut_axis;

/* One quantity of a runner that slides: a layer for each speed and temperature, temperatures fastest. `layer` has the
   values and jets of the first; those of the others follow. */
typedef struct {
  kufe_lut_table layer;
  const kufe_lut_axis *v, *ice;
} kufe_lut_layers;

typedef struct {
  int first, count, nearest, outside;
  double of[4];
} kufe_lut_weights_;

static KUFE_LUT_UNUSED kufe_lut_weights_ kufe_lut_weigh_(const kufe_lut_axis *axis, double value, int smooth) {
  kufe_lut_weights_ w = { 0, 1, 0, 0, { 1.0, 0.0, 0.0, 0.0 } };
  kufe_lut_place_ at;
  if (axis->n < 1) return w;
  at = kufe_lut_find_(axis->values, axis->n, value);
  w.first = w.nearest = at.low;
  w.outside = at.outside;
  if (at.low == at.high) return w;
  if (smooth) {
    double input = axis->logarithmic ? log(at.clipped) : at.clipped;
    double t = kufe_lut_part_(axis->scaled, at.low, at.high, input), x0, x1, x2;
    const double *slopes = axis->slopes + 8 * at.low;
    int k, most = axis->n < 4 ? 0 : axis->n - 4;
    kufe_lut_hermite_(t, axis->scaled[at.high] - axis->scaled[at.low], &x0, &x1, &x2);
    w.first = at.low < 1 ? 0 : at.low - 1;
    if (w.first > most) w.first = most;
    w.count = axis->n < 4 ? axis->n : 4;
    for (k = 0; k < 4; ++k) w.of[k] = slopes[k] * x1 + slopes[4 + k] * x2;
    w.of[at.low - w.first] += 1.0 - x0;
    w.of[at.high - w.first] += x0;
  } else {
    double t = kufe_lut_part_(axis->values, at.low, at.high, at.clipped);
    w.count = 2;
    w.of[0] = 1.0 - t;
    w.of[1] = t;
  }
  return w;
}

static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_layered_(const kufe_lut_layers *t, double fz, double curvature,
                                                         double v, double ice_c, int smooth) {
  const kufe_lut_table *layer = &t->layer;
  kufe_lut_interpolated found;
  kufe_lut_place_ x, y;
  kufe_lut_weights_ speeds, temperatures;
  int i, j, columns = t->ice->n < 1 ? 1 : t->ice->n, nodes = layer->n_fz * layer->n_curvature, corner, near;
  double sum = 0.0, start, base;
  if (isnan(fz) || isnan(curvature) || (t->v->n > 0 && isnan(v)) || (t->ice->n > 0 && isnan(ice_c)))
    return kufe_lut_nan_();
  kufe_lut_places_(layer, fz, curvature, &x, &y);
  speeds = kufe_lut_weigh_(t->v, v, smooth);
  temperatures = kufe_lut_weigh_(t->ice, ice_c, smooth);
  corner = x.low * layer->n_curvature + y.low;
  near = (speeds.nearest * columns + temperatures.nearest) * nodes + corner;
  start = layer->values[near];
  base = smooth ? layer->jets[4 * near] : 0.0;
  for (i = 0; i < speeds.count; ++i) {
    double row = 0.0;
    if (speeds.of[i] == 0.0) continue;
    for (j = 0; j < temperatures.count; ++j) {
      int first = ((speeds.first + i) * columns + temperatures.first + j) * nodes;
      const double *jets = layer->jets + 4 * first;
      if (temperatures.of[j] == 0.0) continue;
      row += temperatures.of[j] * (smooth ? (jets[4 * corner] - base) + kufe_lut_rise_(layer, jets, &x, &y)
                                          : kufe_lut_plane_(layer, layer->values + first, &x, &y));
    }
    sum += speeds.of[i] * row;
  }
  found.value = !smooth ? sum : layer->logarithmic ? start * exp(sum) : start + sum;
  found.out_of_range = x.outside || y.outside || speeds.outside || temperatures.outside;
  return found;
}

/* Linear along all axes; an axis that the table has not is ignored. */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_layers_bilinear(const kufe_lut_layers *t, double fz,
                                                                double curvature, double v, double ice_c) {
  return kufe_lut_layered_(t, fz, curvature, v, ice_c, 0);
}

/* C1: the smooth mode of every layer, and cubic Hermite splines through the layers. */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_layers_smooth(const kufe_lut_layers *t, double fz,
                                                              double curvature, double v, double ice_c) {
  return kufe_lut_layered_(t, fz, curvature, v, ice_c, 1);
}

/* Track curvature [1/m], positive in a valley, from speed [m/s] and pitch rate [rad/s], positive nose
   down: the inverse of r = -v / pitch_rate, 0 at a standstill. */
static KUFE_LUT_UNUSED double kufe_lut_curvature_from_pitch(double speed, double pitch_rate) {
  const double min_speed = 1.0;
  if (fabs(speed) >= min_speed) return 0.0 - pitch_rate / speed;
  return 0.0 - pitch_rate * speed / (min_speed * min_speed);
}

#endif
