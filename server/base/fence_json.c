#include "server/base/fence_json.h"

json_t *fence_json(const struct fence_report *report)
{
	json_t *layers = json_array();
	for (int i = 0; i < FENCE_LAYERS; i++) {
		const struct fence_state *state = &report->layers[i];
		if (state->detail[0])
			json_array_append_new(layers,
					      json_pack("{s:s,s:b,s:s}", "name", fence_layer_name((enum fence_layer)i),
							"holds", (int)state->holds, "detail", state->detail));
	}
	return json_pack("{s:i,s:o}", "threads", report->threads, "layers", layers);
}
