/* A unit around one lookup table that it reads from its resources, for both versions of FMI. Every output follows from the
   inputs of the moment; there is no continuous state. */
#ifndef KUFE_UNIT_H
#define KUFE_UNIT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined(_WIN32)
#include <windows.h>
#endif

#include "kufe_lut.h"

/* Value references, as modelDescription.xml lists them. */
enum {
  VR_TIME, VR_FZ, VR_V, VR_PITCH_RATE, VR_CURVATURE, VR_PRESSURE, VR_OUT_OF_RANGE,
  VR_USE_CURVATURE, VR_SMOOTH, VR_ICE_C, VR_FIRST_OF_SLIDING
};

/* What resources/table.bin starts with; doubles follow: flush (4 or none), fz and its logarithms, curvature; of speeds and
   of temperatures of the ice values, scaled and slopes; of every quantity values and jets of all layers. Bit k of
   `logarithmic` is quantity k's; `outside` has two bits an axis, force first. */
typedef struct {
  char magic[8];
  char token[64];
  uint32_t n_fz, n_curvature, n_v, n_ice, quantities, logarithmic, reduced, outside;
} Head;

#define LONGEST_AXIS 4096u
#define MOST_QUANTITIES 16u

typedef enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP, TERMINATED } Phase;

/* All that changes: copied whole by the functions for states. */
typedef struct {
  double time, fz, v, pitch_rate, curvature, ice_c;
  bool use_curvature, smooth;
  bool out_of_range; /* held between events in Model Exchange */
} State;

typedef struct {
  State state;
  Phase phase;
} Saved;

typedef struct {
  State state, start;
  Phase phase;
  bool model_exchange, event_mode;
  double *numbers;
  kufe_lut_axis fz, curvature, v, ice;
  kufe_lut_table tables[MOST_QUANTITIES]; /* peak pressure, then those of sliding */
  unsigned quantities;
  /* The importer's: what messages go to, as the version of FMI has it. */
  void *environment;
  const char *name;
  void (*log)(void);
} Unit;

static const char OUTSIDE[] = "an input is outside the table along an axis whose rule is error";
static const char PARAMETERS_FIXED[] = "the parameters are fixed once the simulation has started";
static const char NO_MEMORY[] = "out of memory";

/* ---- the table ---- */

/* An axis from the numbers that begin with it; what follows it. */
static const double *axis_of(kufe_lut_axis *axis, uint32_t n, uint32_t outside, int logarithmic, bool layers,
                             const double *numbers) {
  axis->n = (int)n;
  axis->outside = (int)(outside & 3u);
  axis->logarithmic = logarithmic;
  axis->values = numbers;
  axis->scaled = logarithmic || layers ? numbers + n : numbers;
  axis->slopes = layers ? axis->scaled + n : NULL;
  return layers && n ? axis->slopes + 8 * (n - 1) : axis->scaled + n;
}

/* A file whose path is UTF-8. */
static FILE *open_file(const char *path) {
#if defined(_WIN32)
  FILE *file = NULL;
  int length = MultiByteToWideChar(CP_UTF8, 0, path, -1, NULL, 0);
  wchar_t *wide = (wchar_t *)malloc((size_t)(length > 0 ? length : 1) * sizeof(wchar_t));
  if (wide && length > 0 && MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, length) > 0) file = _wfopen(wide, L"rb");
  free(wide);
  return file;
#else
  return fopen(path, "rb");
#endif
}

