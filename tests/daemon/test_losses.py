"""Who is to blame for a worker that is lost: the scene, the device, or nobody; and nobody else has to bear it."""
import os
import signal
import threading
import unittest

import wire
from fakes import FakeCase, pattern, render
from wire import pb

DEADLY = 666  # a seed


class LossCase(FakeCase):
    def prepare(self):
        self.write("deadly.gltf", "ok 4097")
        self.write("same.gltf", "ok 4097")

    def outcome(self, connection, scene="box", **fields):
        """DONE or an error's name."""
        reply = connection.follow(connection.send(wire.RENDER, render(scene, **fields)))[-1]
        return "done" if reply.kind == wire.DONE else reply.body.name

    def with_both(self):
        connection = self.with_box()
        connection.load("deadly", self.scenes, "deadly.gltf")
        return connection


class Scene(LossCase):
    environment = {"FAKE_DIE_SEED": str(DEADLY), "FAKE_DIE_AS": "crash", "FAKE_STEP_US": "2000"}

    def test_a_deadly_scene_harms_no_other(self):
        """Eight clients with good scenes beside one with a deadly one: each good request is answered once, and well."""
        self.with_both()
        wrong = []

        def ask():
            with self.daemon.connect() as connection:
                for seed in range(12):
                    request = connection.send(wire.RENDER, render(seed=seed, samples=8))
                    replies = connection.follow(request)
                    if replies[-1].kind != wire.DONE or bytes(wire.images(replies)[0][1]) != pattern(64, seed):
                        wrong.append(replies[-1])
                # Whatever came twice would be here now.
                if connection.ask(wire.PING, pb.Ping(payload=b"x")).kind != wire.PONG or connection.waiting:
                    wrong.append(connection.waiting)
        people = [threading.Thread(target=ask) for _ in range(8)]
        for person in people:
            person.start()
        deadly = self.connect()
        answers = [self.outcome(deadly, "deadly", seed=DEADLY) for _ in range(6)]
        for person in people:
            person.join()
        self.assertEqual(wrong, [])
        self.assertEqual(answers, ["worker-lost"] + 5 * ["scene-quarantined"])
        wire.wait_for(lambda: deadly.stats().worker_starts == 3, "the third starts")
        self.assertEqual(deadly.stats().jobs_failed, 1)

    def test_all_that_wait_for_it_are_told(self):
        first, second = self.with_both(), self.connect()
        requests = [(c, c.send(wire.RENDER, render("deadly", seed=DEADLY))) for c in (first, first, second)]
        names = sorted(c.follow(request)[-1].body.name for c, request in requests)
        self.assertIn("scene-quarantined", names)
        self.assertLessEqual(set(names), {"scene-quarantined", "worker-lost"})
        wire.wait_for(lambda: first.stats().worker_starts == 3, "the third starts")
        for ask in (lambda: first.ask(wire.RENDER, render("deadly")), lambda: first.ask(wire.QUOTE, pb.Quote(render=render("deadly"))),
                    lambda: first.ask(wire.SWEEP, pb.Sweep(render=render("deadly"), cameras=[pb.Camera(), pb.Camera()]))):
            self.assert_error(ask(), "scene-quarantined")
        # Nor does another name help, or loading it anew; another content does.
        self.assert_error(first.receive_for(first.send_load("other", self.scenes, "same.gltf")), "scene-quarantined")
        self.assert_error(first.receive_for(first.send_load("deadly", self.scenes, "deadly.gltf")), "scene-quarantined")
        self.assertEqual(first.ask(wire.DESCRIBE, pb.Describe(name="deadly")).kind, wire.SCENE_INFO)
        self.write("deadly.gltf", "ok 4098")
        first.load("deadly", self.scenes, "deadly.gltf")
        self.assertEqual(self.outcome(first, "deadly"), "done")
        self.assertEqual(self.outcome(first), "done")

    def test_a_look_at_it_counts(self):
        connection = self.with_both()
        for name in ("deadly", "deadly"):
            connection.ask(wire.QUOTE, pb.Quote(render=render(name, seed=DEADLY), pilot_ms=10))
            self.assertEqual(self.outcome(connection), "done")
        self.assertEqual(connection.stats().worker_starts, 2)  # a pilot like one that was lost is not made again
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "scene-quarantined")
        wire.wait_for(lambda: connection.stats().worker_starts == 3, "the third starts")

    def test_what_is_killed_from_outside_is_no_fault_of_a_scene(self):
        connection, other = self.with_both(), self.connect()
        for _ in range(3):
            job = connection.send(wire.RENDER, render("deadly", samples=400))
            for _ in range(2):
                pid = wire.wait_for(lambda: other.stats().jobs and other.stats().worker_pid, "a worker runs")
                slices = other.stats().slices
                wire.wait_for(lambda: other.stats().slices > slices + 1, "it works")
                os.kill(pid, signal.SIGKILL)
                wire.wait_for(lambda: other.stats().worker_pid not in (0, pid), "another runs")
            self.assert_error(connection.follow(job)[-1], "worker-lost")
        self.assertEqual(self.outcome(connection, "deadly"), "done")
        self.assertEqual(other.stats().device_losses, 0)


