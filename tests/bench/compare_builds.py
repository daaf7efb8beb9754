#!/usr/bin/env python3
"""Holds the pictures of one build against another's, bit by bit, and all that they say beside them but times and sizes.

    /usr/bin/python3 tests/bench/compare_builds.py --old BUILD --new BUILD      each asked the same, side by side
                                                   --new BUILD --record FILE    what it answers, as JSON
                                                   --new BUILD --check FILE     held against that

--only WORD takes the requests whose names have the word; --keep FOLDER leaves the pictures there. One line a request: "same" (with
the sentence, where both refuse it), or DIFFERENT and what. It ends with 1 if anything differs, and also if some option, a word of one, an
effect on or off or a technique is asked for nowhere: what is added to the service is to be added to compare_requests.py.

Compared are decoded pixels of all channels, not files, whose metadata tells times. Pictures are of a device: a record holds on the
one that it was made on."""
import argparse
import collections
import concurrent.futures
import contextlib
import hashlib
import json
import os
import re
import shlex
import shutil
import sys
import tempfile

import numpy

import bench
import compare_requests
import images
from render import Daemon

PICTURES = (".exr", ".png")
# Times, what they depend on, sizes that follow from them or from how a build lays out its memory, and names of files.
UNSTEADY = {"image", "output", "file", "bytes", "job_bytes", "blob_bytes", "hash", "scene_hash", "elapsed_us", "cold_us", "load_us", "stages", "us",
            "cost_us", "share", "slices", "device"}
METADATA = re.compile(r"candil/(?!device$|version$|.*_us$|.*_hash$)")
DIGEST = re.compile(r"pictures\.(.+)\.pixels\.(.+)\.2: ")  # what differences() says of a channel's
SIZE = {"render": "64x48", "sweep": "32x24", "inspect": "32x32"}
OUTPUT = {"render": "picture.{}", "sweep": "{{index}}.{}", "inspect": "voxels"}

Answer = collections.namedtuple("Answer", "told pixels")  # what is recorded, and {file: {channel: array}}


def digest(data):
    return hashlib.sha256(data).hexdigest()[:32]


def content(path):
    """Of a scene's file, or of what a picture shows: OpenImageIO writes the time into an EXR."""
    if path.endswith(PICTURES):
        return digest(images.rgb(path).tobytes())
    with open(path, "rb") as file:
        return digest(file.read())


def steady(value):
    """A report without what differs from run to run."""
    if isinstance(value, dict):
        return {key: steady(inner) for key, inner in value.items() if key not in UNSTEADY}
    return [steady(inner) for inner in value] if isinstance(value, list) else value


def command(line, output):
    """The arguments of `candil` for a request."""
    words = shlex.split(line)
    kind = words[0]
    if kind == "describe":
        return words + ["--json"]
    extension = "png" if "--format png" in line else "exr"
    words += ["-o", os.path.join(output, OUTPUT[kind].format(extension)), "--json"]
    if "--size" not in words:
        words += ["--size", SIZE[kind]]
    if "--spp" not in words and "--technique" not in words and kind != "inspect":
        words += ["--spp", "4"]
    return words


