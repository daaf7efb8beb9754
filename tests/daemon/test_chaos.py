"""Sessions of mutated messages beside clients that mean it, with few descriptors: every request of those is answered once, the worker is
never lost, and nothing is left. CANDIL_SOAK multiplies the counts; at 50 it is 5,000 sessions, 5,000 requests and 500 loads and
unloads for each limit. CANDIL_SOAK_SECONDS has it go on for so long for each limit, CANDIL_REAL=1 with the real loader and worker in the place of
stand-ins."""
import os
import random
import socket
import time
import unittest

import crowd
import make
import wire
from fakes import FakeCase, render
from wire import pb

ROUNDS = 10 * int(os.environ.get("CANDIL_SOAK", "1"))
SESSIONS = 10  # of mutated messages, in a round
REQUESTS = 10  # of a client, in a round
CLIENTS = 2
SECONDS = float(os.environ.get("CANDIL_SOAK_SECONDS", "0"))
REAL = os.environ.get("CANDIL_REAL") == "1"


def streams():
    """What clients say, to be mutated. None of it names a scene that the others use."""
    hello = wire.packet(wire.HELLO, 1, pb.Hello(version_min=1, version_max=1, client="chaos"))
    load = wire.packet(wire.LOAD, 2, pb.Load(name="prey", path="box.gltf"), wire.FLAG_FD)
    camera = pb.Camera(eye=pb.Vec3(x=1), target=pb.Vec3(z=-1), vfov_degrees=40)
    asked = render("prey", progressive=True, seed=7, camera=camera, options=[pb.Option(name="pt.depth", value="5")])
    talk = [(wire.PING, pb.Ping(payload=b"abc")), (wire.RENDER, asked), (wire.SWEEP, pb.Sweep(render=render("prey"), cameras=[camera] * 3)),
            (wire.QUOTE, pb.Quote(render=render("prey"))), (wire.DESCRIBE, pb.Describe(name="prey")), (wire.LIST_SCENES, b""),
            (wire.STATS, b""), (wire.CANCEL, pb.Cancel(request=4)), (wire.UNLOAD, pb.Unload(name="prey"))]
    return hello, load, [wire.packet(kind, 3 + i, body) for i, (kind, body) in enumerate(talk)]


def mutate(data, chance):
    """A few bytes changed, dropped, doubled or put in."""
    data = bytearray(data)
    for _ in range(chance.choice((0, 1, 1, 2, 4, 8))):
        at = chance.randrange(len(data)) if data else 0
        length = chance.choice((1, 1, 2, 4, 16, 64))
        how = chance.randrange(5)
        if how == 0 and data:
            data[at] ^= 1 << chance.randrange(8)
        elif how == 1:
            del data[at:at + length]
        elif how == 2:
            data[at:at] = data[at:at + length]
        elif how == 3:
            data[at:at] = chance.randbytes(length)
        elif data:
            data[at:at + length] = chance.choice((b"\x00", b"\xff", b"\x7f", b"\x80")) * length
    return bytes(data)


