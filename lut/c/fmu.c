/* An FMI 3.0 unit, Model Exchange and Co-Simulation, around one lookup table that it reads from its
   resources. Every output follows from the inputs of the moment; there is no continuous state. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3.h"
#include "kufe_lut.h"

/* Value references, as modelDescription.xml lists them. */
enum {
  VR_TIME, VR_FZ, VR_V, VR_PITCH_RATE, VR_CURVATURE, VR_PRESSURE, VR_OUT_OF_RANGE,
  VR_USE_CURVATURE, VR_SMOOTH, VR_ICE_C, VR_FIRST_OF_SLIDING
};

/* What resources/table.bin starts with; doubles follow: flush (4 or none), fz, log_fz, curvature; of speeds and of temperatures
   of the ice values, scaled and slopes; of every quantity values and jets of all layers. Bit k of `logarithmic` is quantity k's. */
typedef struct {
  char magic[8];
  char token[64];
  uint32_t n_fz, n_curvature, n_v, n_ice, quantities, logarithmic, reduced, none;
} Head;

#define LONGEST_AXIS 4096u
#define MOST_QUANTITIES 16u

typedef enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP, TERMINATED } Phase;

/* All that changes: copied whole by the FMU state functions. */
typedef struct {
  double time, fz, v, pitch_rate, curvature, ice_c;
  bool use_curvature, smooth;
  bool out_of_range; /* held between events in Model Exchange */
} State;

typedef struct {
  State state, start;
  Phase phase;
  bool model_exchange, event_mode;
  double *numbers;
  kufe_lut_axis v, ice;
  kufe_lut_layers tables[MOST_QUANTITIES]; /* peak pressure, then those of sliding */
  unsigned quantities;
  fmi3LogMessageCallback log;
  fmi3InstanceEnvironment environment;
} Unit;

static void say(fmi3LogMessageCallback log, fmi3InstanceEnvironment environment, fmi3Status status,
                const char *message) {
  if (log) log(environment, status, status == fmi3OK ? "logEvents" : "logStatusError", message);
}

static fmi3Status refuse(const Unit *unit, const char *message) {
  say(unit->log, unit->environment, fmi3Error, message);
  return fmi3Error;
}

/* ---- the table ---- */

/* An axis of layers from the numbers that begin with it; what follows it. */
static const double *axis_of(kufe_lut_axis *axis, uint32_t n, int logarithmic, const double *numbers) {
  axis->n = (int)n;
  axis->logarithmic = logarithmic;
  axis->values = numbers;
  axis->scaled = numbers + n;
  axis->slopes = numbers + 2 * n;
  return n ? axis->slopes + 8 * (n - 1) : numbers;
}

