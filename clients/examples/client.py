#!/usr/bin/env python3
"""Speaks candil's protocol without libcandil: Google's protobuf runtime and a socket.

    protoc --python_out=. -I protocol protocol/candil.proto     # makes candil_pb2.py
    PYTHONPATH=. python3 client.py SOCKET SCENE_FILE OUT.png

Every message is a header of 16 bytes and a body; protocol/PROTOCOL.md is the manual.
"""
import os
import signal
import socket
import struct
import sys

try:
    import candil_pb2 as pb
except ModuleNotFoundError as missing:
    if missing.name != "candil_pb2":
        raise
    sys.exit("client.py: there is no module candil_pb2: make it with\n"
             "  protoc --python_out=. -I protocol protocol/candil.proto\n"
             "and put its folder into PYTHONPATH")

HEADER = struct.Struct("<IBBHII")  # magic, version, type, flags, length, request id
MAGIC, VERSION, FLAG_FD = 0x4C444E43, 1, 1
HELLO, LOAD, UNLOAD, RENDER, CANCEL = 0x01, 0x03, 0x04, 0x07, 0x08
HELLO_REPLY, SCENE_INFO, OK, ACCEPTED, PROGRESS, IMAGE, CHUNK, DONE, ERROR = (
    0x81, 0x83, 0x84, 0x86, 0x87, 0x88, 0x89, 0x8A, 0xFF)


class Refused(Exception):
    pass


class Client:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self.socket.connect(path)
        except OSError as error:
            raise ConnectionError(f"cannot connect to {path}: {error.strerror or error}") from error
        self.last_id = 0
        self.stopped = False
        self.call(HELLO, pb.Hello(version_min=VERSION, version_max=VERSION, client="client.py"), HELLO_REPLY,
                  pb.HelloReply)

    def send(self, kind, message, fd=None):
        """Send a request and return its id. A descriptor travels beside the header's first byte."""
        self.last_id += 1
        body = message.SerializeToString()
        data = HEADER.pack(MAGIC, VERSION, kind, FLAG_FD if fd is not None else 0, len(body), self.last_id) + body
        if fd is not None:
            sent = socket.send_fds(self.socket, [data], [fd])
            data = data[sent:]
        self.socket.sendall(data)
        return self.last_id

    def read(self, count):
        data = bytearray()
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise ConnectionError("the daemon closed the connection")
            data += part
        return bytes(data)

    def receive(self, request):
        """The type and body of the next reply to a request."""
        while True:
            magic, version, kind, _, length, about = HEADER.unpack(self.read(HEADER.size))
            if magic != MAGIC or version != VERSION:
                raise ConnectionError("this is no candil daemon")
            body = self.read(length)
            if kind == ERROR and about in (0, request):
                error = pb.Error.FromString(body)
                raise Refused(f"{error.message} ({error.name})")
            if about == request:
                return kind, body

    def call(self, kind, message, reply_kind, reply_type, fd=None):
        kind, body = self.receive(self.send(kind, message, fd))
        if kind != reply_kind:
            raise ConnectionError(f"reply 0x{kind:02x} was not expected")
        return reply_type.FromString(body)

    def load(self, name, path):
        """Load a local file: the daemon gets its folder as a descriptor."""
        folder, file = os.path.split(os.path.realpath(path))
        fd = os.open(folder, os.O_PATH | os.O_DIRECTORY)
        try:
            return self.call(LOAD, pb.Load(name=name, path=file), SCENE_INFO, pb.SceneInfo, fd)
        finally:
            os.close(fd)

    def unload(self, name):
        self.call(UNLOAD, pb.Unload(name=name), OK, pb.Ok)

    def render(self, message):
        """Returns the final image's bytes and the Done message. Once `stopped` is set, the render is cancelled."""
        request = self.send(RENDER, message)
        frame, image, final, cancelled = None, bytearray(), None, False
        while True:
            kind, body = self.receive(request)
            if self.stopped and not cancelled:
                cancelled = True
                self.send(CANCEL, pb.Cancel(request=request))
            if kind == IMAGE:
                frame, image = pb.ImageFrame.FromString(body), bytearray()
            elif kind == CHUNK:
                image += body
                if frame.final and len(image) == frame.bytes:
                    final = bytes(image)
            elif kind == DONE:
                return final, pb.Done.FromString(body)


    def stop(self, *_):
        self.stopped = True


def look_at(info):
    """A view of the whole scene from its front."""
    low, high = info.bounds_min, info.bounds_max
    target = pb.Vec3(x=(low.x + high.x) / 2, y=(low.y + high.y) / 2, z=high.z)
    away = 1.5 * max(high.x - low.x, high.y - low.y)
    return pb.Camera(eye=pb.Vec3(x=target.x, y=target.y, z=target.z + away), target=target, up=pb.Vec3(y=1),
                     vfov_degrees=40)


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: client.py SOCKET SCENE_FILE OUT.png")
    path, scene, out = sys.argv[1:]
    try:
        client = Client(path)
        # A program that ended by these would leave its scene in the daemon.
        signal.signal(signal.SIGINT, client.stop)
        signal.signal(signal.SIGTERM, client.stop)
        info = client.load("client.py", scene)
        try:
            image, done = client.render(pb.Render(
                scene="client.py", width=128, height=128, samples=16, format=pb.FORMAT_PNG,
                background=pb.Vec3(x=0.5, y=0.5, z=0.5), camera=None if info.camera_count else look_at(info)))
        finally:
            client.unload("client.py")
    except (OSError, Refused) as error:
        sys.exit(f"client.py: {error}")
    try:
        with open(out, "wb") as file:
            file.write(image)
    except OSError as error:
        sys.exit(f"client.py: {out}: {error.strerror}")
    print(f"{out}: {info.triangles} triangle{'s'[:info.triangles != 1]}, {done.samples} samples, {done.elapsed_us / 1000:.1f} ms")


if __name__ == "__main__":
    main()