class Surroundings(LossCase):
    """A scene and the picture around it: none can tell at once which of them is deadly."""
    environment = {"FAKE_DIE_SEED": str(DEADLY), "FAKE_DIE_AS": "crash"}

    def with_skies(self):
        connection = self.with_both()
        self.write("other.gltf", "ok 4099")
        connection.load("other", self.scenes, "other.gltf")
        for name in ("sky", "dusk"):
            self.write(name + ".exr", f"sky {len(name) + 4100}")
            connection.load(name, self.scenes, name + ".exr")
        return connection

    def under(self, connection, sky, scene="box", seed=DEADLY):
        return self.outcome(connection, scene, seed=seed, environment=pb.Environment(scene=sky))

    def test_deadly_surroundings_are_found(self):
        connection = self.with_skies()
        self.assertEqual(self.under(connection, "sky"), "worker-lost")
        # It may have been either: they are kept apart, and each is served without the other.
        self.assertEqual(self.under(connection, "sky", seed=1), "scene-quarantined")
        quote = pb.Quote(render=render(environment=pb.Environment(scene="sky")))
        self.assert_error(connection.ask(wire.QUOTE, quote), "scene-quarantined")
        for ask in (lambda: self.outcome(connection), lambda: self.under(connection, "dusk", seed=1),
                    lambda: self.under(connection, "sky", "deadly", seed=1)):
            self.assertEqual(ask(), "done")
        # With another scene it is the surroundings' own fault, at the first loss.
        self.assertEqual(self.under(connection, "sky", "deadly"), "scene-quarantined")
        self.assertEqual(self.under(connection, "sky", "deadly", seed=1), "scene-quarantined")
        self.assert_error(connection.receive_for(connection.send_load("again", self.scenes, "sky.exr")), "scene-quarantined")
        self.assertEqual([self.outcome(connection), self.outcome(connection, "deadly")], ["done", "done"])

    def test_a_deadly_scene_is_found(self):
        connection = self.with_skies()
        self.assertEqual(self.under(connection, "sky", "deadly"), "worker-lost")
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "scene-quarantined")
        self.assertEqual(self.outcome(connection, "deadly"), "scene-quarantined")
        self.assertEqual(self.under(connection, "sky", seed=1), "done")
        # Its losses are none of the surroundings', for which two more are the first.
        self.assertEqual(self.under(connection, "sky"), "worker-lost")
        self.assertEqual(self.under(connection, "sky", "other", seed=1), "done")

    def test_surroundings_do_not_answer_for_a_deadly_scene(self):
        """They were refused before that scene was known to be deadly by itself, and are served again."""
        connection = self.with_skies()
        self.assertEqual(self.under(connection, "sky", "deadly"), "worker-lost")
        self.assertEqual(self.under(connection, "sky"), "scene-quarantined")
        self.assertEqual(self.under(connection, "sky", "other", seed=1), "scene-quarantined")
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "worker-lost")
        self.assertEqual(self.outcome(connection, "deadly"), "scene-quarantined")
        self.assertEqual(self.under(connection, "sky", "other", seed=1), "done")
        # One loss is left, which may have been either's. The next keeps those two apart, and no other.
        self.assertEqual(self.under(connection, "sky", seed=1), "done")
        self.assertEqual(self.under(connection, "sky"), "scene-quarantined")
        self.assertEqual(self.under(connection, "sky", "other", seed=1), "done")
        self.assertEqual(self.under(connection, "dusk", seed=1), "done")

    def test_the_device_answers_under_the_same_surroundings(self):
        connection = self.with_skies()
        self.assertEqual(self.under(connection, "sky", "deadly"), "worker-lost")
        self.assertEqual(connection.stats().device_losses, 1)
        self.assertEqual(self.under(connection, "sky"), "scene-quarantined")
        self.assertEqual(connection.stats().device_losses, 2)

    def test_both_are_looked_at_once_they_are_there(self):
        connection = self.with_skies()
        self.assertEqual(self.under(connection, "sky"), "worker-lost")
        os.mkfifo(os.path.join(self.scenes, "slow.gltf"))
        load = connection.send_load("again", self.scenes, "slow.gltf")
        job = connection.send(wire.RENDER, render("again", environment=pb.Environment(scene="sky")))
        with open(os.path.join(self.scenes, "slow.gltf"), "w") as pipe:
            pipe.write("ok")
        self.assertEqual(connection.receive_for(load).kind, wire.SCENE_INFO)
        self.assert_error(connection.follow(job)[-1], "scene-quarantined")


