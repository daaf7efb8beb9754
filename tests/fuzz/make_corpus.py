"""Seeds for the fuzz targets: what means something, so that mutation starts from there.

    make_corpus.py FOLDER LOADER     writes FOLDER/TARGET/*; those of blob by candil-loader
"""
import json
import os
import struct
import subprocess
import sys
import tempfile

import numpy as np
import OpenImageIO as oiio

import bad
import bad_patches
import candil_pb2 as pb
import make
import writers

MAGIC = 0x4C444E43


def message(kind, body, request=1, flags=0):
    return struct.pack("<IBBHII", MAGIC, 1, kind, flags, len(body), request) + body


def render():
    r = pb.Render(scene="box", technique=pb.TECHNIQUE_PT, width=64, height=32, samples=16, seed=7, aovs=3, progressive=True)
    r.camera.eye.x = 1.0
    r.camera.target.z = -1.0
    r.camera.up.y = 1.0
    r.camera.vfov_degrees = 40
    r.options.add(name="pt.depth", value="5")
    r.background.x = 0.5
    return r.SerializeToString()


def edited():
    """Everything that a request may change of a scene."""
    r = pb.Render()
    r.ParseFromString(render())
    r.edits.animation, r.edits.time_s = "walk", 1
    light = r.edits.lights.add(kind=pb.LIGHT_KIND_SPOT, inner_degrees=10, outer_degrees=20, range=5)
    light.position.y, light.direction.y, light.intensity.x = 2, -1, 10
    material = r.edits.materials.add(name="#0", metallic=1, roughness=0.5)
    material.base_color.x = 0.5
    node = r.edits.nodes.add(name="box")
    node.rotation.w, node.scale.x, node.scale.y, node.scale.z = 1, 1, 2, 1
    r.lens.radius, r.lens.focus, r.filter = 0.1, 2, pb.FILTER_GAUSSIAN
    r.ClearField("background")
    r.environment.scene, r.deadline_ms = "box", 1000
    return r.SerializeToString()


def imported():
    r = pb.Render()
    r.ParseFromString(render())
    r.technique, r.imported = pb.TECHNIQUE_RADIOSITY, "factors"
    r.ClearField("options")
    return r.SerializeToString()


def auto():
    r = pb.Render()
    r.ParseFromString(render())
    r.technique = pb.TECHNIQUE_AUTO
    r.target_error = 0.01
    r.ClearField("options")
    return r.SerializeToString()


def requests():
    """One of each type, with as many fields as it has."""
    quote = pb.Quote(pilot_ms=10)
    quote.render.ParseFromString(render())
    sweep = pb.Sweep()
    sweep.render.ParseFromString(render())
    sweep.render.ClearField("camera")
    for angle in range(3):
        camera = sweep.cameras.add(vfov_degrees=40)
        camera.eye.x = angle
        camera.target.z = -1
        camera.up.y = 1
    return {"hello": (1, pb.Hello(version_min=1, version_max=1, client="seed").SerializeToString()),
            "ping": (2, pb.Ping(payload=b"abc").SerializeToString()),
            "load": (3, pb.Load(name="box", path="box.gltf", up=pb.UP_Z, metres_per_unit=0.01).SerializeToString()),
            "unload": (4, pb.Unload(name="box").SerializeToString()),
            "list": (5, b""),
            "describe": (6, pb.Describe(name="box").SerializeToString()),
            "render": (7, render()),
            "edited": (7, edited()),
            "imported": (7, imported()),
            "auto": (7, auto()),
            "cancel": (8, pb.Cancel(request=7).SerializeToString()),
            "stats": (9, b""),
            "sweep": (10, sweep.SerializeToString()),
            "quote": (11, quote.SerializeToString())}


def request():
    for name, (kind, body) in requests().items():
        yield name, bytes([kind]) + body


# What happens in fuzz_session.c, `n` of it.
MESSAGE, BYTES, WORK, PASS, LOADER_ENDS, WORKER_ENDS, READS, HANG_UP = range(8)


def event(what, n=0):
    return bytes([what + 8 * n])


def say(name, request=1, client=0, flags=0):
    """A message of fuzz_session.c; flags 3: with the descriptor of a folder."""
    kind, body = requests()[name]
    return event(MESSAGE, client) + struct.pack(">BBBH", kind, flags, request, len(body)) + body


