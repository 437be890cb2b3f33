"""Types of the compiled module; every function works in SI units."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | PathLike[str]
_Progress = Callable[[str], object] | None
_Quantity = Literal[
    "p_max", "p_mean", "area", "length", "width", "approach",
    "mu", "mu_ploughing", "mu_viscous", "mu_boundary", "groove_depth", "film_mean",
]
_Mode = Literal["smooth", "bilinear"]

class Error(Exception):
    """What every failure of this package is; the text is the one that the command prints."""

class InputError(Error):
    """A file, or a value in it, is wrong, or a file cannot be written."""

class NotConvergedError(Error):
    """An iteration stopped short of the requested accuracy."""

@final
class Case:
    """One contact problem: runner, ice, track and load."""

    def __new__(cls, text: str, folder: _Path = "") -> Case: ...
    @staticmethod
    def read(path: _Path) -> Case: ...
    @staticmethod
    def example() -> Case: ...
    def replace(self, values: Mapping[str, float | int | bool | str]) -> Case: ...
    def to_toml(self) -> str: ...
    @property
    def name(self) -> str: ...

@final
class Contact:
    """A solved case."""

    @property
    def p_max_pa(self) -> float: ...
    @property
    def p_max_error_pa(self) -> float: ...
    @property
    def p_mean_pa(self) -> float: ...
    @property
    def p_mean_error_pa(self) -> float: ...
    @property
    def area_m2(self) -> float: ...
    @property
    def area_error_m2(self) -> float: ...
    @property
    def length_m(self) -> float: ...
    @property
    def length_error_m(self) -> float: ...
    @property
    def width_m(self) -> float: ...
    @property
    def width_error_m(self) -> float: ...
    @property
    def approach_m(self) -> float: ...
    @property
    def approach_error_m(self) -> float: ...
    @property
    def pitch_rad(self) -> float: ...
    @property
    def pitch_error_rad(self) -> float: ...
    @property
    def roll_rad(self) -> float: ...
    @property
    def roll_error_rad(self) -> float: ...
    @property
    def fz_n(self) -> float: ...
    @property
    def max_shear_pa(self) -> float | None: ...
    @property
    def max_shear_error_pa(self) -> float | None: ...
    @property
    def max_shear_depth_m(self) -> float | None: ...
    @property
    def max_shear_depth_error_m(self) -> float | None: ...
    @property
    def x_m(self) -> NDArray[np.float64]: ...
    @property
    def y_m(self) -> NDArray[np.float64]: ...
    @property
    def pressure_pa(self) -> NDArray[np.float64]: ...
    @property
    def gap_m(self) -> NDArray[np.float64]: ...
    @property
    def uz_m(self) -> NDArray[np.float64]: ...
    @property
    def groove_m(self) -> NDArray[np.float64] | None: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def result(self) -> dict[str, Any]: ...

@final
class Hull:
    """Triangles of a runner, x forward and z up."""

    @staticmethod
    def read(
        path: _Path, *, scale: float = 1.0, up: str | None = None, forward: str = "x"
    ) -> Hull: ...
    @staticmethod
    def bob(
        *,
        length_m: float = 1.0,
        rocker_radius_m: float = 30.0,
        section_radius_m: float = 0.005,
        width_m: float = 0.010,
        height_m: float = 0.030,
        edge_length_m: float = 0.0005,
    ) -> Hull: ...
    @staticmethod
    def luge(
        *,
        length_m: float = 0.6,
        rocker_radius_m: float = 25.0,
        edge_radius_m: float = 0.0003,
        tilt_rad: float = 0.02,
        width_m: float = 0.020,
        height_m: float = 0.008,
        edge_length_m: float = 0.0005,
    ) -> Hull: ...
    def write(self, path: _Path) -> None: ...
    @property
    def vertices_m(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def extent_m(self) -> tuple[float, float, float]: ...
    @property
    def volume_m3(self) -> float: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Table:
    """Contact figures over normal force and track curvature."""

    @staticmethod
    def read(path: _Path) -> Table: ...
    def write(self, path: _Path) -> None: ...
    def values(self, quantity: _Quantity = "p_max") -> NDArray[np.float64]: ...
    def lookup(
        self,
        fz_n: ArrayLike,
        curvature_1pm: ArrayLike,
        quantity: _Quantity = "p_max",
        *,
        v_mps: ArrayLike | None = None,
        ice_c: ArrayLike | None = None,
        mode: _Mode = "smooth",
        rocker_radius_m: float | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]: ...
    def interpolation_error(
        self, quantity: _Quantity = "p_max", *, mode: _Mode = "smooth"
    ) -> float | None: ...
    @property
    def fz_n(self) -> NDArray[np.float64]: ...
    @property
    def curvature_1pm(self) -> NDArray[np.float64]: ...
    @property
    def rocker_radius_m(self) -> NDArray[np.float64] | None: ...
    @property
    def v_mps(self) -> NDArray[np.float64] | None: ...
    @property
    def ice_c(self) -> NDArray[np.float64] | None: ...
    @property
    def solver_error(self) -> float: ...
    @property
    def shortfall(self) -> str | None: ...

@final
class Evaluation:
    """What drivers lose compared with a straight glide."""

    @property
    def runs(self) -> list[dict[str, Any]]: ...
    @property
    def groups(self) -> list[dict[str, Any]]: ...
    @property
    def left_out(self) -> list[str]: ...
    @property
    def remarks(self) -> list[str]: ...
    def series(self, run: str) -> dict[str, NDArray[np.float64]]: ...

@final
class Discovery:
    """Effects that the model does not have, by data."""

    @property
    def verdict(self) -> str: ...
    @property
    def sentence(self) -> str: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def next_model(self) -> str: ...
    @property
    def next_case(self) -> str | None: ...
    @property
    def html(self) -> str: ...

def press(
    case: Case | _Path,
    *,
    accuracy: float | None = None,
    subsurface: bool = False,
    progress: _Progress = None,
) -> Contact:
    """Solve one contact problem."""

def slide(
    case: Case | _Path,
    v_mps: float,
    ice_c: float,
    *,
    accuracy: float | None = None,
    progress: _Progress = None,
) -> Contact:
    """Solve steady sliding on ice that yields: groove, melt film and friction."""

def fill_table(
    table: _Path, out: _Path | None = None, *, progress: _Progress = None
) -> Table:
    """Solve the table that a table file asks for and write it; resumes after an interruption."""

def evaluate(
    runs: _Path,
    model: _Path,
    *,
    session: Sequence[str] = (),
    track: Sequence[str] = (),
    leave_out_bad_runs: bool = False,
    strict: bool = False,
    cutoff_hz: float = 20.0,
    seed: int = 1,
    progress: _Progress = None,
) -> Evaluation:
    """Evaluate recorded runs."""

def discover(
    data: _Path,
    model: _Path | None = None,
    *,
    seed: int = 1,
    twins: int = 40,
    channels: Literal["all", "lateral", "longitudinal"] = "all",
    only: Sequence[str] = (),
    progress: _Progress = None,
) -> Discovery:
    """Find the effect that a model does not have and name it."""
