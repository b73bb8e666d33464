#include "commands.h"

#include <stdlib.h>

static int run(cli *c) {
    char *schema = asdic_mission_schema();
    if (!schema) {
        cli_error(c, "out of memory");
        return CLI_FAILED;
    }
    fputs(schema, stdout);
    free(schema);
    return CLI_OK;
}

const cli_command cli_schema_command = {
    .name = "schema",
    .operands = "",
    .summary = "print the JSON Schema of the scene file",
    .details = "Draft 7, made from the same table that reads scene files: keys, units, ranges, "
               "defaults. Editors with a YAML language server check and complete scenes with it:\n"
               "    # yaml-language-server: $schema=asdic-schema.json",
    .examples = "asdic schema > asdic-schema.json",
    .run = run,
};
