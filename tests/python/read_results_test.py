"""runs/read_results.py draws a sweep: python3 tests/python/read_results_test.py (needs h5py, matplotlib, numpy)"""

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

SCRIPT = Path(__file__).parents[2] / "runs" / "read_results.py"


def case(path, arms, velocity, status="complete"):
    """A result file with what the script reads, laid out as the results reference says."""
    material = "shear_modulus = 500.0\n" + "".join(f"[[material.arms]]\nweight = 0.2\ntime = {i + 1}.0\n" for i in range(arms))
    phases = f"[[phase]]\nname = 'indent'\nduration = 10.0\n[[phase]]\nname = 'slide'\nduration = 40.0\nvelocity = {velocity}\n"
    time = np.linspace(0, 50, 51)
    with h5py.File(path, "w") as file:
        file.attrs["status"] = status
        file.attrs["scene"] = f"[material]\n{material}{phases}"
        file["history/time"] = time
        file["history/sliding"] = velocity * np.maximum(time - 10, 0)
        file["history/tangential_force"] = np.where(time > 10, 0.06 + 0.01 * np.log10(velocity), 0)


with tempfile.TemporaryDirectory() as directory:
    cases = [(arms, velocity) for arms in (0, 1, 2) for velocity in (1e-2, 1e-1, 1.0)]
    for i, (arms, velocity) in enumerate(cases):
        case(Path(directory, f"case-{i:04}.h5"), arms, velocity)
    case(Path(directory, "case-0009.h5"), 3, 1.0, status="stopped")
    picture = Path(directory, "out.png")
    subprocess.run([sys.executable, SCRIPT, directory, picture], check=True)
    content = picture.read_bytes()
    assert content.startswith(b"\x89PNG") and len(content) > 20_000, len(content)
    # An unfinished case alone is no model: three panels, for one and two arms and for the steady value.
    width, height = (int.from_bytes(content[i : i + 4], "big") for i in (16, 20))
    assert (width, height) == (15 * 150, 4 * 150), (width, height)
print("read_results.py draws a sweep")
