#include "commands.h"
#include "serve.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most characters of a line: a whole message with what other sensors saw is less. The buffer begins with the usual, and
 * grows with the lines. */
#define MAX_LINE ((size_t)1 << 24)
#define USUAL_LINE 4096

static const cli_option options[] = {
    {"format", 'f', "FORMAT", "json, csv or raw: the form of answers; default json"},
    {"expected", 0, NULL, "also the expected level without objects, by quadrature"},
    {"detect", 0, NULL, "also what exceeds the expected level, by the scene's detector"},
    {"rays", 0, "N", "rays per ping, instead of the scene's"},
    {"seed", 0, "N", "random seed, instead of the scene's"},
    {"ros2", 0, NULL, "poses from and pings to topics of ROS 2, in place of lines"},
    {"pose-topic", 0, "NAME", "of poses; default /asdic/pose"},
    {"pose-type", 0, "TYPE", "odometry or pose: nav_msgs/Odometry, the default, or PoseStamped"},
    {"topics", 0, "NAME", "of pings: NAME/sonar, NAME/image, NAME/detections; default /asdic"},
    {"frame", 0, "NAME", "that poses must be in, east, north, up; default map"},
    {"vehicle-frame", 0, "NAME", "that a scanned head turns in, on /tf; default base_link"},
    {"sonar-frame", 0, "NAME", "that pings are in; default sonar"},
    {"reliable", 0, NULL, "pings for subscribers that ask for reliable delivery, too"},
    {"sim-time", 0, NULL, "stamps from /clock, not the pose's"},
    {NULL, 0, NULL, NULL},
};

typedef struct server {
    cli *c;
    asdic_mission *mission;
    asdic_loop *loop;
    serve_reader reader;
    serve_writer writer;
    asdic_lookout *lookout;  /* NULL: neither is asked for */
    float *expected_db;      /* NULL: not asked for */
    asdic_loop_ping ping;    /* the last, ... */
    asdic_scan_result found; /* ... and what was detected in it */
    uint64_t line;
    double ahead_s; /* what the client's clock has over the scene's */
} server;

/* Lines from standard input, without stdio, so that a signal ends the wait. */
typedef struct line_source {
    char *buffer; /* of SIZE bytes and a zero */
    size_t size, begin, end;
    size_t searched; /* before here no line ends */
    bool is_over, is_too_long;
} line_source;

/* Makes room for more of a line that fills the buffer: a larger one, or all of it when the line is too long. */
static int make_room(line_source *in) {
    if (in->size == MAX_LINE + 1) { /* with the line's end */
        in->is_too_long = true;
        in->end = in->searched = 0;
        return 0;
    }
    size_t size = in->size ? 2 * in->size : USUAL_LINE;
    size = size < MAX_LINE ? size : MAX_LINE + 1;
    char *buffer = realloc(in->buffer, size + 1);
    in->buffer = buffer ? buffer : in->buffer;
    in->size = buffer ? size : in->size;
    return buffer ? 0 : ENOMEM;
}

/* More bytes into the buffer. False at the end, or when CTX was asked to stop. */
static bool refill(line_source *in, asdic_context *ctx, int *error) {
    struct pollfd waits[2] = {{.fd = STDIN_FILENO, .events = POLLIN}, {.fd = cli_signal_fd()}};
    memmove(in->buffer, in->buffer + in->begin, in->end - in->begin);
    in->end -= in->begin;
    in->searched -= in->begin;
    in->begin = 0;
    while (!asdic_context_interrupted(ctx)) {
        ssize_t got = poll(waits, 2, -1);
        if (got > 0 && !waits[0].revents) {
            return false; /* a signal */
        }
        got = got < 0 ? got : read(STDIN_FILENO, in->buffer + in->end, in->size - in->end);
        if (got > 0) {
            in->end += (size_t)got;
            return true;
        }
        if (got == 0 || errno != EINTR) {
            *error = got == 0 ? 0 : errno;
            return false;
        }
    }
    return false;
}