def session():
    work = event(WORK, 3)
    scene = say("hello") + say("load", 1, flags=3) + work
    yield "render", scene + say("render", 2) + 6 * work + say("list", 3) + say("stats", 4) + say("describe", 5)
    yield "root", say("hello") + say("load", 1) + work + say("edited", 2) + 6 * work
    yield "sweep", scene + say("sweep", 2) + 12 * work + say("unload", 3)
    yield "quotes", scene + say("quote", 2) + say("auto", 3) + 8 * work + event(PASS) + 4 * work
    yield "cancels", scene + say("render", 7) + work + say("cancel", 8) + say("quote", 7) + say("cancel", 9) + 3 * work
    yield "three", b"".join(say("hello", 1, c) + say("load", 2, c, 3) + say("render", 3, c) for c in range(3)) + 9 * work + \
        event(HANG_UP, 1) + 9 * work
    yield "slow", scene + event(READS, 3) + b"".join(say("render", r) for r in range(2, 9)) + 20 * event(WORK, 30) + \
        event(PASS) + event(READS) + work
    for signal in range(4):
        yield f"worker{signal}", scene + 4 * (say("render", 2) + event(WORK, 1) + event(WORKER_ENDS, signal) + 2 * event(PASS)) + work
        yield f"loader{signal}", say("hello") + say("load", 1, flags=3) + event(LOADER_ENDS, signal) + say("load", 2)
    yield "hangs", scene + say("render", 2) + 40 * event(PASS)
    hello = message(1, requests()["hello"][1])
    yield "torn", event(BYTES) + bytes([9]) + hello[:9] + event(BYTES) + bytes([len(hello) - 9]) + hello[9:] + \
        event(BYTES) + bytes([16]) + b"no header of ours"[:16] + 2 * event(PASS)
    yield "unload", scene + say("render", 2) + say("unload", 3) + say("load", 4) + event(HANG_UP) + 3 * work


# What happens in fuzz_children.c: seven kinds, and whose it is.
GOOD, ALTERED, CHOSEN, RAW, PASSES, ENDS, ASK = range(7)
LOADER = 3


def child(what, n=0):
    return bytes([what + 7 * n])


def children():
    start = child(GOOD) + 2 * child(ASK) + child(GOOD, LOADER)  # a scene and a render
    work = child(GOOD, 20)
    yield "all", start + 6 * (child(ASK) + 4 * work)
    yield "times", start + 30 * (child(GOOD) + child(PASSES))
    # The answer that is due, but for some bytes: `place` says which of fuzz_children.c's.
    for place in range(59):
        whose = LOADER if place >= 45 else 0
        change = child(CHOSEN, whose) + bytes([255, 1, place, 4]) + b"\xff\xff\xff\x7f"
        before = child(GOOD) + 2 * child(ASK) if whose else start
        yield f"place{place}", before + change + 3 * (child(GOOD) + change) + child(ASK) + child(GOOD) + change + 2 * work
    # The image in the end, likewise.
    for place in range(30):
        yield f"image{place}", start + 4 * child(GOOD) + child(CHOSEN) + bytes([255, 1, place, 2]) + b"\xff\x01" + work
    yield "unasked", start + b"".join(child(ALTERED) + bytes([op, 0]) for op in range(8)) + work
    yield "raw", start + child(RAW) + bytes([8]) + struct.pack("<II", 9, 1) + work
    for kind in (4, 8, 12):
        yield f"descriptor{kind}", start + 3 * child(GOOD) + child(ALTERED, kind) + bytes([12, 0]) + work
    for signal in range(4):
        yield f"end{signal}", start + child(GOOD) + child(ENDS, signal) + 4 * child(PASSES) + work


def quotes():
    """Records as server/front/quotes/model.h has them: two frames and a pilot."""
    def record(look, pilot, *parts):
        return struct.pack("<5Q5I9f", 1, 2, look, 4, 5 + look, 1, pilot, 4096, 16, 127, *parts, 0.5, 0.25)
    frame = record(3, 0, 1, 2, 3, 4, 5, 6, -2)
    yield "frames", bytes([2]) + frame + record(4, 0, 1, 1, 1, 1, 1, 1, -1)
    yield "pilot", bytes([1]) + record(3, 1, 1, 2, 3, 4, 5, 6, -2)
    yield "habits", bytes([1]) + frame + struct.pack("<Q17d", 1, *17 * [1.0])


