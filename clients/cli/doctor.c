// doctor: prints what this machine has and lacks for a render. The worker alone links the GPU libraries, so it finds the
// devices: candil-worker --doctor prints them as JSON.
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "clients/cli/cli.h"
#include "clients/cli/doctor_checks.h"
#include "protocol/limits.h"

#define WORKER_BYTES 262144u
#define PROGRAMS 5

enum { DAEMON, LOADER, WORKER, COMPARE, REPORT };

struct findings {
	struct program_check programs[PROGRAMS];
	struct daemon_check daemon;
	struct kernel_check kernel;
	json_t *worker; // the object that it printed, or {"why"}
	json_t *sandbox; // what of the loader's works here, or {"why"}; the worker's is in `worker`
	json_t *missing; // [{"what", "package"}]
	bool ok;
};

static void add_missing(struct findings *f, const char *what, const char *package)
{
	json_array_append_new(f->missing, json_pack("{s:o,s:o}", "what", cli_json_text(what), "package",
						    package ? cli_json_text(package) : json_null()));
}

static void check_programs(struct findings *f)
{
	static const struct {
		const char *name, *purpose;
		const char *user; // NULL: a render needs it
		const char *argument;
	} wanted[PROGRAMS] = {
	    [DAEMON] = {"candild", "the daemon", NULL, "--version"},
	    [LOADER] = {"candil-loader", "reads scenes", NULL, "--sandbox-report"},
	    [WORKER] = {"candil-worker", "renders", NULL, "--libraries"},
	    [COMPARE] = {"candil-compare", "measures images", "candil compare", "--help"},
	    [REPORT] = {"candil-report", "writes reports", "candil study", "--help"},
	};
	for (int i = 0; i < PROGRAMS; i++) {
		struct program_check *p = &f->programs[i];
		char argument[20];
		snprintf(argument, sizeof(argument), "%s", wanted[i].argument);
		p->name = wanted[i].name;
		p->purpose = wanted[i].purpose;
		p->user = wanted[i].user;
		if (i == DAEMON)
			program_daemon(p->path, sizeof(p->path));
		else if (!program_libexec(p->name, p->path, sizeof(p->path)))
			p->path[0] = '\0';
		doctor_check_program(p, argument);
		if (p->library[0])
			add_missing(f, p->library, doctor_package_of(p->library));
		f->ok = f->ok && (p->works || p->user);
	}
}

static json_t *failure_json(const char *why)
{
	return json_pack("{s:o}", "why", cli_json_text(why));
}

// Run candil-worker --doctor and keep the object that it prints, whatever its fields are.
static void check_devices(struct findings *f)
{
	static char out[WORKER_BYTES], err[WORKER_BYTES];
	char option[] = "--doctor";
	char *argv[] = {f->programs[WORKER].path, option, NULL};
	if (!f->programs[WORKER].works) {
		f->worker = failure_json("candil-worker does not start");
		return;
	}
	int status = program_run(argv, DOCTOR_TIME, out, err, sizeof(out));
	json_error_t wrong;
	f->worker = status >= 0 ? json_loads(out, 0, &wrong) : failure_json(strerror(errno));
	if (!json_is_object(f->worker)) {
		json_decref(f->worker);
		f->worker = failure_json(err[0] ? err : "candil-worker --doctor printed nothing that can be read");
	}
	const json_t *chosen = json_object_get(f->worker, "chosen");
	f->ok = f->ok && status == 0 && (!chosen || json_integer_value(chosen) >= 0);
	size_t i;
	json_t *entry;
	json_array_foreach(json_object_get(f->worker, "missing"), i, entry) json_array_append(f->missing, entry);
}

// The loader tries its own sandbox. Renders work even if a layer of it does not.
static void check_sandbox(struct findings *f)
{
	static char out[4096], err[4096];
	char option[] = "--sandbox-report";
	char *argv[] = {f->programs[LOADER].path, option, NULL};
	if (!f->programs[LOADER].works) {
		f->sandbox = failure_json("candil-loader does not start");
		return;
	}
	json_error_t wrong;
	const int status = program_run(argv, DOCTOR_TIME, out, err, sizeof(out));
	f->sandbox = status == 0 ? json_loads(out, 0, &wrong) : NULL;
	if (!json_is_object(f->sandbox)) {
		json_decref(f->sandbox);
		f->sandbox = failure_json(err[0] ? err : "candil-loader --sandbox-report printed nothing that can be read");
	}
}

static void check_kernel(struct findings *f)
{
	doctor_check_kernel(&f->kernel);
	if (!f->kernel.memfd_sealing)
		add_missing(f, "sealed memory files (kernel 3.17 or later)", NULL);
	if (!f->kernel.openat2)
		add_missing(f, "openat2 (kernel 5.6 or later, not filtered away)", NULL);
	f->ok = f->ok && f->kernel.memfd_sealing && f->kernel.openat2;
}

