#!/usr/bin/env python3
"""Small scenes with known answers, for tests and people.

    make.py FOLDER [NAME...]    write the named scenes (all without a name), print their paths

As a module: each function below writes one scene into a folder and returns the path of its file; every glTF has a camera
named "camera". Unless it says so nothing here has vertex normals or a specular lobe: surfaces are flat and purely diffuse, as
the closed forms want them.
"""
import math
import sys

from writers import (Gltf, Obj, box, disc, icosphere, png, quad, rotation, transformed)


def furnace(folder, albedo=1.0, subdivisions=2, name="furnace.gltf"):
    """A convex body of one albedo. Under a background of 1 with albedo 1 every pixel is 1: what a convex body reflects goes
    straight to the background."""
    g = Gltf()
    g.place(*icosphere(subdivisions), g.material("white", (albedo,) * 3))
    g.camera((0, 0, 4), (0, 0, 0), 40)
    return g.save(folder, name)


def closed_sphere(folder, rho=0.5, subdivisions=2, name="closed_sphere.gltf", emission=None):
    """A closed sphere whose front is inside, albedo rho, emission 1 - rho: radiance 1 everywhere within; cut after N
    scattering events it is 1 - rho^(N+1)."""
    g = Gltf()
    e = 1.0 - rho if emission is None else emission
    g.place(*icosphere(subdivisions, inward=True), g.material("wall", (rho,) * 3, (e,) * 3))
    g.camera((0, 0, 0.2), (0, 0.1, -1), 60)
    return g.save(folder, name)


def lamp_over_floor(folder, radiance=1.0, albedo=0.5, name="lamp.gltf"):
    """A 1 x 1 lamp that looks down from height 1 on a wide floor. Below its centre, direct light alone:
    pixel * pi / albedo = 0.75227 * radiance (form factor 0.23946 times pi)."""
    g = Gltf()
    g.place(*quad((-10, 0, 10), (10, 0, 10), (10, 0, -10), (-10, 0, -10)), g.material("floor", (albedo,) * 3))
    g.place(*quad((-.5, 1, -.5), (.5, 1, -.5), (.5, 1, .5), (-.5, 1, .5)), g.material("lamp", (0, 0, 0), (radiance,) * 3))
    # From the side, under the lamp: the middle of the picture is the floor's (0, 0, 0).
    g.camera((0, 0.5, 3), (0, 0, 0), 1)
    return g.save(folder, name)


def disc_lamp(folder, radiance=1.0, albedo=0.5, sides=128, name="disc_lamp.gltf"):
    """A disc of radius 1 at height 2 over a floor: pixel * pi / albedo = pi / 5 below its centre."""
    g = Gltf()
    g.place(*quad((-10, 0, 10), (10, 0, 10), (10, 0, -10), (-10, 0, -10)), g.material("floor", (albedo,) * 3))
    g.place(*disc(sides, 1, 2), g.material("lamp", (0, 0, 0), (radiance,) * 3))
    g.camera((0, 0.5, 4), (0, 0, 0), 1)
    return g.save(folder, name)


def unlit(folder, name="unlit.gltf"):
    """Surfaces and no light at all."""
    g = Gltf()
    g.place(*icosphere(2), g.material("white", (0.8,) * 3))
    g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("floor", (0.5,) * 3))
    g.camera((0, 1, 5), (0, 0, 0), 40)
    return g.save(folder, name)


def sealed_room(folder, scale=1.0, rotated=0.0, radiance=1e6, name=None):
    """A closed box around the camera, unlit, with a lamp of great radiance close by outside: exactly 0 within."""
    g = Gltf()
    turn = rotation((1, 2, 3), rotated)
    walls, wall_triangles = box((-1, -1, -1), (1, 1, 1), inward=True)
    block, block_triangles = box((-0.4, -1, -0.6), (0.1, -0.3, -0.1))
    lamp, lamp_triangles = quad((1.01, -1, -1), (1.01, -1, 1), (1.01, 1, 1), (1.01, 1, -1))
    white = g.material("walls", (0.9,) * 3)
    g.place(transformed(walls, turn, scale), wall_triangles, white)
    g.place(transformed(block, turn, scale), block_triangles, white)
    g.place(transformed(lamp, turn, scale), lamp_triangles,
            g.material("lamp", (0, 0, 0), (radiance,) * 3, both_sides=True))
    eye, target, up = transformed([(-0.2, 0.1, 0.9), (0.5, -0.1, -1), (0, 1, 0)], turn, scale)
    g.camera(eye, target, 70, up=up)
    return g.save(folder, name or "sealed_room_%g_%g.gltf" % (scale, rotated))


