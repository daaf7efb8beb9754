"""What voxel cone tracing is worth: its error against the path tracer with as many scattering events, its time beside that of
one path-traced sample per pixel, and what each of its options changes in both.

    bench_vct.py [error] [speed] [stages] [options] [scenes]     all without a name

error: the public Cornell box by resolution, beside `direct` and `direct` + the best constant x albedo. speed: another camera,
another light, a mesh of 262,144 triangles moved, each in turns with path tracing. stages: every stage by scene and
resolution. options: time and error by option. scenes: error of the public scenes.
CANDIL_SCENES names the folder of public scenes; without it there are only ours. References are kept in --references.

Times and memory of the stages by scene and resolution, cones at 720p and 1080p, steps, shadows and apertures, each with its error:
    bench_vct.py stages options --resolutions 64,128,256 --spp 32 --references FOLDER
and of a few scenes alone with --cases Sponza,our. Side by side, with every scene's error:
    bench_vct.py scenes --side 320 --spp 64 --references FOLDER --pictures FOLDER"""
import argparse
import json
import math
import os

import numpy

import bench
import images
import judge
import make
import rooms
from render import Daemon, Picture
from writers import Gltf, quad, transformed

PUBLIC = os.environ.get("CANDIL_SCENES")
SUN = ["--light", "directional:direction=-0.25,-1,-0.15,intensity=12"]
BOUNCES = 2
QUIET_STAGES = ("queue", "upload", "compile", "encode")


class Case:
    """A scene as it is rendered here. `arguments`: camera and light. Pixels as bright as `brightest` are lamps and not judged. `glows`:
    what lights it has so many triangles that it is a matter for cones, too."""

    def __init__(self, name, path, arguments=(), brightest=math.inf, glows=False):
        self.name, self.path, self.arguments, self.brightest, self.glows = name, path, list(arguments), brightest, glows

    def is_there(self):
        return os.path.exists(self.path)


def sphere(columns, rows, radius=0.4):
    """columns x rows x 2 triangles, the two rings at the poles without area left out."""
    positions = [[radius * math.sin(math.pi * r / rows) * math.cos(2 * math.pi * c / columns), radius * math.cos(math.pi * r / rows),
                  radius * math.sin(math.pi * r / rows) * math.sin(2 * math.pi * c / columns)]
                 for r in range(rows + 1) for c in range(columns)]
    triangles = []
    for r in range(rows):
        for c in range(columns):
            a, b = r * columns + c, r * columns + (c + 1) % columns
            triangles += [(a, b, b + columns), (a, b + columns, a + columns)]
    return positions, triangles


def mesh_in_a_room(folder):
    """262,144 triangles that can be moved, in the walls of our Cornell box."""
    g = Gltf()
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    g.place(*sphere(512, 256), g.material("mesh", (.6,) * 3), name="mesh", translation=[0, 0.5, 0])
    g.place(*quad((-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)),
            g.material("lamp", (0, 0, 0), (15,) * 3), name="lamp")
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(folder, "mesh.glb")


