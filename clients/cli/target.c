#include "clients/cli/target.h"

#include <errno.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/programs.h"
#include "clients/cli/scene_options.h"
#include "clients/libcandil/error.h"
#include "protocol/limits.h"
#include "server/base/room.h"

#define PRIVATE_FD 3
#define ANSWER_MS (1000u * LIMIT_HANG_SECONDS)
#define END_MS 5000
#define LOOK_MS 50 // between two looks whether a scene is loaded by now

static bool is_file(const char *path)
{
	struct stat about;
	return stat(path, &about) == 0 && S_ISREG(about.st_mode);
}

// Refuse a path that is missing or a folder. The loader finds out what is wrong with anything else.
static candil_status check_file(const char *path, const struct candil_load_request *how, struct candil_error *error)
{
	struct stat about;
	if (stat(path, &about) != 0)
		return errno == ENOENT || errno == ENOTDIR ? error_set(error, CANDIL_STATUS_SCENE_NOT_FOUND,
								       "there is no scene and no file named %.150s; candil "
								       "scenes lists the scenes",
								       path)
							   : CANDIL_STATUS_OK;
	if (S_ISDIR(about.st_mode))
		return error_set(error, CANDIL_STATUS_SCENE_FILE, "%.150s is a folder: name the scene file in it", path);
	if (!scene_options_fit(path, how))
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, SCENE_OPTIONS_ARE_FOR_OBJ);
	return CANDIL_STATUS_OK;
}

// The daemon gets a process group of its own, so that a Ctrl-C in the terminal does not reach it: this program cancels the
// job instead.
static int spawn_private(int fd, pid_t *pid)
{
	char path[PROGRAM_PATH], number[16], option[] = "--private-fd";
	snprintf(number, sizeof(number), "%d", PRIVATE_FD);
	program_daemon(path, sizeof(path));
	char *argv[] = {path, option, number, NULL};
	posix_spawn_file_actions_t actions;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_adddup2(&actions, fd, PRIVATE_FD);
	posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
	setenv("CANDIL_LOG", "error", 0);
	int failure = program_start(argv, &actions, 1, true, pid);
	posix_spawn_file_actions_destroy(&actions);
	return failure;
}

static candil_status connect_private(struct target *target, struct candil_error *error)
{
	int ends[2];
	if (room_limit_mib() > 0 && room_limit_mib() < ROOM_LEAST_MIB) {
		error_set(error, CANDIL_STATUS_MEMORY, "there is no room to start a daemon for this call");
		room_advise(error->text, sizeof(error->text));
		return CANDIL_STATUS_MEMORY;
	}
	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
		return error_set(error, CANDIL_STATUS_CONNECT, "cannot make a socket pair: %s", strerror(errno));
	int failure = spawn_private(ends[1], &target->private_daemon);
	close(ends[1]);
	if (failure != 0) {
		close(ends[0]);
		target->private_daemon = 0;
		return error_set(error, CANDIL_STATUS_CONNECT,
				 "no daemon runs, and candild cannot be started for this call: %s", strerror(failure));
	}
	candil_status status = candil_connect_fd(ends[0], &target->client, error);
	if (status == CANDIL_STATUS_CONNECT)
		error_set(
		    error, status,
		    "candild was started for this call but ended at once: its reason is above, or candil doctor may say it");
	return status;
}

static candil_status connect_any(struct target *target, const char *address, const char *scene, struct candil_error *error)
{
	candil_status status = candil_connect(address, &target->client, error);
	if (status == CANDIL_STATUS_CONNECT && address && is_file(scene)) {
		const size_t used = strlen(error->text);
		snprintf(error->text + used, sizeof(error->text) - used,
			 ", and without --connect one is started for this call");
	}
	if (status != CANDIL_STATUS_CONNECT || address)
		return status;
	if (is_file(scene))
		return connect_private(target, error);
	struct candil_error why;
	if (check_file(scene, &(struct candil_load_request){0}, &why) == CANDIL_STATUS_SCENE_FILE) {
		*error = why;
		return why.code;
	}
	// A text with a dot or a slash was meant as a file, any other as the name of a scene.
	bool named = !strpbrk(scene, "./");
	char nowhere[256];
	if (!candil_default_address(nowhere, sizeof(nowhere)))
		return error_set(
		    error, named ? CANDIL_STATUS_CONNECT : CANDIL_STATUS_SCENE_NOT_FOUND,
		    "there is no file %.120s, and no daemon to ask, for XDG_RUNTIME_DIR is not set; --connect names one",
		    scene);
	return error_set(error, named ? CANDIL_STATUS_CONNECT : CANDIL_STATUS_SCENE_NOT_FOUND,
			 "there is no file %.120s, and no daemon at the default address that may have a scene of that name; "
			 "--connect names another",
			 scene);
}

// Load the file under a name that no other process uses. *loaded: the daemon has it, even if the result is a failure.
static candil_status load_temporary(struct target *target, const char *file, const struct candil_load_request *how,
				    char name[64], bool *loaded, struct candil_scene_info *info, struct candil_error *error)
{
	struct timespec now;
	struct candil_event event;
	struct candil_load_request request = *how;
	uint32_t id;
	clock_gettime(CLOCK_REALTIME, &now);
	snprintf(name, sizeof(target->scene), "candil-%ld-%lx%lx", (long)getpid(), (unsigned long)now.tv_sec,
		 (unsigned long)now.tv_nsec);
	request.name = name;
	request.file = file;
	candil_status status = candil_submit_load(target->client, &request, &id, error);
	while (status == CANDIL_STATUS_OK) {
		if (interrupt_wait(target->client, &event, &status, error))
			break;
		// A private daemon ends with its connection. Any other would keep the scene, so its answer is waited for.
		if (status == CANDIL_STATUS_OK && target->private_daemon != 0)
			return error_set(error, CANDIL_STATUS_CANCELLED, "cancelled while the scene was being loaded");
	}
	if (status == CANDIL_STATUS_OK && event.kind == CANDIL_EVENT_ERROR) {
		*error = event.u.error;
		status = error->code;
	}
	if (status != CANDIL_STATUS_OK)
		return status;
	*loaded = true;
	*info = event.u.scene;
	if (interrupt_seen())
		return error_set(error, CANDIL_STATUS_CANCELLED, "cancelled while the scene was being loaded");
	return CANDIL_STATUS_OK;
}

