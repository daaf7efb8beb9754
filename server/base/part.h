// What a request names of what was loaded, each under a name of its own: the scene, and what goes with it.
#ifndef CANDIL_BASE_PART_H
#define CANDIL_BASE_PART_H

enum part {
	PART_SCENE, // what is rendered; there is always one
	PART_ENVIRONMENT, // the picture of the surroundings
	PART_IMPORTED, // the file that is taken in place of what would be made of the scene
	PARTS
};

#endif
