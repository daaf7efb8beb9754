// A SceneInfo as JSON, for people and tests. One thread.
#ifndef CANDIL_LOADER_DESCRIBE_H
#define CANDIL_LOADER_DESCRIBE_H

#include <stdbool.h>

#include "candil.pb.h"

// Write it to standard output. False if writing fails.
bool describe_print(const candil_SceneInfo *info);

#endif