static const char *read_table(Unit *unit, FILE *file, const char *token) {
  Head head;
  const double *next;
  uint64_t count, n, layers;
  uint32_t k;
  long length;
  if (fread(&head, sizeof head, 1, file) != 1 || memcmp(head.magic, "KUFELUT3", 8) != 0)
    return "resources/table.bin is no table of this unit";
  if (head.n_fz < 1 || head.n_fz > LONGEST_AXIS || head.n_curvature < 1 ||
      head.n_curvature > LONGEST_AXIS || head.n_v > LONGEST_AXIS || head.n_ice > LONGEST_AXIS ||
      head.quantities < 1 || head.quantities > MOST_QUANTITIES)
    return "resources/table.bin has an axis of impossible length";
  n = (uint64_t)head.n_fz * head.n_curvature;
  layers = (uint64_t)(head.n_v ? head.n_v : 1) * (head.n_ice ? head.n_ice : 1);
  if (n * layers > (1u << 20)) return "resources/table.bin has more nodes than a table";
  count = (head.reduced ? 4 : 0) + 2 * (uint64_t)head.n_fz + head.n_curvature +
          (head.n_v ? 10 * (uint64_t)head.n_v - 8 : 0) + (head.n_ice ? 10 * (uint64_t)head.n_ice - 8 : 0) +
          5 * n * layers * head.quantities;
  if (fseek(file, 0, SEEK_END) != 0 || (length = ftell(file)) < 0 ||
      (uint64_t)length != sizeof head + 8 * count || fseek(file, (long)sizeof head, SEEK_SET) != 0)
    return "resources/table.bin has not the length that it states";
  if (!token || strlen(token) != sizeof head.token || memcmp(token, head.token, sizeof head.token) != 0)
    return "the instantiation token is not this unit's";
  unit->numbers = (double *)malloc((size_t)count * sizeof(double));
  if (!unit->numbers || fread(unit->numbers, 8, (size_t)count, file) != count)
    return "resources/table.bin cannot be read";
  next = unit->numbers + (head.reduced ? 4 : 0);
  next = axis_of(&unit->fz, head.n_fz, head.outside, 1, false, next);
  next = axis_of(&unit->curvature, head.n_curvature, head.outside >> 2, 0, false, next);
  next = axis_of(&unit->v, head.n_v, head.outside >> 4, 1, true, next);
  next = axis_of(&unit->ice, head.n_ice, head.outside >> 6, 0, true, next);
  unit->quantities = head.quantities;
  for (k = 0; k < head.quantities; ++k) {
    kufe_lut_table *table = &unit->tables[k];
    table->fz = &unit->fz;
    table->curvature = &unit->curvature;
    table->v = &unit->v;
    table->ice_c = &unit->ice;
    table->flush = head.reduced ? unit->numbers : NULL;
    table->logarithmic = (head.logarithmic >> k) & 1u;
    table->values = next;
    table->jets = next + n * layers;
    next = table->jets + 4 * n * layers;
  }
  return NULL;
}

/* The unit of the table in the folder `resources`; NULL with the reason where there is none. */
static Unit *new_unit(const char *token, const char *resources, const char **wrong) {
  static const char name[] = "table.bin";
  size_t length = resources ? strlen(resources) : 0;
  char *path = (char *)malloc(length + sizeof name + 1);
  Unit *unit = (Unit *)calloc(1, sizeof(Unit));
  FILE *file;
  *wrong = NO_MEMORY;
  if (path && unit) {
    memcpy(path, resources ? resources : "", length);
    if (length && path[length - 1] != '/' && path[length - 1] != '\\') path[length++] = '/';
    memcpy(path + length, name, sizeof name);
    file = open_file(path);
    *wrong = file ? read_table(unit, file, token) : "resources/table.bin cannot be opened";
    if (file) fclose(file);
  }
  free(path);
  if (*wrong) {
    if (unit) free(unit->numbers);
    free(unit);
    return NULL;
  }
  /* The start values that modelDescription.xml states. */
  unit->start.fz = unit->fz.values[0];
  unit->start.v = unit->v.n ? unit->v.values[0] : 0.0;
  unit->start.ice_c = unit->ice.n ? unit->ice.values[0] : 0.0;
  unit->start.smooth = true;
  unit->state = unit->start;
  return unit;
}

static void free_unit(Unit *unit) {
  if (unit) free(unit->numbers);
  free(unit);
}

static kufe_lut_interpolated interpolate(const Unit *unit, unsigned quantity) {
  const State *s = &unit->state;
  double curvature =
      s->use_curvature ? s->curvature : kufe_lut_curvature_from_pitch(s->v, s->pitch_rate);
  return kufe_lut_at(&unit->tables[quantity], s->fz, curvature, s->v, s->ice_c, s->smooth);
}

/* Whether an input is outside the table now. */
static bool outside_now(const Unit *unit) { return interpolate(unit, 0).out_of_range != 0; }

/* ---- variables: NULL, or what is wrong ---- */

