// Linked into the programs that use a Vulkan driver, in sanitized builds only, so that the leak checker at their end can
// tell the driver's leaks from ours: a leak of a library that is no longer loaded has no name that a suppression could
// match.
#include <dlfcn.h>

const char *__lsan_default_suppressions(void);

// Lavapipe keeps a little of what it allocates when an instance is made.
const char *__lsan_default_suppressions(void)
{
	return "leak:libvulkan_lvp.so\n";
}

// Keeps every library.
int dlclose(void *library)
{
	(void)library;
	return 0;
}
