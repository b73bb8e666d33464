/*
 * What the parts of `asdic serve` share: poses from lines, answers to lines.
 */
#ifndef ASDIC_CLI_SERVE_H
#define ASDIC_CLI_SERVE_H

#include "cli.h"

#define SERVE_MAX_FIELDS 32
#define SERVE_WHY_SIZE 256

enum { SERVE_TIME, SERVE_X, SERVE_Y, SERVE_Z, SERVE_ROLL, SERVE_PITCH, SERVE_YAW, SERVE_COLUMNS };

/* The columns of a track file: "time_s", "x_m", ... */
extern const char *const serve_columns[SERVE_COLUMNS];

/* How values of a line without names are assigned: as the last header said. */
typedef struct serve_reader {
    bool has_header;
    int column[SERVE_MAX_FIELDS]; /* which column a field holds; -1: none of ours */
    size_t fields;
} serve_reader;

typedef struct serve_request {
    double value[SERVE_COLUMNS]; /* as written: m, degrees; NAN: not given */
    asdic_pose pose;
} serve_request;

typedef enum serve_line { SERVE_POSE, SERVE_NOTHING, SERVE_BAD } serve_line;

serve_reader serve_reader_begin(void);

/* Reads one line of LENGTH bytes without its end: a JSON object when it begins with '{', else comma-separated
 * values or their header. SERVE_NOTHING: a blank line or a header. SERVE_BAD: WHY tells what is
 * wrong. */
serve_line serve_read_line(serve_reader *reader, const char *line, size_t length,
                           serve_request *out, char why[SERVE_WHY_SIZE]);

/* {"x_m": 1, "z_m": 2, ...} into VALUE, NAN where it is not given or null; other names are skipped, whatever they
 * hold, unless one seems meant for a value that is not given, or none is known. False: WHY tells what is wrong. */
bool serve_read_object(const char *line, double value[SERVE_COLUMNS], char why[SERVE_WHY_SIZE]);

typedef enum serve_format { SERVE_JSON, SERVE_CSV, SERVE_RAW } serve_format;

typedef struct serve_writer {
    FILE *out;
    serve_format format;
    const asdic_sonar *sonar;
    size_t bins;
    double bin_length_m;
    bool has_expected, has_detections;
} serve_writer;

/* What a line gets. */
typedef struct serve_answer {
    const asdic_loop_ping *ping;
    const float *expected_db;           /* NULL: not asked for */
    const asdic_scan_result *detection; /* NULL: not asked for, or not yet */
} serve_answer;

/* A raw answer: this, then ARRAYS times beams x bins floats [beam][bin]: level; expected level, and
 * the log-likelihood ratios of what was detected (else NaN), when asked for. All little-endian. */
typedef struct serve_frame {
    char magic[4];   /* "ASDP" */
    uint32_t status; /* 0, or 1 for a line that could not be served: its floats are NaN */
    uint64_t ping;
    double time_s, altitude_m, bin_length_m;
    uint32_t beams, bins, arrays, line; /* line of the request, from 1 */
} serve_frame;

/* What goes before the first answer. */
void serve_write_head(const serve_writer *w);

/* REQUEST has a time, given or counted. */
void serve_write_ping(const serve_writer *w, uint64_t line, const serve_request *request,
                      const serve_answer *answer);
void serve_write_error(const serve_writer *w, uint64_t line, const char *why);

/* Whether bin CELL, [beam * bins + bin], exceeds the detector's threshold. */
bool serve_is_detected(const serve_answer *answer, size_t cell);

/* --- ROS 2 ------------------------------------------------------------------------------------ */

typedef struct serve_ros2_options {
    const char *pose_topic; /* "/asdic/pose" */
    bool is_odometry;       /* else PoseStamped */
    const char *out_topics; /* "/asdic": what is before "/sonar", "/image", "/detections" */
    bool is_reliable, has_sim_time, has_detections;
} serve_ros2_options;

/* Makes pings: MAKE answers a pose, or fills WHY when there is no ping from there; DETECT, which takes longer, adds what
 * is detected to that answer. */
typedef struct serve_pinger {
    asdic_status (*make)(void *server, const asdic_pose *pose, serve_answer *out,
                         char why[SERVE_WHY_SIZE]);
    asdic_status (*detect)(void *server, serve_answer *answer);
    void *server;
    double period_s; /* between pings */
} serve_pinger;

/* Serves topics in place of lines until it is interrupted; the program's exit code. ABOUT: world_frame is
 * that which poses must name. Of the module "ros2". */
int serve_ros2(cli *c, const serve_ros2_options *options, const asdic_ros_about *about,
               const serve_pinger *pinger);

#endif
