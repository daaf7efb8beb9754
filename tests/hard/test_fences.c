// Fences from within: a child puts one up and tries what it must not be able to do, and what it must. A layer that this
// kernel lacks is named on standard output, and what only that layer refuses is left out.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <linux/capability.h>
#include <linux/openat2.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "protocol/limits.h"
#include "server/base/memfd.h"
#include "server/base/replace.h"
#include "server/front/fence.h"
#include "server/loader/sandbox.h"
#include "server/worker/fence.h"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1, LEAK_CHECK_NEEDS = 4 };
#else
enum { SANITIZED = 0, LEAK_CHECK_NEEDS = 0 };
#endif

static char folder[] = "/tmp/candil-fences-XXXXXX";
static char cache[sizeof folder + 16]; // the worker's, in it
static char manifest[sizeof folder + 32]; // of a driver
static const char *const manifest_folders[] = {"share", "share/vulkan", "share/vulkan/icd.d"};
static const char *const vendors[][2] = {{"/etc/glvnd/egl_vendor.d", LATE_VENDOR},
					 {"/usr/share/glvnd/egl_vendor.d", LATE_AT_HOME}};
static struct fence_report here; // what a child's sandbox said of this kernel
static struct fence_report worker_here;
static struct fence_report front_here;

int __real_glob(const char *pattern, int flags, int (*failed)(const char *path, int error), glob_t *found);
int __wrap_glob(const char *pattern, int flags, int (*failed)(const char *path, int error), glob_t *found);

// In each of the folders where EGL's loader looks there is a manifest of this test's.
int __wrap_glob(const char *pattern, int flags, int (*failed)(const char *path, int error), glob_t *found)
{
	char path[sizeof folder + 32];
	for (int i = 0; i < 2; i++) {
		snprintf(path, sizeof path, "%s/*.json", vendors[i][0]);
		if (strcmp(path, pattern) == 0) {
			snprintf(path, sizeof path, "%s/vendor%d.json", folder, i);
			return __real_glob(path, flags, failed, found);
		}
	}
	return __real_glob(pattern, flags, failed, found);
}

static int openat2_as(int dir, const char *path, int flags)
{
	struct open_how how = {.flags = (uint64_t)(unsigned)flags, .mode = flags & O_CREAT ? 0600 : 0};
	return (int)syscall(SYS_openat2, dir, path, &how, sizeof how);
}

// Each returns 0 for done, an errno for refused.
static int outcome(long result)
{
	return result < 0 ? errno : 0;
}

static int try_socket(int dir)
{
	(void)dir;
	return outcome(socket(AF_INET, SOCK_STREAM, 0));
}

static int try_socketpair(int dir)
{
	int pair[2];
	(void)dir;
	return outcome(socketpair(AF_UNIX, SOCK_STREAM, 0, pair));
}

static int try_execve(int dir)
{
	char *const arguments[] = {folder, NULL};
	(void)dir;
	return outcome(execve("/proc/self/exe", arguments, NULL));
}

static int try_fork(int dir)
{
	(void)dir;
	const long pid = syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);
	if (pid == 0)
		_exit(0);
	return outcome(pid);
}

static int try_clone3(int dir)
{
	(void)dir;
	return outcome(syscall(SYS_clone3, NULL, (size_t)0));
}

static int try_ptrace(int dir)
{
	(void)dir;
	return outcome(ptrace(PTRACE_TRACEME, 0, NULL, NULL));
}

static int try_kill_parent(int dir)
{
	(void)dir;
	return outcome(kill(getppid(), 0));
}

static int try_read_passwd(int dir)
{
	(void)dir;
	return outcome(open("/etc/passwd", O_RDONLY));
}

static int try_read_passwd_beside(int dir)
{
	return outcome(openat2_as(dir, "../../etc/passwd", O_RDONLY));
}

static int try_write_scene(int dir)
{
	return outcome(openat(dir, "scene.bin", O_RDWR));
}

static int try_write_scene_openat2(int dir)
{
	return outcome(openat2_as(dir, "scene.bin", O_WRONLY));
}

