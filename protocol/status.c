#include "protocol/status.h"

const char *status_name(unsigned code)
{
	switch (code) {
#define X(name, number, wire) \
	case number: \
		return wire;
		CANDIL_STATUS_LIST(X)
#undef X
	}
	return "unknown";
}
