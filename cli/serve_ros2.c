#include "ros2_node.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* So long a signal may wait. */
#define TICK_MS 100
/* Who publishes poses and a clock is found topic by topic: so long poses may come alone. */
#define CLOCK_PATIENCE_NS INT64_C(2000000000)

typedef struct ros2_server {
    cli *c;
    const serve_ros2_options *options;
    const serve_pinger *pinger;
    asdic_ros *ros;
    ros2_node *node;
    size_t cells;
    bool *detected;
    int64_t period_ns, due_ns, last_ns; /* by the poses' stamps */
    int64_t made_ns;                    /* when the last ping was, by this machine's clock */
    int64_t without_clock_ns;           /* when the first pose came; 0: none did */
    uint64_t pings, passed;
    const char *frame;
    bool told_frame, told_refusal, told_clock;
} ros2_server;

static int64_t clock_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* When the ping is: the pose's time, or /clock's; false before the first clock. */
static bool find_time(ros2_server *s, const asdic_ros_stamped *pose, int64_t *out) {
    *out = pose->time_ns;
    bool good = !s->options->has_sim_time || ros2_node_clock(s->node, out);
    if (!good && !s->without_clock_ns) {
        s->without_clock_ns = clock_ns();
    }
    if (!good && !s->told_clock && clock_ns() - s->without_clock_ns > CLOCK_PATIENCE_NS) {
        cli_warning(s->c, "there are poses but no /clock yet; --sim-time waits for it");
        s->told_clock = true;
    }
    return good;
}

/* The sonar pings at its own rate, however often poses come: the first pose within a tenth of the
 * period of the next ping's time is it. Time that leaps back begins anew. A stamp of 0 is ROS's "no
 * time", or a simulator's first: after another one poses are timed by when they come. */
static bool is_due(ros2_server *s, int64_t time_ns) {
    bool is_untimed = !s->options->has_sim_time && time_ns == 0 && s->last_ns == 0;
    bool leapt = time_ns < s->last_ns;
    int64_t now_ns = clock_ns();
    int64_t left_ns = is_untimed ? s->made_ns + s->period_ns - now_ns : s->due_ns - time_ns;
    if (s->pings && !leapt && left_ns > s->period_ns / 10) {
        return false;
    }
    bool is_late = !s->pings || leapt || is_untimed || left_ns < -s->period_ns;
    s->due_ns = (is_late ? time_ns : s->due_ns) + s->period_ns;
    s->last_ns = time_ns;
    s->made_ns = now_ns;
    return true;
}

static bool is_of_the_frame(ros2_server *s, const asdic_ros_stamped *pose) {
    bool good = strcmp(pose->frame, s->frame) == 0;
    if (!good && !s->told_frame) {
        cli_warning(s->c,
                    "'%s' has poses in the frame '%s', not '%s': they are not used; --frame takes "
                    "them where that is east, north, up from the sea surface",
                    s->options->pose_topic, pose->frame, s->frame);
        s->told_frame = true;
    }
    return good;
}

/* An output is made for those who hear it alone: detections take longer than a ping. */
static bool is_heard(const ros2_server *s, asdic_ros_output output) {
    return (output != ASDIC_ROS_DETECTIONS || s->options->has_detections) &&
           asdic_ros_has(s->ros, output) && ros2_node_is_heard(s->node, output);
}

static asdic_status detect(ros2_server *s, serve_answer *answer) {
    asdic_status status = s->pinger->detect(s->pinger->server, answer);
    for (size_t i = 0; !status && i < s->cells; i++) {
        s->detected[i] = serve_is_detected(answer, i);
    }
    return status;
}