static const char *get_real(const Unit *unit, uint32_t vr, double *value) {
  kufe_lut_interpolated found;
  unsigned quantity = 0;
  switch (vr) {
    case VR_TIME: *value = unit->state.time; return NULL;
    case VR_FZ: *value = unit->state.fz; return NULL;
    case VR_V: *value = unit->state.v; return NULL;
    case VR_PITCH_RATE: *value = unit->state.pitch_rate; return NULL;
    case VR_CURVATURE: *value = unit->state.curvature; return NULL;
    case VR_ICE_C: *value = unit->state.ice_c; return NULL;
    case VR_PRESSURE: break;
    default:
      if (vr < VR_FIRST_OF_SLIDING || vr - VR_FIRST_OF_SLIDING + 1 >= unit->quantities)
        return "no real variable of that reference";
      quantity = (unsigned)(vr - VR_FIRST_OF_SLIDING + 1);
  }
  found = interpolate(unit, quantity);
  *value = found.value;
  return found.out_of_range == 2 ? OUTSIDE : NULL;
}

static const char *set_real(Unit *unit, uint32_t vr, double value) {
  switch (vr) {
    case VR_FZ: unit->state.fz = value; return NULL;
    case VR_V: unit->state.v = value; return NULL;
    case VR_PITCH_RATE: unit->state.pitch_rate = value; return NULL;
    case VR_CURVATURE: unit->state.curvature = value; return NULL;
    case VR_ICE_C: unit->state.ice_c = value; return NULL;
    default: return "no real input of that reference";
  }
}

static const char *get_boolean(const Unit *unit, uint32_t vr, bool *value) {
  bool held = unit->model_exchange && unit->phase == CONTINUOUS;
  switch (vr) {
    case VR_OUT_OF_RANGE: *value = held ? unit->state.out_of_range : outside_now(unit); return NULL;
    case VR_USE_CURVATURE: *value = unit->state.use_curvature; return NULL;
    case VR_SMOOTH: *value = unit->state.smooth; return NULL;
    default: return "no Boolean variable of that reference";
  }
}

static const char *set_boolean(Unit *unit, uint32_t vr, bool value) {
  if (unit->phase != INSTANTIATED && unit->phase != INITIALIZATION) return PARAMETERS_FIXED;
  switch (vr) {
    case VR_USE_CURVATURE: unit->state.use_curvature = value; return NULL;
    case VR_SMOOTH: unit->state.smooth = value; return NULL;
    default: return "no Boolean parameter of that reference";
  }
}

/* ---- life cycle and saved states ---- */

static const char *enter_initialization(Unit *unit, double start) {
  if (unit->phase != INSTANTIATED) return "initialization follows instantiation";
  unit->state.time = start;
  unit->phase = INITIALIZATION;
  return NULL;
}

static const char *exit_initialization(Unit *unit) {
  if (unit->phase != INITIALIZATION) return "not in initialization mode";
  unit->state.out_of_range = outside_now(unit);
  unit->phase = unit->event_mode ? EVENT : STEP;
  return NULL;
}

static void reset(Unit *unit) {
  unit->state = unit->start;
  unit->phase = INSTANTIATED;
}

static const char *save(const Unit *unit, void **state) {
  Saved *saved = *state ? (Saved *)*state : (Saved *)calloc(1, sizeof(Saved));
  if (!saved) return NO_MEMORY;
  saved->state = unit->state;
  saved->phase = unit->phase;
  *state = saved;
  return NULL;
}

static const char *restore(Unit *unit, const void *state) {
  if (!state) return "no state given";
  unit->state = ((const Saved *)state)->state;
  unit->phase = ((const Saved *)state)->phase;
  return NULL;
}

static const char *serialize(const void *state, void *bytes, size_t size) {
  if (!state || size != sizeof(Saved)) return "wrong size of a state";
  memcpy(bytes, state, size);
  return NULL;
}

static const char *deserialize(const void *bytes, size_t size, void **state) {
  Saved *saved;
  if (size != sizeof(Saved)) return "wrong size of a state";
  saved = *state ? (Saved *)*state : (Saved *)calloc(1, sizeof(Saved));
  if (!saved) return NO_MEMORY;
  memcpy(saved, bytes, size);
  *state = saved;
  return NULL;
}

#endif
