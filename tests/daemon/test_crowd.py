"""Sixty-four connections at once: everybody is served, in turns, whatever some of them do; and nothing is left of it."""
import os
import unittest

import crowd
import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb

SAMPLES = 20
ROUNDS = 3


class CrowdCase(FakeCase):
    def prepare(self):
        self.trace_file = os.path.join(self.daemon.folder, "trace")
        self.daemon.environment["FAKE_TRACE"] = self.trace_file

    def trace(self):
        """The jobs of all steps so far, in their order."""
        with open(self.trace_file, encoding="ascii") as file:
            return file.read().split()

    def crowd(self, *stalled):
        self.with_box()
        return crowd.Crowd(self.daemon, self.connect, stalled, crowd.slow_render(scene="box", width=8, height=8, samples=4, seed=77))


class Together(CrowdCase):
    def round(self, people, number):
        """All wait for one scene, which comes when all have asked."""
        name = f"late{number}.gltf"
        os.mkfifo(os.path.join(self.scenes, name))
        load = people.observer.send_load(name, self.scenes, name)

        def let_it_come():
            wire.wait_for(lambda: people.observer.stats().jobs == 2 + crowd.ORDINARY, "all have asked")
            with open(os.path.join(self.scenes, name), "w", encoding="ascii") as file:
                file.write("ok")
            self.assertEqual(people.observer.receive_for(load).kind, wire.SCENE_INFO)

        requests = (lambda i: render(name, width=300 + i, height=200, samples=SAMPLES, seed=number + i))
        for i, replies in people.ask_all(requests, let_it_come):
            self.assertEqual(replies[-1].kind, wire.DONE)
            (_, data), = wire.images(replies)
            self.assertEqual(bytes(data), pattern((300 + i) * 200, number + i))
        self.assertEqual(people.observer.ask(wire.UNLOAD, pb.Unload(name=name)).kind, wire.OK)

    def assert_fair(self, trace):
        """From when all have begun until the first has had all its slices they take turns: none is ever two ahead."""
        jobs = set(trace)
        self.assertEqual(len(jobs), crowd.ORDINARY)
        begun = max(trace.index(job) for job in jobs)
        finished = min(max(i for i, job in enumerate(trace) if job == one) for one in jobs)
        self.assertGreater(finished, begun + 10 * len(jobs))
        had = dict.fromkeys(jobs, 0)
        for job in trace[begun + 1:finished]:
            had[job] += 1
            self.assertLessEqual(max(had.values()) - min(had.values()), 1)

    def test_all_are_served_in_turns_and_nothing_is_left(self):
        people = self.crowd(render(width=2000, height=2000, samples=1), render(width=2000, height=2000, samples=1))
        wire.wait_for(lambda: people.observer.stats().slices == 2, "the stalled peer's work is done")
        held, memory = None, 0
        for number in range(ROUNDS):
            before = len(self.trace())
            self.round(people, number)
            self.assert_fair(self.trace()[before:])
            if number == 0:
                held, memory = people.held(), self.daemon.rss_kib()
        self.assertEqual(people.held(), held)
        self.assertEqual((held["connections"], held["jobs"]), (crowd.CONNECTIONS + 1, 2))
        self.assertLess(self.daemon.rss_kib() - memory, crowd.growth_allowed_kib())
        replies = people.finish_slow()
        self.assertEqual(bytes(wire.images(replies)[0][1]), pattern(64, 77))
        self.assertEqual(people.silent.ask(wire.PING, pb.Ping(payload=b"x")).body.payload, b"x")


class Previews(CrowdCase):
    def preview(self, connection, foreign):
        """A preview of four samples; the slices that others had between its first and its last."""
        before = len(self.trace())
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        slices = self.trace()[before:]
        own, = {job for job in slices if slices.count(job) == 4} - foreign
        at = [i for i, job in enumerate(slices) if job == own]
        return at[-1] - at[0] - 3

    def test_a_preview_waits_for_no_more_than_a_slice_of_each(self):
        long = self.with_box()
        long.receive(wire.ACCEPTED, long.send(wire.RENDER, endless()))
        wire.wait_for(lambda: len(self.trace()) > 50, "the long frame is past its youth")
        foreign = set(self.trace())
        alone = [self.preview(self.connect(), foreign) for _ in range(20)]
        self.assertLessEqual(max(alone), 1)
        # The stalled peer has a frame without end, too, of which it takes no preview.
        people = crowd.Crowd(self.daemon, self.connect, [endless(width=1000, height=1000, progressive=True)],
                             crowd.slow_render(scene="box", width=8, height=8, samples=4))
        foreign |= set(self.trace())
        beside = []
        for i in range(60):
            people.nudge()
            beside.append(self.preview(people.ordinary[i], foreign))
        self.assertLessEqual(max(beside), 2)
        self.assertEqual(people.finish_slow()[-1].kind, wire.DONE)


if __name__ == "__main__":
    unittest.main()
