#include "cli_state.h"

#include <string.h>

#include "commands.h"

#define TEXT_COLUMN 26
#define LAST_COLUMN 78

/* TEXT wrapped between two columns; its own line ends are kept. The cursor is at INDENT. */
static void print_wrapped(FILE *out, const char *text, int indent) {
    int column = indent;
    while (*text) {
        size_t length = strcspn(text, " \n");
        if (column > indent && column + 1 + (int)length > LAST_COLUMN) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', out);
            column++;
        }
        fwrite(text, 1, length, out);
        column += (int)length;
        text += length;
        text += strspn(text, " ");
        for (; *text == '\n'; text++) {
            fprintf(out, "\n%*s", text[1] == '\n' ? 0 : indent, "");
            column = indent;
        }
    }
    fputc('\n', out);
}

static void print_row(FILE *out, const char *head, const char *text) {
    int column = fprintf(out, "  %s", head);
    if (column > TEXT_COLUMN - 2) {
        fputc('\n', out);
        column = 0;
    }
    fprintf(out, "%*s", TEXT_COLUMN - column, "");
    print_wrapped(out, text, TEXT_COLUMN);
}

void cli_help_program(FILE *out) {
    fprintf(out, "asdic %s: forward-looking sonar, simulated on any OpenCL device\n\n",
            asdic_version());
    fputs("usage: asdic COMMAND [OPTION...] [OPERAND...]\n\ncommands:\n", out);
    for (size_t i = 0; cli_commands[i]; i++) {
        print_row(out, cli_commands[i]->name, cli_commands[i]->summary);
    }
    fputs("\n'asdic COMMAND --help' explains one; 'asdic --version' (-V) prints the version.\n",
          out);
}

void cli_help_on(FILE *out, const cli_command *command) {
    const cli_option *options[CLI_MAX_OPTIONS];
    size_t count = cli_options_of(command, options);
    fprintf(out, "usage: asdic %s [OPTION...]%s%s\n\n%s.\n", command->name,
            command->operands[0] ? " " : "", command->operands, command->summary);
    fputc('\n', out);
    print_wrapped(out, command->details, 0);
    fputs("\noptions:\n", out);
    for (size_t i = 0; i < count; i++) {
        const cli_option *o = options[i];
        char head[96], letter[8] = "    ";
        if (o->letter) {
            snprintf(letter, sizeof letter, "-%c, ", o->letter);
        }
        snprintf(head, sizeof head, "%s--%s%s%s", letter, o->name, o->arg ? " " : "",
                 o->arg ? o->arg : "");
        print_row(out, head, o->help);
    }
    fputs("\nexamples:\n", out);
    for (const char *line = command->examples; *line; line += *line == '\n') {
        int length = (int)strcspn(line, "\n");
        fprintf(out, "  %.*s\n", length, line);
        line += length;
    }
}
