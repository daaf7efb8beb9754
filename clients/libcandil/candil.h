// libcandil: the client side of candild, a headless render service. Four headers are the manual: this one has the calls,
// candil_types.h what they take and give, candil_names.h the numbers of techniques, effects and failures, candil_version.h
// the version. A program includes this one alone.
//
// A `candil_client` is one connection to a daemon. There are two ways to use it, and they can follow each other on one
// connection:
//
//  - Blocking: candil_connect, candil_load_file, candil_render, candil_disconnect. Each call returns with its answer.
//  - Non-blocking, for a poll loop of your own: candil_submit_… queues a request and returns its id. When candil_fd is
//    readable (or writable, while candil_wants_write says so), call candil_process, then candil_next_event until it returns
//    false. Many requests, renders above all, share one connection that way. Every event bears the id of its request.
//
// Threads: a client belongs to one thread at a time. Different clients are independent. Calls that take no client may be
// made by any thread. The library has no global state, starts no thread, installs no signal handler and raises no SIGPIPE.
//
// Failure: a call that can fail returns a candil_status. Unless `error` is NULL, it then holds the same code and a sentence
// that says what is wrong and what to do; on success it is left alone. What a call would have given is undefined after a
// failure, unless the call says otherwise. Besides the failures that a call names, each call that takes a client can fail
// with IO and with what a daemon says as it closes the connection, SHUTTING_DOWN for example. Once the connection itself has
// failed, every later call that is right in itself fails with the same status: all that is left is candil_disconnect.
//
// Ownership: strings and arrays that go in stay the caller's and are copied before the call returns. What comes out is plain
// values without pointers, but for the bytes of images, whose owner is said where they appear.
//
// NULL: no pointer may be NULL unless its call or field says so. A call that gets one all the same fails with BAD_ARGUMENT
// and changes nothing; one that returns no status does nothing, and returns NULL, false or, of candil_fd, -1. `error` may be
// NULL everywhere.
//
// Units: metres, degrees, W/(m² sr), microseconds, unless a name says otherwise. Colours are linear Rec.709. Axes are
// right-handed with +Y up. Strings are UTF-8.
//
// Versions: major.minor.patch. A release that only mends changes the patch number. Before 1.0 every other release changes
// the minor number, and its shared library has a name of its own (libcandil.so.0.2), because structures may grow: a program
// must be compiled again for it, and may have to be changed. From 1.0 on the major number does what the minor one does now.
// The library talks to every daemon of the same protocol version (1), older or newer; a daemon refuses with UNSUPPORTED or
// BAD_ARGUMENT what it does not know, and what a newer one sends besides is passed over. New fields of a request are off
// when they are zero, so begin each structure with `= {0}` or candil_render_request_init.
//
// Examples: the lines after the word "Example:" are a piece of a C program, indented by a tab. In it `client` is connected
// to a daemon that has loaded a scene named "room", `error` is a struct candil_error, and die(text) stands for what a
// program does about a failure. Each example is compiled and run by candil's own tests.
//
// Example: a whole program
//	#include <candil.h>
//	#include <stdio.h>
//
//	int main(void)
//	{
//		struct candil_render_request request;
//		struct candil_render_result result;
//		struct candil_error error;
//		candil_client *client = NULL;
//		candil_status status = candil_connect(NULL, &client, &error);
//		if (status == CANDIL_STATUS_OK)
//			status = candil_load_file(client, "my room", "room.gltf", NULL, &error);
//		candil_render_request_init(&request);
//		request.scene = "my room";
//		request.width = request.height = 64;
//		request.samples = 4;
//		if (status == CANDIL_STATUS_OK)
//			status = candil_render(client, &request, NULL, &result, &error);
//		if (status == CANDIL_STATUS_OK) {
//			FILE *file = fopen("room.exr", "wb");
//			if (!file || fwrite(result.image.data, 1, result.image.bytes, file) != result.image.bytes ||
//			    fclose(file) != 0)
//				perror("room.exr");
//			candil_free(result.image.data);
//		} else {
//			fprintf(stderr, "%s (%s)\n", error.text, candil_status_name(error.code));
//		}
//		candil_disconnect(client);
//		return status == CANDIL_STATUS_OK ? 0 : 1;
//	}
#ifndef CANDIL_H
#define CANDIL_H

#include "candil_types.h"
#include "candil_version.h"

