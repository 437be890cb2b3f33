"""Types of the compiled module; every function works in SI units."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, SupportsFloat, SupportsIndex, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | PathLike[str]
_Float = SupportsFloat | SupportsIndex
_Names = str | Sequence[str] | None
_Value = float | bool | str | np.generic | Sequence[Any] | NDArray[Any] | None
_Progress = Callable[[str], object] | None
_Quantity = Literal[
    "p_max", "p_mean", "area", "length", "width", "approach",
    "mu", "mu_ploughing", "mu_viscous", "mu_boundary", "groove_depth", "film_mean",
]
_Mode = Literal["smooth", "bilinear"]

@final
class Case:
    """One contact problem: runner, ice, track and load."""

    def __new__(
        cls, text: str, folder: _Path = "", *, name: str = "the case", hull: Hull | None = None
    ) -> Case:
        """
        A case from TOML; a hull's path starts from `folder`. `hull` replaces the file that
        `runner.hull` names; messages call the case `name`.
        """
    @staticmethod
    def of(
        hull: Hull, values: Mapping[str, _Value] | None = None
    ) -> Case:
        """
        A hull on the ice of the example under 1 kN, with other values by dotted key: `Case.of(hull,
        {"load.fz_n": 2000.0})`.
        """
    @staticmethod
    def read(path: _Path) -> Case:
        """Reads a case file."""
    @staticmethod
    def example() -> Case:
        """
        The case that the command solves where none is given: a bobsled runner on flat ice under 1
        kN.
        """
    def replace(self, values: Mapping[str, _Value]) -> Case:
        """
        The case with other values, by dotted key: `case.replace({"load.fz_n": 2000.0})`. None
        removes a key.
        """
    def to_toml(self) -> str:
        """The case as TOML."""
    @property
    def name(self) -> str:
        """Name of the case in messages: its file name."""

@final
class Contact:
    """A solved case."""

    @property
    def p_max_pa(self) -> float:
        """Peak pressure [Pa]."""
    @property
    def p_max_error_pa(self) -> float:
        """Error of the peak pressure, including that of a scan [Pa]."""
    @property
    def p_mean_pa(self) -> float:
        """Mean pressure: ratio of force to contact area [Pa]."""
    @property
    def p_mean_error_pa(self) -> float:
        """Error of the mean pressure [Pa]."""
    @property
    def area_m2(self) -> float:
        """Contact area [m2]."""
    @property
    def area_error_m2(self) -> float:
        """Error of the area [m2]."""
    @property
    def length_m(self) -> float:
        """Extent of the contact along the runner [m]."""
    @property
    def length_error_m(self) -> float:
        """Error of the length [m]."""
    @property
    def width_m(self) -> float:
        """Extent of the contact across the runner [m]."""
    @property
    def width_error_m(self) -> float:
        """Error of the width [m]."""
    @property
    def approach_m(self) -> float:
        """Rigid approach at the origin, from first touch [m]."""
    @property
    def approach_error_m(self) -> float:
        """Error of the approach [m]."""
    @property
    def pitch_rad(self) -> float:
        """Pitch about y, positive lowers the nose [rad]."""
    @property
    def pitch_error_rad(self) -> float:
        """Error of the pitch [rad]."""
    @property
    def roll_rad(self) -> float:
        """Roll about x [rad]."""
    @property
    def roll_error_rad(self) -> float:
        """Error of the roll [rad]."""
    @property
    def fz_n(self) -> float:
        """Integrated normal force [N]."""
    @property
    def max_shear_pa(self) -> float | None:
        """
        Largest shear stress in the ice under the peak; None where it was not requested or does not
        lie under the surface [Pa].
        """
    @property
    def max_shear_error_pa(self) -> float | None:
        """Error of the largest shear stress [Pa]."""
    @property
    def max_shear_depth_m(self) -> float | None:
        """Depth of the largest shear stress [m]."""
    @property
    def max_shear_depth_error_m(self) -> float | None:
        """Error of the depth of the largest shear stress [m]."""
    @property
    def x_m(self) -> NDArray[np.float64]:
        """Node coordinates along the runner, increasing [m]."""
    @property
    def y_m(self) -> NDArray[np.float64]:
        """Node coordinates across the runner, increasing [m]."""
    @property
    def pressure_pa(self) -> NDArray[np.float64]:
        """
        Contact pressure at the nodes, `len(y_m)` rows of `len(x_m)` [Pa]. The nodes are not evenly
        spaced; `map` has the pressure on an even grid, whose sum is the force.
        """
    @property
    def gap_m(self) -> NDArray[np.float64]:
        """Gap at the nodes, 0 within rounding in contact, infinite where there is no hull [m]."""
    @property
    def uz_m(self) -> NDArray[np.float64]:
        """Vertical displacement of the ice's surface at the nodes, upwards positive [m]."""
    @property
    def groove_m(self) -> NDArray[np.float64] | None:
        """Plastic depth of the ice at the nodes, None for a runner at rest [m]."""
    @property
    def warnings(self) -> list[str]:
        """Warnings and remarks."""
    @property
    def result(self) -> dict[str, Any]:
        """
        What the command writes to `result.json`, the case and the history included. Keys that only
        written files have, `p_max_map_pa` and `stress_max_pa`, are absent.
        """
    def map(self) -> dict[str, NDArray[np.float64]]:
        """
        Arrays by name on an even grid around the contact, as in `result.mat`: `x_m`, `y_m`, and
        `len(y_m)` rows of `len(x_m)` of `pressure_pa`, `gap_m` and `uz_m`. The sum of `pressure_pa`
        times the area of a pixel is `fz_n`. A contact from a pickle has no map.
        """
    def write(self, folder: _Path, *, mat: bool = False) -> None:
        """
        Writes what `kufe press` writes into `folder`, which must be new or empty; all files or
        none. `mat` adds `result.mat`. A contact from a pickle has no meshes to write.
        """
    def plot(self, ax: Any = None) -> Any:
        """
        Draws the pressure over the contact plane with matplotlib, on `ax` or new axes; returns the
        axes.
        """
    def to_xarray(self) -> Any:
        """
        The fields as an `xarray.Dataset` over `y_m` and `x_m`, units in the attributes; needs
        xarray.
        """
    def to_dataframe(self) -> Any:
        """The fields as a `pandas.DataFrame`, one row per node; needs pandas."""

