#include "server/loader/obj_vertices.h"

#include <stdlib.h>
#include <string.h>

#include "server/loader/key_table.h"

#define KEY_WORDS (sizeof(struct import_vertex) / sizeof(uint32_t))
_Static_assert(sizeof(struct import_vertex) == 3 * sizeof(double) + 5 * sizeof(float) + sizeof(float),
	       "a vertex is its members and one word that aligns it, which is zero in each");

static void place(const struct import *im, const struct aiVector3D *v, double scale, double out[3])
{
	out[0] = v->x * scale;
	out[1] = (im->z_up ? v->z : v->y) * scale;
	out[2] = (im->z_up ? -(double)v->y : v->z) * scale;
}

static void read_vertex(const struct import *im, const struct aiMesh *mesh, unsigned i, struct import_vertex *v)
{
	double normal[3];
	memset(v, 0, sizeof *v); // the padding between vertices too, because it is compared
	place(im, &mesh->mVertices[i], im->unit, v->position);
	if (mesh->mNormals) {
		place(im, &mesh->mNormals[i], 1.0, normal);
		for (int c = 0; c < 3; c++)
			v->normal[c] = (float)normal[c];
	}
	if (mesh->mTextureCoords[0]) {
		v->uv[0] = mesh->mTextureCoords[0][i].x;
		v->uv[1] = 1.0f - mesh->mTextureCoords[0][i].y; // our row 0 is at the top
	}
}

static enum status add_distinct(struct import *im, const struct aiMesh *mesh, struct key_table *seen, uint32_t *number,
				struct error *err)
{
	const size_t first = im->vertex_count;
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		struct import_vertex v;
		uint32_t key[KEY_WORDS], at;
		const uint32_t before = seen->count;
		read_vertex(im, mesh, i, &v);
		memcpy(key, &v, sizeof key);
		if (key_table_number(seen, key, &at, err) != STATUS_OK)
			return err->code;
		if (at == before && import_add_vertex(im, &v, err) != STATUS_OK)
			return err->code;
		number[i] = (uint32_t)first + at;
	}
	return STATUS_OK;
}

enum status obj_add_vertices(struct import *im, const struct aiMesh *mesh, uint32_t **number, struct error *err)
{
	struct key_table seen;
	*number = NULL;
	if (mesh->mNumVertices == 0)
		return STATUS_OK;
	uint32_t *of = calloc(mesh->mNumVertices, sizeof *of);
	if (!of)
		return error_set(err, STATUS_MEMORY, "no memory for a mesh of %u vertices", mesh->mNumVertices);
	key_table_init(&seen, KEY_WORDS);
	enum status status = add_distinct(im, mesh, &seen, of, err);
	key_table_finish(&seen);
	if (status != STATUS_OK) {
		free(of);
		return status;
	}
	*number = of;
	return STATUS_OK;
}
