"""Quotes, with a stand-in for the worker: a path costs 1 µs and its error is one over its samples; what has no noise takes as long,
and is off by 0.25. Answers before and after a pilot, what a bad request gets, pilots that go wrong, and the file of what was learned."""
import os
import signal
import unittest

import wire
from fakes import FakeCase, endless, render
from wire import pb

OPEN = dict(technique=pb.TECHNIQUE_AUTO, samples=0, width=100, height=100)


def quote(pilot_ms=0, **fields):
    return pb.Quote(render=render(**{**OPEN, **fields}), pilot_ms=pilot_ms)


def at(x):
    """A view of its own."""
    return pb.Camera(eye=pb.Vec3(x=x), target=pb.Vec3(z=1), vfov_degrees=40)


class QuoteCase(FakeCase):
    def prepare(self):
        self.trace_file = os.path.join(self.daemon.folder, "trace")
        self.daemon.environment["FAKE_TRACE"] = self.trace_file

    def trace(self):
        """What the worker was told, in order: a job's number for a step, "pilot"."""
        if not os.path.exists(self.trace_file):
            return []
        with open(self.trace_file) as file:
            return [line.split()[0] for line in file]

    def pilots(self):
        """What each pilot was given: the work of a technique and the whole, in microseconds."""
        with open(self.trace_file) as file:
            return [tuple(map(int, line.split()[1:])) for line in file if line.startswith("pilot")]

    def quote_of(self, connection, question):
        """Of a render that has to succeed: its Accepted's quote."""
        replies = connection.follow(connection.send(wire.RENDER, question))
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        return next(r.body for r in replies if r.kind == wire.ACCEPTED).quote

    def answer(self, connection, question):
        reply = connection.ask(wire.QUOTE, question)
        self.assertEqual(reply.kind, wire.QUOTE_REPLY, reply)
        for choice in (reply.body.choice, reply.body.cheaper, reply.body.better):
            self.assertLessEqual(choice.time_ms_low, choice.time_ms)
            self.assertLessEqual(choice.time_ms, choice.time_ms_high)
            self.assertLessEqual(choice.relmse_low, choice.relmse)
            self.assertLessEqual(choice.relmse, choice.relmse_high)
        return reply.body


class Answers(QuoteCase):
    def test_a_time_an_error_and_neither(self):
        connection = self.with_box()
        timed = self.answer(connection, quote(deadline_ms=1000))
        self.assertEqual(timed.choice.technique, pb.TECHNIQUE_PT)
        self.assertEqual((timed.met, getattr(timed, "from")), (True, "pilot"))
        # 10^4 pixels: about 10 ms a sample.
        self.assertTrue(50 < timed.choice.samples < 150, timed)
        self.assertTrue(0.005 < timed.choice.relmse < 0.02, timed)
        exact = self.answer(connection, quote(target_error=0.01))
        self.assertTrue(exact.met and 60 < exact.choice.samples < 160, exact)
        plain = self.answer(connection, quote(samples=16))
        self.assertEqual((plain.choice.technique, plain.choice.samples, plain.met), (pb.TECHNIQUE_PT, 16, True))
        self.assertLess(plain.choice.time_ms, self.answer(connection, quote(samples=256)).choice.time_ms / 4)
        self.assertEqual(connection.stats().jobs_done, 0)

    def test_frames_refine_it(self):
        connection = self.with_box()
        before = self.answer(connection, quote(samples=16))
        for _ in range(3):
            connection.follow(connection.send(wire.RENDER, render(**{**OPEN, "samples": 16})))
        after = self.answer(connection, quote(samples=16))
        self.assertEqual(after.records, before.records + 3)
        self.assertEqual(getattr(after, "from"), "model")

    def test_the_nearest_of_what_cannot_be(self):
        connection = self.with_box()
        answer = self.answer(connection, quote(deadline_ms=1, width=3840, height=2160))
        self.assertFalse(answer.met)
        self.assertIn("cannot be met: nearest is", answer.why)
        self.assertIn("3840 x 2160", answer.why)

    def test_what_has_no_noise_is_looked_at_when_asked_for(self):
        connection = self.with_box()
        answer = self.answer(connection, quote(pilot_ms=10, technique=pb.TECHNIQUE_DIRECT))
        self.assertEqual(answer.choice.technique, pb.TECHNIQUE_DIRECT)
        self.assertTrue(0.15 < answer.choice.relmse < 0.4, answer)

    def test_a_scene_that_is_being_loaded_is_waited_for(self):
        connection = self.connect()
        load = connection.send_load("box", self.scenes, "box.gltf")
        answer = connection.receive_for(connection.send(wire.QUOTE, quote(samples=4)))
        self.assertEqual(answer.kind, wire.QUOTE_REPLY)
        self.assertEqual(connection.receive_for(load).kind, wire.SCENE_INFO)


