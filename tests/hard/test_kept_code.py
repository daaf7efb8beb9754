"""Modules that a worker keeps on disk for the workers to come: they are read again, and whatever becomes of the files the picture has the
same bits and the files are whole afterwards."""
import glob
import os
import tempfile
import unittest

import make
from render import Daemon

CONSTANTS = slice(-400, -100)  # of a module: words of its last instructions


def cut(path):
    os.truncate(path, os.path.getsize(path) // 2)


def turned(path):
    with open(path, "r+b") as file:
        data = bytearray(file.read())
        data[CONSTANTS] = bytes(255 - b for b in data[CONSTANTS])
        file.seek(0)
        file.write(data)


def zeros(path):
    size = os.path.getsize(path)
    os.truncate(path, 0)
    os.truncate(path, size)


def led_astray(path):
    os.remove(path)
    os.symlink("/etc/passwd", path)


class KeptCode(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="candil-")
        self.addCleanup(folder.cleanup)
        self.cache = folder.name

    def picture(self):
        """The radiance of a daemon that has just been started."""
        with Daemon(environment={"MESA_SHADER_CACHE_DIR": self.cache}) as daemon:
            return daemon.render(make.cornell(daemon.folder), size=(16, 16), spp=2, arguments=("--technique", "pt")).radiance.tobytes()

    def modules(self):
        found = {}
        for path in glob.glob(os.path.join(glob.escape(self.cache), "candil_module_*")):
            self.assertFalse(os.path.islink(path), path)
            with open(path, "rb") as file:
                found[path] = file.read()
        return found

    def test_all(self):
        picture = self.picture()
        modules = self.modules()
        self.assertGreater(len(modules), 0)
        self.assertEqual(self.picture(), picture)
        self.assertEqual(self.modules(), modules)
        for damage in (cut, turned, zeros, led_astray, os.remove):
            with self.subTest(damage.__name__):
                for path in modules:
                    damage(path)
                self.assertEqual(self.picture(), picture)
                self.assertEqual(self.modules(), modules)
        # Modules in each other's places are none either.
        paths = list(modules)
        for path, other in zip(paths, paths[1:] + paths[:1]):
            with open(path, "wb") as file:
                file.write(modules[other])
        self.assertEqual(self.picture(), picture)
        self.assertEqual(self.modules(), modules)


if __name__ == "__main__":
    unittest.main()
