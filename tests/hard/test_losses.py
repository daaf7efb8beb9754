"""Who is answered what, and when, if a process dies, stops, or has no device, memory or room for a file: a table of cases with the real
worker and loader, in one daemon. After each case the next request has the right picture; after all of them nothing has leaked. The page
LOSSES.md has the table; with CANDIL_TABLE=write it is written."""
import contextlib
import glob
import json
import os
import re
import resource
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import images
import make
import wire
from wire import pb

SOURCE = os.environ["CANDIL_SOURCE"]
PAGE = os.path.join(SOURCE, "tests", "hard", "LOSSES.md")
FAULTY = os.path.join(wire.BUILD, "tests", "faulty")
SANITIZE = os.environ.get("CANDIL_SANITIZE") == "1"
HANG = "1"  # seconds
MIB = 1 << 20
MANIFESTS = "/usr/share/vulkan/icd.d/lvp_icd*.json"  # of the software driver

AT_ONCE = "at once"
NEXT = "with the next worker, which starts after 50 ms"
HUNG = "with the next worker, once it has been still for `--hang` seconds"
NEVER = "nobody notices"

# Faults by name: the signals that the process gets. Those that a CPU sends are the same whoever sends them.
SIGNALS = {
    "is killed": [signal.SIGKILL],
    "crashes (SIGSEGV)": [signal.SIGSEGV],
    "crashes (SIGBUS)": [signal.SIGBUS],
    "aborts": [signal.SIGABRT],
    "divides by zero (SIGFPE)": [signal.SIGFPE],
    "meets a wrong instruction (SIGILL)": [signal.SIGILL],
    "is stopped": [],
    "loses its device": [signal.SIGUSR1],
    "gets no device memory": [signal.SIGUSR2],
    "is asked to end (SIGTERM)": [signal.SIGTERM],
}
# Of AddressSanitizer's own handlers no sentence is wanted in the log.
OWN = ("crashes (SIGSEGV)", "crashes (SIGBUS)", "aborts", "divides by zero (SIGFPE)", "meets a wrong instruction (SIGILL)")

STATES = {
    "start": "the worker starts, and a render waits for it",
    "idle": "the worker has nothing to do",
    "begin": "the worker begins a render",
    "step": "the worker traces a picture",
    "read": "the worker encodes a picture",
    "pilot": "the worker looks at a scene for a quote",
    "send": "a client takes its picture slowly",
    "load": "the loader reads a scene",
}


class Case:
    def __init__(self, state, fault, answer, when, times=1):
        self.state, self.fault, self.answer, self.when, self.times = state, fault, answer, when, times

    def __str__(self):
        return f"{self.state}: {self.fault}{' twice' if self.times == 2 else ''}"

    def row(self):
        return f"| {STATES[self.state]} | it {self.fault}{', twice' if self.times == 2 else ''} | {self.answer} | {self.when} |"


def again(state, faults, answer="the picture, begun again"):
    return [Case(state, fault, answer, HUNG if fault == "is stopped" else NEXT) for fault in faults]