#ifdef __cplusplus
extern "C" {
#endif

// What the shared library exports.
#if defined(__GNUC__)
#define CANDIL_API __attribute__((visibility("default")))
#else
#define CANDIL_API
#endif

// ---- version ---------------------------------------------------------------------------------------------------------

// The version of the library that the program runs with, as CANDIL_MAKE_VERSION makes it. The headers' own is
// CANDIL_VERSION_NUMBER.
//
// Example:
//	if (candil_version() < CANDIL_MAKE_VERSION(0, 2, 0))
//		die("this program needs libcandil 0.2 or later");
CANDIL_API uint32_t candil_version(void);

// ---- connection -----------------------------------------------------------------------------------------------------

// One connection, made by candil_connect and ended by candil_disconnect.
typedef struct candil_client candil_client;

// Write the path that NULL stands for in candil_connect, $XDG_RUNTIME_DIR/candil.sock, to `path`. false: that variable is
// not set, or the path and its zero do not fit in `capacity` bytes; `path` is then undefined.
//
// Example:
//	char path[108];
//	if (!candil_default_address(path, sizeof(path)))
//		die("XDG_RUNTIME_DIR is not set");
CANDIL_API bool candil_default_address(char *path, size_t capacity);

// Connect to the daemon's socket at `address` ("PATH" or "unix:PATH", 1 to 107 bytes of path; NULL: the default) and shake
// hands. Waits at most 30 s for either. On success *client is the caller's, to be ended with candil_disconnect; else it is
// NULL. Fails with CONNECT (nobody is there, or it is no daemon), BAD_VERSION, NOT_ALLOWED, TOO_MANY_CONNECTIONS,
// BAD_ARGUMENT (the path is too long), MEMORY.
//
// Example:
//	candil_client *other;
//	if (candil_connect(NULL, &other, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	candil_disconnect(other);
CANDIL_API candil_status candil_connect(const char *address, candil_client **client, struct candil_error *error);

// The same over a stream socket that is connected already. The descriptor is the client's from now on, even on failure: then
// it is closed. One that is anything else, or closed, fails at once with BAD_ARGUMENT.
//
// Example:
//	struct sockaddr_un to = {.sun_family = AF_UNIX};
//	candil_client *other;
//	int fd = socket(AF_UNIX, SOCK_STREAM, 0);
//	if (!candil_default_address(to.sun_path, sizeof(to.sun_path)) ||
//	    connect(fd, (const struct sockaddr *)&to, sizeof(to)) != 0)
//		die("nobody listens");
//	if (candil_connect_fd(fd, &other, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	candil_disconnect(other);
CANDIL_API candil_status candil_connect_fd(int fd, candil_client **client, struct candil_error *error);

// Close the connection and free the client. Requests under way are dropped: the daemon cancels their renders and loads.
// NULL is allowed.
CANDIL_API void candil_disconnect(candil_client *client);

// What the daemon said of itself in the handshake. Valid as long as the client.
//
// Example:
//	const struct candil_server *server = candil_server(client);
//	printf("%s takes %u jobs at once\n", server->name, (unsigned)server->max_jobs_per_connection);
CANDIL_API const struct candil_server *candil_server(const candil_client *client);

// How long a blocking call waits without a byte from the daemon before it fails with IO; the connection is over then.
// 0, the default: for ever. Each of the first renders with a new set of effects compiles shaders in silence: allow seconds,
// with a software driver minutes.
//
// Example:
//	candil_set_timeout(client, 120000);
CANDIL_API void candil_set_timeout(candil_client *client, uint32_t milliseconds);

// ---- blocking calls -------------------------------------------------------------------------------------------------
// All are refused with BAD_ARGUMENT while requests made by candil_submit_… are open: the events of those would have nowhere
// to go.

// Send a few bytes and wait until they come back. *microseconds (may be NULL) is how long that took.
//
// Example:
//	uint64_t microseconds;
//	if (candil_ping(client, &microseconds, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_ping(candil_client *client, uint64_t *microseconds, struct candil_error *error);

// Load a scene, or a picture of surroundings, and keep it in the daemon until it is unloaded; it replaces one of the same
// name. Waits until the file is read. `info` (may be NULL) says what is in it; it is large, some 26 KiB. Fails with
// BAD_ARGUMENT (a name or path is missing or too long, or both paths are given), SCENE_FILE (it cannot be opened),
// SCENE_PATH (the path is not allowed), SCENE_INVALID, SCENE_UNSUPPORTED and SCENE_LIMIT (what is wrong with the file),
// LOADER_LOST, TOO_MANY_SCENES, SCENE_QUARANTINED, TOO_MANY_JOBS, CANCELLED (another client unloaded the name meanwhile).
//
// Example:
//	const struct candil_load_request request = {.name = "other room", .file = "room.gltf"};
//	struct candil_scene_info info;
//	if (candil_load(client, &request, &info, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	for (uint32_t i = 0; i < info.warning_count; i++)
//		puts(info.warnings[i]);
CANDIL_API candil_status candil_load(candil_client *client, const struct candil_load_request *request,
				     struct candil_scene_info *info, struct candil_error *error);

// candil_load of a local file with everything else at its default.
//
// Example:
//	if (candil_load_file(client, "room", "room.gltf", NULL, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_load_file(candil_client *client, const char *name, const char *file,
					  struct candil_scene_info *info, struct candil_error *error);

