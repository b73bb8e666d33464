/*
 * Pictures of the live view: things are seen where they are, whatever sound does.
 */
#include "ping_rig.h"

#include "live/camera.h"

#include <math.h>
#include <string.h>

#define WIDTH 160
#define HEIGHT 96
#define PIXELS ((size_t)WIDTH * HEIGHT)

static test_device t;

/* From 4 m of depth, a little to the right and down. */
static const asdic_shot shot = {
    .eye_m = {-6.0, 0.0, 4.0}, .yaw_rad = 0.2, .pitch_rad = -0.25, .range_m = 60.0};

static asdic_camera *camera(void) {
    asdic_camera *c = NULL;
    assert_ok(t.ctx, asdic_camera_create(t.ctx, t.device, WIDTH, HEIGHT, &c));
    return c;
}

/* Whether the picture shows a thing at AT, and not something before or behind it. */
static void assert_seen(const asdic_camera *c, asdic_vec3 at_m) {
    double x, y, far_m;
    assert_true(asdic_camera_project(c, at_m, &x, &y, &far_m));
    assert_true(x > 0.0 && x < WIDTH && y > 0.0 && y < HEIGHT);
    size_t pixel = (size_t)y * WIDTH + (size_t)x;
    assert_close((double)asdic_camera_far_m(c)[pixel], far_m, 0.015 * far_m);
}

static const asdic_pose ball_from = {{9.0, -3.0, 6.0}, 0.0, 0.0, 0.0};
static const asdic_pose ball_to = {{7.0, -1.0, 8.0}, 0.0, 0.0, 0.0};

/* Flat bottom at 12 m, a box that stays and a ball that moves. */
static ping_rig furnished(void) {
    ping_rig r = rig_create(&t);
    asdic_material steel = asdic_material_facet(45.0, 1e-3, 0.1);
    asdic_mesh *box = NULL, *ball = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 2.0, 1.5}, &box));
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.8, 48, &ball));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", box,
                                            (asdic_pose){{9.5, 4.0, 7.0}, 0.0, 0.0, 0.0}, steel));
    assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "ball", ball, ball_from, steel));
    asdic_mesh_destroy(&box);
    asdic_mesh_destroy(&ball);
    r.sampling.rays = 256;
    return r;
}

/* A picture of what R describes; the ball moves before the first and after it. */
static void look(ping_rig *r, float far_m[2][PIXELS]) {
    asdic_simulator *sim = rig_simulator(r);
    asdic_camera *c = camera();
    for (int k = 0; k < 2; k++) {
        const asdic_pose *at = k == 0 ? &ball_to : &ball_from;
        assert_ok(t.ctx, asdic_simulator_move(sim, "ball", at));
        assert_ok(t.ctx, asdic_camera_shoot(c, sim, &shot));
        memcpy(far_m[k], asdic_camera_far_m(c), PIXELS * sizeof(float));
        assert_seen(c, (asdic_vec3){9.0, 4.0, 7.0});   /* the box's near face */
        assert_seen(c, (asdic_vec3){9.0, 4.8, 6.5});   /* its corner */
        assert_seen(c, (asdic_vec3){9.0, -4.5, 12.0}); /* the floor beside it */
        assert_seen(c, (asdic_vec3){7.0, 1.0, 12.0});
        asdic_vec3 near_m = at->position_m; /* the ball's side towards the eye */
        double away_m = hypot(hypot(near_m.x + 6.0, near_m.y), near_m.z - 4.0);
        near_m.x -= 0.8 * (near_m.x + 6.0) / away_m;
        near_m.y -= 0.8 * near_m.y / away_m;
        near_m.z -= 0.8 * (near_m.z - 4.0) / away_m;
        assert_seen(c, near_m);
    }
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(r);
}

static void light_goes_straight(void **state) {
    (void)state;
    static float straight[2][PIXELS], bent[2][PIXELS];
    ping_rig r = furnished();
    look(&r, straight);
    for (int k = 0; k < 2; k++) {
        r = furnished();
        if (k == 0) {
            r.env.sound_speed_gradient_per_s = -4.0;
        } else {
            r.env.sound_speed_profile =
                (asdic_sound_profile){4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1440.0, 1446.0}};
        }
        look(&r, bent);
        size_t off = 0;
        for (size_t i = 0; i < PIXELS; i++) {
            for (int n = 0; n < 2; n++) {
                off += fabsf(straight[n][i] - bent[n][i]) > 1e-3f * straight[n][i];
            }
        }
        assert_true(off < 20); /* edges */
    }
}

static double brightness(const asdic_camera *c) {
    double sum = 0.0;
    for (size_t i = PIXELS / 2; i < PIXELS; i++) {
        uint32_t rgb = asdic_camera_rgb(c)[i];
        sum += (double)(rgb & 0xff) + (double)(rgb >> 8 & 0xff) + (double)(rgb >> 16 & 0xff);
    }
    return sum;
}