DEADLY = ["is killed", "crashes (SIGSEGV)", "crashes (SIGBUS)", "aborts", "is stopped"]
CASES = [
    *again("start", ["is killed", "aborts", "is stopped"], "the picture"),
    *[Case("idle", fault, "the next request: the picture", NEXT) for fault in DEADLY[:-1] + ["is asked to end (SIGTERM)"]],
    Case("idle", "is stopped", "the next request: the picture", HUNG),
    *again("begin", DEADLY + ["loses its device"]),
    Case("begin", "gets no device memory", "the picture: what nobody uses makes room", NEVER),
    *again("step", DEADLY + ["divides by zero (SIGFPE)", "meets a wrong instruction (SIGILL)", "is asked to end (SIGTERM)", "loses its device"]),
    Case("step", "is killed", "`worker-lost`", AT_ONCE, 2),
    Case("step", "crashes (SIGSEGV)", "`worker-lost`; all others on that scene, now and later: `scene-quarantined`", AT_ONCE, 2),
    Case("step", "is stopped", "`worker-lost`", "after `--hang` seconds", 2),
    Case("step", "loses its device", "`worker-lost`", AT_ONCE, 2),
    *again("read", DEADLY, "the picture, begun again unless it was through"),
    *[Case("pilot", fault, "the quote, by what is known", AT_ONCE) for fault in DEADLY[:-1] + ["loses its device"]],
    Case("pilot", "is stopped", "the quote, by what is known", "when it is due, not later than `--hang` seconds"),
    *[Case("send", fault, "the whole picture", NEVER) for fault in ("is killed", "crashes (SIGSEGV)")],
    *[Case("load", fault, "`loader-lost`", AT_ONCE) for fault in DEADLY[:-1] + ["is asked to end (SIGTERM)"]],
    Case("load", "is stopped", "`scene-limit`", "after `--hang` seconds"),
]
# Those that are cases of their own, below: (while, what happens, answer, when)
OTHERS = {
    "mapped": ("a scene is mapped by the worker", "someone cuts its memory short, for a SIGBUS", "nothing changes",
               "the kernel refuses it: scenes are sealed"),
    "memory": ("the worker begins a render", "there is no address space left for it (RLIMIT_AS)", "`memory`", AT_ONCE),
    "little": ("the worker starts", "a limit of address space (`ulimit -v`) leaves no room for a device", "`memory`", AT_ONCE),
    "decoder": ("the loader starts", "a limit of address space (`ulimit -v`) leaves no room for the decoder of images", "`memory`", AT_ONCE),
    "room": ("the worker encodes a picture", "a file may not become so large (RLIMIT_FSIZE)", "`memory`", AT_ONCE),
    "codec": ("the worker encodes a picture", "candil-codec.so is missing", "`encode`", AT_ONCE),
    "passed": ("the loader hands a scene over, and the worker a picture", "a hundred descriptors of the same user are on their way elsewhere, too "
               "many for the worker", "the scene at once, and the picture when there are fewer", NEVER),
    "client": ("the worker traces a picture", "its client dies", "nobody", "the device is free after the slice"),
    "device": ("the worker is idle, three times within ten minutes", "it aborts; a second device is there", "the picture, by the next device; "
               "notes, `stats` and `doctor` say so", NEXT),
    "only": ("the worker is idle, three times within ten minutes", "it aborts; there is no other device", "the picture, by the same device; "
             "notes, `stats` and `doctor` say so", NEXT),
}


def page():
    rows = [case.row() for case in CASES] + [f"| {' | '.join(row)} |" for row in OTHERS.values()]
    return f"""# Who is answered what, and when

If a process dies, stops, or lacks what it needs. Each row is a case of `test_losses.py`: the fault is a signal to the real worker or loader while it
is in that state, or what the row says. After each the next request on another scene has the right picture, bit for bit; after all of them the
daemon has no descriptor, job, scene, image, file or process more than before. Clients whose jobs the worker had besides have them begun again,
however often: only the job that was worked on is blamed, and its scene only for what the worker did itself. A new worker starts 50 ms after a loss, and after twice as long with each further one before a
slice is done, up to 12.8 s. `tests/daemon/test_losses.py` and `test_hang.py` show the rest with a stand-in worker: eight
clients beside one with a deadly scene, each answered once; what hangs in each of its states; and who is blamed.

Where `/proc` is mounted with `hidepid`, the daemon cannot see what a loader waits for, because it may not be traced: one that hangs counts as at work
unless it is stopped, and the bounds of processor time and of the clock alone end it (`LIMIT_LOAD_SECONDS`, `LIMIT_LOAD_CLOCK_SECONDS`).

**{len(rows)} rows.**

| while | what happens | answer | when |
| --- | --- | --- | --- |
""" + "\n".join(rows) + "\n"


