"""The account of time: the stages cover all that passed from the request's arrival to the image's last byte and nothing twice, and what a
device spends once is told apart. No test looks at the clock: only shares of a frame's own time count."""
import json
import os
import unittest

import make
import wire
from render import PIECES, Daemon

COVER = 0.95
ONCE = ("open", "compile")


def setUpModule():
    global daemon, box
    daemon = unittest.enterModuleContext(Daemon())
    box = make.cornell(daemon.folder)
    daemon.candil("load", box, "--name", "box")


def sum_of(stages):
    return sum(s["us"] for s in stages)


def once(report):
    return sum_of(s for s in report["stages"] if s["name"] in ONCE)


class Account(unittest.TestCase):
    def assert_covered(self, report):
        told = sum_of(report["stages"])
        self.assertLessEqual(told, report["elapsed_us"])
        self.assertGreaterEqual(told, COVER * report["elapsed_us"], report["stages"])
        self.assertEqual(len({s["name"] for s in report["stages"]}), len(report["stages"]))
        self.assertEqual(report["cold_us"], once(report))

    def frame(self, technique, size=(64, 64), more=(), of=None):
        report = (of or daemon).render(box, size, 2, arguments=["--technique", technique, *more]).report
        self.assert_covered(report)
        return report

    def test_the_first_is_cold_and_the_second_warm(self):
        with Daemon() as new:
            for technique in PIECES:
                with self.subTest(technique):
                    self.assertGreater(self.frame(technique, of=new)["cold_us"], 0)
                    self.assertEqual(self.frame(technique, of=new)["cold_us"], 0)

    def test_warm_again_after_others(self):
        """Of sizes, too, for which a software driver compiles other programs."""
        for size in ((64, 64), (72, 48)):
            for technique in (*PIECES, *PIECES):
                self.frame(technique, size)
            for technique in (*PIECES, *reversed(PIECES)):
                with self.subTest(technique, size=size):
                    self.assertEqual(self.frame(technique, size)["cold_us"], 0)

    def test_of_edits_and_channels(self):
        for i, technique in enumerate(PIECES):
            with self.subTest(technique):
                edit = ["--light", f"point:at=0,1,0,intensity={i + 1}", "--aov", "depth,id"]  # an edited scene is kept and told once
                names = [s["name"] for s in self.frame(technique, more=edit)["stages"]]
                self.assertIn("edit", names)
                self.assertIn("aov", names)
                self.frame(technique, more=edit)

    def test_of_a_sweep(self):
        """Its images are made one while the one before is encoded, so their stages may be more than its time."""
        for technique in PIECES:
            with self.subTest(technique):
                request = wire.pb.Render(scene="box", width=64, height=64, samples=2, technique=wire.pb.Technique.Value("TECHNIQUE_" + technique.upper()))
                sweep = wire.pb.Sweep(render=request, cameras=[wire.pb.Camera()] * 3)
                with wire.Connection(daemon.socket) as connection:
                    connection.follow(connection.send(wire.SWEEP, sweep))
                    done = connection.follow(connection.send(wire.SWEEP, sweep))[-1].body
                self.assertGreaterEqual(sum(s.us for s in done.stages), COVER * done.elapsed_us)
                self.assertEqual(done.cold_us, 0)
                out = os.path.join(daemon.folder, technique + "{index}.exr")
                told = daemon.candil("sweep", "box", "-o", out, "--orbit", "2", "--size", "64x64", "--technique", technique, "--json")[1]
                self.assertEqual(json.loads(told)["cold_us"], 0)

    def test_of_intermediate_images(self):
        picture = daemon.render("box", (96, 96), 64, arguments=["--progressive"])
        self.assert_covered(picture.report)
        self.assertGreater(sum_of(s for s in picture.report["stages"] if s["name"] == "preview"), 0)

    def test_of_many_together(self):
        """Each waits for the others, and says so."""
        request = wire.pb.Render(scene="box", width=96, height=96, samples=8)
        with wire.Connection(daemon.socket) as connection:
            jobs = [connection.send(wire.RENDER, request) for _ in range(4)]
            for job in jobs:
                done = connection.follow(job)[-1].body
                told = {s.name: s.us for s in done.stages}
                self.assertLessEqual(sum(told.values()), done.elapsed_us)
                self.assertGreaterEqual(sum(told.values()), COVER * done.elapsed_us)
                self.assertGreater(told["queue"] + told["wait"], 0)


if __name__ == "__main__":
    unittest.main()
