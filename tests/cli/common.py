"""What the tests of the clients share: programs, a small scene, a daemon, running things."""
import os
import subprocess
import sys
import tempfile
import time
import unittest

BUILD = os.environ["CANDIL_BUILD"]
SOURCE = os.environ["CANDIL_SOURCE"]
CANDIL = os.path.join(BUILD, "bin", "candil")
CANDILD = os.path.join(BUILD, "bin", "candild")
SKIPPED = 77

# A lamp above a floor before a wall.
OBJ = """mtllib room.mtl
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -0.5 2 -0.5
v 0.5 2 -0.5
v 0.5 2 0.5
v -0.5 2 0.5
v -1 2 -1
v 1 2 -1
usemtl floor
f 4 3 2 1
f 1 2 10 9
usemtl lamp
f 5 6 7 8
"""
MTL = "newmtl floor\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n"


def write_scene(folder):
    with open(os.path.join(folder, "room.obj"), "w") as file:
        file.write(OBJ)
    with open(os.path.join(folder, "room.mtl"), "w") as file:
        file.write(MTL)
    return os.path.join(folder, "room.obj")


def environment(folder):
    """No daemon at the default address, whatever runs on this machine."""
    return dict(os.environ, XDG_RUNTIME_DIR=folder)


def run(*arguments, env=None, cwd=None, binary=False):
    result = subprocess.run(arguments, stdin=subprocess.DEVNULL, capture_output=True, env=env, cwd=cwd, timeout=300)
    if not binary:
        result.stdout = result.stdout.decode()
    result.stderr = result.stderr.decode()
    return result


def skip_without_device():
    with tempfile.TemporaryDirectory() as folder:
        found = run(CANDIL, "doctor", "--json", env=environment(folder))
    if found.returncode == 5:
        print(found.stdout)
        sys.exit(SKIPPED)
    assert found.returncode == 0, found


class Daemon:
    """candild on a socket in `folder`, its log beside it."""

    def __init__(self, folder, *arguments, socket="test.sock"):
        self.socket = os.path.join(folder, socket)
        self.log = open(os.path.join(folder, "daemon.log"), "w+")
        self.process = subprocess.Popen([CANDILD, "--socket", self.socket, "--no-state", *arguments], stdin=subprocess.DEVNULL,
                                        stderr=self.log)

    def __enter__(self):
        deadline = time.monotonic() + 60
        while run(CANDIL, "--connect", self.socket, "ping").returncode != 0:
            if self.process.poll() is not None or time.monotonic() > deadline:
                self.log.seek(0)
                raise RuntimeError("candild did not start: " + self.log.read())
            time.sleep(0.02)
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=60)
        self.log.close()


class DaemonCase(unittest.TestCase):
    """A daemon and the small scene for all tests of a class, and a folder for each of them."""
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.scene = write_scene(cls.temporary.name)
        cls.daemon = Daemon(cls.temporary.name)
        cls.daemon.__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.daemon.__exit__(None, None, None)
        cls.temporary.cleanup()

    def setUp(self):
        self.folder = tempfile.mkdtemp(dir=self.temporary.name)
