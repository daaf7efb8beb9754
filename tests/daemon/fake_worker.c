// Stands in for candil-worker. A job takes one step a sample; its image is width × height bytes, byte i being
// (i * 31 + seed + camera.eye.x) modulo 256. The environment says what goes wrong:
//   FAKE_DIE_STEP=K    be killed on receiving the K-th STEP of this process, FAKE_DIE_TIMES (default 1) times over all
//   FAKE_DIE_SEED=S    be ended likewise on every STEP and PILOT of a request with this seed
//   FAKE_DIE_AS=HOW    "crash": by SIGABRT; "device": say that the device is lost, and end; else by SIGKILL
//   FAKE_DEVICES=N     so many are there (default 1)
//   FAKE_STATE=DIR     where those times are counted
//   FAKE_HANG=HOW      "sleep", "burn" or "stop" itself for ever, on receiving the message that FAKE_HANG_ON names: "scene",
//                      "begin", "step", "read", "pilot", or "ready" in place of sending that; FAKE_DIE_TIMES over all
//   FAKE_BURN_US=N     a step burns so much processor time (default 0)
//   FAKE_STEP_US=N     a step takes so long (default 200)
//   FAKE_MEMORY_JOBS=N there is memory for N jobs
//   FAKE_STEP_MEMORY_JOBS=N there is memory for N jobs to make their second step
//   FAKE_MEMORY_PIXELS=N there is memory for jobs of N pixels together
//   FAKE_SPARSE=N      images from 2^20 pixels on are N zeros a pixel
//   FAKE_TRACE=FILE    the job of each step is added to it, a line a step, and "pilot" with its budget and limit for each
//   pilot FAKE_COUNTS        "stages" or "figures": count more of them than there are; "value": a figure that is no number
//   FAKE_NO_DEVICE     there is no device          FAKE_EXIT   end at once
//   FAKE_FAIL_STEP     every step fails            FAKE_FAIL_IMAGE   every image fails
//   FAKE_PILOT         "die": be killed on PILOT; "refuse" it; "nonsense", "kind", "code", "other": answer with no number,
//                      no kind of error, no status, for another pilot; "work": less than none; "whole": do not look for its
//                      end
//   FAKE_SOLVED        no work is left to be made for a scene
//   FAKE_PILOT_US=N    a pilot takes so long (default 0) unless it is ended
//   FAKE_READY_US=N    it is ready after so long (default 0)
//   FAKE_OTHER_BUILD   be of another build
//   FAKE_SOFTWARE      be on a software device
//   FAKE_HELD=N        have N bytes of the device more than jobs take
//   FAKE_COLD=DIR      refuse renders and pilots of seed 7, or from 1000 on, for want of code until there is DIR/compiled,
//   in BEGIN or, with FAKE_COLD_STEP, in
//                      the second step. With --compile: add a byte to DIR/compilers, wait for DIR/go, make DIR/compiled and
//                      exit
//   FAKE_COMPILER      "die", "crash", "stop" itself or make "nothing" instead of waiting
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/base/memfd.h"
#include "tests/daemon/fake.h"

#define MAX 512
#define COLD_SEED 7
#define COLD_SEEDS 1000 // each from here on needs code of its own

struct job {
	uint32_t id; // 0: free
	candil_Render render;
	uint32_t samples;
	bool compile;
};

static struct job jobs[MAX];
static uint64_t scenes[MAX];
static unsigned long steps;
static FILE *trace;

static void answer(const void *message, size_t bytes, int fd)
{
	if (ipc_send_patiently(IPC_FD, message, bytes, fd, NULL) != STATUS_OK)
		exit(0);
}

static struct job *find(uint32_t id)
{
	for (int i = 0; i < MAX; i++)
		if (jobs[i].id == id)
			return &jobs[i];
	return NULL;
}

static unsigned long active(void)
{
	unsigned long count = 0;
	for (int i = 0; i < MAX; i++)
		count += jobs[i].id != 0;
	return count;
}

// A job holds 1000 bytes of the device.
static void tell_state(void)
{
	const struct ipc_state state = {.head = {.op = IPC_STATE},
					.device_bytes = active() * 1000 + fake_number("FAKE_HELD", 0)};
	answer(&state, sizeof state, -1);
}

