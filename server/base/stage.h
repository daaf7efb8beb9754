// What the stages of an account grow with: protocol/PROTOCOL.md lists their names. Any thread.
#ifndef CANDIL_BASE_STAGE_H
#define CANDIL_BASE_STAGE_H

// Of STAGE_COLD, µs: from here on a picture's other times are not believed.
#define STAGE_COLD_US 20000.0

enum stage_kind {
	STAGE_QUEUE, // with what others do
	STAGE_COLD, // with nothing: it comes once a device, or a program
	STAGE_SETUP, // with the scene: it comes once, and what it made is kept
	STAGE_PIXEL, // with pixels
	STAGE_SAMPLE, // with pixels times samples
	STAGE_FIXED, // with nothing: it comes with every frame
	STAGE_ENCODE, // with the file
};

// The kind of a stage; STAGE_SAMPLE for a name that is not listed.
enum stage_kind stage_kind(const char *name);

#endif
