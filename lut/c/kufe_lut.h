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
/* The functions of a table: within the file that includes its header, or, with KUFE_LUT_SHARED, in a shared library. */
#if !defined(KUFE_LUT_SHARED)
#define KUFE_LUT_API static KUFE_LUT_UNUSED
#elif defined(_WIN32)
#define KUFE_LUT_API __declspec(dllexport)
#else
#define KUFE_LUT_API
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

/* What becomes of an input outside an axis: the axis's end takes its place; the interpolant continues straight; or there
   is no value but NaN. */
enum { KUFE_LUT_HOLD, KUFE_LUT_LINEAR, KUFE_LUT_ERROR };

typedef struct {
  int n;                /* breakpoints; 0 without the axis */
  int outside;          /* KUFE_LUT_HOLD, KUFE_LUT_LINEAR or KUFE_LUT_ERROR */
  int logarithmic;      /* whether scaled holds logarithms */
  const double *values; /* breakpoints, increasing */
  const double *scaled; /* as the smooth mode sees them */
  const double *slopes; /* of speeds and temperatures: of every cell, weights of the (up to) four layers around it in the
                           slopes at both ends */
} kufe_lut_axis;

/* One quantity. A layer for each speed and temperature, temperatures fastest; within it rows of constant force. */
typedef struct {
  const kufe_lut_axis *fz, *curvature, *v, *ice_c; /* [N], [1/m] or reduced curvatures, [m/s], [C] */
  const double *flush;  /* 0, or what defines reduced curvatures: flush curvature [1/m], scale [1/(m N)], and
                           the curvatures [1/m] of 0 and of 1 */
  const double *values; /* plain values */
  const double *jets;   /* value, slopes and twist of the smooth mode, four a node */
  int logarithmic;      /* whether the jets are of the values' logarithms */
} kufe_lut_table;

/* Largest relative errors of a quantity: the solver's over the nodes, and those of both modes at the solves between
   the nodes; NAN where not known. */
typedef struct {
  double solver, smooth, bilinear;
} kufe_lut_errors;

/* An interpolated value. out_of_range is 1 where an input was outside or NaN, and 2 where the rule of its axis is
   KUFE_LUT_ERROR. */
typedef struct {
  double value;
  int out_of_range;
} kufe_lut_interpolated;

/* The same with the interpolant's first derivatives by force [N], curvature [1/m], speed [m/s] and temperature of the ice
   [C]: 0 for an axis that the table has not and for an input that is held, at a kink those of the cell above it. */
typedef struct {
  double value, d_fz, d_curvature, d_v, d_ice_c;
  int out_of_range;
} kufe_lut_derivatives;

typedef struct {
  int low, high;  /* breakpoints around the input: the same at the last one, and outside where it is held */
  int cell, next; /* breakpoints of the cell whose slope applies */
  double at;      /* the input, or the axis's end in its place */
  double rate;    /* 0 where the axis's end is in its place, else 1 */
  int outside;
} kufe_lut_place_;

static KUFE_LUT_UNUSED kufe_lut_place_ kufe_lut_find_(const kufe_lut_axis *axis, double value) {
  kufe_lut_place_ place;
  const double *x = axis->values;
  int last = axis->n - 1, low = 0, high = last;
  place.at = value;
  place.outside = value > x[last] || value < x[0];
  place.rate = place.outside && axis->outside != KUFE_LUT_LINEAR ? 0.0 : 1.0;
  if (value >= x[last]) {
    low = last;
    if (place.rate == 0.0) place.at = x[last];
    else if (place.outside && last > 0) low = last - 1;
  } else if (value <= x[0]) {
    high = last < 1 ? last : 1;
    if (place.rate == 0.0) place.at = x[0];
  } else {
    while (high - low > 1) {
      int middle = low + (high - low) / 2;
      if (value < x[middle]) high = middle;
      else low = middle;
    }
  }
  place.low = low;
  place.high = high;
  place.cell = low == last && last > 0 ? last - 1 : low;
  place.next = place.cell < last ? place.cell + 1 : last;
  return place;
}

