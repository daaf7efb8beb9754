"""The house keeps its order: no circle of files but the one that is meant, and no file knows a technique but the technique's own
folder and the lists that name them all."""
import json
import os
import re
import subprocess
import unittest

SOURCE = os.environ["CANDIL_SOURCE"]
BUILD = os.environ["CANDIL_BUILD"]

# An edited scene's voxels are built from those of the scene that it was: one of the two files must call back.
MEANT_CIRCLES = [{"server/worker/technique/voxel/voxel_build.c", "server/worker/technique/voxel/voxels.c"}]

# A technique that stands on another's floor.
STANDS_ON = {"radiosity": {"direct"}, "vct": {"direct"}}

# Lists that name every technique, from the checkout's root.
LISTS = {"protocol/names.h", "protocol/candil.proto", "server/worker/technique/techniques.c", "shaders/CMakeLists.txt"}


def read(path):
    with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
        return file.read()


def objects():
    """Of every source file that is built, but tests: its object file."""
    with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
        commands = json.load(file)
    found = {}
    for command in commands:
        path = os.path.relpath(command["file"], SOURCE)
        if path.startswith(("server/", "protocol/", "clients/")):
            output = command.get("output") or re.search(r" -o (\S+)", command["command"])[1]
            found.setdefault(path, os.path.join(BUILD, output))
    return {path: output for path, output in found.items() if os.path.exists(output)}


def calls():
    """Of every source file: those that define a name that it uses and does not define."""
    defined, used = {}, {}
    for path, output in objects().items():
        told = subprocess.run(["nm", "--format=posix", output], capture_output=True, text=True, check=True).stdout
        for line in told.splitlines():
            name, kind = line.split()[:2]
            if kind in "TDBRC":
                defined.setdefault(name, set()).add(path)
            elif kind == "U":
                used.setdefault(path, set()).add(name)
    # A name that two programs define is each program's own.
    only = {name: next(iter(paths)) for name, paths in defined.items() if len(paths) == 1}
    return {path: {only[name] for name in names if name in only} - {path} for path, names in used.items()}


def circles(graph):
    """Sets of files that reach each other."""
    def reach(start):
        seen, left = set(), [start]
        while left:
            for path in graph.get(left.pop(), ()):
                if path not in seen:
                    seen.add(path)
                    left.append(path)
        return seen
    reached = {path: reach(path) for path in graph}
    found = []
    for path in sorted(graph):
        if path in reached[path] and not any(path in circle for circle in found):
            found.append({other for other in reached[path] if path in reached.get(other, ())})
    return found


def techniques():
    """{"pt": "PT", …}, but "auto"."""
    found = re.findall(r'\bX\(([A-Z_]+), \d+, "([a-z]+)", [^"]*?\)', read("protocol/names.h"))
    return {word: name for name, word in found if name != "AUTO"}


def code(path):
    """A source without its comments, strings kept."""
    text = re.sub(r"/\*.*?\*/", " ", read(path), flags=re.DOTALL)
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m[1] or " ", text)


def knows(text, word, name):
    """The first sign in a source that it knows a technique: its number, its table, its folder, its name as a word of its own, an
    option of it."""
    signs = (rf"TECHNIQUE_{name}\b(?!S)", rf"\btechnique_{word}\b", rf'"[\w/.]*\b(?:technique|shaders)/{word}/', rf'#include "{word}/',
             rf'"{word}"', rf'"(?:[^"\n]*[\s(])?{word}\.[a-z_]+[^"\n]*"')
    for sign in signs:
        found = re.search(sign, text)
        if found:
            return found[0]
    return None


class House(unittest.TestCase):
    def test_no_circle_but_the_one_that_is_meant(self):
        graph = calls()
        self.assertGreater(len(graph), 150)
        self.assertEqual([sorted(circle) for circle in circles(graph)], [sorted(circle) for circle in MEANT_CIRCLES])

    def test_circles_are_found(self):
        self.assertEqual(circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": set()}), [{"a", "b", "c"}])

    def test_no_file_knows_a_technique_but_its_own(self):
        named = techniques()
        self.assertLessEqual({"pt", "direct", "vct"}, set(named))
        seen = 0
        for folder in ("server", "shaders", "clients", "protocol"):
            for at, _, files in os.walk(os.path.join(SOURCE, folder)):
                for file in files:
                    path = os.path.relpath(os.path.join(at, file), SOURCE)
                    if path in LISTS or not path.endswith((".c", ".h", ".cpp", ".glsl", ".txt")):
                        continue
                    seen += 1
                    own = set(path.split(os.sep)) & set(named)
                    own |= {other for word in own for other in STANDS_ON.get(word, ())}
                    for word, name in named.items():
                        if word not in own:
                            with self.subTest(path=path, technique=word):
                                self.assertIsNone(knows(code(path), word, name))
        self.assertGreater(seen, 300)

    def test_who_knows_a_technique_is_found(self):
        for text in ("if (t == candil_Technique_TECHNIQUE_PT)", "return &technique_pt;", '#include "server/worker/technique/pt/pt.h"',
                     '#include "pt/sky.glsl"', 'strcmp(name, "pt")', 'option("pt.depth")'):
            self.assertTrue(knows(text, "pt", "PT"), text)
        for text in ("TECHNIQUE_PTX", '"script.pt"', '"prompt"', "opt.depth"):
            self.assertIsNone(knows(text, "pt", "PT"), text)


if __name__ == "__main__":
    unittest.main()
