#include "server/worker/vk/pipeline.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/worker/code_list.h"
#include "server/worker/code_store.h"
#include "server/worker/vk/specialise.h"

_Static_assert(EFFECT_COUNT <= SPEC_EFFECTS, "every effect has a constant");

void constants_set(struct constants *c, uint32_t id, uint32_t value)
{
	if (c->count < PIPELINE_CONSTANTS_MAX) {
		c->of[c->count].id = id;
		c->of[c->count].value = value;
	}
	c->count++;
}

void constants_set_effects(struct constants *c, uint32_t effects)
{
	for (uint32_t i = 0; i < EFFECT_COUNT; i++)
		constants_set(c, i, effects >> i & 1u);
}

static VkDescriptorType type_of(const struct shader *shader, uint32_t binding)
{
	return shader->texels >> binding & 1u ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

static enum status make_layout(struct device *d, struct pipeline *p, struct error *err)
{
	VkDescriptorSetLayoutBinding bindings[BIND_MOST];
	for (uint32_t i = 0; i < p->shader->bindings; i++)
		bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
							     .descriptorType = type_of(p->shader, i),
							     .descriptorCount = 1,
							     .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
	const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
						     .bindingCount = p->shader->bindings,
						     .pBindings = bindings};
	VkResult r = vkCreateDescriptorSetLayout(d->handle, &set, NULL, &p->set_layout);
	if (r != VK_SUCCESS)
		return device_error(r, "making a descriptor layout", err);
	const VkPushConstantRange push = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = p->shader->push_bytes};
	const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
						   .setLayoutCount = 1,
						   .pSetLayouts = &p->set_layout,
						   .pushConstantRangeCount = push.size ? 1 : 0,
						   .pPushConstantRanges = &push};
	r = vkCreatePipelineLayout(d->handle, &layout, NULL, &p->layout);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "making a pipeline layout", err);
}

// A module of its own for these constants, the one that an earlier process made if there is one. Where SPIRV-Tools cannot
// make one, the driver specialises the whole module, which takes it longer.
static enum status make_module(struct device *d, const struct pipeline *p, VkShaderModule *module, bool *specialised,
			       struct error *err)
{
	const struct constants *c = &p->constants;
	uint32_t ids[PIPELINE_CONSTANTS_MAX], values[PIPELINE_CONSTANTS_MAX];
	for (uint32_t i = 0; i < c->count; i++) {
		ids[i] = c->of[i].id;
		values[i] = c->of[i].value;
	}
	size_t bytes = p->shader->bytes;
	const int kept = d->code ? d->code->folder : -1;
	const uint64_t number = d->code ? code_list_number(d->code, p->piece) : 0;
	uint32_t *own = code_store_read(kept, number, &bytes);
	if (!own) {
		own = specialise(p->shader->code, p->shader->bytes, ids, values, c->count, &bytes);
		if (own)
			code_store_write(kept, number, own, bytes);
	}
	const VkShaderModuleCreateInfo code = {
	    .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = own ? own : p->shader->code};
	VkResult r = vkCreateShaderModule(d->handle, &code, NULL, module);
	*specialised = own != NULL;
	free(own);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "loading a shader", err);
}

static enum status make_pipeline(struct device *d, struct pipeline *p, struct error *err)
{
	VkSpecializationMapEntry entries[PIPELINE_CONSTANTS_MAX];
	const struct constants *c = &p->constants;
	const uint32_t stride = sizeof c->of[0];
	for (uint32_t i = 0; i < c->count; i++)
		entries[i] =
		    (VkSpecializationMapEntry){.constantID = c->of[i].id,
					       .offset = i * stride + (uint32_t)offsetof(struct constants, of[0].value) -
							 (uint32_t)offsetof(struct constants, of[0]),
					       .size = sizeof c->of[i].value};
	const VkSpecializationInfo special = {
	    .mapEntryCount = c->count, .pMapEntries = entries, .dataSize = c->count * stride, .pData = c->of};
	VkShaderModule module;
	bool specialised;
	enum status s = make_module(d, p, &module, &specialised, err);
	if (s != STATUS_OK)
		return s;
	const VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
						  .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
							    .stage = VK_SHADER_STAGE_COMPUTE_BIT,
							    .module = module,
							    .pName = "main",
							    .pSpecializationInfo = specialised ? NULL : &special},
						  .layout = p->layout};
	VkResult r = vkCreateComputePipelines(d->handle, VK_NULL_HANDLE, 1, &info, NULL, &p->handle);
	vkDestroyShaderModule(d->handle, module, NULL);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "compiling a pipeline", err);
}

static void pipeline_destroy(struct device *d, struct pipeline *p)
{
	vkDestroyPipeline(d->handle, p->handle, NULL);
	vkDestroyPipelineLayout(d->handle, p->layout, NULL);
	vkDestroyDescriptorSetLayout(d->handle, p->set_layout, NULL);
	free(p);
}

// Destroy the pipeline unused for longest if there is no room for one more.
static void pipeline_trim(struct device *d)
{
	struct pipeline **oldest = NULL;
	unsigned count = 0;
	for (struct pipeline **at = &d->pipelines; *at; at = &(*at)->next) {
		count++;
		if ((*at)->users == 0 && (!oldest || (*at)->used < (*oldest)->used))
			oldest = at;
	}
	if (count < PIPELINES_MAX || !oldest)
		return;
	struct pipeline *p = *oldest;
	*oldest = p->next;
	pipeline_destroy(d, p);
}

static bool same_constants(const struct constants *a, const struct constants *b)
{
	return a->count == b->count && !memcmp(a->of, b->of, a->count * sizeof a->of[0]);
}

