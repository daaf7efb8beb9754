"""The real worker killed in the middle of a frame, the real loader in the middle of a load: the service goes on, and says so."""
import os
import resource
import signal
import subprocess
import unittest

import make
from render import CANDIL, Daemon
from wire import wait_for


def worked_ticks(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        return sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13]))


class Killed(unittest.TestCase):
    def start(self, daemon, *arguments):
        return subprocess.Popen([CANDIL, "--connect", daemon.socket, *arguments], stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_worker_in_the_middle_of_a_frame(self):
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            alone = daemon.render("box", spp=16).radiance.tobytes()
            out = os.path.join(daemon.folder, "killed.exr")
            job = self.start(daemon, "render", "box", "-o", out, "--size", "512x512", "--spp", "64", "--json")
            before = wait_for(lambda: (lambda s: s if s["slices"] > 5 and s["jobs"] == 1 else None)(daemon.stats()),
                              "the frame is under way")
            os.kill(before["worker_pid"], signal.SIGKILL)
            # The job is begun again, from the blob that the front has kept.
            self.assertEqual(daemon.render("box", spp=16).radiance.tobytes(), alone)
            after = daemon.stats()
            self.assertEqual(after["worker_starts"], before["worker_starts"] + 1)
            self.assertEqual(after["loader_starts"], before["loader_starts"])
            self.assertNotEqual(after["worker_pid"], before["worker_pid"])
            # A second loss in the same job: its client hears of it by name, and the daemon goes on again.
            wait_for(lambda: daemon.stats()["slices"] > after["slices"] + 5, "it goes on")
            os.kill(after["worker_pid"], signal.SIGKILL)
            _, error = job.communicate(timeout=120)
            self.assertEqual(job.returncode, 9, error)
            self.assertIn(b"worker-lost", error)
            self.assertFalse(os.path.exists(out))
            self.assertEqual(daemon.render("box", spp=16).radiance.tobytes(), alone)

    def test_loader_in_the_middle_of_a_load(self):
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            job = self.start(daemon, "load", make.slow_to_load(daemon.folder), "--name", "big")
            loader = wait_for(lambda: daemon.stats()["loader_pid"], "the loader is there")
            os.kill(loader, signal.SIGKILL)
            _, error = job.communicate(timeout=120)
            self.assertEqual(job.returncode, 4, error)
            self.assertIn(b"loader-lost", error)
            self.assertGreater(float(daemon.render("box", spp=4).radiance.max()), 0)
            self.assertEqual(daemon.stats()["loader_failures"], 1)

    def test_daemon_takes_its_children_along(self):
        """Stopped, they could not even notice that it is gone. One that goes on would end by itself some day."""
        daemon = Daemon().__enter__()
        self.addCleanup(daemon.stop)
        daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
        job = self.start(daemon, "load", make.slow_to_load(daemon.folder), "--name", "big")
        loader = wait_for(lambda: daemon.stats()["loader_pid"], "the loader is there")
        worker = wait_for(lambda: (lambda s: s["device"] and s["worker_pid"])(daemon.stats()), "the worker is there")
        # Who is stopped before it has linked its libraries has not asked for that signal yet.
        wait_for(lambda: worked_ticks(loader) >= 10, "the loader is at work")
        for child in loader, worker:
            os.kill(child, signal.SIGSTOP)
        daemon.process.kill()
        for child in loader, worker:
            wait_for(lambda: is_gone(child), "the child is gone")
        _, error = job.communicate(timeout=120)
        self.assertNotEqual(job.returncode, 0, error)

    def test_a_file_that_may_not_grow(self):
        """The kernel's signal for that kills nobody, and no part of the file is left."""
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))
        with Daemon() as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            pictures = [os.path.join(daemon.folder, name + ".exr") for name in "ab"]
            for path in pictures:
                daemon.candil("render", "box", "-o", path, "--size", "64x64", "--spp", "1")
            before = sorted(os.listdir(daemon.folder))
            out = os.path.join(daemon.folder, "out.")
            for command in (["render", "box", "-o", out + "exr", "--size", "64x64", "--spp", "1"],
                            ["compare", *pictures, "--html", out + "html"]):
                done = subprocess.run([CANDIL, "--connect", daemon.socket, *command], stdin=subprocess.DEVNULL,
                                      capture_output=True, text=True, preexec_fn=limit)
                self.assertGreater(done.returncode, 0, done)
                self.assertIn("File too large", done.stderr)
                self.assertEqual(sorted(os.listdir(daemon.folder)), before)

    @unittest.skipIf(os.environ.get("CANDIL_SANITIZE") == "1", "AddressSanitizer's own address space is beyond any limit")
    def test_little_address_space(self):
        """Every program says that, by its own exit code, and crashes at no size."""
        def run(mebibytes, *command):
            def limit():
                resource.setrlimit(resource.RLIMIT_AS, (mebibytes << 20, mebibytes << 20))
            return subprocess.run([CANDIL, *command], stdin=subprocess.DEVNULL, capture_output=True, text=True, preexec_fn=limit)
        with Daemon() as daemon:
            scene = make.cornell(daemon.folder)
            pictures = [os.path.join(daemon.folder, name + ".exr") for name in "ab"]
            daemon.candil("load", scene, "--name", "box")
            for path in pictures:
                daemon.candil("render", "box", "-o", path, "--size", "512x512", "--spp", "1")
            before = sorted(os.listdir(daemon.folder))
            out = os.path.join(daemon.folder, "out.exr")
            for mebibytes, *command in ((16, "render", scene, "-o", out), (64, "render", scene, "-o", out), (512, "render", scene, "-o", out),
                                        (1024, "render", scene, "-o", out), (7, "--connect", daemon.socket, "render", "box", "-o", out, "--size",
                                        "1024x1024", "--spp", "1"), (16, "compare", *pictures), (384, "compare", *pictures)):
                with self.subTest(f"{mebibytes} MiB: {command}"):
                    done = run(mebibytes, *command)
                    self.assertEqual(done.returncode, 6, done)
                    self.assertRegex(done.stderr, r"ulimit -v.*\(memory\)")
                    self.assertEqual(done.stderr.splitlines()[-1].count("ulimit -v"), 1, done)
                    self.assertEqual(sorted(os.listdir(daemon.folder)), before)


def is_gone(pid):
    """Dead, if nobody may have asked how yet."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0] in "ZX"
    except (FileNotFoundError, ProcessLookupError):
        return True


if __name__ == "__main__":
    unittest.main()