def textured_quad(folder, name="textured.gltf", **sampler):
    """A 2 x 2 texture (red green / blue white from the top) on a quad that fills the view, uv (0, 0) at its upper left."""
    colours = [[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]]
    g = Gltf()
    texture = g.image(png(2, 2, lambda x, y: colours[y][x]), **(sampler or {"magFilter": 9728}))
    material = g.material("picture", texture=texture)
    mesh = g.mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [(0, 1, 2), (0, 2, 3)], material,
                  uvs=[(0, 1), (1, 1), (1, 0), (0, 0)])
    g.node(mesh=mesh)
    g.camera((0, 0, 2), (0, 0, 0), 53.13)
    return g.save(folder, name)


def lit_floor(folder, kind, intensity=1.0, albedo=0.5, name=None):
    """A floor under one punctual light at height 2, straight down: at (0, 0, 0) the pixel is albedo / pi times
    intensity / 4 (point, spot) or intensity (directional)."""
    g = Gltf()
    g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (albedo,) * 3))
    g.light(kind, intensity, (0, 2, 0), (0, 0, 0), cone=(math.radians(15), math.radians(30)))
    g.camera((0, 1, 4), (0, 0, 0), 40)
    return g.save(folder, name or "%s.gltf" % kind)


def _body(g):
    """A tetrahedron-like body without symmetry, to show which way round things came out."""
    return [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.5]], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], g.material("body", (.5,) * 3)


def negative_scale(folder, name="negative_scale.gltf"):
    """One emitting triangle under a mirrored node: its front looks up (+Y) in the world, as in its mesh."""
    g = Gltf()
    positions, triangles = [[0, 0, 0], [0, 0, 1], [1, 0, 0]], [(0, 1, 2)]
    g.place(positions, triangles, g.material("lamp", (0, 0, 0), (1, 1, 1)), scale=[-1, 1, 1], translation=[0, 1, 0])
    g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
    g.camera((0, 2, 5), (0, 0, 0), 40)
    return g.save(folder, name)


def hierarchy(folder, name="hierarchy.gltf"):
    """Three nodes under each other: translate (1, 2, 3), turn 90 degrees about Z, scale by 2. The body's corner (1, 0, 0)
    comes to (1, 4, 3), its corner (0, 1, 0) to (-1, 2, 3), its corner (0, 0, 0.5) to (1, 2, 4)."""
    g = Gltf()
    leaf = g.place(*_body(g), root=False, scale=[2, 2, 2])
    turn = g.node(root=False, rotation=[0, 0, math.sin(math.pi / 4), math.cos(math.pi / 4)], children=[leaf])
    g.node(translation=[1, 2, 3], children=[turn])
    g.camera((0, 3, 12), (0, 3, 0), 40)
    return g.save(folder, name)


def _offset_parts(g, offset, baked):
    body, triangles, material = _body(g)
    lamp, lamp_triangles = quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1))
    glow = g.material("lamp", (0, 0, 0), (4, 4, 4))
    if baked:
        g.place(transformed(body, offset=offset), triangles, material)
        g.place(transformed(lamp, offset=offset), lamp_triangles, glow)
    else:
        g.place(body, triangles, material, translation=list(offset))
        g.place(lamp, lamp_triangles, glow, translation=list(offset))
    g.camera([0.5 + offset[0], 1 + offset[1], 4 + offset[2]], [0.3 + offset[0], 0.3 + offset[1], offset[2]], 40)


def offset_by_node(folder, offset=(1e5, 0, 0), name="offset_node.gltf"):
    """A small scene moved far away by its nodes: no precision is lost."""
    g = Gltf()
    _offset_parts(g, offset, False)
    return g.save(folder, name)


def offset_in_vertices(folder, offset=(1e5, 0, 0), name="offset_vertices.gltf"):
    """The same with the offset in its vertices: precision is lost in the file, and said."""
    g = Gltf()
    _offset_parts(g, offset, True)
    return g.save(folder, name)


