/* The functions of FMI 2.0, Model Exchange and Co-Simulation. */
#include "fmi2.h"
#include "unit.h"

static fmi2Status say(fmi2CallbackLogger log, void *environment, const char *name, const char *message) {
  /* No message has a percent sign. */
  if (log) log(environment, name, fmi2Error, "logStatusError", message);
  return fmi2Error;
}

/* The status of what is wrong, NULL where nothing is. */
static fmi2Status status(const Unit *unit, const char *wrong) {
  return wrong ? say((fmi2CallbackLogger)unit->log, unit->environment, unit->name, wrong) : fmi2OK;
}

static int digit(char c) {
  const char *digits = "0123456789abcdefABCDEF", *at = c ? strchr(digits, c) : NULL;
  int value = at ? (int)(at - digits) : -1;
  return value > 15 ? value - 6 : value;
}

/* The path of a file: URI, its %XX decoded; on Windows without the slash before the drive. */
static char *path_of(const char *uri) {
  char *path = (char *)malloc(strlen(uri) + 1), *to = path;
  if (!path) return NULL;
  if (strncmp(uri, "file:", 5) == 0) {
    uri += 5;
    if (strncmp(uri, "//", 2) == 0) {
      const char *slash = strchr(uri + 2, '/');
      uri = slash ? slash : uri + strlen(uri);
    }
#if defined(_WIN32)
    if (uri[0] == '/' && uri[1] && (uri[2] == ':' || uri[2] == '|')) ++uri;
#endif
  }
  for (; *uri; ++uri) {
    int high = *uri == '%' ? digit(uri[1]) : -1, low = high >= 0 ? digit(uri[2]) : -1;
    *to++ = (char)(low >= 0 ? 16 * high + low : *uri);
    if (low >= 0) uri += 2;
  }
  *to = 0;
  return path;
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                                           const fmi2String categories[]) {
  (void)component; (void)on; (void)n; (void)categories;
  return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  fmi2CallbackLogger log = functions ? functions->logger : NULL;
  void *environment = functions ? functions->componentEnvironment : NULL;
  char *folder = path_of(resources ? resources : "");
  size_t length = name ? strlen(name) : 0;
  char *copy = (char *)calloc(length + 1, 1);
  const char *wrong = NO_MEMORY;
  Unit *unit = folder && copy ? new_unit(guid, folder, &wrong) : NULL;
  (void)visible; (void)logging;
  free(folder);
  if (!unit) {
    say(log, environment, name ? name : "", wrong);
    free(copy);
    return NULL;
  }
  memcpy(copy, name ? name : "", length);
  unit->name = copy;
  unit->log = (void (*)(void))log;
  unit->environment = environment;
  unit->model_exchange = unit->event_mode = type == fmi2ModelExchange;
  return unit;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component component) {
  Unit *unit = (Unit *)component;
  if (unit) free((void *)unit->name);
  free_unit(unit);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
  ((Unit *)component)->state.time = start;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  Unit *unit = (Unit *)component;
  return status(unit, enter_initialization(unit, unit->state.time));
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  Unit *unit = (Unit *)component;
  return status(unit, exit_initialization(unit));
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
  ((Unit *)component)->phase = TERMINATED;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component component) {
  reset((Unit *)component);
  return fmi2OK;
}

/* ---- variables ---- */

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                   fmi2Real values[]) {
  const Unit *unit = (const Unit *)component;
  const char *wrong = NULL;
  size_t i;
  for (i = 0; i < n && !wrong; ++i) wrong = get_real(unit, vr[i], &values[i]);
  return status(unit, wrong);
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                   const fmi2Real values[]) {
  Unit *unit = (Unit *)component;
  const char *wrong = NULL;
  size_t i;
  for (i = 0; i < n && !wrong; ++i) wrong = set_real(unit, vr[i], values[i]);
  return status(unit, wrong);
}

FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                      fmi2Boolean values[]) {
  const Unit *unit = (const Unit *)component;
  const char *wrong = NULL;
  bool value = false;
  size_t i;
  for (i = 0; i < n && !wrong; ++i) {
    wrong = get_boolean(unit, vr[i], &value);
    values[i] = value;
  }
  return status(unit, wrong);
}

FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                      const fmi2Boolean values[]) {
  Unit *unit = (Unit *)component;
  const char *wrong = NULL;
  size_t i;
  for (i = 0; i < n && !wrong; ++i) wrong = set_boolean(unit, vr[i], values[i] != 0);
  return status(unit, wrong);
}

