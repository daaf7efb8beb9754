"""A deadline ends a picture after its first sample at the earliest, and that sample comes alone; until it comes, it changes nothing."""
import unittest

import make
import wire
from render import Daemon

FAR = 3600 * 1000


def setUpModule():
    global daemon, connection
    daemon = unittest.enterModuleContext(Daemon("--slice", "1"))
    daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
    connection = unittest.enterModuleContext(wire.Connection(daemon.socket))


def replies(**fields):
    request = wire.pb.Render(scene="box", width=96, height=64, format=wire.pb.FORMAT_EXR_FLOAT, progress_ms=1, **fields)
    return connection.follow(connection.send(wire.RENDER, request))


class Deadline(unittest.TestCase):
    def test_the_first_sample_comes_alone(self):
        for technique, options in ((wire.pb.TECHNIQUE_PT, {}), (wire.pb.TECHNIQUE_PT, {"pt.batch": "16"}),
                                   (wire.pb.TECHNIQUE_DIRECT, {})):
            options = [wire.pb.Option(name=name, value=value) for name, value in options.items()]
            told = [r.body.samples_done for r in replies(technique=technique, samples=64, deadline_ms=FAR, options=options)
                    if r.kind == wire.PROGRESS]
            self.assertIn(1, told)

    def test_one_that_cannot_be_kept_ends_after_its_first_sample(self):
        for technique in (wire.pb.TECHNIQUE_PT, wire.pb.TECHNIQUE_DIRECT, wire.pb.TECHNIQUE_VCT):
            replies(technique=technique, samples=4096, deadline_ms=FAR // 3600)  # what is cold takes longer than the request may wait
            last = replies(technique=technique, samples=4096, deadline_ms=1)[-1]
            if last.kind == wire.ERROR:
                self.assertEqual(last.body.name, "deadline")  # it could not even be begun
            else:
                self.assertEqual((last.body.samples, last.body.reason), (1, "time"))

    def test_the_same_bits(self):
        for technique in ("pt", "direct"):
            whole, timed = (daemon.render("box", spp=24, arguments=["--technique", technique, *more]).radiance.tobytes()
                            for more in ([], ["--time", str(FAR)]))
            self.assertEqual(whole, timed)

    def test_without_noise_one_sample_is_enough(self):
        for technique in (wire.pb.TECHNIQUE_DIRECT, wire.pb.TECHNIQUE_VCT):
            done = replies(technique=technique, deadline_ms=FAR)[-1].body
            self.assertEqual((done.samples, done.reason), (1, "samples"))

    def test_what_is_unknown_is_not_told_as_perfect(self):
        """While voxels and shadow maps are made there is no picture, and so no error of it."""
        for more in ({"vct.show": "radiance"}, {"vct.shadows": "map"}):
            options = [wire.pb.Option(name=name, value=value) for name, value in ({"vct.resolution": "128"} | more).items()]
            told = [r.body for r in replies(technique=wire.pb.TECHNIQUE_VCT, options=options) if r.kind == wire.PROGRESS]
            unfinished = [p for p in told if p.samples_done == 0]
            self.assertTrue(unfinished, "no slice ended before the first sample: this test shows nothing")
            for progress in unfinished:
                self.assertLess(progress.estimated_relmse, 0)


if __name__ == "__main__":
    unittest.main()
