"""Seeds for the fuzz targets: valid messages and streams, so that mutation starts from something that means something.

    make_corpus.py FOLDER LOADER     writes FOLDER/front/*, FOLDER/client/* and, by candil-loader, FOLDER/blob/*
"""
import os
import struct
import subprocess
import sys
import tempfile

import candil_pb2 as pb
import make

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


def blobs(folder):
    """Small scenes that between them have every section: textures, lights, emitters, masks, colours, second coordinates."""
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as scenes:
        for name in ("cornell", "textured_quad", "spot", "normal_mapped_quad", "alpha_mask", "vertex_colours", "second_uvs"):
            path = make.SCENES[name](scenes)
            subprocess.run([sys.argv[2], "--describe", "--dir", scenes, "--file", os.path.basename(path), "--images",
                            "--blob", os.path.join(folder, name)], check=True, stdout=subprocess.DEVNULL)


def main():
    blobs(os.path.join(sys.argv[1], "blob"))
    for folder, seeds in (("front", front), ("client", client)):
        path = os.path.join(sys.argv[1], folder)
        os.makedirs(path, exist_ok=True)
        for name, data in seeds():
            with open(os.path.join(path, name), "wb") as f:
                f.write(data)


main()
