#!/usr/bin/env python3
"""Tamaas beside mpjr on one scene: a rough viscoelastic deep layer without friction. `peer_tamaas.py MPJR [NODES]`.

Needs numpy, h5py and tamaas (PyPI, in an environment of its own: mpjr never depends on it). Both run on one thread: mpjr pressed by
its approach, then held; Tamaas under the mean pressures that mpjr found, on the elevations that mpjr's gap and displacement leave: its
MaxwellViscoelastic, and its elastic solver stepped by the same backward Euler. Prints contact area and root mean square pressure, of which
the second is what the meshes differ by (trilinear cells here, a half-space in Fourier space there), and user seconds a step and their
ratio to mpjr's. A contact whose approach is held keeps its area while its pressures fall; MaxwellViscoelastic 2.9 was seen to let it shrink.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import h5py
import numpy as np
import tamaas

SCENE = """
[layer]
width = [1.0, 1.0]
depth = 1.0
cells = [{n}, {n}, 48]
grading = 16.0
sides = "periodic"
[material]
shear_modulus = 1e6
poisson_ratio = 0.3
arms = [ {{ weight = 0.3, time = 0.02 }}, {{ weight = 0.2, time = 0.1 }}, {{ weight = 0.2, time = 0.5 }} ]
poisson_rule = "constant_ratio"
memory = "backward_euler"
[indenter]
profile = "rough"
hurst = 0.8
rms_slope = 0.1
shortest = {shortest}
longest = 0.25
seed = 1
period = 1.0
[contact]
[[phase]]
name = "press"
duration = 0.1
steps = 10
approach = 8e-3
[[phase]]
name = "hold"
duration = {hold}
steps = {steps}
[solver]
tolerance = 1e-8
[output]
energy = false
"""
SHEAR, POISSON, ARMS = 1e6, 0.3, [(0.3, 0.02), (0.2, 0.1), (0.2, 0.5)]
STEP, HELD, TOLERANCE = 0.01, 10, 1e-8


def run(mpjr, nodes, steps, directory):
    """The user seconds of a run that holds for so many steps, and its file."""
    scene = os.path.join(directory, f"scene-{steps}.toml")
    with open(scene, "w", encoding="utf-8") as file:
        file.write(SCENE.format(n=nodes, shortest=8.0 / nodes, hold=steps * STEP, steps=steps))
    out = scene.replace(".toml", ".h5")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([mpjr, "run", "-q", scene, "--out", out], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, out


def model_of(nodes, shear):
    """A half-space of this shear modulus."""
    model = tamaas.Model(tamaas.model_type.basic_2d, [1.0, 1.0], [nodes, nodes])
    model.nu, model.E = POISSON, 2.0 * shear * (1.0 + POISSON)
    return model


def told(traction):
    """Contact fraction and root mean square of the pressure."""
    traction = np.asarray(traction)
    return float(np.mean(traction > 0.0)), float(np.mean(traction**2) ** 0.5)


def its_own(nodes, elevation, pressures):
    """What MaxwellViscoelastic finds after each step, and user seconds a step."""
    model = model_of(nodes, SHEAR * (1.0 - sum(weight for weight, _ in ARMS)))
    moduli, times = [SHEAR * weight for weight, _ in ARMS], [relaxation for _, relaxation in ARMS]
    solver = tamaas.MaxwellViscoelastic(model, -elevation, TOLERANCE, STEP, moduli, times)
    solver.max_iter = 10000
    solver.reset()
    found, begun = [], time.process_time()
    for pressure in pressures:
        solver.solve(float(pressure))
        found.append(told(model.traction))
    return found, (time.process_time() - begun) / len(pressures)


def stepped(nodes, elevation, pressures):
    """The same by backward Euler around its elastic solver: with y = c u + sum_i G_i a_i (z_i - u), a_i = tau_i/(tau_i + dt), in
    place of the displacement u, a step is an elastic contact."""
    model, surface = model_of(nodes, 1.0), np.zeros((nodes, nodes))
    moduli = [SHEAR * weight for weight, _ in ARMS]
    shares = [relaxation / (relaxation + STEP) for _, relaxation in ARMS]
    secant = SHEAR * (1.0 - sum(weight for weight, _ in ARMS)) + sum(g * a for g, a in zip(moduli, shares))
    u, arms = np.zeros_like(surface), [np.zeros_like(surface) for _ in ARMS]
    solver = tamaas.PolonskyKeerRey(model, surface, TOLERANCE)
    solver.max_iter = 10000
    found, begun = [], time.process_time()
    for pressure in pressures:
        past = sum(g * a * (arm - u) for g, a, arm in zip(moduli, shares, arms))
        solver.surface[:] = (past - secant * elevation).reshape(solver.surface.shape)
        solver.solve(float(pressure))
        after = (np.asarray(model.displacement).reshape(nodes, nodes) - past) / secant
        arms = [a * (arm + after - u) for a, arm in zip(shares, arms)]
        u = after
        found.append(told(model.traction))
    return found, (time.process_time() - begun) / len(pressures)


def main():
    mpjr, nodes = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 128
    tamaas.set_log_level(tamaas.LogLevel.warning)
    tamaas.initialize(1)
    with tempfile.TemporaryDirectory() as directory:
        short, _ = run(mpjr, nodes, HELD, directory)
        long, out = run(mpjr, nodes, 3 * HELD, directory)
        with h5py.File(out) as file:
            force = file["history/normal_force"][1:]
            ours = [told(pressure) for pressure in file["interface/pressure"][:][-len(force) :]]
            lifted = file["interface/gap"][-1] + file["interface/displacement"][-1][:, 2]
            elevation = (lifted + file["history/approach"][-1]).reshape(nodes, nodes)
    spent = (long - short) / (2 * HELD)
    runs = [("mpjr", ours, spent)]
    runs += [("MaxwellViscoelastic", *its_own(nodes, elevation, force))]
    runs += [("PolonskyKeerRey, stepped", *stepped(nodes, elevation, force))]
    steps = [4, 9, len(force) - 1]
    print(f"{nodes} x {nodes} nodes; N = " + ", ".join(f"{force[step]:.4e}" for step in steps) + f" N after steps {steps}")
    print(f"{'':>26} {'contact fraction':^26} {'root mean square p, Pa':^32} {'s a step':>9} {'us a node':>9} {'ratio':>6}")
    for name, found, seconds in runs:
        areas = " ".join(f"{found[step][0]:8.5f}" for step in steps)
        pressures = " ".join(f"{found[step][1]:10.4e}" for step in steps)
        print(f"{name:>26} {areas} {pressures} {seconds:9.4f} {1e6 * seconds / nodes**2:9.2f} {seconds / spent:6.2f}")


if __name__ == "__main__":
    main()
