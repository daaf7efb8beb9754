"""Every file that candil writes, on a disk that has no room for it: the right exit code and sentence, what was there before stays as it
was, nothing half written is left, and the daemon goes on. The disk is a small tmpfs in a mount namespace of this test's own; where
there can be none, the test is skipped."""
import contextlib
import hashlib
import json
import os
import shutil
import subprocess
import sys
import unittest

import make
from render import CANDIL, Daemon

LIBEXEC = os.path.join(os.environ["CANDIL_BUILD"], "libexec", "candil")
INSIDE = "inside-a-namespace"
SKIPPED = 77
FILLER = "filler"


def contents(folder):
    """Of all files by their path, without the filler."""
    found = {}
    for base, _, names in os.walk(folder):
        for name in names:
            if name != FILLER:
                with open(os.path.join(base, name), "rb") as file:
                    found[os.path.relpath(os.path.join(base, name), folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


class FullDisk(unittest.TestCase):
    def setUp(self):
        self.daemon = Daemon()
        self.daemon.__enter__()
        self.addCleanup(self.daemon.stop)
        self.disk = os.path.join(self.daemon.folder, "disk")
        os.mkdir(self.disk)
        self.mount("2m")
        self.daemon.candil("load", make.cornell(self.daemon.folder), "--name", "box")

    def mount(self, size, *options):
        subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join([f"size={size}", *options]), "tmpfs", self.disk], check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], check=True)

    @contextlib.contextmanager
    def full(self, left=0):
        """Without room but for so many bytes."""
        path = os.path.join(self.disk, FILLER)
        with open(path, "wb", buffering=0) as file:
            with self.assertRaises(OSError):
                while True:
                    file.write(bytes(4096))
            file.truncate(os.fstat(file.fileno()).st_size - left)
        yield
        os.remove(path)

    def refused(self, *command, program=CANDIL, keep=lambda before, after: before == after):
        before = contents(self.disk)
        connect = ["--connect", self.daemon.socket] if program == CANDIL else []
        done = subprocess.run([program, *connect, *command], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, done)
        self.assertIn("No space left on device", done.stderr)
        after = contents(self.disk)
        self.assertTrue(keep(before, after), (before, after))
        return done

    def path(self, name):
        return os.path.join(self.disk, name)

    def grown(self, before, after):
        """Nothing has changed, and what came is whole."""
        whole = [name for name in after if name.endswith((".exr", ".png"))]
        for name in whole:
            subprocess.run([os.path.join(LIBEXEC, "candil-compare"), self.path(name), self.path(name)], check=True, capture_output=True)
        return before.items() <= after.items() and set(after) == set(before) | set(whole)

    def test_pictures(self):
        size = "--size", "64x64", "--spp", "1"
        out, other = self.path("out.exr"), self.path("other.exr")
        with self.full(8192):
            self.refused("render", "box", "-o", out, *size)
            failure = json.loads(self.refused("render", "box", "-o", out, *size, "--json").stdout)
            self.assertEqual((failure["error"]["name"], failure["exit"]), ("io", 1))
        self.daemon.candil("render", "box", "-o", out, *size)
        self.daemon.candil("render", "box", "-o", other, *size, "--seed", "2")
        with self.full():
            self.refused("render", "box", "-o", out, *size, "--seed", "3")
            self.refused("compare", out, other, "--error-image", self.path("error.png"))
            self.refused("compare", out, other, "--side-by-side", self.path("side.png"))
            self.refused("compare", out, other, "--html", self.path("page.html"))
        with self.full(81920):
            self.refused("sweep", "box", "-o", self.path("turn.{index}.exr"), "--orbit", "4,20,0.3", *size, keep=self.grown)
            self.assertNotIn("turn.3.exr", contents(self.disk))
        with self.full(16384):
            self.refused("inspect", "box", "-o", self.path("voxels"), *size[:2], keep=self.grown)
        self.daemon.candil("sweep", "box", "-o", self.path("turn.{index}.exr"), "--orbit", "4,20,0.3", *size)
        self.daemon.candil("render", "box", "-o", out, *size)

    def test_files_that_are_mounted(self):
        """The kernel lets nothing take their place: they are written over."""
        out, one = self.path("out.exr"), os.path.join(self.daemon.folder, "one")
        self.daemon.candil("render", "box", "-o", out, "--size", "16x16", "--spp", "1")
        for command, option in ((("render", "box", "--format", "png", "--size", "16x16", "--spp", "1"), "-o"),
                                (("compare", out, out), "--error-image"), (("compare", out, out), "--html")):
            for path in (one, self.path("two")):
                with open(path, "wb") as file:
                    file.write(b"before")
            subprocess.run(["mount", "--bind", one, self.path("two")], check=True)
            self.addCleanup(subprocess.run, ["umount", "-l", self.path("two")], check=True)
            self.daemon.candil(*command, option, self.path("two"))
            with open(one, "rb") as file:
                self.assertIn(file.read(4).lower(), (b"\x89png", b"<!do"), command)

    def test_study(self):
        plan = os.path.join(self.daemon.folder, "plan")
        with open(plan, "w", encoding="utf-8") as file:
            json.dump({"size": [32, 32], "seeds": 2, "repeats": 1, "reference": {"relmse": .5, "samples": 16},
                       "points": [{"technique": "pt", "settings": {"samples": [1, 2]}}]}, file)
        study = "study", "box", "-o", self.path("study"), "--plan", plan

        def only_runs(before, after):
            """Of what was there a list of runs alone has changed."""
            return all(before[name] == after[name] for name in before if not name.endswith(".jsonl"))
        with self.full(32768):
            self.refused(*study, keep=only_runs)
        self.daemon.candil(*study)
        with self.full():
            self.refused(self.path("study"), program=os.path.join(LIBEXEC, "candil-report"))
        shutil.rmtree(self.path("study"))

    def test_what_the_daemon_keeps(self):
        """Its log, what it learns and compiled shaders: it does without."""
        state, cache = self.path("state"), self.path("cache")
        os.mkdir(state)
        os.mkdir(cache)
        with self.full():
            log = open(self.path("log"), "wb")
            self.addCleanup(log.close)
            address = os.path.join(self.daemon.folder, "other.sock")
            process = subprocess.Popen([os.path.join(os.environ["CANDIL_BUILD"], "bin", "candild"), "--socket", address, "--state", state],
                                       stdin=subprocess.DEVNULL, stderr=log, env=dict(os.environ, MESA_SHADER_CACHE_DIR=cache))
            self.addCleanup(process.kill)
            for _ in range(100):
                done = subprocess.run([CANDIL, "--connect", address, "ping"], capture_output=True, check=False)
                if done.returncode == 0:
                    break
            scene, out = make.cornell(self.daemon.folder), os.path.join(self.daemon.folder, "kept.exr")
            for command in (("load", scene, "--name", "box"), ("render", "box", "-o", out, "--size", "16x16", "--spp", "1")):
                done = subprocess.run([CANDIL, "--connect", address, *command], capture_output=True, check=False)
                self.assertEqual(done.returncode, 0, done)
            stats = json.loads(subprocess.run([CANDIL, "--connect", address, "stats", "--json"], capture_output=True, check=True).stdout)
            self.assertEqual(stats["worker_starts"], 1)
            process.terminate()
            self.assertEqual(process.wait(), 0)
            self.assertEqual({name: os.path.getsize(self.path(name)) for name in contents(self.disk)}, {"log": 0})

    def test_socket(self):
        self.mount("64k", "nr_inodes=1")
        done = subprocess.run([os.path.join(os.environ["CANDIL_BUILD"], "bin", "candild"), "--no-state", "--socket", self.path("s")],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, done)
        self.assertRegex(done.stderr, "cannot listen at .*No space left on device")
        self.assertEqual(contents(self.disk), {})


def main():
    if INSIDE in os.environ:
        unittest.main()
    for options in (["-m"], ["-rm"]):
        if subprocess.run(["unshare", *options, "mount", "-t", "tmpfs", "tmpfs", "/mnt"], capture_output=True, check=False).returncode == 0:
            os.environ[INSIDE] = "1"
            os.execvp("unshare", ["unshare", *options, sys.executable, *sys.argv])
    print("no file system can be mounted here")
    sys.exit(SKIPPED)


if __name__ == "__main__":
    main()
