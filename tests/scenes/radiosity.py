#!/usr/bin/env python3
"""Scenes for radiosity, of the sizes that the theses on it measured: a room of five objects and a lamp sphere, also with mirrors,
and a street canyon under a dome.

    radiosity.py FOLDER [NAME...]    write the named scenes (all without a name), print their paths and what to render them with

As a module: SCENES maps a name to a function that writes its scene into a folder and returns the path of its file, OPTIONS to
the option by which it has the patches that its function says. Every scene has a camera named "camera"; lengths are metres.
Surfaces are flat and purely diffuse but for the mirrors, and have no textures.
"""
import math
import sys

from make import CORNELL
from writers import Gltf, icosphere, quad, rotation, transformed

EDGE = 0.05  # of the room's patches
MIRRORS = (0, 16, 32, 64)


def ring_of(points, height, radius, sides):
    """`points`, and the corners of a level polygon about the axis y: counter-clockwise seen from above."""
    return points + [[radius * math.cos(2 * math.pi * i / sides), height, -radius * math.sin(2 * math.pi * i / sides)]
                     for i in range(sides)]


def standing_block(half, height):
    """A block's four sides and its top, counter-clockwise seen from outside: what it stands on closes it."""
    ring = [(-half, half), (half, half), (half, -half), (-half, -half)]
    points = [[x, y, z] for y in (0, height) for x, z in ring]
    faces = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)] + [(4, 5, 6, 7)]
    return points, [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]


def column(sides, radius, height):
    """A standing column: quads about it, and a lid of triangles."""
    points = ring_of(ring_of([[0, height, 0]], 0, radius, sides), height, radius, sides)
    triangles = []
    for i in range(sides):
        a, b = 1 + i, 1 + (i + 1) % sides
        triangles += [(a, b, b + sides), (a, b + sides, a + sides), (0, a + sides, b + sides)]
    return points, triangles


def pyramid(half, height):
    points = [[-half, 0, half], [half, 0, half], [half, 0, -half], [-half, 0, -half], [0, height, 0]]
    return points, [(i, (i + 1) % 4, 4) for i in range(4)]


def left_wall(g, colour, mirrors):
    """The wall as one quad; or a mirror of so many patches in it, with four quads of wall around it, all cut alike."""
    red = g.material("left", colour)

    def piece(near, low, far, high, material):
        g.place(*quad((-1, low, near), (-1, low, far), (-1, high, far), (-1, high, near)), material)

    if not mirrors:
        piece(1, 0, -1, 2, red)
        return
    columns, rows = {16: (4, 4), 32: (8, 4), 64: (8, 8)}[mirrors]
    near, low = .3, 1.0
    far, high = near - columns * EDGE, low + rows * EDGE
    for sides in ((1, 0, -1, low), (1, high, -1, 2), (1, low, near, high), (far, low, -1, high)):
        piece(*sides, red)
    piece(near, low, far, high, g.material("mirror", (.95, .95, .95), metallic=1, roughness=0))


def room(folder, mirrors=0, radiance=40.0, name=None):
    """A Cornell box of 2 m, open towards the camera, with a tall and a short block, a ball on the short one, a column and a
    pyramid, lit by a sphere that hangs below the ceiling. With radiosity.edge=0.05 it has 12,922 patches: five walls of 1,600
    quads, the blocks of 1,296 and 720 quads, the ball of 1,280 triangles, the column of 810 quads and, as its lid's triangles pair
    up, 240 more, the pyramid of 256 triangles, the lamp of 320. `mirrors` of the left wall's patches are polished metal."""
    g = Gltf()
    for part, colour, corners in CORNELL:
        if part == "left":
            left_wall(g, colour, mirrors)
        else:
            g.place(*quad(*corners), g.material(part, colour))
    grey, blue, yellow = (g.material(part, colour) for part, colour in (
        ("blocks", (.73, .73, .73)), ("round", (.25, .4, .75)), ("pyramid", (.75, .6, .2))))
    for height, degrees, at in ((.6, 17, (.35, 0, .35)), (1.2, -20, (-.35, 0, -.3))):
        points, triangles = standing_block(.3, height)
        g.place(transformed(points, rotation((0, 1, 0), degrees), offset=at), triangles, grey)
    points, triangles = icosphere(3, .25)
    g.place(transformed(points, offset=(.35, .85, .35)), triangles, blue)
    points, triangles = column(30, .2, 1.35)
    g.place(transformed(points, offset=(.7, 0, -.7)), triangles, blue)
    points, triangles = pyramid(.18, .28)
    g.place(transformed(points, rotation((0, 1, 0), 30), offset=(-.55, 0, .6)), triangles, yellow)
    points, triangles = icosphere(2, .1)
    g.place(transformed(points, offset=(0, 1.75, 0)), triangles, g.material("lamp", (0, 0, 0), (radiance,) * 3))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(folder, name or ("room_%d.gltf" % mirrors if mirrors else "room.gltf"))