static unsigned long pixels(void)
{
	unsigned long count = 0;
	for (int i = 0; i < MAX; i++)
		if (jobs[i].id)
			count += jobs[i].render.width * jobs[i].render.height;
	return count;
}

static uint64_t *find_scene(uint64_t id)
{
	for (int i = 0; i < MAX; i++)
		if (scenes[i] == id)
			return &scenes[i];
	return NULL;
}

static void on_scene(const struct ipc_scene *message, int fd)
{
	const void *map;
	size_t bytes;
	if (memfd_map_sealed(fd, &map, &bytes, NULL) != STATUS_OK)
		exit(7);
	munmap((void *)(uintptr_t)map, bytes);
	*find_scene(0) = message->scene;
}

static void on_forget(const struct ipc_scene *message)
{
	uint64_t *scene = find_scene(message->scene);
	if (!scene)
		exit(6);
	*scene = 0;
}

static bool cold_path(char path[4096], const char *name)
{
	const char *folder = getenv("FAKE_COLD");
	return folder && snprintf(path, 4096, "%s/%s", folder, name) < 4096;
}

static uint64_t cold(const candil_Render *render)
{
	char path[4096];
	const bool needs = render->seed == COLD_SEED || render->seed >= COLD_SEEDS;
	return cold_path(path, "compiled") && needs && access(path, F_OK) != 0 ? render->seed : 0;
}

// What is to be compiled, and how much of the device is taken, in words, to DIR/asked.
static void tell_asked(const char *taken)
{
	static union {
		struct ipc_begin begin;
		uint8_t space[IPC_MAX_BYTES];
	} inbox;
	char path[4096];
	size_t bytes;
	int fd;
	do {
		if (ipc_receive(IPC_FD, &inbox, sizeof inbox, &bytes, &fd, NULL) != STATUS_OK || bytes == 0)
			exit(4);
		if (fd >= 0)
			close(fd);
	} while (inbox.begin.head.op == IPC_SCENE);
	FILE *file = inbox.begin.head.op == IPC_BEGIN && cold_path(path, "asked") ? fopen(path, "we") : NULL;
	if (file) {
		fprintf(file, "%ux%u %s\n", inbox.begin.render.width, inbox.begin.render.height, taken);
		fclose(file);
	}
}

static int compile(const char *taken)
{
	char path[4096];
	tell_asked(taken);
	const char *wrong = getenv("FAKE_COMPILER") ? getenv("FAKE_COMPILER") : "";
	FILE *file = cold_path(path, "compilers") ? fopen(path, "ae") : NULL;
	if (!file || fputc('x', file) == EOF || fclose(file) != 0)
		return 4;
	if (!strcmp(wrong, "die"))
		raise(SIGKILL);
	if (!strcmp(wrong, "crash"))
		raise(SIGILL);
	if (!strcmp(wrong, "stop"))
		raise(SIGSTOP);
	if (!strcmp(wrong, "nothing"))
		return 0;
	for (cold_path(path, "go"); access(path, F_OK) != 0;)
		usleep(1000);
	cold_path(path, "compiled");
	return close(open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600)) == 0 ? 0 : 4;
}

static void on_begin(const struct ipc_begin *message)
{
	struct ipc_begun begun = {.head = {.op = IPC_BEGUN, .job = message->head.job}};
	if (getenv("FAKE_NO_DEVICE"))
		error_set(&begun.error, STATUS_DEVICE, "there is no device");
	else if (!find_scene(message->parts[PART_SCENE]))
		error_set(&begun.error, STATUS_INTERNAL, "the worker does not have the scene");
	else if (active() >= fake_number("FAKE_MEMORY_JOBS", MAX - 1) ||
		 pixels() + message->render.width * message->render.height > fake_number("FAKE_MEMORY_PIXELS", ~0ul))
		error_set(&begun.error, STATUS_MEMORY, "the device's memory is full");
	else if (!message->compile && !getenv("FAKE_COLD_STEP") && (begun.cold = cold(&message->render)) != 0)
		error_set(&begun.error, STATUS_INTERNAL, "cold");
	if (begun.error.code == STATUS_OK) {
		*find(0) = (struct job){.id = message->head.job, .render = message->render, .compile = message->compile};
		tell_state();
		begun.accepted.technique = candil_Technique_TECHNIQUE_PT;
		begun.accepted.samples = message->render.samples;
		snprintf(begun.accepted.device, sizeof begun.accepted.device, "fake");
	}
	answer(&begun, sizeof begun, -1);
}