@final
class Hull:
    """Triangles of a runner, x forward and z up."""

    def __new__(cls, vertices_m: ArrayLike, triangles: ArrayLike) -> Hull:
        """
        A hull of arrays: one row per vertex [m], one row of three vertex indices per triangle,
        counter-clockwise seen from outside.
        """
    @staticmethod
    def from_heights(
        x_m: ArrayLike, y_m: ArrayLike, heights_m: ArrayLike
    ) -> Hull:
        """
        The underside of a measured height map: `heights_m` has `len(y_m)` rows of `len(x_m)`, z up;
        what is masked or not finite was not measured.
        """
    @staticmethod
    def read(
        path: _Path, *, scale: _Float = 1.0, up: str | None = None, forward: str = "x"
    ) -> Hull:
        """
        Reads and checks an OBJ, glTF, STL or 3MF file; `scale` is metres a unit of the file (0.001
        for millimetres), `up` and `forward` its axes (`"z"`, `"-x"`; up is y in glTF and z
        elsewhere where absent).
        """
    @staticmethod
    def bob(
        *,
        length_m: _Float = 1.0,
        rocker_radius_m: _Float = 30.0,
        section_radius_m: _Float = 0.005,
        width_m: _Float = 0.010,
        height_m: _Float = 0.030,
        edge_length_m: _Float = 0.0005,
    ) -> Hull:
        """
        A bobsled runner: a round section swept along a rocker, with rounded ends; `edge_length_m`
        is that of the triangles on the underside.
        """
    @staticmethod
    def luge(
        *,
        length_m: _Float = 0.6,
        rocker_radius_m: _Float = 25.0,
        edge_radius_m: _Float = 0.0003,
        tilt_rad: _Float = 0.02,
        width_m: _Float = 0.020,
        height_m: _Float = 0.008,
        edge_length_m: _Float = 0.0005,
    ) -> Hull:
        """A luge steel on its rounded edge."""
    def write(self, path: _Path) -> None:
        """Writes the hull as .obj, .glb or .stl, in metres; a file is written completely or not at all."""
    @property
    def vertices_m(self) -> NDArray[np.float64]:
        """Vertex positions, one row per vertex [m]."""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Vertex indices of each triangle, counter-clockwise seen from outside."""
    @property
    def extent_m(self) -> tuple[float, float, float]:
        """Size along x, y and z [m]."""
    @property
    def volume_m3(self) -> float:
        """Enclosed volume; not meaningful for an open hull [m3]."""
    @property
    def warnings(self) -> list[str]:
        """Warnings about the hull."""

@final
class HullCheck:
    """Check of a scanned hull: options to read its file, and the loads that it resolves."""

    @property
    def result(self) -> dict[str, Any]:
        """
        What `kufe hull check --json` prints: scale, axes, angles [rad], size, spacing and noise
        [m], and by load whether the peak pressure is known well enough.
        """
    @property
    def warnings(self) -> list[str]:
        """Warnings about the hull."""
    def case(self) -> Case:
        """
        The case that reads the hull so, on the ice of the example under the force that is nearest
        to 1 kN.
        """

@final
class Table:
    """Lookup table of contact quantities over normal force, track curvature and further axes."""

    @staticmethod
    def read(path: _Path) -> Table:
        """Reads a `.lut` file."""
    def write(self, path: _Path) -> None:
        """Writes the `.lut` file; it is written completely or not at all."""
    def values(self, quantity: _Quantity = "p_max") -> NDArray[np.float64]:
        """
        Figures at the nodes: an array over force, curvature and, where the table has those axes,
        rocker radius, speed and temperature of the ice.
        """
    def lookup(
        self,
        fz_n: ArrayLike,
        curvature_1pm: ArrayLike,
        quantity: _Quantity = "p_max",
        *,
        v_mps: ArrayLike | None = None,
        ice_c: ArrayLike | None = None,
        mode: _Mode = "smooth",
        rocker_radius_m: ArrayLike | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """
        One quantity at forces [N], curvatures [1/m] and, where the table has those axes, speeds
        [m/s], temperatures of the ice [C] and rocker radii [m], which are broadcast; its errors, of
        the interpolation and, where known, of the solver (NaN where neither is known); and where an
        input was outside the table: the rules of the axes then replace it, and the error is that
        within. NaN and masked inputs give NaN and the flag. A rocker radius outside is refused.
        """
    def interpolation_error(
        self, quantity: _Quantity = "p_max", *, mode: _Mode = "smooth"
    ) -> float | None:
        """
        Largest relative interpolation error measured between the nodes; None where none was
        measured.
        """
    @property
    def fz_n(self) -> NDArray[np.float64]:
        """Breakpoints of the normal force [N]."""
    @property
    def curvature_1pm(self) -> NDArray[np.float64]:
        """
        Track curvatures of the nodes, positive in a valley [1/m]: breakpoints, or `len(fz_n)` rows
        where the table's axis is the reduced curvature, whose track curvature depends on the force.
        """
    @property
    def reduced_curvature(self) -> NDArray[np.float64] | None:
        """Breakpoints of the reduced curvature, from 0 to 1, where the table has that axis."""
    @property
    def rocker_radius_m(self) -> NDArray[np.float64] | None:
        """Breakpoints of the rocker radius, if the table has that axis [m]."""
    @property
    def v_mps(self) -> NDArray[np.float64] | None:
        """Breakpoints of the speed, if the table has that axis [m/s]."""
    @property
    def ice_c(self) -> NDArray[np.float64] | None:
        """Breakpoints of the temperature of the ice, if the table has that axis [C]."""
    @property
    def solver_error(self) -> float:
        """
        Largest estimated solver error over the nodes, relative: of the peak pressure, or of mu
        where the runner slides.
        """
    @property
    def shortfall(self) -> str | None:
        """
        Where the interpolation is less accurate than the table file requests; None where it is not,
        and for a table that was read.
        """
    @property
    def quantities(self) -> list[_Quantity]:
        """Names of the quantities that the table holds."""
    def to_xarray(self, quantity: _Quantity = "p_max") -> Any:
        """
        One quantity at the nodes as an `xarray.DataArray` over the table's axes, with the track
        curvatures of the nodes as a coordinate; needs xarray.
        """
    def to_dataframe(self) -> Any:
        """
        Every quantity as a `pandas.DataFrame`, one row a node, with the track curvature of each;
        needs pandas.
        """

@final
class Simulation:
    """Simulated runs of one driver on one track."""

    @property
    def runs(self) -> list[dict[str, Any]]:
        """
        One dictionary per run, as in `simulation.json`: `run`, `time_s` [s], `finished`, energies
        [J].
        """
    @property
    def result(self) -> dict[str, Any]:
        """Content of `simulation.json`."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the runs."""
    def series(self, run: str) -> dict[str, NDArray[np.float64]]:
        """One run's channels as arrays, `t_s` among them; each name ends in its unit."""
    def write(self, folder: _Path, *, parquet: bool = False) -> None:
        """
        Writes `runs.csv`, one file a run and the table of the track into `folder`, which must be
        new or empty; all files or none. `parquet` writes Parquet instead of CSV.
        """

