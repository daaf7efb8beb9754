// The names of the public enumerations, and the proof that those which are typed out in candil_types.h have the numbers of
// the wire.
#include "protocol/names.h"
#include "candil.pb.h"
#include "clients/libcandil/candil.h"
#include "protocol/header.h"

#define SAME(ours, theirs) _Static_assert((int)(ours) == (int)(theirs), #ours " differs from candil.proto")
SAME(CANDIL_UP_DEFAULT, candil_UpAxis_UP_DEFAULT);
SAME(CANDIL_UP_Y, candil_UpAxis_UP_Y);
SAME(CANDIL_UP_Z, candil_UpAxis_UP_Z);
SAME(CANDIL_EFFECT_SIMULATED, candil_EffectState_EFFECT_STATE_SIMULATED);
SAME(CANDIL_EFFECT_ABSENT, candil_EffectState_EFFECT_STATE_ABSENT);
SAME(CANDIL_EFFECT_SWITCHED_OFF, candil_EffectState_EFFECT_STATE_SWITCHED_OFF);
SAME(CANDIL_EFFECT_FORCED, candil_EffectState_EFFECT_STATE_FORCED);
SAME(CANDIL_EFFECT_UNSUPPORTED, candil_EffectState_EFFECT_STATE_UNSUPPORTED);
SAME(CANDIL_ERROR_KIND_UNKNOWN, candil_ErrorKind_ERROR_KIND_UNKNOWN);
SAME(CANDIL_ERROR_KIND_MEASURED, candil_ErrorKind_ERROR_KIND_MEASURED);
SAME(CANDIL_ERROR_KIND_PREDICTED, candil_ErrorKind_ERROR_KIND_PREDICTED);
SAME(CANDIL_FORMAT_EXR_HALF, candil_Format_FORMAT_EXR_HALF);
SAME(CANDIL_FORMAT_EXR_FLOAT, candil_Format_FORMAT_EXR_FLOAT);
SAME(CANDIL_FORMAT_PNG, candil_Format_FORMAT_PNG);
SAME(CANDIL_FORMAT_PLY, candil_Format_FORMAT_PLY);
SAME(CANDIL_FORMAT_MTX, candil_Format_FORMAT_MTX);
SAME(CANDIL_VIEW_NONE, candil_View_VIEW_NONE);
SAME(CANDIL_VIEW_REINHARD, candil_View_VIEW_REINHARD);
SAME(CANDIL_VIEW_FILMIC, candil_View_VIEW_FILMIC);
SAME(CANDIL_PROJECTION_CAMERA, candil_Projection_PROJECTION_CAMERA);
SAME(CANDIL_PROJECTION_ORTHOGRAPHIC, candil_Projection_PROJECTION_ORTHOGRAPHIC);
SAME(CANDIL_PROJECTION_PANORAMA, candil_Projection_PROJECTION_PANORAMA);
SAME(CANDIL_FILTER_BOX, candil_Filter_FILTER_BOX);
SAME(CANDIL_FILTER_GAUSSIAN, candil_Filter_FILTER_GAUSSIAN);
SAME(CANDIL_FILTER_BLACKMAN_HARRIS, candil_Filter_FILTER_BLACKMAN_HARRIS);
SAME(CANDIL_AOV_DEPTH, AOV_DEPTH);
SAME(CANDIL_AOV_NORMAL, AOV_NORMAL);
SAME(CANDIL_AOV_ALBEDO, AOV_ALBEDO);
SAME(CANDIL_AOV_ID, AOV_ID);

// The value's name out of a table, whatever number a daemon sent.
#define NAME_OF(table, value) ((size_t)(value) < sizeof(table) / sizeof((table)[0]) ? (table)[(size_t)(value)] : "unknown")

const char *candil_status_name(candil_status status)
{
	return status_name((unsigned)status);
}

uint32_t candil_version(void)
{
	return CANDIL_VERSION_NUMBER;
}

const char *candil_technique_name(enum candil_technique technique)
{
	return technique_name((unsigned)technique);
}

const char *candil_effect_name(enum candil_effect effect)
{
	return effect_name((unsigned)effect);
}

const char *candil_effect_state_name(enum candil_effect_state state)
{
	static const char *const names[] = {"simulated", "absent", "switched-off", "forced", "unsupported"};
	return NAME_OF(names, state);
}

const char *candil_error_kind_name(enum candil_error_kind kind)
{
	return error_kind_name((unsigned)kind);
}

const char *candil_format_name(enum candil_format format)
{
	return format_name((unsigned)format);
}

const char *candil_view_name(enum candil_view view)
{
	static const char *const names[] = {"none", "reinhard", "filmic"};
	return NAME_OF(names, view);
}
