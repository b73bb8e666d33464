/*
 * ROS 2's messages that come in: poses in bytes written out here by hand, in both orders, cut short
 * and with numbers that are no place. What goes out is tested on files (tests/cli/test_mcap.py).
 */
#include "asserts.h"
#include "test_context.h"

#include "base/vec.h"
#include "out/ros_cdr.h"

#include <asdic/ros.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define DEGREE (ASDIC_PI / 180.0)

typedef struct message {
    uint8_t bytes[1024];
    size_t size;
    bool is_big;
} message;

/* A number of SIZE bytes in the message's order, at a multiple of its size behind the head. */
static void put(message *m, const void *number, size_t size) {
    while ((m->size - 4) % size) {
        m->bytes[m->size++] = 0;
    }
    for (size_t i = 0; i < size; i++) {
        m->bytes[m->size++] = ((const uint8_t *)number)[m->is_big ? size - 1 - i : i];
    }
}

static void put_text(message *m, const char *text) {
    uint32_t length = (uint32_t)strlen(text) + 1;
    put(m, &length, sizeof length);
    memcpy(m->bytes + m->size, text, length);
    m->size += length;
}

/* Up to the pose itself. */
static message begin(bool is_big, const char *frame) {
    message m = {.bytes = {0, is_big ? 0 : 1}, .size = 4, .is_big = is_big};
    int32_t sec = 1700000000;
    uint32_t nanosec = 250000000;
    put(&m, &sec, sizeof sec);
    put(&m, &nanosec, sizeof nanosec);
    put_text(&m, frame);
    return m;
}

static void put_doubles(message *m, const double *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        put(m, &values[i], sizeof values[i]);
    }
}

static message stamped(bool is_big, const double pose[7]) {
    message m = begin(is_big, "map");
    put_doubles(&m, pose, 7);
    return m;
}

static message odometry(bool is_big, const double pose[7]) {
    message m = begin(is_big, "odom");
    const double zeros[36] = {0.0};
    put_text(&m, "base_link");
    put_doubles(&m, pose, 7);
    put_doubles(&m, zeros, 36);
    put_doubles(&m, zeros, 6);
    put_doubles(&m, zeros, 36);
    return m;
}

static void check_pose(const asdic_ros_stamped *got, double roll_deg, double pitch_deg,
                       double yaw_deg) {
    asdic_mat3 found =
        asdic_mat3_attitude(got->pose.roll_rad, got->pose.pitch_rad, got->pose.yaw_rad);
    asdic_mat3 wanted =
        asdic_mat3_attitude(roll_deg * DEGREE, pitch_deg * DEGREE, yaw_deg * DEGREE);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            assert_close(found.m[i][k], wanted.m[i][k], 1e-7);
        }
    }
}

/* By hand: about z counter-clockwise from east; about x starboard down; about y bow down. */
static void quaternions_become_headings(void **state) {
    (void)state;
    const double h = sqrt(0.5), s15 = sin(15.0 * DEGREE), c15 = cos(15.0 * DEGREE);
    const struct {
        double q[4];
        double roll_deg, pitch_deg, yaw_deg;
    } rows[] = {
        {{0, 0, 0, 1}, 0, 0, 90},          /* bow east */
        {{0, 0, h, h}, 0, 0, 0},           /* north */
        {{0, 0, 1, 0}, 0, 0, -90},         /* west */
        {{0, 0, -h, h}, 0, 0, 180},        /* south */
        {{0, 0, -1, 0}, 0, 0, -90},        /* west again: -q is q */
        {{s15, 0, 0, c15}, 30, 0, 90},     /* starboard down */
        {{0, s15, 0, c15}, 0, -30, 90},    /* bow down */
        {{0, -h, 0, h}, 0, 90, 90},        /* bow straight up */
        {{0, h, 0, h}, 0, -90, 90},        /* and down */
        {{0.5, -0.5, 0.5, 0.5}, 0, 90, 0}, /* north, then bow up: (0, 0, h, h)(0, -h, 0, h) */
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double *q = rows[i].q, pose[7] = {20, 10, -7, q[0], q[1], q[2], q[3]};
        for (int is_big = 0; is_big < 2; is_big++) {
            message both[2] = {stamped(is_big, pose), odometry(is_big, pose)};
            for (int k = 0; k < 2; k++) {
                asdic_ros_stamped got;
                assert_int_equal(
                    asdic_ros_decode_pose(ctx, k == 1, both[k].bytes, both[k].size, &got), 0);
                assert_true(got.time_ns == INT64_C(1700000000250000000));
                assert_string_equal(got.frame, k == 1 ? "odom" : "map");
                assert_close(got.pose.position_m.x, 10.0, 0.0);
                assert_close(got.pose.position_m.y, 20.0, 0.0);
                assert_close(got.pose.position_m.z, 7.0, 0.0);
                check_pose(&got, rows[i].roll_deg, rows[i].pitch_deg, rows[i].yaw_deg);
            }
        }
    }
}

