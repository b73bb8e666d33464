/*
 * ROS 2's messages that go out, field by field as their packages define them: frames, times,
 * directions and levels by hand, pictures pixel by pixel. What comes in: test_ros.c.
 */
#include "asserts.h"
#include "test_context.h"

#include "base/vec.h"
#include "out/raster.h"
#include "out/ros_outputs.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SECOND INT64_C(1000000000)
#define SPEED_MPS 1500.0

enum { BEAMS = 3, BINS = 4, CELLS = BEAMS * BINS };

static const asdic_beam receivers[BEAMS] = {
    {.pitch_rad = 0.1, .yaw_rad = -0.3, .length_h_m = 0.1},
    {.yaw_rad = 0.0, .length_h_m = 0.05},
    {.pitch_rad = -0.2, .yaw_rad = 0.4, .length_h_m = 0.001}};
static float levels_db[CELLS];
static asdic_ros_ping ping = {.vehicle = {.position_m = {10.0, 20.0, 7.0}}, .level_db = levels_db};

static asdic_sonar sonar_of(size_t beams) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.frequency_hz = 100e3;
    sonar.bin_length_m = 0.5;
    sonar.transmitter.length_v_m = 0.04;
    sonar.receivers = receivers;
    sonar.receiver_count = beams;
    return sonar;
}

/* The same beams from starboard to port. */
static const asdic_beam *mirrored(void) {
    static asdic_beam beams[BEAMS];
    for (size_t b = 0; b < BEAMS; b++) {
        beams[b] = receivers[BEAMS - 1 - b];
    }
    return beams;
}

static asdic_ros *ros_of(const asdic_sonar *sonar, const asdic_sweep *sweep) {
    asdic_ros_about about = asdic_ros_about_default();
    asdic_ros *ros;
    about.sonar = sonar;
    about.sound_speed_mps = SPEED_MPS;
    about.bins = BINS;
    if (sweep) {
        about.sweep = *sweep;
    }
    assert_ok(ctx, asdic_ros_create(ctx, &about, &ros));
    return ros;
}

static asdic_ros *begin(void) {
    asdic_sonar sonar = sonar_of(BEAMS);
    return ros_of(&sonar, NULL);
}

/* --- a message in CDR ------------------------------------------------------------------------- */

typedef struct message {
    const uint8_t *bytes;
    size_t size, at;
} message;

static message encode(asdic_ros *ros, asdic_ros_output output) {
    message m = {.at = 4};
    const void *bytes;
    assert_ok(ctx, asdic_ros_encode(ros, output, &ping, &bytes, &m.size));
    m.bytes = bytes;
    assert_memory_equal(bytes, "\0\1\0\0", 4); /* CDR, the lowest byte first */
    return m;
}

/* A number of SIZE bytes, at a multiple of its size behind the four. */
static void take(message *m, void *out, size_t size) {
    while ((m->at - 4) % size) {
        assert_int_equal(m->bytes[m->at++], 0);
    }
    assert_true(m->at + size <= m->size);
    memcpy(out, m->bytes + m->at, size);
    m->at += size;
}

static uint32_t take_u32(message *m) {
    uint32_t value;
    take(m, &value, sizeof value);
    return value;
}

static float take_f32(message *m) {
    float value;
    take(m, &value, sizeof value);
    return value;
}

static double take_f64(message *m) {
    double value;
    take(m, &value, sizeof value);
    return value;
}

static void check_text(message *m, const char *text) {
    assert_int_equal(take_u32(m), strlen(text) + 1);
    assert_memory_equal(m->bytes + m->at, text, strlen(text) + 1);
    m->at += strlen(text) + 1;
}

static void check_header(message *m, const char *frame) {
    assert_int_equal(take_u32(m), 1700000000);
    assert_int_equal(take_u32(m), 250000000);
    check_text(m, frame);
}

static void check_end(const message *m) {
    assert_int_equal(m->at, m->size);
}

static void check_vector(message *m, double x, double y, double z) {
    assert_close(take_f64(m), x, 1e-15);
    assert_close(take_f64(m), y, 1e-15);
    assert_close(take_f64(m), z, 1e-15);
}

/* --- frames ----------------------------------------------------------------------------------- */

