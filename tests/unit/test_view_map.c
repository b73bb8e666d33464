/* A view's map and camera: what lies where, and what the camera is told to show. */
#include "view_ink.h"

/* The last shot, seen on its way to the camera. */
static asdic_shot shot;

asdic_status __real_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of);
asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of);

asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of) {
    shot = *of;
    return __real_asdic_camera_shoot(camera, sim, of);
}

/* A cone's axis and edges lie as said: by heading and depression, with half-widths to the sides and up and down. */
static void check_cone(const dev_cone_view *cone, double heading_rad, double down_rad,
                       double half_h_rad, double half_v_rad) {
    for (int k = 0; k < 5; k++) {
        double side = k < 3 ? half_h_rad * (k - 1) : 0.0,
               below = k < 3 ? 0.0 : half_v_rad * (2 * k - 7);
        /* Turned to the side within the plane of the face, then down, then to the heading. */
        double x = cos(side) * cos(below), y = sin(side), z = sin(below), seen[3];
        double ahead = x * cos(down_rad) - z * sin(down_rad);
        const double u[3] = {ahead * cos(heading_rad) - y * sin(heading_rad),
                             ahead * sin(heading_rad) + y * cos(heading_rad),
                             x * sin(down_rad) + z * cos(down_rad)};
        for (int row = 0; row < 3; row++) {
            const float *r = cone->rows + 3 * row;
            seen[row] = (double)r[0] * u[0] + (double)r[1] * u[1] + (double)r[2] * u[2];
        }
        assert_close(seen[1] / seen[0], k < 3 ? k - 1.0 : 0.0, 1e-4);
        assert_close(seen[2] / seen[0], k < 3 ? 0.0 : 2.0 * k - 7.0, 1e-4);
        assert_close(seen[0], cos(side) * cos(below), 1e-4);
    }
}

/* Nine beams and more are one wedge. The chosen beam is amber, which has more red than blue, and
 * stronger. */
static void beams_are_cones(void **state) {
    (void)state;
    asdic_view *v =
        open_view("[{name: a, yaw_deg: -40}, {name: b, pitch_deg: 30, length_v_m: 0.05}, "
                  "{name: c, yaw_deg: 25, length_h_m: 0.2}]",
                  "sampling: {rays: 256}");
    v->beam = 2;
    step(v, 1);
    const asdic_beam *beams = asdic_mission_sonar(v->mission)->receivers;
    double heading = v->ping.pose.yaw_rad;
    assert_int_equal(shot.cones, 3);
    for (size_t b = 0; b < 3; b++) {
        const dev_cone_view *cone = &shot.cone[b];
        check_cone(cone, heading + beams[b].yaw_rad, beams[b].pitch_rad,
                   asdic_view_half_width_rad(v, beams[b].length_h_m),
                   asdic_view_half_width_rad(v, beams[b].length_v_m));
        assert_int_equal(cone->rgb[0] > cone->rgb[2], b == 2);
        assert_close((double)cone->strength, b == 2 ? 1.0 : 0.55, 1e-6);
    }
    close_view(v);
    for (int count = 8; count < 11; count++) {
        char receivers[1024] = "[";
        add_beams(receivers, count);
        v = open_view(receivers, "sampling: {rays: 256}");
        v->beam = 1;
        step(v, 1);
        beams = asdic_mission_sonar(v->mission)->receivers;
        assert_int_equal(shot.cones, count < 9 ? count : 2);
        if (count >= 9) {
            double half = asdic_view_half_width_rad(v, beams[0].length_h_m);
            check_cone(&shot.cone[0], v->ping.pose.yaw_rad + beams[1].yaw_rad, 0.0, half,
                       asdic_view_half_width_rad(v, beams[1].length_v_m));
            check_cone(&shot.cone[1], v->ping.pose.yaw_rad, 0.0, beams[count - 1].yaw_rad + half,
                       asdic_view_half_width_rad(v, beams[0].length_v_m));
            assert_true(shot.cone[0].rgb[0] > shot.cone[0].rgb[2]);
            assert_true(shot.cone[1].rgb[0] < shot.cone[1].rgb[2]);
        }
        close_view(v);
    }
}

