// write_blob LOADER SCENE OUT: the scene's blob as a file, a seed for fuzz_blob.
#include <stdio.h>

#include "tests/support/load_scene.h"

int main(int argc, char **argv)
{
	struct loaded_scene scene;
	struct error err;
	if (argc != 4)
		return 2;
	if (load_scene(argv[1], argv[2], &scene, &err) != STATUS_OK) {
		fprintf(stderr, "%s\n", err.text);
		return 1;
	}
	FILE *out = fopen(argv[3], "wb");
	size_t written = out ? fwrite(scene.blob, 1, scene.bytes, out) : 0;
	if (out)
		fclose(out);
	int bad = written != scene.bytes;
	loaded_scene_finish(&scene);
	return bad;
}
