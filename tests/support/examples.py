"""Examples in the comments of headers: found, compiled with the project's warnings, and run.

An example is a comment line that says "Example:", perhaps with words behind it, and the comment lines after it that are
indented by a tab. A rule for each header says what stands around an example; one with a `main` of its own stands alone.
"""
import dataclasses
import json
import os
import re
import shlex
import subprocess

BUILD = os.environ["CANDIL_BUILD"]
SOURCE = os.environ["CANDIL_SOURCE"]
SKIPPED = 77


@dataclasses.dataclass
class Rule:
    """What stands around the examples of one header."""
    header: str  # beneath the source tree
    like: str  # the source file whose compiler options the examples get
    link: tuple  # what the linker gets
    prologue: str  # before all examples of the header
    parameter: str  # of the function that an example becomes
    begin: str  # its first lines
    main: str  # after all examples: calls examples[argv[1]]
    arguments: tuple = ()  # of the program, after that number


class Failed(Exception):
    pass


class Skipped(Exception):
    """The example's program found no device."""


def extract(text):
    """[(line, code)] of every example in a header's text."""
    lines = text.splitlines()
    found = []
    for number, line in enumerate(lines):
        if not re.match(r"\s*// Example:", line):
            continue
        code = []
        for after in lines[number + 1:]:
            piece = re.fullmatch(r"\s*//(?:\t(.*)|)", after)
            if not piece:
                break
            code.append(piece.group(1) or "")
        found.append((number + 2, "\n".join(code).rstrip() + "\n"))
    return found


def options_like(source):
    """The compiler and the options that a source file of the tree is compiled with."""
    with open(os.path.join(BUILD, "compile_commands.json")) as file:
        commands = {entry["file"]: entry["command"] for entry in json.load(file)}
    words = shlex.split(commands[os.path.join(SOURCE, source)])
    kept, skip = [words[0]], False
    for word in words[1:]:
        if not skip and word not in ("-o", "-MT", "-MF", "-c", "-MD"):
            kept.append(word)
        skip = word in ("-o", "-MT", "-MF", "-c")
    return kept


def link_like(program, source):
    """What the linker gets for a program of the build tree, without the object of its one `source`."""
    with open(os.path.join(BUILD, "CMakeCache.txt")) as file:
        ninja = re.search(r"^CMAKE_MAKE_PROGRAM:\w+=(.*)$", file.read(), re.MULTILINE).group(1)
    commands = subprocess.run([ninja, "-C", BUILD, "-t", "commands", program], capture_output=True, check=True).stdout
    line = commands.decode().splitlines()[-1]  # ": && cc … -o PROGRAM … && :"
    linker, *words = shlex.split(line.split("&&")[1])
    if linker.endswith("++"):
        words.append("-lstdc++")  # an example is C, and so is what links it
    at = words.index("-o")
    assert words[at + 1] == program, line
    return tuple(word for word in words[:at] + words[at + 2:] if not word.endswith(f"/{source}.o"))


def compile_program(rule, source, folder, name):
    path, program = os.path.join(folder, name + ".c"), os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(source)
    command = [*options_like(rule.like), path, "-o", program, *rule.link]
    # Assertions count in every build. A link line's relative paths start in the build tree.
    result = subprocess.run([word for word in command if word != "-DNDEBUG"], capture_output=True, cwd=BUILD)
    if result.returncode != 0:
        raise Failed(f"an example of {rule.header} does not compile:\n{result.stderr.decode()}")
    return program


def wrapped(rule, examples):
    """One program of all examples that are pieces of a function. Messages of the compiler name the header's lines."""
    source = rule.prologue
    for index, (line, code) in enumerate(examples):
        source += f"\nstatic void example_{index}({rule.parameter})\n{{\n{rule.begin}#line {line} \"{rule.header}\"\n{code}}}\n"
    names = ", ".join(f"example_{index}" for index in range(len(examples)))
    return f'{source}#line 1 "main"\nstatic void (*const examples[])({rule.parameter}) = {{{names}}};\n{rule.main}'


def build(rule, text, folder):
    """[(where, command)] of every example of a header."""
    alone, pieces, runs = [], [], []
    for line, code in extract(text):
        if not code.strip():
            raise Failed(f"{rule.header}:{line}: the example is empty")
        (alone if re.search(r"^int main\(", code, re.MULTILINE) else pieces).append((line, code))
    name = os.path.basename(rule.header).replace(".", "_")
    for index, (line, code) in enumerate(alone):
        source = f'#line {line} "{rule.header}"\n{code}'
        runs.append((f"{rule.header}:{line}", [compile_program(rule, source, folder, f"{name}_{index}")]))
    if pieces:
        program = compile_program(rule, wrapped(rule, pieces), folder, name)
        runs += [(f"{rule.header}:{line}", [program, str(index), *rule.arguments]) for index, (line, _) in enumerate(pieces)]
    return runs


def run(where, command, folder):
    """No daemon is at the default address, whatever runs on this machine."""
    env = dict(os.environ, XDG_RUNTIME_DIR=folder, LD_LIBRARY_PATH=os.path.join(BUILD, "lib"))
    result = subprocess.run(command, cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, timeout=300)
    if result.returncode == SKIPPED:
        raise Skipped(where)
    if result.returncode != 0:
        raise Failed(f"the example at {where} fails with {result.returncode}: {result.stderr.decode()}")


def read(path):
    with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
        return file.read()


def check_that_bad_examples_are_found(rule, wrong, folder):
    """An example that the compiler warns of, an empty one, and one whose line `wrong` fails at run time."""
    rule = dataclasses.replace(rule, header="bad.h")
    for text, work in (("// Example:\n//\tint unused;\n", lambda t: build(rule, t, folder)),
                       ("// Example:\n\n", lambda t: build(rule, t, folder)),
                       (f"// Example:\n//\t{wrong}\n", lambda t: run(*build(rule, t, folder)[0], folder))):
        try:
            work(text)
        except Failed:
            continue
        raise AssertionError("this example should fail: " + text)
