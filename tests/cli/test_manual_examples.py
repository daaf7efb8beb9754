"""Every example in the comments of libcandil's headers compiles with the project's warnings and runs (support/examples.py)."""
import os
import re
import shutil
import sys
import tempfile

from common import BUILD, SOURCE, Daemon, skip_without_device
from examples import Failed, Rule, build, check_that_bad_examples_are_found, extract, read, run

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


PUBLIC = dict(like="tests/cli/multiplex.c", link=("-L" + os.path.join(BUILD, "lib"), "-lcandil", "-lm"),
              prologue=PUBLIC_PROLOGUE, parameter="candil_client *client",
              begin="\tstruct candil_error error = {0};\n\t(void)client;\n\t(void)error;\n", main=PUBLIC_MAIN)
RULES = [Rule("clients/libcandil/candil.h", **PUBLIC), Rule("clients/libcandil/candil_types.h", **PUBLIC)]


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


def main():
    check_every_function_has_one()
    check_every_declaration_is_explained()
    with tempfile.TemporaryDirectory() as folder:
        runs = [one for rule in RULES for one in build(rule, read(rule.header), folder)]
        assert len(runs) > 20, runs
        skip_without_device()
        shutil.copy(os.path.join(SOURCE, "deploy", "first.gltf"), os.path.join(folder, "room.gltf"))
        with Daemon(folder, socket="candil.sock"):
            check_that_bad_examples_are_found(RULES[0], 'die("no");', folder)
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
