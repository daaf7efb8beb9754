#include "server/loader/obj.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/text.h"
#include "server/loader/mtl_surface.h"
#include "server/loader/obj_files.h"
#include "server/loader/obj_vertices.h"

// assimp leaks memory if it rejects a file. This process ends soon after, so the leak checker ignores it.
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#define WITHOUT_LEAK_CHECK(statement) (__lsan_disable(), (statement), __lsan_enable())
#else
#define WITHOUT_LEAK_CHECK(statement) (statement)
#endif

#define DEFAULT_ALBEDO 0.8f // of a surface whose material does not give one

static enum status check_text(const struct file_bytes *bytes, struct error *err)
{
	const uint8_t *b = bytes->data;
	if (bytes->size >= 2 && ((b[0] == 0xFE && b[1] == 0xFF) || (b[0] == 0xFF && b[1] == 0xFE)))
		return error_set(err, STATUS_SCENE_INVALID, "the OBJ file is UTF-16 text; save it as UTF-8");
	if (memchr(b, 0, bytes->size))
		return error_set(err, STATUS_SCENE_INVALID, "the OBJ file holds zero bytes, so it is no OBJ text");
	for (size_t i = 0; i < bytes->size; i++)
		if (!isspace(b[i]))
			return STATUS_OK;
	return error_set(err, STATUS_SCENE_INVALID, "the OBJ file is empty");
}

// assimp 5.2 skips a vertex that has a number like ".5" without a leading zero, and every later index then names another
// vertex. This makes a text with the zeros added. out->data is NULL if nothing needs to be changed.
static enum status mend_numbers(const struct file_bytes *in, struct file_bytes *out, struct error *err)
{
	size_t bare = 0;
	*out = (struct file_bytes){0};
	for (size_t i = 1; i + 1 < in->size; i++)
		bare += in->data[i] == '.' && isblank(in->data[i - 1]) && isdigit(in->data[i + 1]);
	if (bare == 0)
		return STATUS_OK;
	out->data = malloc(in->size + bare + 1);
	if (!out->data)
		return error_set(err, STATUS_MEMORY, "no memory for the text of the OBJ file");
	for (size_t i = 0; i < in->size; i++) {
		if (in->data[i] == '.' && i > 0 && isblank(in->data[i - 1]) && i + 1 < in->size && isdigit(in->data[i + 1]))
			out->data[out->size++] = '0';
		out->data[out->size++] = in->data[i];
	}
	out->data[out->size] = 0;
	return STATUS_OK;
}

static bool colour_of(const struct aiMaterial *m, const char *key, float out[3], double limit)
{
	struct aiColor4D c = {0, 0, 0, 1};
	bool fit = true;
	aiGetMaterialColor(m, key, 0, 0, &c);
	fit &= import_fit(&out[0], c.r, limit);
	fit &= import_fit(&out[1], c.g, limit);
	fit &= import_fit(&out[2], c.b, limit);
	return fit;
}

// A material's map of one type. *key becomes its file name, or empty if there is none. `flags` is TEXTURE_SRGB or 0.
static enum status map_of(struct import *im, const struct aiMaterial *m, enum aiTextureType type, uint32_t flags,
			  struct aiString *key, uint32_t *texture, struct error *err)
{
	enum aiTextureMapMode mode[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
	struct file_bytes file = {0};
	struct error why;

	*texture = NONE;
	*key = (struct aiString){0};
	if (aiGetMaterialTexture(m, type, 0, key, NULL, NULL, NULL, NULL, mode, NULL) != aiReturn_SUCCESS ||
	    key->length == 0)
		return STATUS_OK;
	for (char *c = key->data; *c; c++)
		if (*c == '\\')
			*c = '/';
	if (!import_knows_image(im, key->data) && files_read(im->files, key->data, &file, &why) != STATUS_OK &&
	    import_missing_image(im, key->data, why.text, err) != STATUS_OK)
		return err->code;
	const uint32_t wrap = mode[0] == aiTextureMapMode_Clamp ? WRAP_CLAMP : WRAP_REPEAT;
	const struct import_sampling sampling =
	    import_plain_sampling(flags | wrap << TEXTURE_WRAP_S_SHIFT | wrap << TEXTURE_WRAP_T_SHIFT);
	enum status status = import_texture(im, key->data, file.data, file.size, true, &sampling, texture, err);
	file_bytes_finish(&file);
	return status;
}

// Turn a bump map into a normal map, unless it already is one.
static enum status normals_of_bumps(struct import *im, const char *name, uint32_t *texture, struct error *err)
{
	const struct texture_info bumps = im->textures[*texture];
	const struct import_sampling sampling = import_plain_sampling(bumps.flags);
	uint32_t *normals = NULL;