static json_t *findings_json(const struct findings *f)
{
	json_t *programs = json_array();
	for (int i = 0; i < PROGRAMS; i++) {
		const struct program_check *p = &f->programs[i];
		json_array_append_new(programs, json_pack("{s:s,s:o,s:b,s:b,s:o}", "name", p->name, "path",
							  cli_json_text(p->path), "needed", (int)!p->user, "works",
							  (int)p->works, "why", cli_json_text(p->why)));
	}
	json_t *processes = json_array();
	for (int i = 0; i < DAEMON_PROCESSES; i++) {
		const struct process_check *p = &f->daemon.processes[i];
		if (p->seen)
			json_array_append_new(processes, json_pack("{s:s,s:b,s:b,s:b}", "name", p->name, "no_new_privileges",
								   (int)p->no_new_privileges, "no_capabilities",
								   (int)p->no_capabilities, "seccomp", (int)p->seccomp));
	}
	json_t *daemon =
	    json_pack("{s:b,s:o,s:o,s:b,s:o,s:o,s:I,s:I,s:o}", "reachable", (int)f->daemon.reachable, "address",
		      cli_json_text(f->daemon.address), "what", cli_json_text(f->daemon.what), "ready", (int)f->daemon.ready,
		      "device", cli_json_text(f->daemon.device), "note", cli_json_text(f->daemon.note), "max_connections",
		      (json_int_t)f->daemon.connections, "max_scenes", (json_int_t)f->daemon.scenes, "processes", processes);
	json_t *kernel =
	    json_pack("{s:b,s:b,s:b,s:i}", "memfd_sealing", (int)f->kernel.memfd_sealing, "openat2", (int)f->kernel.openat2,
		      "seccomp", (int)f->kernel.seccomp, "landlock_abi", f->kernel.landlock_abi);
	return json_pack("{s:b,s:o,s:o,s:o,s:O?,s:O,s:O,s:O}", "ok", (int)f->ok, "daemon", daemon, "programs", programs,
			 "kernel", kernel, "shader_cache", json_object_get(f->worker, "shader_cache"), "worker", f->worker,
			 "sandbox", f->sandbox, "missing", f->missing);
}