static bool pipeline_fits(const struct shader *shader, const struct constants *constants)
{
	uint32_t texels = 0;
	for (uint32_t i = 0; i < BIND_MOST; i++)
		texels += shader->texels >> i & 1u;
	return shader->bindings <= BIND_MOST && texels <= BIND_TEXELS_MOST && constants->count <= PIPELINE_CONSTANTS_MAX;
}

enum status pipeline_get(struct device *d, const struct shader *shader, const struct constants *constants,
			 struct pipeline **pipeline, struct error *err)
{
	static const struct constants none = {0};
	if (!constants)
		constants = &none;
	if (!pipeline_fits(shader, constants))
		return error_set(err, STATUS_INTERNAL, "the shader %s has more bindings or constants than a pipeline",
				 shader->name);
	for (struct pipeline *p = d->pipelines; p; p = p->next)
		if (p->shader == shader && same_constants(&p->constants, constants)) {
			p->used = ++d->pipeline_turn;
			*pipeline = p;
			return STATUS_OK;
		}
	const uint64_t piece = code_piece(code_piece(0, shader->code, shader->bytes), constants->of,
					  constants->count * sizeof constants->of[0]);
	enum status s = d->code ? code_list_ask(d->code, piece, err) : STATUS_OK;
	if (s != STATUS_OK)
		return s;
	struct pipeline *p = calloc(1, sizeof *p);
	if (!p)
		return error_set(err, STATUS_MEMORY, "out of memory");
	p->shader = shader;
	p->constants = *constants;
	p->piece = piece;
	s = make_layout(d, p, err);
	if (s == STATUS_OK)
		s = make_pipeline(d, p, err);
	if (s != STATUS_OK) {
		pipeline_destroy(d, p);
		return s;
	}
	pipeline_trim(d);
	p->used = ++d->pipeline_turn;
	p->next = d->pipelines;
	d->pipelines = p;
	*pipeline = p;
	return STATUS_OK;
}

void pipeline_has_run(struct device *d, struct pipeline *p)
{
	if (!p->warm && d->code)
		code_list_add(d->code, p->piece);
	p->warm = true;
}

void pipeline_destroy_all(struct device *d)
{
	if (d->handle)
		vkDeviceWaitIdle(d->handle);
	while (d->pipelines) {
		struct pipeline *p = d->pipelines;
		d->pipelines = p->next;
		pipeline_destroy(d, p);
	}
}

static enum status make_pool(struct binding_set *set, struct device *d, const struct pipeline *p, struct error *err)
{
	uint32_t texels = 0;
	for (uint32_t i = 0; i < p->shader->bindings; i++)
		texels += p->shader->texels >> i & 1u;
	const VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, p->shader->bindings - texels},
					       {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texels}};
	const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
						 .maxSets = 1,
						 .poolSizeCount = texels ? 2 : 1,
						 .pPoolSizes = sizes};
	VkResult r = vkCreateDescriptorPool(d->handle, &pool, NULL, &set->pool);
	if (r != VK_SUCCESS)
		return device_error(r, "making a descriptor pool", err);
	const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
						  .descriptorPool = set->pool,
						  .descriptorSetCount = 1,
						  .pSetLayouts = &p->set_layout};
	r = vkAllocateDescriptorSets(d->handle, &info, &set->set);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "making a descriptor set", err);
}

static enum status make_view(VkBufferView *view, struct device *d, const struct buffer *b, struct error *err)
{
	const uint64_t most = (uint64_t)d->limits.maxTexelBufferElements * PIPELINE_TEXEL_BYTES;
	const uint64_t whole = b->made / PIPELINE_TEXEL_BYTES * PIPELINE_TEXEL_BYTES;
	const VkBufferViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
					     .buffer = b->handle,
					     .format = VK_FORMAT_R32G32B32A32_UINT,
					     .range = whole < most ? whole : most};
	VkResult r = vkCreateBufferView(d->handle, &info, NULL, view);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "making a view of a buffer", err);
}

enum status binding_set_init(struct binding_set *set, struct device *d, struct pipeline *p,
			     const struct buffer *const *buffers, const struct buffer *filler, struct error *err)
{
	const uint32_t count = p->shader->bindings;
	VkDescriptorBufferInfo ranges[BIND_MOST];
	VkWriteDescriptorSet writes[BIND_MOST];
	uint32_t views = 0;
	memset(set, 0, sizeof *set);
	set->pipeline = p;
	p->users++;
	enum status s = make_pool(set, d, p, err);
	for (uint32_t i = 0; s == STATUS_OK && i < count; i++) {
		const struct buffer *b = buffers[i] && buffers[i]->handle ? buffers[i] : filler;
		ranges[i] = (VkDescriptorBufferInfo){.buffer = b->handle, .range = b->bytes};
		writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
						   .dstSet = set->set,
						   .dstBinding = i,
						   .descriptorCount = 1,
						   .descriptorType = type_of(p->shader, i),
						   .pBufferInfo = &ranges[i],
						   .pTexelBufferView = &set->views[views]};
		if (p->shader->texels >> i & 1u)
			s = make_view(&set->views[views++], d, b, err);
	}
	if (s != STATUS_OK) {
		binding_set_finish(set, d);
		return s;
	}
	vkUpdateDescriptorSets(d->handle, count, writes, 0, NULL);
	return STATUS_OK;
}

void binding_set_finish(struct binding_set *set, struct device *d)
{
	for (uint32_t i = 0; i < BIND_TEXELS_MOST; i++)
		if (set->views[i])
			vkDestroyBufferView(d->handle, set->views[i], NULL);
	if (set->pool)
		vkDestroyDescriptorPool(d->handle, set->pool, NULL);
	if (set->pipeline)
		set->pipeline->users--;
	memset(set, 0, sizeof *set);
}