def obj_triangles(path):
    """(positions, triangles) of an OBJ file: faces as fans, all else passed over."""
    positions, triangles = [], []
    with open(path, encoding="utf-8") as file:
        for words in (line.split() for line in file):
            if words[:1] == ["v"]:
                positions.append([float(x) for x in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
    return positions, triangles


def teapot_in_a_box(folder):
    """Our Cornell box with nothing in it that shines but a teapot, 6,320 triangles."""
    positions, triangles = obj_triangles(f"{PUBLIC}/teapot/teapot.obj")
    low, high = ([f(p[i] for p in positions) for i in range(3)] for f in (min, max))
    scale = 1.2 / max(h - l for l, h in zip(low, high))
    offset = [-scale * (low[0] + high[0]) / 2, 0.01 - scale * low[1], -scale * (low[2] + high[2]) / 2]
    g = Gltf()
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    # Its winding is the other way about here and there: both sides shine.
    g.place(transformed(positions, scale=scale, offset=offset), triangles, g.material("teapot", (.5,) * 3, (4, 3, 2), both_sides=True))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(folder, "teapot.glb")


# Curtains of Sponza, by their places among its materials, which have no names: red, green and blue light out of the like.
CURTAINS = [part for edit in ("#18:emission=3,.2,.1", "#19:emission=.2,3,.1", "#17:emission=.2,.4,3", "#15:emission=.2,.4,3")
            for part in ("--material", edit)]


def cases(folder, given):
    found = [Case("our Cornell box", make.cornell(folder), brightest=4), Case("light box", rooms.light_box(folder), brightest=0.49)]
    if PUBLIC:
        found += [Case("Bitterli's Cornell box", f"{PUBLIC}/ref-cornell-box/cornell-box.gltf", brightest=4),
                  Case("Sponza, sun", f"{PUBLIC}/sponza/Sponza.gltf", ["--camera", "-10,1.2,-.5,0,2.6,0,0,1,0,60", *SUN]),
                  Case("Sponza, curtains that glow", f"{PUBLIC}/sponza/Sponza.gltf", ["--camera", "-10,1.2,-.5,0,2.6,0,0,1,0,60", *CURTAINS],
                       brightest=2.9, glows=True),
                  Case("kitchen", f"{PUBLIC}/kitchen/kitchen.obj", kitchen_camera(), brightest=3.9),
                  Case("Veach's plates", f"{PUBLIC}/ref-veach-mis/veach-mis.gltf", brightest=7)]
    if PUBLIC and os.path.exists(f"{PUBLIC}/teapot/teapot.obj"):
        found += [Case("teapot that glows", teapot_in_a_box(folder), brightest=1.9, glows=True)]
    return [case for case in found if case.is_there() and case.name.startswith(tuple(given.cases.split(",")))]


def kitchen_camera():
    path = f"{PUBLIC}/kitchen/camera.json"
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        c = json.load(file)
    return ["--camera", ",".join(f"{x:g}" for x in (*c["eye"], *c["target"], *c["up"], c.get("vfov_degrees", 60)))]


class Renders:
    """Renders of one loaded scene; references are kept as files."""

    def __init__(self, daemon, case, references):
        self.daemon, self.case, self.references = daemon, case, references
        daemon.candil("load", case.path, "--name", "scene")

    def close(self):
        self.daemon.candil("unload", "scene")

    def __call__(self, technique, size, spp=1, more=(), **options):
        named = {f"{technique}.{name}": value for name, value in options.items()}
        return self.daemon.render("scene", size, spp, options=named, arguments=["--technique", technique, *self.case.arguments, *more])

    def reference(self, size, spp):
        safe = "".join(c if c.isascii() and c.isalnum() else "-" for c in self.case.name)
        path = os.path.join(self.references, f"{safe}-{size[0]}x{size[1]}-{spp}.exr")
        if not os.path.exists(path):
            images.write(path, self("pt", size, spp, depth=BOUNCES + 1).radiance)
        return Picture(path, None).radiance

    def baseline(self, size, spp):
        """(reference, direct, direct + constant, mask)"""
        reference = self.reference(size, spp)
        first = self("direct", size, 4, ["--aov", "albedo,id"])
        mask = (first.channels["id"] > 0) & (first.radiance.max(axis=2) < self.case.brightest)
        flat, _ = judge.fitted(first.radiance, judge.albedo(first), reference, mask)
        return reference, first.radiance, flat, mask


def milliseconds(picture, *names):
    """Of these stages; of all that are the technique's own without names."""
    return sum(s["us"] for s in picture.report["stages"] if (s["name"] in names if names else s["name"] not in QUIET_STAGES)) / 1e3


def side_by_side(path, reference, picture, mask):
    """Path tracing, cones, and |difference| x 4 under one exposure."""
    scale = 0.6 / max(float(numpy.percentile(reference[mask], 90)), 1e-6)
    parts = [reference, picture, 4 * numpy.abs(picture - reference) * mask[..., None]]
    row = numpy.concatenate([numpy.clip(part * scale, 0, 1) ** (1 / 2.2) for part in parts], axis=1)
    images.write(path, row)


def judged(picture, reference, mask):
    return f"{judge.relmse(picture, reference, mask):.4f}", f"{100 * judge.mean_error(picture, reference, mask):+.1f}"


def error_rows(renders, size, spp, pictures, rows):
    reference, direct, flat, mask = renders.baseline(size, spp)
    for name, picture in (("direct", direct), ("direct + constant × albedo", flat)):
        yield (renders.case.name, name, *judged(picture, reference, mask), "")
    for name, options in rows:
        renders("vct", size, 1, bounces=BOUNCES, **options)
        picture = renders("vct", size, 4, bounces=BOUNCES, **options)
        if pictures:
            safe = "".join(c if c.isascii() and c.isalnum() else "-" for c in f"{renders.case.name} {name}")
            side_by_side(os.path.join(pictures, safe + ".png"), reference, picture.radiance, mask)
        yield (renders.case.name, name, *judged(picture.radiance, reference, mask), f"{milliseconds(picture) / 4:.0f}")


ERROR_COLUMNS = ["scene", "picture", ">relMSE", ">mean %", ">ms a sample, voxels kept"]


def error(daemon, given, folder):
    case = next((c for c in cases(folder, given) if c.name.startswith("Bitterli")), cases(folder, given)[0])
    renders = Renders(daemon, case, given.references)
    rows = [(f"vct {r}³", {"resolution": r}) for r in (64, 128, 256)]
    rows += [("vct 128³, every pixel", {"resolution": 128, "detail": "full"})]
    bench.table(ERROR_COLUMNS, error_rows(renders, (given.side, given.side), given.spp, given.pictures, rows))
    renders.close()


def scenes(daemon, given, folder):
    def rows():
        for case in cases(folder, given):
            renders = Renders(daemon, case, given.references)
            ways = [("vct 128³", {"resolution": 128}), ("vct 256³", {"resolution": 256})]
            if case.glows:
                ways += [("vct 128³, emitters by cones", {"resolution": 128, "emitters": "cones"})]
            yield from error_rows(renders, (given.side // 2, given.side // 2), given.spp, given.pictures, ways)
            renders.close()
    bench.table(ERROR_COLUMNS, rows())


def timed_changes(renders, size, changes, turns):
    """{"path": ms of a sample, change: ms}, medians over turns."""
    options = {"bounces": BOUNCES, "resolution": 128}
    times = {name: [] for name in ("path", *changes)}
    for i in range(turns + 1):
        turn = {"path": milliseconds(renders("pt", size, 4, depth=8)) / 4}
        for name, change in changes.items():
            renders("vct", size, **options)
            picture = renders("vct", size, 1, change(i + 1), **options)
            turn[name] = milliseconds(picture) + milliseconds(picture, "upload")
        # The first turn compiles.
        if i > 0:
            for name, ms in turn.items():
                times[name].append(ms)
    return {name: bench.median(ms) for name, ms in times.items()}


def speed(daemon, given, folder):
    """In turns: path tracing of 4 samples, then each kind of change. The box's path-traced sample is the measure of all."""
    size = (given.side, given.side)
    renders = Renders(daemon, Case("box", make.cornell(folder)), given.references)
    box_ms = timed_changes(renders, size, {
        "another camera": lambda i: ["--camera", f"{0.1 * i},1,3.9,0,1,0,0,1,0,39"],
        "another light": lambda i: ["--material", f"lamp:emission={10 + i},{10 + i},{8 + i}"]}, given.turns)
    renders.close()
    renders = Renders(daemon, Case("mesh", mesh_in_a_room(folder)), given.references)
    mesh_ms = timed_changes(renders, size, {
        "another camera": lambda i: ["--camera", f"{0.1 * i},1,3.9,0,1,0,0,1,0,39"],
        "the mesh moved": lambda i: ["--node", f"mesh:translate={0.05 * i},0.5,0"]}, given.turns)
    renders.close()
    bench.table([f"{given.side}², 128³", "", ">ms", ">over the scene's path-traced sample", ">over the box's", ">asked"],
                [(scene, name, f"{ms:.0f}", f"{ms / all_ms['path']:.2f}", f"{ms / box_ms['path']:.2f}",
                  {"another camera": 2.5, "another light": 5, "the mesh moved": 7}.get(name, ""))
                 for scene, all_ms in (("our Cornell box", box_ms), ("262,144 triangles", mesh_ms)) for name, ms in all_ms.items()])


STAGES = ("voxelise", "voxel-light", "pyramid", "voxel-gather", "visibility", "light", "soften", "cones")


def stages(daemon, given, folder):
    def rows():
        for case in cases(folder, given):
            for resolution in given.resolutions:
                renders = Renders(daemon, case, given.references)
                renders("vct", (64, 64), resolution=16)   # compiles and uploads
                first = renders("vct", (1280, 720), resolution=resolution)
                memory = daemon.stats()["device_bytes"] / (1 << 20)
                large = renders("vct", (1920, 1080), resolution=resolution)
                reference, _, _, mask = renders.baseline((320, 180), given.spp)
                picture = renders("vct", (320, 180), 4, resolution=resolution).radiance
                yield (case.name, f"{resolution}³", *(f"{milliseconds(first, s):.0f}" for s in STAGES),
                       f"{milliseconds(large, 'cones'):.0f}", f"{memory:.0f}", judged(picture, reference, mask)[0])
                renders.close()
    bench.table(["720p", ">voxels", *(">" + s for s in STAGES), ">cones, 1080p", ">MiB in all", ">relMSE"], rows())


OPTIONS = [("as it is", {}), *((f"step {s}", {"step": s}) for s in (0.1, 0.25, 1, 2.5)),
           *((f"shadows {s}", {"shadows": s}) for s in ("march", "cones", "volume", "map")),
           *((f"shadow cones {a}°", {"shadows": "cones", "shadow_aperture": a}) for a in (1, 5, 20, 45)),
           *((f"{c} cones", {"cones": c}) for c in (6, 9, 16, 32)), ("every pixel", {"detail": "full"}),
           ("isotropic", {"pyramid": "isotropic"}), ("opacities multiply", {"cover": "product"}), ("own plane left in", {"own": "in"}),
           ("weighted Lambert", {"lambert": "weighted"}), ("emitters by cones", {"emitters": "cones"}), ("dither", {"dither": 1}),
           ("one bounce", {"bounces": 1}), ("cube", {"grid": "cube"})]


def options(daemon, given, folder):
    def rows():
        for case in [c for c in cases(folder, given) if c.name.startswith(("Sponza", "Bitterli", "our"))][-2:]:
            renders = Renders(daemon, case, given.references)
            reference, _, _, mask = renders.baseline((320, 180), given.spp)
            for name, chosen in OPTIONS:
                renders("vct", (64, 36), 1, **chosen)
                frame = renders("vct", (1280, 720), 1, **chosen)
                picture = renders("vct", (320, 180), 4, **chosen).radiance
                yield (case.name, name, f"{milliseconds(frame, 'light', 'soften'):.0f}", f"{milliseconds(frame, 'cones'):.0f}",
                       *judged(picture, reference, mask))
            renders.close()
    bench.table(["720p, 128³", "option", ">light ms", ">cones ms", ">relMSE", ">mean %"], rows())


def main():
    parts = {f.__name__: f for f in (error, speed, stages, options, scenes)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(parts))
    parser.add_argument("--side", type=int, default=512, help="pixels (default %(default)s)")
    parser.add_argument("--spp", type=int, default=256, help="of references (default %(default)s)")
    parser.add_argument("--turns", type=int, default=5, help="of speed (default %(default)s)")
    parser.add_argument("--cases", default="", help="scenes whose names begin so, with commas between (default: all)")
    parser.add_argument("--resolutions", default="64,128,256", help="of stages (default %(default)s)")
    parser.add_argument("--references", help="folder that keeps references from run to run")
    parser.add_argument("--pictures", help="folder for path tracing, cones and their difference x 4 side by side")
    given = parser.parse_args()
    given.resolutions = [int(r) for r in given.resolutions.split(",")]
    if not set(given.parts) <= set(parts):
        parser.error("parts are " + ", ".join(parts))
    with Daemon() as daemon:
        given.references = given.references or daemon.folder
        daemon.render(make.unlit(daemon.folder), (8, 8), 1)
        bench.header(daemon.stats()["device"])
        for name in given.parts or parts:
            parts[name](daemon, given, daemon.folder)


if __name__ == "__main__":
    main()
