// load, unload, scenes, describe: the scenes of a daemon.
#include <inttypes.h>
#include <string.h>

#include "clients/cli/cli.h"
#include "clients/cli/interrupt.h"
#include "clients/cli/scene_options.h"
#include "clients/cli/scene_print.h"
#include "clients/cli/target.h"

static enum exit_code show_scene(const struct cli *cli, const struct candil_scene_info *scene)
{
	if (cli->json)
		return cli_print_json(scene_json(scene), stdout, EXIT_DONE);
	scene_print(scene);
	return cli_flush(stdout, EXIT_DONE);
}

// Write the name of a file without its folder and extension.
static void name_from_file(const char *file, char *name, size_t capacity)
{
	const char *slash = strrchr(file, '/');
	const char *base = slash ? slash + 1 : file;
	const char *dot = strrchr(base, '.');
	size_t length = dot && dot != base ? (size_t)(dot - base) : strlen(base);
	snprintf(name, capacity, "%.*s", (int)length, base);
}

static enum exit_code run_load(struct cli *cli, const struct command *self, int argc, char **argv)
{
	static const struct option options[] = {CLI_COMMON_OPTIONS,
						SCENE_OPTIONS,
						{"name", required_argument, NULL, 'n'},
						{"under-root", no_argument, NULL, 'r'},
						{NULL, 0, NULL, 0}};
	struct candil_load_request request = {0};
	enum exit_code code = EXIT_DONE;
	bool under_root = false;
	char name[256];
	int option;
	while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
		if (option == 'n')
			request.name = optarg;
		else if (option == 'r')
			under_root = true;
		else if (option == OPTION_UP || option == OPTION_UNIT) {
			if (!scene_option(option, optarg, &request))
				return scene_option_refuse(self, option, optarg);
		} else if (!cli_common_option(cli, self, option, &code)) {
			return code;
		}
	}
	if (argc - optind != 1)
		return cli_usage(self, "one scene file is needed");
	if (!scene_options_fit(argv[optind], &request))
		return cli_usage(self, SCENE_OPTIONS_ARE_FOR_OBJ);
	if (!request.name) {
		name_from_file(argv[optind], name, sizeof(name));
		request.name = name;
	}
	if (under_root)
		request.server_path = argv[optind];
	else
		request.file = argv[optind];
	candil_client *client = cli_connect(cli, &code);
	if (!client)
		return code;
	struct candil_error error;
	struct candil_scene_info scene;
	if (candil_load(client, &request, &scene, &error) == CANDIL_STATUS_OK)
		code = show_scene(cli, &scene);
	else
		code = cli_fail(cli, &error, stdout);
	candil_disconnect(client);
	return code;
}

const struct command load_command = {
    .name = "load",
    .summary = "load a scene into the daemon and keep it there",
    .help = "Usage: candil load FILE [--name NAME] [--up y|z] [--unit METRES] [--under-root] [--connect ADDR] [--json]\n\n"
	    "Loads a glTF, GLB or OBJ file and prints what was found in it, as describe does. A picture of surroundings\n"
	    "is loaded likewise, and so are patches (.ply) and form factors (.mtx) of radiosity. The file's folder is\n"
	    "opened here and handed to the daemon; files that the scene names are read beneath that folder only.\n\n"
	    "  --name NAME    the scene's name in the daemon; default: the file's, without folder and extension\n"
	    "  --up y|z       which axis points up in an OBJ file; default y\n"
	    "  --unit METRES  length of an OBJ file's unit; default 1\n"
	    "  --under-root   FILE is relative to the daemon's --scene-root instead\n\n"
	    "--json: " SCENE_JSON_HELP,
    .run = run_load,
};

static enum exit_code ask_unload(const struct cli *cli, candil_client *client, const char *name)
{
	struct candil_error error;
	if (candil_unload(client, name, &error) != CANDIL_STATUS_OK)
		return cli_fail(cli, &error, stdout);
	if (cli->json)
		return cli_print_json(json_pack("{s:o}", "unloaded", cli_json_text(name)), stdout, EXIT_DONE);
	return EXIT_DONE;
}

static enum exit_code run_unload(struct cli *cli, const struct command *self, int argc, char **argv)
{
	return cli_ask(cli, self, argc, argv, 1, ask_unload);
}

