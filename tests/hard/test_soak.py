"""Many mixed requests, loads and unloads: memory, descriptors and what is held on the device stay level, in the daemon and in its
worker. CANDIL_SOAK multiplies the counts; at 10 it is 2,000 requests and 200 cycles."""
import os
import subprocess
import time
import unittest

import make
import wire
from render import CANDIL, Daemon
from wire import pb

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

    def settle(self, daemon, connection):
        """What is held once nobody but `connection` is there: the daemon notices a little later that a client has gone."""
        def alone():
            stats = connection.stats()
            while stats.jobs > 0 or stats.connections > 1:
                time.sleep(0.01)
                stats = connection.stats()
            return stats
        stats = alone()
        pids = {"daemon": daemon.process.pid, "worker": stats.worker_pid}

        # The worker carries out one order after the other: once it has drawn this it has let go of what was given up before.
        connection.follow(connection.send(wire.RENDER, pb.Render(scene="kept", width=8, height=8, samples=1, technique=pb.TECHNIQUE_PT)))

        def held():
            stats = connection.stats()
            return {**{f"{n} descriptors": wire.descriptors(p) for n, p in pids.items()}, "device bytes": stats.device_bytes,
                    "scenes": stats.scenes, "buffered": stats.buffered_bytes}
        # Nor does the worker close an image in the moment in which it has sent it.
        looks = [held()]
        while len(looks) < 10 or looks[-10:] != looks[-1:] * 10:
            time.sleep(0.05)
            looks.append(held())
        return looks[-1], {n: wire.rss_kib(p) for n, p in pids.items()}

    def test_level(self):
        with Daemon() as daemon, wire.Connection(daemon.socket) as connection:
            scenes = {"kept": make.cornell(daemon.folder), "textured": make.textured_quad(daemon.folder)}
            daemon.candil("load", scenes["kept"], "--name", "kept")
            for i in range(5):
                self.round(daemon, scenes, i)
            held, memory = self.settle(daemon, connection)
            for i in range(ROUNDS):
                self.round(daemon, scenes, i)
            held_after, memory_after = self.settle(daemon, connection)
            print(f"{ROUNDS} rounds: {held_after}, resident KiB {memory} -> {memory_after}")
            self.assertEqual(held_after, held)
            self.assertEqual(daemon.stats()["worker_starts"], 1)
            if not SANITIZE:
                self.assertLess(memory_after["daemon"] - memory["daemon"], 1024)
                self.assertLess(memory_after["worker"] - memory["worker"], 16 * 1024)


if __name__ == "__main__":
    unittest.main()