// Is one of the deaths left? They are counted over all workers by files.
static bool take_death(void)
{
	char path[4096];
	unsigned long times = fake_number("FAKE_DIE_TIMES", 1);
	for (unsigned long i = 0; i < times; i++) {
		snprintf(path, sizeof path, "%s/death.%lu", getenv("FAKE_STATE"), i);
		int fd = open(path, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
		if (fd >= 0) {
			close(fd);
			return true;
		}
	}
	return false;
}

static uint64_t burnt_us(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (uint64_t)t.tv_sec * 1000000 + (uint64_t)t.tv_nsec / 1000;
}

static void hang_on(const char *what)
{
	const char *how = getenv("FAKE_HANG"), *on = getenv("FAKE_HANG_ON");
	if (!how || !on || strcmp(on, what) != 0 || !take_death())
		return;
	if (!strcmp(how, "stop"))
		raise(SIGSTOP);
	while (!strcmp(how, "burn"))
		burnt_us();
	for (;;)
		pause();
}

static bool is_deadly(const candil_Render *render)
{
	return render->seed > 0 && render->seed == fake_number("FAKE_DIE_SEED", 0);
}

static void die(void)
{
	const char *how = getenv("FAKE_DIE_AS") ? getenv("FAKE_DIE_AS") : "";
	if (!strcmp(how, "device")) {
		struct ipc_lost lost = {.head = {.op = IPC_LOST}};
		error_set(&lost.error, STATUS_DEVICE, "the device was lost");
		answer(&lost, sizeof lost, -1);
		exit(1);
	}
	raise(!strcmp(how, "crash") ? SIGABRT : SIGKILL);
}

static void on_step(const struct ipc_step *message)
{
	struct ipc_stepped stepped = {.head = {.op = IPC_STEPPED, .job = message->head.job}};
	struct job *job = find(message->head.job);
	steps++;
	if (trace)
		fprintf(trace, "%u\n", message->head.job);
	if ((steps == fake_number("FAKE_DIE_STEP", 0) && take_death()) || (job && is_deadly(&job->render)))
		die();
	const uint64_t enough_us = burnt_us() + fake_number("FAKE_BURN_US", 0);
	while (burnt_us() < enough_us)
		;
	unsigned long us = fake_number("FAKE_STEP_US", 200);
	usleep((useconds_t)us);
	if (!job) {
		error_set(&stepped.error, STATUS_INTERNAL, "no such job");
	} else {
		job->samples++;
		stepped.samples_done = job->samples;
		stepped.ready = 1;
		// Its error is one over its samples.
		stepped.estimate = (struct estimate){1.0 / job->samples, 0.5 / job->samples, 2.0 / job->samples,
						     candil_ErrorKind_ERROR_KIND_MEASURED};
		stepped.reached = stepped.estimate.relmse <= job->render.target_error;
		stepped.finished = stepped.reached || job->samples == job->render.samples;
		stepped.fraction = (double)job->samples / job->render.samples;
		stepped.device_us = us;
		if (job->samples == 2 && active() > fake_number("FAKE_STEP_MEMORY_JOBS", MAX))
			error_set(&stepped.error, STATUS_MEMORY, "the device's memory is full");
		if (job->samples == 2 && !job->compile && (stepped.cold = cold(&job->render)) != 0)
			error_set(&stepped.error, STATUS_INTERNAL, "cold");
		if (getenv("FAKE_FAIL_STEP"))
			error_set(&stepped.error, STATUS_DEVICE, "the device was lost");
	}
	answer(&stepped, sizeof stepped, -1);
}

static int make_image(const candil_ImageFrame *frame, unsigned seed)
{
	const unsigned long factor = fake_number("FAKE_SPARSE", 0);
	if (factor > 0 && frame->bytes >= 1ul << 20)
		return fake_sparse_memfd(frame->bytes * factor);
	return fake_memfd(frame->bytes, seed, true);
}

static void fill_counts(candil_Done *done, const char *wrong)
{
	done->stages_count = wrong && !strcmp(wrong, "stages") ? 60000 : 1;
	done->figures_count = wrong && !strcmp(wrong, "figures") ? 60000 : 1;
	snprintf(done->figures[0].name, sizeof done->figures[0].name, "pixels");
	done->figures[0].value = wrong && !strcmp(wrong, "value") ? NAN : 16;
}

static void end(uint32_t id)
{
	struct job *job = find(id);
	if (job)
		job->id = 0;
	tell_state();
}

static void on_read(const struct ipc_read *message)
{
	struct ipc_image image = {.head = {.op = IPC_IMAGE, .job = message->head.job}};
	struct job *job = find(message->head.job);
	int fd = -1;
	image.frame.final = message->final != 0;
	if (!job || getenv("FAKE_FAIL_IMAGE")) {
		error_set(&image.error, STATUS_ENCODE, "the image could not be encoded");
	} else {
		image.frame.width = job->render.width;
		image.frame.height = job->render.height;
		image.frame.made_width = job->render.width;
		image.frame.made_height = job->render.height;
		image.frame.format = job->render.format;
		image.frame.samples = job->samples;
		image.frame.bytes = (uint64_t)job->render.width * job->render.height;
		image.done.samples = job->samples;
		fill_counts(&image.done, getenv("FAKE_COUNTS"));
		snprintf(image.done.stages[0].name, sizeof image.done.stages[0].name, "trace");
		snprintf(image.done.device, sizeof image.done.device, "fake");
		fd = make_image(&image.frame, (unsigned)job->render.seed + (unsigned)job->render.camera.eye.x);
	}
	if (message->final)
		end(message->head.job);
	answer(&image, sizeof image, fd);
	if (fd >= 0)
		close(fd);
}

// A unit of rows takes 1 µs, and there are as many as radiosity.patches says, in thousands, unless FAKE_SOLVED.
static void tell_work(const struct ipc_pilot *message, struct work *work)
{
	unsigned long thousands = 4;
	for (pb_size_t i = 0; i < message->render.options_count; i++)
		if (!strcmp(message->render.options[i].name, "radiosity.patches"))
			thousands = strtoul(message->render.options[i].value, NULL, 10);
	*work = (struct work){
	    .told = message->try_us > 0 ? WORK_TRIED : WORK_COUNTED, .way_of_rows = 1, .way_of_pictures = 1, .picture = 1};
	work->left[WORK_ROWS] = getenv("FAKE_SOLVED") ? 0 : 1000.0 * (double)thousands;
	work->made[WORK_ROWS] = work->us[WORK_ROWS] = message->try_us > 0 ? 1000 : 0;
}

// A path costs 1 µs, and its error is one over its samples; every other technique takes as long for a pixel, and is off by
// 0.25. As much of it is wrong as FAKE_PILOT says.
static void on_pilot(const struct ipc_pilot *message)
{
	const char *wrong = getenv("FAKE_PILOT") ? getenv("FAKE_PILOT") : "";
	struct ipc_piloted piloted = {.head = {.op = IPC_PILOTED, .job = message->head.job}};
	if (!find_scene(message->parts[PART_SCENE]))
		exit(8);
	if (trace)
		fprintf(trace, "pilot %u %u\n", message->budget_us, message->limit_us);
	if (!strcmp(wrong, "die") || is_deadly(&message->render))
		die();
	if (!strcmp(wrong, "refuse"))
		error_set(&piloted.error, STATUS_BAD_ARGUMENT, "no such option");
	if (!message->compile && (piloted.cold = cold(&message->render)) != 0)
		error_set(&piloted.error, STATUS_INTERNAL, "cold");
	if (!strcmp(wrong, "code"))
		piloted.error.code = (enum status)9999;
	if (!strcmp(wrong, "other"))
		piloted.head.job++;
	// By the clock: on a busy machine a short sleep takes several times as long.
	for (const uint64_t end = clock_us() + fake_number("FAKE_PILOT_US", 0); clock_us() < end && !piloted.cut;) {
		usleep(1000);
		piloted.cut = clock_us() < end && strcmp(wrong, "whole") != 0 && ipc_next_is(IPC_FD, IPC_PILOT_END);
	}
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++) {
		const bool noisy = technique_traits(t) & TECHNIQUE_NOISE;
		if (message->told >> t & 1u)
			tell_work(message, &piloted.results[t].work);
		if (!strcmp(wrong, "work"))
			piloted.results[t].work.left[WORK_ROWS] = -1;
		if (!(message->techniques >> t & 1u))
			continue;
		piloted.results[t] = (struct pilot_result){.pixels = 100, .samples = 10, .pixel_us = 10, .sample_us = 1000};
		piloted.results[t].error = (struct estimate){noisy ? 0.1 : 0.25, noisy ? 0.09 : 0.2, noisy ? 0.11 : 0.3,
							     candil_ErrorKind_ERROR_KIND_MEASURED};
		if (!strcmp(wrong, "nonsense"))
			piloted.results[t].sample_us = NAN;
		if (!strcmp(wrong, "kind"))
			piloted.results[t].error.kind = 77;
	}
	answer(&piloted, sizeof piloted, -1);
}

