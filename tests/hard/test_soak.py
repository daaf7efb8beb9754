"""Many mixed requests, loads and unloads: memory, descriptors and what is held on the device stay level, in the daemon and in its
worker. CANDIL_SOAK multiplies the counts; at 10 it is 2,000 requests and 200 cycles."""
import os
import subprocess
import unittest

import make
import wire
from render import CANDIL, Daemon

ROUNDS = 20 * int(os.environ.get("CANDIL_SOAK", "1"))
SANITIZE = os.environ.get("CANDIL_SANITIZE") == "1"


class Soak(unittest.TestCase):
    def round(self, daemon, scenes, i):
        """Ten requests of different kinds on two scenes, one of which comes and goes."""
        daemon.candil("load", scenes["textured"], "--name", "passing")
        for k, arguments in enumerate((["--spp", "2"], ["--spp", "4", "--effects", "all"], ["--spp", "1", "--aov", "depth,normal,albedo,id"],
                                       ["--spp", "3", "--set", "pt.depth=20"], ["--spp", "2", "--seed", str(i)])):
            for name in ("kept", "passing"):
                out = os.path.join(daemon.folder, f"soak{k}.exr")
                daemon.candil("render", name, "-o", out, "--size", f"{24 + k}x{17 + i % 7}", "--background", "1,1,1", *arguments)
        # One that is given up: its client is gone in the middle.
        job = subprocess.Popen([CANDIL, "--connect", daemon.socket, "render", "kept", "-o", "-", "--size", "256x256", "--spp", "1024"],
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while daemon.stats()["jobs"] == 0 and job.poll() is None:
            pass
        job.kill()
        job.wait()
        daemon.candil("unload", "passing")

    def settle(self, daemon):
        while daemon.stats()["jobs"] > 0:
            pass
        # The device's bytes are those of the last slice: make that the same one every time.
        daemon.render("kept", size=(32, 32), spp=1)
        stats = daemon.stats()
        pids = {"daemon": daemon.process.pid, "worker": stats["worker_pid"]}
        return {**{f"{n} descriptors": wire.descriptors(p) for n, p in pids.items()}, "device bytes": stats["device_bytes"],
                "scenes": stats["scenes"], "buffered": stats["buffered_bytes"]}, {n: wire.rss_kib(p) for n, p in pids.items()}

    def test_level(self):
        with Daemon() as daemon:
            scenes = {"kept": make.cornell(daemon.folder), "textured": make.textured_quad(daemon.folder)}
            daemon.candil("load", scenes["kept"], "--name", "kept")
            for i in range(5):
                self.round(daemon, scenes, i)
            held, memory = self.settle(daemon)
            for i in range(ROUNDS):
                self.round(daemon, scenes, i)
            held_after, memory_after = self.settle(daemon)
            print(f"{ROUNDS} rounds: {held_after}, resident KiB {memory} -> {memory_after}")
            self.assertEqual(held_after, held)
            self.assertEqual(daemon.stats()["worker_starts"], 1)
            if not SANITIZE:
                self.assertLess(memory_after["daemon"] - memory["daemon"], 1024)
                self.assertLess(memory_after["worker"] - memory["worker"], 16 * 1024)


if __name__ == "__main__":
    unittest.main()