class Work(QuoteCase):
    """What radiosity makes once for a scene, by what the worker says is left of it."""
    RADIOSITY = dict(technique=pb.TECHNIQUE_RADIOSITY, samples=1)

    def patches(self, count):
        return dict(self.RADIOSITY, options=[pb.Option(name="radiosity.patches", value=str(count))])

    def test_more_patches_take_longer(self):
        """Rows take a microsecond: so many thousands of them so many milliseconds."""
        connection = self.with_box()
        few, many = (self.answer(connection, quote(**self.patches(n))).choice for n in (500, 5000))
        self.assertTrue(400 < few.time_ms < 1000, few)
        self.assertTrue(4000 < many.time_ms < 8000, many)
        self.assertTrue(few.time_ms_low < 500 < few.time_ms_high and many.time_ms_low < 5000 < many.time_ms_high)

    def test_its_error_is_not_known_until_it_was_looked_at(self):
        connection = self.with_box()
        self.assertEqual(self.answer(connection, quote(**self.RADIOSITY)).choice.relmse, -1)
        looked = self.answer(connection, quote(pilot_ms=10, **self.RADIOSITY))
        self.assertTrue(0.15 < looked.choice.relmse < 0.4, looked)
        # Other patches are others, and so are other lights.
        for other in (quote(**self.patches(77)), quote(edits=pb.Edits(replace_lights=True), **self.RADIOSITY)):
            self.assertEqual(self.answer(connection, other).choice.relmse, -1, other)
        self.assertGreater(self.answer(connection, quote(**self.RADIOSITY)).choice.relmse, 0)

    def test_auto_does_not_choose_what_it_does_not_know(self):
        """Nor what takes longer than there is time for."""
        connection = self.with_box()
        self.assertNotEqual(self.answer(connection, quote(deadline_ms=300)).choice.technique, pb.TECHNIQUE_RADIOSITY)
        late = self.answer(connection, quote(deadline_ms=300, **self.patches(5000)))
        self.assertFalse(late.met)
        self.assertIn("take", late.why)

    def test_a_job_in_a_hurry_asks_what_is_left(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render(**OPEN | dict(samples=1, technique=pb.TECHNIQUE_RADIOSITY))))
        self.answer(connection, quote(pilot_ms=10))
        chosen = self.quote_of(connection, endless(technique=pb.TECHNIQUE_AUTO, width=100, height=100, deadline_ms=2000))
        self.assertNotEqual(chosen.choice.technique, pb.TECHNIQUE_RADIOSITY)


class Solved(Work):
    environment = {"FAKE_SOLVED": "1"}

    def test_more_patches_take_longer(self):
        """But not where all of it is there."""
        connection = self.with_box()
        few, many = (self.answer(connection, quote(**self.patches(n))).choice for n in (500, 5000))
        self.assertTrue(many.time_ms < 300 and few.time_ms < 300, (few, many))

    def test_auto_does_not_choose_what_it_does_not_know(self):
        connection = self.with_box()
        self.assertTrue(self.answer(connection, quote(deadline_ms=900, **self.patches(5000))).met)