/* The next line with a terminating zero, and its LENGTH; NULL when there is none. Of a line that is too long the end is
 * given. A last line without a line end counts. */
static const char *next_line(line_source *in, asdic_context *ctx, size_t *length, int *error) {
    *error = 0;
    for (;;) {
        char *from = in->buffer + in->begin;
        char *end = memchr(in->buffer + in->searched, '\n', in->end - in->searched);
        in->searched = in->end;
        if (!end && in->begin == 0 && in->end == in->size) {
            *error = make_room(in);
            if (*error) {
                return NULL;
            }
            continue;
        }
        if (!end && !in->is_over && refill(in, ctx, error)) {
            continue;
        }
        if (!end) {
            bool is_stopped = *error || asdic_context_interrupted(ctx);
            in->is_over = true;
            if (is_stopped || (in->begin == in->end && !in->is_too_long)) {
                return NULL;
            }
            from = in->buffer + in->begin; /* refill moved it */
            end = in->buffer + in->end;
            in->begin = in->end;
        } else {
            in->begin = in->searched = (size_t)(end + 1 - in->buffer);
        }
        end -= end > from && end[-1] == '\r';
        *end = '\0';
        *length = (size_t)(end - from);
        return from;
    }
}

static asdic_status expect(server *s) {
    const double *total_lin;
    TRY(asdic_lookout_expect(s->lookout, &s->ping, &total_lin));
    for (size_t i = 0; i < s->ping.beams * s->ping.bins; i++) {
        double level_db = asdic_level_db(total_lin[i]);
        s->expected_db[i] = isfinite(level_db) ? (float)level_db : NAN;
    }
    return ASDIC_OK;
}

/* Answers a line that cannot be served. */
static void refuse(server *s, const char *why) {
    serve_write_error(&s->writer, s->line, why);
    cli_warning(s->c, "line %llu: %s", (unsigned long long)s->line, why);
}

/* A ping at POSE, in ANSWER until the next; or WHY there is none. */
static asdic_status make_ping(void *user, const asdic_pose *pose, serve_answer *answer,
                              char why[SERVE_WHY_SIZE]) {
    server *s = user;
    asdic_loop_ping *ping = &s->ping;
    double z_m = pose->position_m.z;
    double bottom_m = asdic_mission_bottom_m(asdic_mission_scene(s->mission), pose->position_m);
    if (z_m > bottom_m + 1e-6 * fabs(bottom_m)) {
        snprintf(why, SERVE_WHY_SIZE, "the sonar is at z = %.6g m, below the bottom at %.6g m", z_m,
                 bottom_m);
        return ASDIC_OK;
    }
    asdic_status status = asdic_loop_submit(s->loop, pose);
    if (status == ASDIC_ERROR_ARGUMENT) { /* no place for a vehicle */
        snprintf(why, SERVE_WHY_SIZE, "%s", asdic_context_error(cli_context(s->c)));
        return ASDIC_OK;
    }
    TRY(status);
    TRY(asdic_loop_collect(s->loop, ping));
    *answer = (serve_answer){.ping = ping};
    return ASDIC_OK;
}

/* What is detected in the last ping, into its ANSWER. */
static asdic_status detect(void *user, serve_answer *answer) {
    server *s = user;
    TRY(asdic_lookout_detect(s->lookout, answer->ping, &s->found));
    answer->detection = &s->found;
    return ASDIC_OK;
}

/* A line without a time goes on from the last that had one. */
static void tell_time(server *s, serve_request *request) {
    double *time_s = &request->value[SERVE_TIME];
    s->ahead_s = isnan(*time_s) ? s->ahead_s : *time_s - s->ping.time_s;
    *time_s = isnan(*time_s) ? s->ping.time_s + s->ahead_s : *time_s;
}

static asdic_status ping_at(server *s, serve_request *request) {
    serve_answer answer;
    char why[SERVE_WHY_SIZE] = "";
    TRY(make_ping(s, &request->pose, &answer, why));
    if (*why) {
        refuse(s, why);
    } else {
        if (s->writer.has_expected) {
            TRY(expect(s));
            answer.expected_db = s->expected_db;
        }
        if (s->writer.has_detections) {
            TRY(detect(s, &answer));
        }
        tell_time(s, request);
        serve_write_ping(&s->writer, s->line, request, &answer);
    }
    return ASDIC_OK;
}