// Take a scene's name away. Jobs that use the scene finish with it; its memory is free after the last. Fails with
// SCENE_NOT_FOUND.
//
// Example:
//	if (candil_unload(client, "room", &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_unload(candil_client *client, const char *name, struct candil_error *error);

// List the scenes that the daemon holds or is loading.
//
// Example:
//	struct candil_scene_list list;
//	if (candil_scenes(client, &list, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	for (uint32_t i = 0; i < list.count; i++)
//		printf("%s: %u triangles\n", list.scenes[i].name, (unsigned)list.scenes[i].triangles);
CANDIL_API candil_status candil_scenes(candil_client *client, struct candil_scene_list *list, struct candil_error *error);

// What candil_load said of a scene, once more. Fails with SCENE_NOT_FOUND, also while it is being loaded.
//
// Example:
//	struct candil_scene_info info;
//	if (candil_describe(client, "room", &info, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	printf("%u cameras, %u materials\n", (unsigned)info.camera_count, (unsigned)info.materials);
CANDIL_API candil_status candil_describe(candil_client *client, const char *name, struct candil_scene_info *info,
					 struct candil_error *error);

// The daemon's counters.
//
// Example:
//	struct candil_stats stats;
//	if (candil_stats(client, &stats, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	printf("renders on %s\n", stats.device_error[0] ? "nothing" : stats.device);
CANDIL_API candil_status candil_stats(candil_client *client, struct candil_stats *stats, struct candil_error *error);

// What candil_render and candil_sweep call while they wait, on the caller's thread. Any may be NULL. A result other than 0
// cancels the request, and the call then returns CANCELLED. What a pointer points to is valid during the callback alone. The
// client must not be used in a callback.
struct candil_callbacks {
	int (*accepted)(void *user, const struct candil_accepted *accepted); // once, when the device has the job
	int (*progress)(void *user, const struct candil_progress *progress); // any number of times
	int (*image)(void *user, const struct candil_image *image); // intermediate images, of a progressive render; of a
								    // sweep the final ones as well
	void *user; // handed to each of them
};

// The answer of candil_render.
struct candil_render_result {
	struct candil_image image; // the final one; its `data` is the caller's, to be freed with candil_free
	struct candil_accepted accepted;
	struct candil_done done;
};

// Fill in the defaults: 512x512 pixels, 64 samples, float EXR, technique and effects automatic, the scene's first camera, no
// edits. `scene` is left NULL, for the caller to set.
CANDIL_API void candil_render_request_init(struct candil_render_request *request);

// Render and wait for the final image. `callbacks` may be NULL. On failure result->image.data is NULL. Fails with
// BAD_ARGUMENT, LIMIT and UNSUPPORTED (the request is wrong), SCENE_NOT_FOUND, TOO_MANY_JOBS, MEMORY, DEVICE, DEADLINE (the
// deadline passed before there was a picture), WORKER_LOST, SCENE_QUARANTINED, TRAVERSAL_CUT, ENCODE, CANCELLED.
//
// Example:
//	struct candil_render_request request;
//	struct candil_render_result result;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = 96;
//	request.height = 64;
//	request.samples = 4;
//	request.format = CANDIL_FORMAT_PNG;
//	request.view = CANDIL_VIEW_FILMIC;
//	if (candil_render(client, &request, NULL, &result, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	printf("%zu bytes of PNG, %u samples\n", result.image.bytes, (unsigned)result.done.samples);
//	candil_free(result.image.data);
CANDIL_API candil_status candil_render(candil_client *client, const struct candil_render_request *request,
				       const struct candil_callbacks *callbacks, struct candil_render_result *result,
				       struct candil_error *error);

