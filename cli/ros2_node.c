#include "ros2_node.h"

#include "asdic_ros.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/q_protocol.h>

#include <stdlib.h>
#include <string.h>

/* Domains have ports of their own; from 233 on they would be beyond 65535 (DDSI-RTPS 2.5, 9.6.2). */
#define MOST_DOMAIN 232
/* ROS 2's sensor data: at most so many messages wait for a reader. */
#define DEPTH 5
#define CDR_HEAD 4
/* Nobody is missed before. */
#define PATIENCE_S 3

typedef struct channel {
    char name[256]; /* as ROS says it: "/asdic/sonar" */
    const dds_topic_descriptor_t *type;
    dds_entity_t end; /* reader or writer; 0: none */
    void *sample;
    bool was_told; /* that a quality of service does not go together */
} channel;

struct ros2_node {
    cli *c;
    unsigned domain;
    dds_entity_t participant, waitset, publications;
    channel pose, clock, outputs[ASDIC_ROS_OUTPUT_COUNT];
    bool is_odometry;
    asdic_ros_stamped stamped;
    char *pose_bytes; /* that STAMPED points into */
    bool has_time;
    int64_t time_ns;
    dds_time_t began;
    bool told_nobody, told_type, told_pose;
};

static const struct {
    const char *end; /* of the topic's name; NULL: not sent */
    const dds_topic_descriptor_t *type;
    bool is_shared; /* that is its whole name, and who listens asks for reliable delivery */
} outputs[ASDIC_ROS_OUTPUT_COUNT] = {
    [ASDIC_ROS_SONAR] = {"/sonar", &marine_acoustic_msgs_msg_dds__ProjectedSonarImage__desc, false},
    [ASDIC_ROS_PICTURE] = {"/image", &sensor_msgs_msg_dds__Image__desc, false},
    [ASDIC_ROS_DETECTIONS] = {"/detections", &marine_acoustic_msgs_msg_dds__SonarDetections__desc,
                              false},
    [ASDIC_ROS_HEAD] = {"/tf", &tf2_msgs_msg_dds__TFMessage__desc, true},
};

/* --- what the DDS says ------------------------------------------------------------------------ */

/* The last thing that Cyclone wrote, for the error that it leads to: it says why. */
static char last_words[256];

static void hear(void *user, const dds_log_data_t *said) {
    (void)user;
    const char *text = said->message; /* its header stands before it */
    size_t length = strcspn(text, "\n");
    length -= length && text[length - 1] == '.';
    snprintf(last_words, sizeof last_words, ": %.*s", (int)length, text);
}

/* "geometry_msgs::msg::dds_::Pose_" as "geometry_msgs/msg/Pose". */
static void ros_name(char out[128], const char *dds_name) {
    size_t n = 0;
    for (const char *p = dds_name; *p && n + 1 < 128; p++) {
        bool is_mark = strncmp(p, "dds_::", 6) == 0;
        bool is_colons = strncmp(p, "::", 2) == 0;
        p += is_mark ? 5 : is_colons ? 1 : 0;
        if (!is_mark && !(p[0] == '_' && p[1] == 0)) {
            out[n++] = is_colons ? '/' : *p;
        }
    }
    out[n] = 0;
}

/* --- opening ---------------------------------------------------------------------------------- */

static bool read_domain(cli *c, unsigned *out) {
    const char *text = getenv("ROS_DOMAIN_ID");
    char *end = NULL;
    unsigned long domain = text && *text ? strtoul(text, &end, 10) : 0;
    *out = (unsigned)domain;
    if ((end && (*end || *text < '0' || *text > '9')) || domain > MOST_DOMAIN) {
        cli_error(c, "ROS_DOMAIN_ID is '%s'; a DDS domain is a number from 0 to %d", text,
                  MOST_DOMAIN);
        return false;
    }
    return true;
}