static int try_create(int dir)
{
	return outcome(openat(dir, "new.bin", O_WRONLY | O_CREAT, 0600));
}

static int try_create_openat2(int dir)
{
	return outcome(openat2_as(dir, "new.bin", O_WRONLY | O_CREAT));
}

static int try_unlink(int dir)
{
	return outcome(unlinkat(dir, "scene.bin", 0));
}

static int try_code(int dir)
{
	(void)dir;
	return mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED ? errno
														      : 0;
}

static int try_more_memory(int dir)
{
	(void)dir;
	return mmap(NULL, LIMIT_LOADER_BYTES, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) == MAP_FAILED
		   ? errno
		   : 0;
}

static int try_raise_limit(int dir)
{
	(void)dir;
	return outcome(setrlimit(RLIMIT_CPU, &(struct rlimit){RLIM_INFINITY, RLIM_INFINITY}));
}

static int try_many_descriptors(int dir)
{
	for (unsigned i = 0; i <= LIMIT_LOADER_FILES; i++)
		if (openat2_as(dir, "scene.bin", O_RDONLY) < 0)
			return errno;
	return 0;
}

static int try_large_memory_file(int dir)
{
	(void)dir;
	const int fd = memfd_create("large", MFD_CLOEXEC);
	return fd < 0 ? 1 : outcome(ftruncate(fd, (off_t)LIMIT_BLOB_BYTES + 1));
}

static int do_read_scene(int dir)
{
	char byte;
	const int fd = openat2_as(dir, "scene.bin", O_RDONLY);
	return fd < 0 ? errno : outcome(read(fd, &byte, 1) == 1 ? 0 : -1);
}

static int do_memory_file(int dir)
{
	int fd;
	void *map;
	struct error err;
	(void)dir;
	if (memfd_create_mapped("blob", 1 << 20, &fd, &map, &err) != STATUS_OK)
		return 1;
	memset(map, 7, 1 << 20);
	return memfd_seal(fd, map, 1 << 20, &err) == STATUS_OK ? 0 : 2;
}

static void enter_loader(int dir)
{
	struct fence_report report;
	sandbox_enter(dir, &report);
}

static void enter_worker(int dir)
{
	static struct worker_fence fence;
	(void)dir;
	worker_fence_enter(&fence);
}

static void front_report(struct fence_report *report)
{
	static struct options options;
	snprintf(options.state, sizeof options.state, "%s/state/candil", folder);
	snprintf(options.socket, sizeof options.socket, "%s/run/candil.sock", folder);
	front_fence_enter(&options, report);
	front_fence_stop_sockets(report);
}

static void enter_front(int dir)
{
	struct fence_report report;
	(void)dir;
	front_report(&report);
}

static void enter_nothing(int dir)
{
	(void)dir;
}

// Run `try` in a process of its own that has entered: what it returned, or 1000 and the signal that ended it.
static int run_in(void (*enter)(int dir), int (*try)(int dir))
{
	int status;
	fflush(NULL);
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		const int dir = open(folder, O_PATH | O_DIRECTORY);
		enter(dir);
		_exit(try(dir));
	}
	assert_int_equal(waitpid(pid, &status, 0), pid);
	return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

static int in_sandbox(int (*try)(int dir))
{
	return run_in(enter_loader, try);
}

// What was refused is possible outside: else the test would show nothing.
static int outside(int (*try)(int dir))
{
	return run_in(enter_nothing, try);
}

static bool holds(const struct fence_report *report, enum fence_layer layer)
{
	if (!report->layers[layer].holds)
		printf("left out: this kernel has no %s (%s)\n", fence_layer_name(layer), report->layers[layer].detail);
	assert_null(strstr(report->layers[layer].detail, "put up, yet")); // the kernel has it, and a rule opens all
	return report->layers[layer].holds;
}

static bool has(enum fence_layer layer)
{
	return holds(&here, layer);
}

