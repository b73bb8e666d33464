/*
 * From a scene file to waterfalls: what `asdic run SCENE.yaml -o FOLDER` does.
 *
 *     cc waterfall.c -o waterfall $(pkg-config --cflags --libs asdic)
 *     ./waterfall mission.yaml out
 */
#include <asdic/asdic.h>
#include <stdio.h>

int main(int argc, char **argv) {
    if (argc != 3)
        return fprintf(stderr, "usage: waterfall SCENE.yaml FOLDER\n"), 2;
    asdic_context *ctx = NULL;
    asdic_device **devices = NULL;
    asdic_mission *mission = NULL;
    size_t count = 0;
    asdic_run_options options = asdic_run_options_default();
    options.folder = argv[2];
    options.force = true;
    asdic_status status = asdic_context_create(&ctx);
    if (!status)
        status = asdic_mission_load(ctx, argv[1], &mission);
    if (!status)
        status = asdic_devices_open(ctx, "auto", &devices, &count);
    if (!status)
        status = asdic_mission_run(ctx, mission, devices, count, &options);
    if (status)
        fprintf(stderr, "waterfall: %s\n", asdic_context_error(ctx));
    asdic_mission_destroy(&mission);
    asdic_devices_close(&devices, count);
    asdic_context_destroy(&ctx);
    return status;
}