def ggx_furnace(folder, roughness=0.5, metallic=1, specular=1, albedo=1.0, subdivisions=4, name=None):
    """A smooth sphere of glTF's own surface, with vertex normals. Under a background of 1 a white metal is 1 where the model
    loses no energy."""
    g = Gltf()
    positions, triangles = icosphere(subdivisions)
    surface = g.material("surface", (albedo,) * 3, metallic=metallic, roughness=roughness, specular=specular)
    g.node(mesh=g.mesh(positions, triangles, surface, normals=positions))
    g.camera((0, 0, 4), (0, 0, 0), 40)
    return g.save(folder, name or "ggx_furnace_%g_%g_%g_%g.gltf" % (roughness, metallic, specular, albedo))


PICTURE_UVS = [(0, 1), (1, 1), (1, 0), (0, 0)]  # of a quad from its lower left, so that a picture stands upright on it


def normal_mapped_quad(folder, tilt=(0.6, 0.0, 0.8), scale=1.0, tangents=None, mirrored=False, name="normal_map.gltf"):
    """A quad in z = 0 whose normal map holds the one direction `tilt` (x right, y up, z out), so that its shading normal is
    that. It shines under one light that travels along -z: pixel albedo / pi * intensity * tilt.z, the light straight ahead.
    `mirrored`: u runs to the left, and so does the map's x."""
    g = Gltf()
    texel = tuple(round((0.5 + 0.5 * c) * 255) for c in tilt)
    material = g.material("tilted", (.5,) * 3)
    g.json["materials"][material]["normalTexture"] = {"index": g.image(png(2, 2, lambda x, y: texel)), "scale": scale}
    uvs = [(1 - u, v) for u, v in PICTURE_UVS] if mirrored else PICTURE_UVS
    g.node(mesh=g.mesh(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), material, uvs=uvs, normals=[(0, 0, 1)] * 4,
                       tangents=tangents))
    g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
    g.camera((0, 0, 2), (0, 0, 0), 40)
    return g.save(folder, name)


def alpha_mask(folder, alpha=1.0, cutoff=0.5, name="alpha_mask.gltf"):
    """A quad whose right half is cut out hangs between a lamp and the floor: its left half throws a shadow, through its
    right half the camera sees the floor."""
    g = Gltf()
    texture = g.image(png(2, 1, lambda x, y: (255, 255, 255, 255 if x == 0 else 0)), magFilter=9728, wrapS=33071)
    g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
    leaf = g.material("leaf", (.2, .6, .2), texture=texture, alpha=alpha, cutoff=cutoff)
    g.node(mesh=g.mesh(*quad((-1, 1, 1), (1, 1, 1), (1, 1, -1), (-1, 1, -1)), leaf, uvs=PICTURE_UVS))
    g.place(*quad((-.25, 3, -.25), (.25, 3, -.25), (.25, 3, .25), (-.25, 3, .25)), g.material("lamp", (0, 0, 0), (10,) * 3))
    g.camera((0, 4, 4), (0, 0.5, 0), 50)
    return g.save(folder, name)


def vertex_colours(folder, width=4, name="vertex_colours.gltf"):
    """A white quad, red green blue white from its lower left, colours linear, under a light along -z: albedo is the
    interpolated colour."""
    g = Gltf()
    colours = [(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)]
    g.node(mesh=g.mesh(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("white"),
                       colors=[c[:width] for c in colours]))
    g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
    g.camera((0, 0, 2), (0, 0, 0), 40)
    return g.save(folder, name)


def second_uvs(folder, offset=(0, 1), rotation=math.pi / 2, scale=(.5, .5), override=True, name="second_uvs.gltf"):
    """A picture of four colours (red green / blue white from the top), looked up by the second set of coordinates through
    KHR_texture_transform. As it stands, the lower left quarter of the picture, blue, fills the quad."""
    colours = [[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]]
    g = Gltf()
    info = {"index": g.image(png(2, 2, lambda x, y: colours[y][x]), magFilter=9728)}
    transform = {"offset": list(offset), "rotation": rotation, "scale": list(scale)}
    if override:
        transform["texCoord"] = 1
    else:
        info["texCoord"] = 1
    g.extend(info, "KHR_texture_transform", transform)
    g.node(mesh=g.mesh(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("picture", texture=info),
                       uvs=[(0, 0)] * 4, uvs1=PICTURE_UVS))
    g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
    g.camera((0, 0, 2), (0, 0, 0), 40)
    return g.save(folder, name)


def unlit_quad(folder, albedo=(.25, .5, .75), name="unlit_quad.gltf"):
    """A quad of KHR_materials_unlit over a floor, no light at all: the quad shows its colour, the floor stays black."""
    g = Gltf()
    g.place(*quad((-1, 0, 0), (1, 0, 0), (1, 2, 0), (-1, 2, 0)), g.material("sign", albedo, unlit=True))
    g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
    g.camera((0, 1, 5), (0, 1, 0), 40)
    return g.save(folder, name)


