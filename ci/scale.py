"""A block of tetrahedra as a Gmsh file (2.2, binary): python3 ci/scale.py CELLS FILE.msh

CELLS^3 cubes of a unit cube, six tetrahedra each (Kuhn), their inner nodes moved by up to a tenth of an edge, always in the same
way. Physical surfaces "contact" (z = 1) and "base" (z = 0).
"""

import sys
from itertools import permutations

import numpy as np

cells, path = int(sys.argv[1]), sys.argv[2]
n = cells + 1
index = np.arange(n**3, dtype=np.int32).reshape(n, n, n)
places = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, n)] * 3, indexing="ij"), axis=-1)
inner = places[1:-1, 1:-1, 1:-1]
inner += np.random.default_rng(1).uniform(-0.1, 0.1, inner.shape) / cells


def shifted(offset):
    return index[tuple(slice(o, o + cells) for o in offset)].ravel()


tetrahedra = []
for order in permutations(range(3)):
    corner, corners = [0, 0, 0], []
    corners.append(shifted(corner))
    for axis in order:
        corner[axis] = 1
        corners.append(shifted(corner))
    # The odd permutations are mirror images.
    if np.linalg.det(np.eye(3)[list(order)]) < 0:
        corners[1], corners[2] = corners[2], corners[1]
    tetrahedra.append(np.stack(corners, axis=-1))
tetrahedra = np.concatenate(tetrahedra)


def triangles(layer):
    """The faces of the tetrahedra on a plane of constant z: the diagonal runs from the first to the last corner."""
    a, b, c, d = layer[:-1, :-1].ravel(), layer[1:, :-1].ravel(), layer[1:, 1:].ravel(), layer[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])


def records(kind, physical, corners, first):
    """(type, how many, tags) and then (number, physical, entity, nodes) of each."""
    count = len(corners)
    head = np.array([kind, count, 2], dtype="<i4")
    numbers = np.arange(first, first + count)[:, None]
    tags = np.full((count, 2), physical)
    return head.tobytes() + np.hstack([numbers, tags, corners + 1]).astype("<i4").tobytes()


contact, base = triangles(index[:, :, -1]), triangles(index[:, :, 0])
nodes = np.empty(n**3, dtype=[("number", "<i4"), ("place", "<f8", 3)])
nodes["number"], nodes["place"] = np.arange(1, n**3 + 1), places.reshape(-1, 3)
with open(path, "wb") as file:
    file.write(b"$MeshFormat\n2.2 1 8\n" + np.array([1], dtype="<i4").tobytes() + b"\n$EndMeshFormat\n")
    file.write(b'$PhysicalNames\n3\n2 1 "contact"\n2 2 "base"\n3 3 "block"\n$EndPhysicalNames\n')
    file.write(b"$Nodes\n%d\n" % len(nodes) + nodes.tobytes() + b"\n$EndNodes\n")
    file.write(b"$Elements\n%d\n" % (len(contact) + len(base) + len(tetrahedra)))
    file.write(records(2, 1, contact, 1) + records(2, 2, base, 1 + len(contact)))
    file.write(records(4, 3, tetrahedra, 1 + len(contact) + len(base)) + b"\n$EndElements\n")
print(f"{path}: {len(tetrahedra)} tetrahedra, {len(nodes)} nodes")
