/* asdic-bench: what only this project measures, see kinds.h; the frame is that of `asdic bench`. */
#include "cli_state.h"
#include "commands.h"
#include "kinds.h"

static const cli_option options[] = {
    {"output", 'o', "FILE.csv", "write the figures as CSV too; - in place of the table"},
    {"picture", 0, "FILE", "fan: draw the curves too: .png, .pdf or .svg"},
    {"quick", 0, NULL, "a rougher answer in a fraction of the time"},
    {"threads", 0, "N", "threads of a processor as device; of rays 1 unless given"},
    {"kernel", 0, "NAME", "beside: a form of the ray kernel instead of the fastest"},
    {"force", 'f', NULL, "overwrite what exists"},
    {NULL, 0, NULL, NULL},
};

static int run(cli *c) {
    static const bench_kind kinds[] = {
        {"bend", bend_columns, bend, NULL, 0, 0, 0, 0, false},
        {"beside", beside_columns, beside, NULL, 0, CLI_ANY_NUMBER, 1, 0, true},
        {"coherent", coherent_columns, coherent, NULL, 0, 0, 0, 0, false},
        {"cost", cost_columns, cost, NULL, 1, CLI_ANY_NUMBER, 0, 0, false},
        {"fan", fan_columns, fan, NULL, 0, 0, 0, 1, false},
        {"first", first_columns, first, NULL, 0, 0, 0, 0, false},
        {"growth", bench_pings_columns, growth, NULL, 0, 0, 0, 0, false},
        {"latency", bench_loop_columns, latency, NULL, 0, 0, 0, 0, false},
        {"roofline", roofline_columns, roofline, NULL, 0, 0, 0, 0, false},
        {"start", start_columns, start, NULL, 0, 0, 0, 0, false},
        {"truth", truth_columns, truth, NULL, 1, CLI_ANY_NUMBER, 0, 0, false},
        {NULL, NULL, NULL, NULL, 0, 0, 0, 0, false},
    };
    return bench_run(c, kinds);
}

static const cli_command command = {
    .name = "asdic-bench",
    .operands = "bend|beside|coherent|cost|fan|first|growth|latency|roofline|start|truth "
                "[SCENE.yaml|MESH ...]",
    .min_operands = 1,
    .max_operands = CLI_ANY_NUMBER,
    .summary = "measure what only the project asks",
    .details = "",
    .examples = "asdic-bench beside\n",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
};

int main(int argc, char **argv) {
    cli c;
    asdic_context *ctx = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return CLI_FAILED;
    }
    cli_begin(&c, ctx, &command);
    int code = CLI_USAGE;
    bool is_right = cli_parse(&c, argc, argv);
    if (is_right && cli_given(&c, "help")) {
        cli_help_on(stdout, &command);
        code = CLI_OK;
    } else if (is_right && cli_operand_count(&c) > 0) {
        cli_report_begin(&c);
        cli_signals_begin(ctx, false, false);
        code = run(&c);
    } else {
        cli_help_on(stderr, &command);
    }
    code = cli_close_output(&c, code);
    cli_signals_end();
    asdic_context_destroy(&ctx);
    return code;
}
