"""A daemon with the stand-in loader and worker of tests/daemon, and scenes for them."""
import os
import unittest

import wire
from wire import pb

LIBEXEC = wire.STAND_INS


def pattern(count, seed):
    return bytes((i * 31 + seed) % 256 for i in range(count))


def render(scene="box", **fields):
    values = dict(width=8, height=8, samples=4, technique=pb.TECHNIQUE_PT)
    values.update(fields)
    return pb.Render(scene=scene, **values)


def endless(scene="box", **fields):
    """A render that no test sees the end of."""
    return render(scene, samples=1 << 24, progress_ms=1, **fields)


class FakeCase(unittest.TestCase):
    """A fresh daemon a test. Set `environment`, `arguments` and `most_descriptors` in the class."""
    environment = {}
    arguments = ()
    most_descriptors = None
    libexec = LIBEXEC

    def setUp(self):
        self.daemon = wire.Daemon(*self.arguments, libexec=self.libexec, environment=self.environment,
                                  most_descriptors=self.most_descriptors)
        self.addCleanup(self.stop)
        self.scenes = os.path.join(self.daemon.folder, "scenes")
        os.mkdir(self.scenes)
        self.write("box.gltf", "ok")
        self.prepare()
        self.daemon.start()

    def prepare(self):
        pass

    def stop(self):
        """Whatever a test did, the daemon ends in good order: under the sanitizers that includes its leaks."""
        status = self.daemon.end()
        log = self.daemon.log_text()
        self.daemon.stop()
        self.assertEqual(status, 0, log)
        self.assertNotIn("Sanitizer", log)
        self.assertNotIn("runtime error", log)

    def write(self, name, text):
        path = os.path.join(self.scenes, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write(text)

    def connect(self, **keywords):
        connection = self.daemon.connect(**keywords)
        self.addCleanup(connection.close)
        return connection

    def with_box(self):
        connection = self.connect()
        connection.load("box", self.scenes, "box.gltf")
        return connection

    def assert_error(self, reply, name):
        self.assertEqual(reply.kind, wire.ERROR, reply)
        self.assertEqual(reply.body.name, name, reply.body.message)
        self.assertGreater(len(reply.body.message), 10)

    def assert_serves(self):
        """The daemon lives and others are served."""
        with self.daemon.connect() as other:
            self.assertEqual(other.ask(wire.PING, pb.Ping(payload=b"x")).body.payload, b"x")