static const char *load(Unit *unit, const char *path, const char *token) {
  Head head;
  kufe_lut_table table;
  const double *next;
  uint64_t count, n, layers;
  uint32_t k;
  long length;
  FILE *file = fopen(path, "rb");
  if (!file) return "resources/table.bin cannot be opened";
  if (fread(&head, sizeof head, 1, file) != 1 || memcmp(head.magic, "KUFELUT2", 8) != 0) {
    fclose(file);
    return "resources/table.bin is no table of this unit";
  }
  if (head.n_fz < 1 || head.n_fz > LONGEST_AXIS || head.n_curvature < 1 ||
      head.n_curvature > LONGEST_AXIS || head.n_v > LONGEST_AXIS || head.n_ice > LONGEST_AXIS ||
      head.quantities < 1 || head.quantities > MOST_QUANTITIES) {
    fclose(file);
    return "resources/table.bin has an axis of impossible length";
  }
  n = (uint64_t)head.n_fz * head.n_curvature;
  layers = (uint64_t)(head.n_v ? head.n_v : 1) * (head.n_ice ? head.n_ice : 1);
  if (n * layers > (1u << 20)) {
    fclose(file);
    return "resources/table.bin has more nodes than a table";
  }
  count = (head.reduced ? 4 : 0) + 2 * (uint64_t)head.n_fz + head.n_curvature +
          (head.n_v ? 10 * (uint64_t)head.n_v - 8 : 0) + (head.n_ice ? 10 * (uint64_t)head.n_ice - 8 : 0) +
          5 * n * layers * head.quantities;
  if (fseek(file, 0, SEEK_END) != 0 || (length = ftell(file)) < 0 ||
      (uint64_t)length != sizeof head + 8 * count ||
      fseek(file, (long)sizeof head, SEEK_SET) != 0) {
    fclose(file);
    return "resources/table.bin has not the length that it states";
  }
  if (!token || strlen(token) != sizeof head.token ||
      memcmp(token, head.token, sizeof head.token) != 0) {
    fclose(file);
    return "the instantiation token is not this unit's";
  }
  unit->numbers = (double *)malloc((size_t)count * sizeof(double));
  if (!unit->numbers || fread(unit->numbers, 8, (size_t)count, file) != count) {
    fclose(file);
    return "resources/table.bin cannot be read";
  }
  fclose(file);
  table.n_fz = (int)head.n_fz;
  table.n_curvature = (int)head.n_curvature;
  table.flush = head.reduced ? unit->numbers : NULL;
  table.fz = unit->numbers + (head.reduced ? 4 : 0);
  table.log_fz = table.fz + head.n_fz;
  table.curvature = table.log_fz + head.n_fz;
  next = axis_of(&unit->v, head.n_v, 1, table.curvature + head.n_curvature);
  next = axis_of(&unit->ice, head.n_ice, 0, next);
  unit->quantities = head.quantities;
  for (k = 0; k < head.quantities; ++k) {
    table.logarithmic = (head.logarithmic >> k) & 1u;
    table.values = next;
    table.jets = next + n * layers;
    next = table.jets + 4 * n * layers;
    unit->tables[k].layer = table;
    unit->tables[k].v = &unit->v;
    unit->tables[k].ice = &unit->ice;
  }
  return NULL;
}

static kufe_lut_interpolated interpolate(const Unit *unit, unsigned quantity) {
  const State *s = &unit->state;
  double curvature =
      s->use_curvature ? s->curvature : kufe_lut_curvature_from_pitch(s->v, s->pitch_rate);
  return kufe_lut_layered_(&unit->tables[quantity], s->fz, curvature, s->v, s->ice_c, s->smooth);
}

/* The peak pressure. */
static kufe_lut_interpolated interpolate_pressure(const Unit *unit) { return interpolate(unit, 0); }

static bool flag(const Unit *unit) {
  bool held = unit->model_exchange && unit->phase == CONTINUOUS;
  return held ? unit->state.out_of_range : interpolate_pressure(unit).out_of_range != 0;
}

/* ---- life cycle ---- */