class Busy(QuoteCase):
    environment = {"FAKE_STEP_US": "20000", "FAKE_PILOT_US": "1000"}

    def test_it_says_what_others_add(self):
        connection = self.with_box()
        other = connection.send(wire.RENDER, endless())
        wire.wait_for(lambda: connection.stats().slices > 2, "the job works")
        answer = self.answer(connection, quote(samples=16))
        self.assertEqual(answer.jobs, 1)
        self.assertGreater(answer.queue_ms, 0)
        self.assertTrue(any("idle" in note for note in answer.notes), answer)
        # The job goes on.
        slices = connection.stats().slices
        wire.wait_for(lambda: connection.stats().slices > slices + 2, "the job goes on")
        connection.send(wire.CANCEL, pb.Cancel(request=other))
        self.assert_error(connection.follow(other)[-1], "cancelled")

    def test_many_quotes_do_not_keep_a_job_from_the_device(self):
        connection, asker = self.with_box(), self.connect()
        job = connection.send(wire.RENDER, render(samples=20))
        for i in range(10):
            self.answer(asker, quote(samples=4, camera=pb.Camera(eye=pb.Vec3(x=i), target=pb.Vec3(z=1), vfov_degrees=40)))
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)


class Shared(QuoteCase):
    environment = {"FAKE_STEP_US": "10000", "FAKE_PILOT_US": "300000"}

    def test_after_a_pilot_the_jobs_have_the_device_for_as_long(self):
        connection, asker = self.with_box(), self.connect()
        job = connection.send(wire.RENDER, endless())
        wire.wait_for(lambda: "pilot" not in self.trace() and len(self.trace()) > 2, "the job works")
        for i in range(4):
            asker.send(wire.QUOTE, quote(pilot_ms=1, camera=at(i)))
        wire.wait_for(lambda: self.trace().count("pilot") == 3, "three pilots")
        steps = " ".join(self.trace()).split("pilot")[1:3]
        self.assertTrue(all(len(s.split()) >= 30 for s in steps), steps)
        connection.send(wire.CANCEL, pb.Cancel(request=job))
        self.assert_error(connection.follow(job)[-1], "cancelled")

    def test_none_before_a_deadline_that_is_near(self):
        connection, asker = self.with_box(), self.connect()
        job = connection.send(wire.RENDER, endless(deadline_ms=1500))
        connection.ask(wire.PING)
        asked = asker.send(wire.QUOTE, quote(pilot_ms=10))
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        answer = asker.receive_for(asked)
        self.assertEqual(getattr(answer.body, "from"), "pilot")
        trace = self.trace()
        self.assertEqual(trace.index("pilot"), len(trace) - 1)