/* Where a place is on the map. */
static double px_per_m(const asdic_view *v) {
    return fmax(v->layout.plan.w, v->layout.plan.h) / ((double)v->relief.rows * v->relief.cell_m);
}

static double x_of(const asdic_view *v, double east_m) {
    return v->layout.plan.x + (east_m - v->relief.west_m) * px_per_m(v);
}

static double y_of(const asdic_view *v, double north_m) {
    return v->layout.plan.y + v->layout.plan.h - (north_m - v->relief.south_m) * px_per_m(v);
}

/* The area's box, metres from the vehicle at (0, 0); cairo's coordinates are 256ths of a pixel. */
static void assert_area(const asdic_view *v, size_t at, double west_m, double east_m,
                        double south_m, double north_m) {
    assert_true(at < area_count);
    const struct area *a = &areas[at];
    const double seen_px[4] = {a->x0 - x_of(v, 0.0), a->x1 - x_of(v, 0.0), y_of(v, 0.0) - a->y1,
                               y_of(v, 0.0) - a->y0};
    const double wanted_m[4] = {west_m, east_m, south_m, north_m};
    for (int k = 0; k < 4; k++) {
        assert_close(seen_px[k] / px_per_m(v), wanted_m[k], 0.01 + 0.01 * fabs(wanted_m[k]));
    }
}

/* Swimming east 13 m above the bottom: areas are where lobes, of so many degrees to the half power, meet it; by
 * trigonometry. */
static void areas_lie_on_the_bottom(void **state) {
    (void)state;
    char receivers[2048] = "[{name: a, pitch_deg: 90, length_h_m: 0.1, length_v_m: 0.05}, "
                           "{name: b, pitch_deg: 45, length_h_m: 0.1, length_v_m: 0.1}, "
                           "{name: c, pitch_deg: -90}], max_range_m: 40";
    asdic_view *v = open_view(receivers, "sampling: {rays: 256}");
    v->beam = 0;
    step(v, 1);
    double speed_mps =
        asdic_environment_sound_speed_mps(asdic_mission_environment(v->mission), 7.0);
    double narrow = asin(0.442946 * speed_mps / 1e5 / 0.1);
    double broad = asin(0.442946 * speed_mps / 1e5 / 0.05);
    draw(v);
    assert_int_equal(area_count, 4); /* the chosen one last; the vehicle */
    double near_m = 13.0 * tan(45.0 * DEGREE - narrow), far_m = 13.0 * tan(45.0 * DEGREE + narrow);
    double side_m = tan(narrow) * 13.0 / sin(45.0 * DEGREE - narrow);
    assert_close(areas[0].x0 - x_of(v, 0.0), near_m * px_per_m(v), 0.02 * near_m * px_per_m(v));
    assert_close(areas[0].x1 - x_of(v, 0.0), far_m * px_per_m(v), 0.02 * far_m * px_per_m(v));
    assert_close(y_of(v, 0.0) - areas[0].y0, side_m * px_per_m(v), 0.1 * side_m * px_per_m(v));
    assert_true(areas[1].x1 - areas[1].x0 < 1.0); /* upwards there is nothing ahead */
    double ahead_m = 13.0 * tan(broad), aside_m = 13.0 * tan(narrow);
    assert_area(v, 2, -ahead_m, ahead_m, -aside_m, aside_m);
    close_view(v);
    /* An echo sounder: a strip athwart, from edge to edge of the outermost lobes. */
    size_t used = (size_t)snprintf(receivers, sizeof receivers, "[");
    for (int k = 0; k < 13; k++) {
        int across_deg = 10 * k - 60;
        used += (size_t)snprintf(receivers + used, sizeof receivers - used,
                                 "%s{name: b%d, yaw_deg: %d, pitch_deg: %d, length_h_m: 0.1, "
                                 "length_v_m: 0.1}",
                                 k ? ", " : "", k, across_deg < 0 ? -90 : 90, 90 - abs(across_deg));
    }
    snprintf(receivers + used, sizeof receivers - used, "], max_range_m: 40");
    v = open_view(receivers, "sampling: {rays: 256}");
    assert_true(v->is_section && v->shows_fan);
    assert_int_equal(v->beam, 6);
    for (int k = 0; k < 13; k++) { /* from the left, port, round below */
        assert_close(v->bearing_rad[k], (240.0 - 10.0 * k) * DEGREE, 1e-9);
    }
    step(v, 1);
    draw(v);
    double most_m = 13.0 * tan(60.0 * DEGREE + narrow);
    double wide_m = tan(narrow) * 13.0 / cos(60.0 * DEGREE + narrow);
    assert_int_equal(area_count, 3);
    assert_close((areas[0].y1 - y_of(v, 0.0)) / px_per_m(v), most_m, 0.02 * most_m);
    assert_close((areas[0].y0 - y_of(v, 0.0)) / px_per_m(v), -most_m, 0.02 * most_m);
    assert_close((areas[0].x1 - x_of(v, 0.0)) / px_per_m(v), wide_m, 0.1 * wide_m);
    assert_area(v, 1, -aside_m, aside_m, -aside_m, aside_m);
    /* In the picture from behind a wedge, downwards and as thick as the beams are wide. */
    assert_int_equal(shot.cones, 2);
    const float *ahead = shot.cone[1].rows, *out = ahead + 6;
    assert_close((double)ahead[2], 1.0, 1e-6);
    assert_close(hypot((double)out[0], (double)out[1]), 1.0 / tan(narrow), 0.01 / tan(narrow));
    assert_close(fabs((double)out[1]), 1.0 / tan(narrow), 0.01 / tan(narrow));
    close_view(v);
}

