#!/usr/bin/env python3
"""Fourteen scenes to look at, each with what it is for: a cube to begin with, cut-out leaves, mirrors, a textured house, and a
Cornell box in nine ways.

    gallery.py FOLDER [NAME...]    write the named scenes (all without a name), print their paths and what to render them with

As a module: SCENES maps a name to a function that writes its scene into a folder and returns the path of its file; `arguments`
gives what `candil render` is to be told beside it. Every scene has a camera named "camera". Lengths are metres.
"""
import math
import sys

from make import CORNELL
from writers import Gltf, box, icosphere, png, quad, rotation, transformed

WHITE = (.73, .73, .73)
SKY = ["--background", "0.14,0.2,0.3"]
# The box's walls by name: left, right, and all the others.
ORIGINAL = ((.63, .065, .05), (.14, .45, .091), WHITE)
SATURATED = ((.9, .01, .01), (.01, .85, .02), (.9, .9, .9))
ORANGE_BLUE = ((.9, .4, .05), (.05, .2, .85), WHITE)


def ball(g, centre, radius, material, subdivisions=4):
    """A sphere that is smooth to the eye: its corners have the sphere's own normals."""
    points, triangles = icosphere(subdivisions)
    g.node(mesh=g.mesh(transformed(points, scale=radius, offset=centre), triangles, material, normals=points))


def block(g, half, height, degrees, at, material):
    points, triangles = box((-half, 0, -half), (half, height, half))
    g.place(transformed(points, rotation((0, 1, 0), degrees), offset=at), triangles, material)


def two_blocks(g, short, tall):
    block(g, .3, .6, 17, (.35, 0, .35), short)
    block(g, .3, 1.2, -20, (-.35, 0, -.3), tall)


def room(colours=ORIGINAL, radiance=15.0):
    """A Cornell box without anything in it, 2 m wide, its lamp just below the ceiling."""
    g = Gltf()
    left, right, others = colours
    for part, _, corners in CORNELL:
        colour = left if part == "left" else right if part == "right" else others
        g.place(*quad(*corners), g.material(part, colour))
    g.place(*quad((-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)),
            g.material("lamp", (.78, .78, .78), (radiance,) * 3))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g


def metal(g, name, colour, roughness=0.0):
    return g.material(name, colour, metallic=1, roughness=roughness)


def solid_glass(g, name="glass", roughness=0.0):
    return g.material(name, clear=1, roughness=roughness, ior=1.5, specular=1, volume={"thicknessFactor": 1})


def open_air(g, half=12, floor=(.45, .42, .4), sun=(4, 8, 5)):
    """A floor under the sky, and the sun."""
    g.place(*quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)), g.material("floor", floor))
    g.light("directional", 2.5, sun, (0, 0, 0), (1, .95, .85), up=(0, 1, 0))


# ---- in the open -----------------------------------------------------------------------------------------------------

def cube(folder):
    """One diffuse cube in the sun: three sides of three brightnesses and a shadow with a hard edge."""
    g = Gltf()
    open_air(g, sun=(-5, 6, 2))
    block(g, .5, 1, 30, (0, 0, 0), g.material("cube", (.8, .25, .2)))
    g.camera((2, 1.8, 3), (0, .45, 0), 38)
    return g.save(folder, "cube.gltf")


def _leaf(x, y):
    """Texels of a leaf with a stalk: green within, clear without."""
    u, v = (x + .5) / 32 - .5, (y + .5) / 32 - .5
    inside = (u / .3) ** 2 + (v / .48) ** 2 < 1 or (abs(u) < .03 and v > 0)
    return (70, 140 + int(60 * (v + .5)), 40, 255 if inside else 0)


def cut_out(folder):
    """Leaves cut out by their texture's alpha, before a wall: neither they nor their shadows show a square."""
    g = Gltf()
    open_air(g)
    g.place(*quad((-3, 0, -1.5), (3, 0, -1.5), (3, 3, -1.5), (-3, 3, -1.5)), g.material("wall", (.8, .78, .7)))
    leaf = g.material("leaf", texture=g.image(png(32, 32, _leaf)), cutoff=.5, both_sides=True)
    for i in range(7):
        turn, tilt = rotation((0, 1, 0), -50 + 17 * i), rotation((0, 0, 1), 24 - 8 * i)
        corners = [(-.45, 0, 0), (.45, 0, 0), (.45, 1.4, 0), (-.45, 1.4, 0)]
        points = transformed(transformed(corners, tilt), turn, offset=(-1.5 + .5 * i, .05, .25 * (i % 3)))
        g.node(mesh=g.mesh(points, [(0, 1, 2), (0, 2, 3)], leaf, uvs=[(0, 1), (1, 1), (1, 0), (0, 0)]))
    g.camera((0, 1.3, 4.5), (0, .9, 0), 40)
    return g.save(folder, "cut_out.gltf")


