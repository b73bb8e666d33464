/* A run folder that somebody damaged: one of its files, beside good others. */
#include "scratch.h"
#include "targets.h"

#include <asdic/asdic.h>

#include "mission/run/run_facts.h"
#include "mission/run/run_chart_data.h"
#include "mission/run/run_store.h"
#include "out/record.h"

#include <stdlib.h>
#include <string.h>

#define BEAMS 2
#define BINS 3

static const char scene[] =
    "version: 1\nbottom: {depth_m: 12}\nsonar: {frequency_khz: 100, receivers: [{name: a}, "
    "{name: b}]}\nmission: {pose: {position_m: [0, 0, 5]}}\n";

/* The folder alone. */
static const char *folder(void) {
    static char path[128];
    strcpy(path, scratch_path(""));
    path[strlen(path) - 1] = 0;
    return path;
}

static void write_facts(asdic_context *ctx) {
    const asdic_run_facts facts = {.version = "1",
                                   .state = ASDIC_RUN_STOPPED,
                                   .scene_path = "s.yaml",
                                   .scene_hash = "1",
                                   .geometry_hash = "2",
                                   .scene_text = scene,
                                   .bottom = ASDIC_RUN_BOTTOM_PLANE,
                                   .bottom_law = asdic_material_bottom(2.0),
                                   .sampling = asdic_sampling_default(),
                                   .pings_planned = 2,
                                   .pings = 2,
                                   .beams = BEAMS,
                                   .bins = BINS,
                                   .bin_length_m = 0.5};
    if (asdic_run_facts_write(ctx, folder(), &facts) != ASDIC_OK) {
        abort();
    }
}

static void write_records(asdic_context *ctx) {
    const asdic_store_shape shape = {.layout = {.beams = BEAMS, .bins = BINS}};
    asdic_store *store = NULL;
    asdic_ping *ping = NULL;
    void *bytes = calloc(1, asdic_record_bytes(BEAMS, BINS));
    if (!bytes || asdic_ping_create(ctx, BEAMS, BINS, &ping) != ASDIC_OK ||
        asdic_store_open(ctx, folder(), ASDIC_STORE_CREATE, &shape, &store) != ASDIC_OK) {
        abort();
    }
    for (size_t i = 0; i < 2; i++) {
        const asdic_record_head head = {.ping = i};
        asdic_record_pack(&head, ping, bytes);
        if (asdic_store_write(store, i, bytes) != ASDIC_OK) {
            abort();
        }
    }
    if (asdic_store_commit(store) != ASDIC_OK) {
        abort();
    }
    asdic_store_close(&store);
    asdic_ping_destroy(&ping);
    free(bytes);
}

/* Opens the folder and reads whatever is there. */
static void read_all(asdic_context *ctx) {
    asdic_run *run = NULL;
    asdic_record record;
    asdic_status status = asdic_run_open(ctx, folder(), &run);
    if ((status == ASDIC_OK) != (run != NULL) || (!run && !asdic_context_error(ctx)[0])) {
        abort();
    }
    if (run) {
        asdic_run_info info = asdic_run_get_info(run);
        for (size_t i = 0; i < info.pings && i < 8; i++) {
            if (asdic_run_read(run, i, &record) == ASDIC_OK) {
                volatile float sum = record.stderr_db[info.beams * info.bins - 1];
                (void)sum;
                asdic_run_flat_scene(run, &record);
            }
        }
    }
    asdic_run_close(&run);
}

void fuzz_facts(const uint8_t *data, size_t size) {
    static bool is_prepared;
    asdic_context *ctx = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    if (!is_prepared) {
        write_records(ctx);
        is_prepared = true;
    }
    /* With the right sum, so that what stands before it is read. */
    char *text = malloc(size + 1);
    if (!text) {
        abort();
    }
    memcpy(text, data, size);
    asdic_run_facts_sign(text, size);
    scratch_write("run.json", (const uint8_t *)text, size);
    free(text);
    read_all(ctx);
    asdic_context_destroy(&ctx);
}

void fuzz_records(const uint8_t *data, size_t size) {
    static bool is_prepared;
    asdic_context *ctx = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    if (!is_prepared) {
        write_facts(ctx);
        is_prepared = true;
    }
    scratch_write("pings.npy", data, size);
    read_all(ctx);
    asdic_context_destroy(&ctx);
}

/* terrain.asc and, behind lines "---", objects.csv and routes.csv. */
void fuzz_chart_data(const uint8_t *data, size_t size) {
    static const char mark[] = "---\n";
    asdic_context *ctx = NULL;
    asdic_chart_data chart;
    if (size == 0 || asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    static const char *const files[] = {"terrain.asc", "objects.csv", "routes.csv"};
    for (size_t i = 0; i < 3; i++) {
        const uint8_t *cut = memmem(data, size, mark, sizeof mark - 1);
        size_t length = cut ? (size_t)(cut - data) : size;
        size_t used = cut ? length + sizeof mark - 1 : size;
        scratch_write(files[i], data, length);
        data += used;
        size -= used;
    }
    asdic_status status = asdic_chart_data_read(ctx, folder(), &chart);
    if (status != ASDIC_OK && (!asdic_context_error(ctx)[0] || chart.outline_count)) {
        abort();
    }
    size_t cells = chart.relief.columns * chart.relief.rows;
    if (cells > 0) {
        volatile float last = chart.relief.depth_m[cells - 1];
        (void)last;
    }
    asdic_chart_data_finish(&chart);
    asdic_context_destroy(&ctx);
}