def front():
    hello = message(1, pb.Hello(version_min=1, version_max=1, client="seed").SerializeToString())
    yield "hello", hello
    yield "ping", hello + message(2, pb.Ping(payload=b"abc").SerializeToString(), 2)
    yield "load", hello + message(3, pb.Load(name="box", path="box.gltf", up=pb.UP_Z, metres_per_unit=0.01).SerializeToString(), 3)
    yield "scenes", hello + message(4, pb.Unload(name="box").SerializeToString(), 4) + message(5, b"", 5) + \
        message(6, pb.Describe(name="box").SerializeToString(), 6)
    yield "render", hello + message(7, render(), 7) + message(8, pb.Cancel(request=7).SerializeToString(), 8)
    yield "stats", hello + message(9, b"", 9)


def client():
    hello = message(0x81, pb.HelloReply(version=1, server="seed", max_message_bytes=65536).SerializeToString())
    accepted = pb.Accepted(technique=pb.TECHNIQUE_PT, device="d", samples=16, depth=8)
    accepted.plan.add(effect=pb.EFFECT_BOUNCES, state=pb.EFFECT_STATE_SIMULATED, why="light")
    image = pb.ImageFrame(final=True, format=pb.FORMAT_PNG, width=64, height=64, samples=16, bytes=8)
    done = pb.Done(samples=16, elapsed_us=10, device="d", reason="samples")
    done.stages.add(name="trace", us=9)
    done.figures.add(name="voxel", value=0.25, unit="m")
    # The library numbers its requests from 1 on, the hello included: cover the neighbours.
    for first in (1, 2):
        yield f"render{first}", hello + message(0x86, accepted.SerializeToString(), first) + \
            message(0x87, pb.Progress(samples_done=1, samples=16).SerializeToString(), first) + \
            message(0x88, image.SerializeToString(), first) + message(0x89, b"12345678", first) + \
            message(0x8A, done.SerializeToString(), first)
    info = pb.SceneInfo(name="scene", file="scene.gltf", triangles=12, warnings=["one"], facts=["textures"])
    info.cameras.add(name="c", vfov_degrees=40)
    yield "describe", hello + message(0x83, info.SerializeToString(), 2) + message(0x83, info.SerializeToString(), 3)
    scenes = pb.SceneList()
    scenes.scenes.add(name="scene", triangles=12)
    yield "list", hello + message(0x85, scenes.SerializeToString(), 3) + message(0x85, scenes.SerializeToString(), 4)
    yield "error", hello + message(0xFF, pb.Error(code=40, name="scene-not-found", message="no").SerializeToString(), 2)


def study():
    head = {"version": 1, "title": "a", "size": [16, 8], "views": [{"name": "v", "camera": None}], "techniques": ["pt", "vct"],
            "settings_varied": {}, "seeds": 2, "complete": True, "missing": ["z"], "skipped": [], "notes": []}
    line = {"id": "a", "kind": "point", "view": 0, "technique": "pt", "settings": {"samples": 4}, "effects": "auto", "seed": 1,
            "warm": True, "image": "a.exr", "command": "candil", "failed": None, "quote": None, "report": {
                "elapsed_us": 9, "cold_us": 0, "samples": 4, "stages": [{"name": "trace", "us": 8}], "error_kind": "measured",
                "estimated_relmse": 0.1, "relmse_low": 0.05, "relmse_high": 0.2}}
    lines = [line, dict(line, id="b", kind="reference"), dict(line, id="c", quote={
        "time_ms": 1, "time_ms_low": 0.5, "time_ms_high": 2, "relmse": 0.1, "from": "pilot"}), dict(line, id="d", failed="no")]
    yield "one", json.dumps(head).encode() + b"\0" + b"\n".join(json.dumps(x).encode() for x in lines)
    yield "torn", json.dumps(head).encode() + b"\0" + json.dumps(line).encode()[:100]


