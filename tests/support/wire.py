"""A daemon in a temporary folder, and a raw client of its protocol: bytes, headers, Google's own protobuf runtime."""
import array
import os
import resource
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time

import candil_pb2 as pb

MAGIC = 0x4C444E43
VERSION = 1
HEADER = struct.Struct("<IBBHII")
FLAG_FD = 1
PATIENCE = 120  # seconds; a test that waits so long has failed

(HELLO, PING, LOAD, UNLOAD, LIST_SCENES, DESCRIBE, RENDER, CANCEL, STATS, SWEEP, QUOTE) = range(1, 12)
(HELLO_REPLY, PONG, SCENE_INFO, OK, SCENE_LIST, ACCEPTED, PROGRESS, IMAGE, FRAME_CHUNK, DONE,
 STATS_REPLY, QUOTE_REPLY) = range(0x81, 0x8D)
ERROR = 0xFF

BODIES = {HELLO_REPLY: pb.HelloReply, PONG: pb.Ping, SCENE_INFO: pb.SceneInfo, OK: pb.Ok, SCENE_LIST: pb.SceneList,
          ACCEPTED: pb.Accepted, PROGRESS: pb.Progress, IMAGE: pb.ImageFrame, DONE: pb.Done,
          STATS_REPLY: pb.StatsReply, QUOTE_REPLY: pb.QuoteReply, ERROR: pb.Error}

BUILD = os.environ.get("CANDIL_BUILD", ".")
STAND_INS = os.path.join(BUILD, "tests", "fake")


def header(kind, length, request, flags=0, version=VERSION, magic=MAGIC):
    return HEADER.pack(magic, version, kind, flags, length, request)


def packet(kind, request, body=b"", flags=0):
    if not isinstance(body, (bytes, bytearray)):
        body = body.SerializeToString()
    return header(kind, len(body), request, flags) + bytes(body)


class Closed(Exception):
    """The daemon closed the connection."""


class Reply:
    def __init__(self, kind, flags, request, raw):
        self.kind, self.flags, self.request, self.raw = kind, flags, request, raw
        self.body = None
        if kind in BODIES:
            self.body = BODIES[kind]()
            self.body.ParseFromString(raw)

    def __repr__(self):
        return f"<{self.kind:#x} request {self.request} {self.body if self.body is not None else len(self.raw)}>"


class Connection:
    """Frames messages, nothing more. `greet=False` leaves the hello to the test."""

    def __init__(self, path=None, greet=True, sock=None):
        self.sock = sock or socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(PATIENCE)
        if path is not None:
            self.sock.connect(path)
        self.last = 0
        self.waiting = []
        if greet:
            self.send(HELLO, pb.Hello(version_min=1, version_max=1, client="wire.py"))
            self.hello = self.receive(HELLO_REPLY).body

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.sock.close()

    def send(self, kind, body=b"", request=None, flags=0):
        """Send a message; its request id is returned."""
        if request is None:
            self.last += 1
            request = self.last
        self.sock.sendall(packet(kind, request, body, flags))
        return request

    def send_with_fds(self, data, fds):
        self.sock.sendmsg([data], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", fds))])

    def send_load(self, name, folder, file, flags=FLAG_FD, **fields):
        """LOAD by descriptor of the folder."""
        self.last += 1
        fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            self.send_with_fds(packet(LOAD, self.last, pb.Load(name=name, path=file, **fields), flags), [fd])
        finally:
            os.close(fd)
        return self.last

    def read(self, count):
        data = bytearray()
        while len(data) < count:
            try:
                piece = self.sock.recv(count - len(data))
            except ConnectionError as gone:
                raise Closed from gone
            if not piece:
                raise Closed
            data += piece
        return bytes(data)

    def receive(self, kind=None, request=None):
        """The next message; checked to be of `kind` and for `request` if given."""
        magic, version, got, flags, length, got_request = HEADER.unpack(self.read(HEADER.size))
        assert magic == MAGIC and version == VERSION, "the daemon's header is not ours"
        reply = Reply(got, flags, got_request, self.read(length))
        assert kind is None or got == kind, f"wanted {kind:#x}, got {reply}"
        assert request is None or got_request == request, f"wanted request {request}, got {reply}"
        return reply

    def ask(self, kind, body=b"", **keywords):
        """Send a message and wait for a reply of the same id, keeping others for receive_for."""
        return self.receive_for(self.send(kind, body, **keywords))

    def receive_for(self, request):
        for i, reply in enumerate(self.waiting):
            if reply.request == request:
                return self.waiting.pop(i)
        while True:
            reply = self.receive()
            if reply.request == request:
                return reply
            self.waiting.append(reply)

    def follow(self, request, until=(DONE, ERROR)):
        """All messages of a render, to its end."""
        replies = [self.receive_for(request)]
        while replies[-1].kind not in until:
            replies.append(self.receive_for(request))
        return replies

    def stats(self):
        return self.ask(STATS).body

    def load(self, name, folder, file, **fields):
        reply = self.receive_for(self.send_load(name, folder, file, **fields))
        assert reply.kind == SCENE_INFO, reply
        return reply.body

    def drained(self):
        """Everything up to the daemon's end of the stream, then closed."""
        replies = []
        try:
            while True:
                replies.append(self.receive())
        except Closed:
            return replies


def images(replies):
    """(frame, bytes) of each image among a render's messages."""
    found = []
    for reply in replies:
        if reply.kind == IMAGE:
            found.append((reply.body, bytearray()))
        elif reply.kind == FRAME_CHUNK:
            found[-1][1].extend(reply.raw)
    return found


def rss_kib(pid):
    """Resident memory of a process."""
    with open(f"/proc/{pid}/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:"))


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def connected_elsewhere(path):
    """A socket that another process has connected, which has ended since."""
    ours, theirs = socket.socketpair()
    child = os.fork()
    if child == 0:
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
                sock.connect(path)
                socket.send_fds(theirs, [b"x"], [sock.fileno()])
        finally:
            os._exit(0)
    theirs.close()
    with ours:
        fds = socket.recv_fds(ours, 1, 1)[1]
    os.waitpid(child, 0)
    return socket.socket(fileno=fds[0])