# ---- the street -------------------------------------------------------------------------------------------------------

CELL = 0.25
STOREY = 12  # cells
WIDTH, DEPTH = 24, 32  # of a building, in cells
STOREYS = ((5, 4, 6, 3, 5, 4, 5, 5, 4, 3, 4), (4, 6, 4, 5, 3, 4, 6, 4, 5, 5, 4))  # left and right of the street
LENGTH = len(STOREYS[0]) * WIDTH * CELL
ROAD, PAVEMENT, KERB = 5.0, 2.0, 0.15  # half of the road; how wide, and how high
WINDOWS = [(1, 5), (7, 11), (13, 17), (19, 23)]  # columns of a storey
PANES = (3, 9)  # rows
STREET_QUADS, DOME_RINGS, DOME_SECTORS, DOME_RADIUS = 61795, 29, 83, 60.0


class Sheets:
    """Quads of one material; those of one sheet share their corners."""

    def __init__(self):
        self.points, self.triangles = [], []

    def add(self, corner, u, v, columns=1, rows=1, cells=None):
        """A grid from `corner` along u and v, which are its whole sides; counter-clockwise from u to v. `cells`: which."""
        first = len(self.points)
        self.points += [[corner[k] + u[k] * i / columns + v[k] * j / rows for k in range(3)]
                        for j in range(rows + 1) for i in range(columns + 1)]
        for j in range(rows):
            for i in range(columns):
                if cells and not cells(i, j):
                    continue
                a = first + j * (columns + 1) + i
                self.triangles += [(a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1)]

    def quads(self):
        return len(self.triangles) // 2


def is_window(column, row):
    return PANES[0] <= row % STOREY < PANES[1] and any(low <= column < high for low, high in WINDOWS)


def facade(walls, panes, corner, along, outwards, storeys):
    """A front of cells with windows a cell deep; `along` and `outwards` are unit vectors, `corner` its lower left one."""
    def place(columns, rows, depth=0.0):
        return [corner[k] + CELL * (along[k] * columns + (rows if k == 1 else 0) - outwards[k] * depth) for k in range(3)]

    def vector(columns, rows, depth=0.0):
        return [CELL * (along[k] * columns + (rows if k == 1 else 0) + outwards[k] * depth) for k in range(3)]

    rows = storeys * STOREY
    walls.add(corner, vector(WIDTH, 0), vector(0, rows), WIDTH, rows, lambda i, j: not is_window(i, j))
    for storey in range(storeys):
        low, high = (storey * STOREY + row for row in PANES)
        for left, right in WINDOWS:
            wide, tall = right - left, high - low
            panes.add(place(left, low, 1), vector(wide, 0), vector(0, tall), wide, tall)
            walls.add(place(left, low), vector(wide, 0), vector(0, 0, -1), wide)  # sill
            walls.add(place(left, high, 1), vector(wide, 0), vector(0, 0, 1), wide)  # lintel
            walls.add(place(left, low), vector(0, 0, -1), vector(0, tall), 1, tall)
            walls.add(place(right, low, 1), vector(0, 0, 1), vector(0, tall), 1, tall)


def building(walls, panes, side, number):
    """One of a row, with its roof, its back, and what stands above its neighbours."""
    row = STOREYS[side]
    storeys, out = row[number], (1, -1)[side]
    wide, deep, height = WIDTH * CELL, DEPTH * CELL, row[number] * STOREY * CELL
    x, z = -out * (ROAD + PAVEMENT), LENGTH / 2 - number * wide  # its corner that is nearest to the camera
    along = (0, 0, -out)
    facade(walls, panes, (x, 0, z if side == 0 else z - wide), along, (out, 0, 0), storeys)
    back = x - out * deep
    walls.add((back, 0, z - wide if side == 0 else z), (0, 0, out * wide), (0, height, 0), 6, 3 * storeys)
    walls.add((x, height, z if side == 0 else z - wide), (0, 0, -out * wide), (-out * deep, 0, 0), 12, 16)
    for step, at in ((-1, z), (1, z - wide)):
        next_to = row[number + step] if 0 <= number + step < len(row) else 0
        if next_to >= storeys:
            continue
        low = next_to * STOREY * CELL
        start, way = (x, -out * deep) if (step < 0) != (out > 0) else (back, out * deep)
        walls.add((start, low, at), (way, 0, 0), (0, height - low, 0), 16, 6 * (storeys - next_to))


