"""What light paths are worth: the error of pictures with the effect `caustics` and without, and the time that they took.

    bench_caustics.py [SAMPLES [REFERENCE_SAMPLES]]

Prints relMSE against a picture of many samples of another seed, milliseconds of the stages `trace` and `caustics`, and how
many times the error falls in equal time: (error × time without) / (error × time with). With CANDIL_BUILD, CANDIL_SOURCE and
PYTHONPATH as tests have them."""
import sys
import tempfile

import make
from images import relmse
from render import Daemon
from writers import Gltf, icosphere, quad, transformed


def room(g):
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)


def bulb(folder, lamp=.03):
    """A small lamp in a bulb of clear glass, its wall a twentieth of its radius, in a room that it alone lights."""
    g = Gltf()
    room(g)
    glass = g.material("glass", clear=1, roughness=0, ior=1.5, volume={"thicknessFactor": 1})
    for radius, inward in ((.2, False), (.19, True)):
        ball, triangles = icosphere(3, radius=radius, inward=inward)
        sign = -1 if inward else 1
        g.node(mesh=g.mesh(transformed(ball, offset=(0, 1.2, 0)), triangles, glass,
                           normals=[[sign * c / radius for c in p] for p in ball]))
    ball, triangles = icosphere(2, radius=lamp)
    g.place(transformed(ball, offset=(0, 1.2, 0)), triangles, g.material("lamp", (0, 0, 0), (.6 / lamp ** 2,) * 3))
    return g.save(folder, "bulb.gltf")


def ball(folder):
    """A ball of clear glass under a small lamp."""
    g = Gltf()
    room(g)
    glass = g.material("glass", clear=1, roughness=0, ior=1.5, volume={"thicknessFactor": 1})
    points, triangles = icosphere(3, radius=.45)
    g.node(mesh=g.mesh(transformed(points, offset=(0, .6, 0)), triangles, glass, normals=[[c / .45 for c in p] for p in points]))
    s = .1
    g.place(*quad((-s, 1.98, -s), (s, 1.98, -s), (s, 1.98, s), (-s, 1.98, s)), g.material("lamp", (0, 0, 0), (100,) * 3))
    return g.save(folder, "ball.gltf")


def main():
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 64
    many = int(sys.argv[2]) if len(sys.argv) > 2 else 4096
    with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder, Daemon() as daemon:
        for name, scene in (("cornell_glass", make.cornell_glass(folder)), ("ball", ball(folder)), ("bulb", bulb(folder))):
            truth = daemon.render(scene, size=(48, 48), spp=many, arguments=["--seed", "77"]).radiance
            costs = []
            for switch in ("-caustics", "+caustics"):
                picture = daemon.render(scene, size=(48, 48), spp=samples, arguments=["--effects", "auto," + switch])
                times = {s["name"]: s["us"] / 1000 for s in picture.report["stages"] if s["name"] in ("trace", "caustics")}
                error = relmse(picture.radiance, truth)
                costs.append(error * sum(times.values()))
                print(f"{name} {switch}: relMSE {error:.5f}, {times} ms, estimated {picture.report['estimated_relmse']:.5f}", flush=True)
            print(f"{name}: {costs[0] / costs[1]:.2f} times less error in equal time", flush=True)


if __name__ == "__main__":
    main()
