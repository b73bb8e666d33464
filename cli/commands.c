#include "commands.h"

#include <string.h>

#include "cli_state.h"

/* clang-format off: one a line */
const cli_command *const cli_commands[] = {
    &cli_run_command,
    &cli_expect_command,
    &cli_detect_command,
    &cli_roc_command,
    &cli_trial_command,
    &cli_view_command,
    &cli_serve_command,
    &cli_render_command,
    &cli_merge_command,
    &cli_dataset_command,
    &cli_model_command,
    &cli_bench_command,
    &cli_check_command,
    &cli_plan_command,
    &cli_schema_command,
    &cli_devices_command,
    &cli_help_command_row,
    NULL,
};
/* clang-format on */

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