static fmi3Instance instantiate(const char *token, const char *resources, bool model_exchange,
                                bool event_mode, fmi3InstanceEnvironment environment,
                                fmi3LogMessageCallback log) {
  static const char name[] = "table.bin";
  const char *wrong;
  size_t length;
  char *path;
  Unit *unit = (Unit *)calloc(1, sizeof(Unit));
  if (!unit) return NULL;
  unit->log = log;
  unit->environment = environment;
  unit->model_exchange = model_exchange;
  unit->event_mode = event_mode;
  length = resources ? strlen(resources) : 0;
  path = (char *)malloc(length + sizeof name + 1);
  if (!path) {
    free(unit);
    return NULL;
  }
  memcpy(path, resources ? resources : "", length);
  if (length && path[length - 1] != '/' && path[length - 1] != '\\') path[length++] = '/';
  memcpy(path + length, name, sizeof name);
  wrong = load(unit, path, token);
  free(path);
  if (wrong) {
    say(log, environment, fmi3Error, wrong);
    free(unit->numbers);
    free(unit);
    return NULL;
  }
  /* The start values that modelDescription.xml states. */
  unit->start.fz = unit->tables[0].layer.fz[0];
  unit->start.ice_c = unit->ice.n ? unit->ice.values[0] : 0.0;
  unit->start.smooth = true;
  unit->state = unit->start;
  return unit;
}

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                                           const fmi3String categories[]) {
  (void)instance; (void)on; (void)n; (void)categories;
  return fmi3OK;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                      fmi3String resources, fmi3Boolean visible,
                                                      fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log) {
  (void)name; (void)visible; (void)logging;
  return instantiate(token, resources, true, true, environment, log);
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
    const fmi3ValueReference required[], size_t n_required, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
  (void)name; (void)visible; (void)logging; (void)early_return; (void)required; (void)n_required;
  (void)update;
  return instantiate(token, resources, false, event_mode, environment, log);
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
  (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)clock; (void)lock;
  (void)unlock;
  say(log, environment, fmi3Error, "this unit has no scheduled execution");
  return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance) {
  Unit *unit = (Unit *)instance;
  if (!unit) return;
  free(unit->numbers);
  free(unit);
}

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                   fmi3Float64 tolerance, fmi3Float64 start,
                                                   fmi3Boolean has_stop, fmi3Float64 stop) {
  Unit *unit = (Unit *)instance;
  (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
  if (unit->phase != INSTANTIATED) return refuse(unit, "initialization follows instantiation");
  unit->state.time = start;
  unit->phase = INITIALIZATION;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  Unit *unit = (Unit *)instance;
  if (unit->phase != INITIALIZATION) return refuse(unit, "not in initialization mode");
  unit->state.out_of_range = interpolate_pressure(unit).out_of_range != 0;
  unit->phase = unit->event_mode ? EVENT : STEP;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  ((Unit *)instance)->phase = EVENT;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  ((Unit *)instance)->phase = STEP;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  Unit *unit = (Unit *)instance;
  unit->state.out_of_range = interpolate_pressure(unit).out_of_range != 0;
  unit->phase = CONTINUOUS;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
  ((Unit *)instance)->phase = TERMINATED;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
  Unit *unit = (Unit *)instance;
  unit->state = unit->start;
  unit->phase = INSTANTIATED;
  return fmi3OK;
}

/* ---- variables ---- */

FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t n, fmi3Float64 values[], size_t n_values) {
  Unit *unit = (Unit *)instance;
  size_t i;
  if (n != n_values) return refuse(unit, "as many values as references are expected");
  for (i = 0; i < n; ++i) {
    switch (vr[i]) {
      case VR_TIME: values[i] = unit->state.time; break;
      case VR_FZ: values[i] = unit->state.fz; break;
      case VR_V: values[i] = unit->state.v; break;
      case VR_PITCH_RATE: values[i] = unit->state.pitch_rate; break;
      case VR_CURVATURE: values[i] = unit->state.curvature; break;
      case VR_PRESSURE: values[i] = interpolate_pressure(unit).value; break;
      case VR_ICE_C: values[i] = unit->state.ice_c; break;
      default:
        if (vr[i] < VR_FIRST_OF_SLIDING || vr[i] - VR_FIRST_OF_SLIDING + 1 >= unit->quantities)
          return refuse(unit, "no Float64 variable of that reference");
        values[i] = interpolate(unit, (unsigned)(vr[i] - VR_FIRST_OF_SLIDING + 1)).value;
    }
  }
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t n, const fmi3Float64 values[], size_t n_values) {
  Unit *unit = (Unit *)instance;
  size_t i;
  if (n != n_values) return refuse(unit, "as many values as references are expected");
  for (i = 0; i < n; ++i) {
    switch (vr[i]) {
      case VR_FZ: unit->state.fz = values[i]; break;
      case VR_V: unit->state.v = values[i]; break;
      case VR_PITCH_RATE: unit->state.pitch_rate = values[i]; break;
      case VR_CURVATURE: unit->state.curvature = values[i]; break;
      case VR_ICE_C: unit->state.ice_c = values[i]; break;
      default: return refuse(unit, "no Float64 input of that reference");
    }
  }
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t n, fmi3Boolean values[], size_t n_values) {
  Unit *unit = (Unit *)instance;
  size_t i;
  if (n != n_values) return refuse(unit, "as many values as references are expected");
  for (i = 0; i < n; ++i) {
    switch (vr[i]) {
      case VR_OUT_OF_RANGE: values[i] = flag(unit); break;
      case VR_USE_CURVATURE: values[i] = unit->state.use_curvature; break;
      case VR_SMOOTH: values[i] = unit->state.smooth; break;
      default: return refuse(unit, "no Boolean variable of that reference");
    }
  }
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t n, const fmi3Boolean values[], size_t n_values) {
  Unit *unit = (Unit *)instance;
  size_t i;
  if (n != n_values) return refuse(unit, "as many values as references are expected");
  if (unit->phase != INSTANTIATED && unit->phase != INITIALIZATION)
    return refuse(unit, "the parameters are fixed once the simulation has started");
  for (i = 0; i < n; ++i) {
    switch (vr[i]) {
      case VR_USE_CURVATURE: unit->state.use_curvature = values[i]; break;
      case VR_SMOOTH: unit->state.smooth = values[i]; break;
      default: return refuse(unit, "no Boolean parameter of that reference");
    }
  }
  return fmi3OK;
}

