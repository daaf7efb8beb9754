#include "server/worker/technique/technique.h"

#include "server/worker/technique/direct.h"
#include "server/worker/technique/pt.h"

const struct technique *technique_find(candil_Technique technique)
{
	switch (technique) {
	case candil_Technique_TECHNIQUE_AUTO:
	case candil_Technique_TECHNIQUE_PT:
		return &technique_pt;
	case candil_Technique_TECHNIQUE_DIRECT:
		return &technique_direct;
	default:
		return NULL;
	}
}