/* Whether stdout still accepts data; main reports the reason when it does not. */
static bool flush(server *s) {
    return fflush(s->writer.out) == 0 && !ferror(s->writer.out);
}

static int serve(server *s) {
    line_source in = {.begin = 0};
    asdic_status status = ASDIC_OK;
    int error = make_room(&in);
    serve_write_head(&s->writer);
    while (!error && flush(s) && !status) {
        size_t length = 0;
        const char *line = next_line(&in, cli_context(s->c), &length, &error);
        serve_request request;
        char why[SERVE_WHY_SIZE] = "";
        if (!line) {
            break;
        }
        s->line++;
        if (s->line == 1) {
            size_t mark = asdic_utf8_mark(line, length);
            line += mark;
            length -= mark;
        }
        serve_line kind =
            in.is_too_long ? SERVE_BAD : serve_read_line(&s->reader, line, length, &request, why);
        if (in.is_too_long) {
            snprintf(why, sizeof why, "the line is longer than %zu characters", MAX_LINE);
            in.is_too_long = false;
        }
        if (kind == SERVE_BAD) {
            refuse(s, why);
        } else if (kind == SERVE_POSE) {
            status = ping_at(s, &request);
        }
    }
    free(in.buffer);
    if (error) {
        cli_error(s->c, "cannot read standard input: %s", strerror(error));
        return CLI_FAILED;
    }
    if (!status && asdic_context_interrupted(cli_context(s->c))) {
        status = ASDIC_ERROR_INTERRUPTED;
    }
    return cli_end(s->c, status);
}

static asdic_status start(server *s, asdic_device *device) {
    asdic_context *ctx = cli_context(s->c);
    const asdic_sonar *sonar = asdic_mission_sonar(s->mission);
    double start_s, depth_m = asdic_mission_pose(s->mission, 0, &start_s).position_m.z;
    TRY(asdic_loop_create_mission(ctx, device, s->mission, depth_m, start_s, &s->loop));
    s->writer.sonar = sonar;
    s->writer.bins = asdic_loop_bin_count(s->loop);
    s->writer.bin_length_m = sonar->bin_length_m;
    if (s->writer.has_expected || s->writer.has_detections) {
        TRY(asdic_lookout_create(ctx, s->mission, s->writer.bins, &s->lookout));
    }
    if (s->writer.has_expected) {
        s->expected_db = malloc(sonar->receiver_count * s->writer.bins * sizeof(float));
        TRY(s->expected_db ? ASDIC_OK : ASDIC_ERROR_MEMORY);
    }
    return ASDIC_OK;
}

static const char *text_or(cli *c, const char *option, const char *fallback) {
    return cli_given(c, option) ? cli_text(c, option) : fallback;
}

/* A whole name, as the wire has it: ROS 2 makes one of the parts that a node's own names lack. No part of it
 * begins with a digit: design.ros2.org, "Topic and Service name mapping to DDS". */
static bool is_topic(const char *name) {
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/";
    size_t length = strlen(name);
    bool begins = true; /* a part does, after each '/' */
    for (const char *at = name; (at = strchr(at, '/')); at++) {
        begins = begins && !strchr("/0123456789", at[1]);
    }
    return name[0] == '/' && begins && length < 200 && strspn(name, allowed) == length;
}