/* There are no variables of the other types: only an empty request is right. */
#define NO_VARIABLES(Name, Type)                                                                   \
  FMI3_EXPORT fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, Type values[], size_t n_values) {                 \
    (void)vr; (void)values; (void)n_values;                                                        \
    return n ? refuse((Unit *)instance, "no variables of type " #Name) : fmi3OK;                   \
  }                                                                                                \
  FMI3_EXPORT fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, const Type values[], size_t n_values) {           \
    (void)vr; (void)values; (void)n_values;                                                        \
    return n ? refuse((Unit *)instance, "no variables of type " #Name) : fmi3OK;                   \
  }
NO_VARIABLES(Float32, fmi3Float32)
NO_VARIABLES(Int8, fmi3Int8)
NO_VARIABLES(UInt8, fmi3UInt8)
NO_VARIABLES(Int16, fmi3Int16)
NO_VARIABLES(UInt16, fmi3UInt16)
NO_VARIABLES(Int32, fmi3Int32)
NO_VARIABLES(UInt32, fmi3UInt32)
NO_VARIABLES(Int64, fmi3Int64)
NO_VARIABLES(UInt64, fmi3UInt64)
NO_VARIABLES(String, fmi3String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                     size_t sizes[], fmi3Binary values[], size_t n_values) {
  (void)vr; (void)sizes; (void)values; (void)n_values;
  return n ? refuse((Unit *)instance, "no variables of type Binary") : fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                     const size_t sizes[], const fmi3Binary values[],
                                     size_t n_values) {
  (void)vr; (void)sizes; (void)values; (void)n_values;
  return n ? refuse((Unit *)instance, "no variables of type Binary") : fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                    fmi3Clock values[]) {
  (void)vr; (void)values;
  return n ? refuse((Unit *)instance, "no clocks") : fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                    const fmi3Clock values[]) {
  (void)vr; (void)values;
  return n ? refuse((Unit *)instance, "no clocks") : fmi3OK;
}

/* ---- saved states ---- */

typedef struct {
  State state;
  Phase phase;
} Saved;

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  Unit *unit = (Unit *)instance;
  Saved *saved = *state ? (Saved *)*state : (Saved *)calloc(1, sizeof(Saved));
  if (!saved) return refuse(unit, "out of memory");
  saved->state = unit->state;
  saved->phase = unit->phase;
  *state = saved;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  Unit *unit = (Unit *)instance;
  if (!state) return refuse(unit, "no state given");
  unit->state = ((Saved *)state)->state;
  unit->phase = ((Saved *)state)->phase;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  (void)instance;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state,
                                                  size_t *size) {
  (void)instance; (void)state;
  *size = sizeof(Saved);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state,
                                             fmi3Byte bytes[], size_t size) {
  if (!state || size != sizeof(Saved)) return refuse((Unit *)instance, "wrong size of a state");
  memcpy(bytes, state, size);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[],
                                               size_t size, fmi3FMUState *state) {
  Saved *saved;
  if (size != sizeof(Saved)) return refuse((Unit *)instance, "wrong size of a state");
  saved = *state ? (Saved *)*state : (Saved *)calloc(1, sizeof(Saved));
  if (!saved) return refuse((Unit *)instance, "out of memory");
  memcpy(saved, bytes, size);
  *state = saved;
  return fmi3OK;
}

/* ---- events, Model Exchange, Co-Simulation ---- */

FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again,
                                                fmi3Boolean *terminate, fmi3Boolean *nominals,
                                                fmi3Boolean *states, fmi3Boolean *has_next,
                                                fmi3Float64 *next) {
  Unit *unit = (Unit *)instance;
  unit->state.out_of_range = interpolate_pressure(unit).out_of_range != 0;
  *again = *terminate = *nominals = *states = *has_next = false;
  *next = 0.0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

/* The flag may change at events only: ask for one where it is due. */
FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_set,
                                                   fmi3Boolean *enter_event, fmi3Boolean *terminate) {
  Unit *unit = (Unit *)instance;
  (void)no_set;
  *enter_event = (interpolate_pressure(unit).out_of_range != 0) != unit->state.out_of_range;
  *terminate = false;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  ((Unit *)instance)->state.time = time;
  return fmi3OK;
}

/* No continuous states, no event indicators. */
#define NO_STATES(Name, Type)                                                                      \
  FMI3_EXPORT fmi3Status fmi3##Name(fmi3Instance instance, Type values[], size_t n) {              \
    (void)values;                                                                                  \
    return n ? refuse((Unit *)instance, "no continuous states and no event indicators") : fmi3OK;  \
  }
NO_STATES(SetContinuousStates, const fmi3Float64)
NO_STATES(GetContinuousStates, fmi3Float64)
NO_STATES(GetContinuousStateDerivatives, fmi3Float64)
NO_STATES(GetNominalsOfContinuousStates, fmi3Float64)
NO_STATES(GetEventIndicators, fmi3Float64)

FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n) {
  (void)instance;
  *n = 0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n) {
  (void)instance;
  *n = 0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from, fmi3Float64 step,
                                  fmi3Boolean no_set, fmi3Boolean *event, fmi3Boolean *terminate,
                                  fmi3Boolean *early, fmi3Float64 *reached) {
  Unit *unit = (Unit *)instance;
  (void)no_set;
  unit->state.time = from + step;
  *event = *terminate = *early = false;
  *reached = unit->state.time;
  return fmi3OK;
}

/* ---- optional parts of the interface that modelDescription.xml does not announce ---- */

#define NOT_OFFERED(Name, ...)                                                                     \
  FMI3_EXPORT fmi3Status fmi3##Name(fmi3Instance instance, __VA_ARGS__) {                          \
    return refuse((Unit *)instance, "fmi3" #Name " is not offered by this unit");                  \
  }
#define VRS const fmi3ValueReference vr[], size_t n
NOT_OFFERED(GetOutputDerivatives, VRS, const fmi3Int32 orders[], fmi3Float64 v[], size_t m)
NOT_OFFERED(GetNumberOfVariableDependencies, fmi3ValueReference vr, size_t *n)
NOT_OFFERED(GetVariableDependencies, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[],
            size_t at[], fmi3DependencyKind kinds[], size_t n)
NOT_OFFERED(GetDirectionalDerivative, VRS, const fmi3ValueReference k[], size_t nk,
            const fmi3Float64 seed[], size_t ns, fmi3Float64 out[], size_t no)
NOT_OFFERED(GetAdjointDerivative, VRS, const fmi3ValueReference k[], size_t nk,
            const fmi3Float64 seed[], size_t ns, fmi3Float64 out[], size_t no)
NOT_OFFERED(GetIntervalDecimal, VRS, fmi3Float64 i[], fmi3IntervalQualifier q[])
NOT_OFFERED(GetIntervalFraction, VRS, fmi3UInt64 c[], fmi3UInt64 r[], fmi3IntervalQualifier q[])
NOT_OFFERED(GetShiftDecimal, VRS, fmi3Float64 s[])
NOT_OFFERED(GetShiftFraction, VRS, fmi3UInt64 c[], fmi3UInt64 r[])
NOT_OFFERED(SetIntervalDecimal, VRS, const fmi3Float64 i[])
NOT_OFFERED(SetIntervalFraction, VRS, const fmi3UInt64 c[], const fmi3UInt64 r[])
NOT_OFFERED(SetShiftDecimal, VRS, const fmi3Float64 s[])
NOT_OFFERED(SetShiftFraction, VRS, const fmi3UInt64 c[], const fmi3UInt64 r[])
NOT_OFFERED(ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}
