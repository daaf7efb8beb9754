"""The verdict on a picture: its shares against pictures that are known pixel by pixel and against the files themselves; and its
sentences, where a picture is a mistake and only there."""
import json
import os
import unittest

import numpy

import images
import make
import wire
from render import Daemon
from wire import pb
from writers import Gltf, box, icosphere, quad

daemon = Daemon()
TECHNIQUES = ("pt", "direct", "vct", "radiosity")
SIDE = 16
FRONT = (0, 0, 5, 0, 0, 0, 0, 1, 0, 40)


def setUpModule():
    unittest.enterModuleContext(daemon)


def board(radiance, albedo=0.0, name="board.gltf"):
    """Seen by parallel rays two metres high: the left half glows, of the right half the upper one is a surface without light,
    and nothing is in the lower."""
    g = Gltf()
    g.place(*quad((-1, -1, 0), (0, -1, 0), (0, 1, 0), (-1, 1, 0)), g.material("glows", (0, 0, 0), (radiance,) * 3))
    g.place(*quad((0, 0, -1), (1, 0, -1), (1, 1, -1), (0, 1, -1)), g.material("sign", (albedo,) * 3, unlit=True))
    return g.save(daemon.folder, name)


def judged(scene, *arguments, camera=FRONT, spp=4, size=SIDE, kind="exr", technique="pt"):
    """(verdict, verdict's notes, path)"""
    path = os.path.join(daemon.folder, "judged." + kind)
    _, out, _ = daemon.candil("render", scene, "-o", path, "--json", "--size", f"{size}x{size}", "--spp", str(spp), "--technique",
                              technique, "--camera", ",".join(map(str, camera)), *arguments)
    report = json.loads(out)
    return report["verdict"], of_verdict(report["notes"]), path


def of_verdict(notes):
    """Without what the techniques tell."""
    return [note for note in notes if not note.startswith(("light may leak", "no sample has found light", "one sample cannot"))]


class Shares(unittest.TestCase):
    def check(self, black, clipped, missed, *arguments, techniques=("direct",), **more):
        for technique in techniques:
            got, _, _ = judged(*arguments, "--orthographic", "2", technique=technique, **more)
            self.assertEqual((got["black"], got["clipped"], got["missed"]), (black, clipped, missed), technique)

    def test_a_board(self):
        self.check(.5, 0, .25, board(3), techniques=TECHNIQUES)
        self.check(.25, 0, .25, board(3, .5), techniques=TECHNIQUES)
        self.check(.5, .5, .25, board(3), kind="png")

    def test_the_exposure_counts(self):
        self.check(.5, 0, .25, board(3), "--exposure", "-2", kind="png")
        self.check(1, 0, .25, board(3), "--exposure", "-20", kind="png")
        self.check(.5, .5, .25, board(.1), "--exposure", "4", kind="png")

    def test_white_is_clipped_and_what_is_less_is_not(self):
        self.check(.5, .5, .25, board(1), kind="png")
        self.check(.5, 0, .25, board(.999), kind="png")

    def test_halves(self):
        self.check(.5, .5, .25, board(65600), "--half")
        self.check(.5, 0, .25, board(65504), "--half")
        self.check(.5, 0, .25, board(1e9), "--float")
        self.check(1, 0, .25, board(2.0 ** -26), "--half")
        self.check(.5, 0, .25, board(2.0 ** -24), "--half")

    def test_a_background_is_missed_but_not_black(self):
        self.check(.25, 0, .25, board(3), "--background", "0,.1,0", techniques=TECHNIQUES)

    def test_a_pixel_is_missed_if_all_its_samples_are(self):
        """Against the picture itself: black surfaces before a white background, of which only a missed pixel has all."""
        g = Gltf()
        g.place(*icosphere(2), g.material("coal", (0, 0, 0), unlit=True))
        scene = g.save(daemon.folder, "coal.gltf")
        for technique in TECHNIQUES:
            for spp, filter_of in ((1, ()), (16, ()), (16, ("--filter", "gauss"))):
                if filter_of and technique != "pt":
                    continue
                verdict, _, path = judged(scene, "--background", "1,1,1", *filter_of, spp=spp, size=33, technique=technique)
                rgb = images.rgb(path)
                self.assertEqual(verdict["missed"], (rgb == 1).all(axis=2).mean(), (technique, spp))
                self.assertEqual(verdict["black"], (rgb == 0).all(axis=2).mean(), (technique, spp))
                self.assertGreater(verdict["missed"], 0)

    def test_bands_and_slices_do_not_count_twice(self):
        scene = board(3)
        for option in ("direct.rows=8", "pt.batch=1", "pt.segment=1"):
            technique = option.split(".")[0]
            got, _, _ = judged(scene, "--orthographic", "2", "--set", option, technique=technique, size=40)
            self.assertEqual(got, {"black": .5, "clipped": 0, "missed": .25}, option)

    def test_pngs_as_their_files_have_it(self):
        scene = make.cornell(daemon.folder)
        camera = (0, 1, 3.9, 0, 1, 0, 0, 1, 0, 39)
        for view in ("none", "reinhard", "filmic"):
            for exposure in (-10, 3):
                got, _, path = judged(scene, "--view", view, "--exposure", str(exposure), camera=camera, kind="png", size=48)
                codes = numpy.round(images.rgb(path) * 255)
                self.assertEqual(got["black"], (codes == 0).all(axis=2).mean(), (view, exposure))
                # A code of 255 is from 254.5 on, 1 is a little more.
                self.assertLessEqual(got["clipped"], (codes == 255).any(axis=2).mean(), (view, exposure))
                self.assertGreaterEqual(got["clipped"], .8 * (codes == 255).any(axis=2).mean(), (view, exposure))
                self.assertTrue(exposure < 0 or got["clipped"] > {"none": .1, "reinhard": -1, "filmic": .005}[view], got)