/* A floor of triangles, 8 m below the eye. */
static double floor_brightness(double depth_m) {
    ping_rig r = rig_create(&t);
    const double v[] = {-90, -90, depth_m, 90, -90, depth_m, 90, 90, depth_m, -90, 90, depth_m};
    static const uint32_t index[] = {0, 2, 1, 0, 3, 2};
    asdic_mesh *mesh = NULL;
    rig_empty(&r);
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, 4, index, 2, &mesh));
    assert_ok(t.ctx,
              asdic_scene_add_bottom(r.scene, mesh, (asdic_pose){0}, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
    r.env.max_depth_m = depth_m;
    r.pose.position_m.z = depth_m - 8.0;
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    asdic_shot from = shot;
    from.eye_m.z = depth_m - 8.0;
    assert_ok(t.ctx, asdic_camera_shoot(c, sim, &from));
    assert_seen(c, (asdic_vec3){8.0, -2.0, depth_m});
    double sum = brightness(c);
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
    return sum;
}

static void the_deep_is_dark(void **state) {
    (void)state;
    double shallow = floor_brightness(10.0), deep = floor_brightness(80.0);
    printf("# 80 m down %.2f times as bright as 10 m\n", deep / shallow);
    assert_true(deep < 0.95 * shallow);
}

/* Of pixels at the same distance on either side of the middle, most differ. */
static void the_floor_has_a_grain(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    const asdic_shot down = {.eye_m = {3.0, 3.0, 4.0}, .pitch_rad = -1.4, .range_m = 60.0};
    assert_ok(t.ctx, asdic_camera_shoot(c, sim, &down));
    const uint32_t *rgb = asdic_camera_rgb(c);
    size_t other = 0;
    for (size_t y = 0; y < HEIGHT; y++) {
        for (size_t x = 0; x < WIDTH / 2; x++) {
            assert_close((double)asdic_camera_far_m(c)[y * WIDTH + x],
                         (double)asdic_camera_far_m(c)[y * WIDTH + WIDTH - 1 - x], 1e-3);
            other += rgb[y * WIDTH + x] != rgb[y * WIDTH + WIDTH - 1 - x];
        }
    }
    assert_true(other > PIXELS / 3);
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Mean of the three colours where AT is seen. */
static double brightness_at(const asdic_camera *c, asdic_vec3 at_m) {
    double x, y, far_m;
    assert_true(asdic_camera_project(c, at_m, &x, &y, &far_m));
    assert_true(x > 0.0 && x < WIDTH && y > 0.0 && y < HEIGHT);
    uint32_t rgb = asdic_camera_rgb(c)[(size_t)y * WIDTH + (size_t)x];
    return ((rgb >> 16 & 255) + (rgb >> 8 & 255) + (rgb & 255)) / 3.0;
}

/* Lines of the floor, ten metres apart, are darker than the sand on both sides of them. */
static void the_floor_has_a_grid(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    const asdic_shot down = {.eye_m = {10.0, 5.0, 8.0}, .pitch_rad = -1.5, .range_m = 60.0};
    assert_ok(t.ctx, asdic_camera_shoot(c, sim, &down));
    double line = 0.0, port = 0.0, starboard = 0.0;
    for (double y = 3.0; y < 7.0; y += 0.02) {
        line += brightness_at(c, (asdic_vec3){10.0, y, 12.0});
        port += brightness_at(c, (asdic_vec3){9.5, y, 12.0});
        starboard += brightness_at(c, (asdic_vec3){10.5, y, 12.0});
    }
    printf("# a line %.2f and %.2f times as bright as beside it\n", line / port, line / starboard);
    assert_true(line < 0.95 * port && line < 0.95 * starboard);
    /* Far off, where a pixel sees three metres of floor and more, there are none: a floor as bright as the sand. */
    const asdic_shot ahead = {.eye_m = {10.0, 5.0, 8.0}, .pitch_rad = -0.1, .range_m = 2000.0};
    assert_ok(t.ctx, asdic_camera_shoot(c, sim, &ahead));
    double sand = brightness_at(c, (asdic_vec3){25.0, 5.0, 12.0});
    for (double x = 50.0; x <= 70.0; x += 0.5) {
        double far = 0.0;
        for (double y = -5.0; y <= 15.0; y += 0.5) {
            far += brightness_at(c, (asdic_vec3){x, y, 12.0}) / 41.0;
        }
        assert_close(far, sand, 0.1 * sand);
    }
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Whether N, out of the vehicle at P, faces the eye well. */
static bool faces_eye(asdic_vec3 p, asdic_vec3 n) {
    const double x = shot.eye_m.x - p.x, y = shot.eye_m.y - p.y, z = shot.eye_m.z - p.z;
    return n.x * x + n.y * y + n.z * z > 0.7 * sqrt(x * x + y * y + z * z);
}

/* A rod with round ends, 0.032 of the range long and 0.15 times as thick; fins are at its stern. */
static void the_vehicle_is_a_rod(void **state) {
    (void)state;
    static const double yaws[] = {1.0, 2.4, 3.2, -2.0};
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    const double radius = 0.075 * 0.032 * shot.range_m, half = 0.016 * shot.range_m - radius;
    int seen = 0, round = 0;
    for (size_t i = 0; i < sizeof yaws / sizeof *yaws; i++) {
        const asdic_pose at = {{-2.5, 0.6, 4.8}, 0.3, 0.2, yaws[i]};
        const asdic_vec3 bow = {cos(at.pitch_rad) * cos(at.yaw_rad),
                                cos(at.pitch_rad) * sin(at.yaw_rad), -sin(at.pitch_rad)};
        asdic_shot from = shot;
        from.vehicle = &at;
        assert_ok(t.ctx, asdic_camera_shoot(c, sim, &from));
        for (int k = 0; k < 400; k++) {
            double z = 1.0 - (k + 0.5) / 200.0, phi = 2.4 * k, across = sqrt(1.0 - z * z);
            asdic_vec3 n = {across * cos(phi), across * sin(phi), z}, p = at.position_m;
            double ahead = n.x * bow.x + n.y * bow.y + n.z * bow.z, along = half;
            if (ahead < 0.0) { /* on the side, ahead of the middle */
                double unit = 1.0 / sqrt(1.0 - ahead * ahead);
                n = (asdic_vec3){unit * (n.x - ahead * bow.x), unit * (n.y - ahead * bow.y),
                                 unit * (n.z - ahead * bow.z)};
                along = half * (1.0 + ahead);
            }
            p.x += along * bow.x + radius * n.x;
            p.y += along * bow.y + radius * n.y;
            p.z += along * bow.z + radius * n.z;
            if (faces_eye(p, n)) {
                assert_seen(c, p);
                seen++;
                round += ahead > 0.0;
            }
        }
    }
    assert_true(seen > 150 && round > 40);
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Four fins stand out at its stern, whichever way it rolls. */
static void the_vehicle_has_fins(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    const double length = 0.032 * shot.range_m, high = 1.8 * 0.075 * length;
    for (int k = 0; k < 4; k++) {
        const asdic_pose at = {{-2.5, 0.6, 4.8}, 0.5 * k * 3.14159265358979323846, 0.0, 1.4};
        asdic_shot from = shot;
        from.vehicle = &at;
        assert_ok(t.ctx, asdic_camera_shoot(c, sim, &from));
        for (int side = -1; side <= 1; side += 2) {
            assert_seen(c, (asdic_vec3){at.position_m.x - 0.42 * length * cos(at.yaw_rad),
                                        at.position_m.y - 0.42 * length * sin(at.yaw_rad),
                                        at.position_m.z + side * high});
        }
    }
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Red of the middle pixel before the display's curve and shoulder. */
static double red_of(const asdic_camera *c) {
    double shown = (asdic_camera_rgb(c)[HEIGHT / 2 * WIDTH + WIDTH / 2] >> 16 & 0xff) / 255.0;
    return shown * shown / (1.0 - 0.25 * shown * shown);
}

/* A beam 45 degrees wide to either side, of 5 m: it glows by what lies before the eye, which looks ahead from within,
 * or straight across from outside, once beyond it. */
static void a_beam_glows_as_far_as_one_looks_through_it(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_camera *c = camera();
    const asdic_pose at = {.position_m = {0.0, 0.0, 6.0}};
    for (int k = 0; k < 8; k++) {
        bool across = k >= 5;
        double ahead_m = across ? 1.0 + 2.1 * (k - 5) : 1.0 + k, red[2];
        for (unsigned cones = 0; cones < 2; cones++) {
            asdic_shot from = {
                .eye_m = {ahead_m, across ? -3.0 : 0.0, 6.0},
                .yaw_rad = across ? 0.5 * 3.14159265358979323846 : 0.0,
                .vehicle = &at,
                .range_m = 5.0,
                .cones = cones,
                .cone = {{.rows = {1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f},
                          .rgb = {1.0f, 0.0f, 0.0f},
                          .strength = 1.0f}}};
            assert_ok(t.ctx, asdic_camera_shoot(c, sim, &from));
            red[cones] = red_of(c);
        }
        double way_m = ahead_m > 5.0 ? 0.0 : across ? 2.0 * ahead_m : 5.0 - ahead_m;
        double glow = 0.55 * (1.0 - exp(-2.2 * way_m / 5.0));
        print_message("from %g m ahead%s: %.3f, %.3f by the way\n", ahead_m,
                      across ? ", across" : "", red[1] - red[0], glow);
        assert_close(red[1] - red[0], glow, 0.02);
    }
    asdic_camera_destroy(&c);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_goes_straight),
        cmocka_unit_test(the_deep_is_dark),
        cmocka_unit_test(the_floor_has_a_grain),
        cmocka_unit_test(the_floor_has_a_grid),
        cmocka_unit_test(the_vehicle_is_a_rod),
        cmocka_unit_test(the_vehicle_has_fins),
        cmocka_unit_test(a_beam_glows_as_far_as_one_looks_through_it),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
