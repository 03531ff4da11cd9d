"""Figures of results with matplotlib: what ``mpjr plot`` draws, under the same names.

Each function takes results, draws on the ``axes`` that are given or on a figure of its own, and returns the axes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as pyplot
import numpy
import xarray
from matplotlib.axes import Axes
from matplotlib.tri import Triangulation

if TYPE_CHECKING:
    from ._run import Sweep

__all__ = ["energy", "friction", "history", "onset", "profile", "stick_slip", "stress", "tractions"]


def _axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    return pyplot.subplots(layout="constrained")[1]


def history(run: xarray.DataTree, axes: Axes | None = None) -> Axes:
    """Forces against time."""
    axes = _axes(axes)
    table = run["history"].to_dataset()
    for name, label in [("normal_force", "N"), ("tangential_force", "Q"), ("hysteretic_force", "hysteretic")]:
        # In space forces along the face have two components.
        if "direction" in table[name].dims:
            for index, direction in enumerate(numpy.asarray(table["direction"])):
                axes.plot(table["time"], table[name].isel(direction=index), label=f"{label} {direction}")
        else:
            axes.plot(table["time"], table[name], label=label)
    axes.set(xlabel="time, s", ylabel=f"force, {table['normal_force'].attrs['units']}")
    axes.legend()
    return axes


def energy(run: xarray.DataTree, axes: Axes | None = None) -> Axes:
    """Where the work of the indenter goes, against time."""
    axes = _axes(axes)
    table = run["history/energy"]
    time = run["history/time"]
    names = ["stored", "viscoelastic_dissipation", "friction_dissipation", "penalty"]
    axes.stackplot(time, *[table[name] for name in names], labels=[name.replace("_", " ") for name in names])
    axes.plot(time, table["external_work"], "k", label="external work")
    axes.set(xlabel="time, s", ylabel=f"energy, {table['stored'].attrs['units']}")
    axes.legend()
    return axes


def tractions(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None) -> Axes:
    """Pressure and shear along the face at the stored moment nearest to ``time``, s; at the last one by default."""
    axes = _axes(axes)
    frame = _frame(_in_plane(run, "interface"), time)
    axes.plot(frame["x"], frame["pressure"], label="pressure")
    axes.plot(frame["x"], frame["shear"], label="shear")
    axes.set(xlabel="x, m", ylabel="traction, Pa", title=f"t = {float(frame['time']):.4g} s")
    axes.legend()
    return axes


def profile(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None) -> Axes:
    """The deformed face, and the indenter over it, at the stored moment nearest to ``time``, s."""
    axes = _axes(axes)
    frame = _frame(_in_plane(run, "interface"), time)
    x = frame["x"] + frame["displacement_x"]
    axes.plot(x, frame["displacement_z"], label="face")
    axes.plot(x, frame["displacement_z"] + frame["gap"], label="indenter")
    axes.set(xlabel="x, m", ylabel="z, m", title=f"t = {float(frame['time']):.4g} s")
    axes.legend()
    return axes


def stick_slip(run: xarray.DataTree, axes: Axes | None = None) -> Axes:
    """Stick, slip and no contact, x against time.

    A point in contact counts as sticking below a thousandth of the fastest slip rate at that moment.
    """
    axes = _axes(axes)
    table = _in_plane(run, "interface")
    rate = abs(table["slip_rate"])
    slips = (rate > 1e-3 * rate.max("x")).astype(int)
    state = (table["pressure"] > 0).astype(int) * (1 + slips)
    colours = pyplot.get_cmap("viridis_r", 3)
    image = axes.pcolormesh(table["time"], table["x"], state.transpose("x", "time"), cmap=colours, vmin=-0.5, vmax=2.5)
    bar = axes.figure.colorbar(image, ax=axes, ticks=[0, 1, 2])
    bar.ax.set_yticklabels(["no contact", "stick", "slip"])
    axes.set(xlabel="time, s", ylabel="x, m")
    return axes


def stress(
    run: xarray.DataTree, component: str = "xz", time: float | None = None, axes: Axes | None = None
) -> Axes:
    """A component of the stress in the bulk at the stored moment nearest to ``time``, s."""
    axes = _axes(axes)
    bulk = _in_plane(run, "bulk")
    frame = _frame(bulk, time)
    x, z = bulk["coordinates"].transpose("axis", "node").values
    cells = bulk["cells"].values
    triangles = numpy.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    # Of a triangle the last node is there twice.
    triangles = triangles[(triangles[:, 0] != triangles[:, 2]) & (triangles[:, 1] != triangles[:, 2])]
    values = frame["stress"].sel(component=component).values
    image = axes.tripcolor(Triangulation(x, z, triangles), values, shading="gouraud")
    axes.figure.colorbar(image, ax=axes, label=f"stress {component}, Pa")
    axes.set(xlabel="x, m", ylabel="z, m", aspect="equal", title=f"t = {float(frame['time']):.4g} s")
    return axes


def onset(sweep: Sweep, axes: Axes | None = None) -> Axes:
    """The tangential force of each case against time."""
    axes = _axes(axes)
    for case in range(len(sweep)):
        with sweep[case] as run:
            label = ", ".join(f"{key.split('.')[-1]} = {sweep.summary[key].values[case]}" for key in sweep.keys)
            axes.plot(run["history/time"], run["history/tangential_force"], label=label)
            units = run["history/tangential_force"].attrs["units"]
    axes.set(xlabel="time, s", ylabel=f"Q, {units}")
    axes.legend()
    return axes


def friction(sweep: Sweep, axes: Axes | None = None) -> Axes:
    """Tangential and hysteretic force over the normal force at the end of each case, against the last varied key."""
    axes = _axes(axes)
    table = sweep.summary
    key = sweep.keys[-1]
    for name, label in [("tangential_force", "Q/N"), ("hysteretic_force", "hysteretic/N")]:
        axes.plot(table[key], table[name] / table["normal_force"], "o-", label=label)
    values: Any = table[key].values
    if values.dtype.kind == "f" and values.min() > 0 and values.max() > 20 * values.min():
        axes.set_xscale("log")
    axes.set(xlabel=key, ylabel="friction")
    axes.legend()
    return axes


def _in_plane(run: xarray.DataTree, group: str) -> xarray.Dataset:
    """A group of results whose face is a line."""
    if "x" not in run["interface"].variables:
        raise ValueError("this figure is of runs in the plane; draw those in space from their variables")
    return run[group].to_dataset()


def _frame(dataset: xarray.Dataset, time: float | None) -> xarray.Dataset:
    """The stored moment nearest to ``time``; the last without."""
    return dataset.isel(time=-1) if time is None else dataset.sel(time=time, method="nearest")