class Late(QuoteCase):
    environment = {"FAKE_PILOT_US": "1500000"}

    def test_a_deadline_that_comes_during_a_pilot(self):
        connection, asker = self.with_box(), self.connect()
        asked = asker.send(wire.QUOTE, quote(pilot_ms=10))
        wire.wait_for(lambda: "pilot" in self.trace(), "the pilot is out")
        job = connection.send(wire.RENDER, endless(deadline_ms=100))
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        self.assertEqual(asker.receive_for(asked).kind, wire.QUOTE_REPLY)

    def test_a_job_that_a_pilot_makes_late_is_rendered(self):
        connection = self.with_box()
        # Compiled, and of a view that is not known: there is a pilot.
        connection.follow(connection.send(wire.RENDER, render()))
        chosen = self.quote_of(connection, endless(technique=pb.TECHNIQUE_AUTO, deadline_ms=1000, camera=at(1)))
        self.assertIn("pilot", self.trace())
        self.assertEqual(getattr(chosen, "from"), "model")

    def test_with_a_deadline_there_is_no_pilot_of_what_is_cold(self):
        connection = self.with_box()
        self.quote_of(connection, endless(technique=pb.TECHNIQUE_AUTO, deadline_ms=400))
        self.assertNotIn("pilot", self.trace())

    def test_a_pilot_has_a_tenth_of_what_is_left(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        self.quote_of(connection, endless(technique=pb.TECHNIQUE_AUTO, deadline_ms=2000, camera=at(1)))
        budget, limit = self.pilots()[-1]
        self.assertTrue(100_000 < limit <= 200_000 and budget <= limit / 2, (budget, limit))

    def test_jobs_that_are_cancelled_leave_no_quote(self):
        connection, asker = self.with_box(), self.connect()
        for i in range(70):
            job = connection.send(wire.RENDER, render(**{**OPEN, "target_error": 0.1, "camera": at(i)}))
            connection.ask(wire.CANCEL, pb.Cancel(request=job))
            self.assert_error(connection.receive_for(job), "cancelled")
        self.answer(asker, quote(samples=4))
        # No pilot of theirs goes on.
        self.assertLessEqual(self.trace().count("pilot"), self.trace().count("end") + 1)


class Ended(QuoteCase):
    """A pilot would take ten minutes; a worker that is so long without an answer is killed after one."""
    environment = {"FAKE_PILOT_US": "600000000"}

    def out(self, connection, question):
        request = connection.send(wire.QUOTE if isinstance(question, pb.Quote) else wire.RENDER, question)
        wire.wait_for(lambda: "pilot" in self.trace(), "the pilot is out")
        return request

    def assert_free(self, connection):
        """The device is free, with the same worker."""
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().worker_starts, 1)
        self.assertIn("end", self.trace())

    def test_cancelled(self):
        connection = self.with_box()
        asked = self.out(connection, quote(pilot_ms=60000))
        connection.ask(wire.CANCEL, pb.Cancel(request=asked))
        self.assert_error(connection.receive_for(asked), "cancelled")
        self.assert_free(connection)

    def test_the_client_goes(self):
        connection, other = self.with_box(), self.connect()
        self.out(other, quote(pilot_ms=60000))
        other.close()
        self.assert_free(connection)

    def test_its_job_is_cancelled(self):
        connection = self.with_box()
        job = self.out(connection, render(**{**OPEN, "target_error": 0.1}))
        connection.ask(wire.CANCEL, pb.Cancel(request=job))
        self.assert_error(connection.receive_for(job), "cancelled")
        self.assert_free(connection)

    def test_its_job_is_let_go_without_it(self):
        connection = self.with_box()
        job = self.out(connection, render(**{**OPEN, "target_error": 0.1}))
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        self.assert_free(connection)

    def test_a_job_comes_whose_deadline_is_nearer(self):
        """The pilot is made again when there is room."""
        connection, other = self.with_box(), self.connect()
        asked = self.out(other, quote(pilot_ms=1000))
        # What is sent meanwhile reaches the worker later, and does not hide the end.
        connection.load("another", self.scenes, "box.gltf")
        job = connection.send(wire.RENDER, endless(deadline_ms=2000, scene="another"))
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        wire.wait_for(lambda: self.trace().count("pilot") == 2, "another pilot")
        other.ask(wire.CANCEL, pb.Cancel(request=asked))
        self.assert_error(other.receive_for(asked), "cancelled")
        self.assert_free(connection)


class Whole(QuoteCase):
    environment = {"FAKE_PILOT_US": "1500000", "FAKE_PILOT": "whole"}

    def test_a_pilot_that_was_ended_too_late_to_be_cut_counts(self):
        connection, asker = self.with_box(), self.connect()
        asked = asker.send(wire.QUOTE, quote(pilot_ms=1000))
        wire.wait_for(lambda: "pilot" in self.trace(), "the pilot is out")
        job = connection.send(wire.RENDER, endless(deadline_ms=2000))
        self.assertEqual(getattr(asker.receive_for(asked).body, "from"), "pilot")
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        self.assertEqual((self.trace().count("pilot"), self.trace().count("end")), (1, 1))


