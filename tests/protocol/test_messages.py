"""What messages say: greeting, wrong bodies, wrong arguments, ids, limits."""
import unittest

import wire
from fakes import FakeCase, endless, render
from wire import pb


class Hello(FakeCase):
    def last_words(self, connection, name):
        replies = connection.drained()
        self.assertEqual(len(replies), 1, replies)
        self.assert_error(replies[0], name)

    def test_message_before_hello(self):
        connection = self.connect(greet=False)
        connection.send(wire.PING)
        self.last_words(connection, "hello-first")

    def test_unknown_message_before_hello(self):
        connection = self.connect(greet=False)
        connection.send(0x55)
        self.last_words(connection, "hello-first")

    def test_what_the_daemon_says(self):
        hello = self.connect().hello
        self.assertEqual(hello.version, 1)
        self.assertTrue(hello.server.startswith("candild "))
        self.assertEqual(hello.max_message_bytes, 64 * 1024)
        self.assertEqual(hello.max_pixels, 64 * 1024 * 1024)
        self.assertEqual(hello.max_jobs_per_connection, 16)

    def test_highest_common_version(self):
        connection = self.connect(greet=False)
        connection.send(wire.HELLO, pb.Hello(version_min=0, version_max=999))
        self.assertEqual(connection.receive(wire.HELLO_REPLY).body.version, 1)

    def test_no_common_version(self):
        for least, most in ((2, 9), (0, 0)):
            connection = self.connect(greet=False)
            connection.send(wire.HELLO, pb.Hello(version_min=least, version_max=most))
            self.last_words(connection, "bad-version")

    def test_versions_upside_down(self):
        connection = self.connect(greet=False)
        connection.send(wire.HELLO, pb.Hello(version_min=2, version_max=1))
        self.last_words(connection, "bad-message")

    def test_garbage(self):
        connection = self.connect(greet=False)
        connection.send(wire.HELLO, b"\xff\xff\xff")
        self.last_words(connection, "bad-message")

    def test_second_hello(self):
        connection = self.connect()
        self.assert_error(connection.ask(wire.HELLO, pb.Hello(version_min=1, version_max=1)), "bad-message")
        self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)


class Bodies(FakeCase):
    def test_garbage_in_every_message(self):
        connection = self.connect()
        for kind in (wire.PING, wire.LOAD, wire.UNLOAD, wire.LIST_SCENES, wire.DESCRIBE, wire.RENDER, wire.CANCEL,
                     wire.STATS):
            for body in (b"\xff\xff\xff", b"\x0a", b"\x0a\x7fshort", b"\x00", b"\x0b"):
                self.assert_error(connection.ask(kind, body), "bad-message")
        self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)

    def test_unknown_field_is_ignored(self):
        connection = self.connect()
        unknown = b"\x98\x06\x2a" + b"\xa2\x06\x03abc"  # 99: 42, 100: "abc"
        body = unknown + pb.Ping(payload=b"here").SerializeToString() + unknown
        self.assertEqual(connection.ask(wire.PING, body).body.payload, b"here")
        self.assertEqual(connection.ask(wire.STATS, unknown).kind, wire.STATS_REPLY)

    def test_string_past_its_bound(self):
        connection = self.connect()
        self.assert_error(connection.ask(wire.DESCRIBE, pb.Describe(name="n" * 64)), "bad-message")
        self.assert_error(connection.ask(wire.DESCRIBE, pb.Describe(name="n" * 63)), "scene-not-found")

    def test_too_many_options(self):
        connection = self.with_box()
        options = [pb.Option(name=f"pt.o{i}", value="1") for i in range(17)]
        self.assert_error(connection.ask(wire.RENDER, render(options=options)), "limit")

    def test_too_many_edits(self):
        connection = self.with_box()
        many = (dict(lights=[pb.Light()] * 33), dict(materials=[pb.MaterialEdit(name="m")] * 33),
                dict(nodes=[pb.NodeEdit(name="n")] * 33))
        for edits in many:
            self.assert_error(connection.ask(wire.RENDER, render(edits=pb.Edits(**edits))), "limit")
        most = pb.Edits(materials=[pb.MaterialEdit(name="m" * 63, base_color=pb.Vec3(x=1))] * 32,
                        nodes=[pb.NodeEdit(name="n" * 63, translation=pb.Vec3(x=1, y=2, z=3))] * 32)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render(edits=most)))[-1].kind, wire.DONE)

    def test_ping_keeps_its_payload(self):
        connection = self.connect()
        payload = bytes(range(256))
        self.assertEqual(connection.ask(wire.PING, pb.Ping(payload=payload)).body.payload, payload)
        self.assert_error(connection.ask(wire.PING, pb.Ping(payload=payload + b"x")), "bad-message")


