"""What compare_builds.py asks for: scenes, and by name the requests over them. Pictures are as small and as coarse as still runs through
every part of the code; what they show is not looked at.

A request is a command line of `candil`, but for its output, its size where none is said, and four samples where pt is to take them.
In it, the word that names a scene or a picture around one is a key of SCENES, and FOLDER is where their files are."""
import json
import os

import gallery
import images
import make
import rooms
import skies
import bench
from writers import Gltf, Obj, box, icosphere, png, quad


def first(_):
    return os.path.join(bench.SOURCE, "deploy", "first.gltf")


def checks(a, b, side=8):
    return png(side, side, lambda x, y: a if (x + y) % 2 else b)


def maps(folder):
    """A floor and a row of balls and signs, each with another kind of texture, and with the ways of looking them up between them."""
    g = Gltf()
    uvs = make.PICTURE_UVS
    stripes = g.image(checks((255, 200, 60), (40, 90, 220)), wrapS=33648, wrapT=33071, magFilter=9728)
    shares = g.image(checks((255, 30, 255), (0, 220, 20)), minFilter=9987)
    bumps = g.image(png(8, 8, lambda x, y: (128 + 60 * (x % 3 - 1), 128 + 50 * (y % 3 - 1), 230)))
    turned = g.extend({"index": stripes}, "KHR_texture_transform", {"offset": [.1, .2], "rotation": .4, "scale": [3, 2]})
    floor = g.material("floor", (.8, .8, .8), texture=turned)
    g.node(mesh=g.mesh(*quad((-4, 0, 3), (4, 0, 3), (4, 0, -3), (-4, 0, -3)), floor, uvs=uvs))
    brushed = g.material("brushed", (.9, .8, .6), metallic=1, roughness=1, specular=1)
    g.json["materials"][brushed]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {"index": shares}
    glow = g.material("glow", (.2, .2, .2), (4, 3, 2))
    g.json["materials"][glow]["emissiveTexture"] = {"index": stripes}
    pane = g.material("pane", (.9, .95, 1), roughness=.1, specular=1, clear=1)
    g.json["materials"][pane]["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = {"index": shares}
    coat = g.material("coat", (.5, .1, .1), specular=1, roughness=.6, matte=.5, coat={
        "clearcoatFactor": 1, "clearcoatRoughnessFactor": .4, "clearcoatTexture": {"index": shares},
        "clearcoatRoughnessTexture": {"index": shares}, "clearcoatNormalTexture": {"index": bumps}})
    g.json["materials"][coat]["normalTexture"] = {"index": bumps, "scale": .7}
    sheen = g.material("specular", (.1, .3, .2), roughness=.2, specular=1)
    g.extend(g.json["materials"][sheen], "KHR_materials_specular", {
        "specularFactor": .9, "specularTexture": {"index": shares}, "specularColorFactor": [1, .6, .3], "specularColorTexture": {"index": stripes}})
    leaf = g.material("leaf", (.3, .7, .2), texture=g.image(checks((255, 255, 255, 255), (255, 255, 255, 90))), cutoff=.5, both_sides=True)
    for i, material in enumerate((brushed, glow, pane, coat, sheen, leaf)):
        x = -3 + 1.2 * i
        g.node(mesh=g.mesh(*quad((x - .5, .1, 0), (x + .5, .1, 0), (x + .5, 1.4, -.3), (x - .5, 1.4, -.3)), material, uvs=uvs,
                           normals=[(0, .2, .98)] * 4))
    g.light("directional", 2.0, (2, 5, 4), (0, 0, 0), up=(0, 1, 0))
    g.light("spot", 20.0, (-2, 3, 2), (-1, 0, 0), cone=(.2, .6))
    g.camera((0, 1.6, 5), (0, .6, 0), 50)
    return g.save(folder, "maps.gltf")


def drink(folder):
    """Ice in a drink in a glass: bodies that overlap, of three priorities, rough and smooth, under a small lamp."""
    g = Gltf()
    g.place(*quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("table", (.6, .5, .4)))
    for name, low, high, ior, priority, roughness, tint in (
            ("glass", (-.7, .05, -.7), (.7, 1.5, .7), 1.5, 1, 0, (.9, 1, .9)),
            ("drink", (-.65, .15, -.65), (.65, 1.2, .65), 1.33, 2, 0, (.9, .5, .1)),
            ("ice", (-.3, .9, -.2), (.2, 1.35, .3), 1.31, 3, .2, (.8, .9, 1))):
        inside = {"thicknessFactor": 1, "attenuationDistance": 1.0, "attenuationColor": list(tint)}
        g.place(*box(low, high), g.material(name, roughness=roughness, specular=1, ior=ior, clear=1, volume=inside, priority=priority))
    g.place(*quad((-.4, 3, -.4), (.4, 3, -.4), (.4, 3, .4), (-.4, 3, .4)), g.material("lamp", (0, 0, 0), (20, 18, 15)))
    g.camera((0, 1.6, 4), (0, .6, 0), 40)
    return g.save(folder, "drink.gltf")


def swarm(folder):
    """One mesh in many places, vertex colours on it, and a mirrored node; as GLB."""
    g = Gltf()
    points, triangles = icosphere(1, .3)
    colours = [(.5 + p[0], .5 + p[1], .5 + p[2], 1) for p in points]
    ball = g.node(mesh=g.mesh(points, triangles, g.material("ball"), normals=points, colors=colours), scale=[-1, 1, 1], name="balls")
    g.instances(ball, translations=[(x - 1.5, .4 * y, 0) for x in range(4) for y in range(3)],
                rotations=[make.turned((0, 1, 0), 25 * i) for i in range(12)], scales=[(1, 1 - .05 * i, 1) for i in range(12)])
    g.light("point", 9.0, (1, 2, 3))
    g.camera((0, .8, 5), (0, .4, 0), 45)
    return g.save(folder, "swarm.glb")


def illuminations(folder):
    """Balls of MTL's models and of its physically based keys, on a floor below a lamp. Without a camera."""
    o = Obj()
    o.material("floor", (.5, .5, .5))
    o.mesh([(-3, 3, 0), (-3, -3, 0), (3, -3, 0), (3, 3, 0)], [(0, 1, 2, 3)], "floor")
    o.material("lamp", (0, 0, 0), (9, 9, 8))
    o.mesh([(-1, 1, 4), (1, 1, 4), (1, -1, 4), (-1, -1, 4)], [(0, 1, 2, 3)], "lamp")
    points, triangles = icosphere(1, .4)
    for i, lines in enumerate((("illum 2", "Ks .5 .4 .3", "Ns 60"), ("illum 3", "Ks .9 .9 .9"), ("illum 5", "Ks .1 .1 .1"),
                               ("illum 7", "Ni 1.5", "Tf .9 .7 .8"), ("Pr .3", "Pm 1"), ("Pr .5", "Pc 1", "Pcr .1", "Pdr .6"),
                               ("illum 4", "d .4"))):
        o.material(f"ball {i}".replace(" ", "_"), (.7, .5, .3), None, *lines)
        o.mesh([(p[0] + i % 3 * 1.2 - 1.2, p[1] + i // 3 * 1.2 - 1.2, p[2] + .45) for p in points], triangles, f"ball_{i}")
    return o.save(folder, "illuminations.obj")


def sky(folder):
    """A sunset, and beside it the files that some requests name."""
    path = os.path.join(folder, "sky.exr")
    images.write(path, skies.sunset(64))
    keys = [[0, 2, 5, 0, .7, 0, 0, 1, 0, 40], {"eye": [2, 2, 5], "target": [0, .7, 0], "vfov": 35}, [3, 1, 4, 0, .5, 0, 0, 1, 0, 30]]
    with open(os.path.join(folder, "keys.json"), "w", encoding="utf-8") as file:
        json.dump(keys, file)
    return path


SCENES = {
    "first": first, "maps": maps, "drink": drink, "swarm": swarm, "sky": sky, "illuminations": illuminations,
    "cornell": make.cornell, "cornell_obj": make.cornell_obj, "cornell_glass": make.cornell_glass, "furnace": make.furnace,
    "furnace_glb": make.furnace_glb, "unlit_quad": make.unlit_quad, "coats": make.coats, "stage": make.stage, "plates": make.plates,
    "masked": make.alpha_mask, "blended": lambda folder: make.alpha_blend(folder, .4, 3, .6), "textured": make.textured_quad,
    "second_uvs": make.second_uvs, "bumpy": make.normal_mapped_quad, "coloured": make.vertex_colours, "hierarchy": make.hierarchy,
    "mirrored": make.negative_scale, "far": make.offset_by_node, "sealed": make.sealed_room,
    "point": lambda folder: make.lit_floor(folder, "point", 5), "spot": lambda folder: make.lit_floor(folder, "spot", 8),
    "lamps": lambda folder: make.many_lamps(folder, 9), "cut_out": gallery.cut_out, "village": gallery.village,
    "mirror_cube": gallery.mirror_cube, "spheres": gallery.cornell_spheres, "glossy": gallery.cornell_glossy,
    "plane": rooms.plane, "light_box": rooms.light_box, "uniform": rooms.uniform_room,
    "rooms": lambda folder: rooms.TwoRooms(folder, 32, 1).path,
}

AROUND = "--background sky --background-turn 120 --background-scale 2"
SUN = "--light directional:direction=-1,-3,-1,intensity=3,angle=4"
VCT = "--technique vct --set vct.resolution=32"
TURNED = "--node arm:rotate=0,1,0,40 --node lamp:translate=.5,2.5,0 --node block:scale=1,2,1"


def _pt():
    yield "the first scene", "render first --spp 8"
    yield "by its file's name", "render FOLDER/cornell.gltf"
    yield "defaults said", ("render cornell --technique pt --set pt.depth=8 --set pt.sampler=sobol --set pt.hemisphere=cosine --set pt.lights=mis "
                            "--set pt.light_tree=auto --set pt.roulette=on --set pt.traversal=auto --set pt.effect_times=off")
    for scene in ("furnace_glb", "cornell_obj", "plates", "maps", "sealed", "swarm", "far", "hierarchy", "mirrored", "light_box"):
        yield scene, f"render {scene} --background .3,.4,.5 --technique auto"
    for option in ("depth=1", "depth=3", "depth=40", "sampler=independent", "sampler=blue", "hemisphere=uniform", "lights=nee", "lights=none",
                   "roulette=off", "clamp=0.8", "traversal=single", "traversal=packet", "batch=3", "segment=2"):
        yield option, f"render glossy --spp 6 --set pt.{option}"
    for way in ("auto", "on", "off"):
        yield f"light_tree={way}", f"render lamps --set pt.light_tree={way}"
    yield "light_tree=on of one lamp", "render point --set pt.light_tree=on"
    yield "effect_times=on", "render point --set pt.effect_times=on"
    yield "effect_times=all", "render unlit_quad --size 8x8 --effects none,+unlit --set pt.effect_times=all"
    yield "everything else at once", ("render drink --spp 5 --seed 7 --set pt.sampler=independent --set pt.hemisphere=uniform --set pt.lights=nee "
                                      "--set pt.roulette=off --set pt.batch=2 --set pt.segment=3 --set pt.traversal=packet --set pt.depth=12")
    yield "caustics", "render spheres --spp 8"
    yield "caustics, blue, by a spot", "render spheres --set pt.sampler=blue --light spot:at=0,1.9,0,to=.4,0,.3,cone=20,40,intensity=9"
    yield "glass, thin and solid", "render cornell_glass"
    yield "priorities", "render drink --spp 6 --set pt.depth=20"
    yield "coats", "render coats"
    yield "blended", "render blended --background 1,1,1"
    yield "unlit", "render unlit_quad --aov albedo,id"
    yield "mirror and sky's light", f"render mirror_cube {AROUND}"
    yield "village", "render village --background .14,.2,.3 --filter gauss"
    yield "samples 5 to 8", "render glossy --spp 4 --first-sample 5"
    yield "samples 1 to 3 of blue", "render cornell --spp 3 --first-sample 1 --set pt.sampler=blue"
    yield "a target error", "render cornell --error 0.2 --spp 4096"
    yield "a deadline that is far", "render cornell --time 580000 --spp 4"
    yield "pictures on the way", "render cornell --spp 4 --progressive"


def _cameras():
    yield "ten numbers", "render first --camera .5,1.2,3,0,.8,0,.1,1,0,50"
    yield "named", "render stage --camera camera"
    yield "framed", "render illuminations"
    yield "orthographic", f"render first --orthographic 2.4 {SUN}"
    yield "panorama", "render first --panorama --camera 0,1,0,0,1,-1,0,1,0,40"
    yield "lens", "render stage --lens .1,4.5"
    yield "orthographic lens", "render stage --orthographic 3 --lens .2,4"
    yield "gauss", "render mirror_cube --filter gauss --background 1,1,1"
    yield "bh", "render mirror_cube --filter bh --background 1,1,1"
    yield "box", "render mirror_cube --filter box --background 1,1,1 --size 33x17"
    for technique in ("direct", "vct"):
        yield f"{technique}, orthographic", f"render stage --technique {technique} --orthographic 3"


def _surroundings():
    yield "seen and a light", f"render furnace {AROUND}"
    yield "turned, in glass", "render drink --background sky --background-turn -75.5 --background-scale 0.25"
    yield "by its file", "render furnace --background FOLDER/sky.exr"
    yield "without light", f"render furnace --effects auto,-environment {AROUND}"
    yield "direct", f"render swarm --technique direct {AROUND}"
    yield "vct", f"render swarm {VCT} {AROUND}"
    yield "panorama of the sky", f"render hierarchy --panorama {AROUND}"
    yield "a wide sun", f"render village {SUN}"
    yield "colour", "render furnace --background 1,0.5,0.25"


def _files():
    yield "all channels, float", "render cut_out --background .2,.3,.4 --aov depth,normal,albedo,id --float"
    yield "all channels, half", "render stage --aov depth,normal,albedo,id --half"
    yield "all channels, direct", "render swarm --technique direct --aov depth,normal,albedo,id"
    yield "all channels, vct", f"render cornell_glass {VCT} --aov depth,normal,albedo,id"
    yield "depth alone, seen by a lens", "render stage --aov depth --lens .1,4"
    for view in ("none", "reinhard", "filmic"):
        yield f"PNG, {view}", f"render first --format png --view {view} --exposure 0.75"
    yield "PNG, direct", "render first --technique direct --format png --exposure -1.5"
    yield "PNG, vct", f"render first {VCT} --format png --view filmic"


def _edits():
    yield "lights", "render stage --light point:at=0,2,1,intensity=4,2,1 --light spot:at=1,3,1,to=0,0,0,cone=5,30,intensity=9"
    yield "lights replaced", f"render stage --replace-lights {SUN}"
    yield "materials", ("render first --material 'lime wash:color=.8,.2,.1,roughness=.3,specular-weight=1,specular=.9' --material "
                        "'brass:metallic=0,coat=1,coat-roughness=.2' --material 'teal:emission=1,2,3,diffuse-roughness=.7'")
    yield "nodes", f"render stage {TURNED}"
    yield "animation", "render stage --animation play --at 1.3"
    yield "animation and nodes", "render stage --animation play --at 2 --node 'arm:translate=0,.2,0'"
    yield "a swarm grows", "render swarm --node balls:scale=1.5"
    yield "direct", f"render stage --technique direct {TURNED} --light point:at=0,2,1,intensity=4"
    yield "vct", f"render stage {VCT} {TURNED} --material block:emission=.5,1,2 --replace-lights"
    yield "OBJ, up and unit", "render FOLDER/illuminations.obj --up z --unit 0.01"


# Where each effect is something, so that without it the picture is another.
_EFFECT_AT = {
    "textures": "village", "emitters": "stage", "lights": "stage", "environment": f"furnace {AROUND}", "bounces": "cornell",
    "glossy": "glossy", "normal-maps": "bumpy", "alpha-mask": "masked", "vertex-colors": "coloured", "unlit": "unlit_quad",
    "glass": "cornell_glass", "alpha-blend": "blended --background 1,1,1", "clearcoat": "coats", "rough-diffuse": "coats",
    "caustics": "spheres",
}


_OTHERS = {"direct": "--technique direct", "vct": VCT}


def _effects():
    for effect, scene in _EFFECT_AT.items():
        yield f"as it is: {effect}", f"render {scene}"
        yield f"without {effect}", f"render {scene} --effects=-{effect}"
    yield "all forced", "render cornell --effects all"
    yield "few forced", "render cornell --effects auto,+textures,+lights,+glossy,+glass,+caustics"
    yield "others forced", ("render point --effects auto,+environment,+normal-maps,+alpha-mask,+vertex-colors,+unlit,+alpha-blend,"
                            "+clearcoat,+rough-diffuse")
    yield "none", "render maps --effects none"
    yield "none but two", "render maps --effects none,+emitters,+bounces"
    for technique in _OTHERS:
        for effect in ("textures", "emitters", "lights", "glossy", "normal-maps", "alpha-mask", "vertex-colors", "unlit"):
            yield f"{technique} without {effect}", f"render {_EFFECT_AT[effect]} {_OTHERS[technique]} --effects=-{effect}"
    yield "vct without glass", f"render cornell_glass {VCT} --effects=-glass"
    yield "vct without bounces", f"render cornell {VCT} --effects=-bounces"
    yield "vct, all forced", f"render cornell {VCT} --effects all"
    yield "direct, all forced", "render cornell --technique direct --effects all"


def _direct():
    for scene in ("first", "maps", "stage", "cornell_glass", "cut_out", "coloured", "second_uvs", "textured", "bumpy", "unlit_quad",
                  "lamps", "spot", "light_box", "drink"):
        yield scene, f"render {scene} --technique direct --background .2,.3,.4"
    yield "defaults said", "render stage --technique direct --set direct.samples=2 --set direct.shadows=rays --set direct.map=1024 --set direct.rows=0"
    for option in ("samples=1", "samples=7", "shadows=none", "shadows=map", "rows=8", "rows=17"):
        yield option, f"render stage --technique direct --set direct.{option}"
    for side in (256, 512, 2048, 4096):
        yield f"map={side}", f"render village --technique direct --set direct.shadows=map --set direct.map={side}"
    yield "four samples", "render first --technique direct --spp 4 --seed 3"
    yield "one more sample", "render first --technique direct --spp 2 --first-sample 3"


def _vct():
    for scene in ("first", "maps", "stage", "drink", "cut_out", "coloured", "unlit_quad", "spheres", "rooms", "light_box", "uniform"):
        yield scene, f"render {scene} {VCT} --background .2,.3,.4"
    yield "defaults said", ("render first --technique vct --set vct.voxels=texture --set vct.resolution=128 --set vct.bounces=2 "
                            "--set vct.detail=half --set vct.emitters=points --set vct.grid=fitted --set vct.step=0.5 --set vct.start=1 "
                            "--set vct.dither=0 --set vct.distance=0")
    yield "defaults said, the others", (f"render first {VCT} --set vct.shadows=rays --set vct.shadow_aperture=10 --set vct.ambient=0 "
                                        "--set vct.ao=1 --set vct.pyramid=directional --set vct.cover=sum --set vct.own=out "
                                        "--set vct.lambert=plain --set vct.show=none --set vct.axis=x")
    for side in (16, 64, 256):
        yield f"resolution={side}", f"render stage --technique vct --set vct.resolution={side}"
    yield "resolution=512", "render plane --technique vct --set vct.resolution=512 --set vct.show=radiance --light point:at=.3,.5,.2,intensity=2"
    for option in ("bounces=0", "bounces=1", "bounces=4", "cones=6", "cones=7", "cones=9", "cones=16", "cones=32", "detail=full", "emitters=cones",
                   "grid=cube", "step=1.5", "start=2", "dither=0.7", "distance=1.25", "ambient=0.5", "pyramid=isotropic",
                   "cover=product", "own=in", "lambert=weighted"):
        yield option, f"render stage {VCT} --set vct.{option}"
    yield "ao=3", f"render stage {VCT} --set vct.ambient=0.5 --set vct.ao=3"
    for shadows in ("map", "march", "cones", "volume"):
        yield f"shadows={shadows}", f"render rooms {VCT} --camera outside --set vct.shadows={shadows}"
    yield "shadow_aperture=40", f"render rooms {VCT} --camera outside --set vct.shadows=cones --set vct.shadow_aperture=40"
    yield "direct's options", f"render maps {VCT} --set direct.samples=4 --set direct.rows=16 --set vct.shadows=map --set direct.map=512"
    for show in ("albedo", "normal", "emission", "irradiance", "radiance", "coverage"):
        yield f"show={show}", f"render first {VCT} --set vct.show={show}"
    yield "level=1", f"render first {VCT} --set vct.show=radiance --set vct.level=1"
    yield "level=2", f"render stage {VCT} --set vct.show=coverage --set vct.level=2"
    for axis in "xyz":
        yield f"slice across {axis}", f"render first {VCT} --set vct.show=irradiance --set vct.axis={axis} --set vct.slice=12"
    yield "samples", f"render stage {VCT} --spp 3 --seed 5 --set vct.dither=1 --set vct.detail=full"
    yield "inspect", "inspect stage --set vct.resolution=16"


def _sweeps():
    yield "orbit", "sweep stage --orbit 3,35,8"
    yield "cameras", "sweep stage --cameras FOLDER/keys.json --format png --view reinhard"
    yield "keys, one of two shards", "sweep stage --keys FOLDER/keys.json --frames 4 --shard 2/2"
    yield "animation", "sweep stage --animation play --frames 3"
    yield "animation on an orbit", "sweep stage --animation play --orbit 3 --technique direct"
    yield "vct", f"sweep stage --animation play --frames 3 {VCT}"


def _scenes():
    for scene in SCENES:
        yield scene, f"describe {scene}"


def _refused():
    yield "an option of none", "render first --set pt.deph=3"
    yield "an option without a technique", "render first --set depth=3"
    yield "an option of direct", "render first --technique direct --set direct.sample=3"
    yield "an option of vct", "render first --technique vct --set vct.voxel=3"
    yield "pt's in direct", "render first --technique direct --set pt.depth=3"
    yield "vct's in pt", "render first --set vct.cones=9"
    yield "direct's in pt", "render first --set direct.samples=3"
    yield "depth 0", "render first --set pt.depth=0"
    yield "depth 5000", "render first --set pt.depth=5000"
    yield "a word", "render first --set pt.sampler=halton"
    yield "a number", "render first --set pt.clamp=much"
    yield "a number out of range", "render first --technique vct --set vct.step=9"
    yield "a whole number", "render first --technique vct --set vct.bounces=1.5"
    yield "no such resolution", "render first --technique vct --set vct.resolution=100"
    yield "too many cones", "render first --technique vct --set vct.cones=33"
    yield "no such map", "render first --technique direct --set direct.map=100"
    yield "an option twice", "render first --set pt.depth=3 --set pt.depth=4"
    yield "an option without a value", "render first --set pt.depth"
    yield "level without show", "render first --technique vct --set vct.level=1"
    yield "slice without show", "render first --technique vct --set vct.slice=1"
    yield "level of albedo", "render first --technique vct --set vct.show=albedo --set vct.level=1"
    yield "level too high", f"render first {VCT} --set vct.show=radiance --set vct.level=6"
    yield "slice outside", f"render first {VCT} --set vct.show=radiance --set vct.slice=200"
    yield "a row that is not shown", "render first --technique radiosity --set radiosity.row=1"
    for technique in ("direct", "vct"):
        yield f"a lens in {technique}", f"render first --technique {technique} --lens .1,2"
        yield f"a panorama in {technique}", f"render first --technique {technique} --panorama"
        yield f"a filter in {technique}", f"render first --technique {technique} --filter gauss"
        yield f"a target error in {technique}", f"render first --technique {technique} --error 0.1"
    yield "a panorama's lens", "render first --panorama --lens .1,2"
    yield "an AOV in a PNG", "render first --format png --aov depth"
    yield "an AOV of none", "render first --aov motion"
    yield "an effect of none", "render first --effects=-fog"
    yield "a view of none", "render first --format png --view aces"
    yield "no size", "render first --size 0x4"
    yield "too large a size", "render first --size 100000x4"
    yield "no camera of that name", "render first --camera door"
    yield "a camera in its target", "render first --camera 0,0,0,0,0,0,0,1,0,40"
    yield "up along the view", "render first --camera 0,0,0,0,1,0,0,1,0,40"
    yield "no node of that name", "render stage --node leg:scale=2"
    yield "a node flattened", "render stage --node arm:scale=1,0,1"
    yield "no material of that name", "render stage --material gold:metallic=1"
    yield "more than all", "render stage --material block:metallic=2"
    yield "no animation of that name", "render stage --animation dance"
    yield "a cone inside out", "render stage --light spot:at=0,1,0,to=0,0,0,cone=40,20,intensity=1"
    yield "no scene", "render nowhere"
    yield "a picture for a scene", "render sky"
    yield "a scene for a picture", "render first --background cornell"
    yield "too large a scale", "render first --background sky --background-scale 1e12"
    yield "a sweep over nothing", "sweep first --animation dance --frames 2"


def requests():
    """{name: command line}"""
    found = {}
    for group in (_pt, _cameras, _surroundings, _files, _edits, _effects, _direct, _vct, _sweeps, _scenes, _refused):
        for name, line in group():
            found[f"{group.__name__[1:]}: {name}"] = line
    return found