class NoWorker(QuoteCase):
    environment = {"FAKE_EXIT": "1"}

    def test_a_pilot_that_cannot_be_is_not_waited_for(self):
        connection = self.with_box()
        self.assertEqual(getattr(self.answer(connection, quote(pilot_ms=10)), "from"), "model")


class Refused(QuoteCase):
    def test_hostile_questions(self):
        connection = self.with_box()
        for question, name in (
                (pb.Quote(), "bad-argument"), (quote(width=0), "bad-argument"), (quote(width=1 << 20), "limit"),
                (quote(samples=1 << 30), "limit"), (quote(target_error=-1), "bad-argument"), (quote(target_error=float("nan")), "bad-argument"),
                (quote(target_error=float("inf"), technique=pb.TECHNIQUE_DIRECT), "bad-argument"), (quote(pilot_ms=1 << 31), "limit"),
                (quote(deadline_ms=1 << 31), "limit"), (quote(technique=77), "bad-argument"),
                (quote(scene="nothing"), "scene-not-found"), (quote(options=[pb.Option(name="xx.depth", value="3")]), "bad-argument"),
                (quote(options=[pb.Option(name="pt.depth", value="3"), pb.Option(name="vct.cones", value="3")]), "bad-argument")):
            self.assert_error(connection.ask(wire.QUOTE, question), name)
        self.assert_error(connection.ask(wire.QUOTE, b"\xff\xff\xff"), "bad-message")
        self.assert_error(connection.ask(wire.QUOTE, quote(), request=0), "bad-argument")
        # A technique that cannot end by its error may be asked about it.
        self.answer(connection, quote(target_error=0.5, technique=pb.TECHNIQUE_DIRECT))
        self.assert_serves()


class Slow(QuoteCase):
    environment = {"FAKE_PILOT_US": "2000000"}

    def test_the_answer_does_not_wait_for_a_slow_pilot(self):
        connection = self.with_box()
        answer = self.answer(connection, quote(samples=16))
        self.assertEqual((getattr(answer, "from"), answer.records), ("model", 0))
        self.assertTrue(any("guess" in note for note in answer.notes), answer)
        # What comes late is learned.
        wire.wait_for(lambda: self.answer(connection, quote(samples=16)).records > 0, "the pilot comes back")

    def test_cancel(self):
        connection = self.with_box()
        asked = connection.send(wire.QUOTE, quote(samples=16))
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=asked)).kind, wire.OK)
        self.assert_error(connection.receive_for(asked), "cancelled")
        self.assert_error(connection.ask(wire.CANCEL, pb.Cancel(request=asked)), "no-such-request")

    def test_the_id_is_in_use(self):
        connection = self.with_box()
        asked = connection.send(wire.QUOTE, quote(samples=16))
        connection.send(wire.PING, request=asked)
        self.assert_error(connection.receive_for(0), "duplicate-request")
        self.assertEqual(connection.receive_for(asked).kind, wire.QUOTE_REPLY)

    def test_a_client_that_goes_during_a_pilot(self):
        connection = self.with_box()
        other = self.connect()
        other.send(wire.QUOTE, quote(samples=16))
        other.ask(wire.PING)
        other.close()
        wire.wait_for(lambda: connection.stats().connections == 1, "the other is gone")
        self.assert_serves()
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)

    def test_a_scene_that_is_unloaded_during_a_pilot(self):
        connection = self.with_box()
        asked = connection.send(wire.QUOTE, quote(samples=16))
        self.assertEqual(connection.ask(wire.UNLOAD, pb.Unload(name="box")).kind, wire.OK)
        self.assertEqual(connection.receive_for(asked).kind, wire.QUOTE_REPLY)
        self.assert_serves()

    def test_the_daemon_ends_during_a_pilot(self):
        connection = self.with_box()
        asked = connection.send(wire.QUOTE, quote(samples=16))
        connection.ask(wire.PING)
        self.daemon.process.send_signal(signal.SIGTERM)
        self.assert_error(connection.receive_for(asked), "shutting-down")


