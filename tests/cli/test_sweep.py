"""candil sweep against a real daemon: the same bits as single renders, what is there is left alone unless another scene or
request made it, shards share; and the edits that sweep and render take."""
import json
import os
import unittest
import zlib

import numpy

import images
import make
from common import CANDIL, DaemonCase, run, skip_without_device, write_scene

SIZE = ("--size", "32x24", "--spp", "4")


class Sweep(DaemonCase):
    def path(self, name):
        return os.path.join(self.folder, name)

    def candil(self, *arguments):
        return run(CANDIL, "--connect", self.daemon.socket, *arguments)

    def sweep(self, output, *more, status=0):
        result = self.candil("sweep", self.scene, "-o", self.path(output), *SIZE, "--json", *more)
        self.assertEqual(result.returncode, status, result)
        return json.loads(result.stdout) if result.stdout else None

    def states(self, summary):
        return [image["state"] for image in summary["images"]]

    def test_orbit_is_six_renders(self):
        summary = self.sweep("o.{index}.exr", "--orbit", "6,30", "--aov", "depth,id")
        self.assertEqual((summary["written"], summary["skipped"], len(summary["images"])), (6, 0, 6))
        self.assertEqual(sorted(os.listdir(self.folder)), [f"o.{i}.exr" for i in range(6)])
        seen = []
        for image in summary["images"]:
            c = image["camera"]
            camera = ",".join(repr(float(x)) for x in c["eye"] + c["target"] + c["up"] + [c["vfov_degrees"]])
            single = self.path("single.exr")
            result = self.candil("render", self.scene, "-o", single, *SIZE, "--aov", "depth,id", "--camera", camera)
            self.assertEqual(result.returncode, 0, result)
            ours, theirs = images.channels(image["image"]), images.channels(single)
            self.assertEqual(set(ours), set(theirs))
            for name in ours:
                self.assertEqual(ours[name].tobytes(), theirs[name].tobytes(), (image["index"], name))
            seen.append(ours["R"])
            hit = numpy.isfinite(ours["Z"])
            self.assertTrue(hit.any(), "the scene is in view")
            for edge in (hit[0], hit[-1], hit[:, 0], hit[:, -1]):
                self.assertFalse(edge.any(), "the whole scene is in view")
        for other in seen[1:]:
            self.assertFalse(numpy.array_equal(seen[0], other))

    def damage(self, path, size):
        """Each way to spoil a file that must be found; the file is whole again after each."""
        with open(path, "rb") as file:
            whole = file.read()
        for spoilt in (whole[:-1], whole[:size // 2], whole[:10], b"", whole + b"x", b"x" + whole[1:]):
            with open(path, "wb") as file:
                file.write(spoilt)
            yield
            with open(path, "rb") as file:
                self.assertEqual(len(file.read()) > 100, True)

    def test_what_is_there_is_left_alone(self):
        for extension in ("exr", "png"):
            name = "s{index}." + extension
            first = self.sweep(name, "--orbit", "3")
            before = [os.stat(image["image"]).st_mtime_ns for image in first["images"]]
            second = self.sweep(name, "--orbit", "3")
            self.assertEqual(self.states(second), ["skipped"] * 3)
            self.assertEqual(before, [os.stat(image["image"]).st_mtime_ns for image in second["images"]])
            os.remove(self.path("s1." + extension))
            self.assertEqual(self.states(self.sweep(name, "--orbit", "3")), ["skipped", "written", "skipped"])
            self.assertEqual(self.states(self.sweep(name, "--orbit", "3", "--force")), ["written"] * 3)
            for _ in self.damage(self.path("s2." + extension), os.path.getsize(self.path("s2." + extension))):
                self.assertEqual(self.states(self.sweep(name, "--orbit", "3")), ["skipped", "skipped", "written"])
            self.assertEqual(self.states(self.sweep(name, "--orbit", "3", "--size", "16x8")), ["written"] * 3)

    def test_zeroed_entry_of_the_offset_table(self):
        self.sweep("z{index}.exr", "--orbit", "1")
        path = self.path("z0.exr")
        with open(path, "rb") as file:
            data = bytearray(file.read())
        # The table begins behind the header; its first entry says where the first block is, right behind the table.
        at = next(i for i in range(100, len(data) - 8)
                  if i < int.from_bytes(data[i:i + 8], "little") <= i + 8 * 24 and data[i - 1] == 0)
        data[at:at + 8] = bytes(8)
        with open(path, "wb") as file:
            file.write(data)
        self.assertEqual(self.states(self.sweep("z{index}.exr", "--orbit", "1")), ["written"])

    def test_every_compression_is_understood(self):
        import OpenImageIO as oiio
        self.sweep("c{index}.exr", "--orbit", "1", "--half")
        said = images.metadata(self.path("c0.exr"))
        for compression in ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"):
            spec = oiio.ImageSpec(32, 24, 3, "half")
            spec.attribute("compression", compression)
            for key in said:
                if key.startswith("candil/"):
                    spec.attribute(key, said[key])
            out = oiio.ImageOutput.create(self.path("c0.exr"))
            self.assertTrue(out.open(self.path("c0.exr"), spec), compression)
            self.assertTrue(out.write_image(numpy.random.default_rng(1).random((24, 32, 3)).astype(numpy.float32)))
            out.close()
            self.assertEqual(self.states(self.sweep("c{index}.exr", "--orbit", "1", "--half")), ["skipped"], compression)

    def redone(self, name, *arguments):
        """Why each of two pictures is made anew, if both are, and neither a second time."""
        summary, again = self.sweep(name, *arguments), self.sweep(name, *arguments)
        self.assertEqual((summary["written"], summary["skipped"], summary["redone"]), (2, 0, 2), arguments)
        self.assertEqual((again["written"], again["skipped"], again["redone"]), (0, 2, 0), arguments)
        self.assertNotIn("why", again["images"][0])
        return {image["why"] for image in summary["images"]}

    def test_what_another_request_made_is_made_anew(self):
        orbit = ("--orbit", "2")
        self.sweep("d{index}.exr", *orbit)
        made = {}
        for name in ("d0.exr", "d1.exr"):
            with open(self.path(name), "rb") as file:
                made[name] = file.read()
        for why, arguments in (("camera", ["--orbit", "2,21"]), ("technique", [*orbit, "--technique", "direct"]),
                               ("samples", [*orbit, "--spp", "5"]), ("options", [*orbit, "--set", "pt.depth=3"]),
                               ("seed", [*orbit, "--seed", "7"]), ("first_sample", [*orbit, "--first-sample", "4"]),
                               ("format", [*orbit, "--half"]), ("aovs", [*orbit, "--aov", "depth"]),
                               ("filter", [*orbit, "--filter", "gauss"]), ("lens", [*orbit, "--lens", "0.1,3"]),
                               ("lens", [*orbit, "--orthographic", "3"]), ("background", [*orbit, "--background", "1,1,1"]),
                               ("default_light", [*orbit, "--no-default-light"]),
                               ("effects", [*orbit, "--effects", "auto,-bounces"]), ("end", [*orbit, "--error", "1e9"]),
                               ("edits", [*orbit, "--light", "point:at=0,1,0,intensity=1"])):
            for name in made:
                with open(self.path(name), "wb") as file:
                    file.write(made[name])
            self.assertEqual(self.redone("d{index}.exr", *arguments), {why}, arguments)
        lit = [*orbit, "--light", "point:at=0,1,0,intensity=1.5", "--set", "pt.depth=3"]
        self.assertEqual(self.redone("d{index}.exr", *lit), {"options"})
        self.assertEqual(self.redone("d{index}.exr", *lit, "--set", "pt.roulette=off"), {"options"})
        self.sweep("d{index}.png", *orbit, "--view", "filmic")
        self.assertEqual(self.redone("d{index}.png", *orbit, "--view", "filmic", "--exposure", ".1"), {"view"})

    def test_what_another_scene_made_is_made_anew(self):
        self.addCleanup(setattr, self, "scene", self.scene)
        self.scene = write_scene(self.folder)
        self.sweep("e{index}.exr", "--orbit", "2", "--background", "1,0,0")
        with open(self.path("room.mtl"), "a") as file:
            file.write("Ke 4 4 4\n")
        summary = self.sweep("e{index}.exr", "--orbit", "2", "--background", "1,0,0")
        self.assertEqual([image["why"] for image in summary["images"]], ["scene"] * 2)
        for i, colour in enumerate(((1, 0, 0), (0, 1, 0))):
            images.write(self.path(f"around{i}.exr"), numpy.full((4, 8, 3), colour, numpy.float32))
        around = ["--orbit", "2", "--background", self.path("around0.exr")]
        self.sweep("f{index}.exr", *around)
        self.assertEqual(self.redone("f{index}.exr", *around, "--background-turn", "10"), {"background"})
        self.assertEqual(self.redone("f{index}.exr", "--orbit", "2", "--background", self.path("around1.exr")), {"background's picture"})
        self.assertEqual(self.redone("f{index}.exr", "--orbit", "2"), {"background's picture"})

    def test_what_another_program_made_is_made_anew(self):
        images.write(self.path("g0.exr"), numpy.zeros((24, 32, 3), numpy.float32))
        with open(self.path("g1.exr"), "wb") as file:
            file.write(b"no picture")
        result = self.candil("sweep", self.scene, "-o", self.path("g{index}.exr"), *SIZE, "--orbit", "3")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("3 of 3 cameras: 3 written, 0 there already", result.stdout)
        self.assertIn("redone     2 that were there and differed: no metadata 1, size, or not whole 1\n", result.stdout)

    def test_odd_metadata_is_passed_over(self):
        self.sweep("h{index}.png", "--orbit", "1")
        with open(self.path("h0.png"), "rb") as file:
            whole = file.read()
        at = whole.index(b"tEXt") - 4

        def text(body):
            return len(body).to_bytes(4, "big") + b"tEXt" + body + zlib.crc32(b"tEXt" + body).to_bytes(4, "big")

        for body, count, state in ((b"candil/request/seed\0" + b"1" * 5000, 1, "skipped"), (b"candil/" + b"k" * 90 + b"\0x", 1, "skipped"),
                                   (b"candil/no zero", 1, "skipped"), (b"", 1, "skipped"), (b"candil/empty\0", 1, "skipped"),
                                   (b"another/key\0x", 500, "skipped"), (b"candil/junk\0x", 500, "written"),
                                   (b"candil/request/seed\0" + b"1", 1, "written")):
            with open(self.path("h0.png"), "wb") as file:
                file.write(whole[:at] + text(body) * count + whole[at:])
            self.assertEqual(self.states(self.sweep("h{index}.png", "--orbit", "1")), [state], (body[:30], count))
        with open(self.path("h0.png"), "wb") as file:
            file.write(whole[:at] + (1 << 31).to_bytes(4, "big") + b"tEXt" + whole[at:])
        self.assertEqual(self.states(self.sweep("h{index}.png", "--orbit", "1")), ["written"])

    def test_what_is_there_is_compared_with_what_the_daemon_has(self):
        self.sweep("n{index}.png", "--orbit", "2")
        result = run(CANDIL, "--connect", "/nowhere", "sweep", self.scene, "-o", self.path("n{index}.png"), *SIZE, "--orbit", "2")
        self.assertEqual(result.returncode, 3, result)

    def test_metadata_tells_version_camera_and_request(self):
        with open(self.path("cameras.json"), "w") as file:
            json.dump([[0, 1, 4, 0, 1, 0, 0, 1, 0, 40]], file)
        for extension in ("exr", "png"):
            self.sweep("m{index}." + extension, "--cameras", self.path("cameras.json"), "--set", "pt.depth=4", "--set", "pt.sampler=blue")
            said = images.metadata(self.path("m0." + extension))
            self.assertRegex(said["candil/version"], r"^\d+\.\d+\.\d+$")
            self.assertEqual(said["candil/camera_eye"], "0,1,4")
            self.assertEqual(said["candil/camera_forward"], "0,0,-1")
            self.assertEqual(said["candil/camera_up"], "0,1,0")
            self.assertEqual(said["candil/camera_projection"], "perspective 40")
            self.assertEqual(said["candil/request/camera"], "0,1,4,0,1,0,0,1,0,40")
            self.assertEqual(said["candil/request/options"], "pt.depth=4,pt.sampler=blue")
            self.assertEqual(said["candil/request/samples"], "4")
        self.sweep("p{index}.exr", "--cameras", self.path("cameras.json"), "--orthographic", "2", "--lens", "0.1,3")
        said = images.metadata(self.path("p0.exr"))
        self.assertEqual(said["candil/camera_projection"], "orthographic 2")
        self.assertEqual(said["candil/camera_lens"], "0.1,3")

    def test_shards_cover_each_once(self):
        seen = []
        for shard in (1, 2, 3):
            summary = self.sweep("p{index}.png", "--orbit", "11", "--shard", f"{shard}/3")
            self.assertEqual(summary["skipped"], 0)
            seen += [image["index"] for image in summary["images"]]
        self.assertEqual(sorted(seen), list(range(11)))
        self.assertEqual(sorted(os.listdir(self.folder)), [f"p{i:02}.png" for i in range(11)])

    def test_more_than_one_request(self):
        summary = self.sweep("m{index}.png", "--orbit", "300", "--size", "4x4", "--spp", "1")
        self.assertEqual((summary["written"], len(os.listdir(self.folder))), (300, 300))

    def cameras(self, text):
        with open(self.path("cameras.json"), "w") as file:
            file.write(text)
        return "--cameras", self.path("cameras.json")

    def test_camera_files(self):
        ten = [0, 1, 4, 0, 1, 0, 0, 1, 0, 40]
        thing = {"eye": ten[:3], "target": ten[3:6], "vfov": 40}
        for i, text in enumerate((json.dumps([ten, thing]), json.dumps(ten) + "\n" + json.dumps(thing) + "\n")):
            summary = self.sweep(f"f{i}." + "{index}.exr", *self.cameras(text))
            a, b = (images.channels(image["image"]) for image in summary["images"])
            self.assertEqual(a["R"].tobytes(), b["R"].tobytes())
            self.assertTrue(a["R"].any())

    def moving(self):
        self.addCleanup(setattr, self, "scene", self.scene)
        self.scene = make.stage(self.folder)

    def same(self, image, *arguments):
        single = self.path("single.exr")
        result = self.candil("render", self.scene, "-o", single, *SIZE, *arguments)
        self.assertEqual(result.returncode, 0, result)
        ours, theirs = images.channels(image["image"]), images.channels(single)
        self.assertEqual([c.tobytes() for c in ours.values()], [c.tobytes() for c in theirs.values()])
        return ours["R"]

    def test_an_animation_is_renders_at_its_times(self):
        self.moving()
        summary = self.sweep("a{index}.exr", "--animation", "play", "--frames", "3")
        self.assertEqual([image["time_s"] for image in summary["images"]], [0, 1, 2])
        seen = [self.same(i, "--animation", "play", "--at", str(i["time_s"])) for i in summary["images"]]
        self.assertFalse(numpy.array_equal(seen[0], seen[1]) or numpy.array_equal(seen[1], seen[2]))
        summary = self.sweep("b{index}.exr", "--animation", "#0", "--fps", "1.5", "--camera", "camera")
        self.assertEqual([image["time_s"] for image in summary["images"]], [0, 1 / 1.5, 2 / 1.5, 2])
        self.same(summary["images"][1], "--animation", "play", "--at", repr(1 / 1.5))
        summary = self.sweep("c{index}.exr", "--animation", "play", "--orbit", "2", "--node", "block:scale=2")
        self.assertEqual([image["time_s"] for image in summary["images"]], [0, 2])
        self.assertEqual(self.sweep("b{index}.exr", "--animation", "#0", "--fps", "1.5", "--camera", "camera")["skipped"], 4)
        same_times = ["--animation", "#0", "--frames", "4", "--camera", "camera"]
        self.assertEqual(self.sweep("b{index}.exr", *same_times)["skipped"], 4)
        summary = self.sweep("b{index}.exr", *same_times, "--node", "block:scale=3")
        self.assertEqual([image.get("why") for image in summary["images"]], ["edits"] * 4)

    def test_keys_are_met_and_the_way_between_is_smooth(self):
        with open(self.path("keys.json"), "w") as file:
            json.dump([[0, 1, 5, 0, 0, 0, 0, 1, 0, 40], [3, 1, 4, 0, 1, 0, 0, 1, 0, 20], [5, 1, 0, 0, 0, 0, 0, 1, 0, 40]], file)
        summary = self.sweep("k{index}.exr", "--keys", self.path("keys.json"), "--frames", "9")
        cameras = [image["camera"] for image in summary["images"]]
        self.assertEqual([c["eye"] for c in cameras[::4]], [[0, 1, 5], [3, 1, 4], [5, 1, 0]])
        self.assertEqual([c["vfov_degrees"] for c in cameras[::4]], [40, 20, 40])
        x = numpy.array([c["eye"][0] for c in cameras])
        self.assertTrue((numpy.diff(x) > 0).all(), x)
        self.assertLess(numpy.abs(numpy.diff(x, 2)).max(), .5 * numpy.diff(x).max())

    def test_edits_on_the_command_line(self):
        self.moving()
        plain, edited = self.path("plain.exr"), self.path("edited.exr")
        for path, more in ((plain, []), (edited, [
                "--light", "spot:at=0,4,0,to=0,0,0,cone=10,40,intensity=30", "--light", "point:at=1,1,1,intensity=1,2,3",
                "--light", "directional:direction=0,-1,-1,intensity=.5", "--replace-lights", "--material",
                "block:color=.8,.1,.1,metallic=1,roughness=.3", "--node", "arm:rotate=0,1,0,30,translate=0,1,0,scale=2"])):
            result = self.candil("render", self.scene, "-o", path, *SIZE, "--json", *more)
            self.assertEqual(result.returncode, 0, result)
        self.assertIn("glossy", [e["name"] for e in json.loads(result.stdout)["effects"] if e["state"] == "simulated"])
        self.assertFalse(numpy.array_equal(images.rgb(plain), images.rgb(edited)))
        for wrong in (["--light", "lamp:at=0,0,0,intensity=1"], ["--light", "point:intensity=1"], ["--light", "point:at=0,0,0"],
                      ["--light", "spot:at=0,0,0,to=1,1,1,intensity=1"], ["--light", "point:at=0,nan,0,intensity=1"],
                      ["--light", "directional:to=1,1,1,intensity=1"], ["--material", "block"], ["--material", ":metallic=1"],
                      ["--material", "block:shine=1"], ["--node", "arm:rotate=0,0,0,30"], ["--node", "arm:translate=1,2"],
                      ["--node", "arm:scale=1,2,3,4,5"], ["--at", "x"], ["--light", "point:at=0,0,0,intensity=1"] * 33):
            result = self.candil("render", self.scene, "-o", self.path("x.exr"), *SIZE, *wrong)
            self.assertEqual(result.returncode, 2, wrong)
        for wrong in (["--node", "leg:scale=2"], ["--material", "gold:metallic=1"], ["--animation", "dance"]):
            result = self.candil("render", self.scene, "-o", self.path("x.exr"), *SIZE, *wrong)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("candil describe", result.stderr)

    def test_describe_lists_what_edits_may_name(self):
        self.moving()
        told = json.loads(self.candil("describe", self.scene, "--json").stdout)
        self.assertEqual(told["nodes"], ["floor", "arm", "block", "lamp", "bulb", "rig", "camera"])
        self.assertEqual(told["material_names"], ["floor", "block", "lamp"])
        self.assertEqual(told["animations"], [{"name": "play", "duration_s": 2.0}])
        text = self.candil("describe", self.scene).stdout
        for words in ("nodes       floor, arm, block", "materials   floor", "animation   play: 2 s"):
            self.assertIn(words, text)

    def test_refused(self):
        for text in ("", "[]", "[1,2]", "{}", '{"eye":[1,2,3],"target":[0,0,0]}', "[[1,2,3,4,5,6,7,8,9,\"x\"]]", "nonsense",
                     "[0,1,4,0,1,0,0,1,0,40] nonsense", "[0,1,4,0,1,0,0,1,0,400]"):
            self.sweep("r{index}.exr", *self.cameras(text), status=2)
        for wrong in (["--orbit", "0"], ["--orbit", "2,90"], ["--orbit", "2,1,0"], ["--orbit", "x"], [],
                      ["--orbit", "2", "--shard", "0/2"], ["--orbit", "2", "--shard", "3/2"], ["--frames", "3"],
                      ["--orbit", "2", "--frames", "3"], ["--orbit", "2", "--camera", "camera"], ["--fps", "3"],
                      ["--animation", "play", "--frames", "2", "--fps", "2"], ["--animation", "play", "--frames", "0"],
                      ["--animation", "play", "--fps", "0"], ["--keys", "x.json"], ["--animation", "play", "--at", "1"]):
            self.sweep("r{index}.exr", *wrong, status=2)
        self.sweep("r.exr", "--orbit", "2", status=2)
        for name in ("r{index}.{camera}.exr", "{frame}/r{index}.exr", "r{}{index}.exr", "r{index }{index}.exr"):
            self.sweep(name, "--orbit", "2", status=2)
        self.sweep("nowhere/{index}.exr", "--orbit", "2", status=1)
        self.assertEqual([name for name in os.listdir(self.folder) if name != "cameras.json"], [])


if __name__ == "__main__":
    skip_without_device()
    unittest.main()