static const char *text_of(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

static void print_devices(const struct findings *f)
{
	size_t i;
	const json_t *device;
	const json_t *devices = json_object_get(f->worker, "devices");
	json_int_t chosen = json_integer_value(json_object_get(f->worker, "chosen"));
	json_array_foreach(devices, i, device)
	{
		json_int_t index = json_integer_value(json_object_get(device, "index"));
		printf("%s device   %" JSON_INTEGER_FORMAT ": %s, %s, Vulkan %s%s%s\n", index == chosen ? "*" : " ", index,
		       text_of(device, "name"), text_of(device, "type"), text_of(device, "api"),
		       text_of(device, "why")[0] ? "; not usable: " : "", text_of(device, "why"));
	}
	if (json_array_size(devices) == 0)
		puts("  device   none");
	if (text_of(f->worker, "why")[0])
		printf("           %s\n", text_of(f->worker, "why"));
}

static void print_fence(const char *program, const json_t *fence, const char *why_unknown)
{
	size_t i;
	const json_t *layer;
	json_array_foreach(json_object_get(fence, "layers"), i, layer)
	    printf("  sandbox  %s, %s: %s%s\n", program, text_of(layer, "name"),
		   json_is_true(json_object_get(layer, "holds")) ? "" : "does not hold: ", text_of(layer, "detail"));
	if (i == 0)
		printf("  sandbox  %s: unknown: %s\n", program, why_unknown);
}

static void print_cache(const struct findings *f)
{
	const json_t *cache = json_object_get(f->worker, "shader_cache");
	const char *path = text_of(cache, "path");
	if (cache)
		printf("  cache    %s: %s\n", *path ? path : "compiled shaders have no place",
		       json_is_true(json_object_get(cache, "writable"))
			   ? "writable"
			   : "not writable, or full: each start compiles its shaders anew");
}

static void print_findings(const struct findings *f)
{
	print_devices(f);
	printf("  daemon   %s: %s\n", f->daemon.address,
	       f->daemon.reachable ? f->daemon.what : "not running; candil render FILE starts its own");
	if (f->daemon.reachable)
		printf("           %s%s\n", f->daemon.ready ? "renders on " : "cannot render: ", f->daemon.device);
	for (int i = 0; i < DAEMON_PROCESSES; i++) {
		const struct process_check *p = &f->daemon.processes[i];
		if (p->seen)
			printf("           %s: new privileges %s, capabilities %s, seccomp %s\n", p->name,
			       p->no_new_privileges ? "no" : "POSSIBLE", p->no_capabilities ? "none" : "SOME",
			       p->seccomp ? "yes" : "NO");
	}
	if (f->daemon.connections > 0)
		printf("           has descriptors for %" PRIu32 " connections and %" PRIu32 " scenes%s\n",
		       f->daemon.connections, f->daemon.scenes,
		       f->daemon.connections < LIMIT_CONNECTIONS || f->daemon.scenes < LIMIT_SCENES
			   ? ": for more raise its limit (ulimit -n, LimitNOFILE=)"
			   : "");
	if (f->daemon.note[0])
		printf("           %s\n", f->daemon.note);
	for (int i = 0; i < PROGRAMS; i++) {
		const struct program_check *p = &f->programs[i];
		printf("  program  %s (%s): %s%s", p->name, p->purpose,
		       p->works ? "starts" : "does not start: ", p->works ? "" : p->why);
		if (!p->works && p->user)
			printf("; only %s needs it", p->user);
		putchar('\n');
	}
	printf("  kernel   sealed memory %s, openat2 %s, seccomp %s, landlock ", f->kernel.memfd_sealing ? "yes" : "NO",
	       f->kernel.openat2 ? "yes" : "NO", f->kernel.seccomp ? "yes" : "no");
	if (f->kernel.landlock_abi > 0)
		printf("ABI %d\n", f->kernel.landlock_abi);
	else
		puts("no");
	print_fence("candil-loader", f->sandbox, text_of(f->sandbox, "why"));
	print_fence("candil-worker", json_object_get(f->worker, "fence"), text_of(f->worker, "why"));
	print_cache(f);
	size_t i;
	const json_t *entry;
	json_array_foreach(f->missing, i, entry)
	{
		const char *package = text_of(entry, "package");
		printf("  missing  %s%s%s\n", text_of(entry, "what"), *package ? ": apt install " : "", package);
	}
	puts(f->ok ? "A render can work." : "A render cannot work.");
}

static enum exit_code run_doctor(struct cli *cli, const struct command *self, int argc, char **argv)
{
	static struct findings f;
	enum exit_code code = EXIT_DONE;
	if (!cli_parse_simple(cli, self, argc, argv, 0, &code))
		return code;
	f.ok = true;
	f.missing = json_array();
	check_programs(&f);
	check_devices(&f);
	check_kernel(&f);
	check_sandbox(&f);
	doctor_check_daemon(&f.daemon, cli->address);
	f.ok = f.ok && (!f.daemon.reachable || f.daemon.ready);
	code = f.ok ? EXIT_DONE : EXIT_DEVICE;
	if (cli->json) {
		code = cli_print_json(findings_json(&f), stdout, code);
	} else {
		print_findings(&f);
		code = cli_flush(stdout, code);
	}
	json_decref(f.worker);
	json_decref(f.sandbox);
	json_decref(f.missing);
	return code;
}

const struct command doctor_command = {
    .name = "doctor",
    .summary = "what this machine has and lacks for a render",
    .help =
	"Usage: candil doctor [--connect ADDR] [--json]\n\n"
	"Lists the devices, which one is chosen and why, whether the daemon answers, whether candil's programs start,\n"
	"what the kernel offers, what of the sandboxes of loader and worker holds here, where compiled shaders are kept,\n"
	"and what is missing with the Debian package that has it.\n"
	"Exit code 0 if a render could work here, 5 if not. A daemon need not be running; one that runs must have a\n"
	"device that it may use.\n\n"
	"--json: {\"ok\", \"daemon\": {\"reachable\", \"address\", \"what\", \"ready\", \"device\" (or why it has none),\n"
	"\"note\", \"max_connections\", \"max_scenes\" (what its descriptors are enough for),\n"
	"\"processes\": [{\"name\", \"no_new_privileges\", \"no_capabilities\", \"seccomp\"}]},\n"
	"\"programs\": [{\"name\", \"path\", \"needed\", \"works\", \"why\"}],\n"
	"\"kernel\": {\"memfd_sealing\", \"openat2\", \"seccomp\", \"landlock_abi\"},\n"
	"\"sandbox\": {\"threads\", \"layers\": [{\"name\", \"holds\", \"detail\"}]},\n"
	"\"shader_cache\": {\"path\", \"writable\"}, \"missing\": [{\"what\", \"package\"}],\n"
	"\"worker\": {\"devices\": [{\"index\", \"name\", \"type\", \"api\", \"driver\", \"uuid\", \"usable\", \"why\",\n"
	"\"memory_bytes\"}], \"chosen\", \"why\", \"missing\", \"fence\": as \"sandbox\"}}\n",
    .run = run_doctor,
};
