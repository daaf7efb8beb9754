"""The real worker killed in the middle of a frame, the real loader in the middle of a load: the service goes on, and says so."""
import os
import signal
import subprocess
import tempfile
import time
import unittest

import make
from render import CANDIL, Daemon


def wait_for(condition, seconds=60):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError("it did not happen in time")


class Killed(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="candil-scenes-")
        self.scene = make.cornell(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def start(self, daemon, *arguments):
        return subprocess.Popen([CANDIL, "--connect", daemon.socket, *arguments], stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_worker_in_the_middle_of_a_frame(self):
        with Daemon() as daemon:
            daemon.candil("load", self.scene, "--name", "box")
            alone = daemon.render("box", spp=16).radiance.tobytes()
            out = os.path.join(self.folder.name, "killed.exr")
            job = self.start(daemon, "render", "box", "-o", out, "--size", "512x512", "--spp", "64", "--json")
            before = wait_for(lambda: (lambda s: s if s["slices"] > 5 and s["jobs"] == 1 else None)(daemon.stats()))
            os.kill(before["worker_pid"], signal.SIGKILL)
            # The job is begun again, from the blob that the front has kept.
            self.assertEqual(daemon.render("box", spp=16).radiance.tobytes(), alone)
            after = daemon.stats()
            self.assertEqual(after["worker_starts"], before["worker_starts"] + 1)
            self.assertEqual(after["loader_starts"], before["loader_starts"])
            self.assertNotEqual(after["worker_pid"], before["worker_pid"])
            # A second loss in the same job: its client hears of it by name, and the daemon goes on again.
            wait_for(lambda: daemon.stats()["slices"] > after["slices"] + 5)
            os.kill(after["worker_pid"], signal.SIGKILL)
            _, error = job.communicate(timeout=120)
            self.assertEqual(job.returncode, 9, error)
            self.assertIn(b"worker-lost", error)
            self.assertFalse(os.path.exists(out))
            self.assertEqual(daemon.render("box", spp=16).radiance.tobytes(), alone)

    def test_loader_in_the_middle_of_a_load(self):
        # A scene that takes a while: one mesh under many nodes.
        big = make.Gltf()
        positions, triangles = make.icosphere(4)
        mesh = big.mesh(positions, triangles, big.material("white", (0.8,) * 3))
        for i in range(300):
            big.node(mesh=mesh, translation=[i % 20 * 3.0, i // 20 * 3.0, 0])
        path = big.save(self.folder.name, "big.gltf")
        with Daemon() as daemon:
            daemon.candil("load", self.scene, "--name", "box")
            job = self.start(daemon, "load", path, "--name", "big")
            loader = wait_for(lambda: daemon.stats()["loader_pid"])
            os.kill(loader, signal.SIGKILL)
            _, error = job.communicate(timeout=120)
            self.assertEqual(job.returncode, 4, error)
            self.assertIn(b"loader-lost", error)
            self.assertGreater(float(daemon.render("box", spp=4).radiance.max()), 0)
            self.assertEqual(daemon.stats()["loader_failures"], 1)


if __name__ == "__main__":
    unittest.main()