static asdic_status send(ros2_server *s, serve_answer *answer, int64_t time_ns) {
    const asdic_ros_ping ping = {.time_ns = time_ns,
                                 .ping = answer->ping->ping,
                                 .vehicle = answer->ping->pose,
                                 .level_db = answer->ping->level_db,
                                 .detected = s->detected};
    const asdic_ros_output order[] = {ASDIC_ROS_HEAD, ASDIC_ROS_SONAR, ASDIC_ROS_PICTURE,
                                      ASDIC_ROS_DETECTIONS};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        const void *bytes;
        size_t size;
        bool is_sent = is_heard(s, order[i]);
        /* A scan's picture wants every ping, heard or not; its head costs nothing. */
        bool is_made = is_sent || (order[i] == ASDIC_ROS_HEAD && asdic_ros_has(s->ros, order[i]));
        asdic_status status =
            is_sent && order[i] == ASDIC_ROS_DETECTIONS ? detect(s, answer) : ASDIC_OK;
        if (!status && is_made) {
            status = asdic_ros_encode(s->ros, order[i], &ping, &bytes, &size);
        }
        if (status) {
            return status;
        }
        if (is_sent && !ros2_node_publish(s->node, order[i], bytes, size)) {
            return ASDIC_ERROR_IO;
        }
    }
    s->pings++;
    return ASDIC_OK;
}

static asdic_status serve_pose(ros2_server *s, const asdic_ros_stamped *pose) {
    serve_answer answer;
    char why[SERVE_WHY_SIZE] = "";
    int64_t time_ns;
    if (!is_of_the_frame(s, pose) || !find_time(s, pose, &time_ns) || !is_due(s, time_ns)) {
        return ASDIC_OK;
    }
    asdic_status status = s->pinger->make(s->pinger->server, &pose->pose, &answer, why);
    if (status) {
        return status;
    }
    if (*why) {
        if (!s->told_refusal) { /* once, until a ping succeeds: poses come often */
            cli_warning(s->c, "'%s': %s; no pings from there", s->options->pose_topic, why);
        }
        s->told_refusal = true;
        return ASDIC_OK;
    }
    s->told_refusal = false;
    return send(s, &answer, time_ns);
}

static int serve(ros2_server *s) {
    asdic_context *ctx = cli_context(s->c);
    asdic_status status = ASDIC_OK;
    const serve_ros2_options *o = s->options;
    cli_note(s->c, "poses from %s (%s), pings to %s/...; Ctrl-C ends it", o->pose_topic,
             o->is_odometry ? "nav_msgs/msg/Odometry" : "geometry_msgs/msg/PoseStamped",
             o->out_topics);
    while (!status && !asdic_context_interrupted(ctx)) {
        asdic_ros_stamped pose;
        ros2_node_wait(s->node, TICK_MS);
        if (ros2_node_take_pose(s->node, &pose, &s->passed)) {
            status = serve_pose(s, &pose);
        }
        ros2_node_look_around(s->node);
    }
    cli_note(s->c, "%llu pings; %llu poses were passed over while one was made",
             (unsigned long long)s->pings, (unsigned long long)s->passed);
    if (status == ASDIC_ERROR_IO) { /* told */
        return CLI_FAILED;
    }
    return cli_end(s->c, status ? status : ASDIC_ERROR_INTERRUPTED);
}

int serve_ros2(cli *c, const serve_ros2_options *options, const asdic_ros_about *about,
               const serve_pinger *pinger) {
    ros2_server s = {.c = c,
                     .options = options,
                     .pinger = pinger,
                     .cells = about->sonar->receiver_count * about->bins,
                     .period_ns = (int64_t)(1e9 * pinger->period_s),
                     .frame = about->world_frame};
    int code = CLI_FAILED;
    asdic_status status = asdic_ros_create(cli_context(c), about, &s.ros);
    s.detected = calloc(s.cells, sizeof *s.detected);
    if (status || !s.detected) {
        code = cli_end(c, status ? status : ASDIC_ERROR_MEMORY);
    } else if (ros2_node_open(c, options, s.ros, &s.node)) {
        code = serve(&s);
        ros2_node_close(&s.node);
    }
    asdic_ros_destroy(&s.ros);
    free(s.detected);
    return code;
}