/* Part of the way from one breakpoint to the next, 0 where they are one. */
static KUFE_LUT_UNUSED double kufe_lut_part_(const double *axis, int low, int high, double value) {
  return low == high ? 0.0 : (value - axis[low]) / (axis[high] - axis[low]);
}

/* As the smooth mode sees an input: logarithms continue below their axis along the tangent. */
static KUFE_LUT_UNUSED double kufe_lut_scale_(const kufe_lut_axis *axis, double at) {
  if (!axis->logarithmic) return at;
  return at >= axis->values[0] ? log(at) : axis->scaled[0] + (at - axis->values[0]) / axis->values[0];
}

/* The derivative of that by the input. */
static KUFE_LUT_UNUSED double kufe_lut_rate_(const kufe_lut_axis *axis, const kufe_lut_place_ *p) {
  if (!axis->logarithmic) return p->rate;
  return p->rate / (p->at >= axis->values[0] ? p->at : axis->values[0]);
}

/* Weights of the far value and of both slopes in a cubic Hermite piece of width h, straight outside; their derivatives. */
typedef struct {
  double w[3], d[3];
} kufe_lut_hermite_;

static KUFE_LUT_UNUSED kufe_lut_hermite_ kufe_lut_piece_(double t, double h, double rate, int outside) {
  kufe_lut_hermite_ piece = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
  double s = 1.0 - t;
  if (outside) {
    int above = t >= 0.5;
    piece.w[0] = above ? 1.0 : 0.0;
    piece.w[above ? 2 : 1] = above ? h * (t - 1.0) : h * t;
    piece.d[above ? 2 : 1] = rate;
    return piece;
  }
  piece.w[0] = t * t * (3.0 - 2.0 * t);
  piece.w[1] = h * t * s * s;
  piece.w[2] = -(h * t * t * s);
  if (h > 0.0) piece.d[0] = rate * 6.0 * t * s / h;
  piece.d[1] = rate * s * (1.0 - 3.0 * t);
  piece.d[2] = rate * t * (3.0 * t - 2.0);
  return piece;
}

static KUFE_LUT_UNUSED kufe_lut_hermite_ kufe_lut_on_axis_(const kufe_lut_axis *axis, const kufe_lut_place_ *p) {
  double t = kufe_lut_part_(axis->scaled, p->low, p->high, kufe_lut_scale_(axis, p->at));
  return kufe_lut_piece_(t, axis->scaled[p->high] - axis->scaled[p->low], kufe_lut_rate_(axis, p), p->outside);
}

/* exp(asinh(|x|)). */
static KUFE_LUT_UNUSED double kufe_lut_far_(double x) { return fabs(x) + sqrt(1.0 + x * x); }

/* The place on the second axis of a force and a curvature: the curvature itself, or the reduced curvature
   (s(curvature) - s(from)) / (s(to) - s(from)) with s(k) = asinh((k - flush) / (scale * fz)); from < flush < to. With d its
   derivatives by force and curvature. */
static KUFE_LUT_UNUSED double kufe_lut_place_on_(const double *flush, double fz, double curvature, double *d) {
  double width, x, from, to, below, whole, part;
  if (d) {
    d[0] = 0.0;
    d[1] = 1.0;
  }
  if (!flush) return curvature;
  width = flush[1] * fz;
  from = (flush[2] - flush[0]) / width;
  to = (flush[3] - flush[0]) / width;
  below = kufe_lut_far_(from);
  whole = log(kufe_lut_far_(to) * below);
  x = (curvature - flush[0]) / width;
  part = x < 0.0 ? log(below / kufe_lut_far_(x)) : log(kufe_lut_far_(x) * below);
  if (d) {
    /* asinh(x) changes with the force by -x / sqrt(1 + x^2) / fz. */
    double at_from = from / sqrt(1.0 + from * from), at_to = to / sqrt(1.0 + to * to), root = sqrt(1.0 + x * x);
    d[0] = ((at_from - x / root) - part / whole * (at_from - at_to)) / (fz * whole);
    d[1] = 1.0 / (width * root * whole);
  }
  return part / whole;
}

