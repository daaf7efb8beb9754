"""Small files that ask for much: what cannot be is refused before it is made, in little memory; what can be takes a time that grows
as the file does. The bounds on processor time are twenty times what is needed, and a tenth of what work by pairs would take."""
import base64
import json
import os
import resource
import struct
import subprocess
import tempfile
import unittest
import zlib

from loaded import LOADER, WANTS_IMAGES

SANITIZE = os.environ.get("CANDIL_SANITIZE") == "1"
SECONDS = 60 if SANITIZE else 20  # of processor time
TRIANGLE = struct.pack("<9f4H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2, 0)
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def gltf(zeros=0, **more):
    """A triangle, and an accessor each of `zeros` vectors and numbers that no byte of the file stands for."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(TRIANGLE).decode()
    document = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(TRIANGLE), "uri": uri}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                              {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
                              {"componentType": 5126, "count": zeros, "type": "VEC3"},
                              {"componentType": 5126, "count": zeros, "type": "SCALAR"}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "nodes": [{"mesh": 0}]}
    if not zeros:
        del document["accessors"][2:]
    document.update(more)
    document["scenes"] = [{"nodes": list(range(len(document["nodes"])))}]
    return json.dumps(document)


def png(side, whole=True):
    """A black picture of one bit a pixel. If not `whole`, its last bytes are wrong."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    pixels = zlib.compress(bytes((side // 8 + 1) * side), 9)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 1, 0, 0, 0, 0)) +
            chunk(b"IDAT", pixels if whole else pixels[:-40]) + chunk(b"IEND", b""))


class Bounds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, content):
        with open(os.path.join(self.folder, name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return name

    def describe(self, name, mebibytes=None):
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
            if mebibytes and not SANITIZE:
                resource.setrlimit(resource.RLIMIT_AS, (mebibytes << 20, mebibytes << 20))
        for images in ([], ["--images"]):
            done = subprocess.run([LOADER, "--describe", "--dir", self.folder, "--file", name] + images, capture_output=True,
                                  text=True, preexec_fn=limit)
            if done.returncode != WANTS_IMAGES:
                return done

    def refused(self, name, words, mebibytes=None):
        done = self.describe(name, mebibytes)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("candil-loader: scene-limit: ", done.stderr)
        self.assertIn(words, done.stderr)

    def loads(self, name, **counts):
        done = self.describe(name)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        self.assertEqual({key: info[key] for key in counts}, counts)
        return info

    # ---- sums: all within the limit of one, not within that of all

    def test_instances_of_many_nodes(self):
        instanced = {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}
        self.refused(self.write("a.gltf", gltf(1 << 19, nodes=[instanced] * 100)), "vertices", 128)
        # Also where nothing is made of them.
        for primitives in [], [{"attributes": {"POSITION": 0}, "mode": 1}]:
            scene = gltf(1 << 19, nodes=[instanced] * 100, meshes=[{"primitives": primitives}])
            self.refused(self.write("a.gltf", scene), "instances and primitives", 128)

    def test_one_mesh_under_many_nodes(self):
        mesh = [{"primitives": [{"attributes": {"POSITION": 2}, "indices": 1}]}]
        self.refused(self.write("a.gltf", gltf(1 << 19, meshes=mesh, nodes=[{"mesh": 0}] * 200)), "vertices", 128)
        self.refused(self.write("a.gltf", gltf(1 << 19, meshes=[{"primitives": mesh[0]["primitives"] * 200}])), "vertices", 128)
        mesh = [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 1}] * 6000}]
        self.refused(self.write("a.gltf", gltf(meshes=mesh, nodes=[{"mesh": 0}] * 6000)), "instances and primitives", 128)

    def test_only_what_the_scene_shows_counts(self):
        document = json.loads(gltf(1 << 19, meshes=[{"primitives": [{"attributes": {"POSITION": 2}, "indices": 1}]},
                                                    {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                                   nodes=[{"mesh": 0}] * 200 + [{"mesh": 1}]))
        document["scenes"] = [{"nodes": [200]}]
        self.loads(self.write("a.gltf", json.dumps(document)), triangles=1, node_count=1)

    def test_channels_that_share_their_keys(self):
        channels = [{"sampler": 0, "target": {"node": 0, "path": "translation"}}] * 2000
        scene = gltf(1 << 19, animations=[{"samplers": [{"input": 3, "output": 2}], "channels": channels}])
        self.refused(self.write("a.gltf", scene), "keys")

    def test_images_that_break_off(self):
        self.write("t.png", png(8192, whole=False))
        count = 400
        scene = gltf(images=[{"uri": "./" * i + "t.png"} for i in range(count)], textures=[{"source": i} for i in range(count)],
                     materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(count)])
        self.refused(self.write("a.gltf", scene), "damaged")

    # ---- products that are sums

    def test_one_glowing_image_in_many_materials(self):
        count = 60000
        self.write("t.png", png(2048))
        material = {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}}
        scene = gltf(images=[{"uri": "t.png"}], textures=[{"source": 0}], materials=[material] * count)
        self.loads(self.write("a.gltf", scene), materials=count + 1, textures=1)

    def test_many_images_in_many_materials(self):
        count = 30000
        for i in range(2000):
            self.write("t%d.png" % i, png(8))
        self.write("a.mtl", "".join("newmtl m%d\nmap_Kd T%d.PNG\nmap_Pr t%d.png\n" % (i, i % 2000, 1999 - i % 5)
                                    for i in range(count)))
        info = self.loads(self.write("a.obj", "mtllib a.mtl\n" + SQUARE + "usemtl m0\nf 1 2 3\n"), materials=count,
                          missing_textures=0)
        self.assertGreater(info["textures"], 1990)

    def test_one_library_named_often(self):
        count = 2000
        self.write("a.mtl", "".join("newmtl m%d\nKd .5 .5 .5\n" % i for i in range(count)))
        info = self.loads(self.write("a.obj", "mtllib a.mtl\n" * count + "mtllib ./A.mtl\n" + SQUARE + "usemtl m0\nf 1 2 3\n"),
                          materials=count)
        self.assertEqual(len(info["warnings"]), 1, info["warnings"])  # of the other case of letters

    def test_libraries_that_are_not_there(self):
        for i in range(2000):
            self.write("f%d" % i, "")
        lines = "".join("mtllib %d.mtl\n" % i for i in range(100000))
        self.loads(self.write("a.obj", lines + SQUARE + "f 1 2 3\n"), triangles=1)


if __name__ == "__main__":
    unittest.main()
