"""Contact pressure, lookup tables, evaluation and discovery for bobsled and luge runners on ice.

Units are SI, and every name carries its unit: ``fz_n``, ``p_max_pa``, ``curvature_1pm``. Axes: x forward, y left, z up.

    >>> import kufe
    >>> contact = kufe.press(kufe.Case.example())
    >>> 137e6 < contact.p_max_pa < 140e6
    True

The number of threads is that of the cores, or ``RAYON_NUM_THREADS``.
"""

from ._errors import Error, InputError, NotConvergedError
from ._kufe import (
    Case,
    Contact,
    Discovery,
    Evaluation,
    Fit,
    Hull,
    HullCheck,
    Replay,
    Simulation,
    Table,
    Validation,
    __version__,
    check_hull,
    discover,
    evaluate,
    fill_table,
    fit,
    friction,
    friction_table,
    import_runs,
    press,
    replay,
    report,
    simulate,
    slide,
    validate,
)

__all__ = [
    "Case",
    "Contact",
    "Discovery",
    "Error",
    "Evaluation",
    "Fit",
    "Hull",
    "HullCheck",
    "InputError",
    "NotConvergedError",
    "Replay",
    "Simulation",
    "Table",
    "Validation",
    "__version__",
    "check_hull",
    "discover",
    "evaluate",
    "fill_table",
    "fit",
    "friction",
    "friction_table",
    "import_runs",
    "press",
    "replay",
    "report",
    "simulate",
    "slide",
    "validate",
]
