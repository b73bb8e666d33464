#include "cli_state.h"
#include "commands.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>

/* Whether C's command has --resume. */
static bool resumes(const cli *c) {
    for (size_t i = 0; i < c->option_count; i++) {
        if (strcmp(c->options[i]->name, "resume") == 0) {
            return true;
        }
    }
    return false;
}

/* Runs C's command with ARGV, whose first word is the command's name. */
static int run_command(cli *c, int argc, char **argv) {
    const cli_command *command = c->command;
    if (!cli_parse(c, argc, argv)) {
        return CLI_USAGE;
    }
    cli_report_begin(c);
    if (cli_given(c, "help")) {
        cli_help_on(stdout, command);
        return CLI_OK;
    }
    if (c->operand_count < command->min_operands) {
        return cli_usage(c, "'%s' needs %s", command->name, command->operands);
    }
    if (command->max_operands != CLI_ANY_NUMBER && c->operand_count > command->max_operands) {
        return cli_usage(c, "'%s' does not take '%s'", command->name,
                         c->operands[command->max_operands]);
    }
    if (command->traits & (CLI_INTERRUPTIBLE | CLI_STOPS_SOON)) {
        cli_signals_begin(c->ctx, (command->traits & CLI_STOPS_SOON) != 0, resumes(c));
    }
    return command->run(c);
}

static bool is_one_of(const char *word, const char *a, const char *b) {
    return strcmp(word, a) == 0 || strcmp(word, b) == 0;
}

static int run_program(cli *c, int argc, char **argv) {
    const char *word = argc > 1 ? argv[1] : NULL;
    if (!word) {
        cli_help_program(stderr);
        return CLI_USAGE;
    }
    if (is_one_of(word, "--version", "-V")) {
        printf("asdic %s\n", asdic_version());
        return CLI_OK;
    }
    if (is_one_of(word, "--help", "-h")) {
        cli_help_program(stdout);
        return CLI_OK;
    }
    if (word[0] == '-') {
        cli_error(c, "'%s' stands before a command; 'asdic --help' shows the usage", word);
        return CLI_USAGE;
    }
    const cli_command *command = cli_find_command(word);
    if (!command) {
        cli_unknown_command(c, word);
        return CLI_USAGE;
    }
    cli_begin(c, c->ctx, command);
    cli_report_begin(c);
    return run_command(c, argc - 1, argv + 1);
}

/* Where the caller closed a standard stream, the next file opened would get its number and receive
 * messages. /dev/null takes the number instead, opened so that reading stdin and writing stdout
 * fail. */
static void hold_standard_streams(void) {
    for (int fd = 0; fd <= 2; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY) < 0) {
            return;
        }
    }
}

int main(int argc, char **argv) {
    cli c;
    asdic_context *ctx = NULL;
    cli_heap_begin();
    hold_standard_streams();
    signal(SIGXFSZ, SIG_IGN); /* a limit on file sizes is an error of writing, as a full disk */
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        fputs("error: out of memory\n", stderr);
        return CLI_FAILED;
    }
    cli_begin(&c, ctx, &cli_help_command);
    cli_report_begin(&c);
    int code = cli_close_output(&c, run_program(&c, argc, argv));
    cli_signals_end();
    asdic_context_destroy(&ctx);
    return code;
}
