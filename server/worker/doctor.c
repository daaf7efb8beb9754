#include "server/worker/doctor.h"

#include <jansson.h>
#include <stdio.h>

#include "protocol/text.h"
#include "server/base/fence_json.h"
#include "server/worker/fence.h"
#include "server/worker/vk/device.h"

static json_t *device_json(struct device_info *d)
{
	char api[16];
	text_clean(d->name, sizeof d->name);
	snprintf(api, sizeof api, "%u.%u", VK_API_VERSION_MAJOR(d->api), VK_API_VERSION_MINOR(d->api));
	return json_pack("{s:i s:s s:s s:s s:s s:b s:s s:I s:s}", "index", (int)d->index, "name", d->name, "type", d->type,
			 "api", api, "uuid", d->uuid, "usable", d->usable, "why", d->usable ? "" : d->why_not,
			 "memory_bytes", (json_int_t)d->memory_bytes, "driver", d->name);
}

int doctor(const struct device_options *options, struct worker_fence *fence)
{
	struct device_info infos[DEVICE_MAX];
	struct error err = {0};
	uint32_t count, chosen = 0, others;
	char why[LIMIT_TEXT + 1];
	json_t *devices = json_array();
	json_t *missing = json_array();
	enum status s = device_list(infos, &count, &err);
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(devices, device_json(&infos[i]));
	if (count == 0)
		json_array_append_new(missing, json_pack("{s:s s:s}", "what", "a Vulkan driver (software will do)",
							 "package", "mesa-vulkan-drivers"));
	if (s == STATUS_OK)
		s = device_choose(infos, count, options, &chosen, &others, why, &err);
	fence_try(&fence->report);
	text_clean(fence->cache, sizeof fence->cache); // which need not be UTF-8, as JSON is
	json_t *cache = json_pack("{s:s s:b}", "path", fence->cache, "writable", (int)fence->cache_writable);
	json_t *root = json_pack("{s:o s:i s:s s:o s:o s:o}", "devices", devices, "chosen",
				 s == STATUS_OK ? (int)chosen : -1, "why", s == STATUS_OK ? why : err.text, "missing",
				 missing, "shader_cache", cache, "fence", fence_json(&fence->report));
	json_dumpf(root, stdout, JSON_INDENT(2));
	putchar('\n');
	json_decref(root);
	return s == STATUS_OK ? 0 : 5;
}