static void seccomp_refuses(void **state)
{
	// The last four are what the leak check of AddressSanitizer needs, where it is built in.
	static int (*const tries[])(int) = {try_socket, try_socketpair,  try_execve,     try_write_scene,
					    try_create, try_unlink,      try_code,       try_fork,
					    try_ptrace, try_kill_parent, try_raise_limit};
	(void)state;
	if (!has(FENCE_SECCOMP))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0] - LEAK_CHECK_NEEDS; i++) {
		const int got = in_sandbox(tries[i]);
		if (got != EPERM && got != EACCES)
			fail_msg("try %zu came to %d", i, got);
	}
	assert_int_equal(in_sandbox(try_clone3), ENOSYS);
}

static void landlock_refuses(void **state)
{
	static int (*const tries[])(int) = {try_read_passwd, try_read_passwd_beside, try_write_scene_openat2,
					    try_create_openat2};
	(void)state;
	if (!has(FENCE_LANDLOCK))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0]; i++) {
		const int got = in_sandbox(tries[i]);
		if (got != EACCES)
			fail_msg("try %zu came to %d", i, got);
	}
}

static void limits_refuse(void **state)
{
	(void)state;
	if (!SANITIZED)
		assert_int_equal(in_sandbox(try_more_memory), ENOMEM);
	assert_int_equal(in_sandbox(try_many_descriptors), EMFILE);
	assert_int_equal(in_sandbox(try_large_memory_file), EFBIG);
}

static void a_load_can_do_its_work(void **state)
{
	(void)state;
	assert_int_equal(in_sandbox(do_read_scene), 0);
	assert_int_equal(in_sandbox(do_memory_file), 0);
}

// ---- the worker ------------------------------------------------------------------------------------------------------

static int try_socket_here(int dir)
{
	(void)dir;
	return outcome(socket(AF_UNIX, SOCK_STREAM, 0));
}

static int try_netlink(int dir)
{
	(void)dir;
	return outcome(socket(AF_NETLINK, SOCK_RAW, 0));
}

static int try_chmod(int dir)
{
	return outcome(fchmodat(dir, "scene.bin", 0777, 0));
}

static int try_truncate(int dir)
{
	(void)dir;
	char path[sizeof folder + 16];
	snprintf(path, sizeof path, "%s/scene.bin", folder);
	return outcome(truncate(path, 1));
}

static int try_limit_parent(int dir)
{
	struct rlimit limit;
	(void)dir;
	return outcome(prlimit(getppid(), RLIMIT_CPU, NULL, &limit));
}

static int try_type(int dir)
{
	(void)dir;
	return outcome(ioctl(STDERR_FILENO, TIOCSTI, "x"));
}

static int try_namespace(int dir)
{
	(void)dir;
	return outcome(unshare(CLONE_NEWUSER));
}

static int try_read_scene(int dir)
{
	return outcome(openat(dir, "scene.bin", O_RDONLY));
}

static int try_parents_environment(int dir)
{
	char path[64];
	(void)dir;
	snprintf(path, sizeof path, "/proc/%d/environ", (int)getppid());
	return outcome(open(path, O_RDONLY));
}

static int try_remove(int dir)
{
	return outcome(unlinkat(dir, "spare.bin", 0));
}

static int do_keep_shader(int dir)
{
	char path[sizeof cache + 16], other[sizeof cache + 16];
	(void)dir;
	snprintf(path, sizeof path, "%s/below", cache);
	if (mkdir(path, 0700) != 0 && errno != EEXIST)
		return errno;
	snprintf(path, sizeof path, "%s/below/new", cache);
	snprintf(other, sizeof other, "%s/shader", cache);
	const int fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
	if (fd < 0 || ftruncate(fd, 64) != 0)
		return errno;
	return outcome(rename(path, other));
}

static void *nothing(void *argument)
{
	return argument;
}

static int do_thread(int dir)
{
	pthread_t thread;
	(void)dir;
	const int failed = pthread_create(&thread, NULL, nothing, NULL);
	return failed ? failed : pthread_join(thread, NULL);
}