/* On the map and by its name, where it is at the moment. */
static void what_moves_is_shown(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-track-XXXXXX", more[160];
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(
        dprintf(
            fd,
            "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,2,12,7,0,0,0\n4,-2,12,7,0,0,0\n") >
        0);
    close(fd);
    snprintf(more, sizeof more,
             "objects: [{name: fish, sphere: {radius_m: 0.5}, track: %s}]\nsampling: {rays: 256}",
             path);
    asdic_view *v = open_view("[{name: a}]", more);
    unlink(path);
    double label_x = NAN;
    for (int ping = 0; ping < 3; ping++) {
        step(v, 1);
        draw(v);
        assert_int_equal(arc_count, 1);
        assert_close(arcs[0].x, x_of(v, 12.0), 1e-6);
        assert_close(arcs[0].y, y_of(v, 2.0 - 0.25 * ping), 1e-6);
        double last_x = label_x;
        for (size_t i = 0; i < word_count; i++) {
            label_x = strcmp(words[i].text, "fish") == 0 ? words[i].x : label_x;
        }
        assert_true(ping == 0 ? label_x > v->layout.chase.x : label_x > last_x);
    }
    close_view(v);
}

/* Which has no triangles, and is in no relief. */
static void points_are_on_the_map(void **state) {
    (void)state;
    asdic_view *v = open_view(
        "[{name: a}]",
        "sampling: {rays: 256}\n"
        "objects:\n  - {name: p, point: {target_strength_db: -30}, position_m: [2, 12, 7]}\n"
        "  - {name: s, sphere: {radius_m: 0.5}, position_m: [2, 8, 7]}\n");
    step(v, 1);
    draw(v);
    assert_int_equal(arc_count, 1);
    assert_close(arcs[0].x, x_of(v, 12.0), 1e-6);
    assert_close(arcs[0].y, y_of(v, 2.0), 1e-6);
    close_view(v);
}