@final
class Replay:
    """Replay of a measured run by the model, compared with the measurement."""

    @property
    def differences(self) -> list[dict[str, Any]]:
        """
        Differences of run and model, one dictionary per column: `rms`, `end`, `largest` in the
        column's unit, measured minus model.
        """
    @property
    def sections(self) -> list[dict[str, Any]]:
        """
        Sections where they differ, one dictionary per section: `from_m`, `to_m` [m], and `lost_s`, the time that
        the run loses there [s].
        """
    @property
    def result(self) -> dict[str, Any]:
        """Content of `simulation.json`."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the run."""
    def series(self) -> dict[str, NDArray[np.float64]]:
        """
        The model's channels as arrays, `t_s` among them, and what was measured at the same places:
        `v_measured_mps` and the like, NaN where nothing was.
        """
    def write(self, folder: _Path, *, parquet: bool = False) -> None:
        """
        Writes `runs.csv`, the run and the table of the track into `folder`, which must be new or
        empty; all files or none. `parquet` writes Parquet instead of CSV.
        """

@final
class Fit:
    """Lateral friction of both runners, fitted to recorded runs."""

    @property
    def front(self) -> dict[str, Any]:
        """
        The front runner's law: each parameter with `value`, `low` and `high`, as in `fit.json`.
        """
    @property
    def rear(self) -> dict[str, Any]:
        """The rear runner's law."""
    @property
    def result(self) -> dict[str, Any]:
        """Content of `fit.json`."""
    @property
    def model(self) -> str:
        """The model with the fitted laws: TOML that every command accepts."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the runs."""

