"""The same request with a fixed sample count gives the same bits: run twice, whatever the slices, beside whatever other job,
split into ranges of samples, and in as many dispatches as the driver bears."""
import tempfile
import threading
import unittest

import numpy

import make
from render import Daemon, Failed
from writers import Gltf

SIZE = (64, 48)


def setUpModule():
    global folder, scene
    folder = unittest.enterModuleContext(tempfile.TemporaryDirectory(prefix="candil-scenes-"))
    scene = make.cornell(folder)


def bits(daemon, **more):
    return daemon.render(scene, **{"size": SIZE, "spp": 24, **more}).radiance.tobytes()


class SameBits(unittest.TestCase):
    def test_twice_and_with_any_slice(self):
        seen = set()
        slices = []
        for milliseconds in (1, 7, 50):
            with Daemon("--slice", str(milliseconds)) as daemon:
                for _ in range(2):
                    picture = daemon.render(scene, size=SIZE, spp=24)
                    seen.add(picture.radiance.tobytes())
                slices.append(picture.report["slices"])
        self.assertEqual(len(seen), 1)
        # The slices did differ: else this proves nothing.
        self.assertGreater(slices[0], slices[2])

    def test_beside_another_job(self):
        with Daemon() as daemon:
            alone = bits(daemon)
            others = []
            other = threading.Thread(target=lambda: others.append(bits(daemon, size=(256, 256), spp=64)))
            other.start()
            beside = set()
            for _ in range(2):
                beside.add(bits(daemon))
            overlapped = other.is_alive()
            other.join()
            self.assertEqual(beside, {alone})
            self.assertTrue(overlapped, "the other job ended too soon to prove anything")
            # And the large one is what it is alone.
            self.assertEqual(others, [bits(daemon, size=(256, 256), spp=64)])

    def test_seeds_differ(self):
        with Daemon() as daemon:
            self.assertNotEqual(bits(daemon), bits(daemon, arguments=["--seed", "1"]))

    def test_ranges_of_samples_merge(self):
        with Daemon() as daemon:
            whole = daemon.render(scene, size=SIZE, spp=24).radiance.astype(numpy.float64)
            first = daemon.render(scene, size=SIZE, spp=8).radiance.astype(numpy.float64)
            rest = daemon.render(scene, size=SIZE, spp=16, arguments=["--first-sample", "8"]).radiance.astype(numpy.float64)
        merged = (8 * first + 16 * rest) / 24
        numpy.testing.assert_allclose(merged, whole, rtol=1e-5, atol=1e-7)

    def test_interrupted_paths_go_on_bit_for_bit(self):
        with Daemon() as daemon:
            whole = bits(daemon, options={"pt.depth": 12, "pt.segment": 13})
            for events in (1, 2, 5):
                self.assertEqual(bits(daemon, options={"pt.depth": 12, "pt.segment": events}), whole)

    def test_samples_of_one_dispatch(self):
        with Daemon() as daemon:
            seen = {bits(daemon)}
            for samples, events in ((1, 2), (5, 9), (24, 2)):
                seen.add(bits(daemon, options={"pt.batch": samples, "pt.segment": events}))
            # From an odd sample on, too.
            odd = {bits(daemon, spp=7, arguments=["--first-sample", "5"], options={"pt.batch": n}) for n in (1, 7)}
        self.assertEqual(len(seen), 1)
        self.assertEqual(len(odd), 1)


class Raster(unittest.TestCase):
    """What one job leaves on the device is nothing to the next."""

    def test_voxels_do_not_remember_a_seed(self):
        seen = []
        for before in ((), (1, 5)):
            with Daemon() as daemon:
                daemon.candil("load", scene, "--name", "room")
                for seed in (*before, 2):
                    picture = daemon.render("room", size=SIZE, spp=1, options={"vct.resolution": 32},
                                            arguments=["--technique", "vct", "--seed", str(seed)])
                seen.append(picture.radiance.tobytes())
        self.assertEqual(seen[0], seen[1])

    def test_an_empty_scene_stays_empty_beside_others(self):
        g = Gltf()
        g.camera((0, 1, 3.5), (0, 1, 0), 40)
        empty = g.save(folder, "empty.gltf")
        with Daemon() as daemon:
            daemon.candil("load", scene, "--name", "room")
            daemon.candil("load", empty, "--name", "empty")
            for technique in ("direct", "vct", "radiosity"):
                options = {"vct": {"vct.resolution": 32}, "radiosity": {"radiosity.patches": 300}}.get(technique, {})
                daemon.render("room", size=SIZE, spp=2, options=options, arguments=["--technique", technique])
                picture = daemon.render("empty", size=SIZE, spp=4, options=options,
                                        arguments=["--technique", technique, "--background", "1,1,1"])
                self.assertEqual(float(picture.radiance.min()), 1, technique)
                self.assertEqual(float(picture.radiance.max()), 1, technique)


class LongLoops(unittest.TestCase):
    """Some drivers end an invocation's loops after about 65,535 rounds, silently. In a closed sphere of albedo 0.999 a path has
    hundreds of events; a picture that lost the rest of them would be dark."""

    def test_long_paths_are_whole(self):
        rho, depth = 0.9995, 4096
        sphere = make.closed_sphere(folder, rho=rho, name="long.gltf")
        expected = 1 - rho ** (depth + 1)
        with Daemon() as daemon:
            picture = daemon.render(sphere, size=(16, 16), spp=8, options={"pt.depth": depth})
            mean = float(picture.radiance.mean(dtype=numpy.float64))
            print(f"rho {rho} depth {depth}: mean {mean:.4f}, expected {expected:.4f}")
            # Cut after some two thousand events, as that driver does, it would be 0.63 and less.
            self.assertLess(abs(mean / expected - 1), 0.1)
            # The same in one dispatch: right too, or refused by name. Never silently dark.
            try:
                picture = daemon.render(sphere, size=(16, 16), spp=8, options={"pt.depth": depth, "pt.segment": depth + 1})
                self.assertEqual(float(picture.radiance.mean(dtype=numpy.float64)), mean)
                print("the driver runs long loops to their end")
            except Failed as failure:
                self.assertIn("traversal-cut", failure.text)
                print("the driver cuts long loops, and it was noticed")


if __name__ == "__main__":
    unittest.main()