/* A cone ends at 166 degrees: a wider fan is seen as several, side by side. */
static void wide_fans_are_seen_whole(void **state) {
    (void)state;
    static const struct {
        int sector_deg;
        unsigned cones;
    } cases[] = {{120, 1}, {200, 2}, {360, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char fan[96];
        snprintf(fan, sizeof fan, "{fan: {count: 24, sector_deg: %d, length_h_m: 0.2}}",
                 cases[i].sector_deg);
        asdic_view *v = open_view(fan, "sampling: {rays: 256}");
        step(v, 1);
        const asdic_sonar *sonar = asdic_mission_sonar(v->mission);
        double half_v = asdic_view_half_width_rad(v, sonar->receivers[0].length_v_m);
        double half = asdic_view_half_width_rad(v, 0.2), yaw = v->ping.pose.yaw_rad;
        double low = sonar->receivers[0].yaw_rad - half, whole = -2.0 * low;
        assert_int_equal(shot.cones, 1 + cases[i].cones);
        whole = fmin(whole, 360.0 * DEGREE);
        for (unsigned k = 0; k < cases[i].cones; k++) {
            double each = whole / cases[i].cones;
            check_cone(&shot.cone[1 + k], yaw + low + (k + 0.5) * each, 0.0, 0.5 * each, half_v);
        }
        close_view(v);
    }
}

/* From behind and above, in the water, clear of the bottom. */
static void the_camera_stays_in_the_water(void **state) {
    (void)state;
    static const double depths_m[] = {0.1, 1.0, 7.0, 15.0, 19.9};
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    for (size_t i = 0; i < sizeof depths_m / sizeof *depths_m; i++) {
        asdic_vec3 *at = &v->ping.pose.position_m;
        at->z = depths_m[i];
        draw(v);
        double behind_m = at->y - shot.eye_m.y; /* it swims east */
        assert_true(behind_m > 3.0 && fabs(shot.eye_m.x - at->x) < 0.02 * behind_m);
        assert_true(shot.eye_m.z >= 0.4 && shot.eye_m.z < 20.0 - 0.1 * behind_m);
        assert_true(shot.eye_m.z < at->z || at->z < 0.4);
        assert_true(shot.eye_m.z > 0.41 || at->z < 0.4 * behind_m);
        /* Down to a place ahead of the vehicle, which is seen below the middle, if at all. */
        double down = atan2(at->z - shot.eye_m.z, behind_m);
        assert_true(-shot.pitch_rad < down + 0.1 && shot.pitch_rad < 0.0);
    }
    close_view(v);
}

/* White pixels of the map: the vehicle's fill alone. */
static size_t white_pixels(const asdic_view *v) {
    cairo_surface_t *surface = v->canvas.surface;
    const asdic_box box = v->layout.plan;
    size_t count = 0;
    cairo_surface_flush(surface);
    const unsigned char *data = cairo_image_surface_get_data(surface);
    for (size_t y = (size_t)box.y; y < (size_t)(box.y + box.h); y++) {
        const unsigned char *row = data + y * (size_t)cairo_image_surface_get_stride(surface);
        for (size_t x = (size_t)box.x; x < (size_t)(box.x + box.w); x++) {
            count += row[4 * x] == 255 && row[4 * x + 1] == 255 && row[4 * x + 2] == 255;
        }
    }
    return count;
}

/* An arrow of 0.74 times its size squared, 8 pixels in a window of 1280 and 16 in one of 2560, less half a line round
 * it. */
static void the_vehicle_is_as_large_as_the_window(void **state) {
    (void)state;
    size_t white[2];
    for (int i = 0; i < 2; i++) {
        asdic_view_options o = small();
        o.width *= 2 * (i + 1);
        o.height *= 2 * (i + 1);
        asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        draw(v);
        white[i] = white_pixels(v);
        close_view(v);
    }
    assert_true(white[0] >= 8 && white[0] < 48);
    assert_true(white[1] >= 95 && white[1] < 190);
}

/* As far apart as the scale bar is long: lines of equal east, which go down the map, and of equal north. */
static void the_map_is_to_scale(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    draw(v);
    const asdic_box box = v->layout.plan;
    double side_m = v->relief.cell_m * (double)v->relief.rows, length_m = NAN, bar_px = NAN;
    size_t norths = 0;
    for (size_t i = 0; i < word_count; i++) { /* below the arrow, which ends 26 px down */
        bool is_north = strcmp(words[i].text, "N") == 0;
        norths += is_north;
        assert_true(!is_north || (words[i].x > box.x + 0.5 * box.w && words[i].x < box.x + box.w &&
                                  words[i].y > box.y + 26.0 * v->layout.scale &&
                                  words[i].y < box.y + 60.0 * v->layout.scale));
    }
    assert_int_equal(norths, 1);
    for (size_t i = 0; i < word_count && isnan(length_m); i++) {
        char *end;
        double value = strtod(words[i].text, &end);
        if (words[i].x > box.x && words[i].x < box.x + box.w && words[i].y > box.y &&
            strcmp(end, " m") == 0) {
            length_m = value;
        }
    }
    assert_true(length_m > 0.1 * side_m && length_m < 0.5 * side_m);
    double step_px = length_m * fmax(box.w, box.h) / side_m, last_x = NAN, last_y = NAN;
    size_t down = 0, across = 0;
    for (size_t i = 0; i < line_count; i++) {
        const struct line *l = &lines[i];
        if (l->x0 == l->x1 && l->y0 == box.y && l->y1 == box.y + box.h && l->x0 >= box.x) {
            assert_true(down++ == 0 || fabs(fabs(l->x0 - last_x) - step_px) < 1.01);
            last_x = l->x0;
        } else if (l->y0 == l->y1 && l->x0 == box.x && l->x1 == box.x + box.w) {
            assert_true(across++ == 0 || fabs(fabs(l->y0 - last_y) - step_px) < 1.01);
            assert_true(l->y0 > box.y - 1.0 && l->y0 < box.y + box.h + 1.0);
            last_y = l->y0;
        } else if (l->y0 == l->y1 && l->x0 > box.x && l->x1 < box.x + box.w && l->y0 > box.y) {
            bar_px = l->x1 - l->x0;
        }
    }
    assert_close(bar_px, step_px, 1e-6);
    assert_close((double)down, box.w / step_px, 1.0);
    assert_close((double)across, box.h / step_px, 1.0);
    assert_true(down >= 3 && across >= 3);
    close_view(v);
}

/* A flat floor has the middle of the map's colours, 0.04, 0.13, 0.20 to 0.33, 0.53, 0.56 of white, and its depth below. */
static void the_map_knows_a_flat_floor(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    draw(v);
    assert_true(is_written("floor at 20.0 m") || is_written("20.0 m"));
    const asdic_box box = v->layout.plan;
    asdic_view_image frame = asdic_view_get_frame(v);
    size_t alike = 0, seen = 0;
    for (size_t y = (size_t)box.y; y < (size_t)(box.y + box.h); y++) {
        for (size_t x = (size_t)box.x; x < (size_t)(box.x + box.w); x++, seen++) {
            uint32_t rgb = frame.rgb[y * frame.stride + x];
            alike += abs((int)(rgb >> 16 & 255) - 47) < 3 && abs((int)(rgb >> 8 & 255) - 84) < 3 &&
                     abs((int)(rgb & 255) - 97) < 3;
        }
    }
    assert_true(alike > seen / 4);
    close_view(v);
}

/* Seen from behind, the oldest of the way lies in open water, nearest to the eye. */
static void a_trail_lies_behind_the_vehicle(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 12);
    draw(v);
    double x[2], y[2], far_m[2];
    bool is_drawn = false;
    for (size_t k = 0; k < 2; k++) {
        assert_true(asdic_camera_project(v->camera, v->trail_m[k], &x[k], &y[k], &far_m[k]));
        x[k] += v->layout.chase.x;
        y[k] += v->layout.chase.y;
    }
    assert_true(far_m[0] < far_m[1]);
    for (size_t i = 0; i < line_count; i++) {
        const struct line *l = &lines[i];
        is_drawn = is_drawn ||
                   hypot(l->x0 - x[0], l->y0 - y[0]) + hypot(l->x1 - x[1], l->y1 - y[1]) < 1e-6;
        assert_false(hypot(l->x1 - x[0], l->y1 - y[0]) < 1e-6); /* nothing leads to its beginning */
    }
    assert_true(is_drawn);
    close_view(v);
}

