"""Runs and sweeps."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy
import tomli_w
import tqdm.auto
import xarray

from ._program import solve
from ._results import open as open_results
from ._scene import Scene

_STEP = re.compile(r"^(\d+)/(\d+)  (\S.*?)  t = ")
_CASES = re.compile(r"(\d+) of (\d+)")


class _Progress:
    """A bar that follows the lines that the program prints."""

    def __init__(self, pattern: re.Pattern[str], unit: str, shown: bool) -> None:
        self._pattern = pattern
        self._bar = tqdm.auto.tqdm(unit=unit, disable=not shown)

    def told(self, line: str) -> None:
        found = self._pattern.search(line)
        if found is None:
            return
        self._bar.total = int(found[2])
        self._bar.update(int(found[1]) - self._bar.n)

    def close(self) -> None:
        self._bar.close()


def run(
    scene: Scene | str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    *,
    ranks: int = 1,
    resume: bool = False,
    progress: bool = True,
    petsc: Sequence[str] = (),
) -> xarray.DataTree:
    """Solves a scene and opens its results.

    Args:
        scene: a scene or the path of one.
        out: the result file; otherwise the stem of the scene's file, or ``run``, + ``.h5``, in the current directory. What is
            there is replaced if the program wrote it.
        ranks: MPI ranks, started by ``mpirun``.
        resume: go on from the checkpoint of a run that was stopped.
        progress: whether a bar shows how far it is.
        petsc: options for PETSc.

    Raises:
        MpjrError: one of its kinds, with the program's text. An interrupt ends the ranks, after a checkpoint where there is time.
    """
    if not isinstance(scene, Scene):
        out = Path(scene).stem + ".h5" if out is None else out
        scene = Scene.load(scene)
    out = Path("run.h5" if out is None else out)
    options = ["--resume"] if resume else ["--restart"]
    bar = _Progress(_STEP, "step", progress)
    try:
        with scene.as_file() as path:
            after = ["--", *petsc] if petsc else []
            solve(["run", str(path), "--out", str(out), *options, *after], ranks, bar.told)
    finally:
        bar.close()
    return open_results(out)


@dataclass(frozen=True)
class Sweep:
    """The results of a sweep.

    Attributes:
        directory: where they are.
        keys: the varied keys, slowest first.
        summary: the last row of each case's history, along ``case``, with the varied keys as coordinates and the ``status``.
    """

    directory: Path
    keys: tuple[str, ...]
    summary: xarray.Dataset

    def __len__(self) -> int:
        return self.summary.sizes["case"]

    def __getitem__(self, case: int) -> xarray.DataTree:
        """Opens the results of a case."""
        return open_results(self.directory / f"case-{range(len(self))[case]:04d}.h5")


def sweep(
    scene: Scene,
    vary: Mapping[str, Sequence[Any]],
    out: str | os.PathLike[str],
    *,
    follow: Mapping[str, str] | None = None,
    ranks: int = 1,
    progress: bool = True,
) -> Sweep:
    """Solves all combinations of varied keys; cases that are complete are not solved again.

    Args:
        scene: what the cases have in common.
        vary: paths of keys with their values; the first key is the slowest.
        out: the directory of the results.
        follow: paths of keys with formulas of others.
        ranks: MPI ranks, among which the cases are dealt out.
        progress: whether a bar shows how many cases are done.

    Raises:
        MpjrError: one of its kinds. Cases that failed do not keep the others from being solved.
    """
    out = Path(out)
    bar = _Progress(_CASES, "case", progress)
    # Their names stay, so that cases are known again.
    scene_file = scene.directory / f".{out.name}-scene.toml"
    sweep_file = scene.directory / f".{out.name}-sweep.toml"
    table: dict[str, Any] = {"scene": scene_file.name, "vary": {key: list(values) for key, values in vary.items()}}
    if follow:
        table["follow"] = dict(follow)
    try:
        scene.write(scene_file)
        sweep_file.write_text(tomli_w.dumps(table), encoding="utf-8")
        solve(["sweep", str(sweep_file), "--out", str(out)], ranks, bar.told)
    finally:
        bar.close()
        scene_file.unlink(missing_ok=True)
        sweep_file.unlink(missing_ok=True)
    return Sweep(out, tuple(vary), _summary(out / "summary.csv", tuple(vary)))


def _summary(path: Path, keys: Sequence[str]) -> xarray.Dataset:
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))

    def column(name: str) -> numpy.ndarray[Any, Any]:
        values = [row[name] for row in rows]
        try:
            return numpy.array([float(value) if value else numpy.nan for value in values])
        except ValueError:
            return numpy.array(values)

    names = [name for name in (rows[0] if rows else {}) if name != "case" and name not in keys]
    return xarray.Dataset(
        {name: ("case", column(name)) for name in names},
        {"case": numpy.arange(len(rows)), **{key: ("case", column(key)) for key in keys}},
    )
