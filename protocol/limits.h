// Every limit of the service, by name. PROTOCOL.md prints them; candil.options repeats those that bound a message's
// strings and arrays (protocol/status.c asserts that they agree).
#ifndef CANDIL_PROTOCOL_LIMITS_H
#define CANDIL_PROTOCOL_LIMITS_H

// ---- messages and connections ----
#define LIMIT_MESSAGE_BYTES (64u * 1024u) // body of one request or reply
#define LIMIT_CHUNK_BYTES (64u * 1024u) // body of one FRAME_CHUNK
#define LIMIT_CONNECTIONS 256u // fewer where descriptors are
#define LIMIT_TURNED_AWAY 4u // connections beyond them that are open until they know, one of them without being waited for
#define LIMIT_JOBS_PER_CONNECTION 16u
#define LIMIT_JOBS 256u // in the daemon
#define LIMIT_SHARE 3u // times what is left, that a peer with some may have of what all share
#define LIMIT_OUT_BUFFER_BYTES (256u * 1024u) // unsent bytes past which a connection is not read and gets no chunks
#define LIMIT_HELLO_MS 10000u // a connection that has not said hello by then is closed
#define LIMIT_LINGER_MS 1000u // after its last message a connection that closes gets so long to read it
#define LIMIT_STALL_SECONDS 300u // a connection that takes no byte of what waits for it so long is closed
#define LIMIT_IMAGE_BYTES (256u * 1024u * 1024u) // encoded images that wait for one connection; one alone may exceed it
#define LIMIT_OWN_IMAGE_BYTES (4u * 1024u * 1024u) // of those, room that no other connection can take
#define LIMIT_COMMON_IMAGE_BYTES (1u << 30) // what does not fit there, of all connections; one alone may exceed it

// ---- strings, without the terminating zero ----
#define LIMIT_NAME 63u // of a scene, camera or client
#define LIMIT_PATH 1023u
#define LIMIT_OPTION_NAME 31u
#define LIMIT_OPTION_VALUE 31u
#define LIMIT_OPTIONS 16u
#define LIMIT_TEXT 255u // an error's sentence, a warning
#define LIMIT_WARNINGS 32u // in a SceneInfo, and in an Accepted
#define LIMIT_CAMERA_LIST 32u
#define LIMIT_NODE_LIST 64u // names of nodes in a SceneInfo
#define LIMIT_MATERIAL_LIST 64u // names of materials
#define LIMIT_ANIMATION_LIST 32u
#define LIMIT_SCENES 64u // fewer where descriptors are; as many again while jobs use them after an UNLOAD
#define LIMIT_STAGES 24u
#define LIMIT_FIGURES 48u // in a Done
#define LIMIT_EFFECTS 32u
#define LIMIT_NOTES 4u // in an Accepted

// ---- a render ----
#define LIMIT_SIDE 16384u // pixels, width and height
#define LIMIT_PIXELS (64u * 1024u * 1024u)
#define LIMIT_SAMPLES 16777216u // per pixel, first_sample + samples: 2^24
#define LIMIT_SAMPLES_TIMES_PIXELS (1ull << 44)
#define LIMIT_DEPTH 4096u // pt.depth
#define DEPTH_UNBOUNDED 65535u // an Accepted's `depth` where light scatters on until next to nothing is left
#define LIMIT_DIRECT_SAMPLES 64u // direct.samples
#define LIMIT_MAP_LIGHTS 16u // lights of a scene that have shadow maps, the strongest; the others' shadows are by rays
#define LIMIT_VCT_BOUNCES 8u // vct.bounces
#define LIMIT_VCT_CONES 32u // vct.cones
#define LIMIT_VCT_RAYS 256u // vct.rays
#define LIMIT_RADIANCE 1e12 // of a component of a background or an emission, W/(m² sr)
#define LIMIT_INTENSITY 1e20 // of a component of a light, W/sr; of a directional one, W/m²
#define LIMIT_COORDINATE 1e12 // of a camera's position, metres
#define LIMIT_EXPOSURE_EV 64.0 // either way
#define LIMIT_PROGRESS_MS 3600000u
#define LIMIT_DEADLINE_MS 86400000u // of a request: a day
#define LIMIT_EDIT_LIGHTS 32u // of one request
#define LIMIT_EDIT_MATERIALS 32u
#define LIMIT_EDIT_NODES 32u
#define LIMIT_EDIT_SCALE 1e9 // of a node, largest and one over smallest
#define LIMIT_ENVIRONMENT_SCALE 1e9 // of a picture of the surroundings, largest and one over smallest
#define LIMIT_TURN_DEGREES 1e6 // of its rotation, either way
#define LIMIT_TIME_S 1e9 // of an animation, either way
#define LIMIT_VARIANTS 4u // edited scenes that a worker keeps while no job uses them
#define LIMIT_SWEEP_CAMERAS 256u // of one Sweep; so many fit a message

// ---- quotes ----
#define LIMIT_QUOTES 64u // under way in the daemon, TECHNIQUE_AUTO's among them
#define LIMIT_PILOT_MS 60000u // of device time that a quote may ask for
#define LIMIT_QUOTE_RECORDS 4096u // of frames and pilots that are kept, the latest
#define LIMIT_QUOTE_DEVICES 4u // whose habits are kept

