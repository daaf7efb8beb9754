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

bool status_is_known(unsigned code)
{
	switch (code) {
#define X(name, number, wire) case number:
		CANDIL_STATUS_LIST(X)
#undef X
		return true;
	}
	return false;
}
