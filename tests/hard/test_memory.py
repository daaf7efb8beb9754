"""Memory follows the size of the picture, not the number of samples; what a job takes is known, and refused, before it begins."""
import os
import tempfile
import unittest

import make
import wire
from render import Daemon, Failed

MIB = 1 << 20


def forget_peak(pid):
    with open(f"/proc/{pid}/clear_refs", "w", encoding="ascii") as file:
        file.write("5")


def peak_kib(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:"))


class Memory(unittest.TestCase):
    def accepted(self, daemon, **fields):
        """What the worker says of a job as it begins."""
        with wire.Connection(daemon.socket) as connection:
            replies = connection.follow(connection.send(wire.RENDER, wire.pb.Render(scene="box", **fields)), (wire.ACCEPTED, wire.ERROR))
        return replies[-1].body

    @unittest.skipIf(os.environ.get("CANDIL_SANITIZE") == "1", "AddressSanitizer keeps what was freed for a while")
    def test_peak_does_not_depend_on_the_number_of_samples(self):
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            daemon.render("box", size=(64, 64), spp=8)
            pids = {"daemon": daemon.process.pid, "worker": daemon.stats()["worker_pid"]}
            peaks = []
            for side, spp in ((64, 4), (64, 512), (512, 1)):
                for pid in pids.values():
                    forget_peak(pid)
                daemon.render("box", size=(side, side), spp=spp)
                peaks.append({name: peak_kib(pid) for name, pid in pids.items()})
            print("peaks in KiB, few samples, many, a large picture:", peaks)
            few, many, large = peaks
            for name in pids:
                self.assertLess(many[name], few[name] + 2048)
            self.assertGreater(large["worker"], few["worker"] + 4096)

    def test_what_a_job_takes_is_said_before_it_begins(self):
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            few, many, large = (self.accepted(daemon, width=side, height=side, samples=samples).job_bytes
                                for side, samples in ((64, 1), (64, 1 << 20), (512, 1)))
            self.assertEqual(few, many)
            self.assertGreater(large, 20 * few)
            self.assertGreater(few, 64 * 64 * 12)

    def test_it_is_refused_before_it_begins(self):
        with Daemon("--memory-budget", "16") as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            before = daemon.render("box", size=(32, 32), spp=1)
            slices, held = daemon.stats()["slices"], daemon.stats()["device_bytes"]
            forget_peak(daemon.stats()["worker_pid"])
            memory = peak_kib(daemon.stats()["worker_pid"])
            with self.assertRaises(Failed) as refused:
                daemon.render("box", size=(4096, 4096), spp=1)
            self.assertEqual(refused.exception.status, 6)
            self.assertRegex(refused.exception.text, r"takes \d+ MiB, the memory budget is 16 MiB")
            stats = daemon.stats()
            self.assertEqual((stats["slices"], stats["device_bytes"], stats["worker_starts"]), (slices, held, 1))
            self.assertLess(peak_kib(stats["worker_pid"]), memory + 1024)
            self.assertEqual(daemon.render("box", size=(32, 32), spp=1).radiance.tobytes(), before.radiance.tobytes())

    def test_no_scene_makes_room_in_vain(self):
        """A job that would fit the budget alone, but not beside its own scene, is refused while the others stay where they are."""
        vct = dict(size=(32, 32), spp=1, options={"vct.resolution": 64}, arguments=["--technique", "vct"])
        with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder:
            g = make.Gltf()
            g.place(*make.icosphere(6, 1), g.material("ball"))
            g.light("point", 3, (2, 2, 2))
            g.camera((0, 0, 4), (0, 0, 0), 40)
            large, small = g.save(folder, "large.glb"), make.cornell(folder)
            with Daemon() as daemon:
                takes = daemon.render(large, **vct).report["job_bytes"]
            with Daemon("--memory-budget", str(takes // MIB + 4)) as daemon:
                for path, name in ((small, "small"), (large, "large")):
                    daemon.candil("load", path, "--name", name)
                daemon.render("small", size=(16, 16), spp=1)
                daemon.render("large", size=(16, 16), spp=1, arguments=["--technique", "direct"])
                beside = daemon.render("small", size=(16, 16), spp=1)
                held = daemon.stats()["device_bytes"]
                with self.assertRaises(Failed) as refused:
                    daemon.render("large", **vct)
                print(refused.exception.text.strip())
                self.assertEqual(refused.exception.status, 6)
                self.assertEqual(daemon.stats()["device_bytes"], held)
                self.assertEqual(daemon.render("small", size=(16, 16), spp=1).radiance.tobytes(), beside.radiance.tobytes())


if __name__ == "__main__":
    unittest.main()
