// The environment of the front's children. The front's own may hold anything, keys of other services among it, and a child
// that is taken over could tell them. So a child gets the variables that it or a library of it reads, and no other.
#ifndef CANDIL_FRONT_INHERIT_H
#define CANDIL_FRONT_INHERIT_H

enum program { PROGRAM_LOADER, PROGRAM_WORKER };

// Those of `environment`, which ends with NULL, that `program` gets, in the same order and ended by NULL. The caller frees
// the array; the strings are those of `environment`. NULL: no memory.
char **inherit_environment(enum program program, char *const environment[]);

#endif
