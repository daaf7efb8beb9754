"""Scene files that attack the loader: each ends as a clear error, quickly, and the sandbox holds what the kernel has."""
import base64
import json
import os
import resource
import struct
import subprocess
import tempfile
import time
import unittest
import zlib

import bad
import make
from loader import LOADER, describe
from render import CANDIL, Daemon

SANITIZED = os.environ.get("CANDIL_SANITIZE", "0") not in ("0", "")
HANG_SECONDS = 100  # far beyond what any of this takes: a loader that is not done by then is taken to hang


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_of_zeros(side, rows=None):
    """A grey picture of side x side zeros that takes a thousandth of its pixels; `rows` cuts its data short."""
    compressor = zlib.compressobj(9)
    row = bytes(1 + side)
    data = b"".join(compressor.compress(row) for _ in range(side if rows is None else rows)) + compressor.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) + chunk(b"IDAT", data) +
            chunk(b"IEND", b""))


def children_peak_kib():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss


class Loader(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="candil-isolation-")
        self.folder = os.path.join(self.temporary.name, "scene")
        os.mkdir(self.folder)

    def tearDown(self):
        self.temporary.cleanup()

    def load(self, path, **options):
        """(info, None, None) or (None, code, sentence)"""
        done = describe(path, timeout=HANG_SECONDS, **options)
        if done.returncode == 0:
            return json.loads(done.stdout), None, None
        self.assertEqual(done.returncode, 1, done.stderr)
        _, code, sentence = done.stderr.splitlines()[-1].split(": ", 2)
        return None, code, sentence

    def refused(self, path, code, words):
        info, got, sentence = self.load(path)
        self.assertIsNone(info)
        self.assertEqual(got, code, sentence)
        self.assertIn(words, sentence)

    def without_picture(self, path, words):
        """The scene loads, and says what became of its picture."""
        info, _, sentence = self.load(path)
        self.assertIsNotNone(info, sentence)
        self.assertEqual((info["textures"], info["missing_textures"]), (0, 1))
        self.assertIn(words, "\n".join(info["warnings"]))

    def write(self, root, name="scene.gltf"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            json.dump(root, file)
        return path

    def side_file(self, uri, length=264):
        root = dict(bad.boxed().json)
        root["buffers"] = [{"byteLength": length, "uri": uri}]
        return self.write(root)


class Pictures(Loader):
    def test_decompression_bomb(self):
        # 900 million pixels in less than a megabyte: refused by its header.
        bomb = png_of_zeros(30000)
        self.assertLess(len(bomb), 1 << 20)
        self.without_picture(bad.image_uri("bomb.png", bomb)(self.folder), "30000 x 30000")
        self.assertLess(children_peak_kib(), 2 << 20)

    def test_bombs_within_the_side_that_are_too_many_texels(self):
        # Each may be; together they are more than all textures of a scene may have.
        bomb = png_of_zeros(12000)
        for name in ("one.png", "two.png"):
            bad.save(self.folder, name, bomb)

        def edit(root):
            root["images"] = [{"uri": "one.png"}, {"uri": "two.png"}]
            root["textures"] = [{"source": 0}, {"source": 1}]
            root["materials"][0]["normalTexture"] = {"index": 1}
        self.refused(bad.gltf(edit, texture=True)(self.folder), "scene-limit", "texels")

    def test_data_cut_short_fails_without_a_gigabyte_of_texels(self):
        self.without_picture(bad.image_uri("cut.png", png_of_zeros(16384, rows=1))(self.folder), "taken as white")

    def test_header_of_60000_squared(self):
        self.without_picture(bad.image_uri("huge.png", png_of_zeros(60000, rows=1))(self.folder), "60000 x 60000")

    def test_picture_outside(self):
        self.without_picture(bad.image_uri("../../secret.png", None)(self.folder), "leads out of the scene's folder")


class SideFiles(Loader):
    def test_dots_lead_out(self):
        bad.save(self.temporary.name, "secret.bin", bytes(264))
        self.refused(self.side_file("../secret.bin"), "scene-path", "leads out of the scene's folder")

    def test_dots_lead_out_from_below(self):
        bad.save(self.temporary.name, "secret.bin", bytes(264))
        os.mkdir(os.path.join(self.folder, "below"))
        self.refused(self.side_file("below/../../secret.bin"), "scene-path", "leads out of the scene's folder")

    def test_link_leads_out(self):
        bad.save(self.temporary.name, "secret.bin", bytes(264))
        os.symlink("../secret.bin", os.path.join(self.folder, "link.bin"))
        self.refused(self.side_file("link.bin"), "scene-path", "leads out of the scene's folder")

    def test_linked_folder_leads_out(self):
        bad.save(self.temporary.name, "secret.bin", bytes(264))
        os.symlink("..", os.path.join(self.folder, "up"))
        self.refused(self.side_file("up/secret.bin"), "scene-path", "leads out of the scene's folder")

    def test_link_to_dev_zero(self):
        os.symlink("/dev/zero", os.path.join(self.folder, "zero.bin"))
        self.refused(self.side_file("zero.bin"), "scene-path", "leads out of the scene's folder")

    def test_scene_that_is_dev_zero(self):
        os.symlink("/dev/zero", os.path.join(self.folder, "scene.gltf"))
        self.refused(os.path.join(self.folder, "scene.gltf"), "scene-path", "leads out of the scene's folder")

    def test_fifo_does_not_hang(self):
        os.mkfifo(os.path.join(self.folder, "pipe.bin"))
        self.refused(self.side_file("pipe.bin"), "scene-file", "not a regular file")

    def test_scene_that_is_a_fifo_does_not_hang(self):
        os.mkfifo(os.path.join(self.folder, "scene.glb"))
        self.refused(os.path.join(self.folder, "scene.glb"), "scene-file", "not a regular file")

    def test_http(self):
        self.refused(self.side_file("http://127.0.0.1:1/scene.bin"), "scene-file", "http://")

    def test_data_uri_shorter_than_said(self):
        for head in ("data:application/octet-stream;base64,", "data:;base64,", "DATA:x/y;base64,"):
            self.refused(self.side_file(head + base64.b64encode(bytes(100)).decode()), "scene-invalid", "100")

    def test_file_beyond_its_limit(self):
        # Sparse, so that it takes no room here; refused by its size before a byte is read.
        with open(os.path.join(self.folder, "large.bin"), "wb") as file:
            file.truncate((1 << 30) + 1)
        self.refused(self.side_file("large.bin"), "scene-limit", "bytes")

    def test_scene_with_data_uri_beyond_its_limit(self):
        path = os.path.join(self.folder, "scene.gltf")
        with open(path, "wb") as file:
            file.write(b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"data:application/octet-stream;base64,')
            file.truncate((1 << 30) + 1)
        self.refused(path, "scene-limit", "bytes")


class Structure(Loader):
    def test_cycle_of_nodes(self):
        def edit(root):
            root["nodes"] = [{"children": [1]}, {"children": [2]}, {"children": [0], "mesh": 0}]
        self.refused(bad.gltf(edit)(self.folder), "scene-invalid", "cycle")

    def test_20000_deep_nodes(self):
        self.refused(bad.deep_nodes(20000)(self.folder), "scene-limit", "deeper")

    def test_20000_deep_json(self):
        info, code, sentence = self.load(bad.deep_json(20000)(self.folder))
        self.assertIsNone(info)
        self.assertEqual(code, "scene-invalid", sentence)

    def test_accessor_without_data(self):
        root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "accessors": [{"componentType": 5126, "type": "VEC3", "count": 20000000}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}
        path = self.write(root)
        self.assertLess(os.path.getsize(path), 400)
        self.refused(path, "scene-limit", "without a buffer view")

    def test_accessors_without_data_are_counted_together(self):
        root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "accessors": [{"componentType": 5126, "type": "VEC3", "count": 600000}] * 2,
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}]}
        self.refused(self.write(root), "scene-limit", "without a buffer view")

    @unittest.skipIf(SANITIZED, "AddressSanitizer's own address space is beyond any limit")
    def test_memory_limit_is_an_error_and_no_crash(self):
        # 600 MiB: the program starts and has little more, less than the picture's 576 MB of texels.
        path = bad.image_uri("bomb.png", png_of_zeros(12000))(self.folder)
        limit = 600 << 20
        info, code, sentence = self.load(path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        self.assertIsNone(info)
        self.assertEqual(code, "memory", sentence)


class Service(Loader):
    def test_endless_loader_is_ended_and_the_daemon_goes_on(self):
        # What a file that loops for ever comes to in the end, after a fraction of the time: the limit is lowered meanwhile.
        box = make.cornell(self.folder)
        with Daemon() as daemon:
            daemon.candil("load", box, "--name", "box")
            job = subprocess.Popen([CANDIL, "--connect", daemon.socket, "load", make.slow_to_load(self.folder), "--name", "big"],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            deadline = time.monotonic() + HANG_SECONDS
            pid = 0
            while not pid and job.poll() is None and time.monotonic() < deadline:
                pid = daemon.stats()["loader_pid"]
            self.assertTrue(pid)
            resource.prlimit(pid, resource.RLIMIT_CPU, (0, 100))
            _, error = job.communicate(timeout=HANG_SECONDS)
            self.assertEqual(job.returncode, 4, error)
            self.assertIn(b"scene-limit", error)
            self.assertIn(b"processor time", error)
            self.assertGreater(float(daemon.render("box", spp=4).radiance.max()), 0)

    def test_refused_scenes_leave_the_daemon_as_it_was(self):
        box = make.cornell(self.folder)
        bad.save(self.temporary.name, "secret.bin", bytes(264))
        os.mkfifo(os.path.join(self.folder, "pipe.bin"))
        with Daemon() as daemon:
            daemon.candil("load", box, "--name", "box")
            before = daemon.render("box", spp=4).radiance.tobytes()
            for write, code in ((lambda: self.side_file("../secret.bin"), b"scene-path"),
                                (lambda: self.side_file("pipe.bin"), b"scene-file"),
                                (lambda: bad.deep_nodes(20000)(self.folder), b"scene-limit")):
                path = write()
                done = subprocess.run([CANDIL, "--connect", daemon.socket, "load", path, "--name", "bad"], timeout=HANG_SECONDS,
                                      capture_output=True)
                self.assertEqual(done.returncode, 4, done.stderr)
                self.assertIn(code, done.stderr)
            self.assertEqual(daemon.render("box", spp=4).radiance.tobytes(), before)

    def status(self, pid):
        """What the kernel says of a process; {}: it has ended."""
        try:
            with open(f"/proc/{pid}/status", encoding="ascii") as file:
                return dict(line.rstrip("\n").split(":\t", 1) for line in file if ":\t" in line)
        except OSError:
            return {}

    def test_all_are_confined_in_service(self):
        # Not what they report but what the kernel says of the very processes that serve.
        path = make.slow_to_load(self.folder)
        seen = {}
        with Daemon() as daemon:
            job = subprocess.Popen([CANDIL, "--connect", daemon.socket, "load", path, "--name", "big"],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            while job.poll() is None:
                stats = daemon.stats()
                for name, pid in (("front", daemon.process.pid), ("worker", stats["worker_pid"]), ("loader", stats["loader_pid"])):
                    seen[name] = pid and self.status(pid) or seen.get(name)
            self.assertEqual(job.wait(), 0, job.stderr.read())
            job.stderr.close()
            told = json.loads(daemon.candil("doctor", "--json")[1])["daemon"]["processes"]
        layers = {layer["name"]: layer for layer in report()["layers"]}
        for name in ("front", "worker", "loader"):
            with self.subTest(process=name):
                self.assertEqual(seen[name]["NoNewPrivs"], "1")
                self.assertEqual([int(seen[name][which], 16) for which in ("CapEff", "CapPrm", "CapInh", "CapAmb")], [0, 0, 0, 0])
                if layers["seccomp"]["holds"]:
                    self.assertEqual(seen[name]["Seccomp"], "2")
        self.assertEqual(told, [{"name": name, "no_new_privileges": True, "no_capabilities": True, "seccomp": layers["seccomp"]["holds"]}
                                for name in ("candild", "candil-worker")])


def report():
    return json.loads(subprocess.run([LOADER, "--sandbox-report"], check=True, capture_output=True, timeout=HANG_SECONDS).stdout)


class Report(unittest.TestCase):
    def test_layers(self):
        layers = report()["layers"]
        self.assertEqual([layer["name"] for layer in layers], ["limits", "privileges", "landlock", "seccomp"])
        self.assertTrue(layers[0]["holds"] and layers[1]["holds"], layers)
        for layer in layers:
            self.assertTrue(layer["detail"])
            if not layer["holds"]:
                print("this kernel lacks", layer["name"] + ":", layer["detail"])

    def test_one_thread_enters(self):
        # Landlock leaves threads alone that were there before.
        self.assertEqual(report()["threads"], 1)

    def test_doctor_tells(self):
        done = subprocess.run([CANDIL, "doctor", "--json"], capture_output=True, timeout=HANG_SECONDS)
        told = json.loads(done.stdout)
        self.assertEqual(told["sandbox"], report())
        fence = told["worker"]["fence"]
        self.assertEqual([layer["name"] for layer in fence["layers"]], ["privileges", "landlock", "seccomp"])
        self.assertEqual(fence["threads"], 1)
        self.assertEqual([layer["holds"] for layer in fence["layers"]], [layer["holds"] for layer in report()["layers"][1:]])
        text = subprocess.run([CANDIL, "doctor"], capture_output=True, timeout=HANG_SECONDS, text=True).stdout
        self.assertEqual((text.count("  sandbox  candil-loader, "), text.count("  sandbox  candil-worker, ")), (4, 3))

    def test_shaders_have_a_folder_of_their_own(self):
        with tempfile.TemporaryDirectory() as home:
            environment = {key: value for key, value in os.environ.items() if key not in ("MESA_SHADER_CACHE_DIR", "XDG_CACHE_HOME")}
            done = subprocess.run([CANDIL, "doctor", "--json"], capture_output=True, timeout=HANG_SECONDS, env=dict(environment, HOME=home))
            self.assertEqual(json.loads(done.stdout)["shader_cache"], {"path": os.path.join(home, ".cache", "candil"), "writable": True})
            self.assertTrue(os.path.isdir(os.path.join(home, ".cache", "candil")))
            # A path need not be UTF-8, and a doctor's answer must.
            wild = os.fsencode(home) + b"/\xff"
            done = subprocess.run([CANDIL, "doctor", "--json"], capture_output=True, timeout=HANG_SECONDS,
                                  env=dict(os.environb) | {b"MESA_SHADER_CACHE_DIR": wild})
            self.assertEqual(json.loads(done.stdout)["shader_cache"], {"path": os.path.join(home, "?"), "writable": True})


if __name__ == "__main__":
    unittest.main()
