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

from ._results import scene_of

if TYPE_CHECKING:
    from ._run import Sweep

__all__ = [
    "energy",
    "friction",
    "gap",
    "history",
    "onset",
    "pressure",
    "profile",
    "shear",
    "stick_slip",
    "stress",
    "tractions",
]


#: The share of the last phase over which the ends of cases are averaged.
END = 0.1


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


def tractions(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None, *, along: str = "x") -> Axes:
    """Pressure and shear along the face at the stored moment nearest to ``time``, s; at the last one by default.

    In space ``along`` x or y, where the pressure is greatest.
    """
    axes = _axes(axes)
    frame, place = _line(run, time, along)
    axes.plot(frame[along], frame["pressure"], label="pressure")
    if "direction" in frame["shear"].dims:
        for direction in numpy.asarray(frame["direction"]):
            axes.plot(frame[along], frame["shear"].sel(direction=direction), label=f"shear {direction}")
    else:
        axes.plot(frame[along], frame["shear"], label="shear")
    axes.set(xlabel=f"{along}, m", ylabel="traction, Pa", title=f"t = {float(frame['time']):.4g} s{place}")
    axes.legend()
    return axes


def profile(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None, *, along: str = "x") -> Axes:
    """The deformed face, and the indenter over it, at the stored moment nearest to ``time``, s.

    In space ``along`` x or y, where the pressure is greatest.
    """
    axes = _axes(axes)
    frame, place = _line(run, time, along)
    if "displacement" in frame:
        across, up = (frame["displacement"].sel(axis=name) for name in (along, "z"))
    else:
        across, up = frame["displacement_x"], frame["displacement_z"]
    x = frame[along] + across
    axes.plot(x, up, label="face")
    axes.plot(x, up + frame["gap"], label="indenter")
    axes.set(xlabel=f"{along}, m", ylabel="z, m", title=f"t = {float(frame['time']):.4g} s{place}")
    axes.legend()
    return axes


def pressure(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None) -> Axes:
    """In space the pressure from above at the stored moment nearest to ``time``, s; nothing where there is no contact."""
    frame = _from_above(run, time)
    return _map(frame, frame["pressure"].where(frame["pressure"] > 0), axes)


