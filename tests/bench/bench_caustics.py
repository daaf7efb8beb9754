"""What light paths are worth: the error of pictures with the effect `caustics` and without, and the time that they took.

    bench_caustics.py [SAMPLES [REFERENCE_SAMPLES [PART]]]

Prints relMSE against a picture of many samples of other seeds, milliseconds of the stages `trace` and `caustics`, and how
many times the error falls in equal time: (error × time without) / (error × time with). The reference is the mean of a picture with
and one without light paths where both find all light, and its two means' ratio is printed. PART, a word in the scenes' names,
picks some. With CANDIL_BUILD, CANDIL_SOURCE and PYTHONPATH as tests have them."""
import math
import os
import sys

import images
import make
import skies
from render import Daemon
from writers import Gltf, icosphere, quad, transformed

SIZE = (48, 48)


def room(g):
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)


def clear(g, roughness=0):
    return g.material("glass", clear=1, roughness=roughness, ior=1.5, volume={"thicknessFactor": 1})


def metal(g, roughness=0):
    return g.material("metal", (.9, .9, .9), metallic=1, roughness=roughness)


def sphere(g, radius, at, material, inward=False):
    points, triangles = icosphere(3, radius=radius, inward=inward)
    sign = -1 if inward else 1
    g.node(mesh=g.mesh(transformed(points, offset=at), triangles, material, normals=[[sign * c / radius for c in p] for p in points]))


def lamp(g, half, at):
    x, y, z = at
    g.place(*quad((x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half)),
            g.material("lamp", (0, 0, 0), (1 / half ** 2,) * 3))


def bulb(folder):
    """A small lamp in a bulb of clear glass, its wall a twentieth of its radius, in a room that it alone lights."""
    g = Gltf()
    room(g)
    glass = clear(g)
    sphere(g, .2, (0, 1.2, 0), glass)
    sphere(g, .19, (0, 1.2, 0), glass, True)
    points, triangles = icosphere(2, radius=.03)
    g.place(transformed(points, offset=(0, 1.2, 0)), triangles, g.material("lamp", (0, 0, 0), (.6 / .03 ** 2,) * 3))
    return g.save(folder, "bulb.gltf")


def ball(folder):
    """A ball of clear glass under a small lamp."""
    g = Gltf()
    room(g)
    sphere(g, .45, (0, .6, 0), clear(g))
    lamp(g, .1, (0, 1.98, 0))
    return g.save(folder, "ball.gltf")


def ring(g, material):
    """A band about the origin, polished on its inner side."""
    points, normals, triangles = [], [], []
    for i in range(48):
        a, j = 2 * math.pi * i / 48, (i + 1) % 48
        for height in (0, .4):
            points.append((.6 * math.cos(a), height, .6 * math.sin(a)))
            normals.append((-math.cos(a), 0, -math.sin(a)))
        triangles += [(2 * i, 2 * i + 1, 2 * j + 1), (2 * i, 2 * j + 1, 2 * j)]
    g.node(mesh=g.mesh(points, triangles, material, normals=normals))


def yard(folder, shape, half=None):
    """A floor and a wall, what throws caustics, and a lamp or the sky alone."""
    g = Gltf()
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
    g.place(*quad((-2, 0, -2), (2, 0, -2), (2, 2, -2), (-2, 2, -2)), g.material("wall", (.6,) * 3))
    shape(g)
    if half:
        lamp(g, half, (.6, 2, 0))
    g.camera((0, 1.8, 2.6), (0, .3, 0), 45)
    return g.save(folder, "yard.gltf")


SHAPES = (("metal ball", lambda g, r: sphere(g, .4, (0, .45, 0), metal(g, r))), ("metal ring", lambda g, r: ring(g, metal(g, r))),
          ("glass ball", lambda g, r: sphere(g, .4, (0, .45, 0), clear(g, r))))


def patch(folder, sun):
    """A hazy sky with a disc of 6 degrees that much brighter. Its file and the contrast of its luminance."""
    sky = skies.sunset(128, sun=0)
    towards = (.5025, .7035, .5025)
    sky += ((skies.directions(128, 64) @ towards) > math.cos(math.radians(3)))[:, :, None] * sun
    path = os.path.join(folder, "sky.exr")
    images.write(path, sky)
    light, solid = sky @ (.2126, .7152, .0722), skies.solid_angles(128, 64)[:, None]
    return path, 4 * math.pi * (light ** 2 * solid).sum() / (light * solid).sum() ** 2


def race(daemon, name, scene, samples, many, arguments=(), reference="-+"):
    truths = [daemon.render(scene, size=SIZE, spp=many, arguments=["--seed", str(77 + i), "--effects", f"auto,{e}caustics", *arguments]).radiance
              for i, e in enumerate(reference)]
    truth = sum(t.astype("f8") for t in truths) / len(truths)
    rows = []
    for switch in "-+":
        errors, times = [], []
        for seed in range(4):
            picture = daemon.render(scene, size=SIZE, spp=samples,
                                    arguments=["--seed", str(seed), "--effects", f"auto,{switch}caustics", *arguments])
            times.append(sum(s["us"] / 1000 for s in picture.report["stages"] if s["name"] in ("trace", "caustics")))
            errors.append(images.relmse(picture.radiance, truth))
        rows.append((sum(errors) / len(errors), min(times)))
    gain = rows[0][0] * rows[0][1] / (rows[1][0] * rows[1][1])
    means = f", means' ratio {truths[1].mean() / truths[0].mean():.4f}" if len(truths) == 2 else ""
    print(f"{name}: relMSE {rows[0][0]:.5f} in {rows[0][1]:.0f} ms by chance, {rows[1][0]:.5f} in {rows[1][1]:.0f} ms with light paths: "
          f"1 / {gain:.2f} in equal time{means}", flush=True)


def main():
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 64
    many = int(sys.argv[2]) if len(sys.argv) > 2 else 4096
    part = sys.argv[3] if len(sys.argv) > 3 else ""
    with Daemon() as daemon:
        for name, make_scene in (("cornell_glass", make.cornell_glass), ("ball in a room", ball), ("bulb", bulb)):
            if part in name:
                race(daemon, name, make_scene(daemon.folder), samples, many, reference="+")
        for shape, place in SHAPES:
            for roughness in (.05, .15, .3, .4, .5):
                for half in (.05, .3):
                    name = f"{shape} of roughness {roughness}, lamp of {2 * half:g} m"
                    if part in name:
                        race(daemon, name, yard(daemon.folder, lambda g: place(g, roughness), half), samples, many)
        for shape, place, roughness in ((*SHAPES[2], 0), (*SHAPES[1], 0), (*SHAPES[1], .2)):
            for sun in (20, 30, 100, 1000):
                sky, contrast = patch(daemon.folder, sun)
                name = f"{shape} of roughness {roughness}, sky of contrast {contrast:.0f}"
                if part in name:
                    race(daemon, name, yard(daemon.folder, lambda g: place(g, roughness)), samples, many, ["--background", sky], "+")


if __name__ == "__main__":
    main()