static const struct candil_scene_entry *find_scene(const struct candil_scene_list *list, const char *name)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (strcmp(list->scenes[i].name, name) == 0)
			return &list->scenes[i];
	return NULL;
}

// Describe a scene that the daemon has. One that is being loaded is waited for.
static candil_status describe_named(struct target *target, const char *name, struct candil_scene_info *info,
				    struct candil_error *error)
{
	static struct candil_scene_list list; // large
	bool waited = false;
	candil_set_timeout(target->client, ANSWER_MS);
	while (!interrupt_seen()) {
		candil_status status = candil_describe(target->client, name, info, error);
		if (status != CANDIL_STATUS_SCENE_NOT_FOUND)
			return status;
		struct candil_error why;
		status = candil_scenes(target->client, &list, &why);
		if (status != CANDIL_STATUS_OK) {
			*error = why;
			return status;
		}
		const struct candil_scene_entry *scene = find_scene(&list, name);
		if (!scene && waited)
			return error_set(error, CANDIL_STATUS_SCENE_FILE,
					 "%s was being loaded, and that failed or was cancelled; candil load FILE says why",
					 name);
		if (!scene)
			return CANDIL_STATUS_SCENE_NOT_FOUND;
		waited = true;
		if (scene->loading)
			interrupt_pause(LOOK_MS);
	}
	return error_set(error, CANDIL_STATUS_CANCELLED, "cancelled while the scene was being loaded");
}

candil_status target_open(struct target *target, const char *address, const char *scene,
			  const struct candil_load_request *how, struct candil_error *error)
{
	memset(target, 0, sizeof(*target));
	candil_status status = connect_any(target, address, scene, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	bool may_be_name = !target->private_daemon && !strchr(scene, '/') && strlen(scene) < sizeof(target->scene);
	if (may_be_name) {
		snprintf(target->scene, sizeof(target->scene), "%s", scene);
		status = describe_named(target, scene, &target->info, error);
		if (status == CANDIL_STATUS_OK && scene_options_given(how))
			return error_set(error, CANDIL_STATUS_BAD_ARGUMENT,
					 "%s is loaded already: give --up and --unit to candil load", scene);
		if (status != CANDIL_STATUS_SCENE_NOT_FOUND)
			return status;
	}
	status = check_file(scene, how, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return load_temporary(target, scene, how, target->scene, &target->temporary, &target->info, error);
}

static candil_status find_part(struct target *target, const char **name, struct target_part *part,
			       struct candil_error *error)
{
	static struct candil_scene_info info; // static because it is large
	const struct candil_load_request how = {0};
	const char *file = *name;
	candil_status status = CANDIL_STATUS_SCENE_NOT_FOUND;
	if (!file)
		return CANDIL_STATUS_OK;
	*name = part->name;
	if (!target->private_daemon && !strchr(file, '/') && strlen(file) < sizeof(part->name)) {
		snprintf(part->name, sizeof(part->name), "%s", file);
		status = describe_named(target, file, &info, error);
	}
	if (status == CANDIL_STATUS_SCENE_NOT_FOUND)
		status = check_file(file, &how, error);
	else
		file = NULL;
	if (file && status == CANDIL_STATUS_OK)
		status = load_temporary(target, file, &how, part->name, &part->temporary, &info, error);
	if (status == CANDIL_STATUS_OK)
		snprintf(part->hash, sizeof(part->hash), "%s", info.hash);
	part->solution = status == CANDIL_STATUS_OK && info.patch_elements > 0;
	return status;
}

candil_status target_parts(struct target *target, struct candil_render_request *request, struct candil_error *error)
{
	candil_status status = find_part(target, &request->environment, &target->picture, error);
	if (status == CANDIL_STATUS_OK)
		status = find_part(target, &request->imported, &target->imported, error);
	return status;
}

static void wait_private(pid_t pid)
{
	for (int waited = 0; waited < END_MS; waited += 10) {
		if (waitpid(pid, NULL, WNOHANG) != 0)
			return;
		interrupt_pause(10);
	}
	kill(pid, SIGKILL);
	waitpid(pid, NULL, 0);
}

static void target_unload(const struct target *target, const char *name)
{
	struct candil_error error;
	candil_set_timeout(target->client, ANSWER_MS);
	candil_status status = candil_unload(target->client, name, &error);
	// If the daemon is gone, so is the scene.
	if (status != CANDIL_STATUS_OK && status != CANDIL_STATUS_IO && status != CANDIL_STATUS_SHUTTING_DOWN)
		fprintf(stderr, "candil: the scene %s stays loaded: %s\n", name, error.text);
}

void target_close(struct target *target)
{
	const bool stays = target->client && !target->private_daemon;
	if (stays && target->temporary)
		target_unload(target, target->scene);
	if (stays && target->picture.temporary)
		target_unload(target, target->picture.name);
	if (stays && target->imported.temporary)
		target_unload(target, target->imported.name);
	candil_disconnect(target->client);
	if (target->private_daemon)
		wait_private(target->private_daemon);
	memset(target, 0, offsetof(struct target, info));
}