/* V turned by the quaternion X, Y, Z, W: v + 2 u x (u x v + w v). */
static void turn(const double q[4], const double v[3], double out[3]) {
    double t[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        t[i] = q[j] * v[k] - q[k] * v[j] + q[3] * v[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = v[i] + 2.0 * (q[j] * t[k] - q[k] * t[j]);
    }
}

/* The next four numbers turn forward, port, up to where the vehicle's axes lie in the world. */
static void check_vehicle(message *m) {
    const asdic_pose *p = &ping.vehicle;
    asdic_mat3 r = asdic_mat3_attitude(p->roll_rad, p->pitch_rad, p->yaw_rad);
    double q[4], got[3];
    for (int i = 0; i < 4; i++) {
        q[i] = take_f64(m);
    }
    for (int axis = 0; axis < 3; axis++) {
        const double v[3] = {axis == 0, axis == 1, axis == 2};
        double sign = axis == 0 ? 1.0 : -1.0; /* port and up are not starboard and down */
        turn(q, v, got);
        assert_close(got[0], sign * r.m[1][axis], 1e-14); /* east */
        assert_close(got[1], sign * r.m[0][axis], 1e-14); /* north */
        assert_close(got[2], -sign * r.m[2][axis], 1e-14);
    }
}

/* The sonar's z ahead, HEAD_RAD to starboard of the bow, y to its port, x down. */
static void check_head(message *m, double head_rad) {
    double q[4], got[3];
    const double axes[3][3] = {
        {0, 0, -1}, {sin(head_rad), cos(head_rad), 0}, {cos(head_rad), -sin(head_rad), 0}};
    for (int i = 0; i < 4; i++) {
        q[i] = take_f64(m);
    }
    for (int axis = 0; axis < 3; axis++) {
        const double v[3] = {axis == 0, axis == 1, axis == 2};
        turn(q, v, got);
        for (int i = 0; i < 3; i++) {
            assert_close(got[i], axes[axis][i], 1e-14);
        }
    }
}

static void check_transforms(asdic_ros *ros, double head_rad) {
    message m = encode(ros, ASDIC_ROS_TRANSFORMS);
    assert_int_equal(take_u32(&m), 2);
    check_header(&m, "map");
    check_text(&m, "base_link");
    check_vector(&m, 20.0, 10.0, -7.0);
    check_vehicle(&m);
    check_header(&m, "base_link");
    check_text(&m, "sonar");
    check_vector(&m, 0.0, 0.0, 0.0);
    check_head(&m, head_rad);
    check_end(&m);
    if (asdic_ros_has(ros, ASDIC_ROS_HEAD)) { /* its last step alone */
        m = encode(ros, ASDIC_ROS_HEAD);
        assert_int_equal(take_u32(&m), 1);
        check_header(&m, "base_link");
        check_text(&m, "sonar");
        check_vector(&m, 0.0, 0.0, 0.0);
        check_head(&m, head_rad);
        check_end(&m);
    }
}

static const asdic_sweep sweep = {.directions = 4, .step_rad = 0.2};

static void frames_lead_from_the_world_to_the_sonar(void **state) {
    (void)state;
    asdic_ros *ros = begin();
    asdic_sonar sonar = sonar_of(1);
    asdic_ros *scan = ros_of(&sonar, &sweep);
    ping.time_ns = 1700000000 * SECOND + 250000000;
    for (int i = 0; i < 3; i++) {
        ping.vehicle.roll_rad = 0.3 * i;
        ping.vehicle.pitch_rad = 0.5 - 0.4 * i;
        ping.vehicle.yaw_rad = 2.0 * i - 1.0;
        check_transforms(ros, 0.0);
        ping.ping = 1;
        check_transforms(scan, -0.1); /* the second of four: -0.3, -0.1, 0.1, 0.3 */
        ping.ping = 0;
        message m = encode(ros, ASDIC_ROS_POSE);
        asdic_ros_stamped back;
        assert_ok(ctx, asdic_ros_decode_pose(ctx, false, m.bytes, m.size, &back));
        assert_true(back.time_ns == ping.time_ns);
        assert_close(back.pose.roll_rad, ping.vehicle.roll_rad, 1e-14);
        assert_close(back.pose.pitch_rad, ping.vehicle.pitch_rad, 1e-14);
        assert_close(remainder(back.pose.yaw_rad - ping.vehicle.yaw_rad, 2.0 * ASDIC_PI), 0.0,
                     1e-14);
        check_header(&m, "map");
        check_vector(&m, 20.0, 10.0, -7.0);
        check_vehicle(&m);
        check_end(&m);
    }
    asdic_ros_destroy(&ros);
    assert_null(ros);
    asdic_ros_destroy(&ros);
    asdic_ros_destroy(&scan);
}

static void times_have_whole_seconds_below(void **state) {
    (void)state;
    const struct {
        int64_t time_ns;
        int32_t sec;
        uint32_t nanosec;
    } rows[] = {{0, 0, 0},           {SECOND, 1, 0},   {2 * SECOND - 1, 1, 999999999},
                {-1, -1, 999999999}, {-SECOND, -1, 0}, {-SECOND - 2, -2, 999999998}};
    asdic_ros *ros = begin();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        ping.time_ns = rows[i].time_ns;
        message m = encode(ros, ASDIC_ROS_POSE);
        assert_int_equal((int32_t)take_u32(&m), rows[i].sec);
        assert_int_equal(take_u32(&m), rows[i].nanosec);
    }
    ping.time_ns = 1700000000 * SECOND + 250000000;
    asdic_ros_destroy(&ros);
}