class Daemon:
    """candild on a socket in a temporary folder. `libexec` None: the build's own loader and worker. `most_descriptors` None: as
    many as we may have ourselves."""

    def __init__(self, *arguments, libexec=None, environment=None, program=None, most_descriptors=None):
        self.most_descriptors = most_descriptors
        self.folder = tempfile.mkdtemp(prefix="candil-test-")
        self.socket = os.path.join(self.folder, "candil.sock")
        self.log = os.path.join(self.folder, "log")
        self.program = program or os.path.join(BUILD, "bin", "candild")
        # What an earlier run has learned is no part of a test.
        self.arguments = list(arguments) if "--state" in arguments else ["--no-state", *arguments]
        if libexec:
            self.arguments += ["--libexec", libexec]
        self.environment = dict(os.environ, FAKE_STATE=self.folder, CANDIL_LOG="debug", **(environment or {}))
        if libexec == STAND_INS:  # they write, and children of the daemon do so in the drivers' folder alone
            self.environment["MESA_SHADER_CACHE_DIR"] = self.folder
        self.process = None

    def start(self):
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen([self.program, "--socket", self.socket] + self.arguments, stderr=log,
                                            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=self.environment,
                                            preexec_fn=self.limit)
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if self.process.poll() is not None:
                raise RuntimeError(f"candild ended with {self.process.returncode}:\n{self.log_text()}")
            try:
                with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
                    probe.connect(self.socket)
                return self
            except OSError:
                time.sleep(0.01)
        raise RuntimeError("candild does not answer")

    def limit(self):
        if self.most_descriptors:
            resource.setrlimit(resource.RLIMIT_NOFILE, (self.most_descriptors, self.most_descriptors))

    def connect(self, elsewhere=False, **keywords):
        """`elsewhere`: by a process of its own, which is another peer."""
        if elsewhere:
            return Connection(sock=connected_elsewhere(self.socket), **keywords)
        return Connection(self.socket, **keywords)

    def alive(self):
        return self.process.poll() is None

    def log_text(self):
        with open(self.log, errors="replace") as log:
            return log.read()

    def rss_kib(self):
        return rss_kib(self.process.pid)

    def descriptors(self):
        return descriptors(self.process.pid)

    def descriptors_at_rest(self):
        """Once no child but the worker is left to be collected."""
        folder = f"/proc/{self.process.pid}/fd"

        def children():
            count = 0
            for number in os.listdir(folder):
                try:
                    count += "pidfd" in os.readlink(os.path.join(folder, number))
                except FileNotFoundError:  # closed meanwhile
                    pass
            return count
        wait_for(lambda: children() == 1, "the loaders have been collected")
        return self.descriptors()

    def end(self, how=signal.SIGTERM):
        """End it and give its exit status; its folder stays. Twice is allowed."""
        if self.process and self.process.poll() is None:
            self.process.send_signal(how)
            try:
                self.process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        return self.process.returncode if self.process else None

    def stop(self, how=signal.SIGTERM):
        """End it, give its exit status, remove its folder. Twice is allowed."""
        status = self.end(how)
        shutil.rmtree(self.folder, ignore_errors=True)
        return status

    def __enter__(self):
        return self.start()

    def __exit__(self, *_):
        self.stop()


def wait_for(condition, what):
    """Until the condition holds; the time allowed is a failure's, not a result's."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.005)
    raise AssertionError(f"never happened: {what}")
