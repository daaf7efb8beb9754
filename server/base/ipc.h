// The protocol between the front and the processes that it starts: a SOCK_SEQPACKET socket pair with one datagram for each
// message; descriptors are passed beside it. Both ends are of the same build, so the messages are plain structs;
// `ipc_build` in the first message proves it. The child finds its end at descriptor IPC_FD.
//
//   front -> worker   SCENE(fd)  FORGET  BEGIN  STEP  READ  END  PILOT  PILOT_END
//   worker -> front   READY      BEGUN   STEPPED  IMAGE(fd)  PILOTED  STATE  LOST  WAITS
//                     (the encoder's thread sends IMAGE and WAITS, at any time)
//   front -> compiler SCENE(fd)  BEGIN   (a worker that compiles what the job needs, says nothing and exits)
//   loader -> front   WAITS  LOADED(fd)  (the loader's orders are its arguments; it sends one LOADED and exits)
#ifndef CANDIL_BASE_IPC_H
#define CANDIL_BASE_IPC_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/names.h"
#include "server/base/error.h"
#include "server/base/estimate.h"
#include "server/base/part.h"
#include "server/base/pilot.h"
#include "server/base/remarks.h"

#define IPC_FD 3
#define IPC_SCENE_DIR_FD 4 // loader: the scene's folder, O_PATH|O_DIRECTORY or readable
#define IPC_MAX_BYTES (128u * 1024u)

enum ipc_op {
	// front -> worker
	IPC_SCENE = 1, // struct ipc_scene and a sealed blob, which from now on has this id
	IPC_FORGET, // struct ipc_scene: jobs that use it go on; the blob is unmapped after the last of them
	IPC_BEGIN, // struct ipc_begin
	IPC_STEP, // struct ipc_step: work on the job for about budget_us
	IPC_READ, // struct ipc_read: encode what has been accumulated; the final one is the job's END, too
	IPC_END, // struct ipc_job: forget the job; READs already requested are still answered
	IPC_PILOT, // struct ipc_pilot: look at a scene
	IPC_PILOT_END, // struct ipc_job: the PILOT before it is to end as soon as can be, and is answered with what it has
	// worker -> front
	IPC_READY, // struct ipc_ready, once
	IPC_BEGUN, // struct ipc_begun, the answer to a BEGIN
	IPC_STEPPED, // struct ipc_stepped, the answer to a STEP
	IPC_IMAGE, // struct ipc_image, the answer to a READ, with the file as a sealed memfd unless there is an error
	IPC_PILOTED, // struct ipc_piloted, the answer to a PILOT
	IPC_LOST, // struct ipc_lost: the device was lost, and the worker ends
	IPC_STATE, // struct ipc_state, when it has changed, ahead of the answer to what has changed it
	// loader -> front
	IPC_LOADED, // struct ipc_loaded, with the blob as a sealed memfd unless there is an error
	// both -> front
	IPC_WAITS, // struct ipc_head: a descriptor waits until fewer of the user's are on their way; the sender may be still
};

struct ipc_head {
	uint32_t op; // enum ipc_op
	uint32_t job; // 0 if the message concerns no job
};

struct ipc_scene {
	struct ipc_head head;
	uint64_t scene; // id, never reused while the front runs
};

struct ipc_begin {
	struct ipc_head head;
	uint64_t parts[PARTS]; // ids of the scenes that it names; 0: none
	candil_Render render; // already checked by the front
	uint64_t end_us; // clock_us() by which sampling has to end for its deadline; UINT64_MAX: never
	uint32_t compile; // compile what the driver has not compiled before; 0: refuse the job where that is needed
};

struct ipc_job {
	struct ipc_head head;
};

struct ipc_step {
	struct ipc_head head;
	uint32_t budget_us;
};

struct ipc_read {
	struct ipc_head head;
	uint32_t final;
	struct estimate
	    predicted; // what the picture's error should be, for reply and file where the worker does not know it
};

struct ipc_ready {
	struct ipc_head head;
	char build[64]; // ipc_build()
	char device[128]; // for instance "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6"
	uint32_t software; // 1: a software driver, no GPU
	char key[48]; // what --avoid takes for this device
	uint32_t others; // usable devices that the options allow, beside this one and those to be avoided
	struct error error; // code != OK: no usable device; the worker then answers every BEGIN with this error
};

struct ipc_begun {
	struct ipc_head head;
	struct error error;
	uint64_t cold; // not 0: refused, because something has to be compiled first, of which this is the number
	candil_Accepted accepted; // valid if error.code is OK
};

