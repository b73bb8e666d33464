/* Answers: one line of JSON or CSV, or one raw frame, for every line that asks. */
#include "serve.h"

#include "json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "frames are written as they lie");
_Static_assert(sizeof(serve_frame) == 56, "frames are packed");

static size_t cells_of(const serve_writer *w) {
    return w->sonar->receiver_count * w->bins;
}

/* NONE where there is no number. */
static void put_number(FILE *out, double value, const char *none) {
    char digits[32];
    if (isfinite(value)) {
        snprintf(digits, sizeof digits, "%.15g", value);
        if (strtod(digits, NULL) != value) {
            snprintf(digits, sizeof digits, "%.17g", value);
        }
        fputs(digits, out);
    } else {
        fputs(none, out);
    }
}

static void put_level(FILE *out, float level_db, const char *none) {
    if (isfinite(level_db)) {
        fprintf(out, "%.9g", (double)level_db);
    } else {
        fputs(none, out);
    }
}

static void put_json_levels(const serve_writer *w, const char *name, const float *level_db) {
    fprintf(w->out, ",\"%s\":{", name);
    for (size_t b = 0; b < w->sonar->receiver_count; b++) {
        fputs(b ? "," : "", w->out);
        json_string(w->out, w->sonar->receivers[b].name);
        fputs(":[", w->out);
        for (size_t n = 0; n < w->bins; n++) {
            fputs(n ? "," : "", w->out);
            put_level(w->out, level_db[b * w->bins + n], "null");
        }
        fputc(']', w->out);
    }
    fputc('}', w->out);
}

bool serve_is_detected(const serve_answer *answer, size_t cell) {
    return answer->ping->parts->intensity_lin[ASDIC_TOTAL][cell] >
           answer->detection->threshold_lin[cell];
}

static void put_json_detections(const serve_writer *w, const serve_answer *answer) {
    const char *comma = "";
    fputs(",\"detections\":[", w->out);
    for (size_t i = 0; i < cells_of(w); i++) {
        if (serve_is_detected(answer, i)) {
            fprintf(w->out, "%s{\"beam\":", comma);
            json_string(w->out, w->sonar->receivers[i / w->bins].name);
            fprintf(w->out, ",\"range_m\":");
            put_number(w->out, ((double)(i % w->bins) + 0.5) * w->bin_length_m, "null");
            fprintf(w->out, ",\"llr\":%.9g}", answer->detection->llr[i]);
            comma = ",";
        }
    }
    fputc(']', w->out);
}

static double head_deg(const asdic_loop_ping *ping) {
    size_t direction = asdic_sweep_direction(&ping->sweep, ping->ping);
    return cli_degrees(asdic_sweep_bearing_rad(&ping->sweep, direction));
}

static void write_json(const serve_writer *w, const serve_request *request,
                       const serve_answer *answer) {
    const asdic_loop_ping *ping = answer->ping;
    fprintf(w->out, "{\"ping\":%" PRIu64 ",\"time_s\":", ping->ping);
    put_number(w->out, request->value[SERVE_TIME], "null");
    for (int i = SERVE_X; i < SERVE_COLUMNS; i++) {
        fprintf(w->out, ",\"%s\":", serve_columns[i]);
        put_number(w->out, request->value[i], "null");
    }
    if (ping->sweep.directions) {
        fputs(",\"head_deg\":", w->out);
        put_number(w->out, head_deg(ping), "null");
    }
    fputs(",\"altitude_m\":", w->out);
    put_number(w->out, ping->altitude_m, "null");
    fputs(",\"bin_length_m\":", w->out);
    put_number(w->out, ping->bin_length_m, "null");
    put_json_levels(w, "level_db", ping->level_db);
    if (w->has_expected) {
        put_json_levels(w, "expected_db", answer->expected_db);
    }
    if (w->has_detections) {
        put_json_detections(w, answer);
    }
    fputs("}\n", w->out);
}

static void put_csv_levels(const serve_writer *w, const float *level_db) {
    for (size_t i = 0; i < cells_of(w); i++) {
        fputc(',', w->out);
        if (level_db) {
            put_level(w->out, level_db[i], "");
        }
    }
}

/* "forward:24.75 forward:25.25", beam and range. */
static void put_csv_detections(const serve_writer *w, const serve_answer *answer) {
    const char *blank = "";
    fputs(",\"", w->out);
    for (size_t i = 0; answer && i < cells_of(w); i++) {
        if (serve_is_detected(answer, i)) {
            fprintf(w->out, "%s%s:%.15g", blank, w->sonar->receivers[i / w->bins].name,
                    ((double)(i % w->bins) + 0.5) * w->bin_length_m);
            blank = " ";
        }
    }
    fputc('"', w->out);
}

