"""Scenes whose light is hard to find, or falls on few: small lamps and glossy walls, a lamp in a shade, a door ajar, a lantern,
slats in the sun. Each function writes one into a folder and returns the path of its file, with a camera named "camera"."""
import math

import gallery
from writers import Gltf, box, quad, transformed


def inside_room(half, colour=(.7, .65, .6), **surface):
    """A room of one surface, its camera in a corner."""
    g = Gltf()
    g.place(*box((-half, 0, -half), (half, 1.5 * half, half), inward=True), g.material("walls", colour, **surface))
    g.camera((.85 * half, .8 * half, .85 * half), (-.25 * half, .5 * half, -.25 * half), 60)
    return g


def down(g, at, half, radiance):
    """A square lamp that looks down."""
    x, y, z = at
    g.place(*quad((x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half)),
            g.material("lamp", (0, 0, 0), (radiance,) * 3))


def brushed(folder):
    """A glossy room with a small lamp and a ball of brushed metal."""
    g = inside_room(2, specular=1, roughness=.35)
    down(g, (.8, 2.6, .3), .06, 1500)
    gallery.ball(g, (0, .7, 0), .6, g.material("ball", (.95, .7, .4), metallic=1, roughness=.15))
    return g.save(folder, "brushed.gltf")


def tube(radius, low, high, sides=24):
    """A cylinder's wall, its front within."""
    points, triangles = [], []
    for i in range(sides):
        a, j = 2 * math.pi * i / sides, (i + 1) % sides
        points += [(radius * math.cos(a), y, radius * math.sin(a)) for y in (low, high)]
        triangles += [(2 * i, 2 * i + 1, 2 * j + 1), (2 * i, 2 * j + 1, 2 * j)]
    return points, triangles


def shade(folder, **surface):
    """A lamp deep in a shade, open above alone: the room is lit by way of the ceiling."""
    g = inside_room(2)
    at = (-.5, 1.0, -.5)
    white = g.material("shade", **{"albedo": (.8,) * 3, **surface})
    points, triangles = tube(.25, 0, .8)
    g.place(points, triangles, white, translation=list(at))
    g.place(*quad((-.3, 0, .3), (.3, 0, .3), (.3, 0, -.3), (-.3, 0, -.3)), white, translation=list(at))
    g.place(*quad((-.05, .1, .05), (.05, .1, .05), (.05, .1, -.05), (-.05, .1, -.05)), g.material("lamp", (0, 0, 0), (800,) * 3),
            translation=list(at))
    return g.save(folder, "shade.gltf")


def metal_shade(folder):
    return shade(folder, albedo=(.9, .8, .6), metallic=1, roughness=.1)


def ajar(folder, slit=.12):
    """Two rooms and a slit between them; the lamp is in the one, the camera in the other."""
    g = Gltf()
    g.place(*box((-4, 0, -2), (4, 2.5, 2), inward=True), g.material("walls", (.75,) * 3))
    g.place(*box((-.05, 0, -2), (.05, 2.5, 1.5 - slit)), g.material("wall", (.75,) * 3))
    g.place(*box((-.05, 0, 1.5), (.05, 2.5, 2)), g.material("jamb", (.75,) * 3))
    down(g, (-2.5, 2.4, -1), .3, 60)
    g.camera((3.5, 1.4, 1.2), (0, 1, -.3), 60)
    return g.save(folder, "ajar.gltf")


def keyhole(folder):
    return ajar(folder, .02)


def rough_metals(folder):
    """Balls of metal too rough for light paths between rough walls of it, under a tiny lamp."""
    g = inside_room(2, (.8, .8, .85), metallic=1, roughness=.6)
    down(g, (.2, 2.9, -.2), .03, 4000)
    for i in range(3):
        gallery.ball(g, (-.9 + .8 * i, .4, -.4 * i), .4, g.material(f"ball {i}", (.9, .6 + .1 * i, .4), metallic=1, roughness=.55))
    return g.save(folder, "rough_metals.gltf")


def panes(folder):
    """A lamp seen and found through rough glass alone: a lantern."""
    g = inside_room(2)
    points, triangles = box((-.3, 0, -.3), (.3, .6, .3))
    g.place(transformed(points, offset=(-.4, .8, -.4)), triangles, g.material("glass", clear=1, roughness=.6, ior=1.5, specular=1))
    points, triangles = box((-.03, 0, -.03), (.03, .1, .03))
    g.place(transformed(points, offset=(-.4, 1.0, -.4)), triangles, g.material("lamp", (0, 0, 0), (900,) * 3))
    return g.save(folder, "panes.gltf")


def tree_shade(folder):
    """The sun by way of many small gaps: two sheets of slats above a floor."""
    g = Gltf()
    g.place(*quad((-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)), g.material("floor", (.6, .55, .5)))
    slat = g.material("slat", (.4, .5, .3), both_sides=True)
    for i in range(24):
        x = -4 + i / 3
        g.place(*quad((x, 2, 4), (x + .3, 2, 4), (x + .3, 2, -4), (x, 2, -4)), slat)
        g.place(*quad((-4, 2.5, x), (-4, 2.5, x + .3), (4, 2.5, x + .3), (4, 2.5, x)), slat)
    g.light("directional", 6, (1, 5, 2), (0, 0, 0), up=(0, 1, 0))
    g.camera((0, 1.6, 3.9), (0, .3, 0), 60)
    return g.save(folder, "tree_shade.gltf")


def balls_at_dusk(folder):
    """Glossy balls under a hazy sky with a low sun in it."""
    g = Gltf()
    g.place(*quad((-6, 0, 6), (6, 0, 6), (6, 0, -6), (-6, 0, -6)), g.material("floor", (.5,) * 3, specular=1, roughness=.4))
    for i in range(3):
        gallery.ball(g, (-1.3 + 1.3 * i, .6, 0), .6, g.material(f"ball {i}", (.8, .7, .6), metallic=i % 2, roughness=.1 + .2 * i, specular=1))
    g.camera((0, 1.5, 5), (0, .5, 0), 40)
    return g.save(folder, "dusk.gltf")