/* There are no variables of the other types: only an empty request is right. */
#define NO_VARIABLES(Name, Type)                                                                                \
  FMI2_EXPORT fmi2Status fmi2Get##Name(fmi2Component component, const fmi2ValueReference vr[], size_t n,        \
                                       Type values[]) {                                                         \
    (void)vr; (void)values;                                                                                     \
    return status((Unit *)component, n ? "no variables of type " #Name : NULL);                                 \
  }                                                                                                             \
  FMI2_EXPORT fmi2Status fmi2Set##Name(fmi2Component component, const fmi2ValueReference vr[], size_t n,        \
                                       const Type values[]) {                                                   \
    (void)vr; (void)values;                                                                                     \
    return status((Unit *)component, n ? "no variables of type " #Name : NULL);                                 \
  }
NO_VARIABLES(Integer, fmi2Integer)
NO_VARIABLES(String, fmi2String)

/* ---- saved states ---- */

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
  return status((Unit *)component, save((Unit *)component, state));
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return status((Unit *)component, restore((Unit *)component, state));
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
  (void)component;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
  (void)component; (void)state;
  *size = sizeof(Saved);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                             size_t size) {
  return status((Unit *)component, serialize(state, bytes, size));
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
  return status((Unit *)component, deserialize(bytes, size, state));
}

/* ---- Model Exchange: no continuous states, no event indicators ---- */

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component component) {
  ((Unit *)component)->phase = EVENT;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
  Unit *unit = (Unit *)component;
  unit->state.out_of_range = outside_now(unit);
  memset(info, 0, sizeof *info);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  Unit *unit = (Unit *)component;
  unit->state.out_of_range = outside_now(unit);
  unit->phase = CONTINUOUS;
  return fmi2OK;
}

/* The flag may change at events only: ask for one where it is due. */
FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean no_set,
                                                   fmi2Boolean *enter_event, fmi2Boolean *terminate) {
  Unit *unit = (Unit *)component;
  (void)no_set;
  *enter_event = outside_now(unit) != unit->state.out_of_range;
  *terminate = 0;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  ((Unit *)component)->state.time = time;
  return fmi2OK;
}

#define NO_STATES(Name, Type)                                                                                   \
  FMI2_EXPORT fmi2Status fmi2##Name(fmi2Component component, Type values[], size_t n) {                         \
    (void)values;                                                                                               \
    return status((Unit *)component, n ? "no continuous states and no event indicators" : NULL);                \
  }
NO_STATES(SetContinuousStates, const fmi2Real)
NO_STATES(GetContinuousStates, fmi2Real)
NO_STATES(GetDerivatives, fmi2Real)
NO_STATES(GetNominalsOfContinuousStates, fmi2Real)
NO_STATES(GetEventIndicators, fmi2Real)

/* ---- Co-Simulation ---- */

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real from, fmi2Real step, fmi2Boolean no_set) {
  (void)no_set;
  ((Unit *)component)->state.time = from + step;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component component) {
  return status((Unit *)component, "no step is pending");
}

/* ---- parts of the interface that modelDescription.xml does not announce ---- */

#define NOT_OFFERED(Name, ...)                                                                                  \
  FMI2_EXPORT fmi2Status fmi2##Name(fmi2Component component, __VA_ARGS__) {                                     \
    return status((Unit *)component, "fmi2" #Name " is not offered by this unit");                              \
  }
#define VRS const fmi2ValueReference vr[], size_t n
NOT_OFFERED(GetDirectionalDerivative, const fmi2ValueReference of[], size_t n, const fmi2ValueReference by[],
            size_t m, const fmi2Real seed[], fmi2Real out[])
NOT_OFFERED(SetRealInputDerivatives, VRS, const fmi2Integer orders[], const fmi2Real v[])
NOT_OFFERED(GetRealOutputDerivatives, VRS, const fmi2Integer orders[], fmi2Real v[])
NOT_OFFERED(GetStatus, fmi2StatusKind kind, fmi2Status *value)
NOT_OFFERED(GetRealStatus, fmi2StatusKind kind, fmi2Real *value)
NOT_OFFERED(GetIntegerStatus, fmi2StatusKind kind, fmi2Integer *value)
NOT_OFFERED(GetBooleanStatus, fmi2StatusKind kind, fmi2Boolean *value)
NOT_OFFERED(GetStringStatus, fmi2StatusKind kind, fmi2String *value)