def closed_room():
    g = Gltf()
    g.place(*box((-1, -1, -1), (1, 1, 1), inward=True), g.material("wall", (.7,) * 3))
    g.place(*quad((-.3, .9, -.3), (.3, .9, -.3), (.3, .9, .3), (-.3, .9, .3)), g.material("lamp", (0, 0, 0), (5,) * 3))
    g.place(*box((-.9, -.9, -.9), (-.5, -.5, -.5)), g.material("body", (.5,) * 3))
    return g.save(daemon.folder, "closed.gltf")


class Sentences(unittest.TestCase):
    def says(self, words, *arguments, **more):
        _, notes, _ = judged(*arguments, **more)
        self.assertEqual(len(notes), 1, notes)
        self.assertIn(words, notes[0])
        return notes[0]

    def test_beside_the_scene(self):
        for technique in TECHNIQUES:
            self.says("looks at no surface", board(3), camera=(0, 0, 5, 0, 0, 9, 0, 1, 0, 40), technique=technique)

    def test_outside_of_the_room_and_inside_of_a_body(self):
        room = closed_room()
        for technique in ("pt", "direct"):
            self.says("outside of the scene", room, technique=technique)
            self.says("inside of a body", room, camera=(-.7, -.7, -.7, 0, 0, 0, 0, 1, 0, 60), technique=technique)
            self.assertEqual(judged(room, camera=(0, 0, .9, 0, 0, 0, 0, 1, 0, 60), technique=technique, spp=16)[1], [])

    def test_without_light(self):
        scene = make.unlit(daemon.folder)
        camera = (0, 1, 5, 0, 0, 0, 0, 1, 0, 40)
        self.says("nothing gives light: add a light", scene, "--no-default-light", camera=camera)
        self.says("neutral sky", scene, camera=camera)
        self.says("switched off: emitters", make.cornell(daemon.folder), "--effects", "auto,-emitters", camera=(0, 1, 3, 0, 1, 0, 0, 1, 0, 40))
        self.says("takes no light from a background: add a light, or take pt, vct or radiosity", scene, "--background", "1,1,1", camera=camera, technique="direct", spp=1)

    def test_exposure(self):
        """The advice holds: the same picture at the exposure that it names needs none, and is neither black nor clipped."""
        for radiance, exposure, words in ((1e3, 0, "brighter than white"), (4, 3, "brighter than white"), (1e-5, 0, "too dark"),
                                          (1, -30, "too dark")):
            g = Gltf()
            g.place(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("glows", (0, 0, 0), (radiance,) * 3))
            scene = g.save(daemon.folder, "glows.gltf")
            for view in ("none", "filmic"):
                more = ("--orthographic", "2", "--view", view, "--exposure")
                note = self.says(words, scene, *more, str(exposure), kind="png")
                advised = note.split("exposure ")[1].split()[0]
                verdict, notes, _ = judged(scene, *more, advised, kind="png")
                self.assertEqual(notes, [], (radiance, view))
                self.assertEqual((verdict["black"], verdict["clipped"]), (0, 0))

    def test_a_small_thing_counts_by_what_it_is(self):
        """Most of the picture misses: the advice is for the rest, and holds."""
        g = Gltf()
        g.place(*quad((-.2, -.2, 0), (.2, -.2, 0), (.2, .2, 0), (-.2, .2, 0)), g.material("dim", (0, 0, 0), (1e-8,) * 3))
        scene = g.save(daemon.folder, "dim.gltf")
        note = self.says("too dark to be seen at this exposure", scene, kind="png", size=48)
        advised = note.split("exposure ")[1].split()[0]
        self.assertAlmostEqual(float(advised), -numpy.log2(1e-8), delta=.3)
        self.assertEqual(judged(scene, "--exposure", advised, kind="png", size=48)[1], [])
        self.says("too dark for 16 bits: take 32 bits", scene, "--half")
        self.assertEqual(judged(scene, "--float")[1], [])
        self.says("too dark for every exposure", board(1e-30), "--orthographic", "2", kind="png")
        # What is black in a background is none of the scene's.
        rgb = numpy.zeros((8, 16, 3), numpy.float32)
        rgb[0, 0] = 1
        sky = os.path.join(daemon.folder, "spark.exr")
        images.write(sky, rgb)
        self.assertEqual(judged(self.small_sign(), "--background", sky, kind="png")[1], [])

    @staticmethod
    def small_sign():
        g = Gltf()
        g.place(*quad((-.2, -.2, 0), (.2, -.2, 0), (.2, .2, 0), (-.2, .2, 0)), g.material("sign", (.5,) * 3, unlit=True))
        return g.save(daemon.folder, "small.gltf")

    def test_a_silhouette_is_no_mistake(self):
        """A black thing before a background that is seen; filling the picture, it may be what reflects none."""
        g = Gltf()
        g.place(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("soot", (0, 0, 0), specular=0))
        scene = g.save(daemon.folder, "soot.gltf")
        sky = ("--background", ".3,.3,.3")
        for kind in ("png", "exr"):
            self.assertEqual(judged(scene, *sky, kind=kind)[1], [], kind)
            self.says("reflects none", scene, *sky, "--orthographic", "1", kind=kind)
            self.says("reflects none", scene, "--light", "point:at=0,0,3,intensity=9", kind=kind, spp=1)

    def test_sixteen_bits(self):
        self.says("take 32 bits", board(1e6), "--half", "--orthographic", "2")

    def test_nothing_to_see(self):
        g = Gltf()
        g.light("point", 1.0, (0, 1, 0))
        self.says("no surface", g.save(daemon.folder, "empty.gltf"), "--background", "1,1,1")

    def test_good_pictures_have_none(self):
        """Lit rooms, a lamp in the void, a white page and a picture of the background's own."""
        cornell = make.cornell(daemon.folder)
        for technique in TECHNIQUES:
            self.assertEqual(judged(cornell, camera=(0, 1, 3.9, 0, 1, 0, 0, 1, 0, 39), kind="png", technique=technique)[1], [])
        self.assertEqual(judged(board(3, 1), kind="png")[1], [])
        g = Gltf()
        g.place(*quad((-.05, -.05, 0), (.05, -.05, 0), (.05, .05, 0), (-.05, .05, 0)), g.material("far", (0, 0, 0), (1,) * 3))
        self.assertEqual(judged(g.save(daemon.folder, "far.gltf"), size=64)[1], [])
        g = Gltf()
        g.place(*quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), g.material("page", (1,) * 3, unlit=True))
        self.assertEqual(judged(g.save(daemon.folder, "page.gltf"), kind="png")[1], [])
        self.assertEqual(judged(cornell, "--set", "vct.show=albedo", "--set", "vct.resolution=16", "--set", "vct.slice=0", technique="vct", spp=1)[1], [])