/* As ROS 2's sensor data: best effort, volatile, the last few; RELIABLE writers serve both kinds of readers. */
static dds_qos_t *quality(bool is_reliable) {
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         DDS_MSECS(100));
    dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, DEPTH);
    return qos;
}

/* Topics of ROS are "rt" and their name. */
static bool open_channel(ros2_node *n, channel *ch, const dds_topic_descriptor_t *type,
                         bool is_reader, bool is_reliable) {
    char wire_name[sizeof ch->name + 2];
    dds_qos_t *qos = quality(is_reliable);
    snprintf(wire_name, sizeof wire_name, "rt%s", ch->name);
    ch->type = type;
    ch->sample = calloc(1, type->m_size);
    dds_entity_t topic = dds_create_topic(n->participant, type, wire_name, NULL, NULL);
    ch->end = topic < 0   ? topic
              : is_reader ? dds_create_reader(n->participant, topic, qos, NULL)
                          : dds_create_writer(n->participant, topic, qos, NULL);
    dds_delete_qos(qos);
    if (ch->end < 0 || !ch->sample) {
        cli_error(n->c, "the topic '%s' cannot be opened: %s%s", ch->name,
                  dds_strretcode(ch->end < 0 ? ch->end : DDS_RETCODE_OUT_OF_RESOURCES), last_words);
        return false;
    }
    return true;
}

/* Nothing but this machine, where ROS 2 is told so. */
static void stay_at_home(unsigned domain) {
    static const char here[] =
        "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces></General>";
    const char *asked = getenv("ROS_LOCALHOST_ONLY"), *own = getenv("CYCLONEDDS_URI");
    char *config = NULL;
    if (asked && strcmp(asked, "1") == 0 &&
        asprintf(&config, "%s%s%s", own ? own : "", own && *own ? "," : "", here) >= 0) {
        dds_create_domain(domain, config);
        free(config);
    }
}

