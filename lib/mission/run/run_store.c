#include "run_store.h"

#include "base/context.h"
#include "base/try.h"
#include "run_records.h"

#include <asdic/plan.h>

#include <stdlib.h>

struct asdic_store {
    asdic_context *ctx;
    asdic_store_shape shape;
    asdic_records *levels, *truth; /* truth NULL: the run has none */
    void *stored;                  /* levels as in the file, where they lie otherwise in memory */
};

asdic_record_layout asdic_store_layout(const asdic_settings *settings, size_t beams, size_t bins,
                                       unsigned left_out) {
    static const asdic_term terms[ASDIC_COMPONENT_COUNT] = {
        [ASDIC_BOTTOM] = ASDIC_TERM_BOTTOM, [ASDIC_SURFACE] = ASDIC_TERM_SURFACE,
        [ASDIC_VOLUME] = ASDIC_TERM_VOLUME, [ASDIC_OBJECT] = ASDIC_TERM_OBJECTS,
        [ASDIC_NOISE] = ASDIC_TERM_NOISE,   [ASDIC_MULTIPATH] = ASDIC_TERM_MULTIPATH};
    asdic_record_layout layout = {
        .beams = beams, .bins = bins, .form = settings->records, .truth = settings->sampling.truth};
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        bool is_kept = c != ASDIC_TOTAL && !(left_out & 1u << terms[c]);
        layout.parts |= is_kept ? 1u << c : 0u;
    }
    return layout;
}

static asdic_status open_levels(asdic_store *store, const char *folder, asdic_store_mode mode) {
    char dtype[ASDIC_RECORD_DTYPE_SIZE];
    const asdic_record_layout *layout = &store->shape.layout;
    const asdic_records_shape shape = {"pings.npy", dtype, "", asdic_record_stored_bytes(layout)};
    asdic_record_dtype(dtype, layout);
    store->stored = layout->form == ASDIC_RECORD_FULL ? NULL : malloc(shape.bytes);
    if (!store->stored && layout->form != ASDIC_RECORD_FULL) {
        return asdic_fail_memory(store->ctx, "a record");
    }
    return asdic_records_open(store->ctx, folder, mode, &shape, &store->levels);
}

static asdic_status open_truth(asdic_store *store, const char *folder, asdic_store_mode mode) {
    char dtype[ASDIC_RECORD_DTYPE_SIZE];
    const asdic_record_layout *layout = &store->shape.layout;
    const asdic_records_shape shape = {ASDIC_TRUTH_NAME, dtype, "",
                                       asdic_record_truth_bytes(layout)};
    asdic_record_truth_dtype(dtype, layout);
    return layout->truth ? asdic_records_open(store->ctx, folder, mode, &shape, &store->truth)
                         : ASDIC_OK;
}

asdic_status asdic_store_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                              const asdic_store_shape *shape, asdic_store **out) {
    asdic_store *store = *out = calloc(1, sizeof *store);
    if (!store) {
        return asdic_fail_memory(ctx, "a run's records");
    }
    *store = (asdic_store){.ctx = ctx, .shape = *shape};
    asdic_status status = open_levels(store, folder, mode);
    status = status ? status : open_truth(store, folder, mode);
    if (status != ASDIC_OK) {
        asdic_store_close(out);
    }
    return status;
}

size_t asdic_store_count(const asdic_store *store) {
    size_t levels = asdic_records_count(store->levels);
    size_t truth = store->truth ? asdic_records_count(store->truth) : levels;
    return levels < truth ? levels : truth;
}

asdic_status asdic_store_write(asdic_store *store, size_t index, void *bytes) {
    const asdic_record_layout *layout = &store->shape.layout;
    void *stored = store->stored ? store->stored : bytes;
    if (store->truth) { /* first: a ping whose levels are there has its truth */
        TRY(asdic_records_write(store->truth, index, asdic_record_store_truth(layout, bytes)));
    }
    asdic_record_store(layout, bytes, stored);
    TRY(asdic_records_write(store->levels, index, stored));
    asdic_record_restore(layout, stored, bytes);
    return ASDIC_OK;
}

/* RECORD, of BYTES, as it was written for ping INDEX? */
static asdic_status check(const asdic_store *store, const asdic_records *records, size_t index,
                          const void *record, size_t bytes) {
    uint64_t ping = store->shape.first_ping + index;
    return asdic_record_is_whole(record, bytes, ping)
               ? ASDIC_OK
               : asdic_fail(store->ctx, ASDIC_ERROR_INPUT,
                            "'%s' is damaged: ping %llu is not as it was written",
                            asdic_records_path(records), (unsigned long long)ping);
}

asdic_status asdic_store_read(asdic_store *store, size_t index, void *bytes) {
    const asdic_record_layout *layout = &store->shape.layout;
    void *stored = store->stored ? store->stored : bytes;
    TRY(asdic_records_read(store->levels, index, stored));
    TRY(check(store, store->levels, index, stored, asdic_record_stored_bytes(layout)));
    asdic_record_restore(layout, stored, bytes);
    if (!store->truth) {
        return ASDIC_OK;
    }
    void *truth = asdic_record_truth(layout, bytes);
    TRY(asdic_records_read(store->truth, index, truth));
    return check(store, store->truth, index, truth, asdic_record_truth_bytes(layout));
}

asdic_status asdic_store_cut(asdic_store *store, size_t count) {
    TRY(store->truth ? asdic_records_cut(store->truth, count) : ASDIC_OK);
    return asdic_records_cut(store->levels, count);
}

asdic_status asdic_store_commit(asdic_store *store) {
    TRY(store->truth ? asdic_records_commit(store->truth) : ASDIC_OK);
    return asdic_records_commit(store->levels);
}

void asdic_store_close(asdic_store **store) {
    asdic_store *s = store ? *store : NULL;
    if (!s) {
        return;
    }
    asdic_records_close(&s->levels);
    asdic_records_close(&s->truth);
    free(s->stored);
    free(s);
    *store = NULL;
}