static void on_message(const void *message, int fd)
{
	const struct ipc_head *head = message;
	switch ((enum ipc_op)head->op) {
	case IPC_SCENE:
		hang_on("scene");
		on_scene(message, fd);
		return;
	case IPC_FORGET:
		on_forget(message);
		return;
	case IPC_BEGIN:
		hang_on("begin");
		on_begin(message);
		return;
	case IPC_STEP:
		hang_on("step");
		on_step(message);
		return;
	case IPC_READ:
		hang_on("read");
		on_read(message);
		return;
	case IPC_PILOT:
		hang_on("pilot");
		on_pilot(message);
		return;
	case IPC_PILOT_END:
		if (trace)
			fprintf(trace, "end\n");
		return;
	case IPC_END:
		end(head->job);
		return;
	default:
		exit(5);
	}
}

int main(int argc, char **argv)
{
	static union {
		uint64_t align;
		uint8_t space[IPC_MAX_BYTES];
	} inbox;
	if (getenv("FAKE_EXIT"))
		return 3;
	if (argc > 2 && !strcmp(argv[1], "--compile"))
		return compile(argv[2]);
	const bool inherited = fake_inherited(IPC_FD);
	if (getenv("FAKE_TRACE")) {
		trace = fopen(getenv("FAKE_TRACE"), "ae");
		setvbuf(trace, NULL, _IOLBF, 0);
	}
	usleep((useconds_t)fake_number("FAKE_READY_US", 0));
	hang_on("ready");
	struct ipc_ready ready = {.head = {.op = IPC_READY}};
	snprintf(ready.build, sizeof ready.build, "%s", getenv("FAKE_OTHER_BUILD") ? "0.0" : ipc_build());
	// The first device that is not to be avoided.
	unsigned long device = 0;
	for (int i = 1; i < argc; i++)
		device += !strcmp(argv[i], "--avoid");
	snprintf(ready.device, sizeof ready.device, "%s%.0lu", inherited ? "inherited descriptors" : "fake", device);
	snprintf(ready.key, sizeof ready.key, "%lu", device);
	ready.software = getenv("FAKE_SOFTWARE") != NULL;
	ready.others = (uint32_t)(fake_number("FAKE_DEVICES", 1) - 1 - device);
	if (getenv("FAKE_NO_DEVICE"))
		error_set(&ready.error, STATUS_DEVICE, "there is no device");
	answer(&ready, sizeof ready, -1);
	for (;;) {
		size_t bytes;
		int fd;
		if (ipc_receive(IPC_FD, &inbox, sizeof inbox, &bytes, &fd, NULL) != STATUS_OK || bytes == 0)
			return 0;
		on_message(&inbox, fd);
		if (fd >= 0)
			close(fd);
	}
}