def mirror_cube(folder):
    """A cube of polished metal among coloured balls: each face shows the ones before it."""
    g = Gltf()
    open_air(g)
    block(g, .6, 1.2, 30, (0, 0, 0), metal(g, "mirror", (.95, .95, .95)))
    for i, colour in enumerate(((.8, .1, .1), (.1, .6, .15), (.1, .2, .8), (.8, .7, .1))):
        a = math.radians(20 + 45 * i)
        ball(g, (1.7 * math.cos(a), .3, 1.7 * math.sin(a)), .3, g.material(f"ball {i}", colour), 3)
    g.camera((1.2, 2.0, 4.4), (0, .5, .3), 40)
    return g.save(folder, "mirror_cube.gltf")


def _speckle(x, y, n=7):
    return (x * 73856093 ^ y * 19349663) % 1000 * n // 1000


def _timber(x, y):
    """Plaster with beams round a panel and across it."""
    beam = min(x, 63 - x, y, 63 - y) < 5 or abs(x - y) < 4
    s = _speckle(x, y, 14)
    return (92 - s, 62 - s, 38 - s) if beam else (226 - s, 214 - s, 186 - s)


def _tiles(x, y):
    row = y // 8
    edge = y % 8 < 1 or (x + 4 * (row % 2)) % 8 < 1
    s = _speckle(x // 8, row, 40)
    return (90, 40, 30) if edge else (170 - s, 74 - s // 2, 52 - s // 2)


def _cobbles(x, y):
    row = y // 8
    edge = y % 8 < 1 or (x + 3 * row) % 10 < 1
    s = _speckle((x + 3 * row) // 10, row, 50)
    return (70, 66, 60) if edge else (150 - s, 144 - s, 136 - s)


def _face(g, corners, material, across, up):
    """A textured rectangle: so many repeats of its picture along its first and second edge."""
    g.node(mesh=g.mesh(list(corners), [(0, 1, 2), (0, 2, 3)], material,
                       uvs=[(0, up), (across, up), (across, 0), (0, 0)]))


def _house(g, at, turn, size, materials):
    width, depth, height = size
    timber, tiles, dark = materials
    place = lambda *points: transformed(points, rotation((0, 1, 0), turn), offset=at)
    w, d, ridge = width / 2, depth / 2, height + width * .55
    _face(g, place((-w, 0, d), (w, 0, d), (w, height, d), (-w, height, d)), timber, 3, 2)
    _face(g, place((w, 0, -d), (-w, 0, -d), (-w, height, -d), (w, height, -d)), timber, 3, 2)
    _face(g, place((w, 0, d), (w, 0, -d), (w, height, -d), (w, height, d)), timber, 4, 2)
    _face(g, place((-w, 0, -d), (-w, 0, d), (-w, height, d), (-w, height, -d)), timber, 4, 2)
    for sign in (1, -1):
        gable = place((-w, height, sign * d), (w, height, sign * d), (0, ridge, sign * d))
        g.node(mesh=g.mesh(gable, [(0, 1, 2) if sign > 0 else (0, 2, 1)], timber, uvs=[(0, 1), (3, 1), (1.5, 0)]))
        o, low = 1.15 * w, height - .15 * (ridge - height)
        eave = [(sign * o, low, sign * 1.1 * d), (sign * o, low, -sign * 1.1 * d), (0, ridge, -sign * 1.1 * d), (0, ridge, sign * 1.1 * d)]
        _face(g, place(*eave), tiles, 4, 3)
    _face(g, place((-.3, 0, d + .01), (.3, 0, d + .01), (.3, 1.1, d + .01), (-.3, 1.1, d + .01)), dark, 1, 1)
    for x in (-w * .6, w * .6):
        _face(g, place((x - .2, 1.1, d + .01), (x + .2, 1.1, d + .01), (x + .2, 1.6, d + .01), (x - .2, 1.6, d + .01)), dark, 1, 1)


def village(folder):
    """Half-timbered houses on cobbles: textures everywhere, colour bleeding into the shadows under the eaves."""
    g = Gltf()
    g.light("directional", 3.0, (6, 8, 7), (0, 0, 0), (1, .93, .8), up=(0, 1, 0))
    cobbles = g.material("cobbles", texture=g.image(png(40, 40, _cobbles)))
    _face(g, [(-12, 0, 12), (12, 0, 12), (12, 0, -12), (-12, 0, -12)], cobbles, 16, 16)
    materials = (g.material("timber", texture=g.image(png(64, 64, _timber)), both_sides=True),
                 g.material("tiles", texture=g.image(png(64, 64, _tiles)), both_sides=True), g.material("dark", (.06, .04, .03)))
    _house(g, (0, 0, 0), 25, (3, 4, 2.2), materials)
    _house(g, (-4.2, 0, -1), -15, (2.4, 3, 1.8), materials)
    _house(g, (3.6, 0, -3.5), 5, (2.6, 3.4, 3.0), materials)
    g.camera((1.5, 2.4, 9.5), (-.4, 1.5, 0), 42)
    return g.save(folder, "village.gltf")


def mirror_floor(folder):
    """Two cubes on a mirror: their pictures stand upside down below them, and the sun lights their sides a second time from it."""
    g = Gltf()
    g.light("directional", 2.5, (4, 8, 5), (0, 0, 0), (1, .95, .85), up=(0, 1, 0))
    g.place(*quad((-2.2, 0, 2.2), (2.2, 0, 2.2), (2.2, 0, -2.2), (-2.2, 0, -2.2)), metal(g, "mirror", (.9, .9, .9)))
    block(g, .45, .9, 20, (-.8, 0, 0), g.material("red", (.75, .12, .1)))
    block(g, .45, .9, -30, (.8, 0, -.4), g.material("blue", (.1, .2, .7)))
    g.camera((0, 1.5, 4.2), (0, .35, 0), 38)
    return g.save(folder, "mirror_floor.gltf")


# ---- in the box ------------------------------------------------------------------------------------------------------

def cornell_original(folder):
    """The box as measured at Cornell, more or less: soft shadows, red and green on the blocks' sides."""
    g = room()
    white = g.material("blocks", WHITE)
    two_blocks(g, white, white)
    return g.save(folder, "cornell_original.gltf")


def cornell_mirror(folder):
    """Its tall block is a mirror, and throws the lamp's light on the floor and the left wall."""
    g = room()
    two_blocks(g, g.material("block", WHITE), metal(g, "mirror", (.95, .95, .95)))
    return g.save(folder, "cornell_mirror.gltf")


def cornell_spheres(folder):
    """A mirror's ball and one of glass: the lamp twice in the one, the room upside down in the other, a caustic below it."""
    g = room()
    ball(g, (-.4, .42, -.3), .42, metal(g, "mirror", (.95, .95, .95)))
    ball(g, (.45, .42, .3), .42, solid_glass(g))
    return g.save(folder, "cornell_spheres.gltf")


def cornell_saturated(folder):
    """Walls of nearly pure colours: what bleeds from them is as strong."""
    g = room(SATURATED)
    white = g.material("blocks", (.9, .9, .9))
    two_blocks(g, white, white)
    return g.save(folder, "cornell_saturated.gltf")


def cornell_glossy(folder):
    """Blocks of brushed metal and plastic, the floor half a mirror."""
    g = room()
    g.place(*quad((-1, .002, 1), (1, .002, 1), (1, .002, -1), (-1, .002, -1)), g.material("gloss", WHITE, specular=1, roughness=.15))
    two_blocks(g, g.material("plastic", (.15, .3, .7), specular=1, roughness=.2), metal(g, "brushed", (.9, .75, .5), .35))
    return g.save(folder, "cornell_glossy.gltf")


def cornell_weekend(folder):
    """A glass ball and a tall block of polished aluminium."""
    g = room(((.65, .05, .05), (.12, .45, .15), WHITE))
    block(g, .3, 1.2, -18, (-.35, 0, -.3), metal(g, "aluminium", (.8, .85, .88)))
    ball(g, (.42, .33, .35), .33, solid_glass(g))
    return g.save(folder, "cornell_weekend.gltf")


def cornell_empty(folder):
    """Nothing but walls and lamp."""
    return room().save(folder, "cornell_empty.gltf")


def cornell_orange_blue(folder):
    """The empty box between an orange and a blue wall."""
    return room(ORANGE_BLUE).save(folder, "cornell_orange_blue.gltf")


def cornell_white(folder):
    """All white, nearly all of the light comes back: the longest paths there are, and the noise of all of them."""
    g = room(((.95,) * 3,) * 3, 3.0)
    white = g.material("blocks", (.95,) * 3)
    two_blocks(g, white, white)
    return g.save(folder, "cornell_white.gltf")


SCENES = {f.__name__: f for f in (cube, cut_out, mirror_cube, village, mirror_floor, cornell_original, cornell_mirror, cornell_spheres,
                                  cornell_saturated, cornell_glossy, cornell_weekend, cornell_empty, cornell_orange_blue,
                                  cornell_white)}


def arguments(name):
    return [] if name.startswith("cornell") else SKY


def main():
    if len(sys.argv) < 2 or any(name not in SCENES for name in sys.argv[2:]):
        sys.exit("usage: gallery.py FOLDER [NAME...]\nnames: " + " ".join(SCENES))
    for name in sys.argv[2:] or SCENES:
        print(SCENES[name](sys.argv[1]), *arguments(name))


if __name__ == "__main__":
    main()
