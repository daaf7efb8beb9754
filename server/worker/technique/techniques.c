// The list of techniques. No other file of the worker, but a technique's own folder, knows one by its name.
#include "protocol/names.h"
#include "server/worker/technique/direct/direct.h"
#include "server/worker/technique/pt/pt.h"
#include "server/worker/technique/radiosity/radiosity.h"
#include "server/worker/technique/technique.h"
#include "server/worker/technique/vct/vct.h"

static const struct technique *const techniques[] = {&technique_pt, &technique_direct, &technique_vct, &technique_radiosity};

uint32_t technique_count(void)
{
	return sizeof techniques / sizeof *techniques;
}

const struct technique *technique_at(uint32_t i)
{
	return techniques[i];
}

const struct technique *technique_find(candil_Technique number)
{
	if (number == candil_Technique_TECHNIQUE_AUTO)
		number = (candil_Technique)TECHNIQUE_OF_AUTO;
	for (uint32_t i = 0; i < technique_count(); i++)
		if (techniques[i]->number == number)
			return techniques[i];
	return NULL;
}
