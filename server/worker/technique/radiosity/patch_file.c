#include "server/worker/technique/radiosity/patch_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/memfd.h"
#include "server/scene/patch_format.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/display_views.h"

#define FACES_AT_ONCE 16u // between two looks at the clock
#define BUFFER_BYTES (1u << 20)
#define ENTRY_BYTES_LEAST 6u // "1 1 1" and the end of the line
#define ENTRY_BYTES_USUAL 22u
#define ENTRY_BYTES_MOST 40u // two numbers of ten digits, a float of nine, and what is between

_Static_assert(2 * PATCHES_MOST <= LIMIT_PATCH_ELEMENTS, "what is written can be read back");

struct patch_file {
	bool broken; // a part could not be written
	const struct solution *solution;
	const struct resident_scene *scene;
	candil_Format format;
	int fd; // -1: handed over
	bool sealed;
	uint64_t most; // bytes that it may have
	uint64_t bytes; // of the file so far, what is in `buffer` among them
	char *buffer;
	size_t used;
	uint32_t next, end; // of a PLY patches, then elements; of a matrix elements
	bool faces; // of a PLY: patches are done
	uint64_t entries, written; // of a matrix
	float *radiosity, *exitance; // of a PLY, by element, 3 each
	uint64_t corner; // of a PLY: the vertex that the next face begins with
	struct factors_window window; // of a matrix
};

static const struct elements *elements_of(const struct patch_file *f)
{
	return &f->solution->factors->elements;
}

// ---- bytes --------------------------------------------------------------------------------------------------------------

static enum status flush(struct patch_file *f, struct error *err)
{
	// What a failure has left in the file is not known: it cannot be gone on with.
	if (f->broken)
		return error_set(err, STATUS_INTERNAL, "the file could not be written");
	const enum status s = memfd_append(f->fd, f->buffer, f->used, err);
	f->broken = s != STATUS_OK;
	f->used = 0;
	return s;
}

// Room for so many bytes, which are at most BUFFER_BYTES; `put` says how many were used. NULL: it failed.
static char *room(struct patch_file *f, size_t bytes, struct error *err)
{
	if (BUFFER_BYTES - f->used < bytes && flush(f, err) != STATUS_OK)
		return NULL;
	return f->buffer + f->used;
}

static void put(struct patch_file *f, size_t bytes)
{
	f->used += bytes;
	f->bytes += bytes;
}

static enum status refuse(const struct patch_file *f, double bytes, struct error *err)
{
	return error_set(err, STATUS_LIMIT,
			 "the file would have some %.4g MiB, and may have %.4g: ask for fewer patches, by radiosity.patches "
			 "or radiosity.edge, or for fewer rays, by radiosity.rays",
			 bytes / (1u << 20), (double)f->most / (1u << 20));
}

// ---- a PLY --------------------------------------------------------------------------------------------------------------

#define PROPERTY_LINE(type, name, member) "property " #type " " name "\n"

static enum status put_ply_header(struct patch_file *f, struct error *err)
{
	const struct elements *e = elements_of(f);
	const struct blob_header *blob = f->scene->view.blob;
	uint64_t corners = 0;
	for (uint32_t i = 0; i < e->patches.count; i++)
		corners += elements_corner_count(e, i);
	const uint64_t bytes = corners * 3 * sizeof(double) + (uint64_t)e->count * PATCH_FACE_BYTES_MOST;
	if (bytes > f->most)
		return refuse(f, (double)bytes, err);
	char *at = room(f, BUFFER_BYTES, err);
	if (!at)
		return err->code;
	put(f,
	    (size_t)snprintf(
		at, BUFFER_BYTES,
		"ply\nformat binary_little_endian 1.0\n"
		"comment candil: patches of scene %016llx%016llx, metres, world space\n"
		"comment face i is element i: the fronts of all patches, then their backs\n"
		"comment b: radiosity, m: emitted exitance, d: irradiance straight from sources, h: all irradiance, W/m2\n"
		"comment b = m + rho (d + F (b - straight m)), with rho the diffuse reflectance\n"
		"comment escaped, cut: shares of its light that meet nothing, that a limit cut off\n"
		"element vertex %llu\n" PATCH_AXES(PROPERTY_LINE) "element face %u\nproperty list " PATCH_LIST
								  "\n" PATCH_PROPERTIES(PROPERTY_LINE) "end_header\n",
		(unsigned long long)blob->hash[1], (unsigned long long)blob->hash[0], (unsigned long long)corners,
		e->count));
	return STATUS_OK;
}