struct ipc_stepped {
	struct ipc_head head;
	struct error error; // code != OK: the job has failed; only END may follow
	uint64_t cold; // as of struct ipc_begun
	uint32_t samples_done; // completed samples of every pixel
	uint32_t finished; // 1: all samples are done, or the target error is reached; time for the last READ
	uint32_t reached; // 1: the target error is reached
	uint32_t late; // 1: no more fits before end_us; time for the last READ
	uint32_t ready; // 1: there is a picture to READ
	uint32_t scaled; // 1: it has fewer pixels than were asked for, and is scaled up
	double fraction; // done share of the job's work
	struct estimate estimate; // the latest
	uint64_t device_us; // device time of this slice
};

struct ipc_image {
	struct ipc_head head;
	struct error error;
	candil_ImageFrame frame;
	candil_Done done; // for a final READ, the worker's part: samples, stages, estimates, counts, device
	struct work work; // likewise, what the job made once for the scene
};

struct ipc_pilot {
	struct ipc_head head; // `job` is the quote's number
	uint64_t parts[PARTS]; // as of struct ipc_begin
	uint32_t budget_us; // of work of each technique, beside compiling
	uint32_t limit_us; // of all of it: no picture is begun or gone on with past it
	uint32_t techniques; // bits 1 << candil_Technique
	uint32_t told; // the same: those whose work is told, whether or not there are pictures by them
	uint32_t try_us; // for which some of that work is tried out; 0: it is counted
	uint32_t compile; // as of struct ipc_begin
	candil_Render render; // already checked by the front; its technique does not count
};

struct ipc_piloted {
	struct ipc_head head;
	struct error error; // code != OK: nothing came of it
	uint64_t cold; // as of struct ipc_begun; nothing came of it
	uint32_t cold_technique; // the technique that needs it
	uint32_t cut; // 1: its PILOT_END came in time to keep something from being seen
	struct pilot_result results[TECHNIQUE_COUNT]; // by technique
};

struct ipc_lost {
	struct ipc_head head;
	struct error error;
};

struct ipc_state {
	struct ipc_head head;
	uint64_t device_bytes; // bytes held on the device now, by jobs and scenes; 0 until told
	uint64_t validation_errors; // since the worker started; likewise
};

struct ipc_loaded {
	struct ipc_head head;
	char build[64];
	struct error error;
	candil_SceneInfo info; // without name and load_us, which the front knows
	struct scene_remarks remarks;
	uint32_t wants_images; // it failed because it was started without their decoder, and is to be started with it
};

// The identification of a build: version and message sizes. Static storage. Any thread.
const char *ipc_build(void);

// Send one datagram with at most one descriptor (fd < 0: none). The descriptor remains the caller's. Any thread. STATUS_IO
// if the peer is gone. Also STATUS_IO, with errno EAGAIN, if a non-blocking socket cannot take it now.
// STATUS_IO with errno ETOOMANYREFS: more descriptors of the user are on their way than this process may have open.
enum status ipc_send(int socket, const void *message, size_t bytes, int fd, struct error *err);

// The same, but wait until there are fewer of them, and tell the peer now and then by IPC_WAITS. Not for the front, which
// never waits.
enum status ipc_send_patiently(int socket, const void *message, size_t bytes, int fd, struct error *err);

#define IPC_PAUSE_MS 10u // between two tries
#define IPC_TRIES_TOLD 16u // one IPC_WAITS for so many: often enough for the shortest --hang, a second

// Whether the next datagram is there already and is of this kind. It stays. Any thread.
bool ipc_next_is(int socket, enum ipc_op op);

// The descriptor that came with a message is lost: this process, or the system, had none left for it.
#define IPC_LOST_FD (-2)

// Receive one datagram into `buffer`; IPC_MAX_BYTES is always enough. *bytes is 0 if the peer has closed. *fd is -1, a
// new close-on-exec descriptor that the caller owns, or IPC_LOST_FD, with the message whole. STATUS_INTERNAL for a message
// that is longer than `capacity` or carries more than one descriptor; all its descriptors are closed. STATUS_IO, with errno
// EAGAIN, if a non-blocking socket has nothing to read.
enum status ipc_receive(int socket, void *buffer, size_t capacity, size_t *bytes, int *fd, struct error *err);

// For a child, before anything that takes time: have the kernel kill it when the thread that started it ends. False if the
// parent, which held the other end of `socket`, has ended already.
bool ipc_end_with_parent(int socket);

#endif