static void check_refused(bool is_odometry, const message *m, size_t size) {
    asdic_ros_stamped got;
    assert_int_equal(asdic_ros_decode_pose(ctx, is_odometry, m->bytes, size, &got),
                     ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), is_odometry
                                                  ? "bytes are no nav_msgs/msg/Odometry"
                                                  : "bytes are no geometry_msgs/msg/PoseStamped");
}

static void what_is_cut_short_is_refused(void **state) {
    (void)state;
    const double pose[7] = {1, 2, -3, 0, 0, 0, 1};
    message both[2] = {stamped(false, pose), odometry(false, pose)};
    for (int k = 0; k < 2; k++) {
        for (size_t size = 0; size < both[k].size; size++) {
            check_refused(k == 1, &both[k], size);
        }
    }
    message m = stamped(false, pose);
    for (uint8_t i = 2; i < 8; i++) { /* other encodings */
        m.bytes[1] = i;
        check_refused(false, &m, m.size);
    }
    m = stamped(false, pose);
    m.bytes[0] = 1;
    check_refused(false, &m, m.size);
    m = stamped(false, pose);
    memset(m.bytes + 12, 0xff, 4); /* a name of 4 GiB */
    check_refused(false, &m, m.size);
    memset(m.bytes + 12, 0, 4); /* a name without its zero */
    check_refused(false, &m, m.size);
    m = stamped(false, pose);
    m.bytes[12] = 3; /* the name's zero is its fourth letter */
    check_refused(false, &m, m.size);
}

/* Numbers alone are aligned: where a list has none, there is nothing to align. */
static void an_empty_list_is_its_length_alone(void **state) {
    (void)state;
    struct lists {
        struct {
            const void *items;
            size_t count;
        } doubles;
        uint8_t last;
    } some = {{(const double[]){1.0, 2.0}, 2}, 7};
    const asdic_ros_field fields[] = {
        {.offset = 0, .kind = ASDIC_ROS_F64, .form = ASDIC_ROS_SEQUENCE},
        {.offset = offsetof(struct lists, last), .count = 1, .kind = ASDIC_ROS_U8}};
    const asdic_ros_type type = {.fields = fields, .field_count = 2, .bytes = sizeof some};
    const uint8_t full[] = {0, 1, 0, 0,    2,    0, 0, 0, 0, 0, 0, 0, 0,    0, 0,
                            0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40, 7};
    asdic_bytes out = {0};
    asdic_ros_write(&out, &type, &some);
    assert_int_equal(out.size, sizeof full);
    assert_memory_equal(out.bytes, full, sizeof full);
    some.doubles.count = 0;
    asdic_ros_write(&out, &type, &some);
    assert_int_equal(out.size, 9);
    assert_memory_equal(out.bytes, "\0\1\0\0\0\0\0\0\7", 9);
    assert_false(asdic_ros_read(&type, out.bytes, out.size, &some)); /* it has a list */
    asdic_bytes_finish(&out);
    assert_null(out.bytes);
}

static void what_is_no_place_is_refused(void **state) {
    (void)state;
    const double rows[][7] = {{NAN, 0, 0, 0, 0, 0, 1},
                              {0, 0, INFINITY, 0, 0, 0, 1},
                              {0, 0, 0, 0, 0, 0, 0},
                              {0, 0, 0, 0, 0, NAN, 1},
                              {0, 0, 0, 1, 1, 0, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        message m = stamped(false, rows[i]);
        asdic_ros_stamped got;
        assert_int_equal(asdic_ros_decode_pose(ctx, false, m.bytes, m.size, &got),
                         ASDIC_ERROR_INPUT);
        assert_non_null(strstr(asdic_context_error(ctx), "a quaternion of length 1"));
    }
}

/* The sender's rounding is forgiven, to a hundredth of the length. */
static void a_quaternions_length_is_nearly_1(void **state) {
    (void)state;
    const struct {
        double length;
        bool good;
    } rows[] = {{0.989, false}, {0.991, true}, {1.009, true}, {1.011, false}, {-0.991, true}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double part = 0.5 * rows[i].length;
        const double pose[7] = {0, 0, 0, part, -part, part, part};
        message m = stamped(false, pose);
        asdic_ros_stamped got;
        assert_int_equal(asdic_ros_decode_pose(ctx, false, m.bytes, m.size, &got),
                         rows[i].good ? ASDIC_OK : ASDIC_ERROR_INPUT);
        if (rows[i].good) {
            check_pose(&got, 0, 90, 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quaternions_become_headings),
        cmocka_unit_test(what_is_cut_short_is_refused),
        cmocka_unit_test(an_empty_list_is_its_length_alone),
        cmocka_unit_test(what_is_no_place_is_refused),
        cmocka_unit_test(a_quaternions_length_is_nearly_1),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
