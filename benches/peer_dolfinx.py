#!/usr/bin/python3
"""A free-sided block under a parabola as a careful user of FEniCSx would write it: `peer_dolfinx.py SCENE.toml CELLS`.

DOLFINx 0.5, one rank or several: bilinear quadrilaterals, the arms as nodal fields, the exact tangent by automatic
differentiation, SNES with its line search and MUMPS, one matrix assembled in place. Quadrature is given by hand (two
points a direction): degrees estimated by themselves differ between residual and tangent on the contact facets, and
Newton's method then takes ten times the iterations. Prints one JSON object: seconds and forces per step.
"""

import json
import sys
import time
import tomllib

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc


class Nonlinear:
    """F(u) = 0 as SNES wants it."""

    def __init__(self, form, u, conditions):
        self.u, self.conditions = u, conditions
        self.residual = fem.form(form)
        self.tangent = fem.form(ufl.derivative(form, u, ufl.TrialFunction(u.function_space)))

    def take(self, x):
        x.ghostUpdate(addv=PETSc.InsertMode.INSERT, mode=PETSc.ScatterMode.FORWARD)
        x.copy(self.u.vector)
        self.u.x.scatter_forward()

    def evaluate(self, snes, x, f):
        self.take(x)
        with f.localForm() as local:
            local.set(0.0)
        fem.petsc.assemble_vector(f, self.residual)
        fem.petsc.apply_lifting(f, [self.tangent], [self.conditions], [x], -1.0)
        f.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        fem.petsc.set_bc(f, self.conditions, x, -1.0)

    def differentiate(self, snes, x, matrix, preconditioner):
        matrix.zeroEntries()
        fem.petsc.assemble_matrix(matrix, self.tangent, self.conditions)
        matrix.assemble()


def main():
    with open(sys.argv[1], "rb") as file:
        scene = tomllib.load(file)
    cells = int(sys.argv[2])
    begun = time.perf_counter()
    layer, material, contact, friction = (scene[key] for key in ("layer", "material", "contact", "friction"))
    width, depth = layer["width"], layer["depth"]
    corners = [np.array([0.0, -depth]), np.array([width, 0.0])]
    domain = mesh.create_rectangle(MPI.COMM_WORLD, corners, [cells, cells], mesh.CellType.quadrilateral)
    space = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    facets = mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[1], 0.0))
    tags = mesh.meshtags(domain, 1, np.sort(facets), np.full(len(facets), 1, dtype=np.int32))
    dx = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 2})
    face = ufl.Measure("ds", domain=domain, subdomain_data=tags, metadata={"quadrature_degree": 2})(1)
    base = fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[1], -depth))
    conditions = [fem.dirichletbc(np.zeros(2), base, space)]

    u, old = fem.Function(space), fem.Function(space)
    arms = [(arm["weight"], arm["time"], fem.Function(space)) for arm in material["arms"]]
    constant = lambda: fem.Constant(domain, PETSc.ScalarType(0.0))
    approach, sliding, speed, dt = constant(), constant(), constant(), constant()
    gains, decays = [constant() for _ in arms], [constant() for _ in arms]

    shear = material["shear_modulus"]
    lame = 2 * shear * material["poisson_ratio"] / (1 - 2 * material["poisson_ratio"])
    strain = lambda w: ufl.sym(ufl.grad(w))
    stress = lambda w: 2 * shear * strain(w) + lame * ufl.tr(strain(w)) * ufl.Identity(2)
    effective = (1 - sum(weight for weight, _, _ in arms)) * u
    for (weight, _, spring), gain, decay in zip(arms, gains, decays):
        effective += weight * (decay * spring + gain * (u - old))

    x = ufl.SpatialCoordinate(domain)[0]
    offset = x - sliding - scene["indenter"]["centre"]
    penetration = approach + u[1] - offset**2 / (2 * scene["indenter"]["radius"])
    pressure = contact["penalty"] * ufl.conditional(ufl.gt(penetration, 0), penetration, 0)
    slip = speed - (u[0] - old[0]) / dt
    traction = friction["coefficient"] * pressure * ufl.tanh(slip / friction["regularisation"])
    test = ufl.TestFunction(space)
    form = ufl.inner(stress(effective), strain(test)) * dx + (pressure * test[1] - traction * test[0]) * face

    problem = Nonlinear(form, u, conditions)
    matrix = fem.petsc.create_matrix(problem.tangent)
    vector = fem.petsc.create_vector(problem.residual)
    snes = PETSc.SNES().create(domain.comm)
    snes.setFunction(problem.evaluate, vector)
    snes.setJacobian(problem.differentiate, matrix)
    snes.setTolerances(rtol=1e-10, atol=0.0, stol=0.0, max_it=50)
    snes.getKSP().setType("preonly")
    snes.getKSP().getPC().setType("lu")
    snes.getKSP().getPC().setFactorSolverType("mumps")
    integrals = [fem.form(pressure * face), fem.form(traction * face)]
    total = lambda form: domain.comm.allreduce(fem.assemble_scalar(form), MPI.SUM)

    set_up = time.perf_counter() - begun
    normal, tangential, newton = [], [], 0
    solution = u.vector.copy()
    reached = slid = 0.0
    for phase in scene["phase"]:
        steps = phase["steps"]
        velocity = phase.get("velocity", 0.0)
        duration = phase["duration"] if "duration" in phase else phase["distance"] / abs(velocity)
        start, target = reached, phase.get("approach", reached)
        dt.value, speed.value = duration / steps, velocity
        for (_, relaxation, _), gain, decay in zip(arms, gains, decays):
            ratio = duration / steps / relaxation
            decay.value, gain.value = np.exp(-ratio), -np.expm1(-ratio) / ratio
        for step in range(1, steps + 1):
            reached = start + (target - start) * step / steps
            slid += velocity * duration / steps
            approach.value, sliding.value = reached, slid
            snes.solve(None, solution)
            if snes.getConvergedReason() <= 0:
                raise SystemExit(f"no convergence: reason {snes.getConvergedReason()}")
            problem.take(solution)
            newton += snes.getIterationNumber()
            normal.append(total(integrals[0]))
            tangential.append(total(integrals[1]))
            for (_, _, spring), gain, decay in zip(arms, gains, decays):
                spring.x.array[:] = decay.value * spring.x.array + gain.value * (u.x.array - old.x.array)
            old.x.array[:] = u.x.array
    whole = time.perf_counter() - begun
    if domain.comm.rank == 0:
        forces = {"normal_force": normal, "tangential_force": tangential}
        print(json.dumps({"set_up": set_up, "whole": whole, "newton": newton, **forces}))


main()