// The answer of candil_sweep.
struct candil_sweep_result {
	struct candil_accepted accepted; // of the first image
	struct candil_done done; // sums over all images, but for samples (of each) and relMSE (the means)
};

// Render the same picture from `count` cameras, 1 to CANDIL_SWEEP_CAMERAS, or at as many times of an animation. The
// request's own camera is not used. Each image comes through callbacks->image as soon as it is finished, in the order of the
// cameras; image->index says which it is. While a callback takes its time, the daemon goes on with one more image and then
// waits. A failure ends the whole sweep; images that have come are good. Fails as candil_render does.
//
// Example:
//	const struct candil_camera cameras[2] = {
//		{.eye = {0, 1, 4}, .target = {0, 1, 0}, .up = {0, 1, 0}, .vfov_degrees = 35},
//		{.name = "view"},
//	};
//	struct candil_render_request request;
//	struct candil_sweep_result result;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = request.height = 32;
//	request.samples = 1;
//	if (candil_sweep(client, &request, cameras, 2, NULL, &result, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_sweep(candil_client *client, const struct candil_render_request *request,
				      const struct candil_camera *cameras, size_t count,
				      const struct candil_callbacks *callbacks, struct candil_sweep_result *result,
				      struct candil_error *error);

// What would that render take, and how good would it be? `request` is one of candil_render. Its target_error asks for the
// least time within that error, its deadline_ms for the least error within that time, neither for this very request;
// CANDIL_TECHNIQUE_AUTO leaves the technique open. Nothing is rendered but a small look at a scene that is not known yet,
// and the answer is there within a second from the scene; `pilot_ms` above 0, up to 60000, allows so much device time for
// that look, by every technique: then the answer is waited for as long as the look takes. Fails as candil_render does with
// what is wrong with the request, and with TOO_MANY_JOBS, MEMORY.
//
// Example: as good as can be within 200 ms
//	struct candil_render_request request;
//	struct candil_quote quote;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.samples = 0;
//	request.deadline_ms = 200;
//	if (candil_ask_quote(client, &request, 0, &quote, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	printf("%s, %u samples: %.0f ms, relMSE %.2g%s\n", candil_technique_name(quote.choice.technique),
//	       (unsigned)quote.choice.samples, quote.choice.time_ms, quote.choice.relmse, quote.met ? "" : ", too late");
CANDIL_API candil_status candil_ask_quote(candil_client *client, const struct candil_render_request *request,
					  uint32_t pilot_ms, struct candil_quote *quote, struct candil_error *error);

// Free the bytes of an image that the library handed over. NULL is allowed.
CANDIL_API void candil_free(const void *data);

// ---- non-blocking calls ---------------------------------------------------------------------------------------------

// The descriptor to poll, the client's own. Do nothing else with it.
CANDIL_API int candil_fd(const candil_client *client);

// Whether to poll for POLLOUT besides POLLIN: bytes are waiting to be sent.
CANDIL_API bool candil_wants_write(const candil_client *client);

// Send and receive what can be without waiting. Harmless when there is nothing to do. Fails with what ended the connection,
// IO mostly, once it is over and no request is open; each open request gets an ERROR event first.
//
// Example: a poll loop that sees one render through
//	struct candil_render_request request;
//	struct candil_event event = {0};
//	uint32_t id;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = request.height = 32;
//	request.samples = 1;
//	if (candil_submit_render(client, &request, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	while (!event.ends_request) {
//		struct pollfd p = {candil_fd(client), POLLIN, 0};
//		if (candil_wants_write(client))
//			p.events |= POLLOUT;
//		poll(&p, 1, -1);
//		if (candil_process(client, &error) != CANDIL_STATUS_OK)
//			die(error.text);
//		while (!event.ends_request && candil_next_event(client, &event)) {
//			if (event.kind == CANDIL_EVENT_ERROR)
//				die(event.u.error.text);
//			if (event.kind == CANDIL_EVENT_IMAGE && event.u.image.final)
//				printf("%zu bytes of EXR\n", event.u.image.bytes);
//		}
//	}
CANDIL_API candil_status candil_process(candil_client *client, struct candil_error *error);