static enum status begin_ply(struct patch_file *f, struct error *err)
{
	const struct solution *v = f->solution;
	const struct display_source source = {
	    .elements = elements_of(f), .surfaces = v->made_of, .irradiance = v->irradiance};
	f->radiosity = malloc((3 * (size_t)source.elements->count + 1) * sizeof *f->radiosity);
	f->exitance = malloc((3 * (size_t)source.elements->count + 1) * sizeof *f->exitance);
	if (!f->radiosity || !f->exitance)
		return error_set(err, STATUS_MEMORY, "out of memory");
	display_view_fill(DISPLAY_VIEW_B, &source, f->radiosity);
	display_view_fill(DISPLAY_VIEW_E, &source, f->exitance);
	f->end = source.elements->patches.count;
	return put_ply_header(f, err);
}

static enum status put_corners(struct patch_file *f, uint32_t patch, struct error *err)
{
	double world[4][3];
	const uint32_t count = elements_corners(elements_of(f), patch, f->scene->view.blob->origin, world);
	char *at = room(f, sizeof world, err);
	if (!at)
		return err->code;
	memcpy(at, world, count * sizeof *world);
	put(f, count * sizeof *world);
	return STATUS_OK;
}

// The element, but for its corners' places, which its vertices tell.
static struct imported_element element_of(const struct patch_file *f, uint32_t element)
{
	const struct elements *e = elements_of(f);
	const struct solution *v = f->solution;
	const struct factors_row *row = &solution_matrix(v)->rows[element];
	const size_t three = 3 * (size_t)element;
	const bool reached = v->reached[element];
	const uint32_t patch = element % e->patches.count;
	struct patch shape;
	patches_get(&e->patches, patch, &shape);
	struct imported_element out = {.patch = patch,
				       .material = shape.material,
				       .area = e->shapes[patch].area,
				       .escaped = reached ? row->escaped : 0,
				       .cut = reached ? row->cut : 0,
				       .corners = (uint8_t)elements_corner_count(e, patch),
				       .side = element != patch,
				       .straight = v->lamps,
				       .reached = reached};
	memcpy(out.b, &f->radiosity[three], sizeof out.b);
	memcpy(out.m, &f->exitance[three], sizeof out.m);
	memcpy(out.d, &v->direct[three], sizeof out.d);
	memcpy(out.rho, v->made_of[element].albedo, sizeof out.rho);
	memcpy(out.h, &v->irradiance[three], sizeof out.h);
	return out;
}

static enum status put_face(struct patch_file *f, uint32_t element, struct error *err)
{
	const struct imported_element face = element_of(f, element);
	uint32_t vertex[4];
	char *at = room(f, PATCH_FACE_BYTES_MOST, err);
	if (!at)
		return err->code;
	// Both sides have the same corners.
	if (element == elements_of(f)->patches.count)
		f->corner = 0;
	for (uint32_t k = 0; k < face.corners; k++)
		vertex[k] = (uint32_t)f->corner + (face.side ? face.corners - 1 - k : k);
	f->corner += face.corners;
	put(f, patch_face_write(&face, vertex, at));
	return STATUS_OK;
}

static enum status put_ply_item(struct patch_file *f, struct error *err)
{
	const enum status s = f->faces ? put_face(f, f->next, err) : put_corners(f, f->next, err);
	if (s == STATUS_OK && ++f->next == f->end && !f->faces) {
		f->faces = true;
		f->next = 0;
		f->end = elements_of(f)->count;
	}
	return s;
}

// ---- a matrix -----------------------------------------------------------------------------------------------------------