/* --- levels ----------------------------------------------------------------------------------- */

/* Half the power at either edge of the line's pattern sinc^2; all around where none has it. */
static void check_width(float width_rad, double length_m) {
    double x = ASDIC_PI * length_m * sin(0.5 * (double)width_rad) * 100e3 / SPEED_MPS;
    assert_close(sin(x) * sin(x) / (x * x), 0.5, 1e-4);
}

static void check_info(message *m) {
    assert_close(take_f32(m), 100e3, 0.0);
    assert_close(take_f32(m), SPEED_MPS, 0.0);
    assert_int_equal(take_u32(m), BEAMS); /* of the transmitter, for each beam */
    for (size_t b = 0; b < BEAMS; b++) {
        check_width(take_f32(m), 0.04);
    }
    assert_int_equal(take_u32(m), BEAMS);
    check_width(take_f32(m), 0.1);
    check_width(take_f32(m), 0.05);
    assert_close(take_f32(m), ASDIC_PI, 1e-6);
}

static void levels_go_range_by_range(void **state) {
    (void)state;
    asdic_ros *ros = begin();
    for (size_t i = 0; i < CELLS; i++) {
        levels_db[i] = i == 5 ? NAN : 60.5f + (float)i;
    }
    message m = encode(ros, ASDIC_ROS_SONAR);
    check_header(&m, "sonar");
    check_info(&m);
    assert_int_equal(take_u32(&m), BEAMS);
    check_vector(&m, sin(0.1), cos(0.1) * sin(0.3), cos(0.1) * cos(0.3)); /* down, port, ahead */
    check_vector(&m, 0.0, 0.0, 1.0);
    check_vector(&m, -sin(0.2), -cos(0.2) * sin(0.4), cos(0.2) * cos(0.4));
    assert_int_equal(take_u32(&m), BINS);
    for (size_t i = 0; i < BINS; i++) {
        assert_close(take_f32(&m), 0.25 + 0.5 * (double)i, 0.0);
    }
    assert_int_equal(m.bytes[m.at++], 0); /* little-endian */
    assert_int_equal(take_u32(&m), 8);    /* float32 */
    assert_int_equal(take_u32(&m), BEAMS);
    assert_int_equal(take_u32(&m), CELLS * sizeof(float));
    for (size_t i = 0; i < CELLS; i++) {
        size_t cell = i % BEAMS * BINS + i / BEAMS;
        float level = take_f32(&m);
        assert_true(cell == 5 ? isnan(level) : level == levels_db[cell]);
    }
    check_end(&m);
    asdic_ros_destroy(&ros);
}

static void detections_say_when_and_where(void **state) {
    (void)state;
    const bool found[CELLS] = {[1] = true, [4] = true, [11] = true};
    const size_t cells[] = {1, 4, 11};
    asdic_ros *ros = begin();
    for (size_t i = 0; i < CELLS; i++) {
        levels_db[i] = 60.5f + (float)i;
    }
    for (int again = 0; again < 2; again++) {
        ping.detected = found;
        message m = encode(ros, ASDIC_ROS_DETECTIONS);
        check_header(&m, "sonar");
        check_info(&m);
        assert_int_equal(take_u32(&m), 3);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(m.bytes[m.at++], 0); /* good */
        }
        for (int list = 0; list < 5; list++) {
            assert_int_equal(take_u32(&m), 3);
            for (int i = 0; i < 3; i++) {
                const asdic_beam *beam = &receivers[cells[i] / BINS];
                double range_m = 0.25 + 0.5 * (double)(cells[i] % BINS);
                const double values[5] = {range_m / 750.0, 0.0, 60.5 + (double)cells[i],
                                          -beam->pitch_rad, beam->yaw_rad};
                assert_close(take_f32(&m), values[list], 1e-7);
            }
        }
        check_end(&m);
    }
    ping.detected = NULL;
    asdic_ros_destroy(&ros);
}