static int serve_topics(server *s, bool is_odometry) {
    asdic_ros_about about = asdic_ros_about_default();
    serve_ros2_options topics = {.pose_topic = "/asdic/pose", .out_topics = "/asdic"};
    const asdic_sonar *sonar = asdic_mission_sonar(s->mission);
    const serve_pinger pinger = {make_ping, detect, s, 1.0 / sonar->ping_rate_hz};
    double start_s, depth_m = asdic_mission_pose(s->mission, 0, &start_s).position_m.z;
    topics.is_odometry = is_odometry;
    topics.is_reliable = cli_given(s->c, "reliable");
    topics.has_sim_time = cli_given(s->c, "sim-time");
    topics.has_detections = s->writer.has_detections;
    topics.pose_topic = text_or(s->c, "pose-topic", topics.pose_topic);
    topics.out_topics = text_or(s->c, "topics", topics.out_topics);
    about.world_frame = text_or(s->c, "frame", about.world_frame);
    about.vehicle_frame = text_or(s->c, "vehicle-frame", about.vehicle_frame);
    about.sonar_frame = text_or(s->c, "sonar-frame", about.sonar_frame);
    about.sonar = sonar;
    about.sweep = asdic_mission_sweep(s->mission);
    about.bins = s->writer.bins;
    about.sound_speed_mps =
        asdic_environment_sound_speed_mps(asdic_mission_environment(s->mission), depth_m);
    __typeof__(serve_ros2) *by_topics = cli_module(s->c, "ros2", "serve_ros2");
    return by_topics ? by_topics(s->c, &topics, &about, &pinger) : CLI_FAILED;
}

/* What goes with topics alone, and with lines alone. */
static bool check_topics(cli *c) {
    static const char *const only[] = {"pose-topic",    "pose-type",   "topics",   "frame",
                                       "vehicle-frame", "sonar-frame", "reliable", "sim-time"};
    static const char *const names[] = {"pose-topic", "topics"};
    const char *word = NULL;
    for (size_t i = 0; i < sizeof only / sizeof *only && !cli_given(c, "ros2"); i++) {
        word = cli_given(c, only[i]) ? only[i] : word;
    }
    if (word) {
        cli_usage(c, "--%s goes with --ros2", word);
        return false;
    }
    if (cli_given(c, "ros2") && (cli_given(c, "format") || cli_given(c, "expected"))) {
        cli_usage(c, "--format and --expected go with lines, not with --ros2");
        return false;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *name = cli_text(c, names[i]);
        if (name && !is_topic(name)) {
            cli_usage(c,
                      "--%s: '%s' is no topic: '/' and letters, '_', digits but not first, as "
                      "/auv/pose",
                      names[i], name);
            return false;
        }
    }
    return true;
}

static int run(cli *c) {
    static const char *const formats[] = {"json", "csv", "raw", NULL};
    static const char *const pose_types[] = {"odometry", "pose", NULL};
    server s = {.c = c, .reader = serve_reader_begin(), .writer = {.out = stdout}};
    uint64_t rays = 0, seed = 0;
    int format = SERVE_JSON, pose_type = 0;
    cli_choice(c, "format", formats, &format);
    cli_choice(c, "pose-type", pose_types, &pose_type);
    cli_integer(c, "rays", 64, 1u << 28, &rays);
    cli_integer(c, "seed", 0, UINT64_MAX, &seed);
    if (cli_bad_usage(c)) {
        return CLI_USAGE;
    }
    if (!check_topics(c)) {
        return CLI_USAGE;
    }
    if (strcmp(cli_operand(c, 0), "-") == 0) {
        return cli_usage(c, "poses come on standard input; the scene must be a file");
    }
    s.writer.format = (serve_format)format;
    s.writer.has_expected = cli_given(c, "expected");
    s.writer.has_detections = cli_given(c, "detect");
    asdic_device **devices = NULL;
    size_t device_count = 0;
    asdic_status status = cli_load_rays(c, rays, &s.mission);
    if (!status) {
        asdic_sampling *sampling = asdic_mission_sampling(s.mission);
        sampling->seed = cli_given(c, "seed") ? seed : sampling->seed;
        status = cli_open_devices(c, &devices, &device_count);
    }
    status = status ? status : start(&s, devices[0]);
    int code = status                 ? cli_end(c, status)
               : cli_given(c, "ros2") ? serve_topics(&s, pose_type == 0)
                                      : serve(&s);
    asdic_loop_destroy(&s.loop);
    asdic_lookout_destroy(&s.lookout);
    free(s.expected_db);
    asdic_devices_close(&devices, device_count);
    asdic_mission_destroy(&s.mission);
    return code;
}