def apron(radius):
    """The ground from the houses' backs and the street's ends to the dome's foot, a quad to each of its sectors."""
    half = [ROAD + PAVEMENT + DEPTH * CELL, LENGTH / 2]
    outer = ring_of([], 0, radius, DOME_SECTORS)
    inner = []
    for x, _, z in outer:
        most = max(abs(x) / half[0], abs(z) / half[1])
        inner.append([x / most, 0, z / most])
    pairs = [(i, (i + 1) % DOME_SECTORS) for i in range(DOME_SECTORS)]
    return inner + outer, [t for a, b in pairs for t in ((a, a + DOME_SECTORS, b + DOME_SECTORS), (a, b + DOME_SECTORS, b))]


def dome(radius):
    """Rings of quads, the last of triangles, whose fronts are within."""
    points = [[0, radius, 0]]
    for ring in range(DOME_RINGS):
        up = math.pi / 2 * ring / DOME_RINGS
        points = ring_of(points, radius * math.sin(up), radius * math.cos(up), DOME_SECTORS)
    triangles = []
    for ring in range(DOME_RINGS):
        for i in range(DOME_SECTORS):
            a, b = (1 + ring * DOME_SECTORS + (i + k) % DOME_SECTORS for k in (0, 1))
            if ring + 1 < DOME_RINGS:
                triangles += [(b, a, a + DOME_SECTORS), (b, a + DOME_SECTORS, b + DOME_SECTORS)]
            else:
                triangles.append((b, a, 0))
    return points, triangles


def street(folder, radiance=(.5, .65, .9), name="street.glb"):
    """A street of 66 m between two rows of eleven houses of three to six storeys, under a dome of radius 60 m that glows. All of
    it is given as it is, and with radiosity.edge=50 nothing is cut: 64,289 patches, of which the street has 61,795 quads, the
    dome 2,407 (2,324 quads and 83 triangles) and the ground around the houses 87. The houses' fronts and the street are of
    quads of 0.25 m, roofs and gables of 0.5 m, backs of 1 m; the kerbs are of as many pieces as make up the number."""
    parts = [(Sheets(), colour) for colour in ((.75, .7, .6), (.6, .45, .4), (.7, .72, .75))]
    panes, road, pavement = Sheets(), Sheets(), Sheets()
    for side in (0, 1):
        for number in range(len(STOREYS[side])):
            building(parts[(number + side) % 3][0], panes, side, number)
    rows = round(LENGTH / CELL)
    road.add((-ROAD, 0, LENGTH / 2), (2 * ROAD, 0, 0), (0, 0, -LENGTH), round(2 * ROAD / CELL), rows)
    for x in (-ROAD - PAVEMENT, ROAD):
        pavement.add((x, KERB, LENGTH / 2), (PAVEMENT, 0, 0), (0, 0, -LENGTH), round(PAVEMENT / CELL), rows)
    kerbs = STREET_QUADS - sum(s.quads() for s in [panes, road, pavement] + [walls for walls, _ in parts])
    pavement.add((-ROAD, 0, LENGTH / 2), (0, 0, -LENGTH), (0, KERB, 0), kerbs // 2)
    pavement.add((ROAD, 0, -LENGTH / 2), (0, 0, LENGTH), (0, KERB, 0), kerbs - kerbs // 2)
    g = Gltf()
    for number, (sheets, colour) in enumerate(parts + [(panes, (.1, .12, .15)), (road, (.2, .2, .2)), (pavement, (.5, .5, .48))]):
        g.place(sheets.points, sheets.triangles, g.material(f"part {number}", colour))
    g.place(*apron(DOME_RADIUS), g.material("ground", (.3, .32, .25)))
    g.place(*dome(DOME_RADIUS), g.material("dome", (0, 0, 0), radiance))
    g.camera((1.5, 4, 36), (-.5, 6, 0), 60)
    return g.save(folder, name)


SCENES = {"room": room, **{"room_%d" % n: lambda folder, n=n: room(folder, n) for n in MIRRORS if n}, "street": street}
OPTIONS = {**{name: "radiosity.edge=%g" % EDGE for name in SCENES}, "street": "radiosity.edge=50"}


def main():
    if len(sys.argv) < 2 or any(name not in SCENES for name in sys.argv[2:]):
        sys.exit("usage: radiosity.py FOLDER [NAME...]\nnames: " + " ".join(SCENES))
    for name in sys.argv[2:] or SCENES:
        print(SCENES[name](sys.argv[1]), OPTIONS[name])


if __name__ == "__main__":
    main()