class Arguments(FakeCase):
    def refuse(self, name, **fields):
        connection = self.with_box()
        self.assert_error(connection.ask(wire.RENDER, render(**fields)), name)
        self.assertEqual(connection.stats().jobs, 0)

    def test_a_billion_pixels(self):
        before = self.daemon.rss_kib()
        self.refuse("limit", width=31623, height=31623)
        self.refuse("limit", width=16384, height=16384)
        self.assertLess(self.daemon.rss_kib(), before + 20000)

    def test_no_pixels(self):
        self.refuse("bad-argument", width=0)

    def test_too_many_samples(self):
        self.refuse("limit", samples=(1 << 24) + 1)

    def test_files_that_are_no_pictures(self):
        for kind in (pb.FORMAT_PLY, pb.FORMAT_MTX):
            self.refuse("unsupported", technique=pb.TECHNIQUE_PT, format=kind)
            self.refuse("unsupported", format=kind)
            self.refuse("bad-argument", technique=pb.TECHNIQUE_RADIOSITY, format=kind, aovs=1)
            self.refuse("bad-argument", technique=pb.TECHNIQUE_RADIOSITY, format=kind, progressive=True)
            connection = self.connect()
            file = render("box", technique=pb.TECHNIQUE_RADIOSITY, format=kind)
            self.assert_error(connection.ask(wire.SWEEP, pb.Sweep(render=file, cameras=[pb.Camera()])), "bad-argument")
            self.assert_error(connection.ask(wire.QUOTE, pb.Quote(render=file)), "bad-argument")

    def test_camera_that_is_not_finite(self):
        eye = pb.Vec3(x=float("nan"))
        self.refuse("bad-argument", camera=pb.Camera(eye=eye, target=pb.Vec3(x=1), vfov_degrees=40))

    def test_aovs_in_a_png(self):
        self.refuse("bad-argument", format=pb.FORMAT_PNG, aovs=1)

    def test_no_such_scene(self):
        connection = self.connect()
        self.assert_error(connection.ask(wire.RENDER, render("nowhere")), "scene-not-found")
        self.assert_error(connection.ask(wire.UNLOAD, pb.Unload(name="nowhere")), "scene-not-found")
        self.assert_error(connection.ask(wire.DESCRIBE, pb.Describe(name="nowhere")), "scene-not-found")


class Ids(FakeCase):
    def test_duplicate_id_ends_neither(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, endless())
        connection.receive(wire.ACCEPTED, job)
        connection.send(wire.PING, request=job)
        self.assert_error(connection.receive_for(0), "duplicate-request")
        connection.send(wire.RENDER, render(), request=job)
        self.assert_error(connection.receive_for(0), "duplicate-request")
        self.assertEqual(connection.stats().jobs, 1)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)

    def test_the_id_is_free_again(self):
        connection = self.with_box()
        for _ in range(3):
            connection.send(wire.RENDER, render(), request=77)
            self.assertEqual(connection.follow(77)[-1].kind, wire.DONE)

    def test_the_same_id_on_another_connection(self):
        first, second = self.with_box(), self.connect()
        first.send(wire.RENDER, endless(), request=77)
        second.send(wire.RENDER, render(), request=77)
        self.assertEqual(second.follow(77)[-1].kind, wire.DONE)

    def test_zero_is_nobodys(self):
        connection = self.with_box()
        connection.send(wire.RENDER, render(), request=0)
        self.assert_error(connection.receive(request=0), "bad-argument")

    def test_too_many_jobs(self):
        connection = self.with_box()
        jobs = [connection.send(wire.RENDER, endless()) for _ in range(16)]
        self.assert_error(connection.ask(wire.RENDER, endless()), "too-many-jobs")
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=jobs[3])).kind, wire.OK)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        other = self.connect()
        self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)

    def test_cancel_of_nothing(self):
        connection = self.connect()
        self.assert_error(connection.ask(wire.CANCEL, pb.Cancel(request=5)), "no-such-request")

    def test_cancel_of_anothers(self):
        first, second = self.with_box(), self.connect()
        job = first.send(wire.RENDER, endless())
        first.receive(wire.ACCEPTED, job)
        second.last = 100
        self.assert_error(second.ask(wire.CANCEL, pb.Cancel(request=job)), "no-such-request")
        self.assertEqual(second.stats().jobs, 1)


if __name__ == "__main__":
    unittest.main()
