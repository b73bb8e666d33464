#include "targets.h"

const fuzz_target fuzz_targets[] = {
    {"scene", fuzz_scene},
    {"track", fuzz_track},
    {"grid", fuzz_grid},
    {"obj", fuzz_obj},
    {"off", fuzz_off},
    {"ply", fuzz_ply},
    {"stl", fuzz_stl},
    {"facts", fuzz_facts},
    {"records", fuzz_records},
    {"chart_data", fuzz_chart_data},
    {"arguments", fuzz_arguments},
    {"serve", fuzz_serve},
    {NULL, NULL},
};
