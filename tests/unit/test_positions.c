/*
 * What a mission says of places where sonar, bottom and objects cannot meet.
 */
#include "mission_rig.h"

#include "mission/mission.h"

#define OBJECT(name, shape, place) "  - {name: " name ", " shape ", position_m: [" place "]}\n"
#define BALL(name, place) OBJECT(name, "sphere: {radius_m: 2}", place)
#define BOX(name, size, place) OBJECT(name, "box: {size_m: [" size "]}", place)
#define POSE(place) "mission: {pose: {position_m: [" place "]}}\n"

static void sonars_below_the_bottom_are_refused(void **state) {
    workshop *w = *state;
    static const char end[] = "; raise it or lower the bottom  [mission.";
    char expected[300];
    /* In single precision 10 m are exact to a few um: 10 are allowed. */
    assert_string_equal(said_of(w, "bottom: {mesh: pit}\n" POSE("20, 20, 10.0000095")), "");
    assert_contains(said_of(w, "bottom: {mesh: pit}\n" POSE("20, 20, 10.0000107")),
                    "scene.yaml:5:39: error: the sonar is at z = 10 m, below the bottom at 10 m; "
                    "raise it or lower the bottom  [mission.pose.position_m[2]]\n");
    assert_string_equal(said_of(w, "bottom: {depth_m: 12}\n" POSE("0, 0, 12")), "");
    assert_contains(said_of(w, "bottom: {depth_m: 12}\n" POSE("0, 0, 12.5")),
                    "error: the sonar is at z = 12.5 m, below the bottom at 12 m; raise it or "
                    "lower the bottom  [mission.pose.position_m[2]]\n");
    /* Tracks are followed: here 0.1 m deeper each ping. */
    write_track(w, "dive.csv", "100,0,0,5.05,0,0,0\n108,0,0,13.05,0,0,0\n");
    snprintf(expected, sizeof expected,
             "ping 70 at 107 s: the sonar is at z = 12.05 m, below the bottom at 12 m%strack]",
             end);
    assert_contains(said_of(w, "bottom: {depth_m: 12}\nmission: {track: dive.csv}\n"), expected);
    assert_string_equal(
        said_of(w, "bottom: {depth_m: 12}\nmission: {track: dive.csv, pings: 70}\n"), "");
    snprintf(expected, sizeof expected, "below the bottom at 12 m%swaypoints]", end);
    assert_contains(
        said_of(w, "bottom: {depth_m: 12}\nmission: {waypoints: [[0, 0, 5], [50, 0, 14]]}\n"),
        expected);
    /* 10 m deep at x = 0, 20 m at x = 100. Nothing else is said of what is wrong. */
    static const char *const pits[] = {"60, 40, 15.9", "60, 40, 16.1"};
    for (size_t i = 0; i < 2; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "bottom: {mesh: slope}\nobjects:\n" BALL("far", "900, 0, 9") POSE("%s"), pits[i]);
        assert_contains(said_of(w, text),
                        i ? "at z = 16.1 m, below the bottom at 16 m" : "'far' is beyond");
        assert_int_equal(strstr(w->said, "far") == NULL, i);
    }
}

static void bottoms_above_the_surface_are_refused(void **state) {
    workshop *w = *state;
    static const char ground[] = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n"
                                 "-4 -5 -6\n-7 -8 -9\n-4 -4 -4\n";
    static const char shore[] = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n"
                                "-4 -5 -6\n-7 -8 -9\n-4 -4 0\n";
    write_file(w, "ground.asc", ground);
    write_file(w, "shore.asc", shore);
    static const struct {
        const char *bottom, *said;
    } cases[] = {
        {"{grid: {file: ground.asc, values: depths}}",
         "scene.yaml:4:23: error: the bottom lies above the sea surface, from z = -9 to -4 m; give "
         "'values: heights' if it is upside down, or 'position_m'  [bottom.grid.file]\n"},
        {"{grid: {file: ground.asc, values: heights}, position_m: [0, 0, -20]}",
         "from z = -16 to -11 m; give 'values: depths' if"},
        {"{mesh: {file: slope}, position_m: [0, 0, -21]}",
         "from z = -11 to -1 m; give 'z_up: false' if it is upside down, or 'position_m'  "
         "[bottom.mesh.file]"},
        {"{mesh: {file: slope, z_up: false}, position_m: [0, 0, -21]}", "give 'z_up: true' if"},
    };
    char text[300];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, "bottom: %s\n" POSE("5, 5, 9"), cases[i].bottom);
        assert_contains(said_of(w, text), cases[i].said);
        assert_null(strstr(w->said, "below the bottom")); /* though the sonar is */
    }
    /* One that reaches the surface may be meant, and where there are only objects there is none. */
    assert_null(
        strstr(said_of(w, "bottom: {grid: {file: shore.asc, values: depths}}\n" POSE("5, 5, 9")),
               "above the sea surface, from"));
    assert_null(
        strstr(said_of(w, "bottom: {mesh: slope, position_m: [0, 0, -20]}\n" POSE("5, 0, 9")),
               "above the sea surface, from"));
    assert_string_equal(
        said_of(w, "bottom: none\nobjects:\n" BOX("a", "2, 2, 2", "9, 0, 0") POSE("0, 0, 9")), "");
}