/* Of objects in one place the first is named alone, wherever others are. */
static void names_keep_clear_of_names(void **state) {
    (void)state;
    asdic_view *v = open_view(
        "[{name: a}]", "sampling: {rays: 256}\nobjects:\n"
                       "  - {name: port, box: {size_m: [1, 1, 1]}, position_m: [4, 15, 12]}\n"
                       "  - {name: starboard, box: {size_m: [1, 1, 1]}, position_m: [-4, 15, 12]}\n"
                       "  - {name: again, box: {size_m: [0.9, 0.9, 1]}, position_m: [4, 15, 12]}");
    step(v, 1);
    draw(v);
    assert_true(is_written("port") && is_written("starboard") && !is_written("again"));
    /* Each stands above the middle of its object's top, 6 pixels in a window of 1280 and half as many in one of 640. */
    static const struct {
        const char *name;
        asdic_vec3 top_m;
    } tops[] = {{"port", {4, 15, 11.5}}, {"starboard", {-4, 15, 11.5}}};
    for (size_t i = 0; i < 2; i++) {
        double x, y, far_m;
        assert_true(asdic_camera_project(v->camera, tops[i].top_m, &x, &y, &far_m));
        const struct word *w = words;
        while (strcmp(w->text, tops[i].name) != 0) {
            w++;
        }
        assert_close(w->x, v->layout.chase.x + x, 1.5);
        assert_close(w->y, v->layout.chase.y + y - 3.0 - 3.0, 3.0); /* half the letters' height */
    }
    close_view(v);
}

