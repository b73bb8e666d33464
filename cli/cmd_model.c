#include "commands.h"
#include "json.h"

#include <math.h>
#include <string.h>

/* "f_khz [0.1, 3000]", "variant=corrected|printed". */
static void print_key(const asdic_model_key *key) {
    printf("    %s%s%s%s", key->name, key->required ? "" : " (optional)", key->words ? " " : "",
           key->words ? key->words : "");
    if (key->columns) {
        printf(" CSV file of %s", key->columns);
    }
    if (key->numeric) {
        printf("%s [%.9g, %.9g]", key->words ? " or" : "", key->min, key->max);
    }
    if (!key->required && !isnan(key->fallback)) {
        printf(key->numeric ? ", else %.9g" : ", else the first", key->fallback);
    }
    if (key->valid_min > key->min || key->valid_max < key->max) {
        printf(", valid [%.9g, %.9g]", key->valid_min, key->valid_max);
    }
    printf("\n");
}

static void print_list(void) {
    for (size_t i = 0; i < asdic_model_count(); i++) {
        const asdic_model_info *info = asdic_model_get(i);
        printf("%s%s  %s: %s\n    %s\n", i ? "\n" : "", info->name, info->unit, info->what,
               info->source);
        for (size_t k = 0; k < info->key_count; k++) {
            print_key(&info->keys[k]);
        }
    }
}

static void print_key_json(json *j, const asdic_model_key *key) {
    json_open(j, NULL, '{');
    json_text(j, "name", key->name);
    json_bool(j, "required", key->required);
    json_text(j, "words", key->words);
    json_text(j, "columns", key->columns);
    if (key->numeric) {
        json_number(j, "min", key->min);
        json_number(j, "max", key->max);
        json_number(j, "valid_min", key->valid_min);
        json_number(j, "valid_max", key->valid_max);
    }
    if (!key->required) {
        json_number(j, "default", key->fallback);
    }
    json_close(j);
}

static void print_list_json(void) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '[');
    for (size_t i = 0; i < asdic_model_count(); i++) {
        const asdic_model_info *info = asdic_model_get(i);
        json_open(&j, NULL, '{');
        json_text(&j, "name", info->name);
        json_text(&j, "unit", info->unit);
        json_text(&j, "what", info->what);
        json_text(&j, "source", info->source);
        json_open(&j, "keys", '[');
        for (size_t k = 0; k < info->key_count; k++) {
            print_key_json(&j, &info->keys[k]);
        }
        json_close(&j);
        json_close(&j);
    }
    json_close(&j);
}

static void print_value(cli *c, const char *name, const asdic_device *device, double value) {
    const asdic_model_info *info = asdic_model_get(0);
    for (size_t i = 0; i < asdic_model_count(); i++) {
        if (strcmp(asdic_model_get(i)->name, name) == 0) {
            info = asdic_model_get(i);
        }
    }
    if (!cli_given(c, "json")) {
        printf("%.*g %s\n", device ? 9 : 15, value, info->unit);
        return;
    }
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "name", name);
    json_number(&j, "value", value);
    json_text(&j, "unit", info->unit);
    json_text(&j, "source", info->source);
    json_text(&j, "device", device ? asdic_device_get_info(device)->name : NULL);
    json_close(&j);
}

static int run(cli *c) {
    const char *assignments[ASDIC_MODEL_MAX_KEYS + 1];
    asdic_device **devices = NULL;
    size_t device_count = 0, count = cli_operand_count(c);
    double value = 0.0;
    asdic_status status = ASDIC_OK;

    if (count == 0) {
        (cli_given(c, "json") ? print_list_json : print_list)();
        return CLI_OK;
    }
    if (count - 1 > ASDIC_MODEL_MAX_KEYS) {
        return cli_usage(c, "%zu keys, more than any formula has", count - 1);
    }
    for (size_t i = 1; i < count; i++) {
        assignments[i - 1] = cli_operand(c, i);
    }
    if (cli_given(c, "device")) {
        status = cli_open_devices(c, &devices, &device_count);
    }
    if (status == ASDIC_OK) {
        status = asdic_model_evaluate(cli_context(c), devices ? devices[0] : NULL,
                                      cli_operand(c, 0), assignments, count - 1, &value);
    }
    if (status == ASDIC_OK) {
        print_value(c, cli_operand(c, 0), devices ? devices[0] : NULL, value);
    }
    asdic_devices_close(&devices, device_count);
    return cli_end(c, status);
}

const cli_command cli_model_command = {
    .name = "model",
    .operands = "[NAME [KEY=VALUE ...]]",
    .max_operands = CLI_ANY_NUMBER,
    .summary = "evaluate one formula, or list them with units and sources",
    .details = "Prints 'value unit', computed in double precision on the host; with --device in "
               "single precision there. Outside the validity that the formula's source states, "
               "the value is printed with a warning.",
    .examples = "asdic model\n"
                "asdic model absorption f_khz=450 t_degc=10 s_ppt=35 z_m=7 ph=8",
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON,
    .run = run,
};