def files(folder):
    """Scenes of both formats that between them have what an importer knows, small enough to be mutated."""
    scenes = [make.SCENES[name](folder) for name in (
        "furnace_glb", "hierarchy", "negative_scale", "spot", "stage", "textured_quad", "normal_mapped_quad", "alpha_mask",
        "vertex_colours", "second_uvs", "alpha_blend", "cornell_obj")]
    for name, write in bad.BAD.items():
        scenes.append(write(os.path.join(folder, name)))
    return scenes


def gltf_and_obj(out, folder):
    put(out, "obj", "maps", b"mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl a\n"
        b"f 1/1/1 2/2/1 3/3/1\n\0newmtl a\nKd 1 1 1\nKs .5 .5 .5\nKe 1 1 1\nNs 20\nPr .5\nPm 1\nmap_Kd -s 2 2 map.png\nmap_Ke map.png\n"
        b"map_bump -bm 2 map.png\nnorm map.png\nmap_Pr map.png\nmap_Pm map.png\nmap_d map.png\nmap_Ks MAP.PNG\nillum 7\n")
    for path in files(folder):
        with open(path, "rb") as f:
            data = f.read()
        if len(data) > 16384:
            continue
        kind = "obj" if path.endswith(".obj") else "gltf"
        base = os.path.basename(os.path.dirname(path)) if os.path.dirname(path) != folder else os.path.basename(path)
        if kind == "obj":
            mtl = sorted(f for f in os.listdir(os.path.dirname(path)) if f.endswith(".mtl"))
            if mtl:
                with open(os.path.join(os.path.dirname(path), mtl[0]), "rb") as f:
                    data = data.replace(mtl[0].encode(), b"scene.mtl") + b"\0" + f.read()
        put(out, kind, base, data)


def patches(out, folder):
    for name, (write, _, _) in bad_patches.CASES.items():
        with open(write(folder), "rb") as f:
            data = f.read()
        if len(data) <= 16384:
            put(out, "patches", name, data)


def pictures(out, folder):
    """A picture in each of the formats, of few pixels."""
    rgb = np.float32([[(x / 7, y / 3, 0.5) for x in range(8)] for y in range(4)])
    ways = [("png", 0), ("jpg", 0), ("bmp", 1), ("tga", 2), ("tif", 3), ("exr", 9), ("hdr", 9), ("png", 9), ("tif", 9)]
    for ending, first in ways:
        path = os.path.join(folder, "p." + ending)
        for depth in ("uint8", "uint16") if ending in ("png", "tif") else ("uint8",):
            write_picture(path, rgb, depth)
            with open(path, "rb") as f:
                put(out, "image", f"{ending}{first}{depth}", bytes([first]) + f.read())


def write_picture(path, rgb, depth):
    spec = oiio.ImageSpec(rgb.shape[1], rgb.shape[0], 3, oiio.FLOAT if path.endswith((".exr", ".hdr")) else depth)
    out = oiio.ImageOutput.create(path)
    out.open(path, spec)
    out.write_image(rgb)
    out.close()


def put(out, target, name, data):
    folder = os.path.join(out, target)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "wb") as f:
        f.write(data)


def blobs(folder):
    """Small scenes that between them have every section: textures, lights, emitters, masks, colours, second coordinates; and one
    of patches and one of form factors."""
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as scenes:
        for name in ("cornell", "textured_quad", "spot", "normal_mapped_quad", "alpha_mask", "vertex_colours", "second_uvs", "stage", "alpha_blend", "polished"):
            path = make.ggx_furnace(scenes, 0.05, subdivisions=0) if name == "polished" else make.SCENES[name](scenes)
            blob_of(path, os.path.join(folder, name))
        for name in ("ply_sound", "mtx_sound"):
            blob_of(bad_patches.CASES[name][0](scenes), os.path.join(folder, name))


def blob_of(path, blob):
    subprocess.run([sys.argv[2], "--describe", "--dir", os.path.dirname(path), "--file", os.path.basename(path), "--images", "--blob", blob],
                   check=True, stdout=subprocess.DEVNULL)


def main():
    out = sys.argv[1]
    blobs(os.path.join(out, "blob"))
    for target, seeds in (("front", front), ("request", request), ("session", session), ("children", children), ("quotes", quotes),
                          ("client", client), ("study", study)):
        for name, data in seeds():
            put(out, target, name, data)
    with tempfile.TemporaryDirectory() as folder:
        gltf_and_obj(out, folder)
        patches(out, folder)
        pictures(out, folder)


main()
