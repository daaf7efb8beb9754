"""Every example in the headers of our own seams compiles with the project's warnings and runs (support/examples.py), and every
declaration in the worker's headers is explained."""
import glob
import os
import re
import shutil
import sys
import tempfile

from examples import (BUILD, SKIPPED, SOURCE, Failed, Rule, Skipped, build, check_that_bad_examples_are_found, extract, link_like,
                      read, run)

LOADER = os.path.join(BUILD, "libexec", "candil", "candil-loader")
DEVICE = dict(like="tests/gpu/test_hits.c", link=link_like("tests/test_hits", "test_hits.c"), arguments=(LOADER, "room.gltf"))
FRONT = dict(like="tests/daemon/test_schedule.c", link=link_like("tests/test_schedule", "test_schedule.c"))

PROLOGUE = """
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/names.h"
#include "server/worker/devices.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan/make.h"
#include "server/worker/technique/radiosity/rays.h"
#include "server/worker/technique/technique.h"
#include "server/worker/trace/trace.h"
#include "tests/support/load_scene.h"
"""

RADIOSITY = """
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/radiosity/corner_values.h"
#include "server/worker/technique/radiosity/patches.h"
#include "tests/support/load_scene.h"
"""

MAIN = """
int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	examples[atoi(argv[1])]();
	return 0;
}
"""

# The blob is that of argv[3], loaded by argv[2].
BLOB_MAIN = """
int main(int argc, char **argv)
{
	struct loaded_scene scene;
	struct error err;
	if (argc != 4)
		return 2;
	if (load_scene(argv[2], argv[3], &scene, &err) != STATUS_OK) {
		fprintf(stderr, "%s\\n", err.text);
		return 1;
	}
	examples[atoi(argv[1])](scene.blob, scene.bytes);
	loaded_scene_finish(&scene);
	return 0;
}
"""

# An example whose number is at least FIRST gets a device and the same scene, as serve.c gives them to a technique.
DEVICE_MAIN = """
static void need(enum status status, const struct error *err)
{
	if (status == STATUS_OK)
		return;
	fprintf(stderr, "%s\\n", err->text);
	exit(status == STATUS_DEVICE ? 77 : 1);
}

int main(int argc, char **argv)
{
	struct devices devices = {NULL};
	struct resident_scenes scenes = {NULL};
	struct resident_scene *scene = NULL;
	struct error err = {0};
	if (argc != 4)
		return 2;
	if (atoi(argv[1]) >= FIRST) {
		struct loaded_scene loaded;
		need(device_create(&(struct device_options){0}, &devices.vk, &err), &err);
		need(load_scene(argv[2], argv[3], &loaded, &err), &err);
		scenes.device = devices.vk;
		need(resident_add(&scenes, 1, dup(loaded.fd), &err), &err);
		loaded_scene_finish(&loaded);
		need(resident_acquire(&scenes, 1, NULL, &scene, &err), &err);
	}
	examples[atoi(argv[1])](&devices, scene);
	if (scene)
		resident_release(&scenes, scene);
	resident_finish(&scenes);
	devices_finish(&devices);
	return 0;
}
"""

ON_DEVICE = dict(**DEVICE, prologue=PROLOGUE, parameter="struct devices *devices, struct resident_scene *scene")
RULES = [
    Rule("protocol/names.h", **DEVICE, prologue=PROLOGUE, parameter="void", begin="", main=MAIN),
    Rule("server/scene/blob.h", **DEVICE, prologue=PROLOGUE, parameter="const struct blob_header *blob, size_t bytes", begin="",
         main=BLOB_MAIN),
    Rule("server/worker/scenes/shelf.h", **DEVICE, prologue="", parameter="void", begin="", main=MAIN),
    Rule("server/worker/technique/radiosity/form_factor.h", **DEVICE, prologue=RADIOSITY, parameter="void", begin="",
         main=MAIN),
    *[Rule(f"server/worker/technique/radiosity/{name}.h", **DEVICE, prologue=RADIOSITY,
           parameter="const struct blob_header *blob, size_t bytes",
           begin="\tstruct blob_view view;\n\tblob_view_init(&view, blob);\n"
                 "\tconst struct blob_view *scene = &view;\n\t(void)bytes;\n", main=BLOB_MAIN)
      for name in ("patches", "corners")],
    Rule("server/front/channel.h", **FRONT, prologue="", parameter="void", begin="", main=MAIN),
    Rule("server/worker/technique/technique.h", **ON_DEVICE, begin="\t(void)devices, (void)scene;\n",
         main=DEVICE_MAIN.replace("FIRST", "1")),
    Rule("server/worker/trace/trace.h", **ON_DEVICE, begin="\tstruct device *device = devices->vk;\n",
         main=DEVICE_MAIN.replace("FIRST", "0")),
    Rule("server/worker/technique/radiosity/rays.h", **ON_DEVICE, begin="\tstruct device *device = devices->vk;\n",
         main=DEVICE_MAIN.replace("FIRST", "0")),
]


# A declaration at the left margin, but for a forward one.
DECLARATION = re.compile(r"(?!struct \w+;)(enum|struct|static|const|void|bool|u?int\w*|unsigned|size_t|float|double|char|typedef)\b")


def unexplained(path):
    """Lines of a header whose declarations have no comment: right above their block of lines, or at their end."""
    lines = read(path).splitlines()
    for number, line in enumerate(lines):
        if not DECLARATION.match(line) or "//" in line:
            continue
        above = number
        while above > 0 and lines[above - 1] and not lines[above - 1].startswith(("//", "}")):
            above -= 1
        if not lines[above - 1].startswith("//"):
            yield f"{path}:{number + 1}: nothing explains this: {line}"


def check_every_declaration_is_explained():
    worker = glob.glob("server/worker/**/*.h", recursive=True, root_dir=SOURCE)
    assert len(worker) > 40, worker
    missing = [line for path in [*worker, "protocol/names.h", "server/scene/blob.h"] for line in unexplained(path)]
    assert not missing, "\n".join(missing)


def main():
    check_every_declaration_is_explained()
    failures, skipped = [], []
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(os.path.join(SOURCE, "deploy", "first.gltf"), os.path.join(folder, "room.gltf"))
        check_that_bad_examples_are_found(RULES[0], "assert(!technique_name(0));", folder)
        runs = [one for rule in RULES for one in build(rule, read(rule.header), folder)]
        without = [rule.header for rule in RULES if not extract(read(rule.header))]
        assert not without, without
        for where, command in runs:
            try:
                run(where, command, folder)
            except Failed as failure:
                failures.append(str(failure))
            except Skipped as skip:
                skipped.append(str(skip))
    assert not failures, "\n".join(failures)
    print(f"{len(runs) - len(skipped)} examples ran")
    if skipped:
        print("no device for", *skipped)
        sys.exit(SKIPPED)


try:
    main()
except Failed as failure:
    sys.exit(str(failure))
