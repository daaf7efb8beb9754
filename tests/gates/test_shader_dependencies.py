"""An edited file of shaders/ rebuilds the modules that include it, and no others: what the build knows of every module (the
depfiles that build.ninja names) is what a reading of the sources finds. The compiler skips what #ifdef leaves out; make_source,
which writes OpenGL's sources, does not."""
import functools
import os
import re
import unittest

SOURCE = os.environ["CANDIL_SOURCE"]
BUILD = os.environ["CANDIL_BUILD"]
SHADERS = os.path.join(SOURCE, "shaders")
MADE = os.path.join(BUILD, "names", "shaders")  # by make_names
MODULE = re.compile(r"\.(comp|vert|frag|geom)\.glsl$")


@functools.lru_cache(None)
def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def sources(*folders):
    return {os.path.join(at, name) for folder in folders for at, _, names in os.walk(folder) for name in names
            if name.endswith((".glsl", ".h"))}


def includes(path, defined=None):
    """The files that come into a source, itself among them: by what is defined when its lines are reached, or all (None)."""
    found = {path}
    taken = []  # of the conditions that a line stands in: whether it holds
    for line in read(path).splitlines():
        word, _, rest = re.sub(r"\s+", " ", re.sub(r"//.*|/\*.*?\*/", "", line)).strip().partition(" ")
        if defined is not None:
            if word in ("#ifdef", "#ifndef"):
                taken.append((rest.strip() in defined) == (word == "#ifdef"))
            elif word == "#if":
                taken.append(holds(rest, defined))
            elif word == "#elif":
                raise ValueError(f"{path}: teach this test #elif")
            elif word == "#else":
                taken[-1] = None if taken[-1] is None else not taken[-1]
            elif word == "#endif":
                taken.pop()
            elif word == "#define" and False not in taken:
                defined.add(re.match(r"\w+", rest)[0])
        name = re.match(r'"(.+)"', rest) if word == "#include" else None
        if name and False not in taken:
            if None in taken:
                raise ValueError(f"{path}: cannot tell whether {name[1]} is included")
            paths_of_it = [os.path.join(folder, name[1]) for folder in (SHADERS, MADE)]
            found |= includes(next(path for path in paths_of_it if os.path.exists(path)), defined)
    return found


def holds(condition, defined):
    """Whether an #if holds; None where it asks for more than what is defined."""
    words = re.sub(r"\bdefined ?\(? ?(\w+) ?\)?", lambda name: str(name[1] in defined), condition)
    words = words.replace("&&", " and ").replace("||", " or ").replace("!", " not ")
    if re.fullmatch(r"(True|False|and|or|not|[() ])+", words):
        return bool(eval(words))
    return None


def paths(text, escape):
    """The words of a line of ninja's or make's, each a path from the build folder."""
    words = re.findall(rf"(?:{re.escape(escape)}.|\S)+", text)
    return [os.path.normpath(os.path.join(BUILD, re.sub(rf"{re.escape(escape)}(.)", r"\1", word))) for word in words]


def built():
    """Of every module: each header that is made of it, with the files that the build knows to go into it."""
    made = {}
    for block in re.split(r"\n(?=build )", read(os.path.join(BUILD, "build.ninja"))):
        outputs, _, inputs = block.partition("\n")[0].partition(": CUSTOM_COMMAND ")
        module = next((path for path in paths(inputs, "$") if MODULE.search(path)), None)
        if not module:
            continue
        header = paths(outputs, "$")[1]
        depfile = re.search(r"^  depfile = (.+)$", block, re.MULTILINE)
        target, _, files = read(os.path.join(BUILD, depfile[1])).partition(":") if depfile else ("", "", "")
        known = paths(files.replace("\\\n", " "), "\\") if paths(target, "\\") == [header] else []
        made.setdefault(module, {})[os.path.relpath(header, BUILD)] = set(known)
    return made


class Dependencies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.built = built()
        cls.known = {header: files for headers in cls.built.values() for header, files in headers.items()}
        cls.needed = {header: includes(module, None if header.startswith("shaders/gl/") else {"GL_core_profile", "VULKAN"})
                      for module, headers in cls.built.items() for header in headers}

    def test_every_module_is_built(self):
        modules = {path for path in sources(SHADERS, os.path.join(SOURCE, "tests")) if MODULE.search(path)}
        self.assertGreater(len(modules), 20)
        self.assertEqual(set(self.built), modules)

    def test_a_header_depends_on_what_its_module_includes(self):
        for header, files in self.known.items():
            with self.subTest(header=header):
                self.assertEqual(files, self.needed[header])

    def test_an_edited_file_rebuilds_the_modules_that_include_it(self):
        for path in sources(SHADERS, MADE):
            with self.subTest(file=path):
                needed = {header for header, files in self.needed.items() if path in files}
                self.assertTrue(needed, "nothing includes it")
                self.assertEqual({header for header, files in self.known.items() if path in files}, needed)


if __name__ == "__main__":
    unittest.main()