static void write_csv(const serve_writer *w, const serve_request *request,
                      const serve_answer *answer) {
    const asdic_loop_ping *ping = answer->ping;
    fprintf(w->out, "%" PRIu64 ",", ping->ping);
    put_number(w->out, request->value[SERVE_TIME], "");
    for (int i = SERVE_X; i < SERVE_COLUMNS; i++) {
        fputc(',', w->out);
        put_number(w->out, request->value[i], "");
    }
    fputc(',', w->out);
    put_number(w->out, ping->altitude_m, "");
    fputc(',', w->out);
    put_csv_levels(w, ping->level_db);
    if (w->has_expected) {
        put_csv_levels(w, answer->expected_db);
    }
    if (w->has_detections) {
        put_csv_detections(w, answer);
    }
    fputc('\n', w->out);
}

static void put_csv_names(const serve_writer *w, const char *prefix) {
    for (size_t b = 0; b < w->sonar->receiver_count; b++) {
        for (size_t n = 0; n < w->bins; n++) {
            fprintf(w->out, ",%s%s_%zu", prefix, w->sonar->receivers[b].name, n);
        }
    }
}

void serve_write_head(const serve_writer *w) {
    if (w->format != SERVE_CSV) {
        return;
    }
    fputs("ping,time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg,altitude_m,error", w->out);
    put_csv_names(w, "");
    if (w->has_expected) {
        put_csv_names(w, "expected_");
    }
    fputs(w->has_detections ? ",detections\n" : "\n", w->out);
}

static serve_frame frame_of(const serve_writer *w, uint64_t line) {
    return (serve_frame){.magic = {'A', 'S', 'D', 'P'},
                         .bin_length_m = w->bin_length_m,
                         .beams = (uint32_t)w->sonar->receiver_count,
                         .bins = (uint32_t)w->bins,
                         .arrays = 1u + w->has_expected + w->has_detections,
                         .line = (uint32_t)line};
}

static void write_raw(const serve_writer *w, uint64_t line, const serve_request *request,
                      const serve_answer *answer) {
    serve_frame frame = frame_of(w, line);
    frame.ping = answer->ping->ping;
    frame.time_s = request->value[SERVE_TIME];
    frame.altitude_m = answer->ping->altitude_m;
    fwrite(&frame, sizeof frame, 1, w->out);
    fwrite(answer->ping->level_db, sizeof(float), cells_of(w), w->out);
    if (w->has_expected) {
        fwrite(answer->expected_db, sizeof(float), cells_of(w), w->out);
    }
    for (size_t i = 0; w->has_detections && i < cells_of(w); i++) {
        float llr = serve_is_detected(answer, i) ? (float)answer->detection->llr[i] : NAN;
        fwrite(&llr, sizeof llr, 1, w->out);
    }
}

void serve_write_ping(const serve_writer *w, uint64_t line, const serve_request *request,
                      const serve_answer *answer) {
    if (w->format == SERVE_JSON) {
        write_json(w, request, answer);
    } else if (w->format == SERVE_CSV) {
        write_csv(w, request, answer);
    } else {
        write_raw(w, line, request, answer);
    }
}

void serve_write_error(const serve_writer *w, uint64_t line, const char *why) {
    if (w->format == SERVE_JSON) {
        fprintf(w->out, "{\"error\":");
        json_string(w->out, why);
        fprintf(w->out, ",\"line\":%" PRIu64 "}\n", line);
    } else if (w->format == SERVE_CSV) {
        fputs(",,,,,,,,,\"", w->out);
        for (const char *p = why; *p; p++) {
            fputs(*p == '"' ? "\"\"" : (char[2]){*p, 0}, w->out);
        }
        fputc('"', w->out);
        put_csv_levels(w, NULL);
        if (w->has_expected) {
            put_csv_levels(w, NULL);
        }
        if (w->has_detections) {
            put_csv_detections(w, NULL);
        }
        fputc('\n', w->out);
    } else {
        serve_frame frame = frame_of(w, line);
        float nothing = NAN;
        frame.status = 1;
        frame.time_s = frame.altitude_m = NAN;
        fwrite(&frame, sizeof frame, 1, w->out);
        for (size_t i = 0; i < frame.arrays * cells_of(w); i++) {
            fwrite(&nothing, sizeof nothing, 1, w->out);
        }
    }
}
