"""Result files as xarray trees."""

from __future__ import annotations

import os
import tomllib
from typing import Any

import xarray


def open(path: str | os.PathLike[str]) -> xarray.DataTree:  # noqa: A001 - the name of the contract
    """Opens a result file.

    The groups ``history``, ``history/energy``, ``interface`` and ``bulk`` have the datasets as variables, with their units and
    long names, along ``time``, ``x``, ``node``, ``axis`` and ``component``. Root attributes: ``status``, ``scene`` (TOML),
    ``warnings`` and others. Values are read when they are used; the file can be opened while a run goes on.
    """
    tree = xarray.open_datatree(os.fspath(path), engine="h5netcdf")
    if "mpjr_version" not in tree.attrs:
        tree.close()
        raise ValueError(f"{os.fspath(path)}: is an HDF5 file, but not one that mpjr wrote")
    return tree


def scene_of(tree: xarray.DataTree) -> dict[str, Any]:
    """The scene that was solved, with every default."""
    return tomllib.loads(tree.attrs["scene"])