def state_of(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        return file.read().rsplit(")", 1)[1].split()[0]


def stop(pid):
    os.kill(pid, signal.SIGSTOP)
    wire.wait_for(lambda: state_of(pid) in "TZ", "it is stopped")


def strike(pid, fault):
    """To a process that is stopped."""
    for number in SIGNALS[fault]:
        os.kill(pid, number)
    if SIGNALS[fault]:
        with contextlib.suppress(ProcessLookupError):  # it has ended already
            os.kill(pid, signal.SIGCONT)


def request(scene, **fields):
    values = dict(width=16, height=16, samples=1, technique=pb.TECHNIQUE_PT, format=pb.FORMAT_EXR_FLOAT)
    values.update(fields)
    return pb.Render(scene=scene, **values)


class Losses(unittest.TestCase):
    arguments = ("--hang", HANG, "--slice", "5")
    libexec = FAULTY
    environment = {}

    def setUp(self):
        self.daemon = wire.Daemon(*self.arguments, libexec=self.libexec, environment=self.environment)
        self.daemon.start()
        self.addCleanup(self.end)
        self.scenes = os.path.join(self.daemon.folder, "scenes")
        os.mkdir(self.scenes)
        self.client, self.observer = self.daemon.connect(), self.daemon.connect()
        for connection in (self.client, self.observer):
            self.addCleanup(connection.close)
        self.fresh = 0
        self.client.load("box", self.scenes, os.path.basename(make.cornell(self.scenes)))
        replies = self.client.follow(self.client.send(wire.RENDER, request("box")))
        if replies[-1].kind == wire.ERROR and replies[-1].body.name == "device":
            self.skipTest(replies[-1].body.message)
        self.picture = self.radiance(replies)

    def end(self):
        status, log = self.daemon.end(), self.daemon.log_text()
        self.daemon.stop()
        self.assertEqual(status, 0, log)

    def radiance(self, replies):
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        (_, data), = wire.images(replies)
        path = os.path.join(self.daemon.folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(data)
        channels = images.channels(path)
        return b"".join(channels[c].tobytes() for c in "RGB")

    def worker(self):
        return wire.wait_for(lambda: (lambda s: s.device and s.worker_pid)(self.observer.stats()), "a worker runs")

    def new_scene(self):
        """One that no worker was lost with."""
        self.fresh += 1
        name = f"scene{self.fresh}"
        self.client.load(name, self.scenes, os.path.basename(make.cornell(self.scenes, 15 + self.fresh / 100, name + ".gltf")))
        return name

    def settled(self):
        """What the client sent has been given to the worker."""
        for _ in range(2):
            self.client.ask(wire.PING, pb.Ping())

    def assert_serves(self):
        replies = self.client.follow(self.client.send(wire.RENDER, request("box")))
        self.assertEqual(self.radiance(replies), self.picture)
        self.assertEqual(self.client.waiting, [])

    # ---- states: each leaves the process of the case stopped in it, and returns (process, request or None)

    def in_idle(self, scene):
        self.client.follow(self.client.send(wire.RENDER, request(scene)))
        stop(self.worker())
        return self.worker(), None

    def in_start(self, scene):
        old = self.worker()
        os.kill(old, signal.SIGKILL)
        pid = wire.wait_for(lambda: (lambda p: p if p not in (0, old) else 0)(self.observer.stats().worker_pid), "the next starts")
        stop(pid)
        return pid, self.client.send(wire.RENDER, request(scene))

    def in_begin(self, scene):
        pid = self.worker()
        stop(pid)
        job = self.client.send(wire.RENDER, request(scene))
        self.settled()
        return pid, job

    def in_step(self, scene, job=None):
        while True:
            pid, before = self.worker(), self.observer.stats().slices
            job = job or self.client.send(wire.RENDER, request(scene, width=32, height=32, samples=1 << 20, progressive=False))
            wire.wait_for(lambda: self.observer.stats().slices > before + 2, "it is traced")
            stop(pid)
            return pid, job

    def in_read(self, scene):
        pid = self.worker()
        job = self.client.send(wire.RENDER, request(scene, width=400, height=400, format=pb.FORMAT_EXR_HALF))
        wire.wait_for(lambda: (lambda s: s.image_bytes > 0 or s.jobs == 0)(self.observer.stats()), "it is encoded")
        stop(pid)
        return pid, job

    def in_pilot(self, scene):
        pid = self.worker()
        stop(pid)
        quote = pb.Quote(render=request(scene, target_error=1e-9), pilot_ms=200)
        job = self.client.send(wire.QUOTE, quote)
        self.settled()
        return pid, job

    def in_send(self, scene):
        slow = self.daemon.connect()
        self.addCleanup(slow.close)
        self.slow = slow, slow.send(wire.RENDER, request(scene, width=500, height=500))
        wire.wait_for(lambda: self.observer.stats().buffered_bytes > 0, "it is sent")
        pid = self.worker()
        stop(pid)
        return pid, None

    def in_load(self, scene):
        del scene
        job = self.client.send_load("slow", self.scenes, os.path.basename(make.slow_to_load(self.scenes)))
        pid = wire.wait_for(lambda: self.observer.stats().loader_pid, "the loader reads")
        stop(pid)
        return pid, job

    # ---- one case

    def answer_of(self, case, scene, job, worker):
        """Hold what comes to what the case says."""
        if case.state == "idle":
            self.assertEqual(self.client.follow(self.client.send(wire.RENDER, request(scene)))[-1].kind, wire.DONE)
        elif case.state == "send":
            slow, job = self.slow
            frame, data = wire.images(slow.follow(job))[-1]
            self.assertEqual(len(data), frame.bytes)
            slow.close()
        elif case.state == "pilot":
            self.assertEqual(self.client.receive_for(job).kind, wire.QUOTE_REPLY)
        elif "`" in case.answer:
            reply = self.client.follow(job)[-1]
            self.assertEqual(reply.kind, wire.ERROR)
            self.assertIn(f"`{reply.body.name}`", case.answer)
            self.assertGreater(len(reply.body.message), 20)
        elif case.state == "step":
            # It goes on, and is none the worse: another is through meanwhile.
            wire.wait_for(lambda: self.observer.stats().worker_pid not in (0, worker), "the next worker starts")
            before = self.observer.stats().slices
            wire.wait_for(lambda: self.observer.stats().slices > before + 2, "it goes on")
            self.assertEqual(self.client.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
            self.assertEqual(self.client.follow(job)[-1].body.name, "cancelled")
        else:
            done = self.client.follow(job)[-1]
            self.assertEqual(done.kind, wire.DONE)
            if case.state == "begin":
                self.assertEqual(done.body.retries, case.fault != "gets no device memory")
        if "scene-quarantined" in case.answer:
            refused = self.client.ask(wire.RENDER, request(scene))
            self.assertEqual(refused.body.name, "scene-quarantined")

    def run_case(self, case):
        starts = self.observer.stats().worker_starts
        scene = self.new_scene()
        pid, job = getattr(self, "in_" + case.state)(scene)
        strike(pid, case.fault)
        if case.times == 2:
            wire.wait_for(lambda: self.observer.stats().worker_pid not in (0, pid), "the next worker starts")
            pid, job = self.in_step(scene, job)
            strike(pid, case.fault)
        self.answer_of(case, scene, job, pid)
        self.client.ask(wire.UNLOAD, pb.Unload(name=scene))
        self.assert_serves()
        lost = self.observer.stats().worker_starts - starts
        if case.state not in ("load", "start", "read") and case.fault != "gets no device memory":
            self.assertEqual(lost, case.times)

    def held(self):
        """What must not grow."""
        def look():
            stats = self.observer.stats()
            return {"descriptors": self.daemon.descriptors(), "jobs": stats.jobs, "scenes": stats.scenes, "images": stats.image_bytes,
                    "buffered": stats.buffered_bytes, "connections": stats.connections, "device": stats.device_bytes,
                    "children": len(os.listdir(f"/proc/{self.daemon.process.pid}/task")), "processes": children_of(self.daemon.process.pid),
                    "files": sorted(os.listdir(self.daemon.folder))}
        # What a quote wanted compiled is compiled to its end, whoever lost interest.
        wire.wait_for(lambda: children_of(self.daemon.process.pid) == 1, "compilers and loaders have ended")
        looks = [look()]
        while looks[-5:] != looks[-1:] * 5:
            time.sleep(.05)
            looks.append(look())
        return looks[-1]


def children_of(pid):
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
        return len(file.read().split())


class Table(Losses):
    def test_all(self):
        # What a first case brings along once, such as a scene's name in a table, is there before.
        self.run_case(CASES[0])
        held, memory = self.held(), self.daemon.rss_kib()
        for case in CASES:
            if SANITIZE and case.fault in OWN:
                continue
            began = time.monotonic()
            with self.subTest(str(case)):
                self.run_case(case)
            print(f"{case}: {time.monotonic() - began:.1f} s")
        self.assertEqual(self.held(), held)
        if not SANITIZE:
            self.assertLess(self.daemon.rss_kib() - memory, 4096)


    def test_others(self):
        for name in ("mapped", "memory", "room", "passed", "client"):
            with self.subTest(name):
                getattr(self, "other_" + name)()
                self.assert_serves()
        self.assertEqual(self.observer.stats().worker_starts, 1)

    def other_mapped(self):
        """Of the memory that the daemon has of scenes, none can be cut short, by whoever gets hold of it."""
        pid, tried = self.daemon.process.pid, 0
        for number in os.listdir(f"/proc/{pid}/fd"):
            path = f"/proc/{pid}/fd/{number}"
            if "memfd:" not in os.readlink(path):
                continue
            fd = os.open(path, os.O_RDWR)
            self.addCleanup(os.close, fd)
            self.assertGreater(os.fstat(fd).st_size, 0)
            for cut in (lambda: os.ftruncate(fd, 0), lambda: os.pwrite(fd, b"x", 0)):
                with self.assertRaises(PermissionError):
                    cut()
            tried += 1
        self.assertGreater(tried, 0)

    def limited(self, what, limit, **fields):
        """The reply to a request under a limit of the worker's, which goes again."""
        pid = self.worker()
        before = resource.prlimit(pid, what)
        resource.prlimit(pid, what, (limit, before[1]))
        reply = self.client.follow(self.client.send(wire.RENDER, request("box", **fields)))[-1]
        resource.prlimit(pid, what, before)
        return reply

    def other_memory(self):
        if SANITIZE:
            return  # its address space is no measure
        with open(f"/proc/{self.worker()}/statm", encoding="ascii") as file:
            size = int(file.read().split()[0]) * resource.getpagesize()
        reply = self.limited(resource.RLIMIT_AS, size + 64 * MIB, width=2048, height=2048)
        self.assert_says_limit(reply, "raise the limit")

    @unittest.skipIf(SANITIZE, "its address space is no measure")
    def test_limit_that_children_inherit(self):
        pid, textured = self.daemon.process.pid, os.path.basename(make.textured_quad(self.scenes))
        before = resource.prlimit(pid, resource.RLIMIT_AS)
        resource.prlimit(pid, resource.RLIMIT_AS, (256 * MIB, before[1]))
        reply = self.client.receive_for(self.client.send_load("textured", self.scenes, textured))
        self.assert_says_limit(reply, "256 MiB")
        for mib in (256, 1024):
            resource.prlimit(pid, resource.RLIMIT_AS, (mib * MIB, before[1]))
            self.another_worker()
            replies = self.client.follow(self.client.send(wire.RENDER, request("box")))
            self.assert_says_limit(replies[-1], f"{mib} MiB")
        resource.prlimit(pid, resource.RLIMIT_AS, before)
        self.another_worker()
        self.assert_serves()
        self.assertEqual(self.observer.stats().worker_starts, 4)

    def another_worker(self):
        old = self.observer.stats().worker_pid
        os.kill(old, signal.SIGKILL)
        wire.wait_for(lambda: self.observer.stats().worker_pid not in (0, old), "the next starts")

    def assert_says_limit(self, reply, limit):
        self.assertEqual(reply.body.name, "memory", reply)
        self.assertEqual(reply.body.message.count("ulimit -v"), 1, reply)
        self.assertIn(limit, reply.body.message)

    def other_room(self):
        reply = self.limited(resource.RLIMIT_FSIZE, 1024, width=64, height=64)
        self.assertEqual(reply.body.name, "memory", reply)
        self.assertIn("ulimit -f", reply.body.message)
        # A loader gets the front's limit.
        pid = self.daemon.process.pid
        before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (1024, before[1]))
        reply = self.client.receive_for(self.client.send_load("large", self.scenes, os.path.basename(make.cornell(self.scenes))))
        resource.prlimit(pid, resource.RLIMIT_FSIZE, before)
        self.assertEqual(reply.body.name, "memory", reply)
        self.assertIn("ulimit -f", reply.body.message)

    def other_passed(self):
        """The kernel counts them by user, and holds each sender's count to that sender's own limit of open files."""
        passed = []
        for _ in range(100):
            passed.append(socket.socketpair())
            socket.send_fds(passed[-1][0], [b"x"], [0])
        self.new_scene()
        # The worker's limit is below that: its picture waits.
        before = resource.prlimit(self.worker(), resource.RLIMIT_NOFILE)
        resource.prlimit(self.worker(), resource.RLIMIT_NOFILE, (90, before[1]))
        job = self.client.send(wire.RENDER, request("box"))
        wire.wait_for(lambda: "on their way" in self.daemon.log_text(), "the worker has tried")
        for pair in passed:
            for end in pair:
                end.close()
        self.assertEqual(self.client.follow(job)[-1].kind, wire.DONE)
        resource.prlimit(self.worker(), resource.RLIMIT_NOFILE, before)

    def other_client(self):
        with self.daemon.connect() as gone:
            gone.send(wire.RENDER, request("box", samples=1 << 20))
            wire.wait_for(lambda: self.observer.stats().jobs == 1, "it is begun")
        wire.wait_for(lambda: self.observer.stats().jobs == 0, "its job is gone")


class WithoutCodec(Losses):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="candil-programs-")
        self.addCleanup(folder.cleanup)
        for name in ("candil-loader", "candil-worker"):
            shutil.copy(os.path.join(FAULTY, name), folder.name)
        self.libexec = folder.name
        self.picture = None
        super().setUp()

    def radiance(self, replies):
        return replies[-1].body.name

    def test_codec(self):
        self.assertEqual(self.picture, "encode")
        self.assert_serves()  # so does the next request end
        self.assertEqual(self.observer.stats().worker_starts, 1)


class Device(Losses):
    """The worker aborts three times while it is idle."""
    def abort(self):
        for number in range(3):
            pid = self.worker()
            os.kill(pid, signal.SIGABRT)
            wire.wait_for(lambda: self.observer.stats().worker_pid not in (0, pid), "the next starts")
            self.assertEqual(self.observer.stats().device_losses, number + 1)
            self.assertEqual(bool(self.observer.stats().device_note), number == 2)
            self.assert_serves()

    def assert_told(self, sentence):
        stats = self.observer.stats()
        self.assertRegex(stats.device_note, sentence)
        job = self.client.send(wire.RENDER, request("box"))
        self.assertIn(stats.device_note, self.client.receive_for(job).body.notes)
        self.client.follow(job)
        told = subprocess.run([os.path.join(wire.BUILD, "bin", "candil"), "--connect", self.daemon.socket, "doctor", "--json"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=False)
        self.assertEqual(json.loads(told.stdout)["daemon"]["note"], stats.device_note)

    def devices(self):
        """Numbers of the devices that workers have opened."""
        return [int(number) for number in re.findall(r"worker.*device (\d+): ", self.daemon.log_text())]


@unittest.skipIf(SANITIZE, "AddressSanitizer has its own end for what aborts")
class Only(Device):
    arguments = (*Losses.arguments, "--device", "0")

    def test_only(self):
        self.abort()
        self.assert_told("was lost 3 times within 10 minutes, and no other device is there that may be used")
        self.assertEqual(set(self.devices()), {0})


@unittest.skipIf(SANITIZE, "AddressSanitizer has its own end for what aborts")
@unittest.skipUnless(glob.glob(MANIFESTS), "there is no software driver to be listed twice")
class Next(Device):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="candil-drivers-")
        self.addCleanup(folder.cleanup)
        copies = [os.path.join(folder.name, name) for name in ("one.json", "two.json")]
        for copy in copies:
            shutil.copy(glob.glob(MANIFESTS)[0], copy)
        self.environment = {name: ":".join(copies) for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")}
        super().setUp()

    def test_device(self):
        self.abort()
        self.assert_told("was lost 3 times within 10 minutes: .* is used until candild starts anew")
        opened = self.devices()  # by workers, and by those that compile for them
        self.assertEqual(opened, sorted(opened))
        self.assertEqual(set(opened), {0, 1})


class Page(unittest.TestCase):
    def test_page_has_the_cases(self):
        if os.environ.get("CANDIL_TABLE") == "write":
            with open(PAGE, "w", encoding="utf-8") as file:
                file.write(page())
        with open(PAGE, encoding="utf-8") as file:
            self.assertEqual(file.read(), page(), "CANDIL_TABLE=write ctest -R hard_losses writes it")
        self.assertGreaterEqual(len(CASES) + len(OTHERS), 40)


if __name__ == "__main__":
    unittest.main()
