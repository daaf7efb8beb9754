// libcandil: the client side of candild, a headless render service. This header, which has the calls, and candil_types.h,
// which has what they take and give, are the manual.
//
// A `candil_client` is one connection. Two ways to use it, which can follow each other on one connection:
//
//  - Blocking: candil_connect, candil_load_file, candil_render, candil_disconnect. Each call returns with its answer.
//  - Non-blocking, for a poll loop of your own: candil_submit_… queues a request and returns its id; when candil_fd is
//    readable (or writable, while candil_wants_write says so) call candil_process, then candil_next_event until it returns
//    false. Many requests, renders above all, share one connection that way; every event bears its request's id.
//
// Threads: a client belongs to one thread at a time; different clients are independent. The library has no global state,
// starts no thread, installs no signal handler and raises no SIGPIPE.
//
// Failure: a call that can fail returns a candil_status and, unless `error` is NULL, fills in a sentence that says what to
// do. After CANDIL_STATUS_IO or CANDIL_STATUS_CONNECT the connection is over: all that is left is candil_disconnect.
//
// Ownership: strings and arrays that go in stay the caller's and are copied before the call returns. What comes out is plain
// values without pointers, but for image bytes, whose owner is said where they appear.
//
// Units: metres, degrees, W/(m² sr), microseconds unless a name says otherwise. Colours are linear Rec.709.
#ifndef CANDIL_H
#define CANDIL_H

#include "candil_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CANDIL_API __attribute__((visibility("default")))
#else
#define CANDIL_API
#endif

// ---- connection -----------------------------------------------------------------------------------------------------

typedef struct candil_client candil_client;

// The path that NULL stands for in candil_connect: $XDG_RUNTIME_DIR/candil.sock. false if that variable is not set or the
// path does not fit in `capacity` bytes.
CANDIL_API bool candil_default_address(char *path, size_t capacity);

// Connect to the socket at `address` ("PATH" or "unix:PATH"; NULL: the default) and shake hands; waits at most 10 s.
// On success *client is the caller's, to be ended with candil_disconnect; else it is NULL.
// Fails with CONNECT (nobody there), BAD_VERSION, NOT_ALLOWED, TOO_MANY_CONNECTIONS, BAD_ARGUMENT (the path is too long).
CANDIL_API candil_status candil_connect(const char *address, candil_client **client, struct candil_error *error);

// The same on a stream socket that is connected already. The descriptor is the client's from now on, even on failure.
CANDIL_API candil_status candil_connect_fd(int fd, candil_client **client, struct candil_error *error);

// Close and free. Requests under way are dropped; the daemon frees their device time. NULL is allowed.
CANDIL_API void candil_disconnect(candil_client *client);

// Valid as long as the client.
CANDIL_API const struct candil_server *candil_server(const candil_client *client);

// How long a blocking call waits with no byte from the daemon before it fails with IO; the connection is over then.
// 0, the default: for ever. The first render with a new set of effects compiles shaders in silence: allow seconds.
CANDIL_API void candil_set_timeout(candil_client *client, uint32_t milliseconds);

// ---- blocking calls -------------------------------------------------------------------------------------------------
// Refused with BAD_ARGUMENT while requests made by candil_submit_… are open: their events would have nowhere to go.

// A round trip. *microseconds (may be NULL) is how long it took.
CANDIL_API candil_status candil_ping(candil_client *client, uint64_t *microseconds, struct candil_error *error);

// Load a scene and keep it in the daemon until it is unloaded. `info` may be NULL.
CANDIL_API candil_status candil_load(candil_client *client, const struct candil_load_request *request,
				     struct candil_scene_info *info, struct candil_error *error);

// candil_load of a local file with everything else at its default.
CANDIL_API candil_status candil_load_file(candil_client *client, const char *name, const char *file,
					  struct candil_scene_info *info, struct candil_error *error);

CANDIL_API candil_status candil_unload(candil_client *client, const char *name, struct candil_error *error);
CANDIL_API candil_status candil_scenes(candil_client *client, struct candil_scene_list *list, struct candil_error *error);
CANDIL_API candil_status candil_describe(candil_client *client, const char *name, struct candil_scene_info *info,
					 struct candil_error *error);
CANDIL_API candil_status candil_stats(candil_client *client, struct candil_stats *stats, struct candil_error *error);

// What candil_render calls while it waits. Any may be NULL. A result other than 0 cancels the render, which then returns
// CANCELLED. Image bytes are valid during the call only. The client must not be used inside.
struct candil_callbacks {
	int (*accepted)(void *user, const struct candil_accepted *accepted);
	int (*progress)(void *user, const struct candil_progress *progress);
	int (*image)(void *user, const struct candil_image *image); // intermediate images, of a progressive render; of a
								    // sweep, the final ones as well
	void *user;
};

struct candil_render_result {
	struct candil_image image; // the final one; `data` is the caller's, to be freed with candil_free
	struct candil_accepted accepted;
	struct candil_done done;
};

// 512x512, 64 samples, float EXR, technique and effects automatic, the scene's first camera. `scene` is left NULL.
CANDIL_API void candil_render_request_init(struct candil_render_request *request);

// Render and return the final image. `callbacks` may be NULL. On failure result->image.data is NULL.
CANDIL_API candil_status candil_render(candil_client *client, const struct candil_render_request *request,
				       const struct candil_callbacks *callbacks, struct candil_render_result *result,
				       struct candil_error *error);