def plates(folder, name="plates.gltf"):
    """Three metal plates of roughness 0.05, 0.2 and 0.5, each turned to show a small and a large lamp of the same power to
    the camera: a small lamp in a rough plate wants light sampling, a large one in a smooth plate the lobe's."""
    g = Gltf()
    eye, lamps = (0, 2, 9), (("small", -1.5, .1), ("large", 1.5, .8))
    for i, roughness in enumerate((.05, .2, .5)):
        middle = (0, .3 + .5 * i, 2.0 - 1.5 * i)
        # Turned so that the plate mirrors the lamps' middle to the eye.
        to_eye = [eye[c] - middle[c] for c in range(3)]
        to_lamp = [(0, 3, -3)[c] - middle[c] for c in range(3)]
        half = [to_eye[c] / math.hypot(*to_eye) + to_lamp[c] / math.hypot(*to_lamp) for c in range(3)]
        degrees = math.degrees(math.atan2(half[2], half[1]))
        plate, triangles = quad((-3, 0, .5), (3, 0, .5), (3, 0, -.5), (-3, 0, -.5))
        g.place(transformed(plate, rotation((1, 0, 0), degrees), offset=middle), triangles,
                g.material("plate %g" % roughness, (.8,) * 3, metallic=1, roughness=roughness))
    for lamp, x, half_side in lamps:
        s = half_side
        g.place(*quad((x - s, 3 - s, -3), (x + s, 3 - s, -3), (x + s, 3 + s, -3), (x - s, 3 + s, -3)),
                g.material(lamp, (0, 0, 0), (1 / (s * s),) * 3))
    g.camera(eye, (0, 1.5, 0), 40)
    return g.save(folder, name)


def turned(axis, degrees):
    """The quaternion of a turn."""
    x, y, z = (c * math.sin(math.radians(degrees) / 2) for c in axis)
    return [x, y, z, math.cos(math.radians(degrees) / 2)]


def stage(folder, arm=None, block=None, lamp=None, bulb=None, rig=None, name="stage.gltf"):
    """Things that move: a block on an arm, a lamp that is a surface, a bulb that is a point light, a camera on a rig, each a
    named node whose translation, rotation and scale the arguments replace. Animation "play", 2 s: the arm turns by 90 degrees
    about +Y, the block grows to twice its size in steps of a second, the lamp sinks from 3 to 2 along a cubic that leaves and
    arrives level, the rig moves 1 to the right."""
    g = Gltf()

    def part(own, other):
        return {**own, **(other or {})}

    g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3), name="floor")
    positions, triangles = box((0, 0, 0), (1, .6, .3))
    block = g.place(positions, triangles, g.material("block", (.2, .4, .7)), root=False, name="block",
                    **part({"translation": [.3, 0, 0]}, block))
    arm = g.node(name="arm", children=[block], **part({"translation": [0, .5, 0]}, arm))
    lamp = g.place(*quad((-.5, 0, -.5), (.5, 0, -.5), (.5, 0, .5), (-.5, 0, .5)), g.material("lamp", (0, 0, 0), (4,) * 3),
                   name="lamp", **part({"translation": [0, 3, 0]}, lamp))
    g.light("point", 2.0)
    del g.json["nodes"][-1]["matrix"]
    g.json["nodes"][-1].update(name="bulb", **part({"translation": [-1, 2, 1]}, bulb))
    camera = g.camera((0, 2, 5), (0, .7, 0), 40)
    g.json["scenes"][0]["nodes"].remove(camera)
    rig = g.node(name="rig", children=[camera], **(rig or {}))
    g.animation("play", (arm, "rotation", [0, 2], [turned((0, 1, 0), 0), turned((0, 1, 0), 90)]),
                (block, "scale", [0, 1], [[1, 1, 1], [2, 2, 2]], "STEP"),
                (lamp, "translation", [0, 2], [[0] * 3, [0, 3, 0], [0] * 3, [0] * 3, [0, 2, 0], [0] * 3], "CUBICSPLINE"),
                (rig, "translation", [0, 2], [[0, 0, 0], [1, 0, 0]]))
    return g.save(folder, name)


CORNELL = [  # name, colour, corners counter-clockwise seen from inside
    ("floor", (.73, .73, .73), ((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))),
    ("ceiling", (.73, .73, .73), ((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1))),
    ("back", (.73, .73, .73), ((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1))),
    ("left", (.65, .05, .05), ((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1))),
    ("right", (.12, .45, .15), ((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1))),
]