class Build:
    """A daemon of one build, the scenes that it has loaded, and its answers. `folder` has the scenes' files."""

    def __init__(self, path, folder, keep=None):
        self.daemon = Daemon(build=os.path.abspath(path))
        self.folder = folder
        self.keep = keep
        self.loaded = set()

    def __enter__(self):
        self.daemon.__enter__()
        return self

    def __exit__(self, *why):
        self.daemon.__exit__(*why)

    def device(self, scenes):
        """Known once there was something to do for it."""
        self.daemon.candil(*command(f"render {scenes['first']} --technique direct", self.daemon.folder))
        return self.daemon.stats()["device"]

    def run(self, words):
        """(status, standard output, standard error), without the folders' names."""
        status, out, err = self.daemon.candil(*(word.replace("FOLDER", self.folder) for word in words), check=False)
        return status, *(text.replace(self.folder, "FOLDER").replace(self.daemon.folder, "DAEMON").strip() for text in (out, err))

    def load(self, line, scenes):
        for name in shlex.split(line):
            if name in scenes and name not in self.loaded:
                self.daemon.candil("load", scenes[name], "--name", name)
                self.loaded.add(name)

    def answer(self, name, line, scenes):
        self.load(line, scenes)
        output = os.path.join(self.daemon.folder, "answer")
        os.mkdir(output)
        status, out, err = self.run(command(line, output))
        told = {"request": line, "status": status, "said": err, "report": steady(json.loads(out)) if out.startswith("{") else out}
        pixels = {file: images.channels(os.path.join(output, file)) for file in sorted(os.listdir(output)) if file.endswith(PICTURES)}
        told["pictures"] = {file: self.picture(os.path.join(output, file), channels) for file, channels in pixels.items()}
        if self.keep:
            shutil.copytree(output, os.path.join(self.keep, re.sub(r"\W+", "_", name)), dirs_exist_ok=True)
        shutil.rmtree(output)
        return Answer(told, pixels)

    @staticmethod
    def picture(path, channels):
        types = images.channel_types(path)
        return {"pixels": {name: [types[name], "%dx%d" % pixels.shape[::-1], digest(pixels.tobytes())] for name, pixels in channels.items()},
                "metadata": {name: value for name, value in images.metadata(path).items() if METADATA.match(name)}}


def differences(old, new, where=""):
    """Sentences, one a leaf of the two that is not the same."""
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        old, new = dict(enumerate(old)), dict(enumerate(new))
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return [] if old == new else [f"{where}: {json.dumps(old, ensure_ascii=False)}, now {json.dumps(new, ensure_ascii=False)}"]
    found = []
    for key in [*old, *(key for key in new if key not in old)]:
        place = f"{where}.{key}" if where else str(key)
        if key in old and key in new:
            found += differences(old[key], new[key], place)
        else:
            found.append(f"{place} is {'gone' if key in old else 'new'}")
    return found


def unlike(old, new):
    """How far two pictures are apart, where both are at hand."""
    for file, channels in old.items():
        for name, pixels in channels.items():
            other = new.get(file, {}).get(name)
            if other is None or other.shape != pixels.shape or other.tobytes() == pixels.tobytes():
                continue
            apart = numpy.abs(other.astype(numpy.float64) - pixels)
            yield f"{file} {name}: {numpy.count_nonzero(other != pixels)} of {pixels.size} pixels, by up to {apart.max():.3g}"


def verdict(old, new):
    """(is it the same, a line's end)"""
    apart = list(unlike(old.pixels, new.pixels))
    told = []
    for text in differences(old.told, new.told):
        bits = DIGEST.match(text)
        if not bits:
            told.append(text)
        elif not old.pixels:
            apart.append("{0} {1}: other bits".format(*bits.groups()))
    if apart or told:
        return False, "DIFFERENT " + "; ".join(apart + told)
    return True, "same" + (f", refused with {new.told['status']}: {new.told['said']}" if new.told["status"] else "")


def uncovered(build, lines, answers):
    """What no request asks for: options and their words as the daemon itself lists them, effects as its replies do, techniques."""
    said = " ".join(lines.values())
    for technique in ("pt", "direct", "vct"):
        # The sentence lists those of one technique.
        known = build.run(command(f"render first --technique {technique} --set {technique}.none_such=1", "FOLDER"))[2]
        names = re.search(rf"known are {technique}\.([\w, ]+)", known)
        assert names, known
        for name in names.group(1).strip().split(", "):
            option = f"{technique}.{name}"
            if f"--set {option}=" not in said:
                yield f"option {option}"
            words = build.run(command(f"render first --technique {technique} --set {option}=none_such", "FOLDER"))[2]
            words = re.search(r" is one of ([^']*), not", words)
            for word in words.group(1).split(", ") if words else ():
                if f"--set {option}={word}" not in said:
                    yield f"{option}={word}"
    reports = [answer.told["report"] for answer in answers if isinstance(answer.told["report"], dict)]
    for name in dict.fromkeys(effect["name"] for report in reports for effect in report.get("effects", ())):
        yield from (f"effect {sign}{name}" for sign in "+-" if f"{sign}{name}" not in said)
    for technique in {"pt", "direct", "vct"} - {report.get("technique") for report in reports}:
        yield f"technique {technique}"


