#include <string.h>

#include "protocol/names.h"
#include "server/scene/lights.h"
#include "server/worker/scenes/edit.h"
#include "server/worker/scenes/edit_names.h"

static void set_colour(bool has, const candil_Vec3 *from, float to[3])
{
	if (!has)
		return;
	to[0] = (float)from->x;
	to[1] = (float)from->y;
	to[2] = (float)from->z;
}

static void change(const struct blob_view *view, const candil_MaterialEdit *edit, struct material *m)
{
	set_colour(edit->has_base_color, &edit->base_color, m->albedo);
	set_colour(edit->has_specular, &edit->specular, m->specular);
#define SET_SHARE(field, ...) \
	if (edit->has_##field) \
		m->field = (float)edit->field;
	CANDIL_MATERIAL_SHARES(SET_SHARE)
	// An unlit surface shows its base colour and casts no light (KHR_materials_unlit).
	if (edit->has_emission && !(m->flags & MATERIAL_UNLIT)) {
		set_colour(true, &edit->emission, m->emission);
		m->power_density = lights_power_density(m, view->sections[BLOB_TEXTURES], view->sections[BLOB_TEXELS]);
	}
}

enum status edit_materials(struct edited *e, const candil_Edits *edits, bool *changed, struct error *err)
{
	const struct name_list names = names_of(&e->view, BLOB_MATERIAL_NAMES, "material");
	*changed = edits->materials_count > 0;
	if (!*changed)
		return STATUS_OK;
	struct material *materials = edit_own(e, BLOB_MATERIALS, 0);
	if (!materials)
		return error_set(err, STATUS_MEMORY, "no memory for %u materials", names.count);
	for (pb_size_t i = 0; i < edits->materials_count; i++) {
		const candil_MaterialEdit *edit = &edits->materials[i];
		bool found = false;
		for (uint32_t m = 0; m < names.count; m++) {
			if (!name_matches(&names, m, edit->name))
				continue;
			change(&e->view, edit, &materials[m]);
			found = true;
		}
		if (!found)
			return name_unknown(&names, edit->name, err);
	}
	return STATUS_OK;
}