def _cornell_blocks():
    for low, high, degrees, at in (((-.3, 0, -.3), (.3, .6, .3), 17, (.35, 0, .35)), ((-.3, 0, -.3), (.3, 1.2, .3), -20, (-.35, 0, -.3))):
        positions, triangles = box(low, high)
        yield transformed(positions, rotation((0, 1, 0), degrees), offset=at), triangles


def cornell(folder, radiance=15.0, name="cornell.gltf"):
    """A box with two blocks and a lamp below its ceiling."""
    g = Gltf()
    for part, colour, corners in CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    white = g.material("blocks", (.73, .73, .73))
    for block in _cornell_blocks():
        g.place(*block, white)
    g.place(*quad((-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)),
            g.material("lamp", (.78, .78, .78), (radiance,) * 3))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(folder, name)


def cornell_glass(folder, scale=1.0, name="cornell_glass.gltf"):
    """A box with a ball of green glass and a thin pane before it, under a lamp. All lengths times `scale`, the glass's too."""
    g = Gltf()
    for part, colour, corners in CORNELL:
        g.place(*quad(*[[scale * c for c in p] for p in corners]), g.material(part, colour))
    ball, triangles = icosphere(3, radius=.45)
    inside = {"thicknessFactor": 1, "attenuationDistance": .5 * scale, "attenuationColor": [.4, .9, .5]}
    g.node(mesh=g.mesh(transformed(ball, scale=scale, offset=(0, .45 * scale, 0)), triangles,
                       g.material("ball", clear=1, roughness=0, ior=1.5, volume=inside), normals=[[c / .45 for c in p] for p in ball]))
    pane = [(.1, .1, .8), (.8, .1, .6), (.8, 1.2, .6), (.1, 1.2, .8)]
    g.place(*quad(*[[scale * c for c in p] for p in pane]), g.material("pane", (1, .8, .6), clear=1, roughness=.2))
    lamp = [(-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)]
    g.place(*quad(*[[scale * c for c in p] for p in lamp]), g.material("lamp", (.78, .78, .78), (15,) * 3))
    g.camera((0, scale, 3.9 * scale), (0, scale, 0), 39)
    return g.save(folder, name)


def many_lamps(folder, side=30, name="many_lamps.gltf"):
    """A hall of side x side small lamps below its ceiling, of many colours and powers, with screens between them: what shines on
    a place are a few of them."""
    g = Gltf()
    half = side / 2
    g.place(*box((-half, 0, -half), (half, 3, half), inward=True), g.material("walls", (.6, .6, .6)))
    screen = g.material("screen", (.5, .45, .4))
    for i in range(0, side, 3):
        g.place(*box((-half + i, 0, -half + 2), (-half + i + .1, 1.8, half - 2)), screen)
    glow = [g.material(f"lamp {k}", (0, 0, 0), [8 * 2 ** k * c for c in colour])
            for k, colour in enumerate(((1, .3, .2), (.3, 1, .3), (.3, .4, 1), (1, .9, .7)))]
    parts = [([], []) for _ in glow]
    for i in range(side * side):
        x, z = -half + .5 + i % side, -half + .5 + i // side
        positions, triangles = parts[(i * 7919 >> 3) % 4]
        corners, two = quad((x - .05, 2.9, z - .05), (x + .05, 2.9, z - .05), (x + .05, 2.9, z + .05), (x - .05, 2.9, z + .05))
        triangles += [tuple(c + len(positions) for c in t) for t in two]
        positions += corners
    for material, part in zip(glow, parts):
        g.place(*part, material)
    g.camera((-half + 1.2, 1.7, half - 1), (half / 3, .8, -half / 2), 60)
    return g.save(folder, name)


def alpha_blend(folder, alpha=.25, sheets=1, albedo=0.0, name="alpha_blend.gltf"):
    """Black sheets before each other, each there by a share: of what is behind them (1 - alpha) ** sheets comes through."""
    g = Gltf()
    sheet = g.material("sheet", (albedo,) * 3, alpha=alpha, blend=True)
    for i in range(sheets):
        g.place(*quad((-1, -1, -.1 * i), (1, -1, -.1 * i), (1, 1, -.1 * i), (-1, 1, -.1 * i)), sheet)
    g.camera((0, 0, 2), (0, 0, 0), 40)
    return g.save(folder, name)