static int do_pair(int dir)
{
	return try_socketpair(dir);
}

static int do_read_maps(int dir)
{
	(void)dir;
	return outcome(open("/proc/self/maps", O_RDONLY));
}

static int do_link_library(int dir)
{
	(void)dir;
	return dlopen("libvulkan.so.1", RTLD_NOW) ? 0 : 1;
}

// A driver that a manifest in the user's own folder names, with what it needs by its own list of folders.
static int do_link_driver(int dir)
{
	(void)dir;
	return dlopen(LATE_DRIVER, RTLD_NOW) ? outcome(open(manifest, O_RDONLY)) : 1;
}

static int do_link_vendors(int dir)
{
	(void)dir;
	return dlopen(LATE_VENDOR, RTLD_NOW) && dlopen(LATE_AT_HOME, RTLD_NOW) ? 0 : 1;
}

// Of the home folder only the library that lies there is for the worker to see.
static int try_list_home(int dir)
{
	(void)dir;
	return outcome(open(LATE_HOME, O_RDONLY));
}

static int do_have_no_privileges(int dir)
{
	struct __user_cap_header_struct head = {.version = _LINUX_CAPABILITY_VERSION_3};
	struct __user_cap_data_struct has[_LINUX_CAPABILITY_U32S_3];
	(void)dir;
	if (syscall(SYS_capget, &head, has) != 0 || prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) != 1)
		return 1;
	return has[0].effective || has[0].permitted || has[1].effective || has[1].permitted ? 2 : 0;
}

static void worker_calls_are_refused(void **state)
{
	// The last three are what the leak check of AddressSanitizer needs.
	static int (*const tries[])(int) = {try_socket,    try_socket_here, try_netlink,      try_execve,
					    try_chmod,     try_truncate,    try_limit_parent, try_type,
					    try_namespace, try_fork,        try_ptrace,       try_kill_parent};
	(void)state;
	if (!holds(&worker_here, FENCE_SECCOMP))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0] - (SANITIZED ? 3 : 0); i++)
		if (run_in(enter_worker, tries[i]) != EPERM)
			fail_msg("try %zu came to %d", i, run_in(enter_worker, tries[i]));
	assert_int_equal(run_in(enter_worker, try_clone3), ENOSYS);
}

static void worker_files_are_refused(void **state)
{
	static int (*const tries[])(int) = {
	    try_read_passwd,    try_read_passwd_beside,  try_read_scene, try_write_scene, try_create,
	    try_create_openat2, try_parents_environment, try_remove,     try_list_home};
	(void)state;
	if (!holds(&worker_here, FENCE_LANDLOCK))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0]; i++)
		if (run_in(enter_worker, tries[i]) != EACCES)
			fail_msg("try %zu came to %d", i, run_in(enter_worker, tries[i]));
}

static void the_worker_can_do_its_work(void **state)
{
	static int (*const works[])(int) = {do_keep_shader, do_thread,       do_pair,        do_read_maps, do_link_library,
					    do_link_driver, do_link_vendors, do_memory_file, try_code};
	(void)state;
	for (size_t i = 0; i < sizeof works / sizeof works[0]; i++)
		if (run_in(enter_worker, works[i]) != 0)
			fail_msg("work %zu came to %d", i, run_in(enter_worker, works[i]));
}

// ---- the front -------------------------------------------------------------------------------------------------------

static int do_start_program(int dir)
{
	int status;
	char program[] = "/bin/true";
	char *const arguments[] = {program, NULL}, *const environment[] = {NULL};
	pid_t pid;
	(void)dir;
	const int failed = posix_spawn(&pid, program, NULL, NULL, arguments, environment);
	if (failed)
		return failed;
	return waitpid(pid, &status, 0) == pid ? status : 1;
}

static int do_keep_quotes(int dir)
{
	char path[sizeof folder + 32];
	struct error err;
	(void)dir;
	snprintf(path, sizeof path, "%s/state/candil/quotes", folder);
	return replace_file(path, 0600, "x", 1, &err) == STATUS_OK ? 0 : 1;
}