/* Bilinear between the values of a cell. With d its derivatives by force and place on the second axis. */
static KUFE_LUT_UNUSED double kufe_lut_plane_(const kufe_lut_table *t, const double *values, const kufe_lut_place_ *x,
                                              const kufe_lut_place_ *y, double *d) {
  int n = t->curvature->n;
  const double *fz = t->fz->values, *curvature = t->curvature->values;
  const double *lower = values + x->low * n, *upper = values + x->high * n;
  double tx = kufe_lut_part_(fz, x->low, x->high, x->at);
  double ty = kufe_lut_part_(curvature, y->low, y->high, y->at);
  double left = lower[y->low] + (upper[y->low] - lower[y->low]) * tx;
  double right = lower[y->high] + (upper[y->high] - lower[y->high]) * tx;
  if (d) {
    const double *first = values + x->cell * n, *second = values + x->next * n;
    double from = first[y->low] + (first[y->high] - first[y->low]) * ty;
    double to = second[y->low] + (second[y->high] - second[y->low]) * ty;
    double before = lower[y->cell] + (upper[y->cell] - lower[y->cell]) * tx;
    double after = lower[y->next] + (upper[y->next] - lower[y->next]) * tx;
    d[0] = x->cell == x->next ? 0.0 : x->rate * (to - from) / (fz[x->next] - fz[x->cell]);
    d[1] = y->cell == y->next ? 0.0 : y->rate * (after - before) / (curvature[y->next] - curvature[y->cell]);
  }
  return left + (right - left) * ty;
}

/* Bicubic Hermite patch over log force and curvature, less its value at the lower corner. With d its derivatives by force
   and place on the second axis. */
static KUFE_LUT_UNUSED double kufe_lut_rise_(const kufe_lut_table *t, const double *jets, const kufe_lut_place_ *x,
                                             const kufe_lut_place_ *y, double *d) {
  int n = t->curvature->n;
  kufe_lut_hermite_ on_x = kufe_lut_on_axis_(t->fz, x), on_y = kufe_lut_on_axis_(t->curvature, y);
  const double *u = on_x.w, *w = on_y.w;
  const double *a = jets + 4 * (x->low * n + y->low), *b = jets + 4 * (x->high * n + y->low);
  const double *c = jets + 4 * (x->low * n + y->high), *e = jets + 4 * (x->high * n + y->high);
  double low = (b[0] - a[0]) * u[0] + a[1] * u[1] + b[1] * u[2];
  double high = (c[0] - a[0]) + ((e[0] - c[0]) * u[0] + c[1] * u[1] + e[1] * u[2]);
  double low_slope = a[2] + ((b[2] - a[2]) * u[0] + a[3] * u[1] + b[3] * u[2]);
  double high_slope = c[2] + ((e[2] - c[2]) * u[0] + c[3] * u[1] + e[3] * u[2]);
  if (d) {
    const double *du = on_x.d, *dw = on_y.d;
    double d_low = (b[0] - a[0]) * du[0] + a[1] * du[1] + b[1] * du[2];
    double d_high = (e[0] - c[0]) * du[0] + c[1] * du[1] + e[1] * du[2];
    double d_low_slope = (b[2] - a[2]) * du[0] + a[3] * du[1] + b[3] * du[2];
    double d_high_slope = (e[2] - c[2]) * du[0] + c[3] * du[1] + e[3] * du[2];
    d[0] = d_low + ((d_high - d_low) * w[0] + d_low_slope * w[1] + d_high_slope * w[2]);
    d[1] = (high - low) * dw[0] + low_slope * dw[1] + high_slope * dw[2];
  }
  return low + ((high - low) * w[0] + low_slope * w[1] + high_slope * w[2]);
}

/* Weights of layers along an axis, and their derivatives by the input. */
typedef struct {
  int first, count, nearest, outside;
  double of[4], d[4];
} kufe_lut_weights_;

