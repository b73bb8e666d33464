#include "commands.h"
#include "json.h"

#include <string.h>

static const char *kind_name(asdic_device_kind kind) {
    switch (kind) {
    case ASDIC_DEVICE_CPU:
        return "cpu";
    case ASDIC_DEVICE_GPU:
        return "gpu";
    case ASDIC_DEVICE_ACCELERATOR:
        return "acc";
    case ASDIC_DEVICE_OTHER:
        break;
    }
    return "other";
}

/* What the device lacks; "" when nothing is missing. */
static const char *lacks(const asdic_device_info *info) {
    if (!info->usable) {
        return info->unusable_why;
    }
    return info->has_int64_atomics ? "" : "64-bit atomics (pairs of 32 bits are used)";
}

static bool same_device(const asdic_device_info *a, const asdic_device_info *b) {
    return b && a->platform == b->platform && a->device == b->device;
}

static void print_size(double bytes) {
    if (bytes >= 1073741824.0) {
        printf("  %6.1f GiB", bytes / 1073741824.0);
    } else {
        printf("  %6.1f MiB", bytes / 1048576.0);
    }
}

static void print_table(const asdic_device_info *infos, size_t count,
                        const asdic_device_info *chosen) {
    int name_width = 4, platform_width = 8;
    for (size_t i = 0; i < count; i++) {
        int name = (int)strlen(infos[i].name), platform = (int)strlen(infos[i].platform_name);
        name_width = name > name_width ? name : name_width;
        platform_width = platform > platform_width ? platform : platform_width;
    }
    printf("  P:D    kind   units      memory  one buffer  %-*s  %-*s  lacks\n", name_width, "name",
           platform_width, "platform");
    for (size_t i = 0; i < count; i++) {
        const asdic_device_info *info = &infos[i];
        char place[32];
        snprintf(place, sizeof place, "%u:%u", info->platform, info->device);
        printf("%c %-5s  %-5s  %5u", same_device(info, chosen) ? '*' : ' ', place,
               kind_name(info->kind), info->compute_units);
        print_size((double)info->global_bytes);
        print_size((double)info->max_alloc_bytes);
        printf("  %-*s  %-*s  %s\n", name_width, info->name, platform_width, info->platform_name,
               lacks(info)[0] ? lacks(info) : "-");
    }
    if (chosen) {
        printf("\n* is what '--device auto' takes.\n");
    }
}

static void print_json(const asdic_device_info *infos, size_t count,
                       const asdic_device_info *chosen) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '[');
    for (size_t i = 0; i < count; i++) {
        const asdic_device_info *info = &infos[i];
        char place[32];
        snprintf(place, sizeof place, "%u:%u", info->platform, info->device);
        json_open(&j, NULL, '{');
        json_text(&j, "device", place);
        json_text(&j, "name", info->name);
        json_text(&j, "kind", kind_name(info->kind));
        json_text(&j, "platform", info->platform_name);
        json_text(&j, "vendor", info->vendor);
        json_text(&j, "driver", info->driver);
        json_text(&j, "version", info->version);
        json_integer(&j, "compute_units", info->compute_units);
        json_integer(&j, "max_work_group", info->max_work_group);
        json_integer(&j, "global_bytes", info->global_bytes);
        json_integer(&j, "local_bytes", info->local_bytes);
        json_integer(&j, "max_alloc_bytes", info->max_alloc_bytes);
        json_bool(&j, "fp64", info->has_fp64);
        json_bool(&j, "int64_atomics", info->has_int64_atomics);
        json_bool(&j, "usable", info->usable);
        json_text(&j, "lacks", lacks(info));
        json_bool(&j, "auto", same_device(info, chosen));
        json_close(&j);
    }
    json_close(&j);
}

static int run(cli *c) {
    asdic_device_info *infos = NULL;
    asdic_device **devices = NULL;
    size_t count = 0, opened = 0;

    asdic_kernel_cache_prepare(cli_context(c));
    asdic_status status = asdic_device_list(cli_context(c), &infos, &count);
    if (status != ASDIC_OK) {
        return cli_end(c, status);
    }
    status = asdic_devices_open(cli_context(c), "auto", &devices, &opened);
    const asdic_device_info *chosen = opened ? asdic_device_get_info(devices[0]) : NULL;
    if (cli_given(c, "json")) {
        print_json(infos, count, chosen);
    } else if (count > 0) {
        print_table(infos, count, chosen);
    }
    asdic_devices_close(&devices, opened);
    asdic_device_info_free(&infos);
    return cli_end(c, status);
}

const cli_command cli_devices_command = {
    .name = "devices",
    .operands = "",
    .summary = "list the OpenCL devices, and what each lacks",
    .details = "P:D is what --device takes. Without a usable device the exit code is 4.",
    .examples = "asdic devices\n"
                "asdic run scene.yaml --device 0:0",
    .traits = CLI_HAS_JSON,
    .run = run,
};