static int do_remove_socket(int dir)
{
	const int fd = openat(dir, "run/candil.sock", O_PATH);
	const int failed = fd < 0 ? errno : outcome(unlinkat(dir, "run/candil.sock", 0));
	return failed;
}

static int try_create_beside_socket(int dir)
{
	return outcome(openat(dir, "run/new", O_WRONLY | O_CREAT, 0600));
}

static void front_calls_are_refused(void **state)
{
	// The last is what the leak check of AddressSanitizer needs.
	static int (*const tries[])(int) = {try_socket, try_socket_here, try_netlink,   try_chmod,
					    try_type,   try_truncate,    try_namespace, try_ptrace};
	(void)state;
	if (!holds(&front_here, FENCE_SECCOMP))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0] - (SANITIZED ? 1 : 0); i++)
		if (run_in(enter_front, tries[i]) != EPERM)
			fail_msg("try %zu came to %d", i, run_in(enter_front, tries[i]));
	assert_int_equal(run_in(enter_front, try_clone3), ENOSYS);
}

static void front_changes_are_refused(void **state)
{
	static int (*const tries[])(int) = {try_write_scene, try_create, try_create_openat2, try_remove,
					    try_create_beside_socket};
	(void)state;
	if (!holds(&front_here, FENCE_LANDLOCK))
		return;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0]; i++)
		if (run_in(enter_front, tries[i]) != EACCES)
			fail_msg("try %zu came to %d", i, run_in(enter_front, tries[i]));
}

static void the_front_can_do_its_work(void **state)
{
	static int (*const works[])(int) = {do_start_program, do_keep_quotes, do_keep_shader,  do_remove_socket,
					    do_pair,          do_memory_file, try_read_passwd, try_read_scene};
	(void)state;
	for (size_t i = 0; i < sizeof works / sizeof works[0]; i++)
		if (run_in(enter_front, works[i]) != 0)
			fail_msg("work %zu came to %d", i, run_in(enter_front, works[i]));
}

// ---- all ---------------------------------------------------------------------------------------------------------------

static void nobody_has_privileges(void **state)
{
	(void)state;
	assert_int_equal(run_in(enter_worker, do_have_no_privileges), 0);
	assert_int_equal(run_in(enter_front, do_have_no_privileges), 0);
}

static void all_of_it_works_outside(void **state)
{
	static int (*const tries[])(int) = {try_socket,
					    try_socketpair,
					    try_fork,
					    try_ptrace,
					    try_kill_parent,
					    try_read_passwd,
					    try_read_passwd_beside,
					    try_write_scene,
					    try_write_scene_openat2,
					    try_code,
					    try_socket_here,
					    try_netlink,
					    try_chmod,
					    try_truncate,
					    try_limit_parent,
					    try_read_scene,
					    try_parents_environment,
					    try_create,
					    try_create_beside_socket,
					    try_remove,
					    try_list_home};
	(void)state;
	for (size_t i = 0; i < sizeof tries / sizeof tries[0]; i++)
		if (outside(tries[i]) != 0)
			fail_msg("try %zu is refused outside too: it shows nothing", i);
}

// Through a pipe, because only a child may enter.
static void learn(void (*enter)(struct fence_report *report), struct fence_report *report)
{
	int pipe_ends[2];
	assert_int_equal(pipe(pipe_ends), 0);
	fflush(NULL);
	const pid_t pid = fork();
	if (pid == 0) {
		static struct fence_report found;
		enter(&found);
		_exit(write(pipe_ends[1], &found, sizeof found) == sizeof found ? 0 : 1);
	}
	close(pipe_ends[1]);
	assert_int_equal(read(pipe_ends[0], report, sizeof *report), sizeof *report);
	close(pipe_ends[0]);
	assert_int_equal(waitpid(pid, NULL, 0), pid);
}

static void loader_report(struct fence_report *report)
{
	sandbox_enter(-1, report);
	fence_try(report);
}

