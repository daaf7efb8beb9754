"""Every example in the headers' comments compiles with the project's warnings and runs.

An example is a comment line that says "Example:", perhaps with words behind it, and the comment lines after it that are
indented by a tab. A rule for each header says what stands around an example; one with a `main` of its own stands alone.
"""
import dataclasses
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from common import BUILD, SOURCE, Daemon, environment, skip_without_device

PUBLIC_PROLOGUE = """
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <candil.h>

static void die(const char *why)
{
	fprintf(stderr, "%s\\n", why);
	exit(1);
}

// See every request through that an example has left open. A failure that the example did not ask for ends the program.
static void see_through(candil_client *client)
{
	static struct candil_event event;
	struct candil_error error;
	candil_status status;
	while ((status = candil_ping(client, NULL, &error)) == CANDIL_STATUS_BAD_ARGUMENT) {
		struct pollfd p = {candil_fd(client), (short)(POLLIN | (candil_wants_write(client) ? POLLOUT : 0)), 0};
		poll(&p, 1, 1000);
		if (candil_process(client, &error) != CANDIL_STATUS_OK)
			die(error.text);
		while (candil_next_event(client, &event))
			if (event.kind == CANDIL_EVENT_ERROR && event.u.error.code != CANDIL_STATUS_CANCELLED)
				die(event.u.error.text);
	}
	if (status != CANDIL_STATUS_OK)
		die(error.text);
}
"""

PUBLIC_MAIN = """
int main(int argc, char **argv)
{
	struct candil_error error;
	candil_client *client;
	if (argc != 2 || candil_connect(NULL, &client, &error) != CANDIL_STATUS_OK ||
	    candil_load_file(client, "room", "room.gltf", NULL, &error) != CANDIL_STATUS_OK)
		die("no daemon with a room");
	examples[atoi(argv[1])](client);
	see_through(client);
	candil_disconnect(client);
	return 0;
}
"""


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


PUBLIC = dict(like="tests/cli/multiplex.c", link=("-L" + os.path.join(BUILD, "lib"), "-lcandil", "-lm"),
              prologue=PUBLIC_PROLOGUE, parameter="candil_client *client",
              begin="\tstruct candil_error error = {0};\n\t(void)client;\n\t(void)error;\n", main=PUBLIC_MAIN)
RULES = [Rule("clients/libcandil/candil.h", **PUBLIC), Rule("clients/libcandil/candil_types.h", **PUBLIC)]


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


class Failed(Exception):
    pass


def compile_program(rule, source, folder, name):
    path, program = os.path.join(folder, name + ".c"), os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(source)
    result = subprocess.run([*options_like(rule.like), path, "-o", program, *rule.link], capture_output=True)
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
        runs += [(f"{rule.header}:{line}", [program, str(index)]) for index, (line, _) in enumerate(pieces)]
    return runs


def run(where, command, folder):
    env = dict(environment(folder), LD_LIBRARY_PATH=os.path.join(BUILD, "lib"))
    result = subprocess.run(command, cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, timeout=300)
    if result.returncode != 0:
        raise Failed(f"the example at {where} fails with {result.returncode}: {result.stderr.decode()}")


def read(path):
    with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
        return file.read()


def check_every_function_has_one():
    header = read("clients/libcandil/candil.h")
    functions = set(re.findall(r"^CANDIL_API [^;]*?\b(candil_\w+)\(", header, re.MULTILINE))
    code = "".join(code for rule in RULES for _, code in extract(read(rule.header)))
    missing = {name for name in functions if not re.search(rf"\b{name}\(", code)}
    assert len(functions) > 30 and not missing, missing


def check_every_declaration_is_explained():
    """A function, a structure or an enumeration has a comment right above it."""
    for rule in RULES:
        lines = read(rule.header).splitlines()
        for number, line in enumerate(lines):
            if re.match(r"(CANDIL_API|typedef|struct \w+ \{|enum \w+ \{)", line):
                assert re.match(r"//", lines[number - 1]), f"{rule.header}:{number + 1}: nothing explains this: {line}"


def check_that_a_bad_example_is_found(folder):
    rule = dataclasses.replace(RULES[0], header="bad.h")
    for text, work in (("// Example:\n//\tint unused;\n", lambda t: build(rule, t, folder)),
                       ("// Example:\n\n", lambda t: build(rule, t, folder)),
                       ("// Example:\n//\tdie(\"no\");\n", lambda t: run(*build(rule, t, folder)[0], folder))):
        try:
            work(text)
        except Failed:
            continue
        raise AssertionError("this example should fail: " + text)


def main():
    check_every_function_has_one()
    check_every_declaration_is_explained()
    with tempfile.TemporaryDirectory() as folder:
        runs = [one for rule in RULES for one in build(rule, read(rule.header), folder)]
        assert len(runs) > 20, runs
        skip_without_device()
        shutil.copy(os.path.join(SOURCE, "deploy", "first.gltf"), os.path.join(folder, "room.gltf"))
        with Daemon(folder, socket="candil.sock"):
            check_that_a_bad_example_is_found(folder)
            failures = []
            for where, command in runs:
                try:
                    run(where, command, folder)
                except Failed as failure:
                    failures.append(str(failure))
        assert not failures, "\n".join(failures)
        assert os.path.getsize(os.path.join(folder, "room.exr")) > 1000
        print(f"{len(runs)} examples")


try:
    main()
except Failed as failure:
    sys.exit(str(failure))
