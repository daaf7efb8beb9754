// The least that a program needs to get a picture: connect, load, render, write.
//
//   cc minimal.c $(pkg-config --cflags --libs candil) -o minimal
//   ./minimal SOCKET SCENE.gltf OUT.png
#include <candil.h>
#include <signal.h>
#include <stdio.h>

static volatile sig_atomic_t stopped; // by Ctrl-C or SIGTERM

static void stop(int number)
{
	(void)number;
	stopped = 1;
}

// Called some times a second while the daemon renders. Anything but 0 cancels.
static int look(void *user, const struct candil_progress *progress)
{
	(void)user;
	(void)progress;
	return stopped;
}

static int fail(const char *what, const struct candil_error *error)
{
	fprintf(stderr, "minimal: %s: %s (%s)\n", what, error->text, candil_status_name(error->code));
	return 1;
}

static int write_file(const char *path, const struct candil_image *image)
{
	FILE *file = fopen(path, "wb");
	size_t written = file ? fwrite(image->data, 1, image->bytes, file) : 0;
	if (!file || fclose(file) != 0 || written != image->bytes) {
		perror(path);
		return 1;
	}
	printf("%s: %ux%u, %zu bytes\n", path, (unsigned)image->width, (unsigned)image->height, image->bytes);
	return 0;
}

// Look at a scene without a camera from its front, from far enough away to have all of it in the picture.
static void look_at(const struct candil_scene_info *scene, struct candil_render_request *request)
{
	const struct candil_vec3 *low = &scene->bounds_min, *high = &scene->bounds_max;
	double width = high->x - low->x, height = high->y - low->y;
	request->target.x = low->x + width / 2;
	request->target.y = low->y + height / 2;
	request->target.z = high->z;
	request->eye = request->target;
	request->eye.z += 1.5 * (width > height ? width : height);
	request->up.y = 1;
	request->vfov_degrees = 40;
	request->has_camera = true;
}

static int render(candil_client *client, const struct candil_scene_info *scene, const char *out)
{
	struct candil_error error;
	struct candil_render_result result;
	struct candil_render_request request;
	const struct candil_callbacks callbacks = {.progress = look};
	candil_render_request_init(&request);
	request.scene = "minimal";
	request.width = request.height = 128;
	request.samples = 16;
	request.format = CANDIL_FORMAT_PNG;
	request.has_background = true;
	request.background = (struct candil_vec3){0.5, 0.5, 0.5};
	if (scene->camera_count == 0)
		look_at(scene, &request);
	if (candil_render(client, &request, &callbacks, &result, &error) != CANDIL_STATUS_OK)
		return fail("render", &error);
	int failed = write_file(out, &result.image);
	candil_free(result.image.data);
	return failed;
}

int main(int argc, char **argv)
{
	struct candil_error error;
	struct candil_scene_info scene;
	candil_client *client;
	if (argc != 4) {
		fprintf(stderr, "usage: minimal SOCKET SCENE OUT.png\n");
		return 2;
	}
	if (candil_connect(argv[1], &client, &error) != CANDIL_STATUS_OK)
		return fail("connect", &error);
	int failed = 1;
	// A program that ended now would leave its scene in the daemon.
	signal(SIGINT, stop);
	signal(SIGTERM, stop);
	if (candil_ping(client, NULL, &error) != CANDIL_STATUS_OK ||
	    candil_load_file(client, "minimal", argv[2], &scene, &error) != CANDIL_STATUS_OK) {
		fail("load", &error);
	} else {
		failed = render(client, &scene, argv[3]);
		candil_unload(client, "minimal", NULL);
	}
	candil_disconnect(client);
	return failed;
}
