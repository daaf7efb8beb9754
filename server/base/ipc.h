// The front's line to the processes it starts: a SOCK_SEQPACKET pair, one datagram a message, descriptors beside it.
// Both ends are of one build, so the messages are plain structs; `ipc_build` in the first one proves it.
// The child finds its end at descriptor IPC_FD.
//
//   front -> worker   SCENE(fd)  FORGET  BEGIN  STEP  READ  END
//   worker -> front   READY      BEGUN   STEPPED  IMAGE(fd)      (IMAGE comes from the encoder's thread, at any time)
//   loader -> front   LOADED(fd)         (the loader's orders are its arguments; it sends one message and exits)
#ifndef CANDIL_BASE_IPC_H
#define CANDIL_BASE_IPC_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"

#define IPC_FD 3
#define IPC_SCENE_DIR_FD 4 // loader: the scene's folder, O_PATH|O_DIRECTORY or readable
#define IPC_MAX_BYTES (128u * 1024u)

enum ipc_op {
	// front -> worker
	IPC_SCENE = 1, // struct ipc_scene, one sealed blob: known from now on under its id
	IPC_FORGET, // struct ipc_scene: jobs that use it go on; the blob is let go after the last
	IPC_BEGIN, // struct ipc_begin
	IPC_STEP, // struct ipc_step: work on the job for about budget_us
	IPC_READ, // struct ipc_read: encode what has been accumulated
	IPC_END, // struct ipc_job: forget the job (READs already asked for still answer)
	// worker -> front
	IPC_READY, // struct ipc_ready, once
	IPC_BEGUN, // struct ipc_begun, one a BEGIN
	IPC_STEPPED, // struct ipc_stepped, one a STEP
	IPC_IMAGE, // struct ipc_image, one a READ, the encoded file as a sealed memfd unless error
	// loader -> front
	IPC_LOADED, // struct ipc_loaded, the blob as a sealed memfd unless error
};

struct ipc_head {
	uint32_t op; // enum ipc_op
	uint32_t job; // 0 where none is meant
};

struct ipc_scene {
	struct ipc_head head;
	uint64_t scene; // id, never used twice in the front's life
};

struct ipc_begin {
	struct ipc_head head;
	uint64_t scene;
	uint64_t environment; // id of the picture of its surroundings; 0: none
	candil_Render render; // checked by the front
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
};

struct ipc_ready {
	struct ipc_head head;
	char build[64]; // ipc_build()
	char device[128]; // "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6"
	uint32_t software; // no GPU behind it
	struct error error; // code != OK: no usable device; the worker then only answers BEGIN with this error
};

struct ipc_begun {
	struct ipc_head head;
	struct error error;
	candil_Accepted accepted; // valid if error.code is OK
};

struct ipc_stepped {
	struct ipc_head head;
	struct error error; // any but OK: the job is dead and needs END
	uint32_t samples_done; // complete ones, of every pixel
	uint32_t finished; // time for the last READ: all samples are in, or
	uint32_t reached; // so is the target error
	double fraction; // of the job's work
	double estimated_relmse; // at the last look; negative: unknown
	uint64_t device_us; // this slice took
	uint64_t device_bytes; // held on the device now, all jobs
	uint64_t validation_errors; // since the worker started
};

struct ipc_image {
	struct ipc_head head;
	struct error error;
	candil_ImageFrame frame;
	candil_Done done; // the worker's part: samples, stages, estimates, counts, device; for a final READ
};

struct ipc_loaded {
	struct ipc_head head;
	char build[64];
	struct error error;
	candil_SceneInfo info; // without name and load_us, which the front knows
};

// Identifies a build: version and a hash of the message sizes.
const char *ipc_build(void);

// Send one datagram with up to one descriptor (fd < 0: none). The descriptor stays the caller's. Thread-safe.
// STATUS_IO if the peer is gone or, on a non-blocking socket, cannot take it now (errno is EAGAIN then).
enum status ipc_send(int socket, const void *message, size_t bytes, int fd, struct error *err);

// Receive one datagram into `buffer` (IPC_MAX_BYTES is always enough). *bytes 0 means the peer closed. *fd is -1 or a new
// close-on-exec descriptor that the caller owns. STATUS_INTERNAL for a message that is longer or brings more; none of its
// descriptors stays open. On a non-blocking socket with nothing to read: STATUS_IO and errno EAGAIN.
enum status ipc_receive(int socket, void *buffer, size_t capacity, size_t *bytes, int *fd, struct error *err);

#endif
