"""A deadline ends a picture with what is there, of fewer pixels if need be; its first sample comes alone, and it changes no bit of what is whole."""
import os
import unittest

import images
import make
import wire
from render import Daemon

FAR = 3600 * 1000
AOV_DEPTH = 1


def setUpModule():
    global daemon, connection
    daemon = unittest.enterModuleContext(Daemon("--slice", "1"))
    daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
    connection = unittest.enterModuleContext(wire.Connection(daemon.socket))


def replies(**fields):
    fields = {"width": 96, "height": 64, **fields}
    request = wire.pb.Render(scene="box", format=wire.pb.FORMAT_EXR_FLOAT, progress_ms=1, **fields)
    return connection.follow(connection.send(wire.RENDER, request))


def begun(deadline_ms, **fields):
    """Replies to a request that can hardly be kept, but is at least begun in time: by this deadline or, where the machine is busy, a later one."""
    for i in range(64):
        all_of = replies(deadline_ms=deadline_ms << i // 8, **fields)
        if all_of[-1].kind == wire.DONE:
            return all_of
        assert all_of[-1].body.name == "deadline"
    raise AssertionError("nothing is begun within its deadline")


class Deadline(unittest.TestCase):
    def test_the_first_sample_comes_alone(self):
        for technique, options in ((wire.pb.TECHNIQUE_PT, {}), (wire.pb.TECHNIQUE_PT, {"pt.batch": "16"}),
                                   (wire.pb.TECHNIQUE_DIRECT, {})):
            options = [wire.pb.Option(name=name, value=value) for name, value in options.items()]
            told = [r.body.samples_done for r in replies(technique=technique, samples=64, deadline_ms=FAR, options=options)
                    if r.kind == wire.PROGRESS]
            self.assertIn(1, told)

    def test_without_time_there_are_fewer_pixels(self):
        for technique in (wire.pb.TECHNIQUE_PT, wire.pb.TECHNIQUE_DIRECT, wire.pb.TECHNIQUE_VCT):
            picture = {"technique": technique, "aovs": AOV_DEPTH, "width": 512, "height": 512}
            replies(**picture, samples=1)  # all code is compiled, and what is made of the scene is there
            all_of = begun(**picture, samples=4096, deadline_ms=1)
            (frame, data), = wire.images(all_of)
            done = all_of[-1].body
            self.assertEqual(done.reason, "time")
            self.assertEqual((frame.width, frame.height), (512, 512))
            self.assertLess(frame.made_width * frame.made_height, 512 * 512 / 2)
            self.assertIn(f"there was time for {frame.made_width} x {frame.made_height} pixels alone", " ".join(done.notes))
            self.assertEqual(done.error_kind, wire.pb.ERROR_KIND_UNKNOWN)
            # It shows what the whole picture shows: its depths, for light of one sample is noise.
            path = os.path.join(daemon.folder, "scaled.exr")
            with open(path, "wb") as file:
                file.write(data)
            near = 1 / images.channels(path)["Z"].astype(float)
            whole = daemon.render("box", (64, 64), 1, arguments=["--technique", wire.pb.Technique.Name(technique)[10:].lower(), "--aov", "depth"])
            self.assertLess(abs(near.mean() / (1 / whole.channels["Z"].astype(float)).mean() - 1), .15)
            self.assertEqual(images.metadata(path)["candil/made_of"], f"{frame.made_width}x{frame.made_height}")

    def test_whole_or_nothing(self):
        for technique in (wire.pb.TECHNIQUE_PT, wire.pb.TECHNIQUE_DIRECT, wire.pb.TECHNIQUE_VCT):
            picture = {"technique": technique, "width": 512, "height": 512}
            replies(**picture, samples=1)
            took_ms = replies(**picture, samples=1)[-1].body.elapsed_us / 1e3
            late = {**picture, "samples": 4096, "deadline_ms": max(1, int(took_ms / 3))}
            (frame, _), = wire.images(begun(**late))
            self.assertLess(frame.made_width, 512)
            last = replies(**late, whole=True)[-1]
            self.assertEqual((last.kind, last.body.name), (wire.ERROR, "deadline"))
            (frame, _), = wire.images(begun(**picture, samples=4096, deadline_ms=int(took_ms * 4), whole=True))
            self.assertEqual((frame.made_width, frame.made_height), (512, 512))

    def test_each_image_of_a_sweep(self):
        request = wire.pb.Render(scene="box", width=512, height=512, samples=4096, technique=wire.pb.TECHNIQUE_PT)
        replies(technique=wire.pb.TECHNIQUE_PT, samples=1)
        for _ in range(100):
            request.deadline_ms += 20
            sweep = wire.pb.Sweep(render=request, cameras=[wire.pb.Camera()] * 4)
            all_of = connection.follow(connection.send(wire.SWEEP, sweep))
            if all_of[-1].kind == wire.DONE:
                break
        pictures = wire.images(all_of)
        self.assertEqual(len(pictures), 4)
        for frame, _ in pictures:
            self.assertEqual((frame.width, frame.height), (512, 512))
            self.assertGreater(frame.made_width * frame.made_height, 0)
        self.assertIn("pixels alone", " ".join(all_of[-1].body.notes))

    def test_the_same_bits(self):
        for technique in ("pt", "direct"):
            whole, timed = (daemon.render("box", spp=24, arguments=["--technique", technique, *more]).radiance.tobytes()
                            for more in ([], ["--time", str(FAR)]))
            self.assertEqual(whole, timed)

    def test_without_noise_one_sample_is_enough(self):
        for technique in (wire.pb.TECHNIQUE_DIRECT, wire.pb.TECHNIQUE_VCT, wire.pb.TECHNIQUE_RADIOSITY):
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