/* A plane of 50 m north by 10 m east, then by 10 by 50, that goes down by so many metres. */
static void upright_bottoms_are_remarked(void **state) {
    workshop *w = *state;
    char text[300];
    static const struct {
        double north_m, down_m;
        const char *turn;
        const char *said;
    } cases[] = {
        {50, 19.9, "0, 0, 0", ""},
        {50, 20.0, "0, 0, 0", ""},
        {50, 21.0, "0, 0, 0",
         "scene.yaml:4:16: warning: the bottom stands upright: 50 m north, 10 m east, 21 m down; "
         "if its "
         "file has y up, give 'rotation_deg: [0, 90, 0]' beside 'mesh'  [bottom.mesh]\n"},
        {10, 21.0, "0, 0, 0",
         "scene.yaml:4:16: warning: the bottom stands upright: 10 m north, 50 m east, 21 m down; "
         "if its "
         "file has y up, give 'rotation_deg: [0, 90, 0]' beside 'mesh'  [bottom.mesh]\n"},
        {50, 21.0, "180, 0, 0", ""},
        {50, 21.0, "0, 180, 0", ""},
    };
    static const char *const names[] = {"p0", "p1", "p2", "p3", "p4", "p5"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double x = cases[i].north_m, y = 60 - x, z = cases[i].down_m;
        const double corners[6][3] = {{0, 0, 0}, {x, 0, 0}, {x, y, z},
                                      {0, 0, 0}, {x, y, z}, {0, y, z}};
        add_mesh(w, names[i], corners, 2);
        snprintf(text, sizeof text,
                 "bottom: {mesh: %s, position_m: [0, 0, 30], rotation_deg: [%s]}\n" POSE("5, 5, 3"),
                 names[i], cases[i].turn);
        assert_string_equal(said_of(w, text), cases[i].said);
    }
}