class Chaos(FakeCase):
    most_descriptors = 1024
    environment = {"FAKE_STEP_US": "0", "FAKE_SPARSE": "1"}
    libexec = None if REAL else FakeCase.libexec

    def prepare(self):
        self.daemon.environment["CANDIL_LOG"] = "error"  # a line a message would fill a disk
        self.chance = random.Random(self.most_descriptors)
        if REAL:
            make.cornell(self.scenes, name="box.gltf")
        self.hello, self.load, self.talk = streams()
        self.counts = dict.fromkeys(("sessions", "replies", "requests", "refused", "loads"), 0)

    def assert_well_formed(self, replies):
        for reply in replies:
            self.counts["replies"] += 1
            if reply.kind == wire.ERROR:
                self.assertGreater(len(reply.body.name) * len(reply.body.message), 10)

    def session(self):
        """One session of mutated messages. It is read to its end, or left with what waits for it."""
        chance = self.chance
        data = b"".join([self.load] * chance.randrange(2) + chance.choices(self.talk, k=chance.randrange(1, 12)))
        # Most get past the hello.
        data = self.hello + mutate(data, chance) if chance.random() < .9 else mutate(self.hello + data, chance)
        folder = os.open(self.scenes, os.O_RDONLY | os.O_DIRECTORY)
        self.counts["sessions"] += 1
        with wire.Connection(self.daemon.socket, greet=False) as connection:
            try:
                while data:
                    piece = chance.choice((1, 16, 100, 4096, 65536))
                    connection.send_with_fds(data[:piece], [folder] * chance.choice((0, 0, 1, 1, 3, 9)))
                    data = data[piece:]
                if chance.random() < .6:
                    connection.sock.shutdown(socket.SHUT_WR)
                    self.assert_well_formed(connection.drained())
            except (BrokenPipeError, ConnectionResetError):
                pass  # refused in the middle of what it had to say
            finally:
                os.close(folder)

    def ask(self, client):
        """Many requests at once, of every kind; their ids, and those that are cancelled in between."""
        chance = self.chance
        asked = []
        for _ in range(REQUESTS):
            side = chance.choice((1, 8, 32, 100) if REAL else (1, 8, 100, 700))
            picture = render("kept", width=side, height=side, samples=chance.randrange(1, 9), progressive=chance.random() < .3)
            kind, body = chance.choice(((wire.RENDER, picture), (wire.RENDER, picture), (wire.PING, pb.Ping(payload=b"x")),
                                        (wire.SWEEP, pb.Sweep(render=picture, cameras=[pb.Camera()] * 3)), (wire.STATS, b""),
                                        (wire.QUOTE, pb.Quote(render=picture)), (wire.DESCRIBE, pb.Describe(name="kept")),
                                        (wire.RENDER, render("nobody")), (wire.RENDER, render("kept", width=1 << 20))))
            asked.append(client.send(kind, body))
            if chance.random() < .1:
                asked.append(client.send(wire.CANCEL, pb.Cancel(request=chance.choice(asked))))
        return asked

    def hear(self, client, asked):
        """Each has one end. What comes after a last question shows whether anything came twice."""
        goes_on = (wire.ACCEPTED, wire.PROGRESS, wire.IMAGE, wire.FRAME_CHUNK)
        for request in asked:
            replies = client.follow(request, until=[kind for kind in wire.BODIES if kind not in goes_on])
            self.counts["requests"] += 1
            self.counts["refused"] += replies[-1].kind == wire.ERROR
            self.assert_well_formed(replies)
        self.assertEqual(client.ask(wire.PING).kind, wire.PONG)
        self.assertEqual(client.waiting, [])

    def pass_through(self, client):
        """A scene comes and goes, and all that the mutated ones have left."""
        reply = client.receive_for(client.send_load("passing", self.scenes, "box.gltf"))
        self.counts["loads"] += reply.kind == wire.SCENE_INFO
        if reply.kind != wire.SCENE_INFO:
            self.assert_error(reply, "too-many-scenes")
        for scene in client.ask(wire.LIST_SCENES).body.scenes:
            if scene.name != "kept":
                client.ask(wire.UNLOAD, pb.Unload(name=scene.name))

    def round(self):
        asked = [(client, self.ask(client)) for client in self.clients]
        for _ in range(SESSIONS):
            self.session()
        for client, requests in asked:
            self.hear(client, requests)
        self.pass_through(self.clients[0])

    def level(self):
        observer = self.clients[0]

        def held():
            stats = observer.stats()
            return (self.daemon.descriptors_at_rest(), stats.connections, stats.jobs, stats.scenes, stats.image_bytes, stats.buffered_bytes,
                    stats.worker_starts)
        wire.wait_for(lambda: held() == (self.idle, CLIENTS, 0, 1, 0, 0, 1), f"it is level, with {self.idle} descriptors")
        return self.daemon.rss_kib()

    def test_who_means_it_is_served(self):
        self.clients = [self.connect(elsewhere=True) for _ in range(CLIENTS)]
        self.clients[0].load("kept", self.scenes, "box.gltf")
        self.clients[0].follow(self.clients[0].send(wire.RENDER, render("kept")))
        self.idle = self.daemon.descriptors_at_rest()
        for _ in range(max(5, ROUNDS // 5)):
            self.round()
        memory = self.level()
        end = time.monotonic() + SECONDS
        rounds = 0
        while rounds < ROUNDS or time.monotonic() < end:
            self.round()
            rounds += 1
        grown = self.level() - memory
        print(f"{self.most_descriptors} descriptors: {self.counts}, {memory} KiB and {grown} more")
        self.assertLess(grown, crowd.growth_allowed_kib())
        self.assertGreater(self.counts["loads"], ROUNDS // 2)
        self.assertGreater(self.counts["requests"] - self.counts["refused"], 10 * ROUNDS)


class ChaosAt256(Chaos):
    most_descriptors = 256


class ChaosAt64(Chaos):
    most_descriptors = 64


if __name__ == "__main__":
    unittest.main()
