"""Checks result files against the results reference with h5py alone: python3 tests/python/h5py_contract.py FILE.h5 ..."""

import sys

import h5py
import numpy as np

ROOT = {
    "title": str, "scene": str, "inputs": str, "mpjr_version": str, "git_commit": str, "petsc_version": str, "started": str,
    "units": str, "status": str, "mpi_ranks": np.integer, "wall_seconds": np.floating,
}
HISTORY = """time phase approach sliding normal_force tangential_force hysteretic_force contact_fraction stick_fraction
             max_penetration newton_iterations""".split()
ENERGY = "external_work stored viscoelastic_dissipation friction_dissipation penalty imbalance".split()
INTERFACE = "pressure shear gap slip_rate displacement_x displacement_z".split()


def check_scales(file, data):
    """Each dimension has one scale, of its length, in the same group or the one above; both ends know of each other."""
    if h5py.h5ds.is_scale(data.id):
        return
    for index, dimension in enumerate(data.dims):
        (name,) = dimension.keys()
        scale = dimension[0]
        assert h5py.h5ds.is_scale(scale.id) and h5py.h5ds.is_attached(data.id, scale.id, index), data.name
        assert scale.name.rsplit("/", 1)[1] == name and data.name.startswith(scale.parent.name), (data.name, scale.name)
        assert scale.shape == data.shape[index : index + 1], (data.name, scale.name)


def check(path):
    with h5py.File(path, "r") as file:
        for name, kind in ROOT.items():
            assert isinstance(file.attrs[name], kind), f"{name}: {type(file.attrs[name])}"
        assert file.attrs["units"] == "SI"
        assert file.attrs["warnings"].ndim == 1 and all(isinstance(text, str) for text in file.attrs["warnings"])
        assert file.attrs["status"] in ("complete", "stopped", "not converged")

        def described(name, item):
            if isinstance(item, h5py.Dataset):
                assert isinstance(item.attrs["units"], str), name
                assert isinstance(item.attrs["long_name"], str) and item.attrs["long_name"], name

                check_scales(file, item)

        file.visititems(described)

        history = file["history"]
        rows = len(history["time"])
        columns = [history[name] for name in HISTORY]
        if "energy" in history:
            columns += [history["energy"][name] for name in ENERGY]
        if "worn_volume" in history:
            columns += [history["worn_volume"], *([history["energy"]["wear"]] if "energy" in history else [])]
        assert rows >= 1 and history["time"][0] == 0.0 and np.all(np.diff(history["time"][:]) > 0)
        for column in columns:
            assert column.shape == (rows,) and np.all(np.isfinite(column[:])), column.name
        for name in ("phase", "newton_iterations"):
            assert np.issubdtype(history[name].dtype, np.integer)
        names = history["phase"].attrs["names"]
        assert all(isinstance(name, str) for name in names) and history["phase"][:].max() < len(names)

        interface = file["interface"]
        frames, nodes = len(interface["time"]), len(interface["x"])
        worn = ["worn_depth", *(name for name in ["worn_profile"] if name in interface)] if "worn_volume" in history else []
        for name in INTERFACE + worn:
            assert interface[name].shape == (frames, nodes) and interface[name].dtype == np.float64, name
            assert np.all(np.isfinite(interface[name][:])), name

        if "bulk" in file:
            bulk = file["bulk"]
            count, nodes = len(bulk["time"]), len(bulk["coordinates"])
            assert bulk["coordinates"].shape == (nodes, 2) and bulk["cells"].shape[1] == 4
            assert bulk["cells"][:].min() >= 0 and bulk["cells"][:].max() < nodes
            assert bulk["displacement"].shape == (count, nodes, 2)
            assert bulk["stress"].shape == (count, nodes, 4)
            assert list(bulk["stress"].attrs["components"]) == ["xx", "zz", "yy", "xz"]
            assert np.all(np.isfinite(bulk["stress"][:])) and np.all(np.isfinite(bulk["displacement"][:]))
        print(f"{path}: {rows} rows, {frames} interface profiles, status {file.attrs['status']}")


for path in sys.argv[1:]:
    check(path)