class Sweeps(unittest.TestCase):
    """Three pictures of a closed room: from outside of it, from inside, and past it."""
    cameras = [FRONT, (0, 0, .9, 0, 0, 0, 0, 1, 0, 60), (0, 0, 5, 0, 0, 9, 0, 1, 0, 40)]

    def test_over_the_wire(self):
        closed_room()

        def camera(eye_x, eye_y, eye_z, x, y, z, up_x, up_y, up_z, vfov):
            return pb.Camera(eye=pb.Vec3(x=eye_x, y=eye_y, z=eye_z), target=pb.Vec3(x=x, y=y, z=z),
                             up=pb.Vec3(x=up_x, y=up_y, z=up_z), vfov_degrees=vfov)

        with wire.Connection(daemon.socket) as connection:
            connection.load("room", daemon.folder, "closed.gltf")
            render = pb.Render(scene="room", width=16, height=16, samples=4, progressive=True)
            sweep = pb.Sweep(render=render, cameras=[camera(*c) for c in self.cameras])
            replies = connection.follow(connection.send(wire.SWEEP, sweep.SerializeToString()))
            finals = [r.body.verdict for r in replies if r.kind == wire.IMAGE and r.body.final]
            self.assertFalse(any(r.body.HasField("verdict") for r in replies if r.kind == wire.IMAGE and not r.body.final))
            for verdict, c in zip(finals, sweep.cameras):
                render.camera.CopyFrom(c)
                one = connection.follow(connection.send(wire.RENDER, render.SerializeToString()))
                self.assertEqual(one[-1].body.verdict, verdict)
                self.assertEqual(next(r.body for r in one if r.kind == wire.IMAGE and r.body.final).verdict, verdict)
            done = replies[-1].body
            for share in ("black", "clipped", "missed"):
                self.assertAlmostEqual(getattr(done.verdict, share), sum(getattr(v, share) for v in finals) / 3, 12)
            self.assertEqual(len(of_verdict(done.notes)), 2, done.notes)

    def test_notes_that_differ_in_a_number_are_one(self):
        """Two dim plates, of which each picture sees one: the first picture's advice stands for both."""
        g = Gltf()
        for x, radiance in ((-5, 1e-5), (5, 1e-6)):
            g.place(*quad((x - 1, -1, 0), (x + 1, -1, 0), (x + 1, 1, 0), (x - 1, 1, 0)),
                    g.material(f"at {x}", (0, 0, 0), (radiance,) * 3))
        scene = g.save(daemon.folder, "plates.gltf")
        cameras = os.path.join(daemon.folder, "two.json")
        with open(cameras, "w", encoding="utf-8") as file:
            json.dump([(x, 0, 2, x, 0, 0, 0, 1, 0, 40) for x in (-5, 5)], file)
        output = os.path.join(daemon.folder, "p{index}.png")
        out = daemon.candil("sweep", scene, "-o", output, "--cameras", cameras, "--size", "8x8", "--spp", "1", "--json")[1]
        alone = judged(scene, camera=(-5, 0, 2, -5, 0, 0, 0, 1, 0, 40), size=8, spp=1, kind="png")[1]
        self.assertEqual(of_verdict(json.loads(out)["notes"]), alone)
        self.assertIn("too dark", alone[0])

    def test_on_the_command_line(self):
        cameras = os.path.join(daemon.folder, "cameras.json")
        with open(cameras, "w", encoding="utf-8") as file:
            json.dump([list(c) for c in self.cameras], file)
        output = os.path.join(daemon.folder, "s{index}.png")
        command = ("sweep", closed_room(), "-o", output, "--cameras", cameras, "--size", "16x16", "--spp", "4")
        _, text, _ = daemon.candil(*command)
        for line in ("verdict    2 of 3 images are black\n", "verdict    1 of 3 images see no surface\n", "note       no light comes",
                     "note       the camera looks at no surface"):
            self.assertIn(line, text)
        summary = json.loads(daemon.candil(*command, "--force", "--json")[1])
        self.assertEqual(len(of_verdict(summary["notes"])), 2)
        self.assertFalse(summary["default_light"])
        for image in summary["images"]:
            codes = images.rgb(image["image"])
            self.assertEqual(image["verdict"]["black"], (codes == 0).all(axis=2).mean())
        again = json.loads(daemon.candil(*command, "--json")[1])
        self.assertNotIn("verdict", again["images"][0], "what was there already is not judged")


if __name__ == "__main__":
    unittest.main()
