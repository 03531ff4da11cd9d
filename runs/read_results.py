"""Draws Figure 7 from the directory of a sweep with h5py and matplotlib alone: python3 runs/read_results.py DIR [FILE.png]"""

import sys
import tomllib
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

models = {}  # the cases of each material
for path in sorted(Path(sys.argv[1]).glob("case-*.h5")):
    with h5py.File(path) as file:
        if file.attrs["status"] != "complete":
            continue
        scene = tomllib.loads(file.attrs["scene"])
        time, force, sliding = (file["history"][name][:] for name in ("time", "tangential_force", "sliding"))
    material, last = scene["material"], scene["phase"][-1]
    arms = len(material.get("arms", []))
    label = f"{arms} arm{'s' * (arms > 1)}" if arms else f"elastic, G = {material['shear_modulus']:.4g} Pa"
    end_of_approach = time[sliding == 0][-1]
    steady = force[time > time[-1] - 0.1 * last["duration"]].mean()
    models.setdefault(label, []).append((last["velocity"], time / end_of_approach, force, steady))

viscoelastic = {label: cases for label, cases in models.items() if not label.startswith("elastic")}
figure, axes = plt.subplots(1, len(viscoelastic) + 1, figsize=(5 * len(viscoelastic) + 5, 4), layout="constrained")
for axis, (label, cases) in zip(axes, viscoelastic.items()):
    for i, (velocity, time, force, _) in enumerate(sorted(cases, key=lambda case: case[0])):
        axis.plot(time, force, color=plt.cm.viridis(0.9 * i / max(len(cases) - 1, 1)), label=f"v = {velocity:g} m/s")
    axis.set(title=label, xlabel="t/t₀", ylabel="tangential force, N/m", xlim=(0.8, None))
    axis.legend(fontsize="x-small")
for label, cases in models.items():
    velocities, _, _, steady = zip(*sorted(cases, key=lambda case: case[0]))
    if label in viscoelastic:
        axes[-1].semilogx(velocities, steady, "o-", label=label)
    else:
        axes[-1].axhline(steady[0], linestyle=":", color=f"C{len(axes[-1].lines)}", label=label)
axes[-1].set(title="steady value", xlabel="v, m/s", ylabel="tangential force, N/m")
axes[-1].legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1, 1))
figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "figure7.png", dpi=150)