const struct command unload_command = {
    .name = "unload",
    .summary = "let the daemon forget a scene",
    .help = "Usage: candil unload NAME [--connect ADDR] [--json]\n\n"
	    "Jobs that use the scene go on; its memory is free after the last.\n\n"
	    "--json: {\"unloaded\": NAME}\n",
    .run = run_unload,
};

static json_t *list_json(const struct candil_scene_list *list)
{
	json_t *array = json_array();
	for (uint32_t i = 0; i < list->count; i++) {
		const struct candil_scene_entry *s = &list->scenes[i];
		json_array_append_new(array, json_pack("{s:o,s:o,s:o,s:b,s:o}", "name", cli_json_text(s->name), "triangles",
						       cli_json_u64(s->triangles), "blob_bytes", cli_json_u64(s->blob_bytes),
						       "loading", (int)s->loading, "jobs", cli_json_u64(s->jobs)));
	}
	return json_pack("{s:o}", "scenes", array);
}

static void print_list(const struct candil_scene_list *list)
{
	if (list->count == 0)
		puts("no scenes");
	for (uint32_t i = 0; i < list->count; i++) {
		const struct candil_scene_entry *s = &list->scenes[i];
		if (s->loading)
			printf("%-24s loading\n", s->name);
		else
			printf("%-24s %10" PRIu32 " triangle%s %8.1f MiB %3" PRIu32 " job%s\n", s->name, s->triangles,
			       cli_s(s->triangles), (double)s->blob_bytes / 1048576.0, s->jobs, cli_s(s->jobs));
	}
}

static enum exit_code ask_scenes(const struct cli *cli, candil_client *client, const char *argument)
{
	struct candil_error error;
	struct candil_scene_list list;
	(void)argument;
	if (candil_scenes(client, &list, &error) != CANDIL_STATUS_OK)
		return cli_fail(cli, &error, stdout);
	if (cli->json)
		return cli_print_json(list_json(&list), stdout, EXIT_DONE);
	print_list(&list);
	return cli_flush(stdout, EXIT_DONE);
}

static enum exit_code run_scenes(struct cli *cli, const struct command *self, int argc, char **argv)
{
	return cli_ask(cli, self, argc, argv, 0, ask_scenes);
}

const struct command scenes_command = {
    .name = "scenes",
    .summary = "list the scenes that the daemon holds",
    .help = "Usage: candil scenes [--connect ADDR] [--json]\n\n"
	    "--json: {\"scenes\": [{\"name\", \"triangles\", \"blob_bytes\", \"loading\", \"jobs\"}]}\n",
    .run = run_scenes,
};

static enum exit_code run_describe(struct cli *cli, const struct command *self, int argc, char **argv)
{
	static const struct option options[] = {CLI_COMMON_OPTIONS, SCENE_OPTIONS, {NULL, 0, NULL, 0}};
	struct candil_load_request how = {0};
	enum exit_code code = EXIT_DONE;
	int option;
	while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
		if (option == OPTION_UP || option == OPTION_UNIT) {
			if (!scene_option(option, optarg, &how))
				return scene_option_refuse(self, option, optarg);
		} else if (!cli_common_option(cli, self, option, &code)) {
			return code;
		}
	}
	if (argc - optind != 1)
		return cli_usage(self, "one scene is needed");
	struct candil_error error;
	struct target target;
	interrupt_begin();
	const candil_status status = target_open(&target, cli->address, argv[optind], &how, &error);
	if (target.temporary)
		target.info.name[0] = '\0';
	// Before the answer is printed: one that nobody reads keeps no scene and no interrupt.
	target_close(&target);
	interrupt_end();
	return status == CANDIL_STATUS_OK ? show_scene(cli, &target.info) : cli_fail(cli, &error, stdout);
}

const struct command describe_command = {
    .name = "describe",
    .summary = "what a scene holds, and what was dropped or mended",
    .help = "Usage: candil describe SCENE [--up y|z] [--unit METRES] [--connect ADDR] [--json]\n\n"
	    "SCENE is the name of a loaded scene, or a file, which is then loaded for the call.\n\n"
	    "--json: " SCENE_JSON_HELP,
    .run = run_describe,
};