static KUFE_LUT_UNUSED kufe_lut_weights_ kufe_lut_weigh_(const kufe_lut_axis *axis, double value, int smooth) {
  kufe_lut_weights_ w = { 0, 1, 0, 0, { 1.0, 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0, 0.0 } };
  kufe_lut_place_ p;
  double t;
  if (axis->n < 1) return w;
  p = kufe_lut_find_(axis, value);
  w.nearest = p.low;
  w.outside = p.outside;
  if (axis->n < 2) return w;
  w.first = p.cell;
  if (smooth) {
    const double *slopes = axis->slopes + 8 * p.cell;
    kufe_lut_hermite_ piece;
    int k, most = axis->n < 4 ? 0 : axis->n - 4;
    t = p.low == p.high ? 1.0 : kufe_lut_part_(axis->scaled, p.low, p.high, kufe_lut_scale_(axis, p.at));
    piece = kufe_lut_piece_(t, axis->scaled[p.next] - axis->scaled[p.cell], kufe_lut_rate_(axis, &p), p.outside);
    w.first = p.cell < 1 ? 0 : p.cell - 1;
    if (w.first > most) w.first = most;
    w.count = axis->n < 4 ? axis->n : 4;
    for (k = 0; k < 4; ++k) {
      w.of[k] = slopes[k] * piece.w[1] + slopes[4 + k] * piece.w[2];
      w.d[k] = slopes[k] * piece.d[1] + slopes[4 + k] * piece.d[2];
    }
    w.of[p.cell - w.first] += 1.0 - piece.w[0];
    w.of[p.next - w.first] += piece.w[0];
    w.d[p.cell - w.first] -= piece.d[0];
    w.d[p.next - w.first] += piece.d[0];
  } else {
    t = p.low == p.high ? 1.0 : kufe_lut_part_(axis->values, p.low, p.high, p.at);
    w.count = 2;
    w.of[0] = 1.0 - t;
    w.of[1] = t;
    w.d[1] = p.rate / (axis->values[p.next] - axis->values[p.cell]);
    w.d[0] = -w.d[1];
  }
  return w;
}