struct candil_sweep_result {
	struct candil_accepted accepted; // of the first image
	struct candil_done done; // sums over all images, but for samples (of each) and estimated_relmse (the mean)
};

// The same picture from `count` cameras, 1 to CANDIL_SWEEP_CAMERAS, or at as many times of an animation. The request's own
// camera is not used. Each image comes through callbacks->image as soon as it is finished, in the order of the cameras,
// image->index saying which; if that takes long, the daemon goes on with one more image and then waits. A failure ends the
// whole sweep; images that have come are good.
CANDIL_API candil_status candil_sweep(candil_client *client, const struct candil_render_request *request,
				      const struct candil_camera *cameras, size_t count,
				      const struct candil_callbacks *callbacks, struct candil_sweep_result *result,
				      struct candil_error *error);

// Free image bytes that the library handed over. NULL is allowed.
CANDIL_API void candil_free(const void *data);

// ---- non-blocking calls ---------------------------------------------------------------------------------------------

// The descriptor to poll. Do nothing else with it.
CANDIL_API int candil_fd(const candil_client *client);

// Whether to poll for POLLOUT besides POLLIN: bytes are waiting to be sent.
CANDIL_API bool candil_wants_write(const candil_client *client);

// Send and receive what can be without waiting. Harmless when there is nothing to do. Fails with IO once the connection is
// over and every event has been taken; the open requests each get an ERROR event first.
CANDIL_API candil_status candil_process(candil_client *client, struct candil_error *error);

// Queue a request and write its id to *id. Nothing is sent before candil_process. Fails with BAD_ARGUMENT (a string is too
// long or missing), TOO_MANY_JOBS (64 requests are open), SCENE_FILE (a local file cannot be opened), MEMORY, IO.
CANDIL_API candil_status candil_submit_ping(candil_client *client, const void *payload, size_t bytes, uint32_t *id,
					    struct candil_error *error); // payload: at most 256 bytes, comes back
CANDIL_API candil_status candil_submit_load(candil_client *client, const struct candil_load_request *request, uint32_t *id,
					    struct candil_error *error);
CANDIL_API candil_status candil_submit_unload(candil_client *client, const char *name, uint32_t *id,
					      struct candil_error *error);
CANDIL_API candil_status candil_submit_scenes(candil_client *client, uint32_t *id, struct candil_error *error);
CANDIL_API candil_status candil_submit_describe(candil_client *client, const char *name, uint32_t *id,
						struct candil_error *error);
CANDIL_API candil_status candil_submit_render(candil_client *client, const struct candil_render_request *request,
					      uint32_t *id, struct candil_error *error);
CANDIL_API candil_status candil_submit_sweep(candil_client *client, const struct candil_render_request *request,
					     const struct candil_camera *cameras, size_t count, uint32_t *id,
					     struct candil_error *error); // see candil_sweep
CANDIL_API candil_status candil_submit_stats(candil_client *client, uint32_t *id, struct candil_error *error);

// Ask the daemon to cancel render or sweep `id`. Has no event of its own: the render ends with ERROR cancelled, or with DONE
// where it was quicker. Fails with NO_SUCH_REQUEST if no such request of that id is open.
CANDIL_API candil_status candil_cancel(candil_client *client, uint32_t id, struct candil_error *error);

enum candil_event_kind {
	CANDIL_EVENT_PONG = 1, // pong             ends a ping
	CANDIL_EVENT_SCENE, // scene            ends a load or a describe
	CANDIL_EVENT_OK, //                  ends an unload
	CANDIL_EVENT_SCENES, // scenes           ends a list
	CANDIL_EVENT_ACCEPTED, // accepted         of a render: once
	CANDIL_EVENT_PROGRESS, // progress         of a render: any number
	CANDIL_EVENT_IMAGE, // image            of a render: intermediate ones, then one that is final;
			    //                  of a sweep: so for each camera in turn
	CANDIL_EVENT_DONE, // done             ends a render or a sweep; the final images came before it
	CANDIL_EVENT_STATS, // stats            ends a stats request
	CANDIL_EVENT_ERROR, // error            ends any request
};

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
		struct candil_image image; // data: the client's, valid until the next candil_next_event or candil_disconnect
		struct candil_done done;
		struct candil_stats stats;
		struct candil_error error;
	} u;
};

// Take the next event that has arrived. false: none now; go back to poll. Does not touch the socket.
CANDIL_API bool candil_next_event(candil_client *client, struct candil_event *event);

// After an IMAGE event: the caller owns image->data from now on and frees it with candil_free.
CANDIL_API void candil_keep_image(candil_client *client, const struct candil_image *image);

// ---- names -----------------------------------------------------------------------------------------------------------

// "scene-not-found": the stable name of a status; "unknown" for a number that is none. Static.
CANDIL_API const char *candil_status_name(candil_status status);

// "0.1.0", of the library. Static.
CANDIL_API const char *candil_library_version(void);

// The names that people type: "pt", "textures", "switched-off", "exr-half", "reinhard"; "unknown" for other values. Static.
CANDIL_API const char *candil_technique_name(enum candil_technique technique);
CANDIL_API const char *candil_effect_name(enum candil_effect effect);
CANDIL_API const char *candil_effect_state_name(enum candil_effect_state state);
CANDIL_API const char *candil_format_name(enum candil_format format);
CANDIL_API const char *candil_view_name(enum candil_view view);

#ifdef __cplusplus
}
#endif

#endif