	if (mtl_is_normal_map(im->texels + bumps.offset, bumps.width, bumps.height))
		return STATUS_OK;
	if (!import_knows_derived(im, name) &&
	    mtl_normals_of_heights(im->texels + bumps.offset, bumps.width, bumps.height, &normals, err) != STATUS_OK)
		return err->code;
	enum status status = import_derived_texture(im, name, normals, bumps.width, bumps.height, &sampling, texture, err);
	free(normals);
	return status;
}

static enum status find_normals(struct import *im, const struct aiMaterial *m, const struct mtl_note *note,
				struct material *out, struct error *err)
{
	struct aiString key;
	if (note && isfinite((float)note->bump))
		out->normal_scale = (float)note->bump;
	if (map_of(im, m, aiTextureType_NORMALS, 0, &key, &out->normal_texture, err) != STATUS_OK)
		return err->code;
	if (out->normal_texture != NONE)
		return STATUS_OK;
	if (map_of(im, m, aiTextureType_HEIGHT, 0, &key, &out->normal_texture, err) != STATUS_OK)
		return err->code;
	return out->normal_texture == NONE ? STATUS_OK : normals_of_bumps(im, key.data, &out->normal_texture, err);
}

static enum status find_maps(struct import *im, const struct aiMaterial *m, const struct mtl_note *note,
			     struct material *out, struct error *err)
{
	struct aiString key;
	if (map_of(im, m, aiTextureType_DIFFUSE, TEXTURE_SRGB, &key, &out->albedo_texture, err) != STATUS_OK ||
	    map_of(im, m, aiTextureType_EMISSIVE, TEXTURE_SRGB, &key, &out->emission_texture, err) != STATUS_OK)
		return err->code;
	// A lobe without weight needs no texture.
	if (out->specular_weight > 0 &&
	    map_of(im, m, aiTextureType_SPECULAR, TEXTURE_SRGB, &key, &out->specular_texture, err) != STATUS_OK)
		return err->code;
	return find_normals(im, m, note, out, err);
}

static enum status add_material(struct obj_files *files, const struct aiMaterial *m, struct error *err)
{
	struct import *im = files->import;
	struct material out = import_plain_material(1.0f);
	struct aiString name = {0};
	aiGetMaterialString(m, AI_MATKEY_NAME, &name);
	const struct mtl_note *note = mtl_notes_find(&files->notes, name.data);

