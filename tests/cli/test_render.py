"""candil render and its fellows against a real daemon, a private one and Ctrl-C."""
import base64
import json
import os
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

from common import CANDIL, Daemon, environment, run, skip_without_device, write_scene

CAMERA = "0,1,4,0,1,0,0,1,0,40"


def is_png(data):
    return data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND"


class Render(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        cls.scene = write_scene(cls.folder)
        cls.daemon = Daemon(cls.folder)
        cls.daemon.__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.daemon.__exit__(None, None, None)
        cls.temporary.cleanup()

    def candil(self, *arguments, **more):
        return run(CANDIL, "--connect", self.daemon.socket, *arguments, **more)

    def path(self, name):
        return os.path.join(self.folder, name)

    def leftovers(self):
        return [name for name in os.listdir(self.folder) if name.endswith(".tmp")]

    def scenes(self):
        return [s["name"] for s in json.loads(self.candil("scenes", "--json").stdout)["scenes"]]

    def render(self, scene, output, *more):
        return self.candil("render", scene, "-o", output, "--size", "32x24", "--spp", "4", *more)

    def test_the_default_number_of_samples_fits_behind_the_first(self):
        result = self.candil("render", self.scene, "-o", self.path("last.png"), "--size", "4x4", "--first-sample", "16777212",
                             "--error", "1e-9", "--technique", "pt", "--json")
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(json.loads(result.stdout)["samples"], 4)

    def test_loaded_scene_and_its_life(self):
        loaded = self.candil("load", self.scene, "--name", "room", "--json")
        self.assertEqual(loaded.returncode, 0, loaded)
        info = json.loads(loaded.stdout)
        self.assertEqual((info["name"], info["triangles"], info["emissive_triangles"]), ("room", 6, 2))
        self.assertEqual(json.loads(self.candil("describe", "room", "--json").stdout)["hash"], info["hash"])
        self.assertIn("room", self.scenes())
        result = self.render("room", self.path("room.exr"), "--camera", CAMERA, "--json", "--aov", "depth,id", "--seed", "7")
        self.assertEqual(result.returncode, 0, result)
        report = json.loads(result.stdout)
        self.assertEqual((report["width"], report["height"], report["samples"], report["seed"]), (32, 24, 4, 7))
        self.assertEqual(report["bytes"], os.path.getsize(self.path("room.exr")))
        self.assertEqual({e["name"]: e["state"] for e in report["effects"]}["textures"], "absent")
        self.assertEqual(report["camera"]["source"], "given")
        self.assertEqual(self.candil("unload", "room").returncode, 0)
        self.assertEqual(self.candil("unload", "room").returncode, 4)
        self.assertNotIn("room", self.scenes())

    def test_file_is_loaded_for_the_call_only(self):
        before = self.scenes()
        result = self.render(self.scene, self.path("file.png"))
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("simulated", result.stdout)
        self.assertIn("left out", result.stdout)
        self.assertIn("framed", result.stdout)
        self.assertEqual(result.stderr, "")
        with open(self.path("file.png"), "rb") as file:
            self.assertTrue(is_png(file.read()))
        self.assertEqual(self.scenes(), before)

    def test_standard_output(self):
        result = self.candil("render", self.scene, "-o", "-", "--size", "8x8", "--spp", "1", "--json", binary=True)
        self.assertEqual(result.returncode, 0, result)
        self.assertTrue(is_png(result.stdout))
        self.assertEqual(json.loads(result.stderr)["image"], "-")
        result = self.candil("render", self.scene, "-o", "-", "--format", "exr", "--size", "8x8", "--spp", "1", "--quiet",
                             binary=True)
        self.assertEqual(result.stdout[:4], b"\x76\x2f\x31\x01")
        self.assertEqual(result.stderr, "")

    def test_refusals_have_their_codes_and_leave_no_file(self):
        broken = self.path("broken.gltf")
        with open(broken, "w") as file:
            file.write("{ not json")
        for code, arguments in ((4, [broken]), (4, ["no-such-scene"]), (2, [self.scene, "--size", "16384x16384"]),
                                (2, [self.scene, "--set", "pt.depth=0"]), (2, [self.scene, "--set", "pt.magic=1"]),
                                (2, [self.scene, "--camera", "no-such-camera"])):
            result = self.candil("render", *arguments, "-o", self.path("refused.png"), "--json")
            self.assertEqual(result.returncode, code, result)
            self.assertEqual(json.loads(result.stdout)["exit"], code)
            self.assertFalse(os.path.exists(self.path("refused.png")))
        self.assertEqual(self.leftovers(), [])
        self.assertEqual(self.candil("ping").returncode, 0)

    def test_an_old_image_survives_a_failure(self):
        with open(self.path("old.png"), "w") as file:
            file.write("old")
        self.assertEqual(self.render("no-such-scene", self.path("old.png")).returncode, 4)
        with open(self.path("old.png")) as file:
            self.assertEqual(file.read(), "old")

    def test_a_link_to_a_file_stays(self):
        with open(self.path("behind.png"), "w") as file:
            file.write("old")
        os.symlink("behind.png", self.path("link.png"))
        self.assertEqual(self.render(self.scene, self.path("link.png")).returncode, 0)
        self.assertTrue(os.path.islink(self.path("link.png")))
        with open(self.path("behind.png"), "rb") as file:
            self.assertTrue(is_png(file.read()))

    def test_special_files_are_written_not_replaced(self):
        result = self.render(self.scene, "/dev/null", "--format", "png")
        self.assertEqual(result.returncode, 0, result)
        self.assertFalse(os.path.isfile("/dev/null"))
        self.assertEqual(self.render(self.scene, "/dev/full", "--format", "png").returncode, 1)

    def start_endless(self, *more, env=None, output=None):
        output = output or self.path("endless.png")
        process = subprocess.Popen([CANDIL, *more, "render", self.scene, "-o", output, "--size", "64x64", "--spp", "10000000",
                                    "--progressive"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env=env)
        deadline = time.monotonic() + 120
        while not os.path.exists(output):
            self.assertIsNone(process.poll(), "it ended before its first image")
            self.assertLess(time.monotonic(), deadline, "no intermediate image came")
            time.sleep(0.05)
        return process, output

    def test_output_that_goes_away_leaves_nothing_loaded(self):
        before, gone = self.scenes(), self.path("gone")
        os.mkdir(gone)
        process, _ = self.start_endless("--connect", self.daemon.socket, output=os.path.join(gone, "endless.png"))
        shutil.rmtree(gone)
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1, errors)
        self.assertNotIn(b"stays loaded", errors)
        self.assertEqual(self.scenes(), before)

    def interrupted(self, *more, env=None, how=signal.SIGINT):
        process, output = self.start_endless(*more, env=env)
        process.send_signal(how)
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 8, errors)
        with open(output, "rb") as file:
            self.assertTrue(is_png(file.read()), "the last intermediate image is whole")
        os.unlink(output)
        self.assertEqual(self.leftovers(), [])

    def test_interrupt_cancels(self):
        before = json.loads(self.candil("stats", "--json").stdout)["jobs_cancelled"]
        self.interrupted("--connect", self.daemon.socket)
        after = json.loads(self.candil("stats", "--json").stdout)
        self.assertEqual(after["jobs_cancelled"], before + 1)
        self.assertEqual(after["jobs"], 0)
        self.assertEqual(self.scenes(), [])

    def test_a_closed_terminal_cancels(self):
        before = signal.signal(signal.SIGHUP, signal.SIG_DFL)  # one that nohup ignores is inherited, and left alone
        self.addCleanup(signal.signal, signal.SIGHUP, before)
        self.interrupted("--connect", self.daemon.socket, how=signal.SIGHUP)

    def test_what_cannot_be_a_scene_is_named(self):
        result = self.render("no-such.obj", self.path("none.png"))
        self.assertEqual(result.returncode, 4, result)
        self.assertIn("no scene and no file named no-such.obj", result.stderr)
        result = self.render(self.folder, self.path("none.png"))
        self.assertEqual(result.returncode, 4, result)
        self.assertIn("is a folder", result.stderr)

    def test_axis_of_a_loaded_scene(self):
        self.assertEqual(self.candil("scenes").stdout, "no scenes\n")
        self.assertEqual(self.candil("load", self.scene, "--name", "upright", "--up", "z").returncode, 0)
        self.assertEqual(self.render("upright", self.path("none.png"), "--up", "z").returncode, 2)
        self.assertEqual(self.candil("unload", "upright").returncode, 0)

    def test_camera_of_the_scene_is_reported_whole(self):
        corners = struct.pack("<9f", -1, 0, 0, 1, 0, 0, 0, 1, 0)
        with open(self.path("seen.gltf"), "w") as file:
            json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
                       "nodes": [{"mesh": 0}, {"camera": 0, "name": "front", "translation": [0, 0, 5]}],
                       "cameras": [{"name": "front", "type": "perspective",
                                    "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 1}}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                                      "min": [-1, 0, 0], "max": [1, 1, 0]}],
                       "bufferViews": [{"buffer": 0, "byteLength": 36}],
                       "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,"
                                    + base64.b64encode(corners).decode()}]}, file)
        described = json.loads(self.candil("describe", self.path("seen.gltf"), "--json").stdout)["cameras"][0]
        self.assertEqual(described["eye"], [0, 0, 5])
        for more in ([], ["--camera", described["name"]]):
            result = self.render(self.path("seen.gltf"), self.path("seen.png"), "--json", *more)
            self.assertEqual(result.returncode, 0, result)
            self.assertEqual(json.loads(result.stdout)["camera"], dict(described, source="scene"))
        self.assertEqual(self.render(self.path("seen.gltf"), self.path("none.png"), "--unit", "2").returncode, 2)

    def test_described_file_has_its_name(self):
        self.assertRegex(self.candil("describe", self.scene).stdout, r"^scene +room\.obj\n")

    def test_light_that_was_switched_off(self):
        result = self.render(self.scene, self.path("dark.png"), "--effects", "none", "--background", "1,1,1")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("emitters (switched off)", result.stdout)
        self.assertIn("switched off: emitters", result.stdout)
        self.assertNotIn("--background", result.stdout)
        self.assertIn("error      none", result.stdout)

    def test_private_daemon(self):
        with tempfile.TemporaryDirectory() as runtime:
            env = environment(runtime)
            result = run(CANDIL, "render", self.scene, "-o", self.path("private.png"), "--size", "16x16", "--spp", "1",
                         env=env)
            self.assertEqual(result.returncode, 0, result)
            with open(self.path("private.png"), "rb") as file:
                self.assertTrue(is_png(file.read()))
            result = run(CANDIL, "describe", self.scene, "--json", env=env)
            self.assertEqual(json.loads(result.stdout)["triangles"], 6)
            self.interrupted(env=env)
            self.assertEqual(os.listdir(runtime), [], "a private daemon listens nowhere")


if __name__ == "__main__":
    skip_without_device()
    unittest.main()