// ---- a scene ----
#define LIMIT_SCENE_FILE_BYTES (1ull << 30) // the file and each of its side files
#define LIMIT_SCENE_SOURCE_BYTES (2ull << 30) // all its files together
#define LIMIT_FOLDER_ENTRIES (8u * 1024u * 1024u) // read to find files whose names differ in case
#define LIMIT_BLOB_BYTES (4ull << 30)
#define LIMIT_SCENES_BYTES (16ull << 30) // the blobs of all scenes together
#define LIMIT_TRIANGLES (32u * 1024u * 1024u)
#define LIMIT_VERTICES (96u * 1024u * 1024u)
#define LIMIT_ZERO_ELEMENTS (1024u * 1024u) // of glTF accessors without a buffer view, all together
#define LIMIT_INSTANCES (1024u * 1024u) // of one node of a glTF file; those of all count as their triangles and vertices
#define LIMIT_MATERIALS 65535u
#define LIMIT_IOR_LEAST 0.1 // index of refraction of what lets light through
#define LIMIT_IOR_MOST 10.0
#define LIMIT_ABSORPTION 1e9 // of what is inside, 1/m
#define LIMIT_PRIORITY 255u // of a clear body among those that it overlaps
#define LIMIT_TEXTURES 4096u
#define LIMIT_TEXTURE_SIDE 16384u
#define LIMIT_TEXELS (256u * 1024u * 1024u) // all textures together; one of 16 bits a channel counts twice
#define LIMIT_ENVIRONMENT_TEXELS (32u * 1024u * 1024u) // of a picture of the surroundings; a side as a texture's
#define LIMIT_PUNCTUAL_LIGHTS 4096u
#define LIMIT_CAMERAS 1024u
#define LIMIT_NODES 1000000u
#define LIMIT_NODE_DEPTH 4096u
#define LIMIT_ANIMATIONS 1024u
#define LIMIT_CHANNELS 65536u // of all animations
#define LIMIT_CURVE_FLOATS (16u * 1024u * 1024u) // times and values of all channels
#define LIMIT_BVH_DEPTH 48u // levels; the shader's stack has as many entries
#define LIMIT_LOAD_SECONDS 120u // of processor time that one loader may take
#define LIMIT_LOAD_CLOCK_SECONDS 1200u // of the clock, whether or not it gets a processor
#define LIMIT_LOADER_BYTES (6ull << 30) // address space of one loader: parsing, building and the blob
#define LIMIT_LOADER_FILES 1024u // descriptors of one loader, and of its user on their way when it hands over
#define LIMIT_LOADERS 2u // at once, and one more that takes long; further loads wait
#define LIMIT_LOAD_TURN_SECONDS 5u // after which a load makes room for one that has not run yet
#define LIMIT_CHILDREN_LEFT 8u // loaders that were killed and have not ended yet; while there are more, loads wait

// ---- radiosity ----
#define LIMIT_RADIOSITY_RAYS 4000000u // of a row of form factors
#define LIMIT_RADIOSITY_BOUNCES 32u // of a ray by mirrors
#define LIMIT_RADIOSITY_POINTS 4096u // of a patch, from which lights are looked at
#define LIMIT_RADIOSITY_GATHER 4096u // rays of a sample of a pixel
#define LIMIT_RADIOSITY_ITERATIONS 4096u // of a solver
#define LIMIT_PATCH_FILE_BYTES (512u * 1024u * 1024u) // a file of patches or of their form factors
#define LIMIT_PATCH_ELEMENTS (2u * 1024u * 1024u) // of such a file that is loaded: faces, or rows
#define LIMIT_PATCH_ENTRIES (128u * 1024u * 1024u) // of a file of form factors that is loaded
#define LIMIT_PLY_HEADER_BYTES (64u * 1024u) // of a file of patches that is loaded
#define LIMIT_EXITANCE 1e30 // of a component of radiosity or irradiance in a file that is loaded, W/m²

// ---- the worker ----
#define LIMIT_SLICE_MS 1000u
#define LIMIT_HANG_SECONDS 30u // a child that owes an answer, and is still for so long, hangs
#define LIMIT_HANG_GPU_SECONDS 120u // the same of a worker on a GPU, which sleeps while the GPU works
#define LIMIT_ANSWER_SECONDS 300u // of work on one order (first compilation included) past which the worker hangs
#define LIMIT_LATE_MS 1000u // an order that is out for so long when a deadline comes is not waited for
#define LIMIT_PROBE_SECONDS 60u // of the clock, that pilots and measurements of effects may take
#define LIMIT_COMPILERS 3u // processes at once that compile shader code for jobs; further jobs wait for one
#define LIMIT_JOB_RETRIES 1u // times the job that a dying worker held is begun again
#define LIMIT_SCENE_LOSSES 2u // workers that crashed or hung over a scene, past which it is quarantined
#define LIMIT_DEVICE_LOSSES 3u // of a device within the seconds below, past which the next device is taken
#define LIMIT_DEVICE_LOSS_SECONDS 600u
#define LIMIT_IPC_QUEUE 4096u // messages that wait for a worker to take them; more: it hangs

// ---- a study on disk, as the program that reports on it reads it ----
#define LIMIT_STUDY_RUNS 65536u // lines of runs.jsonl
#define LIMIT_STUDY_LINE_BYTES (1u << 20) // one of them, and study.json
#define LIMIT_STUDY_BYTES (512u << 20) // runs.jsonl
#define LIMIT_STUDY_VIEWS 32u
#define LIMIT_STUDY_TEXT 4095u // of an id, a path, a command
#define LIMIT_STUDY_SETTINGS 24u // of one run
#define LIMIT_STUDY_PIXELS (8u * 1024u * 1024u) // of one image; 3840x2160 fits
#define LIMIT_REPORT_BYTES (3u << 20) // the page that a browser opens
#define LIMIT_REPORT_TABLE_BYTES (4u << 20) // the page of hard cases

#endif