	bool fit = colour_of(m, "$clr.diffuse", out.albedo, 1.0);
	fit &= colour_of(m, "$clr.emissive", out.emission, LIMIT_RADIANCE);
	if (note)
		fit &= mtl_set_surface(im, note, &out);
	if (find_maps(im, m, note, &out, err) != STATUS_OK)
		return err->code;
	if ((!note || !note->has_diffuse) && out.transmission == 0)
		for (int c = 0; c < 3; c++)
			out.albedo[c] = out.albedo_texture == NONE ? DEFAULT_ALBEDO : 1.0f;
	if (!fit)
		import_warn(im, "material '%.60s' has a colour out of range, which was clamped", name.data);
	return import_add_material(im, &out, name.data, err);
}

// Warn of materials that faces use but no MTL defines: assimp invents them silently.
static void warn_undefined(struct obj_files *files, const struct aiScene *scene)
{
	for (unsigned i = 0; i < scene->mNumMaterials; i++) {
		struct aiString name = {0};
		bool used = false;
		aiGetMaterialString(scene->mMaterials[i], AI_MATKEY_NAME, &name);
		for (unsigned k = 0; k < scene->mNumMeshes && !used; k++)
			used = scene->mMeshes[k]->mMaterialIndex == i;
		if (used && strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0)
			import_warn(files->import, "surfaces without a material are taken as grey");
		else if (used && !mtl_notes_find(&files->notes, name.data))
			import_warn(files->import, "material '%.60s' is not defined by an MTL file and is taken as grey",
				    name.data);
	}
}

static void note_bounds(struct import *im, const struct aiMesh *mesh)
{
	double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (unsigned i = 0; i < mesh->mNumVertices; i++) {
		const double p[3] = {mesh->mVertices[i].x, mesh->mVertices[i].y, mesh->mVertices[i].z};
		for (int c = 0; c < 3 && isfinite(p[0] + p[1] + p[2]); c++) {
			min[c] = fmin(min[c], p[c]);
			max[c] = fmax(max[c], p[c]);
		}
	}
	import_note_source(im, min, max);
}

static enum status add_faces(struct import *im, const struct aiMesh *mesh, const uint32_t *number, struct error *err)
{
	for (unsigned i = 0; i < mesh->mNumFaces; i++) {
		const struct aiFace *face = &mesh->mFaces[i];
		if (face->mNumIndices != 3) {
			import_ignore(im, face->mNumIndices == 1 ? "points" : "lines");
			continue;
		}
		struct triangle t = {.material = mesh->mMaterialIndex};
		bool inside = true;
		for (int k = 0; k < 3; k++) {
			inside = inside && face->mIndices[k] < mesh->mNumVertices;
			t.vertex[k] = inside ? number[face->mIndices[k]] : 0;
		}
		if (!inside)
			im->info->dropped_out_of_range++;
		else if (import_add_triangle(im, &t, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

static enum status add_mesh(struct import *im, const struct aiMesh *mesh, struct error *err)
{
	uint32_t *number;
	note_bounds(im, mesh);
	enum status status = obj_add_vertices(im, mesh, &number, err);
	if (status == STATUS_OK)
		status = add_faces(im, mesh, number, err);
	free(number);
	return status;
}

static enum status add_group(struct import *im, const struct aiScene *scene, const struct aiNode *group, struct error *err)
{
	if (import_add_node(im, group->mName.data, &transform_identity, &transform_no_parts, NONE, err) != STATUS_OK)
		return err->code;
	for (unsigned i = 0; i < group->mNumMeshes; i++) {
		const struct aiMesh *mesh = scene->mMeshes[group->mMeshes[i]];
		if (mesh->mMaterialIndex >= scene->mNumMaterials)
			return error_set(err, STATUS_SCENE_INVALID, "the OBJ file uses a material that is not there");
		if (add_mesh(im, mesh, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

// assimp's OBJ importer makes a node of each `o` or `g`, without transforms, all beneath one root. It puts each mesh into
// one of them.
static enum status add_groups(struct import *im, const struct aiScene *scene, struct error *err)
{
	const struct aiNode *root = scene->mRootNode;
	if (root->mNumMeshes > 0 && add_group(im, scene, root, err) != STATUS_OK)
		return err->code;
	for (unsigned i = 0; i < root->mNumChildren; i++)
		if (root->mChildren[i]->mNumMeshes > 0 && add_group(im, scene, root->mChildren[i], err) != STATUS_OK)
			return err->code;
	return STATUS_OK;
}

static enum status add_scene(struct obj_files *files, const struct aiScene *scene, struct error *err)
{
	for (unsigned i = 0; i < scene->mNumMaterials; i++)
		if (add_material(files, scene->mMaterials[i], err) != STATUS_OK)
			return err->code;
	warn_undefined(files, scene);
	return add_groups(files->import, scene, err);
}

enum status obj_import(struct import *im, const char *name, const struct file_bytes *bytes, struct error *err)
{
	struct obj_files files;
	struct file_bytes mended;
	if (check_text(bytes, err) != STATUS_OK || mend_numbers(bytes, &mended, err) != STATUS_OK)
		return err->code;
	obj_files_init(&files, im, name, mended.data ? &mended : bytes);
	const struct aiScene *scene;
	WITHOUT_LEAK_CHECK(scene = aiImportFileEx(name, aiProcess_Triangulate, &files.io));
	enum status status = STATUS_OK;
	if (files.failure.code != STATUS_OK) {
		*err = files.failure;
		status = err->code;
	} else if (!scene) {
		char why[128];
		text_copy(why, sizeof why, aiGetErrorString());
		size_t length = strlen(why);
		if (length > 0 && why[length - 1] == '.')
			why[length - 1] = '\0';
		status =
		    error_set(err, STATUS_SCENE_INVALID, "the OBJ file is invalid, line unknown: %s; export it again", why);
	} else {
		status = add_scene(&files, scene, err);
	}
	aiReleaseImport(scene);
	obj_files_finish(&files);
	file_bytes_finish(&mended);
	return status;
}