/* --- pictures --------------------------------------------------------------------------------- */

/* The image, whose pixels follow; the farthest bin ends 400 pixels from the sonar. */
static const uint8_t *check_image(asdic_ros *ros, size_t width, size_t height) {
    message m = encode(ros, ASDIC_ROS_PICTURE);
    check_header(&m, "sonar");
    assert_int_equal(take_u32(&m), height);
    assert_int_equal(take_u32(&m), width);
    check_text(&m, "rgb8");
    assert_int_equal(m.bytes[m.at++], 0);
    assert_int_equal(take_u32(&m), 3 * width);
    assert_int_equal(take_u32(&m), 3 * width * height);
    const uint8_t *pixels = m.bytes + m.at;
    m.at += 3 * width * height;
    check_end(&m);
    return pixels;
}

/* RGB at a range, in shares of the whole, and bearing from the sonar, which is at APEX_X, 400. */
static uint32_t pixel(const uint8_t *pixels, size_t width, double apex_x, double share,
                      double bearing_rad) {
    size_t x = (size_t)(apex_x + 400.0 * share * sin(bearing_rad));
    size_t y = (size_t)(400.0 - 400.0 * share * cos(bearing_rad));
    const uint8_t *p = pixels + 3 * (y * width + x);
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

static uint32_t color(double low_db, double high_db, double level_db) {
    asdic_picture_options look = asdic_picture_options_default();
    look.db_low = low_db;
    look.db_high = high_db;
    return asdic_raster_color(&look, level_db, 1.0, 0);
}

static void check_fan(const asdic_beam *beams) {
    /* half-way between beams and as far outside: -0.45 to 0.6 rad */
    const double apex_x = ceil(400.0 * sin(0.45));
    const size_t width = (size_t)(apex_x + ceil(400.0 * sin(0.6)));
    asdic_sonar sonar = sonar_of(BEAMS);
    sonar.receivers = beams;
    asdic_ros *ros = ros_of(&sonar, NULL);
    for (int at = 0; at < 2; at++) {
        for (size_t i = 0; i < CELLS; i++) {
            levels_db[i] = i == 5 ? NAN : 62.0f + (float)(at ? 2 * i : 3 * i);
        }
        const uint8_t *pixels = check_image(ros, width, 400);
        for (size_t i = 0; i < CELLS; i++) { /* 62 to 95 dB, then 62 to 84: 60 to 100 both times */
            double share = ((double)(i % BINS) + 0.5) / BINS;
            uint32_t rgb = pixel(pixels, width, apex_x, share, beams[i / BINS].yaw_rad);
            assert_int_equal(rgb, i == 5 ? 0 : color(60.0, 100.0, (double)levels_db[i]));
        }
        assert_int_equal(pixel(pixels, width, apex_x, 0.5, -0.5), 0);
    }
    asdic_ros_destroy(&ros);
}

static void a_fan_has_the_window_of_its_first_ping(void **state) {
    (void)state;
    check_fan(receivers);
    check_fan(mirrored());
}

static void a_scan_grows(void **state) {
    (void)state;
    asdic_sonar sonar = sonar_of(1); /* which looks 0.3 to port of the head */
    asdic_ros *scan = ros_of(&sonar, &sweep);
    /* directions -0.6, -0.4, -0.2, 0, and half a step outside: nothing to starboard of 0.1 */
    const double apex_x = ceil(400.0 * sin(0.7));
    const size_t width = (size_t)(apex_x + ceil(400.0 * sin(0.1)));
    for (ping.ping = 0; ping.ping < 3; ping.ping++) {
        for (size_t i = 0; i < BINS; i++) {
            levels_db[i] = 61.0f + 8.0f * (float)i + (float)ping.ping;
        }
        const uint8_t *pixels = check_image(scan, width, 400);
        for (size_t direction = 0; direction < 4; direction++) {
            for (size_t i = 0; i < BINS; i++) {
                double share = ((double)i + 0.5) / BINS;
                double level_db = 61.0 + 8.0 * (double)i + (double)direction;
                assert_int_equal(
                    pixel(pixels, width, apex_x, share, -0.6 + 0.2 * (double)direction),
                    direction <= ping.ping ? color(60.0, 90.0, level_db) : 0);
            }
        }
    }
    ping.ping = 0;
    asdic_ros_destroy(&scan);
}

/* Who listens late sees where the head looked before. */
static void a_scan_has_pings_that_nobody_saw(void **state) {
    (void)state;
    asdic_sonar sonar = sonar_of(1);
    asdic_ros *scan = ros_of(&sonar, &sweep);
    const double apex_x = ceil(400.0 * sin(0.7));
    const size_t width = (size_t)(apex_x + ceil(400.0 * sin(0.1)));
    for (ping.ping = 0; ping.ping < 5; ping.ping++) { /* there, and back to 2 */
        for (size_t i = 0; i < BINS; i++) {
            levels_db[i] = 61.0f + 8.0f * (float)i + (float)ping.ping;
        }
        encode(scan, ASDIC_ROS_HEAD);
    }
    ping.ping--;
    const uint8_t *pixels = check_image(scan, width, 400);
    for (size_t direction = 0; direction < 4; direction++) {
        double level_db = 61.0 + (direction == 2 ? 4.0 : (double)direction);
        assert_int_equal(pixel(pixels, width, apex_x, 0.5 / BINS, -0.6 + 0.2 * (double)direction),
                         color(60.0, 90.0, level_db));
    }
    ping.ping = 0;
    asdic_ros_destroy(&scan);
}

/* Three beams or more in the order of their bearings, or a scan of as many directions. */
static void not_all_sonars_have_a_picture(void **state) {
    (void)state;
    static const asdic_beam alike[4] = {{.length_h_m = 0.1, .yaw_rad = 0.1},
                                        {.length_h_m = 0.1, .yaw_rad = 0.2},
                                        {.length_h_m = 0.1, .yaw_rad = 0.2},
                                        {.length_h_m = 0.1, .yaw_rad = 0.1}};
    static const asdic_beam fro[3] = {{.length_h_m = 0.1, .yaw_rad = 0.2},
                                      {.length_h_m = 0.1, .yaw_rad = 0.1},
                                      {.length_h_m = 0.1, .yaw_rad = 0.15}};
    static const asdic_beam steep[3] = {{.length_h_m = 0.1, .yaw_rad = 0.1},
                                        {.length_h_m = 0.1, .yaw_rad = 0.2},
                                        {.length_h_m = 0.1, .yaw_rad = 0.3, .pitch_rad = -1.5}};
    const asdic_sweep two = {.directions = 2, .step_rad = 0.2}, three = {3, 0.2, false};
    const struct {
        const asdic_beam *beams;
        size_t count;
        const asdic_sweep *sweep;
        bool has;
    } rows[] = {{receivers, 3, NULL, true},  {receivers, 2, NULL, false},
                {receivers, 1, NULL, false}, {alike, 3, NULL, false},
                {alike + 1, 3, NULL, false}, {steep, 3, NULL, false},
                {receivers, 1, &two, false}, {receivers, 1, &three, true},
                {mirrored(), 3, NULL, true}, {fro, 3, NULL, false}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        asdic_sonar sonar = sonar_of(rows[i].count);
        sonar.receivers = rows[i].beams;
        asdic_ros *ros = ros_of(&sonar, rows[i].sweep);
        for (unsigned k = 0; k < ASDIC_ROS_OUTPUT_COUNT; k++) {
            bool has =
                k == ASDIC_ROS_HEAD ? rows[i].sweep != NULL : k != ASDIC_ROS_PICTURE || rows[i].has;
            assert_int_equal(asdic_ros_has(ros, k), has);
        }
        assert_false(asdic_ros_has(ros, (asdic_ros_output)-1));
        assert_false(asdic_ros_has(ros, ASDIC_ROS_OUTPUT_COUNT));
        asdic_ros_destroy(&ros);
    }
}

/* Never too few, for a disk that has to hold them; and 32 for each beam. */
static void a_pings_bytes_are_known_before(void **state) {
    (void)state;
    const asdic_sweep none = {0}, circle = {12, ASDIC_PI / 6.0, true};
    const struct {
        size_t beams;
        const asdic_sweep *sweep;
    } rows[] = {{2, &none}, {1, &none}, {BEAMS, &none}, {1, &sweep}, {1, &circle}};
    size_t sizes[5], said[5];
    for (size_t i = 0; i < 5; i++) {
        asdic_sonar sonar = sonar_of(rows[i].beams);
        asdic_ros *ros = ros_of(&sonar, rows[i].sweep);
        sizes[i] = 0;
        for (unsigned k = 0; k < ASDIC_ROS_DETECTIONS; k++) {
            sizes[i] += asdic_ros_has(ros, k) ? encode(ros, k).size : 0;
        }
        sizes[i] -= (sonar.receiver_count + 1) * BINS * sizeof(float);
        said[i] = asdic_ros_ping_bytes(&sonar, rows[i].sweep);
        assert_in_range(said[i], sizes[i], sizes[i] + 600);
        asdic_ros_destroy(&ros);
    }
    assert_int_equal(said[0] - said[1], sizes[0] - sizes[1]);
}

static void what_is_missing_is_refused(void **state) {
    (void)state;
    static const char *const names[ASDIC_ROS_OUTPUT_COUNT] = {
        "tf2_msgs/msg/TFMessage",
        "geometry_msgs/msg/PoseStamped",
        "marine_acoustic_msgs/msg/ProjectedSonarImage",
        "sensor_msgs/msg/Image",
        "marine_acoustic_msgs/msg/SonarDetections",
        "tf2_msgs/msg/TFMessage"};
    asdic_ros_about about = asdic_ros_about_default();
    asdic_sonar sonar = sonar_of(BEAMS);
    asdic_ros *ros;
    const void *bytes;
    size_t size;
    about.bins = BINS;
    assert_int_not_equal(asdic_ros_create(ctx, &about, &ros), ASDIC_OK);
    about.sonar = &sonar;
    assert_int_not_equal(asdic_ros_create(ctx, &about, NULL), ASDIC_OK);
    about.bins = 0;
    assert_int_not_equal(asdic_ros_create(ctx, &about, &ros), ASDIC_OK);
    about.bins = BINS;
    sonar.receiver_count = 0;
    assert_int_not_equal(asdic_ros_create(ctx, &about, &ros), ASDIC_OK);
    sonar.receiver_count = BEAMS;
    about.vehicle_frame = NULL;
    assert_int_not_equal(asdic_ros_create(ctx, &about, &ros), ASDIC_OK);
    assert_null(ros);
    ros = begin();
    asdic_ros_ping lacking = ping;
    lacking.detected = NULL;
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_DETECTIONS, &lacking, &bytes, &size), 0);
    assert_int_equal(asdic_ros_encode(ros, ASDIC_ROS_SONAR, &lacking, &bytes, &size), 0);
    lacking.level_db = NULL;
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_SONAR, &lacking, &bytes, &size), 0);
    for (unsigned k = 0; k < ASDIC_ROS_OUTPUT_COUNT; k++) {
        assert_string_equal(asdic_ros_type_name(k), names[k]);
        assert_string_equal(asdic_ros_type_of(k)->name, names[k]);
    }
    assert_null(asdic_ros_type_name(ASDIC_ROS_OUTPUT_COUNT));
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_OUTPUT_COUNT, &ping, &bytes, &size), 0);
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_HEAD, &ping, &bytes, &size), 0);
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_POSE, NULL, &bytes, &size), 0);
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_POSE, &ping, NULL, &size), 0);
    assert_int_not_equal(asdic_ros_encode(ros, ASDIC_ROS_POSE, &ping, &bytes, NULL), 0);
    assert_int_not_equal(asdic_ros_encode(NULL, ASDIC_ROS_POSE, &ping, &bytes, &size), 0);
    asdic_ros_destroy(&ros);
    asdic_ros_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_lead_from_the_world_to_the_sonar),
        cmocka_unit_test(times_have_whole_seconds_below),
        cmocka_unit_test(levels_go_range_by_range),
        cmocka_unit_test(detections_say_when_and_where),
        cmocka_unit_test(a_fan_has_the_window_of_its_first_ping),
        cmocka_unit_test(a_scan_grows),
        cmocka_unit_test(a_scan_has_pings_that_nobody_saw),
        cmocka_unit_test(not_all_sonars_have_a_picture),
        cmocka_unit_test(a_pings_bytes_are_known_before),
        cmocka_unit_test(what_is_missing_is_refused),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
