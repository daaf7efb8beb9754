"""test_hits over three scenes of different kinds: large flat walls that touch, a field of curved bodies of different
sizes (32,000 triangles), and a body under turned, scaled and mirrored nodes."""
import math
import os
import random
import subprocess
import sys
import tempfile

import make
from writers import Gltf, icosphere

BUILD = os.environ["CANDIL_BUILD"]


def field(folder):
    """One mesh under a hundred nodes, radii from 1 to 3."""
    g = Gltf()
    positions, triangles = icosphere(2)
    mesh = g.mesh(positions, triangles, g.material("white", (0.8,) * 3))
    rng = random.Random(1)
    for _ in range(100):
        radius = math.exp(rng.uniform(math.log(1), math.log(3)))
        g.node(mesh=mesh, translation=[rng.uniform(-8, 8) for _ in range(3)], scale=[radius] * 3)
    g.camera((0, 0, 20), (0, 0, 0), 50)
    return g.save(folder, "field.gltf")


def turned(folder):
    g = Gltf()
    positions, triangles = icosphere(2)
    mesh = g.mesh(positions, triangles, g.material("white", (0.8,) * 3))
    rng = random.Random(2)
    for _ in range(40):
        angle = rng.uniform(0, math.pi)
        g.node(mesh=mesh, translation=[rng.uniform(-3, 3) for _ in range(3)],
               rotation=[math.sin(angle), 0, 0, math.cos(angle)], scale=[rng.choice((-1, 1)) * rng.uniform(0.01, 2) for _ in range(3)])
    return g.save(folder, "turned.gltf")


with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder:
    scenes = [make.cornell(folder), field(folder), turned(folder)]
    loader = os.path.join(BUILD, "libexec", "candil", "candil-loader")
    sys.exit(subprocess.run([os.path.join(BUILD, "tests", "test_hits"), loader, *scenes]).returncode)