static void worker_report(struct fence_report *report)
{
	static struct worker_fence fence;
	worker_fence_enter(&fence);
	fence_try(&fence.report);
	*report = fence.report;
}

static bool write_manifest(const char *path, const char *library)
{
	FILE *out = fopen(path, "we");
	const bool good = out && fprintf(out, "{\"ICD\": {\"library_path\": \"%s\"}}", library) > 0;
	return out && fclose(out) == 0 && good;
}

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return 1;
	const int dir = open(folder, O_PATH | O_DIRECTORY);
	const int fd = openat(dir, "scene.bin", O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
	const bool good = fd >= 0 && write(fd, "x", 1) == 1;
	close(fd);
	close(openat(dir, "spare.bin", O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
	mkdirat(dir, "run", 0700);
	close(openat(dir, "run/candil.sock", O_WRONLY | O_CREAT | O_CLOEXEC, 0600)); // for landlock any file is as a socket
	close(dir);
	snprintf(manifest, sizeof manifest, "%s/share", folder);
	setenv("XDG_DATA_HOME", manifest, 1);
	for (size_t i = 0; i < sizeof manifest_folders / sizeof *manifest_folders; i++) {
		snprintf(manifest, sizeof manifest, "%s/%s", folder, manifest_folders[i]);
		mkdir(manifest, 0700);
	}
	snprintf(manifest, sizeof manifest, "%s/share/vulkan/icd.d/late.json", folder);
	if (!write_manifest(manifest, LATE_DRIVER))
		return 1;
	for (int i = 0; i < 2; i++) {
		char vendor[sizeof folder + 32];
		snprintf(vendor, sizeof vendor, "%s/vendor%d.json", folder, i);
		if (!write_manifest(vendor, vendors[i][1]))
			return 1;
	}
	setenv("HOME", LATE_HOME, 1);
	snprintf(cache, sizeof cache, "%s/cache", folder);
	setenv("MESA_SHADER_CACHE_DIR", cache, 1);
	learn(loader_report, &here);
	learn(worker_report, &worker_here);
	learn(front_report, &front_here);
	return good ? 0 : 1;
}

static int remove_folder(void **state)
{
	(void)state;
	const int dir = open(folder, O_PATH | O_DIRECTORY);
	unlinkat(dir, "scene.bin", 0);
	unlinkat(dir, "spare.bin", 0);
	unlinkat(dir, "new.bin", 0);
	unlinkat(dir, "vendor0.json", 0);
	unlinkat(dir, "vendor1.json", 0);
	unlinkat(dir, "cache/shader", 0);
	unlinkat(dir, "cache/below", AT_REMOVEDIR);
	unlinkat(dir, "cache", AT_REMOVEDIR);
	unlinkat(dir, "state/candil/quotes", 0);
	unlinkat(dir, "state/candil", AT_REMOVEDIR);
	unlinkat(dir, "state", AT_REMOVEDIR);
	unlink(manifest);
	for (size_t i = sizeof manifest_folders / sizeof *manifest_folders; i-- > 0;)
		unlinkat(dir, manifest_folders[i], AT_REMOVEDIR);
	unlinkat(dir, "run/candil.sock", 0);
	unlinkat(dir, "run/new", 0);
	unlinkat(dir, "run", AT_REMOVEDIR);
	close(dir);
	return rmdir(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(seccomp_refuses),
	    cmocka_unit_test(landlock_refuses),
	    cmocka_unit_test(limits_refuse),
	    cmocka_unit_test(a_load_can_do_its_work),
	    cmocka_unit_test(worker_calls_are_refused),
	    cmocka_unit_test(worker_files_are_refused),
	    cmocka_unit_test(the_worker_can_do_its_work),
	    cmocka_unit_test(front_calls_are_refused),
	    cmocka_unit_test(front_changes_are_refused),
	    cmocka_unit_test(the_front_can_do_its_work),
	    cmocka_unit_test(nobody_has_privileges),
	    cmocka_unit_test(all_of_it_works_outside),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