// Queue a request and write its id, which is not 0, to *id. Nothing is sent before candil_process. What the daemon refuses
// comes as an ERROR event; the call itself fails with BAD_ARGUMENT (a string is too long or missing), LIMIT (a list is too
// long, or too much waits to be sent), TOO_MANY_JOBS (64 requests are open), SCENE_FILE (a local file cannot be opened),
// MEMORY, or what ended the connection. *id is then 0, and there is no event.

// Ends with a PONG event that brings the payload back: 0 to 256 bytes.
//
// Example:
//	uint32_t id;
//	if (candil_submit_ping(client, "still there?", 12, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_ping(candil_client *client, const void *payload, size_t bytes, uint32_t *id,
					    struct candil_error *error);

// As candil_load. Ends with a SCENE event.
//
// Example:
//	const struct candil_load_request request = {.name = "another room", .file = "room.gltf"};
//	uint32_t id;
//	if (candil_submit_load(client, &request, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_load(candil_client *client, const struct candil_load_request *request, uint32_t *id,
					    struct candil_error *error);

// As candil_unload. Ends with an OK event.
//
// Example:
//	uint32_t id;
//	if (candil_submit_unload(client, "room", &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_unload(candil_client *client, const char *name, uint32_t *id,
					      struct candil_error *error);

// As candil_scenes. Ends with a SCENES event.
//
// Example: three questions at once, whose answers come in any order
//	uint32_t scenes, room, stats;
//	if (candil_submit_scenes(client, &scenes, &error) != CANDIL_STATUS_OK ||
//	    candil_submit_describe(client, "room", &room, &error) != CANDIL_STATUS_OK ||
//	    candil_submit_stats(client, &stats, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_scenes(candil_client *client, uint32_t *id, struct candil_error *error);

// As candil_describe. Ends with a SCENE event.
CANDIL_API candil_status candil_submit_describe(candil_client *client, const char *name, uint32_t *id,
						struct candil_error *error);

// As candil_render. Brings ACCEPTED, any number of PROGRESS (some before it if beginning takes long), with `progressive` any
// number of IMAGE that are not final, then one IMAGE that is, and ends with DONE.
CANDIL_API candil_status candil_submit_render(candil_client *client, const struct candil_render_request *request,
					      uint32_t *id, struct candil_error *error);

// As candil_sweep. Brings what a render does, but one final IMAGE for each camera.
//
// Example:
//	const struct candil_camera cameras[2] = {{.name = "view"}, {.name = "view"}};
//	struct candil_render_request request;
//	uint32_t id;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = request.height = 32;
//	request.samples = 1;
//	if (candil_submit_sweep(client, &request, cameras, 2, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_sweep(candil_client *client, const struct candil_render_request *request,
					     const struct candil_camera *cameras, size_t count, uint32_t *id,
					     struct candil_error *error);

// As candil_ask_quote. Ends with a QUOTE event.
//
// Example:
//	struct candil_render_request request;
//	uint32_t id;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	if (candil_submit_quote(client, &request, 0, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_submit_quote(candil_client *client, const struct candil_render_request *request,
					     uint32_t pilot_ms, uint32_t *id, struct candil_error *error);

// As candil_stats. Ends with a STATS event.
CANDIL_API candil_status candil_submit_stats(candil_client *client, uint32_t *id, struct candil_error *error);

// Ask the daemon to cancel the render, sweep or quote `id`. This has no event of its own: the render ends with ERROR and
// CANCELLED, or with DONE where it was quicker. To ask twice is harmless. Fails with NO_SUCH_REQUEST if no such request of
// that id is open.
//
// Example:
//	struct candil_render_request request;
//	uint32_t id;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.samples = 1000000;
//	if (candil_submit_render(client, &request, &id, &error) != CANDIL_STATUS_OK ||
//	    candil_cancel(client, id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
CANDIL_API candil_status candil_cancel(candil_client *client, uint32_t id, struct candil_error *error);