def coats(folder, name="coats.gltf"):
    """A row of spheres on a matte floor, each pair without and with one thing: red plastic and a smooth coat, blue metal and a
    coat of roughness 0.05, clay by Lambert and by Oren and Nayar."""
    g = Gltf()
    g.place(*quad((-8, 0, 6), (8, 0, 6), (8, 0, -6), (-8, 0, -6)), g.material("floor", (.4,) * 3, matte=1))
    plastic, metal = dict(albedo=(.6, .04, .03), specular=1, roughness=.6), dict(albedo=(.2, .3, .7), metallic=1, roughness=.5, specular=1)
    clay = dict(albedo=(.7, .6, .5))
    row = (("plastic", plastic), ("coated plastic", dict(plastic, coat={"clearcoatFactor": 1})), ("metal", metal),
           ("coated metal", dict(metal, coat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": .05})), ("clay", clay),
           ("matte clay", dict(clay, matte=1)))
    positions, triangles = icosphere(4)
    for i, (label, material) in enumerate(row):
        g.node(mesh=g.mesh(positions, triangles, g.material(label, **material), normals=positions), translation=[-5.5 + 2.2 * i, 1, 0])
    g.place(*quad((-2, 6, -2), (2, 6, -2), (2, 6, 2), (-2, 6, 2)), g.material("lamp", (0, 0, 0), (14,) * 3))
    g.camera((0, 3.2, 14), (0, .9, 0), 26)
    return g.save(folder, name)


def cornell_obj(folder, radiance=15.0, name="cornell.obj"):
    """The same as OBJ and MTL."""
    o = Obj()
    for part, colour, corners in CORNELL:
        o.material(part, colour)
        o.mesh(list(corners), [(0, 1, 2, 3)], part)
    o.material("blocks", (.73, .73, .73))
    for positions, triangles in _cornell_blocks():
        o.mesh(positions, triangles, "blocks")
    o.material("lamp", (.78, .78, .78), (radiance,) * 3)
    o.mesh([(-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)], [(0, 1, 2, 3)], "lamp")
    return o.save(folder, name)


def slow_to_load(folder, name="slow.gltf"):
    """One that takes the loader a while: a mesh under many nodes."""
    g = Gltf()
    positions, triangles = icosphere(4)
    mesh = g.mesh(positions, triangles, g.material("white", (0.8,) * 3))
    for i in range(300):
        g.node(mesh=mesh, translation=[i % 20 * 3.0, i // 20 * 3.0, 0])
    return g.save(folder, name)


def furnace_glb(folder, name="furnace.glb"):
    """The furnace in a GLB container."""
    return furnace(folder, name=name)


SCENES = {
    "furnace": furnace,
    "furnace_glb": furnace_glb,
    "closed_sphere": closed_sphere,
    "lamp_over_floor": lamp_over_floor,
    "disc_lamp": disc_lamp,
    "unlit": unlit,
    "sealed_room_small": lambda folder: sealed_room(folder, 1e-3),
    "sealed_room": sealed_room,
    "sealed_room_large": lambda folder: sealed_room(folder, 1e3),
    "sealed_room_turned": lambda folder: sealed_room(folder, 1.0, 30.0),
    "textured_quad": textured_quad,
    "point": lambda folder: lit_floor(folder, "point"),
    "spot": lambda folder: lit_floor(folder, "spot"),
    "directional": lambda folder: lit_floor(folder, "directional"),
    "negative_scale": negative_scale,
    "hierarchy": hierarchy,
    "offset_by_node": offset_by_node,
    "offset_in_vertices": offset_in_vertices,
    "ggx_furnace": ggx_furnace,
    "normal_mapped_quad": normal_mapped_quad,
    "alpha_mask": alpha_mask,
    "vertex_colours": vertex_colours,
    "second_uvs": second_uvs,
    "unlit_quad": unlit_quad,
    "plates": plates,
    "stage": stage,
    "cornell": cornell,
    "coats": coats,
    "cornell_obj": cornell_obj,
    "cornell_glass": cornell_glass,
    "alpha_blend": alpha_blend,
    "many_lamps": many_lamps,
}


def main():
    if len(sys.argv) < 2 or any(name not in SCENES for name in sys.argv[2:]):
        sys.exit("usage: make.py FOLDER [NAME...]\nnames: " + " ".join(SCENES))
    for name in sys.argv[2:] or SCENES:
        print(SCENES[name](sys.argv[1]))


if __name__ == "__main__":
    main()
