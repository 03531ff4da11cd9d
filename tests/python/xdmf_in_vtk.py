"""Opens an XDMF file as ParaView does (vtkXdmfReader), with pyvista and with meshio, and compares with h5py:

python3 tests/python/xdmf_in_vtk.py FILE.xdmf
"""

import sys

import h5py
import meshio
import numpy as np
import pyvista
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def check(path):
    errors = []
    reader = vtk.vtkXdmfReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("vtkXdmfReader reports an error"))
    reader.SetFileName(path)
    reader.UpdateInformation()
    steps = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    with h5py.File(path.removesuffix(".xdmf") + ".h5", "r") as file:
        bulk = file["bulk"]
        assert np.array_equal(steps, bulk["time"][:]), (steps, bulk["time"][:])
        for frame, time in enumerate(steps):
            reader.UpdateTimeStep(time)
            grid = reader.GetOutputDataObject(0)
            while isinstance(grid, vtk.vtkMultiBlockDataSet):
                grid = grid.GetBlock(0)
            (nodes, axes), (cells, corners) = bulk["coordinates"].shape, bulk["cells"].shape
            assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (nodes, cells)
            kind = {(2, 4): vtk.VTK_QUAD, (3, 8): vtk.VTK_HEXAHEDRON, (3, 4): vtk.VTK_TETRA}[axes, corners]
            assert {grid.GetCellType(cell) for cell in range(cells)} == {kind}
            assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData())[:, :axes], bulk["coordinates"][:])
            connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, corners)
            assert np.array_equal(connectivity, bulk["cells"][:])
            if axes == 3:
                volumes = vtk.vtkCellSizeFilter()
                volumes.SetInputData(grid)
                volumes.Update()
                assert np.all(vtk_to_numpy(volumes.GetOutput().GetCellData().GetArray("Volume")) > 0.0)
            data = grid.GetPointData()
            displacement = vtk_to_numpy(data.GetArray("displacement"))
            assert displacement.shape == (nodes, 3) and np.all(displacement[:, axes:] == 0.0)
            assert np.array_equal(displacement[:, :axes], bulk["displacement"][frame]), frame
            for component, name in enumerate(bulk["stress"].attrs["components"]):
                stress = vtk_to_numpy(data.GetArray(f"stress_{name}"))
                assert np.array_equal(stress.ravel(), bulk["stress"][frame, :, component]), (frame, name)
    assert not errors, errors
    print(f"{path}: {len(steps)} frames as in the HDF5 file")


def check_pyvista(path):
    reader = pyvista.get_reader(path)
    with h5py.File(path.removesuffix(".xdmf") + ".h5", "r") as file:
        assert np.array_equal(reader.time_values, file["bulk/time"][:])
        for frame, time in enumerate(reader.time_values):
            reader.set_active_time_value(time)
            grid = reader.read()
            while isinstance(grid, pyvista.MultiBlock):
                grid = grid[0]
            axes = file["bulk/coordinates"].shape[1]
            assert np.array_equal(grid["displacement"][:, :axes], file["bulk/displacement"][frame])
            assert np.array_equal(grid["stress_xz"].ravel(), file["bulk/stress"][frame, :, -1])
    print(f"{path}: all fields in pyvista {pyvista.__version__}")


def check_meshio(path):
    """The mesh; meshio does not know the slices that the fields are."""
    with meshio.xdmf.TimeSeriesReader(path) as reader, h5py.File(path.removesuffix(".xdmf") + ".h5", "r") as file:
        points, (cells,) = reader.read_points_cells()
        assert np.array_equal(points, file["bulk/coordinates"][:])
        assert cells.type in ("quad", "hexahedron", "tetra") and np.array_equal(cells.data, file["bulk/cells"][:])
    print(f"{path}: the mesh in meshio {meshio.__version__}")


for path in sys.argv[1:]:
    check(path)
    check_pyvista(path)
    check_meshio(path)
