#include "server/front/request_edits.h"

#include <math.h>

#include "protocol/limits.h"
#include "protocol/names.h"
#include "protocol/text.h"

static bool edits_within(const candil_Vec3 *v, double least, double most)
{
	return v->x >= least && v->x <= most && v->y >= least && v->y <= most && v->z >= least && v->z <= most;
}

static bool has_length(double x, double y, double z, double w)
{
	const double square = x * x + y * y + z * z + w * w;
	return square > 1e-30 && square < 1e30; // false for NaN too
}

static enum status check_spot(const candil_Light *l, struct error *err)
{
	if (l->inner_degrees >= 0 && l->outer_degrees > l->inner_degrees && l->outer_degrees <= 90)
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "a spot's inner angle is from 0 to below its outer one, and that at most 90 degrees");
}

static enum status check_light(const candil_Light *l, struct error *err)
{
	const unsigned traits = light_kind_traits((unsigned)l->kind);
	char kinds[128];
	if ((unsigned)l->kind >= LIGHT_KIND_COUNT)
		return error_set(err, STATUS_BAD_ARGUMENT, "a light's kind %u is none of candil.proto", (unsigned)l->kind);
	if (!l->has_intensity || !edits_within(&l->intensity, 0, LIMIT_INTENSITY))
		return error_set(err, STATUS_BAD_ARGUMENT, "a light needs an intensity of components between 0 and %g",
				 LIMIT_INTENSITY);
	if (traits & LIGHT_HAS_PLACE &&
	    (!l->has_position || !edits_within(&l->position, -LIMIT_COORDINATE, LIMIT_COORDINATE))) {
		light_kind_list(LIGHT_HAS_PLACE, "or", kinds, sizeof kinds);
		return error_set(err, STATUS_BAD_ARGUMENT, "%s needs a position of finite coordinates, at most %g", kinds,
				 LIMIT_COORDINATE);
	}
	if (traits & LIGHT_HAS_DIRECTION &&
	    (!l->has_direction || !has_length(l->direction.x, l->direction.y, l->direction.z, 0))) {
		light_kind_list(LIGHT_HAS_DIRECTION, "or", kinds, sizeof kinds);
		return error_set(err, STATUS_BAD_ARGUMENT, "%s needs a direction that is finite and not zero", kinds);
	}
	if (!(l->range >= 0 && isfinite(l->range)) || (l->range > 0 && !(traits & LIGHT_HAS_PLACE))) {
		light_kind_list(LIGHT_HAS_PLACE, "or", kinds, sizeof kinds);
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "a range is finite metres above zero, or 0 for no bound, and only of %s", kinds);
	}
	if (traits & LIGHT_HAS_DISC && !(l->angle_degrees >= 0 && l->angle_degrees < 180))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "a directional light's angle is from 0 to below 180 degrees, across its disc");
	return traits & LIGHT_HAS_CONE ? check_spot(l, err) : STATUS_OK;
}

// A name as the scene has it, or '#' and a number. Whether the scene has it is for the worker to find out.
static enum status edits_check_name(const char *name, const char *what, struct error *err)
{
	if (name[0] && text_is_clean(name))
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "%s is named by 1 to %u bytes of UTF-8 without control characters, or by '#' and its number", what,
			 LIMIT_NAME);
}

static bool is_share(bool has, double value)
{
	return !has || (value >= 0 && value <= 1);
}

static enum status check_material(const candil_MaterialEdit *m, struct error *err)
{
	if (edits_check_name(m->name, "a material", err) != STATUS_OK)
		return err->code;
	bool within = (!m->has_base_color || edits_within(&m->base_color, 0, 1)) &&
		      (!m->has_specular || edits_within(&m->specular, 0, 1));
#define CHECK_SHARE(field, ...) within = within && is_share(m->has_##field, m->field);
	CANDIL_MATERIAL_SHARES(CHECK_SHARE)
	if (!within) {
#define SHARE_FIELD(field, ...) #field,
		static const char *const fields[] = {"base_color", "specular", CANDIL_MATERIAL_SHARES(SHARE_FIELD)};
		char list[256];
		names_list(fields, sizeof fields / sizeof *fields, "and", list, sizeof list);
		return error_set(err, STATUS_BAD_ARGUMENT, "material '%s': %s are between 0 and 1", m->name, list);
	}
	if (m->has_emission && !edits_within(&m->emission, 0, LIMIT_RADIANCE))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "material '%s': an emission's components are between 0 and %g W/(m² sr)", m->name,
				 LIMIT_RADIANCE);
	return STATUS_OK;
}

static bool is_scale(double s)
{
	return fabs(s) >= 1 / LIMIT_EDIT_SCALE && fabs(s) <= LIMIT_EDIT_SCALE;
}

static enum status check_node(const candil_NodeEdit *n, struct error *err)
{
	if (edits_check_name(n->name, "a node", err) != STATUS_OK)
		return err->code;
	if (n->has_translation && !edits_within(&n->translation, -LIMIT_COORDINATE, LIMIT_COORDINATE))
		return error_set(err, STATUS_BAD_ARGUMENT, "node '%s': a translation is finite and at most %g m", n->name,
				 LIMIT_COORDINATE);
	if (n->has_rotation && !has_length(n->rotation.x, n->rotation.y, n->rotation.z, n->rotation.w))
		return error_set(err, STATUS_BAD_ARGUMENT, "node '%s': a rotation is a finite quaternion that is not zero",
				 n->name);
	if (n->has_scale && (!is_scale(n->scale.x) || !is_scale(n->scale.y) || !is_scale(n->scale.z)))
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "node '%s': each component of a scale is between %g and %g, or so below zero; 0 would flatten it",
		    n->name, 1 / LIMIT_EDIT_SCALE, LIMIT_EDIT_SCALE);
	return STATUS_OK;
}

enum status request_check_time(double time_s, struct error *err)
{
	if (fabs(time_s) <= LIMIT_TIME_S)
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT, "a time is finite and at most %g s", LIMIT_TIME_S);
}

enum status request_check_edits(const candil_Edits *e, struct error *err)
{
	enum status status = request_check_time(e->time_s, err);
	if (status == STATUS_OK && !text_is_clean(e->animation))
		status = edits_check_name("", "an animation", err);
	for (pb_size_t i = 0; i < e->lights_count && status == STATUS_OK; i++)
		status = check_light(&e->lights[i], err);
	for (pb_size_t i = 0; i < e->materials_count && status == STATUS_OK; i++)
		status = check_material(&e->materials[i], err);
	for (pb_size_t i = 0; i < e->nodes_count && status == STATUS_OK; i++)
		status = check_node(&e->nodes[i], err);
	return status;
}
