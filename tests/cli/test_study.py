"""candil study: a folder that is complete, goes on wherever it was cut short, and says what is missing; plan files and folders of
strangers."""
import contextlib
import fcntl
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
import unittest

import images
from common import CANDIL, MTL, OBJ, SOURCE, DaemonCase, run, skip_without_device

PLAN = {
    "title": "a tiny study",
    "size": [32, 24],
    "seeds": 2,
    "repeats": 1,
    "reference": {"relmse": 0.5, "samples": 64, "settings": {"pt.depth": 9}},
    "points": [
        {"technique": "pt", "settings": {"samples": [1, 4]}},
        {"technique": "pt", "settings": {"samples": 4}, "effects": "auto,-bounces"},
        {"technique": "direct", "settings": {"samples": 1, "direct.samples": [1, 4]}},
        {"technique": "vct", "settings": {"vct.resolution": 16}},
    ],
}
# 1 reference; 2 cold and 3 x 2 runs of pt; a cold and a warm one of each of the other 3 points.
RUNS = 1 + 2 + 6 + 3 * 2
# What is made for one: perhaps something before it that warms up, or that waited for others on a busy machine.
ONE = (1, 2, 3)


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Study(DaemonCase):
    def setUp(self):
        super().setUp()
        self.out = os.path.join(self.folder, "study")

    def write_plan(self, plan):
        path = os.path.join(self.folder, "plan.json")
        with open(path, "w", encoding="utf-8") as file:
            file.write(plan if isinstance(plan, str) else json.dumps(plan))
        return path

    def command(self, *more, plan=PLAN, scene=None):
        return [CANDIL, "--connect", self.daemon.socket, "study", scene or self.scene, "-o", self.out, "--plan",
                self.write_plan(plan), *more]

    def study(self, *more, status=0, plan=PLAN, scene=None):
        result = run(*self.command("--json", *more, plan=plan, scene=scene))
        self.assertEqual(result.returncode, status, result)
        return json.loads(result.stdout)

    def path(self, *names):
        return os.path.join(self.out, *names)

    def lines(self):
        return [json.loads(line) for line in read(self.path("runs.jsonl")).splitlines()]

    def state(self):
        return json.loads(read(self.path("study.json")))

    def test_the_folder_is_complete(self):
        answer = self.study()
        self.assertLessEqual({"folder", "report", "complete", "missing", "skipped", "runs", "made", "seconds", "warnings"},
                             set(answer))
        self.assertEqual((answer["complete"], answer["missing"], answer["runs"]), (True, [], RUNS))
        self.assertEqual(answer["report"], os.path.realpath(self.path("report.html")))
        for name in ("report.html", "results.json", "results.csv"):
            self.assertGreater(os.path.getsize(self.path(name)), 100, name)
        state = self.state()
        self.assertTrue(state["complete"])
        self.assertEqual((state["version"], state["size"], state["seeds"], state["title"]), (1, [32, 24], 2, PLAN["title"]))
        self.assertEqual(state["settings_varied"]["direct"], ["samples", "direct.samples"])
        self.assertEqual(state["techniques"], ["pt", "vct", "radiosity", "direct"])
        self.assertEqual(len(state["scene"]["hash"]), 32)
        self.assertLessEqual({"cpu", "cores", "os", "load"}, set(state["machine"]))
        lines = self.lines()
        self.assertEqual(len(lines), RUNS)
        self.assertEqual(len({line["id"] for line in lines}), RUNS)
        for line in lines:
            self.assertEqual(images.channels(self.path(line["image"]))["R"].shape, (24, 32))
            self.assertEqual(line["report"]["scene_hash"], state["scene"]["hash"])
            self.assertEqual(line["warm"], line["report"]["cold_us"] == 0)
            self.assertIsNone(line["failed"])
            if line["kind"] in ("point", "ablation"):
                self.assertTrue(line["warm"], "what is timed has compiled nothing")
            first = line["kind"] == "reference" or (line["kind"] in ("point", "ablation") and line["seed"] == 1)
            self.assertEqual(line["quote"] is not None, first, "what a point would take was asked before")
            if first:
                self.assertEqual(line["quote"]["technique"], line["technique"])
                self.assertGreater(line["quote"]["time_ms"], 0)
        reference, = (line for line in lines if line["kind"] == "reference")
        self.assertEqual(reference["report"]["reason"], "error")
        self.assertLessEqual(reference["report"]["relmse_high"], 0.5)
        self.assertEqual((reference["settings"]["pt.depth"], reference["report"]["depth"]), (9, 9))
        self.assertNotIn(reference["seed"], {line["seed"] for line in lines if line["kind"] != "reference"})
        self.assertEqual({line["effects"] for line in lines if line["kind"] == "ablation"}, {"auto,-bounces"})
        self.assertEqual(sorted(name for name in os.listdir(self.path("images")) if name.endswith(".exr")),
                         sorted(line["id"] + ".exr" for line in lines))

    def assert_again(self, line):
        """The command of a line makes its image again."""
        words = shlex.split(line["command"])
        self.assertEqual(words[0], "candil")
        result = run(CANDIL, *words[1:], cwd=self.folder)
        self.assertEqual(result.returncode, 0, result)
        theirs, ours = images.channels(os.path.join(self.folder, line["id"] + ".exr")), images.channels(self.path(line["image"]))
        for name, values in ours.items():
            self.assertEqual(values.tobytes(), theirs[name].tobytes(), (line["command"], name))

    def test_commands_make_the_images_again_whatever_names_there_are(self):
        scene = os.path.join(self.folder, "it's $HOME; a `room` \"here\".obj")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(OBJ)
        with open(os.path.join(self.folder, "room.mtl"), "w", encoding="utf-8") as file:
            file.write(MTL)
        self.out = os.path.join(self.folder, "out 'of' $order;\u00e9")
        self.study("--camera", "0,1,4,0,1,0,0,1,0,40", "--camera", "1,1,4,0,1,0,0,1,0,40", "--light",
                   "point:at=0,1.5,1,intensity=2", "--background", "0.1,0.2,0.3", scene=scene)
        lines = self.lines()
        self.assertEqual({line["view"] for line in lines}, {0, 1})
        for kind, technique in (("reference", "pt"), ("point", "pt"), ("ablation", "pt"), ("point", "direct"), ("point", "vct")):
            found = [line for line in lines if (line["kind"], line["technique"], line["view"]) == (kind, technique, 1)]
            self.assert_again(found[-1])

    def test_the_study_of_another_scene_stays(self):
        self.study()
        before = {name: read(self.path(name)) for name in ("study.json", "runs.jsonl", "plan.json", "report.html")}
        other = os.path.join(self.folder, "other.obj")
        with open(other, "w", encoding="utf-8") as file:
            file.write(OBJ.replace("v -1 2 -1", "v -1 3 -1"))
        error = self.study(scene=other, status=2)["error"]
        self.assertEqual(error["name"], "bad-argument")
        self.assertIn("another scene", error["message"])
        self.assertEqual({name: read(self.path(name)) for name in before}, before)

    def test_what_is_done_is_not_done_again(self):
        self.study()
        before = read(self.path("runs.jsonl")), read(self.path("study.json")), os.stat(self.path("runs.jsonl")).st_mtime_ns
        answer = self.study()
        self.assertEqual((answer["made"], answer["complete"]), (0, True))
        self.assertEqual(before, (read(self.path("runs.jsonl")), read(self.path("study.json")),
                                  os.stat(self.path("runs.jsonl")).st_mtime_ns))
        point = next(line for line in self.lines() if line["kind"] == "point" and line["technique"] == "pt")
        os.remove(self.path(point["image"]))
        self.assertIn(self.study()["made"], ONE)
        self.assertEqual(len(self.lines()), RUNS)
        with open(self.path(point["image"]), "r+b") as file:
            file.truncate(1000)
        self.assertIn(self.study()["made"], ONE)
        whole = read(self.path("runs.jsonl"))
        for torn in (whole[:-20], b"\x00\xff{\n[]\n{\"id\": 3}\n{\"id\": \"../../x\"}\n" + whole[whole.index(b"\n") + 1:]):
            with open(self.path("runs.jsonl"), "wb") as file:
                file.write(torn)
            answer = self.study()
            self.assertIn(answer["made"], ONE)
            self.assertTrue(answer["complete"])
            self.assertEqual(len(self.lines()), RUNS)

    def test_what_differs_is_done_again(self):
        self.study()
        first = {line["id"] for line in self.lines()}
        for more in (["--size", "24x16"], ["--camera", "0,1,4,0,1,0,0,1,0,40"], ["--background", "1,0,0"]):
            self.study(*more)
            self.assertFalse(first & {line["id"] for line in self.lines()}, more)
        # Nothing of the others is lost, and the first is there again when it is asked for.
        others = [json.loads(line)["id"] for line in read(self.path("others.jsonl")).splitlines()]
        self.assertEqual((len(others), len(set(others)), first <= set(others)), (3 * RUNS, 3 * RUNS, True))
        answer = self.study()
        self.assertEqual((answer["made"], answer["complete"]), (0, True))
        self.assertEqual({line["id"] for line in self.lines()}, first)
        results = json.loads(read(self.path("results.json")))
        self.assertEqual(sum(len(technique["points"]) for technique in results["techniques"]), 5)

    def test_without_a_device_nothing_is_touched(self):
        self.study("--size", "8x8")
        before = {name: read(self.path(name)) for name in os.listdir(self.out) if name != "images"}
        words = [word for word in self.command("--json", "--size", "8x8") if word not in ("--connect", self.daemon.socket)]
        result = run(*words, env=dict(os.environ, VK_ICD_FILENAMES="/nothing.json", VK_DRIVER_FILES="/nothing.json",
                                      CANDIL_SOCKET=os.path.join(self.folder, "none")))
        self.assertNotEqual(result.returncode, 0, result)
        self.assertIn("device", json.loads(result.stdout)["error"]["message"])
        self.assertEqual(before, {name: read(self.path(name)) for name in os.listdir(self.out) if name != "images"})

    def test_the_report_is_of_what_is_there(self):
        small = dict(PLAN, points=PLAN["points"][2:3], reference={"relmse": 0.5, "samples": 16})
        self.study(plan=small)
        page = self.path("report.html")
        os.remove(self.path("results.csv"))
        self.assertEqual(self.study(plan=small)["made"], 0)
        self.assertTrue(os.path.exists(self.path("results.csv")))
        before = os.stat(page).st_mtime_ns
        self.study(plan=small)
        self.assertEqual(os.stat(page).st_mtime_ns, before, "nothing was to do")
        state = self.state()
        state["report_of"]["candil-report"] = "another build"
        with open(self.path("study.json"), "w", encoding="utf-8") as file:
            json.dump(state, file)
        os.utime(page, (1 << 32, 1 << 32))
        self.study(plan=small)
        self.assertLess(os.stat(page).st_mtime, 1 << 32, "a clock that is ahead keeps no old page")

    def test_no_link_leads_out_of_the_folder(self):
        small = dict(PLAN, points=PLAN["points"][2:3], reference=False)
        outside = os.path.join(self.folder, "outside")
        with open(outside, "w", encoding="utf-8") as file:
            file.write("years of work")
        self.study(plan=small)
        for name, status in (("study.json", 0), ("runs.jsonl", 1), ("others.jsonl", 1)):
            kept = self.path(name) + ".kept"
            if os.path.exists(self.path(name)):
                os.rename(self.path(name), kept)
            os.symlink(outside, self.path(name))
            result = run(*self.command("--json", plan=small))
            self.assertEqual((result.returncode, read(outside)), (status, b"years of work"), (name, result))
            os.remove(self.path(name))
            if os.path.exists(kept):
                os.rename(kept, self.path(name))
        image = self.path(self.lines()[0]["image"])
        os.remove(image)
        os.symlink(outside, image)
        self.study(plan=small)
        self.assertEqual((read(outside), os.path.islink(image)), (b"years of work", False))
        os.rename(self.path("images"), os.path.join(self.folder, "elsewhere"))
        os.symlink(os.path.join(self.folder, "elsewhere"), self.path("images"))
        self.assertIn("images/", self.study(plan=small, status=2)["error"]["message"])

    def test_numbers_are_numbers_however_they_are_written(self):
        plan = dict(PLAN, reference=False, points=[{"technique": "direct",
                                                    "settings": {"samples": 1, "direct.samples": ["08", "8", 8, 8.0, "8.0"]}}])
        self.assertEqual(self.study(plan=plan)["runs"], 2)
        self.assertEqual({line["settings"]["direct.samples"] for line in self.lines()}, {8})
        self.assertEqual(self.study(plan=json.loads(read(self.path("plan.json"))))["made"], 0)
        # This daemon has compiled all of it before.
        shutil.rmtree(self.out)
        self.study(plan=plan)
        self.assertTrue(any("no run was cold" in note for note in self.state()["notes"]), self.state()["notes"])

    def test_a_target_of_many_digits_is_the_same_when_it_goes_on(self):
        plan = dict(PLAN, points=PLAN["points"][2:3], reference={"relmse": 0.512345678901234, "samples": 16})
        self.study(plan=plan)
        command, = [line["command"] for line in self.lines() if line["kind"] == "reference"]
        self.assertIn("--error 0.512346 ", command + " ")
        self.assertEqual(self.study(plan=plan)["made"], 0)

    def test_ablations_have_what_they_stand_beside(self):
        plan = dict(PLAN, points=[{"technique": "pt", "settings": {"samples": 2, "pt.depth": 3}}], ablations=True, budget=5)
        self.study("--techniques", "pt", plan=plan)
        with open(self.path("results.json"), encoding="utf-8") as file:
            ablation = json.load(file)["ablation"]
        self.assertTrue(ablation)
        for row in ablation:
            self.assertIsNotNone(row["seconds_whole"], row)

    def start(self, plan):
        """Start a study, and wait until some of it is on disk."""
        process = subprocess.Popen(self.command(plan=plan), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        deadline = time.monotonic() + 120
        while not os.path.exists(self.path("runs.jsonl")) or read(self.path("runs.jsonl")).count(b"\n") < 4:
            self.assertIsNone(process.poll(), process.poll() is not None and process.stderr.read())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        return process

    def test_killed_and_interrupted_it_goes_on(self):
        plan = dict(PLAN, seeds=60)
        process = self.start(plan)
        process.kill()
        process.communicate()
        before = read(self.path("runs.jsonl"))
        process = subprocess.Popen(self.command(plan=plan), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        while len(read(self.path("runs.jsonl"))) <= len(before) + 2000:
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        said = process.communicate()[1]
        self.assertEqual(process.returncode, 8, said)
        self.assertIn(b"cancelled", said)
        self.assertTrue(read(self.path("runs.jsonl")).startswith(before[:before.rindex(b"\n") + 1]))
        state = self.state()
        self.assertEqual((state["complete"], state["missing"][0]["why"]),
                         (False, "not made yet: the study was interrupted"))
        before = read(self.path("runs.jsonl"))
        self.assertTrue(self.study(plan=plan)["complete"])
        self.assertTrue(read(self.path("runs.jsonl")).startswith(before), "what was done is as it was")

    def test_of_many_missing_runs_study_json_names_some(self):
        process = self.start(dict(PLAN, seeds=1000))
        process.send_signal(signal.SIGINT)
        process.communicate()
        missing = self.state()["missing"]
        self.assertEqual((len(missing), missing[-1]["run"]), (401, None))
        self.assertRegex(missing[-1]["why"], r"^2\d\d\d more runs are missing$")

    def elsewhere(self, report=None):
        """The command of a small study, by a client that is installed elsewhere and has this program for a report."""
        tree = os.path.join(self.folder, "tree")
        os.makedirs(os.path.join(tree, "bin"), exist_ok=True)
        shutil.copy(CANDIL, os.path.join(tree, "bin"))
        if report:
            program = os.path.join(tree, "libexec", "candil", "candil-report")
            os.makedirs(os.path.dirname(program), exist_ok=True)
            with open(program, "w", encoding="utf-8") as file:
                file.write(report)
            os.chmod(program, 0o755)
        small = dict(PLAN, points=PLAN["points"][2:3], reference=False)
        return [os.path.join(tree, "bin", "candil"), *self.command("--json", plan=small)[1:]]

    def test_a_missing_report_program_is_why_there_is_no_report(self):
        result = run(*self.elsewhere())
        self.assertEqual(result.returncode, 1, result)
        answer = json.loads(result.stdout)
        self.assertEqual((answer["complete"], answer["report"]), (True, None))
        self.assertIn("not installed", answer["why"])

    def test_an_interrupt_ends_the_report_too(self):
        mark = os.path.join(self.folder, "started")
        # No shell: that blocks signals of its own while it waits for a command.
        command = self.elsewhere(f"#!{sys.executable}\nimport os, signal, time\nmask = signal.pthread_sigmask(signal.SIG_BLOCK, [])\n"
                                 f"open('{mark}.tmp', 'w').write(str(len(mask)))\nos.rename('{mark}.tmp', '{mark}')\ntime.sleep(60)\n")
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        while not os.path.exists(mark):
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        # Not to the whole group, as from a terminal: the report is the study's to end.
        process.send_signal(signal.SIGINT)
        out = process.communicate(timeout=30)[0]
        self.assertEqual(process.returncode, 8, out)
        self.assertEqual(json.loads(out)["exit"], 8)
        self.assertEqual(read(mark), b"0")  # signals were blocked

    def test_a_worker_that_is_killed_costs_no_study(self):
        plan = dict(PLAN, seeds=40)
        process = self.start(plan)
        for _ in range(4):
            workers = run("pgrep", "-P", str(self.daemon.process.pid), "candil-worker").stdout.split()
            for worker in workers:  # one that compiles may have ended meanwhile
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(worker), signal.SIGKILL)
            time.sleep(0.3)
        said = process.communicate()[1]
        self.assertIn(process.returncode, (0, 1), said)
        state = self.state()
        self.assertEqual(state["complete"], process.returncode == 0)
        for missing in state["missing"]:
            self.assertIn("worker", missing["why"])
        self.assertTrue(self.study(plan=plan)["complete"])

    def test_a_full_disk_is_said_and_resumed(self):
        def study(most):
            def limit():
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
            result = subprocess.run(self.command("--json"), preexec_fn=limit, capture_output=True, timeout=300, check=False)
            self.assertEqual(result.returncode, 1, result)
            self.assertIn(b"cannot write", result.stderr)
            self.assertEqual(json.loads(result.stdout)["exit"], 1)
        study(6000)
        # The same once more, where at the end study.json has no room either: it is longer than at the start.
        written = os.stat(self.path("study.json")).st_size
        self.assertLess(written, 6000)
        shutil.rmtree(self.out)
        study(written - 60)
        self.assertTrue(self.study()["complete"])
        self.assertEqual(len(self.lines()), RUNS)

    def test_a_technique_that_cannot_is_named(self):
        answer = self.study("--panorama", status=1)
        self.assertFalse(answer["complete"])
        self.assertEqual({skipped["technique"] for skipped in answer["skipped"]}, {"vct", "direct"})
        self.assertIn("panorama", answer["skipped"][0]["why"])
        self.assertEqual({missing["run"].split("-")[1] for missing in answer["missing"]}, {"vct", "direct"})
        self.assertEqual(self.state()["skipped"], answer["skipped"])
        wrong = dict(PLAN, points=PLAN["points"] + [{"technique": "vct", "settings": {"vct.wings": 2}}])
        answer = self.study(status=1, plan=wrong)
        self.assertEqual((answer["skipped"], {missing["run"].split("-")[1] for missing in answer["missing"]}), ([], {"vct"}))
        self.assertIn("vct.wings", answer["missing"][0]["why"])

    def test_bad_plans_are_refused_with_a_sentence(self):
        point = PLAN["points"][0]
        for plan, word in (
                ("", "no JSON"), ("[]", "object"), ("{\"a\": 1, \"a\": 2}", "duplicate"), (" " * (1 << 20) + "{}", "1 MiB"),
                ({}, "points"), (dict(PLAN, sise=[1, 1]), "no key \"sise\""), (dict(PLAN, points=[]), "1 to 1024"),
                (dict(PLAN, points=[dict(point, technique="magic")]), "technique"),
                (dict(PLAN, points=[dict(point, technique="auto")]), "technique"),
                (dict(PLAN, points=[dict(point, settings={"radiosity.import": "room.ply"})]), "a study imports no file"),
                (dict(PLAN, points=[dict(point, extra=1)]), "points[0]"),
                (dict(PLAN, points=[point, 7]), "points[1]"), (dict(PLAN, points=[dict(point, settings=[])]), "settings"),
                (dict(PLAN, points=[dict(point, settings={"samples": 0})]), "16777216"),
                (dict(PLAN, points=[dict(point, settings={"samples": []})]), "1 to 64"),
                (dict(PLAN, points=[dict(point, settings={"samples": [[1]]})]), "samples"),
                (dict(PLAN, points=[dict(point, settings={"pt.depth": {}})]), "pt.depth"),
                (dict(PLAN, points=[dict(point, settings={"pt.depth": "x" * 32})]), "31 bytes"),
                (dict(PLAN, points=[dict(point, settings={"depth": 1})]), "option"),
                (dict(PLAN, points=[dict(point, settings={f"a.{i}": list(range(40)) for i in range(9)})]), "1024"),
                (dict(PLAN, points=[dict(point, settings={f"a.{i}": 1 for i in range(17)})]), "16 options"),
                (dict(PLAN, points=[{"technique": "vct", "settings": {"samples": "fit"}}]), "fit"),
                (dict(PLAN, points=[dict(point, effects="auto,-shiny")]), "effects"),
                (dict(PLAN, points=[dict(point, effects="auto,\u0007")]), "control"),
                (dict(PLAN, size=[0, 1]), "16384"), (dict(PLAN, size=[1]), "16384"), (dict(PLAN, size="1x1"), "16384"),
                (dict(PLAN, size=[3841, 2160 + 25]), "3840x2160 fits"),
                (dict(PLAN, seeds=0), "1000"), (dict(PLAN, seeds=1.5), "1000"), (dict(PLAN, seeds=1 << 40), "1000"),
                (dict(PLAN, budget=-1), "budget"), (dict(PLAN, views=[]), "32"), (dict(PLAN, views=[{}] * 33), "32"),
                (dict(PLAN, views=[{"camera": "1,2,3"}]), "ten numbers"), (dict(PLAN, views=[{"camera": ""}, 1]), "views[1]"),
                (dict(PLAN, reference={"relmse": 0}), "relmse"), (dict(PLAN, reference={"seed": 1}), "1001"),
                (dict(PLAN, reference={"settings": []}), "object"), (dict(PLAN, reference={"settings": {"a.b": [1]}}), "word"),
                (dict(PLAN, reference=3), "object"), (dict(PLAN, title="a\u0000b"), "JSON"),
                (dict(PLAN, title="t" * 128), "title"), (dict(PLAN, ablations=1), "true")):
            answer = self.study(status=2, plan=plan)
            self.assertIn(word, answer["error"]["message"], plan if len(str(plan)) < 500 else word)
        self.assertFalse(os.path.exists(self.out))
        result = run(CANDIL, "study", self.scene, "-o", self.out, "--plan", self.folder, "--json")
        self.assertEqual(result.returncode, 2, result)
        for wrong in (["--techniques", "magic"], ["--budget", "0"], ["--budget", "inf"],
                      ["--seeds", "0"], ["--camera", "1,2"], ["--quick", "--plan", "x"], ["--set", "pt.depth=1"],
                      ["--spp", "1"], ["--camera", "a"] * 33, ["--size", "16384x16384"],
                      ["--background", "./" * 1000 + "x", "--background", "./" * 1100]):
            result = run(CANDIL, "study", self.scene, "-o", self.out, *wrong)
            self.assertEqual(result.returncode, 2, (wrong, result))
            self.assertTrue(result.stderr.startswith("candil: "), result.stderr)
        self.assertFalse(os.path.exists(self.out))

    def test_a_folder_of_somebody_else_is_left_alone(self):
        os.mkdir(self.out)
        with open(self.path("thesis.tex"), "w", encoding="utf-8") as file:
            file.write("years of work")
        self.assertIn("no study", self.study(status=2)["error"]["message"])
        self.assertEqual(os.listdir(self.out), ["thesis.tex"])
        os.remove(self.path("thesis.tex"))
        held = os.open(self.out, os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
        self.assertIn("another study", self.study(status=2)["error"]["message"])
        os.close(held)
        self.assertTrue(self.study()["complete"])

    def test_every_setting_of_a_full_study_is_one_that_there_is(self):
        with open(os.path.join(SOURCE, "protocol", "names.h"), encoding="utf-8") as file:
            knobs = re.findall(r'X\("([a-z_]+)\.([a-z_]+)", "([^"]*)", "([^"]*)"\)', file.read())
        self.assertGreater(len(knobs), 5)
        small = {"vct": {"vct.resolution": 16}}
        points = [{"technique": technique, "settings": dict(small.get(technique, {}), **{f"{technique}.{name}": value})}
                  for technique, name, values, quick in knobs for value in values.split() + quick.split()]
        answer = self.study("--size", "8x8", plan={"points": points, "repeats": 1, "reference": False})
        self.assertEqual((answer["missing"], answer["complete"]), ([], True))

    def test_a_study_of_its_own_accord(self):
        def candil(*more):
            result = run(CANDIL, "--connect", self.daemon.socket, "study", self.scene, "-o", self.out, "--size", "16x16",
                         "--budget", "1", "--seeds", "1", "--json", *more)
            self.assertEqual(result.returncode, 0, result)
            return self.lines()
        lines = candil()
        without = {(line["technique"], line["effects"]) for line in lines if line["kind"] == "ablation"}
        self.assertLessEqual({("pt", "auto,-bounces"), ("pt", "auto,-emitters")}, without)
        points = [line for line in lines if line["kind"] == "point"]
        self.assertEqual({line["technique"] for line in points}, {"pt", "vct", "radiosity", "direct"})
        self.assertLessEqual({1, 4}, {line["settings"]["samples"] for line in points if line["technique"] == "pt"})
        # What does not fit into the budget is left out, and said.
        plan = json.loads(read(self.path("plan.json")))
        self.assertGreater(plan["planned"], 0)
        self.assertGreater(plan["left_out"], 0)
        self.assertTrue(any("left out" in note for note in self.state()["notes"]))
        # The plan that it made is a plan file, too.
        self.assertEqual(self.study(plan=plan)["complete"], True)
        self.assertEqual({line["id"] for line in lines}, {line["id"] for line in self.lines()})
        lines = candil("--techniques", "pt", "--effects", "auto,-bounces")
        self.assertEqual({line["effects"] for line in lines}, {"auto,-bounces", "auto,-bounces,-emitters"})


if __name__ == "__main__":
    skip_without_device()
    unittest.main()
