#include "commands.h"
#include "json.h"
#include "cli_state.h"

static void print_command(json *j, const cli_command *command) {
    const cli_option *options[CLI_MAX_OPTIONS];
    size_t count = cli_options_of(command, options);
    json_open(j, NULL, '{');
    json_text(j, "name", command->name);
    json_text(j, "operands", command->operands);
    json_text(j, "summary", command->summary);
    json_text(j, "details", command->details);
    json_text(j, "examples", command->examples);
    json_open(j, "options", '[');
    for (size_t i = 0; i < count; i++) {
        char letter[] = {options[i]->letter, '\0'};
        json_open(j, NULL, '{');
        json_text(j, "name", options[i]->name);
        json_text(j, "letter", letter[0] ? letter : NULL);
        json_text(j, "arg", options[i]->arg);
        json_text(j, "help", options[i]->help);
        json_close(j);
    }
    json_close(j);
    json_close(j);
}

/* The whole table; man pages and completions are made from it. */
static void print_table(const cli_command *only) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '[');
    for (size_t i = 0; cli_commands[i]; i++) {
        if (!only || only == cli_commands[i]) {
            print_command(&j, cli_commands[i]);
        }
    }
    json_close(&j);
}

static int run(cli *c) {
    const char *name = cli_operand(c, 0);
    const cli_command *command = name ? cli_find_command(name) : NULL;
    if (name && !command) {
        cli_unknown_command(c, name);
        return CLI_USAGE;
    }
    if (cli_given(c, "json")) {
        print_table(command);
    } else if (command) {
        cli_help_on(stdout, command);
    } else {
        cli_help_program(stdout);
    }
    return CLI_OK;
}

const cli_command cli_help_command = {
    .name = "help",
    .operands = "[COMMAND]",
    .max_operands = 1,
    .summary = "list the commands, or explain one",
    .details =
        "With --json the whole table, or one command of it: names, operands, texts and options. "
        "Manual pages and completions are made from it.",
    .examples = "asdic help run\n"
                "asdic help --json",
    .traits = CLI_HAS_JSON,
    .run = run,
};
