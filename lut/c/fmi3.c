/* The functions of FMI 3.0, Model Exchange and Co-Simulation. */
#include "fmi3.h"
#include "unit.h"

static fmi3Status say(fmi3LogMessageCallback log, fmi3InstanceEnvironment environment, const char *message) {
  if (log) log(environment, fmi3Error, "logStatusError", message);
  return fmi3Error;
}

/* The status of what is wrong, NULL where nothing is. */
static fmi3Status status(const Unit *unit, const char *wrong) {
  return wrong ? say((fmi3LogMessageCallback)unit->log, unit->environment, wrong) : fmi3OK;
}

static fmi3Instance instantiate(const char *token, const char *resources, bool model_exchange,
                                bool event_mode, fmi3InstanceEnvironment environment,
                                fmi3LogMessageCallback log) {
  const char *wrong;
  Unit *unit = new_unit(token, resources, &wrong);
  if (!unit) {
    say(log, environment, wrong);
    return NULL;
  }
  unit->log = (void (*)(void))log;
  unit->environment = environment;
  unit->model_exchange = model_exchange;
  unit->event_mode = event_mode;
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
  say(log, environment, "this unit has no scheduled execution");
  return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance) { free_unit((Unit *)instance); }

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                   fmi3Float64 tolerance, fmi3Float64 start,
                                                   fmi3Boolean has_stop, fmi3Float64 stop) {
  Unit *unit = (Unit *)instance;
  (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
  return status(unit, enter_initialization(unit, start));
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  Unit *unit = (Unit *)instance;
  return status(unit, exit_initialization(unit));
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
  unit->state.out_of_range = outside_now(unit);
  unit->phase = CONTINUOUS;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
  ((Unit *)instance)->phase = TERMINATED;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
  reset((Unit *)instance);
  return fmi3OK;
}

/* ---- variables ---- */

#define VARIABLES(Name, Type, get, set)                                                            \
  FMI3_EXPORT fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, Type values[], size_t n_values) {                 \
    const Unit *unit = (const Unit *)instance;                                                     \
    const char *wrong = n == n_values ? NULL : COUNTS;                                             \
    size_t i;                                                                                      \
    for (i = 0; i < n && !wrong; ++i) wrong = get(unit, vr[i], &values[i]);                        \
    return status(unit, wrong);                                                                    \
  }                                                                                                \
  FMI3_EXPORT fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, const Type values[], size_t n_values) {           \
    Unit *unit = (Unit *)instance;                                                                 \
    const char *wrong = n == n_values ? NULL : COUNTS;                                             \
    size_t i;                                                                                      \
    for (i = 0; i < n && !wrong; ++i) wrong = set(unit, vr[i], values[i]);                         \
    return status(unit, wrong);                                                                    \
  }
static const char COUNTS[] = "as many values as references are expected";
VARIABLES(Float64, fmi3Float64, get_real, set_real)
VARIABLES(Boolean, fmi3Boolean, get_boolean, set_boolean)

/* There are no variables of the other types: only an empty request is right. */
#define NO_VARIABLES(Name, Type)                                                                   \
  FMI3_EXPORT fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, Type values[], size_t n_values) {                 \
    (void)vr; (void)values; (void)n_values;                                                        \
    return status((Unit *)instance, n ? "no variables of type " #Name : NULL);                   \
  }                                                                                                \
  FMI3_EXPORT fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference vr[],       \
                                       size_t n, const Type values[], size_t n_values) {           \
    (void)vr; (void)values; (void)n_values;                                                        \
    return status((Unit *)instance, n ? "no variables of type " #Name : NULL);                   \
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
  return status((Unit *)instance, n ? "no variables of type Binary" : NULL);
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                     const size_t sizes[], const fmi3Binary values[],
                                     size_t n_values) {
  (void)vr; (void)sizes; (void)values; (void)n_values;
  return status((Unit *)instance, n ? "no variables of type Binary" : NULL);
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                    fmi3Clock values[]) {
  (void)vr; (void)values;
  return status((Unit *)instance, n ? "no clocks" : NULL);
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                    const fmi3Clock values[]) {
  (void)vr; (void)values;
  return status((Unit *)instance, n ? "no clocks" : NULL);
}

/* ---- saved states ---- */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  return status((Unit *)instance, save((Unit *)instance, state));
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return status((Unit *)instance, restore((Unit *)instance, state));
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
  return status((Unit *)instance, serialize(state, bytes, size));
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[],
                                               size_t size, fmi3FMUState *state) {
  return status((Unit *)instance, deserialize(bytes, size, state));
}

/* ---- events, Model Exchange, Co-Simulation ---- */

FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again,
                                                fmi3Boolean *terminate, fmi3Boolean *nominals,
                                                fmi3Boolean *states, fmi3Boolean *has_next,
                                                fmi3Float64 *next) {
  Unit *unit = (Unit *)instance;
  unit->state.out_of_range = outside_now(unit);
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
  *enter_event = outside_now(unit) != unit->state.out_of_range;
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
    return status((Unit *)instance, n ? "no continuous states and no event indicators" : NULL);  \
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
    return status((Unit *)instance, "fmi3" #Name " is not offered by this unit");                  \
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