class Hanging(LossCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "step", "FAKE_DIE_TIMES": "2"}
    arguments = ("--hang", "1")

    def test_a_hang_counts(self):
        connection = self.with_both()
        self.assertEqual(self.outcome(connection, "deadly"), "worker-lost")
        self.assertEqual(self.outcome(connection, "deadly"), "scene-quarantined")
        self.assertEqual(self.outcome(connection), "done")


class HangingUnseen(Hanging):
    def test_a_hang_counts(self):
        """Its jobs were cancelled before anyone knew."""
        connection = self.with_both()
        for number in (2, 3):
            job = connection.send(wire.RENDER, render("deadly"))
            self.assertEqual(connection.receive_for(job).kind, wire.ACCEPTED)
            for _ in range(2):  # until the order that it hangs in is given
                connection.ask(wire.PING, pb.Ping())
            self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
            self.assert_error(connection.follow(job)[-1], "cancelled")
            wire.wait_for(lambda: connection.stats().worker_starts == number, "another is started")
        self.assertEqual(self.outcome(connection, "deadly"), "scene-quarantined")
        self.assertEqual(connection.stats().device_losses, 1)
        self.assertEqual(self.outcome(connection), "done")


class Device(LossCase):
    environment = {"FAKE_DIE_SEED": str(DEADLY), "FAKE_DIE_AS": "device", "FAKE_DEVICES": "2"}

    def test_the_third_loss_takes_the_next_device(self):
        connection = self.with_both()
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "worker-lost")  # two
        self.assertEqual(self.outcome(connection), "done")
        stats = connection.stats()
        self.assertEqual((stats.device, stats.device_losses, stats.device_note), ("fake", 2, ""))
        # The third, then the first two of the next device: the scene had its part in only one that was given up.
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "worker-lost")
        accepted = connection.follow(connection.send(wire.RENDER, render()), (wire.ACCEPTED, wire.ERROR))[-1].body
        stats = connection.stats()
        self.assertEqual((stats.device, stats.device_losses), ("fake1", 4))
        self.assertRegex(stats.device_note, "^fake was lost 3 times within 10 minutes: fake1 is used")
        self.assertIn(stats.device_note, accepted.notes)
        # There is no third device: it stays, and says so. The scene ended two devices, and gets no more.
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "worker-lost")
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "scene-quarantined")
        wire.wait_for(lambda: connection.stats().device == "fake1", "the worker is ready")
        self.assertRegex(connection.stats().device_note, "^fake1 was lost 3 times within 10 minutes, and no other")
        self.assertEqual(self.outcome(connection), "done")


class Crashing(LossCase):
    environment = {"FAKE_DIE_SEED": str(DEADLY), "FAKE_DIE_AS": "crash", "FAKE_DEVICES": "2"}

    def test_the_same_scene_is_no_fault_of_the_device(self):
        connection = self.with_both()
        self.assertEqual(self.outcome(connection, "deadly", seed=DEADLY), "worker-lost")
        self.assertEqual(connection.stats().device_losses, 1)
        # Other scenes are: two more, and the next device is taken.
        for number in (1, 2):
            self.write("more.gltf", f"ok {5000 + number}")
            connection.load("more", self.scenes, "more.gltf")
            self.assertEqual(self.outcome(connection, "more", seed=DEADLY), "worker-lost")
            self.assertEqual(self.outcome(connection), "done")
            stats = connection.stats()
            self.assertEqual((stats.device_losses, stats.device), (1 + number, "fake1" if number == 2 else "fake"))

    def test_a_crash_when_nothing_is_worked_on_is_the_devices(self):
        connection = self.with_box()
        self.assertEqual(self.outcome(connection), "done")
        for number in range(3):
            pid = wire.wait_for(lambda: connection.stats().device and connection.stats().worker_pid, "a worker runs")
            self.assertEqual(self.outcome(connection), "done")
            os.kill(pid, signal.SIGABRT)
            wire.wait_for(lambda: connection.stats().worker_pid not in (0, pid), "another runs")
            self.assertEqual(connection.stats().device_losses, number + 1)
        self.assertEqual(self.outcome(connection), "done")
        self.assertEqual(connection.stats().device, "fake1")


if __name__ == "__main__":
    unittest.main()