/* The sonar is 200 m deep; boxes of 2 by 4 by 6 m stand in all directions, and at what is heard to. */
static void distant_objects_are_remarked(void **state) {
    workshop *w = *state;
    static const char remark[] = "is beyond the maximum range";
#define AT(name, place) BOX(name, "2, 4, 6", place)
    static const char scene[] =
        "bottom: none\nobjects:\n" AT("north", "200, 200, 200") AT("south", "-10, 200, 200")
            AT("east", "100, 320, 200") AT("west", "100, 70, 200") AT("below", "100, 200, 340")
                AT("above", "100, 200, 50") AT("aside", "200, 300, 200") AT("edge", "176, 200, 200")
                    AT("sky", "100, 200, -3.1") AT("wave", "176, 200, 200") POSE("100, 200, 200");
#undef AT
    static const char *const away_m[] = {"99", "109", "118", "128", "137", "147", "139.3"};
    static const char *const names[] = {"north", "south", "east", "west",
                                        "below", "above", "aside"};
    char expected[2048] = "";
    for (size_t i = 0; i < 7; i++) {
        snprintf(expected + strlen(expected), sizeof expected - strlen(expected),
                 "scene.yaml:%zu:5: warning: object '%s' %s: %s m away, heard to 75 m  "
                 "[objects[%zu]]\n",
                 6 + i, names[i], remark, away_m[i], i);
    }
    strcat(expected, "scene.yaml:14:5: warning: object 'sky' lies above the sea surface; z is "
                     "positive down  [objects[8]]\n");
    assert_string_equal(said_of(w, scene), expected);
    assert_string_equal(
        said_of(w, "bottom: {mesh: slope}\nobjects:\n" BALL("sky", "20, 0, -3") POSE("20, 0, 7")),
        "scene.yaml:6:5: warning: object 'sky' lies above the sea surface; z is "
        "positive down  [objects[0]]\n");
    /* What reaches down to the surface does not lie above it. */
    assert_string_equal(
        said_of(w, "bottom: none\nobjects:\n" BOX("a", "2, 4, 6", "20, 0, -3") POSE("0, 0, 7")),
        "");
    /* The sound's speed is that at the first ping: 1510 m/s at 10 m. */
    write_track(w, "fall.csv", "0,0,0,10,0,0,0\n1,0,0,90,0,0,0\n");
    char text[1024] = SCENE "bottom: none\nobjects:\n" BOX(
        "far", "2, 2, 2", "201, 0, 90") "mission: {track: fall.csv}\n";
    char *speed = strstr(text, "sound_speed_mps: 1500");
    memmove(speed + 42, speed + 21, strlen(speed + 21) + 1);
    memcpy(speed, "sound_speed_profile: [[0,1500],[100,1600]]", 42);
    asdic_mission *m = load_text(w, text);
    assert_contains(w->said, "'far' is beyond the maximum range: 200 m away, heard to 75.5 m");
    asdic_mission_destroy(&m);
}

/* A vehicle that goes 1 m north a ping for 100 pings; objects and bottoms before it, and beyond. */
static void all_pings_are_looked_at(void **state) {
    workshop *w = *state;
    write_track(w, "north.csv", "0,0,0,7,0,0,0\n20,200,0,7,0,0,0\n");
    static const char way[] = "mission: {track: north.csv, pings: 100}\n";
    char text[600];
    snprintf(text, sizeof text,
             "bottom: none\nobjects:\n" BOX("far", "2, 2, 2", "200, 0, 7")
                 BOX("met", "2, 2, 2", "174, 0, 7") BALL("through", "51.5, 0, 7") "%s",
             way);
    assert_string_equal(
        said_of(w, text),
        "scene.yaml:6:5: warning: object 'far' is beyond the maximum range: 100 m away, "
        "heard to 75 m  [objects[0]]\n"
        "scene.yaml:8:5: warning: object 'through' has the sonar inside it at ping 50  "
        "[objects[2]]\n");
    /* The slope, 100 m long, from 250 m north on; then a plane. */
    snprintf(text, sizeof text, "bottom: {mesh: slope, position_m: [250, 0, 5]}\n%s", way);
    assert_string_equal(said_of(w, text), "scene.yaml:4:9: warning: the bottom is never in range: "
                                          "151.2 m away, heard to 75 m  [bottom]\n");
    snprintf(text, sizeof text, "bottom: {mesh: slope, position_m: [150, 0, 5]}\n%s", way);
    assert_string_equal(said_of(w, text), "");
    snprintf(text, sizeof text, "bottom: {depth_m: 83}\n%s", way);
    assert_string_equal(said_of(w, text), "scene.yaml:4:9: warning: the bottom is never in range: "
                                          "76 m away, heard to 75 m  [bottom]\n");
    snprintf(text, sizeof text, "bottom: {depth_m: 82}\n%s", way);
    assert_string_equal(said_of(w, text), "");
}

/* One ping of a long mission, which goes round over the pit, is 1 mm deeper than the others. */
static void no_ping_of_a_long_mission_is_left_out(void **state) {
    workshop *w = *state;
    static const char *const depths[] = {"9.9", "10.001"};
    for (int i = 0; i < 2; i++) {
        char rows[300];
        snprintf(rows, sizeof rows,
                 "0,20,20,9,0,0,0\n1000.05,20,20,9,0,0,0\n1000.1,20,20,%s,0,0,0\n"
                 "1000.15,20,20,9,0,0,0\n3000,20,20,9,0,0,0\n",
                 depths[i]);
        write_track(w, "dip.csv", rows);
        assert_string_equal(
            said_of(w, "bottom: {mesh: pit}\nmission: {track: dip.csv}\n"),
            i ? "scene.yaml:5:18: error: ping 10001 at 1000.1 s: the sonar is at z = 10.001 m, "
                "below "
                "the bottom at 10 m; raise it or lower the bottom  [mission.track]\n"
              : "");
    }
}

