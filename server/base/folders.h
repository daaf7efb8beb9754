// Folders that may not be there yet. Any thread.
#ifndef CANDIL_BASE_FOLDERS_H
#define CANDIL_BASE_FOLDERS_H

#include <stdbool.h>

// Make a folder and those above it that are missing, for this user alone. `path` is shorter than PATH_MAX. False, with
// errno, if it is not there in the end.
bool make_folders(const char *path);

#endif
