#!/usr/bin/env python3
"""What projected form factors are worth: the radiosity of a closed box by few rays, with radiosity.project=none, sums and both.

    /usr/bin/python3 tests/bench/bench_project.py     # 2 minutes

The box is of 2 m with a lamp of 0.36 m² beneath its ceiling and a block, which floats or stands on the floor; 400 patches. The error
is that of B, root of Σ A (B - C)² over Σ A (C - M)², beside a control C of 131,072 rays that is not projected. The balance is what
arrives and is not reflected, over what the lamp sends: 1, in truth, whatever the control. `points` and `factors` say how light of the
lamp is found (radiosity.emitters)."""
import os
import sys

import bench

sys.path.append(os.path.join(bench.SOURCE, "tests", "cli"))

import numpy
import test_patch_files
from make import CORNELL
from test_patch_files import Ply, daemon, file_of, load
from writers import Gltf, box, quad

RAYS, CONTROL = (64, 256, 1024, 3072), 131072
PROJECTIONS = ("none", "sums", "both")


def closed_box(folder, name, albedo, low):
    """`albedo`: of all surfaces; None: coloured walls. `low`: height of the block above the floor."""
    g = Gltf()
    for part, colour, corners in CORNELL:
        g.place(*quad(*corners), g.material(part, (albedo,) * 3 if albedo else colour))
    g.place(*quad((-1, 0, 1), (-1, 2, 1), (1, 2, 1), (1, 0, 1)), g.material("front", (albedo or .7,) * 3))
    g.place(*box((-.5, low, -.3), (0, low + .7, .2)), g.material("block", (albedo or .6,) * 3))
    g.place(*quad((-.3, 1.98, -.3), (.3, 1.98, -.3), (.3, 1.98, .3), (-.3, 1.98, .3)), g.material("lamp", (.3,) * 3, (12,) * 3))
    g.camera((0, 1, .9), (0, .9, -1), 60)
    return load(g.save(folder, name + ".gltf"), name)


def light(scene, **options):
    """B and M by element, the areas, and the balance. B of what light does not reach is 0."""
    ply = Ply(file_of(scene, "ply", patches=400, residual=1e-6, **options)[0])
    b, m, rho = (ply.colour(name).astype(float) for name in ("b", "m", "rho"))
    area, here = ply.of["area"].astype(float)[:, None], ply.of["reached"] == 1
    absorbed = (area * (1 - rho) * (b - m) / rho)[here].sum()
    return b, m, area, absorbed / (area * m)[here].sum()


def main():
    rows = []
    for name, albedo, low in (("coloured, block floats", None, .1), ("white .9, block floats", .9, .1), ("white .98, block floats", .98, .1),
                              ("coloured, block stands", None, 0), ("white .9, block stands", .9, 0), ("white .98, block stands", .98, 0)):
        scene = closed_box(daemon.folder, name.replace(" ", "_").replace(",", ""), albedo, low)
        for emitters in ("points", "factors"):
            control, m, area, balance = light(scene, rays=CONTROL, emitters=emitters)
            size = numpy.sqrt((area * (control - m) ** 2).sum())
            rows.append((name, emitters, f"{CONTROL:,}", "", "", "", f"{balance:.4f}", "", ""))
            for rays in RAYS:
                found = [light(scene, rays=rays, emitters=emitters, project=project) for project in PROJECTIONS]
                errors = [numpy.sqrt((area * (b - control) ** 2).sum()) / size for b, _, _, _ in found]
                rows.append(("", "", f"{rays:,}", *(f"{100 * e:.2f} %" for e in errors), *(f"{f[3]:.4f}" for f in found)))
    bench.header("llvmpipe")
    bench.table(("box", "lamp by", ">rays", *(">" + p for p in PROJECTIONS), *(">balance, " + p for p in PROJECTIONS)), rows)


if __name__ == "__main__":
    with test_patch_files.daemon:
        main()
