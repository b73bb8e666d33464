/*
 * Which beams of a scene find its object, and with what probability: what `asdic roc` does.
 *
 *     cc detect.c -o detect $(pkg-config --cflags --libs asdic)
 *     ./detect scenario2.yaml rise
 */
#include <asdic/asdic.h>
#include <stdio.h>

int main(int argc, char **argv) {
    asdic_context *ctx = NULL;
    asdic_device **devices = NULL;
    asdic_mission *mission = NULL;
    asdic_roc *roc = NULL;
    size_t device_count = 0;
    asdic_status status = argc == 3 ? asdic_context_create(&ctx) : ASDIC_ERROR_ARGUMENT;
    if (!status) {
        status = asdic_devices_open(ctx, "auto", &devices, &device_count);
    }
    if (!status) {
        status = asdic_mission_load(ctx, argv[1], &mission);
    }
    size_t beams = status ? 0 : asdic_mission_sonar(mission)->receiver_count;
    for (size_t b = 0; b < beams && !status; b++) {
        asdic_roc_options options = asdic_roc_options_default();
        options.object = argv[2];
        options.beam = asdic_mission_sonar(mission)->receivers[b].name;
        options.trials = 100000;
        status = asdic_roc_compute(ctx, mission, devices[0], &options, &roc);
        if (!status) {
            printf("%s: %.2f m, %.1f dB, P_FA %g, P_D %.4f (%.4f to %.4f), area %.5f\n", roc->beam,
                   roc->range_m, roc->snr_db, roc->pfa, roc->pd.value, roc->pd.low, roc->pd.high,
                   roc->area.value);
        }
        asdic_roc_destroy(&roc);
    }
    if (status) {
        fprintf(stderr, "%s\n", ctx ? asdic_context_error(ctx) : "give a scene and an object");
    }
    asdic_mission_destroy(&mission);
    asdic_devices_close(&devices, device_count);
    asdic_context_destroy(&ctx);
    return status == ASDIC_ERROR_DEVICE ? 77 : status != ASDIC_OK;
}