/* The slope is 10 m deep at the first of 46 pings, then 2 m deeper every ten. */
static void altitudes_above_the_surface_are_not_held(void **state) {
    workshop *w = *state;
    static const struct {
        const char *bottom, *altitude_m, *said;
    } cases[] = {
        /* 4.5 s at 0.3 m/s leave 8 m of the 9 m that the slope goes down. */
        {"{mesh: slope}", "10", "point 1: it passes 0.2 m aside and 8.0 m above it; fly slower, "},
        {"{mesh: slope}", "15",
         "scene.yaml:5:85: warning: 'altitude_m' = 15 is more than the water is deep at 25 of 46 "
         "pings, from ping 0 on; the vehicle is at the surface there  "
         "[mission.waypoints.altitude_m]\n"},
        {"{mesh: slope}", "21",
         "scene.yaml:5:85: error: 'altitude_m' = 21 is more than the water is deep, at most 19 m "
         "on "
         "the way; lower it  [mission.waypoints.altitude_m]\n"},
        {"{depth_m: 12}", "12", ""},
        {"{depth_m: 12}", "20", "at most 12 m on the way; lower it  [mission"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "bottom: %s\nmission: {waypoints: {points_m: [[0, 1, 5], [90, 1, 5]], "
                 "speed_mps: 20, altitude_m: %s}}\n",
                 cases[i].bottom, cases[i].altitude_m);
        if (cases[i].said[0]) {
            assert_contains(said_of(w, text), cases[i].said);
        } else {
            assert_string_equal(said_of(w, text), "");
        }
    }
    /* 1.35 m of 345 m at most: in figures without a power of ten. */
    assert_contains(said_of(w,
                            "bottom: {depth_m: 400}\nmission: {waypoints: {points_m: [[0, 0, 5], "
                            "[90, 0, 350]], speed_mps: 20}}\n"),
                    "aside and 343.");
}

/* Balls and the sonar far from the origin: within 2 m of the middle it is inside, in all directions. */
static void sonars_in_objects_are_remarked(void **state) {
    workshop *w = *state;
    for (int way = 0; way < 8; way++) {
        double x = way & 1 ? 1 : -1, y = way & 2 ? 1 : -1, z = way & 4 ? 1 : -1;
        char text[600];
        snprintf(text, sizeof text,
                 "bottom: {mesh: slope, position_m: [950, 2000, 60]}\nobjects:\n" BALL(
                     "out", "%g, %g, %g") BALL("in", "%g, %g, %g") POSE("1000, 2000, 50"),
                 1000 + 1.2 * x, 2000 + 1.3 * y, 50 + 1.25 * z, 1000 + 1.1 * x, 2000 + 0.9 * y,
                 50 + 1.05 * z);
        assert_string_equal(said_of(w, text), "scene.yaml:7:5: warning: object 'in' has the sonar "
                                              "inside it at ping 0  [objects[1]]\n");
    }
    /* In one that is open, or at a point, nothing is inside; nor in a ball that is under water alone. */
    assert_string_equal(said_of(w,
                                "bottom: none\nobjects:\n" OBJECT("tent", "mesh: tent", "0, 0, 7")
                                    OBJECT("p", "point: 0", "0, 0, 6") POSE("0, 0, 6")),
                        "");
}

