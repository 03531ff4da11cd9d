"""The notebook runs from its first cell to its last."""

from __future__ import annotations

import shutil
from pathlib import Path

import nbclient
import nbformat


def test_the_notebook_runs(tmp_path: Path) -> None:
    source = Path(__file__).parents[1] / "first_steps.ipynb"
    notebook = nbformat.read(shutil.copy(source, tmp_path), as_version=4)
    client = nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": tmp_path}})
    client.execute()
    figures = [out for cell in notebook.cells if cell.cell_type == "code" for out in cell.outputs if "image/png" in out.get("data", {})]
    assert len(figures) == 4
