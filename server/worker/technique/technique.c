#include "server/worker/technique/technique.h"

#include "server/worker/technique/direct.h"
#include "server/worker/technique/pt.h"
#include "server/worker/technique/vct.h"

const struct technique *technique_find(candil_Technique technique)
{
	switch (technique) {
	case candil_Technique_TECHNIQUE_AUTO:
	case candil_Technique_TECHNIQUE_PT:
		return &technique_pt;
	case candil_Technique_TECHNIQUE_DIRECT:
		return &technique_direct;
	case candil_Technique_TECHNIQUE_VCT:
		return &technique_vct;
	default:
		return NULL;
	}
}
