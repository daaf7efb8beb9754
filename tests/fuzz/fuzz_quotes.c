// The file of what is learned for quotes, as anyone may have written it: the first byte is how many records the input begins
// with, the rest is laid over the habits of one device. The sum that keeps accidents away is always right. What the daemon
// takes of it must give predictions that are numbers, also after one more frame.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/front/quotes/store.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void predict(const struct quote_model *model, const struct quote_query *query)
{
	const struct quote_prediction p = quote_predict(model, query);
	if (isnan(p.us) || isnan(p.us_low) || isnan(p.us_high) || isnan(p.cold_us) || isnan(p.error.relmse) ||
	    isnan(p.error.low) || isnan(p.error.high) || p.us < p.us_low || p.us > p.us_high)
		abort();
}

static void use(struct quote_model *model, const struct quote_record *record)
{
	struct quote_query query = {.key = record->key,
				    .technique = record->technique,
				    .pixels = 4096,
				    .samples = 16,
				    .bytes = 4096,
				    .setup = true,
				    .cold = true};
	predict(model, &query);
	query.key.scene++;
	predict(model, &query);
	quote_count_scene(model, &record->key);
	quote_count_look(model, &record->key, QUOTE_SAMPLE);
	quote_count_view(model, &record->key, QUOTE_ERROR);
	quote_refused(model, &record->key);
	query.key = record->key;
	const struct quote_record frame = *record;
	quote_learn(model, &frame, &query, 1000);
	predict(model, &query);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct quote_model written, model;
	struct error err;
	size_t bytes;
	memset(&written, 0, sizeof written);
	memset(&model, 0, sizeof model);
	for (unsigned records = size > 0 ? data[0] % 8u : 0; records > 0 && size > sizeof written.records[0]; records--) {
		memcpy(&written.records[written.count++], data + 1, sizeof written.records[0]);
		data += sizeof written.records[0];
		size -= sizeof written.records[0];
	}
	if (size > 1)
		memcpy(&written.habits[0], data + 1,
		       size - 1 < sizeof written.habits[0] ? size - 1 : sizeof written.habits[0]);
	uint8_t *file = quote_store_encode(&written, &bytes);
	if (file && quote_store_decode(file, bytes, &model, &err) == STATUS_OK && model.count > 0)
		use(&model, &model.records[0]);
	free(file);
	return 0;
}
