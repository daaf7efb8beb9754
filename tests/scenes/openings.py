"""Rooms that are lit by the sky through an opening, and what is known of them."""
import math

import numpy

from writers import Gltf, box

WALL = 0.2  # metres thick


def _solids(folder, name, albedo, solids, camera, emission=(0, 0, 0)):
    g = Gltf()
    material = g.material("walls", (albedo,) * 3, emission)
    for low, high, *own in solids:
        g.place(*box(low, high), own[0](g) if own else material)
    g.camera(*camera)
    return g.save(folder, name)


def well(folder, depth, walls=0.0, floor=0.5, emission=0.0):
    """A square well of 1 m by 1 m, open at y = `depth`; its camera sees most of the floor and nothing else. `emission` is the
    radiance of the whole inside."""
    w, d = WALL, depth
    under = [((-.5 - w, -w, -.5 - w), (.5 + w, 0, .5 + w), lambda g: g.material("floor", (floor,) * 3, (emission,) * 3))]
    around = [((-.5 - w, 0, -.5 - w), (-.5, d, .5 + w)), ((.5, 0, -.5 - w), (.5 + w, d, .5 + w)),
              ((-.5, 0, -.5 - w), (.5, d, -.5)), ((-.5, 0, .5), (.5, d, .5 + w))]
    height = .9 * d
    camera = ((0, height, 0), (0, 0, 0), math.degrees(2 * math.atan(.45 / height)), "floor", (0, 0, -1))
    return _solids(folder, f"well_{depth:g}_{walls:g}_{floor:g}_{emission:g}.gltf", walls, under + around, camera, (emission,) * 3)


def seen_from_floor(depth, side):
    """The form factor from places on the floor of `well` to its opening, in the middles of the side x side pixels of its camera:
    Howell B-4, four rectangles with a corner above the place."""
    def corner(a, b):
        u, v = numpy.sqrt(1 + a * a), numpy.sqrt(1 + b * b)
        return (a / u * numpy.arctan(b / u) + b / v * numpy.arctan(a / v)) / (2 * math.pi)
    at = ((numpy.arange(side) + .5) / side - .5) * .9
    x, z = numpy.meshgrid(at, at)
    return sum(corner((.5 + i * x) / depth, (.5 + j * z) / depth) for i in (-1, 1) for j in (-1, 1))


def window(folder, share=.02, albedo=.7):
    """A room of 4 x 2.5 x 4 m with a window of this share of the wall at z = -2."""
    w, half, middle = WALL, .5 * math.sqrt(10 * share), 1.4
    solids = [((-2 - w, -w, -2 - w), (2 + w, 0, 2 + w)), ((-2 - w, 2.5, -2 - w), (2 + w, 2.5 + w, 2 + w)),
              ((-2 - w, 0, -2 - w), (-2, 2.5, 2 + w)), ((2, 0, -2 - w), (2 + w, 2.5, 2 + w)), ((-2, 0, 2), (2, 2.5, 2 + w)),
              ((-2, 0, -2 - w), (-half, 2.5, -2)), ((half, 0, -2 - w), (2, 2.5, -2)),
              ((-half, 0, -2 - w), (half, middle - half, -2)), ((-half, middle + half, -2 - w), (half, 2.5, -2))]
    return _solids(folder, f"window_{share:g}.gltf", albedo, solids, ((-1.8, 1.6, 1.8), (.5, .8, -1), 75))


def courtyard(folder, albedo=.7):
    """A court of 10 x 10 m between walls of 6 m, with an arcade along one of them."""
    solids = [((-6, -WALL, -6), (6, 0, 6)), ((-6, 0, -6), (-5, 6, 6)), ((5, 0, -6), (6, 6, 6)), ((-5, 0, -6), (5, 6, -5)),
              ((-5, 0, 5), (5, 6, 6)), ((-5, 3, -5), (-3, 3.3, 5))]
    solids += [((-3.4, 0, z - .2), (-3, 3, z + .2)) for z in (-4, -2, 0, 2, 4)]
    return _solids(folder, "courtyard.gltf", albedo, solids, ((3, 1.7, 3), (-3.5, 1.5, -2), 75))