def shear(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None) -> Axes:
    """In space the magnitude of the shear, with arrows along it, at the stored moment nearest to ``time``, s."""
    frame = _from_above(run, time)
    touched = frame["pressure"] > 0
    axes = _map(frame, _magnitude(frame["shear"]).where(touched).assign_attrs(frame["shear"].attrs), axes)
    some = {name: slice(None, None, max(1, frame.sizes[name] // 18)) for name in ("x", "y")}
    arrows = frame["shear"].where(touched).isel(some).transpose("direction", "y", "x")
    axes.quiver(arrows["x"], arrows["y"], *arrows.values, color="w", edgecolor="k", linewidth=0.5, pivot="mid")
    return axes


def gap(run: xarray.DataTree, time: float | None = None, axes: Axes | None = None) -> Axes:
    """In space the gap from above at the stored moment nearest to ``time``, s; nothing where there is contact."""
    frame = _from_above(run, time)
    return _map(frame, frame["gap"].where(frame["pressure"] <= 0), axes)


def stick_slip(run: xarray.DataTree, axes: Axes | None = None, *, time: float | None = None) -> Axes:
    """Stick, slip and no contact, as ``stick_fraction`` of the history counts them: x against time; in space from above at the stored
    moment nearest to ``time``, s.
    """
    axes = _axes(axes)
    in_space = "x" not in run["interface"].variables
    table = _from_above(run, time) if in_space else run["interface"].to_dataset()
    state = (table["pressure"] > 0).astype(int) * (2 - _sticks(run, table).astype(int))
    colours = pyplot.get_cmap("viridis_r", 3)
    over, up = ("x", "y") if in_space else ("time", "x")
    image = axes.pcolormesh(table[over], table[up], state.transpose(up, over), cmap=colours, vmin=-0.5, vmax=2.5)
    bar = axes.figure.colorbar(image, ax=axes, ticks=[0, 1, 2])
    bar.ax.set_yticklabels(["no contact", "stick", "slip"])
    axes.set(xlabel="x, m" if in_space else "time, s", ylabel=f"{up}, m")
    if in_space:
        axes.set(aspect="equal", title=f"t = {float(table['time']):.4g} s")
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
    """From stick to slip: the tangential force of each case against the displacement of the indenter, after the approach."""
    axes = _axes(axes)
    for case in range(len(sweep)):
        with sweep[case] as run:
            table = _in_plane(run, "history")
            moves = numpy.append(table["sliding"].values != 0, True)
            table = table.isel(time=slice(max(int(numpy.argmax(moves)) - 1, 0), None))
            label = ", ".join(f"{key.split('.')[-1]} = {sweep.summary[key].values[case]}" for key in sweep.keys)
            axes.plot(1e3 * table["sliding"], table["tangential_force"], label=label)
            units = table["tangential_force"].attrs["units"]
    axes.set(xlabel="displacement of the indenter, mm", ylabel=f"Q, {units}")
    axes.legend()
    return axes


def friction(sweep: Sweep, axes: Axes | None = None) -> Axes:
    """Hysteretic and total friction, over the normal force, against the last varied key; a line for each value of the others.

    Each is the mean over the last tenth of the last phase.
    """
    axes = _axes(axes)
    *others, key = sweep.keys
    forces = numpy.array([_at_the_end(sweep, case) for case in range(len(sweep))])
    along: Any = sweep.summary[key].values
    series: dict[str, list[int]] = {}
    for case in range(len(sweep)):
        name = ", ".join(f"{other.split('.')[-1]} = {sweep.summary[other].values[case]}" for other in others)
        series.setdefault(name, []).append(case)
    for name, cases in series.items():
        normal, tangential, hysteretic = forces[cases].T
        for label, values in [("hysteretic", hysteretic), ("total", tangential + hysteretic)]:
            axes.plot(along[cases], values / normal, "o-", label=f"{label}, {name}" if name else label)
    if along.dtype.kind == "f" and along.min() > 0 and along.max() > 20 * along.min():
        axes.set_xscale("log")
    axes.set(xlabel=key, ylabel="friction over N")
    axes.legend()
    return axes


def _at_the_end(sweep: Sweep, case: int) -> list[float]:
    """Normal, tangential and hysteretic force of a case: the means over the last tenth of its last phase."""
    with sweep[case] as run:
        table = _in_plane(run, "history")
        time, phase = table["time"].values, table["phase"].values
        start = time[numpy.argmax(phase == phase[-1])]
        end = table.isel(time=time >= time[-1] - END * (time[-1] - start))
        return [float(end[name].mean()) for name in ("normal_force", "tangential_force", "hysteretic_force")]


def _sticks(run: xarray.DataTree, table: xarray.Dataset) -> xarray.DataArray:
    """Where points in contact stick."""
    law = scene_of(run).get("friction")
    shear, rate = (_magnitude(table[name]) for name in ("shear", "slip_rate"))
    sticks: xarray.DataArray
    if law is None:
        sticks = xarray.zeros_like(table["pressure"], dtype=bool)
    elif law["law"] == "coulomb_tanh":
        sticks = rate < law["regularisation"]
    elif isinstance(law["coefficient"], str):
        sticks = rate == 0.0
    else:
        # Up to round-off.
        sticks = shear < (1 - 1e-12) * law["coefficient"] * table["pressure"]
    return sticks


def _in_plane(run: xarray.DataTree, group: str) -> xarray.Dataset:
    """A group of results whose face is a line."""
    if "x" not in run["interface"].variables:
        raise ValueError("this figure is of runs in the plane; in space it is left to mpjr plot")
    return run[group].to_dataset()


def _from_above(run: xarray.DataTree, time: float | None) -> xarray.Dataset:
    """A stored moment of a face of two directions, with x and y in the place of its nodes."""
    if "x" in run["interface"].variables:
        raise ValueError("this figure is of runs in space")
    frame = _frame(run["interface"].to_dataset(), time)
    columns, rows = (int(count) for count in frame["coordinates"].attrs["grid"])
    x, y = frame["coordinates"].transpose("direction", "node").values
    fields = {}
    for name, field in frame.drop_vars("coordinates").data_vars.items():
        rest = [dimension for dimension in field.dims if dimension != "node"]
        values = field.transpose("node", *rest).values
        fields[name] = (["x", "y", *rest], values.reshape(columns, rows, *values.shape[1:]), field.attrs)
    kept = {name: frame[name] for name in ("time", "direction", "axis")}
    return xarray.Dataset(fields, {"x": x[::rows], "y": y[:rows], **kept})


def _line(run: xarray.DataTree, time: float | None, along: str) -> tuple[xarray.Dataset, str]:
    """A stored moment along a line, and in space where that is."""
    if "x" in run["interface"].variables:
        if along != "x":
            raise ValueError("in the plane a face is along x")
        return _frame(run["interface"].to_dataset(), time), ""
    if along not in ("x", "y"):
        raise ValueError(f"a line is along x or y, not {along}")
    frame, across = _from_above(run, time), "y" if along == "x" else "x"
    deepest = frame["pressure"].max(along).argmax(across)
    line = frame.isel({across: int(deepest)})
    return line, f", {across} = {float(line[across]):.3g} m"


def _magnitude(field: Any) -> Any:
    """Of a number, or of a vector along the face."""
    return numpy.sqrt((field**2).sum("direction")) if "direction" in field.dims else abs(field)


def _map(frame: xarray.Dataset, field: Any, axes: Axes | None) -> Axes:
    axes = _axes(axes)
    image = axes.pcolormesh(frame["x"], frame["y"], field.transpose("y", "x"), shading="nearest")
    axes.figure.colorbar(image, ax=axes, label=f"{field.attrs['long_name']}, {field.attrs['units']}")
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal", title=f"t = {float(frame['time']):.4g} s")
    return axes


def _frame(dataset: xarray.Dataset, time: float | None) -> xarray.Dataset:
    """The stored moment nearest to ``time``; the last without."""
    return dataset.isel(time=-1) if time is None else dataset.sel(time=time, method="nearest")