const cli_command cli_serve_command = {
    .name = "serve",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "be the sonar of a vehicle simulator: a pose a line in, a ping out",
    .details =
        "Reads one pose per line from standard input and answers each with one ping, at once. A "
        "line is a JSON object, {\"x_m\": 0, \"y_m\": 0, \"z_m\": 7, \"yaw_deg\": 90}, or "
        "comma-separated "
        "values in the order of a track file, time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg, or of "
        "a header that was sent before. x_m, y_m, z_m are needed, angles are 0 when not given; "
        "time_s is repeated in the answer, and counted on when it is not given; null is not given. "
        "Other names are passed over with all that they hold, so that whole messages may be sent, "
        "up to 16 MiB a line; "
        "but a number under a name that seems meant for a value that is not given is an error: "
        "one spelt nearly so, yaw or heading_deg for yaw_deg, depth_m for z_m, any other in _deg "
        "or _rad where an angle is missing; so is an attitude in another form, as qx or "
        "orientation. The scene's own "
        "mission gives the first depth alone; objects with a track move by 1 / ping_rate_hz from "
        "ping to ping, whatever time_s says.\n\n"
        "json: an object a line with \"level_db\", an array for each beam; null where there is no "
        "energy; of a scanned sonar also \"head_deg\", the angle of its head from the bow to "
        "starboard. csv: a header, then a line per ping with its levels beam by beam. raw: 56 "
        "bytes, little-endian (\"ASDP\"; uint32 status; uint64 ping; double time_s, altitude_m, "
        "bin_length_m; uint32 beams, bins, arrays, line), then float32 [arrays][beam][bin].\n\n"
        "--expected is of a place on a grid, 1 mm in altitude and depth, rounded down, and 1e-4 "
        "degrees in roll and pitch: within 0.1 dB in nearly all bins, but not in the first of a "
        "plane's echo, of which a bin may hold up to a mm more. "
        "--detect adds what exceeds the expected level by more than the scene's detector allows "
        "(detector.pfa): in JSON \"detections\" with beam, range_m and llr, the logarithm of the "
        "likelihood ratio; in CSV a last column of beam:range; raw a last array, NaN where nothing "
        "was "
        "detected. Over a bottom from a mesh or grid bins are held against their neighbours "
        "(OS-CFAR), as in trials; false alarms are then more than detector.pfa where levels step. "
        "A new altitude, roll or pitch takes longer than a ping of many beams.\n\n"
        "A line that cannot be served is answered as well: an object with \"error\" and \"line\", "
        "a "
        "line whose 'error' is filled, or a frame of status 1 full of NaN; the next line is "
        "served. "
        "Blank lines and headers are not answered. At the end of the input the program ends with "
        "code 0.\n\n"
        "--ros2 subscribes to poses (nav_msgs/Odometry or geometry_msgs/PoseStamped) and publishes "
        "marine_acoustic_msgs/ProjectedSonarImage, the fan as sensor_msgs/Image and, with "
        "--detect, "
        "SonarDetections: as ROS 2 has them on the wire, by Cyclone DDS, without ROS. Poses are "
        "east, "
        "north, up; the newest counts, and the sonar pings at its own rate. ROS_DOMAIN_ID, "
        "ROS_LOCALHOST_ONLY and CYCLONEDDS_URI work as in ROS 2. Ctrl-C ends it.\n\n"
        "Angles are rounded to whole nanodegrees. A run of the scene with model: {terms: all, "
        "refraction: full} and "
        "a "
        "track that holds the same poses, one per ping, gives the same levels to the last bit.",
    .examples = "echo '{\"x_m\": 0, \"y_m\": 0, \"z_m\": 7}' | asdic serve scene.yaml --detect\n"
                "asdic serve scene.yaml --format csv < poses.csv > levels.csv\n"
                "asdic serve scene.yaml --ros2 --pose-topic /auv/odometry --detect",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_INTERRUPTIBLE,
    .run = run,
};
