// The technique `radiosity`: the scene's surfaces are cut into patches, and the light of all patches is solved for at once
// (Goral et al. 1984; with mirrors, Sillion and Puech 1989). The solution knows no camera: it stays with the scene, and any
// later view of it is a raster pass. It has no noise from pixel to pixel: its error depends on patches and form factors.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_H

#include "server/worker/technique/technique.h"

// Its table.
extern const struct technique technique_radiosity;

#endif