@final
class Validation:
    """Lateral forces of a model compared with those of recorded runs."""

    @property
    def runs(self) -> list[dict[str, Any]]:
        """
        One dictionary per run, as in `validation.json`: `rmse_n` is the root mean square difference
        of the lateral force [N].
        """
    @property
    def tracks(self) -> list[dict[str, Any]]:
        """One dictionary per track, with the errors over its runs."""
    @property
    def result(self) -> dict[str, Any]:
        """Content of `validation.json`."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the runs."""
    def series(self, run: str) -> dict[str, NDArray[np.float64]]:
        """
        One run's samples as arrays: time [s], place [m], and the lateral force at the centre of
        gravity [N] as measured, of the model, and of Braghin's law.
        """

@final
class Evaluation:
    """Losses of drivers compared with a straight glide."""

    @property
    def runs(self) -> list[dict[str, Any]]:
        """One dictionary per run, as in `evaluation.json`."""
    @property
    def groups(self) -> list[dict[str, Any]]:
        """
        Means by driver and by track, each with its 95 % interval over runs, as in
        `evaluation.json`.
        """
    @property
    def drivers(self) -> list[dict[str, Any]]:
        """
        The time that each driver loses on each track, `lost_s`, and along it, `stretches`; one
        dictionary a driver and track.
        """
    @property
    def result(self) -> dict[str, Any]:
        """Content of `evaluation.json`."""
    @property
    def left_out(self) -> list[str]:
        """Excluded runs, with the reason."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the runs."""
    def series(self, run: str) -> dict[str, NDArray[np.float64]]:
        """
        One run's samples as arrays: time, place, force along the motion as driven and of a straight
        glide, angles.
        """

@final
class Discovery:
    """Result of a search for effects that are missing in a model."""

    @property
    def verdict(self) -> str:
        """
        The verdict: named, one-of, law, depends-on, located, not-identifiable,
        inadequate or none.
        """
    @property
    def sentence(self) -> str:
        """The outcome as a sentence."""
    @property
    def report(self) -> dict[str, Any]:
        """Content of `report.json`."""
    @property
    def next_model(self) -> str | None:
        """The model with the added effects, as TOML; None for a `quick` search."""
    @property
    def next_case(self) -> str | None:
        """
        The next case, as its file's text, where a campaign has pressures and other data; else None.
        """
    @property
    def html(self) -> str:
        """The report as an HTML page."""

def press(
    case: Case | Hull | _Path,
    *,
    accuracy: _Float | None = None,
    subsurface: bool = False,
    progress: _Progress = None,
) -> Contact:
    """Solve one contact problem."""

def slide(
    case: Case | Hull | _Path,
    v_mps: _Float,
    ice_c: _Float,
    *,
    accuracy: _Float | None = None,
    progress: _Progress = None,
) -> Contact:
    """Solve steady sliding on ice that yields: groove, melt film and friction."""

