"""Pictures for tests: one daemon a test program, rendered through the command line, read back as numpy arrays.

    daemon = Daemon()

    def setUpModule():
        unittest.enterModuleContext(daemon)

    picture = daemon.render(make.cornell(daemon.folder), size=(64, 64), spp=16)     # Picture
    picture.radiance[y, x]                                                          # float32, W/(m2 sr)
"""
import json
import os
import socket
import subprocess
import sys
import tempfile
import time

import numpy
import OpenImageIO as oiio

BUILD = os.environ["CANDIL_BUILD"]
SOURCE = os.environ["CANDIL_SOURCE"]
CANDIL = os.path.join(BUILD, "bin", "candil")
SKIPPED = 77
EXIT_DEVICE = 5
# By technique, how a picture is worked on in other pieces: samples in a dispatch, rows at once.
PIECES = {"pt": {"pt.batch": 3}, "direct": {"direct.rows": 3}, "vct": {"direct.rows": 3}, "radiosity": {"direct.rows": 3}}


class Failed(Exception):
    """candil ended with another status than 0."""

    def __init__(self, status, text):
        super().__init__(f"exit {status}: {text}")
        self.status = status
        self.text = text


def skip(reason):
    """End this program as one that needs what is not here. At once: to unittest a SystemExit is a test that failed."""
    print("skipped:", reason, flush=True)
    for daemon in list(Daemon.running):
        daemon.stop()
    os._exit(SKIPPED)


class Picture:
    """An EXR file as arrays: radiance (h, w, 3), and by name each other channel (h, w). Of twice(): whether both were the same."""
    same_bits = None

    def __init__(self, path, report):
        self.report = report
        image = oiio.ImageInput.open(path)
        if image is None:
            raise RuntimeError(oiio.geterror())
        spec = image.spec()
        self.metadata = {a.name: a.value for a in spec.extra_attribs}
        pixels = image.read_image(format=oiio.FLOAT)
        image.close()
        pixels = numpy.asarray(pixels, dtype=numpy.float32).reshape(spec.height, spec.width, spec.nchannels)
        self.channels = {name: pixels[:, :, i] for i, name in enumerate(spec.channelnames)}
        self.radiance = numpy.stack([self.channels[c] for c in "RGB"], axis=2)

    def mean(self):
        return float(self.radiance.mean(dtype=numpy.float64))

    def non_finite(self):
        """Pixels that are no numbers, and samples that were left out for it."""
        return int((~numpy.isfinite(self.radiance)).any(axis=2).sum()) + self.report["non_finite_samples"]


class Daemon:
    """candild with the build's own loader and worker, from __enter__ to __exit__. `folder`, a path, goes with it: it has the socket
    and the log, and room for scenes and pictures. Its end fails if a sanitizer or a validation layer had something to say."""
    running = []  # all of this program

    def __init__(self, *arguments, environment=None, build=BUILD):
        self.programs = os.path.join(build, "bin")
        self.arguments = arguments
        self.environment = dict(os.environ, **(environment or {}))

    def __enter__(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="candil-")
        self.folder = self.temporary.name
        self.socket = os.path.join(self.folder, "socket")
        self.log = open(os.path.join(self.folder, "log"), "w+")
        self.process = subprocess.Popen([os.path.join(self.programs, "candild"), "--socket", self.socket, "--no-state",
                                         *self.arguments],
                                        stderr=self.log, stdin=subprocess.DEVNULL, env=self.environment)
        Daemon.running.append(self)
        deadline = time.monotonic() + 60
        while not self.answers():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError("candild did not start: " + self.read_log())
            time.sleep(0.01)
        return self

    def answers(self):
        """Does it listen yet? The socket is there a moment earlier."""
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
                probe.connect(self.socket)
            return True
        except OSError:
            return False

    def stop(self):
        """(exit status, log)"""
        Daemon.running.remove(self)
        self.process.terminate()
        status = self.process.wait(timeout=60)
        text = self.read_log()
        self.log.close()
        self.temporary.cleanup()
        return status, text

    def __exit__(self, kind, value, trace):
        status, text = self.stop()
        if kind is not None:
            sys.stderr.write(text)
        assert status == 0, f"candild ended with {status}: {text}"
        for word in ("ERROR: AddressSanitizer", "runtime error:", "ERROR: LeakSanitizer", "validation:"):
            assert word not in text, text

    def read_log(self):
        self.log.flush()
        with open(self.log.name) as f:
            return f.read()

    def candil(self, *arguments, check=True):
        """Run the command line against this daemon. Returns (status, standard output, standard error)."""
        done = subprocess.run([os.path.join(self.programs, "candil"), "--connect", self.socket, *arguments],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.environment,
                              timeout=590)
        out, err = done.stdout.decode(), done.stderr.decode()
        if done.returncode == EXIT_DEVICE and "no Vulkan" in err:
            skip(err)
        if check and done.returncode != 0:
            raise Failed(done.returncode, err)
        return done.returncode, out, err

    def stats(self):
        return json.loads(self.candil("stats", "--json")[1])

    def render(self, scene, size=(64, 64), spp=16, camera=None, options=None, arguments=(), default_light=False):
        """Render to a float EXR. `camera`: a name or ten numbers. `options`: {"pt.depth": 3}. Unlike the command line by itself, a
        test that says nothing asks for no default light: what has no light is black."""
        path = os.path.join(self.folder, f"{time.monotonic_ns()}.exr")
        command = ["render", scene, "-o", path, "--float", "--json", "--size", f"{size[0]}x{size[1]}", "--spp", str(spp)]
        if camera is not None:
            command += ["--camera", camera if isinstance(camera, str) else ",".join(repr(float(c)) for c in camera)]
        if not default_light:
            command.append("--no-default-light")
        for name, value in (options or {}).items():
            command += ["--set", f"{name}={value}"]
        _, out, _ = self.candil(*command, *arguments)
        picture = Picture(path, json.loads(out))
        os.remove(path)
        return picture

    def twice(self, scene, *more, options=None, **named):
        """render(), and once more in other pieces, of which the picture must know nothing."""
        picture = self.render(scene, *more, options=options, **named)
        again = self.render(scene, *more, options={**(options or {}), **PIECES[picture.metadata["candil/technique"]]}, **named)
        picture.same_bits = all(picture.channels[name].tobytes() == again.channels[name].tobytes() for name in picture.channels)
        return picture


def rel(value, expected):
    return abs(value / expected - 1)