/* Below a slope of 10 m at x = 0 and 20 m at x = 100: all corners of the upper side must be. */
static void buried_objects_are_remarked(void **state) {
    workshop *w = *state;
    static const struct {
        const char *bottom, *size, *place;
        bool buried;
    } cases[] = {
        {"{mesh: slope}", "20, 4, 2", "50, 0, 17.1", true},
        {"{mesh: slope}", "20, 4, 2", "50, 0, 16.9", false},
        {"{mesh: slope, rotation_deg: [0, 0, 180], position_m: [100, 0, 0]}", "20, 4, 2",
         "50, 0, 17.1", true},
        {"{mesh: slope, rotation_deg: [0, 0, 180], position_m: [100, 0, 0]}", "20, 4, 2",
         "50, 0, 16.9", false},
        {"{mesh: slope, rotation_deg: [0, 0, 90], position_m: [50, -50, 0]}", "4, 20, 2",
         "50, 0, 17.1", true},
        {"{mesh: slope, rotation_deg: [0, 0, 90], position_m: [50, -50, 0]}", "4, 20, 2",
         "50, 0, 16.9", false},
        {"{mesh: slope, rotation_deg: [0, 0, -90], position_m: [50, 50, 0]}", "4, 20, 2",
         "50, 0, 17.1", true},
        {"{mesh: slope, rotation_deg: [0, 0, -90], position_m: [50, 50, 0]}", "4, 20, 2",
         "50, 0, 16.9", false},
        /* Across the slope one corner alone is over deeper ground, 1.414 m more than the middle. */
        {"{mesh: slope, rotation_deg: [0, 0, 45], position_m: [14.645, -35.355, 0]}", "20, 20, 2",
         "50, 0, 17.5", true},
        {"{mesh: slope, rotation_deg: [0, 0, 45], position_m: [14.645, -35.355, 0]}", "20, 20, 2",
         "50, 0, 17.3", false},
        {"{mesh: slope, rotation_deg: [0, 0, 135], position_m: [85.355, -35.355, 0]}", "20, 20, 2",
         "50, 0, 17.5", true},
        {"{mesh: slope, rotation_deg: [0, 0, 135], position_m: [85.355, -35.355, 0]}", "20, 20, 2",
         "50, 0, 17.3", false},
        {"{mesh: slope, rotation_deg: [0, 0, 225], position_m: [85.355, 35.355, 0]}", "20, 20, 2",
         "50, 0, 17.5", true},
        {"{mesh: slope, rotation_deg: [0, 0, 225], position_m: [85.355, 35.355, 0]}", "20, 20, 2",
         "50, 0, 17.3", false},
        {"{mesh: slope, rotation_deg: [0, 0, 315], position_m: [14.645, 35.355, 0]}", "20, 20, 2",
         "50, 0, 17.5", true},
        {"{mesh: slope, rotation_deg: [0, 0, 315], position_m: [14.645, 35.355, 0]}", "20, 20, 2",
         "50, 0, 17.3", false},
        /* Over a pit 2 m wide in a plane 10 m deep, then beside it. */
        {"{mesh: pit}", "20, 20, 2", "50, 40, 12", false},
        {"{mesh: pit}", "20, 20, 2", "52, 40, 12", true},
        {"{mesh: pit}", "20, 20, 2", "50, 42, 12", true},
        {"{depth_m: 12}", "2, 2, 2", "50, 0, 13", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        snprintf(
            text, sizeof text,
            "bottom: %s\nobjects:\n  - {name: a, box: {size_m: [%s]}, position_m: [%s]}\n" POSE(
                "50, 10, 3"),
            cases[i].bottom, cases[i].size, cases[i].place);
        assert_string_equal(said_of(w, text),
                            cases[i].buried
                                ? "scene.yaml:6:5: warning: object 'a' lies wholly below "
                                  "the bottom; z is positive down  [objects[0]]\n"
                                : "");
    }
}

/* Of objects on tracks every ping counts, with the object where it is then, and turned. */
static void moving_objects_are_looked_at_where_they_are(void **state) {
    workshop *w = *state;
#define MOVES(name, shape) "  - {name: " name ", " shape ", track: " name ".csv}\n"
    /* 13.5 m deep below a plane of 12 m, a box 10 m long; upright at the second ping it comes up to 8.5 m. Those
     * that lie flat, or go down, stay there. */
    write_track(w, "rises.csv", "0,20,0,13.5,0,0,0\n0.1,20,0,13.5,0,90,0\n");
    write_track(w, "rolls.csv", "0,20,0,13.5,0,0,0\n0.1,20,0,13.5,90,0,0\n");
    write_track(w, "turns.csv", "0,20,0,13.5,0,0,0\n0.1,20,0,13.5,0,0,90\n");
    write_track(w, "sinks.csv", "0,20,0,13.5,0,0,0\n0.1,20,0,20,0,0,0\n");
    assert_string_equal(
        said_of(w, "bottom: {depth_m: 12}\nobjects:\n" MOVES("rises", "box: {size_m: [10, 2, 2]}")
                       MOVES("rolls", "box: {size_m: [2, 10, 2]}")
                           MOVES("turns", "box: {size_m: [10, 10, 2]}") MOVES(
                               "sinks", "box: {size_m: [2, 2, 2]}") "mission: {pose: {position_m: "
                                                                    "[0, 0, 3]}, pings: 2}\n"),
        "scene.yaml:8:5: warning: object 'turns' lies wholly below the bottom; z is positive down  "
        "[objects[2]]\n"
        "scene.yaml:9:5: warning: object 'sinks' lies wholly below the bottom; z is positive down  "
        "[objects[3]]\n");
    /* Wholly below the plane from 13 m of depth on, between pings 4 and 6; once is said of what dives twice. */
    write_track(w, "dives.csv",
                "0,20,0,8,0,0,0\n1,20,0,18.5,0,0,0\n1.1,20,0,8,0,0,0\n1.2,20,0,18,0,0,0\n");
    write_track(w, "lands.csv", "0,20,0,8,0,0,0\n1.2,20,0,12.9,0,0,0\n");
    assert_string_equal(
        said_of(w, "bottom: {depth_m: 12}\nobjects:\n" MOVES("dives", "box: {size_m: [2, 2, 2]}")
                       MOVES("lands", "box: {size_m: [2, 2, 2]}") "mission: {pose: {position_m: "
                                                                  "[0, 0, 3]}, pings: 13}\n"),
        "scene.yaml:6:5: warning: object 'dives' sinks wholly below the bottom by ping 5  "
        "[objects[0]]\n");
    /* Along a slope to the north and east of it: turned by 90 degrees a long box comes out. */
    write_track(w, "north.csv", "0,50,0,16,0,0,0\n1,50,0,16,0,0,90\n");
    write_track(w, "east.csv", "0,50,0,16,0,0,90\n1,50,0,16,0,0,90\n");
    assert_string_equal(
        said_of(w, "bottom: {mesh: slope}\nobjects:\n" MOVES("north", "box: {size_m: [1, 20, 1]}")
                       MOVES("east", "box: {size_m: [20, 1, 1]}") "mission: {pose: {position_m: "
                                                                  "[50, 0, 3]}, pings: 11}\n"),
        "scene.yaml:7:5: warning: object 'east' lies wholly below the bottom; z is positive down  "
        "[objects[1]]\n");
    /* On edge, each of its four in turn, a bar of 10 by 10 m reaches 7.07 m from its middle, not 5. */
    for (int turn_deg = 45; turn_deg < 360; turn_deg += 90) {
        char rows[200];
        snprintf(rows, sizeof rows, "0,50,0,19,0,0,0\n0.1,50,0,19,%d,0,0\n", turn_deg);
        write_track(w, "roll.csv", rows);
        snprintf(rows, sizeof rows, "0,50,0,19,0,0,0\n0.1,50,0,19,0,%d,0\n", turn_deg);
        write_track(w, "pitch.csv", rows);
        assert_string_equal(
            said_of(w,
                    "bottom: {depth_m: 12}\nobjects:\n" MOVES("roll", "box: {size_m: [1, 10, 10]}")
                        MOVES("pitch", "box: {size_m: [10, 1, 10]}") "mission: {pose: {position_m: "
                                                                     "[0, 0, 3]}, pings: 2}\n"),
            "");
        snprintf(rows, sizeof rows, "0,50,0,16.1,0,0,0\n0.1,50,0,16.1,0,0,%d\n", turn_deg);
        write_track(w, "yaw.csv", rows);
        assert_string_equal(
            said_of(w, "bottom: {mesh: slope}\nobjects:\n" MOVES(
                           "yaw", "box: {size_m: [10, 10, 1]}") "mission: {pose: {position_m: [50, "
                                                                "0, 3]}, pings: 2}\n"),
            "");
    }
    /* From 80 m off to the sonar, which the ball's skin, 2 m from its middle, meets at the last ping but one;
     * the other stays off. */
    write_track(w, "comes.csv", "0,80,0,7,0,0,0\n1,0,0,7,0,0,0\n");
    write_track(w, "stays.csv", "0,300,0,7,0,0,0\n1,80,0,7,0,0,0\n");
    assert_string_equal(
        said_of(w, "bottom: {mesh: slope}\nobjects:\n" BALL("rests", "9, 0, 7")
                       MOVES("comes", "sphere: {radius_m: 10}")
                           MOVES("stays", "sphere: {radius_m: 2}") "mission: {pose: {position_m: "
                                                                   "[0, 0, 7]}, pings: 11}\n"),
        "scene.yaml:7:5: warning: object 'comes' has the sonar inside it at ping 9  [objects[1]]\n"
        "scene.yaml:8:5: warning: object 'stays' is beyond the maximum range: 78 m away, heard to "
        "75 m  "
        "[objects[2]]\n");
#undef MOVES
}

/* Points 1 s apart, and one gap of so many seconds before the last. */
static void gaps_of_tracks_are_remarked(void **state) {
    workshop *w = *state;
    static const struct {
        int points;
        double gap_s, rate_hz;
        bool said;
    } cases[] = {{22, 10.5, 10, true},  {22, 9.5, 10, false},  {20, 10.5, 10, true},
                 {19, 10.5, 10, false}, {22, 10.5, 0.2, true}, {22, 10.5, 0.19, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rows[2048] = "", text[600];
        for (int k = 0; k < cases[i].points; k++) {
            double time_s = 100 + k + (k == cases[i].points - 1 ? cases[i].gap_s - 1 : 0);
            snprintf(rows + strlen(rows), sizeof rows - strlen(rows), "%g,0,0,7,0,0,0\n", time_s);
        }
        write_track(w, "gap.csv", rows);
        snprintf(text, sizeof text,
                 "version: 1\nbottom: {depth_m: 12}\nsonar: {frequency_khz: 100, ping_rate_hz: %g, "
                 "source_level_db: 0, receivers: [{name: a}]}\nmission: {track: gap.csv}\n",
                 cases[i].rate_hz);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        asdic_mission_destroy(&m);
        snprintf(text, sizeof text,
                 "scene.yaml:4:18: warning: the track has no point for 10.5 s after %d s; the "
                 "vehicle goes straight on meanwhile  [mission.track]\n",
                 98 + cases[i].points);
        assert_string_equal(w->said, cases[i].said ? text : "");
    }
}

/* The pings are from 100 to 101 s; the tracks of three objects meet that, of one at its very end. */
static void tracks_at_other_times_are_remarked(void **state) {
    workshop *w = *state;
    write_track(w, "way.csv", "100,0,0,7,0,0,0\n101,1,0,7,0,0,0\n");
    write_track(w, "before.csv", "90,9,0,7,0,0,0\n99.5,9,0,7,0,0,0\n");
    write_track(w, "first.csv", "90,9,0,7,0,0,0\n100,9,0,7,0,0,0\n");
    write_track(w, "last.csv", "101,9,0,7,0,0,0\n110,9,0,7,0,0,0\n");
    write_track(w, "after.csv", "101.5,9,0,7,0,0,0\n110,9,0,7,0,0,0\n");
#define ON(name) "  - {name: " name ", point: 0, track: " name ".csv}\n"
    assert_string_equal(
        said_of(w, "bottom: none\nobjects:\n" OBJECT("rests", "point: 0", "9, 0, 7") ON("before")
                       ON("first") OBJECT("too", "point: 0", "9, 0, 7") ON("last")
                           ON("after") "mission: {track: way.csv}\n"),
        "scene.yaml:7:5: warning: object 'before' never moves: its track covers 90 to 99.5 s, the "
        "pings are from 100 to 101 s  [objects[1]]\n"
        "scene.yaml:11:5: warning: object 'after' never moves: its track covers 101.5 to 110 s, "
        "the "
        "pings are from 100 to 101 s  [objects[5]]\n");
    write_track(w, "way.csv",
                "1700000000.25,0,0,7,0,0,0\n1700000000.75,1,0,7,0,0,0\n"); /* of a clock */
    assert_string_equal(
        said_of(w, "bottom: none\nobjects:\n" ON("before") "mission: {track: way.csv}\n"),
        "scene.yaml:6:5: warning: object 'before' never moves: its track covers 90 to 99.5 s, the "
        "pings are from 1700000000.25 to 1700000000.75 s  [objects[0]]\n");
#undef ON
}

/* A run of many says nothing of what is out of place unless it is asked to, and may begin below the bottom; that one
 * says nothing in any case. */
static void runs_of_many_leave_remarks_out(void **state) {
    workshop *w = *state;
    const asdic_draw draw = {.seed = 1};
    char path[128];
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    for (int depth_m = 7; depth_m < 20; depth_m += 6) {
        char text[600];
        snprintf(text, sizeof text,
                 SCENE "bottom: {depth_m: 12}\nobjects:\n" BALL("far", "99, 0, 7") POSE("0, 0, %d"),
                 depth_m);
        write_file(w, "scene.yaml", text);
        for (int tells = 0; tells < 2; tells++) {
            asdic_mission *m = NULL;
            w->said[0] = '\0';
            asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, keep_lines, w);
            assert_ok(w->ctx, asdic_mission_load_like(w->ctx, path, &draw, NULL, 0, tells, &m));
            asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, NULL, NULL);
            assert_int_equal(asdic_mission_is_below_bottom(m, 0, text), depth_m > 12);
            assert_int_equal(strstr(w->said, "object 'far' is beyond") != NULL,
                             tells && depth_m < 12);
            assert_int_equal(w->said[0] != '\0', tells && depth_m < 12);
            asdic_mission_destroy(&m);
        }
    }
}

