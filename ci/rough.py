"""Contact fraction against load of one self-affine surface on finer and finer meshes: `rough.py MPJR DIR NODES...` (see ci/rough).

An elastic deep layer, pressed without friction. The surface, its waves and their phases, is the same for all meshes; load is p/(E* h'),
h' the root mean square of its slope, Persson's fraction erf(sqrt(2) p/(E* h')) (J. Chem. Phys. 115 (2001) 3840, with Manners and Greenwood's
factor). Beside the fraction of nodes that touch stands what is left of it without the half cells by which nodes at the rim count too
much: less (pi - 1 + ln 2)/24 of the rim's length times the cell (Yastrebov, Anciaux and Molinari, Tribol. Int. 114 (2017) 161).
"""

import math
import os
import subprocess
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SHEAR, POISSON, SLOPE, SHORTEST = 1e6, 0.3, 0.1, 1.0 / 32.0
MODULUS = 2.0 * SHEAR / (1.0 - POISSON)  # E*
LOADS = [0.005, 0.015, 0.03, 0.06]
SCENE = """
[layer]
width = [1.0, 1.0]
depth = 1.0
cells = [{n}, {n}, 48]
grading = {grading}
sides = "periodic"
[material]
shear_modulus = {SHEAR}
poisson_ratio = {POISSON}
[indenter]
profile = "rough"
hurst = 0.8
rms_slope = {SLOPE}
shortest = {SHORTEST}
longest = 0.25
period = 1.0
seed = 1
[contact]
[[phase]]
name = "press"
duration = 1.0
steps = 16
approach = 1.2e-2
[output]
energy = false
"""


def solved(mpjr, directory, nodes):
    """Loads, contact fractions and those without half of the rim, step by step."""
    name = os.path.join(directory, f"rough-{nodes}")
    # Cells at the face about as high as they are wide.
    grading = {128: 8.0, 256: 32.0, 512: 100.0}.get(nodes, 8.0)
    with open(name + ".toml", "w", encoding="utf-8") as file:
        file.write(SCENE.format(n=nodes, grading=grading, **globals()))
    subprocess.run([mpjr, "run", "-q", name + ".toml", "--out", name + ".h5"], check=True)
    with h5py.File(name + ".h5") as file:
        force = file["history/normal_force"][1:]
        touches = file["interface/pressure"][:].reshape(-1, nodes, nodes)[-len(force) :] > 0.0
    rim = sum(np.sum(touches != np.roll(touches, 1, axis), axis=(1, 2)) for axis in (1, 2)) / nodes
    fraction = touches.mean(axis=(1, 2))
    less = (math.pi - 1.0 + math.log(2.0)) / 24.0 * rim / nodes
    return force / (MODULUS * SLOPE), fraction, fraction - less


def main():
    mpjr, directory, *nodes = sys.argv[1:]
    figure, axes = plt.subplots(figsize=(4.0, 3.0), layout="constrained")
    line = np.linspace(0.0, 0.07, 100)
    axes.plot(line, [math.erf(math.sqrt(2.0) * load) for load in line], "k", label="Persson")
    print("p/(E* h')            " + " ".join(f"{load:15.3f}" for load in LOADS))
    print("Persson              " + " ".join(f"{math.erf(math.sqrt(2.0) * load):15.4f}" for load in LOADS))
    for count in map(int, nodes):
        loads, fraction, less = solved(mpjr, directory, count)
        at = [(np.interp(load, loads, fraction), np.interp(load, loads, less)) for load in LOADS]
        cells = f"{count:4} nodes, {count * SHORTEST:3.0f}/wave "
        print(cells + " " + " ".join(f"{whole:8.4f} {part:6.4f}" for whole, part in at), flush=True)
        axes.plot(loads, fraction, ".-", lw=0.8, label=f"{count} nodes a side")
    axes.set(xlabel="$p/(E^* h')$", ylabel="contact fraction", xlim=(0.0, 0.07), ylim=(0.0, 0.2))
    axes.legend(frameon=False)
    figure.savefig(os.path.join(directory, "rough.png"), dpi=110)


if __name__ == "__main__":
    main()
