"""Closed rooms for tests and benchmarks of techniques that think in voxels: how light adds up in one, and how much of it
leaks from one to the next."""
import math

from writers import Gltf, box, icosphere, quad, rotation, transformed

MARGIN = 2.75  # voxels that the longest axis leaves free: shaders/shared/voxel.h


def uniform_room(folder, rho=0.5, size=2.0, turned=0.0, name=None):
    """A cube of one albedo, rho, that emits 1 - rho inwards: radiance 1, and 1 - rho^(N+1) after N scattering events."""
    g = Gltf()
    turn = rotation((1, 2, 3), turned)
    positions, triangles = box((-size / 2,) * 3, (size / 2,) * 3, inward=True)
    g.place(transformed(positions, turn), triangles, g.material("wall", (rho,) * 3, (1 - rho,) * 3))
    eye, target, up = transformed([(-.05 * size, .1 * size, .3 * size), (.2 * size, -.1 * size, -.5 * size), (0, 1, 0)], turn)
    g.camera(eye, target, 80, up=up)
    return g.save(folder, name or "uniform_%g_%g_%g.gltf" % (rho, size, turned))


def plane(folder, albedo=0.7, size=2.0, name=None):
    """A square and nothing else: under a background of 1 its front is its albedo."""
    g = Gltf()
    s = size / 2
    g.place(*quad((-s, 0, s), (s, 0, s), (s, 0, -s), (-s, 0, -s)), g.material("plane", (albedo,) * 3))
    g.camera((0, 1.2 * size, 0.01), (0, 0, 0), 40)
    return g.save(folder, name or "plane_%g.gltf" % albedo)


def light_box(folder):
    """Three spheres of 7,680 triangles in all that glow in three colours, in a grey room."""
    g = Gltf()
    g.place(*box((-1, 0, -1), (1, 2, 1), inward=True), g.material("walls", (.7,) * 3))
    for i, colour in enumerate(((3, 1, .5), (.5, 3, 1), (.5, 1, 3))):
        positions, triangles = icosphere(3 if i else 4, 0.25)
        g.place(positions, triangles, g.material(f"glow {i}", (.2,) * 3, colour), translation=[-.6 + .6 * i, .4 + .3 * i, -.3])
    g.camera((0, 1, .95), (0, .9, -1), 75)
    return g.save(folder, "light_box.glb")


def _extent(points):
    return max(max(p[i] for p in points) - min(p[i] for p in points) for i in range(3))


class TwoRooms:
    """A dark room beside a bright one, all walls of albedo 0.7, a point light in the bright one alone. The wall between them is
    `voxels` thick at a resolution and lies `shift` voxels further; `turned` degrees about (1, 2, 3). Light inside the dark room
    is a leak, whole. Cameras "inside" and "outside" are each other's mirror images."""

    def __init__(self, folder, resolution, voxels, shift=0.0, turned=0.0):
        turn = rotation((1, 2, 3), turned)
        width, half = 4.0, 1.0
        hull = transformed(box((-width / 2, -half, -half), (width / 2, half, half))[0], turn)
        self.voxel = _extent(hull) / (resolution - MARGIN)
        thick, middle = voxels * self.voxel, shift * self.voxel
        g = Gltf()
        white = g.material("walls", (.7,) * 3)
        for low, high in ((-width / 2, middle - thick / 2), (middle + thick / 2, width / 2)):
            positions, triangles = box((low, -half, -half), (high, half, half), inward=True)
            g.place(transformed(positions, turn), triangles, white)
        (lamp,) = transformed([(-1.1, .3, .2)], turn)
        g.light("point", 3.0, lamp)
        for camera, side in (("outside", -1), ("inside", 1)):
            eye, target, up = transformed([(side * 1.8, .6, .8), (side * .2, -.3, -.5), (0, 1, 0)], turn)
            g.camera(eye, target, 75, camera, up)
        self.path = g.save(folder, "rooms_%d_%g_%g_%g.gltf" % (resolution, voxels, shift, turned))


LEAK_SHIFTS = (0.0, 1 / 3, 2 / 3)  # voxels
LEAK_THICKNESSES = (4, 2, 1, .5, .25)  # voxels


def leak(daemon, rooms, resolution, size=(48, 48), options=None):
    """(mean, 99th percentile) of the dark room's radiance over the bright room's mean."""
    import numpy
    arguments = ["--technique", "vct"]
    every = {"vct.resolution": resolution, **(options or {})}
    inside, outside = (daemon.render(rooms.path, size=size, spp=1, camera=camera, options=every, arguments=arguments)
                       .radiance.mean(axis=2, dtype=numpy.float64) for camera in ("inside", "outside"))
    assert math.isfinite(inside.sum()) and outside.mean() > 0.01, "the bright room is not bright"
    return inside.mean() / outside.mean(), float(numpy.percentile(inside, 99)) / outside.mean()
