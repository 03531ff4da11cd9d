"""Draws where the scenes of tests/extremes converge: python3 tests/python/extremes_map.py TABLE.csv MAP.png"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

table = np.genfromtxt(sys.argv[1], delimiter=",", names=True, dtype=None, encoding="utf-8")
converged = table["converged"] == 1
PANELS = [
    (("step", "step / relaxation time"), ("penalty", "penalty / (E/h)")),
    (("velocity", "velocity, wavelengths per relaxation time"), ("regularisation", "regularisation / velocity")),
    (("depth", "depth / wavelength"), ("amplitude", "amplitude / wavelength")),
    (("poisson", "Poisson ratio"), ("friction", "coefficient of friction")),
]
figure, axes = plt.subplots(2, 2, figsize=(12, 9), constrained_layout=True)
for axis, ((x, x_label), (y, y_label)) in zip(axes.flat, PANELS):
    axis.plot(table[x][converged], table[y][converged], "o", ms=4, mfc="none", color="#0072b2")
    axis.plot(table[x][~converged], table[y][~converged], "X", ms=9, color="#d55e00")
    axis.set_xscale("linear" if x == "poisson" else "log")
    axis.set_yscale("symlog", linthresh=1e-3) if y == "friction" else axis.set_yscale("log")
    axis.set(xlabel=x_label, ylabel=y_label)
    axis.grid(alpha=0.3)
axes[0, 0].set_title(f"circles: converged, {converged.sum()} of {len(table)}", loc="left")
axes[0, 1].set_title(f"crosses: ended with exit code 3, {(~converged).sum()}", loc="left")
figure.savefig(sys.argv[2], dpi=120)
