"""Memory follows the size of the picture, not the number of samples; what a job takes is known, and refused, before it begins."""
import os
import signal
import tempfile
import time
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


def level_kib(pid):
    """Resident memory once it has not moved for a while. A worker that is kept from resting meanwhile has more."""
    looks = [wire.rss_kib(pid)]
    while len(looks) < 12 or max(looks[-12:]) - min(looks[-12:]) > 256:
        time.sleep(.1)
        looks.append(wire.rss_kib(pid))
    return looks[-1]


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

    @unittest.skipIf(os.environ.get("CANDIL_SANITIZE") == "1", "AddressSanitizer keeps what was freed for a while")
    def test_what_a_large_picture_took_goes_back(self):
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            for technique in ("pt", "direct", "vct"):
                def render(side):
                    daemon.render("box", size=(side, side), spp=1, arguments=["--technique", technique])
                render(64)
                worker = daemon.stats()["worker_pid"]
                before, held = level_kib(worker), daemon.stats()["device_bytes"]
                forget_peak(worker)
                render(1024)
                self.assertEqual(daemon.stats()["device_bytes"], held)
                peak = peak_kib(worker)
                after = wire.wait_for(lambda: (lambda kib: kib if kib < before + 16 * 1024 else 0)(wire.rss_kib(worker)), "it is given back")
                print(f"{technique}: resident {before >> 10} MiB before 1024x1024, {peak >> 10} at most, {after >> 10} after")
                self.assertGreater(peak, before + 32 * 1024)

    def test_what_is_held_is_told_when_nothing_runs(self):
        with Daemon() as daemon, wire.Connection(daemon.socket) as connection:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            self.assertEqual(daemon.stats()["device_bytes"], 0)
            daemon.render("box", size=(64, 64), spp=1)
            scene = daemon.stats()["device_bytes"]
            self.assertGreater(scene, 0)
            self.assertLess(scene, 64 * 64 * 12)
            # A job holds its own until it is cancelled.
            job = connection.send(wire.RENDER, wire.pb.Render(scene="box", width=256, height=256, samples=1 << 20))
            self.assertEqual(connection.receive_for(job).kind, wire.ACCEPTED)
            self.assertGreater(connection.stats().device_bytes, scene + 256 * 256 * 12)
            self.assertEqual(connection.ask(wire.CANCEL, wire.pb.Cancel(request=job)).kind, wire.OK)
            wire.wait_for(lambda: connection.stats().device_bytes == scene, "the scene alone is held")
            daemon.candil("unload", "box")
            wire.wait_for(lambda: connection.stats().device_bytes == 0, "nothing is held")
            # Neither does the next worker hold what the one before did.
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            daemon.render("box", size=(64, 64), spp=1)
            worker = connection.stats().worker_pid
            os.kill(worker, signal.SIGKILL)
            wire.wait_for(lambda: connection.stats().worker_pid not in (0, worker), "another worker runs")
            self.assertEqual(connection.stats().device_bytes, 0)
            daemon.render("box", size=(64, 64), spp=1)
            self.assertEqual(connection.stats().device_bytes, scene)

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