class Lost(QuoteCase):
    environment = {"FAKE_PILOT": "die"}

    def test_a_pilot_that_kills_the_worker_is_answered_and_no_job_is_blamed(self):
        connection = self.with_box()
        for _ in range(3):
            answer = self.answer(connection, quote(samples=16))
            self.assertEqual(getattr(answer, "from"), "model")
            self.assertTrue(any("lost with a pilot" in note for note in answer.notes), answer)
        # What it may have died of is not tried again.
        self.assertEqual(self.trace(), ["pilot"])
        jobs = [connection.send(wire.RENDER, render(samples=50)) for _ in range(3)]
        for i in range(4):
            self.answer(connection, quote(samples=4, seed=i, options=[pb.Option(name="pt.depth", value=str(i + 1))]))
        for job in jobs:
            self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)


class Nonsense(QuoteCase):
    environment = {"FAKE_PILOT": "nonsense"}

    def test_a_worker_that_answers_with_no_number_is_killed(self):
        connection = self.with_box()
        self.answer(connection, quote(samples=16))
        wire.wait_for(lambda: connection.stats().worker_starts > 1, "another worker")
        self.assertIn("nonsense", self.daemon.log_text())
        self.assert_serves()


class NoKind(Nonsense):
    environment = {"FAKE_PILOT": "kind"}


class NoStatus(Nonsense):
    environment = {"FAKE_PILOT": "code"}


class OfAnother(Nonsense):
    environment = {"FAKE_PILOT": "other"}


class LessThanNoWork(Nonsense):
    environment = {"FAKE_PILOT": "work"}


class RefusedByTheWorker(QuoteCase):
    environment = {"FAKE_PILOT": "refuse"}

    def test_its_reason_is_told(self):
        connection = self.with_box()
        self.assert_error(connection.ask(wire.QUOTE, quote(samples=16)), "bad-argument")


class Auto(QuoteCase):
    def test_a_fresh_daemon_looks_first(self):
        connection = self.with_box()
        self.assertEqual(getattr(self.quote_of(connection, quote(target_error=0.1).render), "from"), "pilot")

    def test_it_is_chosen_by_the_quote_and_says_so(self):
        connection = self.with_box()
        question = quote(target_error=0.1)
        said = self.answer(connection, question)
        replies = connection.follow(connection.send(wire.RENDER, question.render))
        accepted = next(r.body for r in replies if r.kind == wire.ACCEPTED)
        self.assertEqual(replies[-1].kind, wire.DONE)
        self.assertEqual(accepted.quote.choice.technique, said.choice.technique)
        self.assertIn("least time", accepted.quote.why)

    def test_a_deadline_too_short_for_a_pilot(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, endless(technique=pb.TECHNIQUE_AUTO, deadline_ms=50)))
        if replies[-1].kind == wire.DONE:
            self.assertEqual(getattr(next(r.body for r in replies if r.kind == wire.ACCEPTED).quote, "from"), "model")

    def test_without_an_end_and_in_a_sweep_nothing_is_chosen(self):
        connection = self.with_box()
        for kind, question in ((wire.RENDER, render(technique=pb.TECHNIQUE_AUTO)),
                               (wire.SWEEP, pb.Sweep(render=render(technique=pb.TECHNIQUE_AUTO, target_error=0.5), cameras=[pb.Camera()]))):
            accepted = next(r.body for r in connection.follow(connection.send(kind, question)) if r.kind == wire.ACCEPTED)
            self.assertFalse(accepted.HasField("quote"))