// What an event is about, and which member of its union it fills. A library of the same name sends no others.
enum candil_event_kind {
	CANDIL_EVENT_PONG = 1, // pong: ends a ping
	CANDIL_EVENT_SCENE = 2, // scene: ends a load or a describe
	CANDIL_EVENT_OK = 3, // nothing: ends an unload
	CANDIL_EVENT_SCENES = 4, // scenes: ends a list
	CANDIL_EVENT_ACCEPTED = 5, // accepted: of a render or sweep, once
	CANDIL_EVENT_PROGRESS = 6, // progress: of a render or sweep, any number of times
	CANDIL_EVENT_IMAGE = 7, // image: of a render or sweep
	CANDIL_EVENT_DONE = 8, // done: ends a render or sweep; its final images came before
	CANDIL_EVENT_STATS = 9, // stats: ends a stats request
	CANDIL_EVENT_ERROR = 10, // error: ends any request
	CANDIL_EVENT_QUOTE = 11, // quote: ends a quote
};

// One piece of an answer. It is large, some 26 KiB, because a scene's description is.
struct candil_event {
	enum candil_event_kind kind;
	uint32_t id; // the request's
	bool ends_request; // no event with this id will follow
	union {
		struct {
			size_t bytes;
			uint8_t payload[256];
		} pong;
		struct candil_scene_info scene;
		struct candil_scene_list scenes;
		struct candil_accepted accepted;
		struct candil_progress progress;
		struct candil_image image; // `data` is the client's, valid until the next candil_next_event or
					   // candil_disconnect, unless candil_keep_image takes it
		struct candil_done done;
		struct candil_stats stats;
		struct candil_error error;
		struct candil_quote quote;
	} u;
};

// Take the next event that has arrived. false: there is none now; go back to poll. Does not touch the socket.
CANDIL_API bool candil_next_event(candil_client *client, struct candil_event *event);

// Right after an IMAGE event: the caller owns image->data from now on and frees it with candil_free, also after
// candil_disconnect.
//
// Example:
//	struct candil_render_request request;
//	struct candil_event event = {0};
//	const uint8_t *picture = NULL;
//	uint32_t id;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = request.height = 32;
//	request.samples = 1;
//	if (candil_submit_render(client, &request, &id, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	struct pollfd p = {candil_fd(client), POLLIN, 0};
//	while (!event.ends_request && candil_process(client, &error) == CANDIL_STATUS_OK) {
//		while (!event.ends_request && candil_next_event(client, &event)) {
//			if (event.kind != CANDIL_EVENT_IMAGE || !event.u.image.final)
//				continue;
//			candil_keep_image(client, &event.u.image);
//			picture = event.u.image.data;
//		}
//		poll(&p, 1, 10);
//	}
//	if (!picture)
//		die("the render failed");
//	candil_free(picture);
CANDIL_API void candil_keep_image(candil_client *client, const struct candil_image *image);

// ---- names -----------------------------------------------------------------------------------------------------------
// What people type and programs print, for every number of an enumeration; "unknown" for a number that is none. The strings
// are static.

// "scene-not-found", for example. The names are for ever.
//
// Example:
//	if (candil_unload(client, "nowhere", &error) == CANDIL_STATUS_SCENE_NOT_FOUND)
//		printf("%s (%s)\n", error.text, candil_status_name(error.code));
CANDIL_API const char *candil_status_name(candil_status status);

// The value of `candil render --technique`.
//
// Example:
//	printf("%s, %s, %s, %s, %s, %s\n", candil_technique_name(CANDIL_TECHNIQUE_AUTO), // auto
//	       candil_effect_name(CANDIL_EFFECT_TEXTURES), // textures
//	       candil_effect_state_name(CANDIL_EFFECT_SWITCHED_OFF), // switched-off
//	       candil_error_kind_name(CANDIL_ERROR_KIND_MEASURED), // measured
//	       candil_format_name(CANDIL_FORMAT_EXR_HALF), // exr-half
//	       candil_view_name(CANDIL_VIEW_REINHARD)); // reinhard
CANDIL_API const char *candil_technique_name(enum candil_technique technique);

// The word of `candil render --effects`.
CANDIL_API const char *candil_effect_name(enum candil_effect effect);

// "simulated", "absent", "switched-off", "forced" or "unsupported".
CANDIL_API const char *candil_effect_state_name(enum candil_effect_state state);

// "unknown", "measured" or "predicted".
CANDIL_API const char *candil_error_kind_name(enum candil_error_kind kind);

// "exr-half", "exr-float", "png", "ply" or "mtx".
CANDIL_API const char *candil_format_name(enum candil_format format);

// "none", "reinhard" or "filmic".
CANDIL_API const char *candil_view_name(enum candil_view view);

#ifdef __cplusplus
}
#endif

#endif
