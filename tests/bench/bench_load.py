"""What reading a scene file costs by how many of one thing it has: n, 2n, 4n and so on, in processor time of candil-loader, and what
twice as many cost: 2 where that is linear. Several loaders, of other builds, stand beside each other.

    python3 tests/bench/bench_load.py build/libexec/candil/candil-loader [OTHER-LOADER …] [-k WORD]
"""
import argparse
import base64
import json
import math
import os
import random
import resource
import struct
import subprocess
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes"))
from writers import png

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
TRIANGLE = struct.pack("<9f4H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2, 0)


def face(points):
    return "".join("v %.9g %.9g 0\n" % p for p in points) + "f " + " ".join(map(str, range(1, len(points) + 1))) + "\n"


def comb(n):
    return face([(x, 0 if x % 2 else 2) for x in range(n - 2)] + [(n - 3, -1), (0, -1)])


def spiral(n):
    turn = math.pi / 16
    arm = [((1 + .03 * k) * math.cos(turn * k), (1 + .03 * k) * math.sin(turn * k)) for k in range(n // 2)]
    return face(arm + [(x * (1 + .4 / math.hypot(x, y)), y * (1 + .4 / math.hypot(x, y))) for x, y in reversed(arm)])


def ring(n):
    return face([((2 + i % 2) * math.cos(2 * math.pi * i / n), (2 + i % 2) * math.sin(2 * math.pi * i / n)) for i in range(n)])


def walk(n):
    draw = random.Random(1)
    return face([(draw.random(), draw.random()) for _ in range(n)])


def steps(n):
    draw, at, points = random.Random(2), [0, 0], []
    for _ in range(n):
        at = [a + draw.choice((-1, 0, 1)) for a in at]
        points.append(tuple(at))
    return face(points)


def line(n):
    draw = random.Random(3)
    return face([(x, 2 * x) for x in (draw.randrange(n) for _ in range(n - 1))] + [(0, 1)])


def alike(n):
    return SQUARE + "f " + "1 2 3 4 " * (n // 4) + "\n"


def gltf(**more):
    document = {"asset": {"version": "2.0"},
                "buffers": [{"byteLength": len(TRIANGLE), "uri": "data:application/octet-stream;base64," + base64.b64encode(TRIANGLE).decode()}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                              {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "nodes": [{"mesh": 0}]}
    document.update(more)
    document.setdefault("scenes", [{"nodes": list(range(len(document["nodes"])))}])
    return json.dumps(document)


def chain(n):
    return gltf(nodes=[{"children": [i + 1]} for i in range(n - 1)] + [{"mesh": 0}], scenes=[{"nodes": [0]}])


def leaves(n):
    """A chain of 4,000 nodes, and what hangs on its end."""
    return gltf(nodes=[{"children": [i + 1]} for i in range(3999)] + [{"children": list(range(4000, 4000 + n))}] + [{"mesh": 0}] * n,
                scenes=[{"nodes": [0]}])


def one_node_moved(n):
    return channels(1).replace('"channels": [', '"channels": [' + '{"sampler": 0, "target": {"node": 0, "path": "scale"}},' * (n - 1))


def fan(n):
    """Triangles around one corner, of a material that needs tangents."""
    rim = "".join("v %.9g %.9g 0\nvt %.9g %.9g\n" % ((math.cos(i), math.sin(i)) * 2) for i in range(n))
    return ("mtllib a.mtl\nv 0 0 1\nvt 0 0\nvn 0 0 1\n" + rim + "usemtl m\n" + "".join(
        "f 1/1/1 %d/%d/1 %d/%d/1\n" % (i, i, i + 1, i + 1) for i in range(2, n + 1)),
        {"a.mtl": "newmtl m\nmap_Bump a.png\n", "a.png": png(1, 1, lambda x, y: (128, 128, 255))})


def channels(n):
    zeros = [{"componentType": 5126, "count": 2, "type": kind, "min": [0], "max": [1]} for kind in ("SCALAR", "VEC3")]
    nodes = [{"mesh": 0, "name": "n"} for _ in range(n)]
    base = json.loads(gltf())
    return gltf(accessors=base["accessors"] + zeros, nodes=nodes, animations=[{
        "name": "a", "samplers": [{"input": 2, "output": 3}] * n,
        "channels": [{"sampler": i, "target": {"node": i, "path": "translation"}} for i in range(n)]}])


def animations(n):
    return channels(2).replace('"animations": [', '"animations": [' + ",".join(
        ['{"name": "a", "samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}'] * n) + ",")


def materials(n):
    return gltf(materials=[{"name": "m", "pbrMetallicRoughness": {"metallicFactor": .5}}] * n, meshes=[
        {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": i} for i in range(n)]}])


def instanced(n):
    base = json.loads(gltf())
    return gltf(accessors=base["accessors"] + [{"componentType": 5126, "count": 1, "type": "VEC3"}], nodes=[
        {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}] * n,
        extensionsUsed=["EXT_mesh_gpu_instancing"])


def views(n):
    base = json.loads(gltf())
    return gltf(bufferViews=base["bufferViews"] + [{"buffer": 0, "byteLength": 36}] * n, accessors=base["accessors"] + [
        {"bufferView": 2 + i, "componentType": 5126, "count": 3, "type": "VEC3"} for i in range(n)], meshes=[
        {"primitives": [{"attributes": {"POSITION": 2 + i}, "indices": 1} for i in range(n)]}])


def buffers(n):
    base = json.loads(gltf())
    return gltf(buffers=base["buffers"] * n, bufferViews=base["bufferViews"] + [{"buffer": i, "byteLength": 36} for i in range(n)])


def library(text):
    return lambda n: ("mtllib a.mtl\n" + SQUARE + "usemtl m1\nf 1 2 3\n", {"a.mtl": text(n)})


# By name: the first n, how often it doubles, and the text of a file, or that and others beside it.
INPUTS = {
    "corners: a comb": (20000, 6, comb),
    "corners: a spiral": (20000, 6, spiral),
    "corners: a ring of spikes": (20000, 6, ring),
    "corners: crossing sides anywhere": (20000, 6, walk),
    "corners: a walk on a lattice": (20000, 6, steps),
    "corners: back and forth on a line": (20000, 6, line),
    "corners: four places": (20000, 6, alike),
    "obj groups": (50000, 4, lambda n: SQUARE + "".join("g a%d\nf 1 2 3\n" % i for i in range(n))),
    "obj groups of one name": (50000, 4, lambda n: SQUARE + "g a b\nf 1 2 3\n" * n),
    "obj many names in one g": (50000, 4, lambda n: SQUARE + "g " + " ".join("a%d" % i for i in range(n)) + "\nf 1 2 3\n"),
    "obj groups alike but for the last of 200 letters": (20000, 4, lambda n: SQUARE + "".join("g %s%06d\nf 1 2 3\n" % ("a" * 200, i) for i in range(n))),
    "obj one triangle often": (100000, 4, lambda n: SQUARE + "f 1 2 3\n" * n),
    "obj triangles on one line": (100000, 4, lambda n: "v 0 0 0\nv 0 1 0\n" + "".join("v %d 0 0\n" % i for i in range(n)) + "".join(
        "f 1 2 %d\n" % i for i in range(4, n + 3))),
    "obj triangles around one corner": (50000, 4, fan),
    "obj corners of one place": (100000, 4, lambda n: "v 0 0 0\n" * n + SQUARE + "".join("f %d -3 -2\n" % i for i in range(1, n + 1))),
    "obj objects": (50000, 4, lambda n: SQUARE + "".join("o a%d\nf 1 2 3\n" % i for i in range(n))),
    "obj materials": (16000, 2, lambda n: (
        "mtllib a.mtl\n" + SQUARE + "".join("usemtl m%d\nf 1 2 3\n" % i for i in range(n)),
        {"a.mtl": "".join("newmtl m%d\nKd .5 .5 .5\n" % i for i in range(n))})),
    "obj materials that no library has": (16000, 2, lambda n: SQUARE + "".join("usemtl m%d\nf 1 2 3\n" % i for i in range(n))),
    "obj usemtl between two": (100000, 4, lambda n: SQUARE + "usemtl m0\nf 1 2 3\nusemtl m1\nf 1 2 3\n" * (n // 2)),
    "obj libraries that are there": (1000, 4, lambda n: ("".join("mtllib a%d.mtl\n" % i for i in range(n)) + SQUARE + "f 1 2 3\n", {
        "a%d.mtl" % i: "newmtl m%d\n" % i for i in range(n)})),
    "obj libraries that are not": (50000, 4, lambda n: "".join("mtllib %d.mtl\n" % i for i in range(n)) + SQUARE + "f 1 2 3\n"),
    "obj libraries on one line": (50000, 4, lambda n: "mtllib " + " ".join("%d.mtl" % i for i in range(n)) + "\n" + SQUARE + "f 1 2 3\n"),
    "obj words that nobody knows": (50000, 4, lambda n: SQUARE + "".join("x%d 1\n" % i for i in range(n)) + "f 1 2 3\n"),
    "obj continued lines": (50000, 4, lambda n: SQUARE + "f " + "1 \\\n2 \\\n3 \\\n" * n + "\n"),
    "obj smoothing groups": (50000, 4, lambda n: SQUARE + "".join("s %d\nf 1 2 3\n" % (i + 1) for i in range(n))),
    "mtl of one name": (50000, 4, library(lambda n: "newmtl m1\nKd 1 1 1\n" * n)),
    "mtl maps that are not there": (16000, 2, library(lambda n: "".join("newmtl m%d\nmap_Kd %d.png\n" % (i, i) for i in range(n)))),
    "mtl one map often": (16000, 2, library(lambda n: "".join("newmtl m%d\nmap_Kd -o %d 0 0.png\n" % (i, i) for i in range(n)))),
    "mtl statements of one material": (50000, 4, library(lambda n: "newmtl m1\n" + "map_Kd -s 1 1 1 a.png\nKe 1 1 1\n" * n)),
    "mtl words that nobody knows": (50000, 4, library(lambda n: "newmtl m1\n" + "".join("x%d 1\n" % i for i in range(n)))),
    "gltf nodes": (50000, 4, lambda n: gltf(nodes=[{"mesh": 0, "name": "n%d" % i} for i in range(n)])),
    "gltf nodes of one name": (50000, 4, lambda n: gltf(nodes=[{"mesh": 0, "name": "n"}] * n)),
    "gltf a chain of nodes": (1000, 3, chain),
    "gltf leaves of a long chain": (50000, 4, leaves),
    "gltf channels of one node": (16000, 2, one_node_moved),
    "gltf nodes without meshes": (50000, 4, lambda n: gltf(nodes=[{"mesh": 0}] + [{"name": "e"}] * n)),
    "gltf meshes": (50000, 4, lambda n: gltf(meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}] * n,
                                             nodes=[{"mesh": i} for i in range(n)])),
    "gltf materials": (16000, 2, materials),
    "gltf instances": (50000, 4, instanced),
    "gltf channels": (16000, 2, channels),
    "gltf animations": (250, 3, animations),
    "gltf views and accessors": (50000, 4, views),
    "gltf buffers": (5000, 4, buffers),
    "gltf extensions": (50000, 4, lambda n: gltf(extensionsUsed=["X_%d" % i for i in range(n)])),
    "gltf extensions of nodes": (50000, 4, lambda n: gltf(nodes=[{"mesh": 0, "extensions": {"X_%d" % i: {}}} for i in range(n)],
                                                          extensionsUsed=["X_%d" % i for i in range(n)])),
    "gltf extensions of one node": (50000, 4, lambda n: gltf(nodes=[{"mesh": 0, "extensions": {"X_%d" % i: {} for i in range(n)}}])),
    "gltf scenes": (50000, 4, lambda n: gltf(scenes=[{"nodes": [0]}] * n)),
    "gltf cameras": (250, 3, lambda n: gltf(cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}] * n,
                                            nodes=[{"mesh": 0}] + [{"camera": i, "name": "c"} for i in range(n)])),
    "gltf textures that are not there": (1000, 3, lambda n: gltf(
        images=[{"uri": "%d.png" % i} for i in range(n)], textures=[{"source": i} for i in range(n)],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(n)])),
    "gltf images in materials": (16000, 2, lambda n: gltf(
        images=[{"uri": "a.png"}], textures=[{"source": 0}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}] * n)),
}


def seconds(loader, folder, name):
    """Processor time of a load, or what the loader said instead."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([loader, "--describe", "--dir", folder, "--file", name, "--images"], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent, done.stderr.strip() if done.returncode else ""


def measure(loader, folder, text, count):
    files = text(count)
    files, beside = files if isinstance(files, tuple) else (files, {})
    for other, content in beside.items():
        with open(os.path.join(folder, other), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
    name = "a.gltf" if files.startswith("{") else "a.obj"
    with open(os.path.join(folder, name), "w") as file:
        file.write(files)
    return seconds(loader, folder, name)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("loaders", nargs="+")
    parser.add_argument("-k", metavar="WORD", default="", help="only inputs whose names have it")
    options = parser.parse_args()
    print("| of what | loader | n | seconds for n, 2n, 4n … | each over the one before |\n| --- | --- | ---: | --- | --- |")
    for name, (first, times, text) in INPUTS.items():
        if options.k not in name:
            continue
        for number, loader in enumerate(options.loaders):
            spent = []
            with tempfile.TemporaryDirectory() as folder:
                idle, _ = measure(loader, folder, lambda n: SQUARE + "f 1 2 3\n", 0)
                for k in range(times + 1):
                    took, said = measure(loader, folder, text, first << k)
                    spent.append(took - idle)
                    if said:
                        break
            ratios = ["%.1f" % (b / a) if a > .02 else "-" for a, b in zip(spent, spent[1:])]
            print("| %s | %d | %d | %s%s | %s |" % (name, number + 1, first, ", ".join("%.2f" % s for s in spent),
                                                  ", then refused: " + said[:150] if said else "", ", ".join(ratios)), flush=True)


if __name__ == "__main__":
    main()