class AutoSlow(QuoteCase):
    environment = {"FAKE_PILOT_US": "3000000"}

    def test_the_choice_does_not_wait(self):
        """While the pilot has the device nobody else has, so the job begins after it; but its choice was made, and it may be cancelled."""
        connection = self.with_box()
        job = connection.send(wire.RENDER, endless(technique=pb.TECHNIQUE_AUTO, target_error=1e-9))
        connection.ask(wire.PING)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assert_serves()


class Kept(QuoteCase):
    def prepare(self):
        super().prepare()
        self.state = os.path.join(self.daemon.folder, "state", "deep")
        self.daemon.arguments = [a for a in self.daemon.arguments if a != "--no-state"] + ["--state", self.state]

    def file(self):
        return os.path.join(self.state, "quotes")

    def learn(self):
        """One record more; the daemon ends, and its file is there."""
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        self.assertEqual(self.daemon.end(), 0)

    def records(self):
        self.daemon.start()
        return self.answer(self.with_box(), quote(samples=4)).records

    def test_what_was_learned_outlives_the_daemon(self):
        self.learn()
        self.assertEqual(os.stat(self.file()).st_mode & 0o777, 0o600)
        self.assertEqual(os.listdir(self.state), ["quotes"])
        self.assertGreaterEqual(self.records(), 1)

    def test_a_question_before_the_worker_is_ready(self):
        self.learn()
        self.daemon.environment["FAKE_READY_US"] = "1000000"
        self.assertGreaterEqual(self.records(), 1)

    def test_an_answer_does_not_wait_for_the_worker(self):
        """What the file knows is told, of the device that the newest record is of."""
        self.learn()
        self.daemon.environment["FAKE_READY_US"] = "20000000"
        self.daemon.start()
        connection = self.with_box()
        self.assertGreaterEqual(self.answer(connection, quote(samples=4)).records, 1)
        self.assertEqual(connection.stats().device, "")

    def test_a_damaged_file_is_left_aside_with_a_line(self):
        self.learn()
        with open(self.file(), "rb") as file:
            good = file.read()
        for name, bad in (("cut", good[:-7]), ("empty", b""), ("foreign", b"#!/bin/sh\n" * 100), ("long", good + bytes(1 << 24)),
                          ("turned", good[:-9] + bytes([good[-9] ^ 1]) + good[-8:])):
            with self.subTest(name):
                with open(self.file(), "wb") as file:
                    file.write(bad)
                self.daemon.start()
                self.assertIn("is left aside", self.daemon.log_text())
                self.assertEqual(self.answer(self.with_box(), quote(samples=4, pilot_ms=0, scene="box")).met, True)
                self.assertEqual(self.daemon.end(), 0)
                os.remove(self.daemon.log)
        os.remove(self.file())
        os.mkdir(self.file())
        self.daemon.start()
        self.assertTrue(self.answer(self.with_box(), quote(samples=4)).met)
        self.assertEqual(self.daemon.end(), 0)

    def test_two_daemons_keep_what_both_learned(self):
        with wire.Daemon("--state", self.state, libexec=self.daemon.arguments[self.daemon.arguments.index("--libexec") + 1]) as other:
            with other.connect() as connection:
                connection.load("box", self.scenes, "box.gltf")
                connection.follow(connection.send(wire.RENDER, render()))
                connection.follow(connection.send(wire.RENDER, render()))
            self.learn()
            self.assertEqual(other.end(), 0)
        self.assertGreaterEqual(self.records(), 3)


class NotKept(QuoteCase):
    def prepare(self):
        super().prepare()
        state = os.path.join(self.daemon.folder, "state")
        with open(state, "w"):
            pass
        self.daemon.arguments = [a for a in self.daemon.arguments if a != "--no-state"] + ["--state", os.path.join(state, "deep")]

    def test_a_folder_that_cannot_be_made(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        self.assertEqual(self.daemon.end(), 0)
        self.assertIn("cannot be kept", self.daemon.log_text())


if __name__ == "__main__":
    unittest.main()