/* What the camera sees fills its panel, but for what is drawn over it. */
static void the_camera_fills_its_panel(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 4);
    draw(v);
    const asdic_box box = v->layout.chase;
    const size_t width = (size_t)box.w, height = (size_t)box.h;
    const uint32_t *seen = asdic_camera_rgb(v->camera);
    asdic_view_image frame = asdic_view_get_frame(v);
    size_t others = 0, coloured = 0;
    for (size_t y = 0; y < height; y++) {
        const uint32_t *row = frame.rgb + ((size_t)box.y + y) * frame.stride + (size_t)box.x;
        for (size_t x = 0; x < width; x++) {
            others += ((row[x] ^ seen[y * width + x]) & 0xffffffu) != 0;
            coloured += seen[y * width + x] != seen[0];
        }
    }
    assert_true(others < width * height / 50 && coloured > width * height / 2);
    close_view(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beams_are_cones),
        cmocka_unit_test(areas_lie_on_the_bottom),
        cmocka_unit_test(what_moves_is_shown),
        cmocka_unit_test(points_are_on_the_map),
        cmocka_unit_test(wide_fans_are_seen_whole),
        cmocka_unit_test(the_camera_stays_in_the_water),
        cmocka_unit_test(the_vehicle_is_as_large_as_the_window),
        cmocka_unit_test(the_map_is_to_scale),
        cmocka_unit_test(the_map_knows_a_flat_floor),
        cmocka_unit_test(a_trail_lies_behind_the_vehicle),
        cmocka_unit_test(names_keep_clear_of_names),
        cmocka_unit_test(the_camera_fills_its_panel),
    };
    t = test_device_open_or_skip();
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
