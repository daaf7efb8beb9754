// make_words SYMBOL FILE HEADER: writes a SPIR-V module to HEADER as an array of words, `const uint32_t SYMBOL[]`. It runs
// while candil is built: the worker never opens a shader file.
#include <inttypes.h>
#include <stdio.h>

#define WORDS_A_LINE 8u

int main(int argc, char **argv)
{
	if (argc != 4) {
		fprintf(stderr, "usage: make_words SYMBOL FILE HEADER\n");
		return 2;
	}
	FILE *module = fopen(argv[2], "rb"), *header = fopen(argv[3], "w");
	int status = 1;
	if (!module || !header) {
		perror(module ? argv[3] : argv[2]);
		goto end;
	}
	fprintf(header, "#include <stdint.h>\n\nstatic const uint32_t %s[] = {", argv[1]);
	uint32_t word;
	for (size_t i = 0; fread(&word, sizeof word, 1, module) == 1; i++)
		fprintf(header, "%s0x%08" PRIx32 ",", i % WORDS_A_LINE ? " " : "\n\t", word);
	fprintf(header, "\n};\n");
	if (ferror(module) || ferror(header))
		fprintf(stderr, "make_words: %s cannot be read or %s not written\n", argv[2], argv[3]);
	else
		status = 0;
end:
	if (module)
		fclose(module);
	if (header && fclose(header) != 0)
		status = 1;
	return status;
}