def ask(builds, lines, scenes):
    """(name, one answer a build) of each request, the builds at work at the same time."""
    files = {name: content(path) for name, path in scenes.items()}
    with concurrent.futures.ThreadPoolExecutor(len(builds)) as pool:
        for name, line in lines.items():
            answers = list(pool.map(lambda build, n=name, l=line: build.answer(n, l, scenes), builds))
            for answer in answers:
                answer.told["scenes"] = {word: files[word] for word in shlex.split(line) if word in files}
            yield name, answers


class Record:
    """A file of answers: {"device": …, "answers": {name: what was told}}."""

    def __init__(self, path, device):
        with open(path, encoding="utf-8") as file:
            self.known = json.load(file)
        if self.known["device"] != device:
            print(f"recorded on {self.known['device']}, and this is {device}: other bits are to be expected")

    def hold(self, name, answer):
        told = self.known["answers"].get(name)
        if told is None:
            return False, "DIFFERENT: the record has no such request"
        # As JSON keeps it.
        return verdict(Answer(told, {}), Answer(json.loads(json.dumps(answer.told)), answer.pixels))

    def left(self, lines):
        return [name for name in self.known["answers"] if name not in lines]

    @staticmethod
    def write(path, device, answers):
        known = {"device": device, "answers": {name: answer.told for name, answer in answers.items()}}
        with open(path, "w", encoding="utf-8") as file:
            json.dump(known, file, indent=1, ensure_ascii=False)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--old", metavar="BUILD", help="the build's folder that is held to")
    parser.add_argument("--new", metavar="BUILD", default=bench.BUILD, help="a build's folder; default: CANDIL_BUILD, else build")
    parser.add_argument("--record", metavar="FILE")
    parser.add_argument("--check", metavar="FILE")
    parser.add_argument("--only", metavar="WORD", default="")
    parser.add_argument("--keep", metavar="FOLDER")
    given = parser.parse_args()
    if sum(map(bool, (given.record, given.check, given.old))) != 1:
        parser.error("what is it for? --old BUILD, --record FILE or --check FILE: one of them")
    return given


def compare(given, lines, every, builds, scenes):
    """(how many are the same, how many are not), each with a line"""
    device = builds[-1].device(scenes)
    record = Record(given.check, device) if given.check else None
    counts, answers = [0, 0], {}
    for name, found in ask(builds, lines, scenes):
        answers[name] = found[-1]
        same, text = record.hold(name, found[-1]) if record else verdict(found[0], found[-1])
        if given.record:
            text = text.replace("same", "recorded", 1)
        print(f"{name:<44} {text}", flush=True)
        counts[not same] += 1
    for name in record.left(every) if record else ():
        print(f"{name:<44} DIFFERENT: recorded, and asked no more")
        counts[True] += 1
    if given.record:
        Record.write(given.record, device, answers)
    missing = [] if given.only else list(uncovered(builds[-1], lines, answers.values()))
    for what in missing:
        print(f"asked for nowhere: {what}")
    return counts, missing


def main():
    given = parse()
    every = compare_requests.requests()
    lines = {name: line for name, line in every.items() if given.only in name}
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="candil-scenes-"))
        scenes = {name: write(folder) for name, write in compare_requests.SCENES.items()}
        builds = [stack.enter_context(Build(path, folder, given.keep and os.path.join(given.keep, which)))
                  for which, path in (("old", given.old), ("new", given.new)) if path]
        (same, different), missing = compare(given, lines, every, builds, scenes)
    print(f"{same} {'recorded' if given.record else 'same'}, {different} different")
    sys.exit(1 if different or missing else 0)


if __name__ == "__main__":
    main()
