// A shader module with its specialization constants put in, and without the code that they leave dead. Drivers do the same,
// but late: they read, inline and clean all of the module first, which for a module of many effects is most of a
// compilation. Done with SPIRV-Tools. shaders/CMakeLists.txt does what needs no constant when candil is built.
#ifndef CANDIL_WORKER_VK_SPECIALISE_H
#define CANDIL_WORKER_VK_SPECIALISE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The constants `ids` get `values`, `count` of each; others keep their defaults. Returns the module's code, *bytes of it,
// for the caller to free(); NULL if SPIRV-Tools cannot, and the module is then to be used as it is. Any thread.
uint32_t *specialise(const uint32_t *code, size_t code_bytes, const uint32_t *ids, const uint32_t *values, uint32_t count,
		     size_t *bytes);

#ifdef __cplusplus
}
#endif

#endif
