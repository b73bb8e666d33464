#include "commands.h"

#include <string.h>

#include "cli_state.h"

#define ROW(name) &cli_##name##_command,
const cli_command *const cli_commands[] = {CLI_COMMANDS(ROW) NULL};

const cli_command *cli_find_command(const char *name) {
    for (size_t i = 0; cli_commands[i]; i++) {
        if (strcmp(cli_commands[i]->name, name) == 0) {
            return cli_commands[i];
        }
    }
    return NULL;
}

void cli_unknown_command(const cli *c, const char *name) {
    const char *names[sizeof cli_commands / sizeof cli_commands[0]];
    size_t count = 0;
    for (; cli_commands[count]; count++) {
        names[count] = cli_commands[count]->name;
    }
    const char *near = cli_nearest(name, names, count);
    if (near) {
        cli_error(c, "unknown command '%s'; did you mean '%s'?", name, near);
    } else {
        cli_error(c, "unknown command '%s'; 'asdic help' lists the commands", name);
    }
}
