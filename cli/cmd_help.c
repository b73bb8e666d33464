#include "cli_state.h"
#include "commands.h"

static int run(cli *c) {
    const char *name = cli_operand(c, 0);
    if (!name) {
        cli_help_program(stdout);
        return CLI_OK;
    }
    const cli_command *command = cli_find_command(name);
    if (!command) {
        cli_unknown_command(c, name);
        return CLI_USAGE;
    }
    cli_help_command(stdout, command);
    return CLI_OK;
}

const cli_command cli_help_command_row = {
    .name = "help",
    .operands = "[COMMAND]",
    .max_operands = 1,
    .summary = "list the commands, or explain one",
    .run = run,
};