static bool join(ros2_node *n) {
    if (!read_domain(n->c, &n->domain)) {
        return false;
    }
    dds_set_log_sink(hear, NULL);
    stay_at_home(n->domain);
    n->participant = dds_create_participant(n->domain, NULL, NULL);
    if (n->participant < 0) {
        cli_error(n->c,
                  "cannot join the DDS domain %u (ROS_DOMAIN_ID): %s%s; see the network, and "
                  "CYCLONEDDS_URI where that is set",
                  n->domain, dds_strretcode(n->participant), last_words);
        return false;
    }
    n->waitset = dds_create_waitset(n->participant);
    n->publications =
        dds_create_reader(n->participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
    n->began = dds_time();
    return true;
}

static bool open_all(ros2_node *n, const serve_ros2_options *o, const asdic_ros *ros) {
    const dds_topic_descriptor_t *pose = o->is_odometry ? &nav_msgs_msg_dds__Odometry__desc
                                                        : &geometry_msgs_msg_dds__PoseStamped__desc;
    if (!join(n)) {
        return false;
    }
    n->is_odometry = o->is_odometry;
    snprintf(n->pose.name, sizeof n->pose.name, "%s", o->pose_topic);
    snprintf(n->clock.name, sizeof n->clock.name, "/clock");
    if (!open_channel(n, &n->pose, pose, true, false) ||
        (o->has_sim_time &&
         !open_channel(n, &n->clock, &rosgraph_msgs_msg_dds__Clock__desc, true, false))) {
        return false;
    }
    dds_waitset_attach(n->waitset, dds_create_readcondition(n->pose.end, DDS_ANY_STATE), 0);
    for (unsigned i = 0; i < ASDIC_ROS_OUTPUT_COUNT; i++) {
        bool is_sent = outputs[i].end && asdic_ros_has(ros, i) &&
                       (i != ASDIC_ROS_DETECTIONS || o->has_detections);
        channel *ch = &n->outputs[i];
        snprintf(ch->name, sizeof ch->name, "%s%s", outputs[i].is_shared ? "" : o->out_topics,
                 outputs[i].end ? outputs[i].end : "");
        if (is_sent &&
            !open_channel(n, ch, outputs[i].type, false, o->is_reliable || outputs[i].is_shared)) {
            return false;
        }
    }
    return true;
}

bool ros2_node_open(cli *c, const serve_ros2_options *options, const asdic_ros *ros,
                    ros2_node **out) {
    *out = calloc(1, sizeof **out);
    if (!*out) {
        cli_error(c, "no memory for a node of ROS 2");
        return false;
    }
    (*out)->c = c;
    bool good = open_all(*out, options, ros);
    if (!good) {
        ros2_node_close(out);
    }
    return good;
}

static void free_sample(channel *ch) {
    if (ch->sample) {
        dds_sample_free(ch->sample, ch->type, DDS_FREE_CONTENTS);
        free(ch->sample);
    }
}

void ros2_node_close(ros2_node **node) {
    ros2_node *n = *node;
    if (n->participant > 0) {
        dds_delete(n->participant);
    }
    free_sample(&n->pose);
    free_sample(&n->clock);
    for (unsigned i = 0; i < ASDIC_ROS_OUTPUT_COUNT; i++) {
        free_sample(&n->outputs[i]);
    }
    free(n->pose_bytes);
    free(n);
    *node = NULL;
}

/* --- messages --------------------------------------------------------------------------------- */

void ros2_node_wait(ros2_node *n, unsigned ms) {
    dds_attach_t which;
    dds_waitset_wait(n->waitset, &which, 1, DDS_MSECS(ms));
}

/* A message as its bytes; false when it is none. */
static bool read_pose(ros2_node *n, struct ddsi_serdata *data) {
    uint32_t size = ddsi_serdata_size(data);
    char *bytes = realloc(n->pose_bytes, size);
    if (!bytes) {
        cli_warning(n->c, "no memory for a pose");
        return false;
    }
    n->pose_bytes = bytes;
    ddsi_serdata_to_ser(data, 0, size, bytes);
    asdic_context *ctx = cli_context(n->c);
    bool good = asdic_ros_decode_pose(ctx, n->is_odometry, bytes, size, &n->stamped) == ASDIC_OK;
    if (!good && !n->told_pose) { /* once, until a good one comes: poses come often */
        cli_warning(n->c, "%s: %s", n->pose.name, asdic_context_error(ctx));
    }
    n->told_pose = !good;
    return good;
}

bool ros2_node_take_pose(ros2_node *n, asdic_ros_stamped *out, uint64_t *passed) {
    struct ddsi_serdata *data[DEPTH];
    dds_sample_info_t info[DEPTH];
    dds_return_t count = dds_takecdr(n->pose.end, data, DEPTH, info, DDS_ANY_STATE);
    struct ddsi_serdata *newest = NULL;
    for (dds_return_t i = 0; i < count; i++) {
        if (!info[i].valid_data) {
            ddsi_serdata_unref(data[i]);
            continue;
        }
        if (newest) {
            ++*passed;
            ddsi_serdata_unref(newest);
        }
        newest = data[i];
    }
    bool good = newest && read_pose(n, newest);
    if (newest) {
        ddsi_serdata_unref(newest);
    }
    *out = n->stamped;
    return good;
}

bool ros2_node_clock(ros2_node *n, int64_t *time_ns) {
    void *sample = n->clock.sample;
    dds_sample_info_t info;
    while (dds_take(n->clock.end, &sample, &info, 1, 1) == 1) {
        const rosgraph_msgs_msg_dds__Clock_ *clock = sample;
        if (info.valid_data) {
            n->time_ns = (int64_t)clock->clock_.sec_ * 1000000000 + clock->clock_.nanosec_;
            n->has_time = true;
        }
    }
    *time_ns = n->time_ns;
    return n->has_time;
}

/* The bytes become a sample of the DDS, which sends the same bytes again. */
bool ros2_node_is_heard(const ros2_node *n, asdic_ros_output output) {
    dds_publication_matched_status_t status;
    return dds_get_publication_matched_status(n->outputs[output].end, &status) != DDS_RETCODE_OK ||
           status.current_count > 0;
}

bool ros2_node_publish(ros2_node *n, asdic_ros_output output, const void *bytes, size_t size) {
    channel *ch = &n->outputs[output];
    dds_istream_t in;
    dds_istream_init(&in, (uint32_t)(size - CDR_HEAD), (const char *)bytes + CDR_HEAD,
                     CDR_ENC_VERSION_1);
    dds_stream_read(&in, ch->sample, ch->type->m_ops);
    dds_istream_fini(&in);
    dds_return_t status = dds_write(ch->end, ch->sample);
    if (status == DDS_RETCODE_TIMEOUT) { /* a reliable reader that does not keep up */
        return true;
    }
    if (status != DDS_RETCODE_OK) {
        cli_error(n->c, "cannot publish '%s': %s%s", ch->name, dds_strretcode(status), last_words);
    }
    return status == DDS_RETCODE_OK;
}

/* --- who is there ----------------------------------------------------------------------------- */

/* Publishers of the pose's topic that have another type: the DDS does not bring them to us. */
static void look_at_types(ros2_node *n) {
    void *sample = NULL;
    dds_sample_info_t info;
    sample = NULL;
    while (dds_take(n->publications, &sample, &info, 1, 1) == 1) {
        const dds_builtintopic_endpoint_t *end = sample;
        if (info.valid_data && strncmp(end->topic_name, "rt", 2) == 0 &&
            strcmp(end->topic_name + 2, n->pose.name) == 0 &&
            strcmp(end->type_name, n->pose.type->m_typename) != 0 && !n->told_type) {
            char theirs[128], ours[128];
            ros_name(theirs, end->type_name);
            ros_name(ours, n->pose.type->m_typename);
            cli_warning(n->c, "'%s' is published as %s, and read as %s; --pose-type chooses",
                        n->pose.name, theirs, ours);
            n->told_type = true;
        }
        dds_return_loan(n->publications, &sample, 1);
        sample = NULL;
    }
}

static void look_for_poses(ros2_node *n) {
    dds_subscription_matched_status_t status;
    char type[128];
    if (n->told_nobody || dds_time() - n->began < DDS_SECS(PATIENCE_S) ||
        dds_get_subscription_matched_status(n->pose.end, &status) != DDS_RETCODE_OK) {
        return;
    }
    n->told_nobody = true;
    if (status.total_count == 0 && !n->told_type) {
        ros_name(type, n->pose.type->m_typename);
        cli_warning(n->c,
                    "nobody publishes '%s' (%s) in domain %u yet; pings begin when somebody does",
                    n->pose.name, type, n->domain);
    }
}

/* A best-effort writer has nothing for a reader that asks for more. */
static void look_for_subscribers(ros2_node *n) {
    for (unsigned i = 0; i < ASDIC_ROS_OUTPUT_COUNT; i++) {
        channel *ch = &n->outputs[i];
        dds_offered_incompatible_qos_status_t status;
        if (ch->end > 0 && !ch->was_told &&
            dds_get_offered_incompatible_qos_status(ch->end, &status) == DDS_RETCODE_OK &&
            status.total_count > 0) {
            ch->was_told = true;
            cli_warning(
                n->c,
                status.last_policy_id == DDS_RELIABILITY_QOS_POLICY_ID
                    ? "a subscriber of '%s' asks for reliable delivery and gets nothing; "
                      "--reliable serves it, or it asks for best effort"
                    : "a subscriber of '%s' asks for a quality of service that pings do not "
                      "have (volatile, no deadline) and gets nothing",
                ch->name);
        }
    }
}

void ros2_node_look_around(ros2_node *n) {
    look_at_types(n);
    look_for_poses(n);
    look_for_subscribers(n);
}