/* 10 m deep at x = 0, 20 m at x = 100; 50 m to either side. A plane 10 m deep with a pit at (50, 40). A roof. */
static int begin_with_meshes(void **state) {
    static const double slope[6][3] = {{0, -50, 10}, {100, -50, 20}, {100, 50, 20},
                                       {0, -50, 10}, {100, 50, 20},  {0, 50, 10}};
    static const double edge[5][2] = {{0, 0}, {100, 0}, {100, 100}, {0, 100}, {0, 0}};
    static const double rim[5][2] = {{49, 39}, {51, 39}, {51, 41}, {49, 41}, {49, 39}};
    static const double tent[6][3] = {{-2, -2, 1}, {2, -2, 1}, {0, 0, -3},
                                      {2, -2, 1},  {2, 2, 1},  {0, 0, -3}};
    double pit[12][3][3];
    if (begin(state)) {
        return -1;
    }
    for (size_t i = 0; i < 4; i++) {
        const double triangles[3][3][3] = {
            {{edge[i][0], edge[i][1], 10},
             {edge[i + 1][0], edge[i + 1][1], 10},
             {rim[i][0], rim[i][1], 10}},
            {{edge[i + 1][0], edge[i + 1][1], 10},
             {rim[i + 1][0], rim[i + 1][1], 10},
             {rim[i][0], rim[i][1], 10}},
            {{rim[i][0], rim[i][1], 10}, {rim[i + 1][0], rim[i + 1][1], 10}, {50, 40, 30}}};
        memcpy(pit[3 * i], triangles, sizeof triangles);
    }
    add_mesh(*state, "slope", slope, 2);
    add_mesh(*state, "pit", pit[0], 12);
    add_mesh(*state, "tent", tent, 2);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sonars_below_the_bottom_are_refused),
        cmocka_unit_test(bottoms_above_the_surface_are_refused),
        cmocka_unit_test(upright_bottoms_are_remarked),
        cmocka_unit_test(distant_objects_are_remarked),
        cmocka_unit_test(all_pings_are_looked_at),
        cmocka_unit_test(no_ping_of_a_long_mission_is_left_out),
        cmocka_unit_test(altitudes_above_the_surface_are_not_held),
        cmocka_unit_test(sonars_in_objects_are_remarked),
        cmocka_unit_test(buried_objects_are_remarked),
        cmocka_unit_test(moving_objects_are_looked_at_where_they_are),
        cmocka_unit_test(gaps_of_tracks_are_remarked),
        cmocka_unit_test(tracks_at_other_times_are_remarked),
        cmocka_unit_test(runs_of_many_leave_remarks_out),
    };
    return cmocka_run_group_tests(tests, begin_with_meshes, end);
}
