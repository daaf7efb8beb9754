// The answer of `candil quote`, which `candil render` shows, too, where the technique was chosen by one.
#ifndef CANDIL_CLI_QUOTE_H
#define CANDIL_CLI_QUOTE_H

#include "clients/cli/cli.h"

#define QUOTE_JSON_HELP \
	"{\"technique\", \"settings\": {\"samples\"}, \"time_ms\", \"time_ms_low\", " \
	"\"time_ms_high\",\n" \
	"\"relmse\", \"relmse_low\", \"relmse_high\" (null: unknown), \"met\", \"why\", \"cheaper\", \"better\" (each " \
	"with\n" \
	"these from technique to relmse_high, or null), \"from\": \"model\"|\"pilot\", \"cold_ms\", \"queue_ms\", " \
	"\"jobs\",\n" \
	"\"records\", \"notes\": []}\n"

json_t *quote_json(const struct candil_quote *quote);

#endif