def fill_table(
    table: _Path,
    out: _Path | None = None,
    *,
    case: Case | Hull | _Path | None = None,
    progress: _Progress = None,
) -> Table:
    """
    Solve the table that a table file specifies and write it; resumes after an interruption. `case`
    replaces the case that the file names.
    """

def check_hull(
    path: _Path,
    fz_n: ArrayLike = (250.0, 500.0, 1000.0, 2000.0, 4000.0),
    *,
    p_max: _Float | None = None,
    progress: _Progress = None,
) -> HullCheck:
    """
    Examine the hull of a scanner under normal forces [N]; `p_max` is the relative error of the peak
    pressure for which it is examined; where absent 0.05, or 0.01 for a hull without noise.
    """

def friction(
    case: Case | Hull | _Path,
    v_mps: _Float,
    *,
    alpha_rad: _Float = 0.0,
    model: _Path | None = None,
    ice_c: _Float | None = None,
    air_c: _Float | None = None,
    air_pa: _Float | None = None,
    humidity_pct: _Float | None = None,
    progress: _Progress = None,
) -> dict[str, Any]:
    """Solve a contact and evaluate a friction law at its peak pressure."""

def friction_table(
    case: Case | Hull | _Path,
    v_mps: ArrayLike,
    ice_c: ArrayLike,
    *,
    progress: _Progress = None,
) -> list[dict[str, Any]]:
    """
    Solve the friction of groove and melt film at every speed [m/s] on ice of every temperature [C].

    Where a requested accuracy is not reached, `NotConvergedError.best` is this list.
    """

def simulate(
    model: _Path,
    track: _Path,
    *,
    runs: SupportsIndex = 1,
    driver: str | None = None,
    skill: _Float = 0.9,
    seed: SupportsIndex = 1,
    noise: bool = True,
    start_speed_mps: _Float = 10.0,
    rate_hz: _Float = 500.0,
    step_s: _Float = 0.001,
    most_s: _Float = 600.0,
    ice_c: _Float = -8.0,
    air_c: _Float = 0.0,
    air_pa: _Float = 95000.0,
    humidity_pct: _Float | None = None,
    distance_m: _Float | None = None,
    session: str = "1",
    progress: _Progress = None,
) -> Simulation:
    """Drive a sled down a track and record it like a measured run."""

def replay(
    model: _Path,
    track: _Path,
    runs: _Path,
    *,
    run: str,
    strict: bool = False,
    rate_hz: _Float = 500.0,
    step_s: _Float = 0.001,
    most_s: _Float = 600.0,
    progress: _Progress = None,
) -> Replay:
    """
    Drive the model with the start and the steering of the run of this name in `runs`, an index, and
    compare both.
    """

def import_runs(
    mapping: _Path, folder: _Path, *, strict: bool = False, progress: _Progress = None
) -> dict[str, Any]:
    """
    Import recordings of other programs into a new folder; returns the content of `import.json`,
    with the runs that cannot be imported under `excluded`.
    """

def fit(
    runs: _Path,
    model: _Path,
    *,
    keep_contacts: bool = False,
    session: _Names = None,
    track: _Names = None,
    leave_out_bad_runs: bool = False,
    strict: bool = False,
    cutoff_hz: _Float = 20.0,
    progress: _Progress = None,
) -> Fit:
    """Fit the lateral friction of both runners to recorded runs."""

def validate(
    runs: _Path,
    model: _Path,
    *,
    fit: Fit | _Path | None = None,
    session: _Names = None,
    track: _Names = None,
    leave_out_bad_runs: bool = False,
    strict: bool = False,
    cutoff_hz: _Float = 20.0,
    progress: _Progress = None,
) -> Validation:
    """
    Compare the lateral forces of a model, or of a fit, with recorded runs that the fit has not
    seen.
    """

def report(result: _Path) -> str:
    """
    The page of a folder that a command or `Contact.write` has written, or of a lookup table, as
    HTML.
    """

def evaluate(
    runs: _Path,
    model: _Path,
    *,
    session: _Names = None,
    track: _Names = None,
    leave_out_bad_runs: bool = False,
    strict: bool = False,
    cutoff_hz: _Float = 20.0,
    seed: SupportsIndex = 1,
    progress: _Progress = None,
) -> Evaluation:
    """Evaluate recorded runs."""

def discover(
    data: _Path,
    model: _Path | None = None,
    *,
    seed: SupportsIndex = 1,
    twins: SupportsIndex = 40,
    channels: Literal["all", "lateral", "longitudinal"] = "all",
    only: _Names = None,
    quick: bool = False,
    progress: _Progress = None,
) -> Discovery:
    """Find an effect that is missing in a model, and name it."""