static enum status begin_matrix(struct patch_file *f, struct error *err)
{
	const struct factors *m = solution_matrix(f->solution);
	const struct blob_header *blob = f->scene->view.blob;
	f->end = elements_of(f)->count;
	for (uint32_t i = 0; i < f->end; i++)
		f->entries += f->solution->reached[i] ? m->rows[i].count : 0;
	if (f->entries > f->most / ENTRY_BYTES_LEAST)
		return refuse(f, (double)f->entries * ENTRY_BYTES_USUAL, err);
	char *at = room(f, BUFFER_BYTES, err);
	if (!at)
		return err->code;
	put(f, (size_t)snprintf(at, BUFFER_BYTES,
				"%%%%MatrixMarket matrix coordinate real general\n"
				"%% candil: form factors of scene %016llx%016llx\n"
				"%% row i, column j: share of the light of element i - 1 that arrives at element j - 1;\n"
				"%% elements are the faces of the PLY, in its order\n"
				"%% rows by rays are samples: single entries are noisy, sums of many are not\n"
				"%u %u %llu\n",
				(unsigned long long)blob->hash[1], (unsigned long long)blob->hash[0], f->end, f->end,
				(unsigned long long)f->entries));
	return STATUS_OK;
}

static enum status put_row(struct patch_file *f, uint32_t element, struct error *err)
{
	if (!f->solution->reached[element])
		return STATUS_OK;
	struct row_view row;
	const enum status s = factors_window_row(&f->window, solution_matrix(f->solution), element, &row, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t k = 0; k < row.count; k++) {
		char *at = room(f, ENTRY_BYTES_MOST, err);
		if (!at)
			return err->code;
		put(f, (size_t)snprintf(at, ENTRY_BYTES_MOST, "%u %u %.9g\n", element + 1, row.columns[k] + 1,
					(double)row.values[k]));
	}
	f->written += row.count;
	return f->bytes <= f->most ? STATUS_OK
				   : refuse(f, (double)f->bytes * ((double)f->entries / (double)f->written), err);
}

static enum status put_matrix_item(struct patch_file *f, struct error *err)
{
	const enum status s = put_row(f, f->next, err);
	f->next += s == STATUS_OK;
	return s;
}

// ---- both ---------------------------------------------------------------------------------------------------------------

enum status patch_file_create(const struct solution *solution, const struct resident_scene *scene, candil_Format format,
			      uint64_t most, struct patch_file **file, struct error *err)
{
	struct patch_file *f = calloc(1, sizeof *f);
	if (!f)
		return error_set(err, STATUS_MEMORY, "out of memory");
	f->solution = solution;
	f->scene = scene;
	f->format = format;
	f->most = most;
	f->buffer = malloc(BUFFER_BYTES);
	enum status s = memfd_create_empty("a file of patches", &f->fd, err);
	if (s == STATUS_OK && !f->buffer)
		s = error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = format == candil_Format_FORMAT_PLY ? begin_ply(f, err) : begin_matrix(f, err);
	if (s == STATUS_OK)
		*file = f;
	else
		patch_file_destroy(f);
	return s;
}

void patch_file_destroy(struct patch_file *f)
{
	if (!f)
		return;
	if (f->fd >= 0)
		close(f->fd);
	factors_window_finish(&f->window);
	free(f->radiosity);
	free(f->exitance);
	free(f->buffer);
	free(f);
}

enum status patch_file_step(struct patch_file *f, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	const bool ply = f->format == candil_Format_FORMAT_PLY;
	enum status s = STATUS_OK;
	do
		for (uint32_t i = 0; s == STATUS_OK && i < (ply ? FACES_AT_ONCE : 1) && f->next < f->end; i++)
			s = ply ? put_ply_item(f, err) : put_matrix_item(f, err);
	while (s == STATUS_OK && f->next < f->end && clock_us() - start < budget_us);
	if (s != STATUS_OK || f->next < f->end || f->sealed)
		return s;
	factors_window_finish(&f->window);
	s = flush(f, err);
	if (s == STATUS_OK)
		s = memfd_seal(f->fd, NULL, 0, err);
	f->sealed = s == STATUS_OK;
	return s;
}

bool patch_file_finished(const struct patch_file *f)
{
	return f->sealed;
}

double patch_file_fraction(const struct patch_file *f)
{
	const double within = f->end > 0 ? (double)f->next / f->end : 1;
	if (f->sealed || f->format != candil_Format_FORMAT_PLY)
		return within;
	return 0.5 * (within + f->faces);
}

enum status patch_file_take(struct patch_file *f, int *fd, uint64_t *bytes, struct error *err)
{
	if (!f->sealed || f->fd < 0)
		return error_set(err, STATUS_INTERNAL, "there is no file to read");
	*fd = f->fd;
	*bytes = f->bytes;
	f->fd = -1;
	return STATUS_OK;
}