/* The value of a table, 4 derivatives at d where d is no null pointer. */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_evaluate_(const kufe_lut_table *t, double fz, double curvature,
                                                                double v, double ice_c, int smooth, double *d) {
  kufe_lut_interpolated found;
  kufe_lut_place_ x, y;
  kufe_lut_weights_ speeds, temperatures;
  const double *forces = t->fz->values;
  double sum = 0.0, base, start, held, reduced[2], sums[4] = { 0.0, 0.0, 0.0, 0.0 };
  int i, j, k, columns, nodes, corner, nearest;
  found.value = (double)NAN;
  found.out_of_range = 1;
  for (k = 0; d && k < 4; ++k) d[k] = (double)NAN;
  if (isnan(fz) || isnan(curvature) || (t->v->n > 0 && isnan(v)) || (t->ice_c->n > 0 && isnan(ice_c))) return found;
  held = fz < forces[0] ? forces[0] : fz > forces[t->fz->n - 1] ? forces[t->fz->n - 1] : fz;
  /* A runner that has lifted off has no smaller pressure than at a force of 0. */
  x = kufe_lut_find_(t->fz, fz < 0.0 ? 0.0 : fz);
  if (fz < 0.0) x.rate = 0.0;
  y = kufe_lut_find_(t->curvature, kufe_lut_place_on_(t->flush, held, curvature, d ? reduced : 0));
  speeds = kufe_lut_weigh_(t->v, v, smooth);
  temperatures = kufe_lut_weigh_(t->ice_c, ice_c, smooth);
  if ((x.outside && t->fz->outside == KUFE_LUT_ERROR) || (y.outside && t->curvature->outside == KUFE_LUT_ERROR) ||
      (speeds.outside && t->v->outside == KUFE_LUT_ERROR) ||
      (temperatures.outside && t->ice_c->outside == KUFE_LUT_ERROR)) {
    found.out_of_range = 2;
    return found;
  }
  columns = t->ice_c->n < 1 ? 1 : t->ice_c->n;
  nodes = t->fz->n * t->curvature->n;
  corner = x.low * t->curvature->n + y.low;
  nearest = (speeds.nearest * columns + temperatures.nearest) * nodes + corner;
  start = t->values[nearest];
  base = smooth ? t->jets[4 * nearest] : 0.0;
  for (i = 0; i < speeds.count; ++i) {
    double row = 0.0, rows[3] = { 0.0, 0.0, 0.0 };
    if (speeds.of[i] == 0.0 && (!d || speeds.d[i] == 0.0)) continue;
    for (j = 0; j < temperatures.count; ++j) {
      int first = ((speeds.first + i) * columns + temperatures.first + j) * nodes;
      double weight = temperatures.of[j], value, by[2] = { 0.0, 0.0 };
      if (weight == 0.0 && (!d || temperatures.d[j] == 0.0)) continue;
      value = smooth ? (t->jets[4 * (first + corner)] - base) +
                           kufe_lut_rise_(t, t->jets + 4 * first, &x, &y, d ? by : 0)
                     : kufe_lut_plane_(t, t->values + first, &x, &y, d ? by : 0);
      row += weight * value;
      rows[0] += weight * by[0];
      rows[1] += weight * by[1];
      rows[2] += temperatures.d[j] * value;
    }
    sum += speeds.of[i] * row;
    sums[0] += speeds.of[i] * rows[0];
    sums[1] += speeds.of[i] * rows[1];
    sums[2] += speeds.d[i] * row;
    sums[3] += speeds.of[i] * rows[2];
  }
  found.value = !smooth ? sum : t->logarithmic ? start * exp(sum) : start + sum;
  found.out_of_range = x.outside || y.outside || speeds.outside || temperatures.outside;
  if (d) {
    double scale = smooth && t->logarithmic ? found.value : 1.0;
    sums[0] += x.outside ? 0.0 : sums[1] * reduced[0];
    sums[1] *= reduced[1];
    for (k = 0; k < 4; ++k) d[k] = scale * sums[k];
  }
  return found;
}

/* The value of a table. Smooth: C1, and monotone over force and curvature where the table is: bicubic Hermite patches over
   log force and curvature, and cubic Hermite splines through the layers. Else piecewise bilinear, as Simulink's n-D Lookup
   Table (linear point-slope, use last value). An axis that the table has not is ignored. */
static KUFE_LUT_UNUSED kufe_lut_interpolated kufe_lut_at(const kufe_lut_table *t, double fz, double curvature, double v,
                                                         double ice_c, int smooth) {
  return kufe_lut_evaluate_(t, fz, curvature, v, ice_c, smooth, 0);
}

/* The same with the first derivatives of what kufe_lut_at interpolates. */
static KUFE_LUT_UNUSED kufe_lut_derivatives kufe_lut_derivatives_at(const kufe_lut_table *t, double fz, double curvature,
                                                                    double v, double ice_c, int smooth) {
  kufe_lut_derivatives found;
  double d[4];
  kufe_lut_interpolated plain = kufe_lut_evaluate_(t, fz, curvature, v, ice_c, smooth, d);
  found.value = plain.value;
  found.d_fz = d[0];
  found.d_curvature = d[1];
  found.d_v = d[2];
  found.d_ice_c = d[3];
  found.out_of_range = plain.out_of_range;
  return found;
}

/* Track curvature [1/m], positive in a valley, from speed [m/s] and pitch rate [rad/s], positive nose
   down: the inverse of r = -v / pitch_rate; below 1 m/s -pitch_rate v / (1 m/s)^2, 0 at a standstill. */
static KUFE_LUT_UNUSED double kufe_lut_curvature_from_pitch(double speed, double pitch_rate) {
  const double min_speed = 1.0;
  if (fabs(speed) >= min_speed) return 0.0 - pitch_rate / speed;
  return 0.0 - pitch_rate * speed / (min_speed * min_speed);
}

#endif
