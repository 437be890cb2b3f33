"""Pictures and tables of results with matplotlib, xarray and pandas, which are optional."""

import html

import numpy as np

from ._kufe import Contact, Table

FIELDS = {"pressure_pa": "Pa", "gap_m": "m", "uz_m": "m", "groove_m": "m"}
AXES = ("rocker_radius_m", "v_mps", "ice_c")
FIGURES = [
    ("peak pressure", "p_max", "pa", 1e-6, "MPa"),
    ("mean pressure", "p_mean", "pa", 1e-6, "MPa"),
    ("contact area", "area", "m2", 1e6, "mm2"),
    ("contact length", "length", "m", 1e3, "mm"),
    ("contact width", "width", "m", 1e3, "mm"),
    ("approach", "approach", "m", 1e6, "um"),
]


def fields(contact):
    """The available fields of a contact by name."""
    found = {name: getattr(contact, name) for name in FIELDS}
    return {name: values for name, values in found.items() if values is not None}


def plot_contact(contact, ax):
    """Draw the pressure in MPa over the contact plane in mm."""
    import matplotlib.pyplot as plt

    if ax is None:
        ax = plt.figure(figsize=(9, 3), layout="constrained").add_subplot()
    pressure = np.where(contact.pressure_pa > 0, contact.pressure_pa, np.nan)
    x, y = 1e3 * contact.x_m, 1e3 * contact.y_m
    mesh = ax.pcolormesh(x, y, 1e-6 * pressure, shading="nearest", cmap="viridis", vmin=0.0)
    touching = np.isfinite(pressure)
    for limit, values in ((ax.set_xlim, x[touching.any(axis=0)]), (ax.set_ylim, y[touching.any(axis=1)])):
        margin = 0.1 * (values.max() - values.min())
        limit(values.min() - margin, values.max() + margin)
    ax.set_xlabel("x along the runner [mm]")
    ax.set_ylabel("y across [mm]")
    ax.set_title(f"peak pressure {contact.p_max_pa / 1e6:.2f} +- {contact.p_max_error_pa / 1e6:.2f} MPa")
    ax.figure.colorbar(mesh, ax=ax, label="contact pressure [MPa]")
    return ax


def contact_to_html(contact):
    """Results with their errors as an HTML table for notebooks."""
    rows = ""
    for label, name, unit, scale, shown in FIGURES:
        value = scale * getattr(contact, f"{name}_{unit}")
        error = scale * getattr(contact, f"{name}_error_{unit}")
        rows += f"<tr><td>{label}</td><td>{value:.5g} &plusmn; {error:.2g}</td><td>{shown}</td></tr>"
    warnings = "".join(f"<li>{html.escape(text)}</li>" for text in contact.warnings)
    return f"<table>{rows}</table>" + (f"<ul>{warnings}</ul>" if warnings else "")


def contact_to_xarray(contact):
    """The fields over y and x, with the results as attributes."""
    import xarray

    data = {name: (("y_m", "x_m"), values, {"units": FIELDS[name]}) for name, values in fields(contact).items()}
    axes = {name: (name, getattr(contact, name), {"units": "m"}) for name in ("x_m", "y_m")}
    figures = {f"{name}_{unit}": getattr(contact, f"{name}_{unit}") for _, name, unit, _, _ in FIGURES}
    errors = {f"{name}_error_{unit}": getattr(contact, f"{name}_error_{unit}") for _, name, unit, _, _ in FIGURES}
    return xarray.Dataset(data, axes, {**figures, **errors})


def contact_to_dataframe(contact):
    """One row per node: coordinates and fields."""
    import pandas

    y, x = np.meshgrid(contact.y_m, contact.x_m, indexing="ij")
    columns = {"x_m": x.ravel(), "y_m": y.ravel()}
    columns.update((name, values.ravel()) for name, values in fields(contact).items())
    return pandas.DataFrame(columns)


def table_axes(table):
    """Breakpoints by axis, in the order of the values."""
    second = "curvature_1pm" if table.reduced_curvature is None else "reduced_curvature"
    axes = {"fz_n": table.fz_n, second: getattr(table, second)}
    found = {name: getattr(table, name) for name in AXES}
    axes.update((name, values) for name, values in found.items() if values is not None)
    return axes


def table_to_xarray(table, quantity):
    """One quantity over the axes."""
    import xarray

    axes = table_axes(table)
    array = xarray.DataArray(table.values(quantity), axes, list(axes), quantity)
    if table.reduced_curvature is None:
        return array
    return array.assign_coords(curvature_1pm=(("fz_n", "reduced_curvature"), table.curvature_1pm))


def table_to_dataframe(table):
    """One row per node: axes and quantities."""
    import pandas

    axes = table_axes(table)
    places = np.meshgrid(*axes.values(), indexing="ij")
    columns = {name: place.ravel() for name, place in zip(axes, places)}
    curvature = np.broadcast_to(table.curvature_1pm, places[0].shape[:2])
    columns["curvature_1pm"] = np.repeat(curvature.ravel(), places[0].size // curvature.size)
    columns.update((quantity, table.values(quantity).ravel()) for quantity in table.quantities)
    return pandas.DataFrame(columns)


def table_of_bytes(content, shortfall):
    """Restores a table from a pickle."""
    return Table._of_bytes(content, shortfall)


def contact_of_pickle(result, warnings, arrays):
    """Restores a contact from a pickle."""
    return Contact._of_pickle(result, warnings, arrays)
