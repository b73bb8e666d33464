/*
 * Every kind of error a scene file can have, with the exact message.
 */
#include "scene_text.h"

static void minimal_scene_has_no_error(void **state) {
    (void)state;
    expect_errors(MINIMAL, "");
}

static void unknown_keys_are_answered(void **state) {
    (void)state;
    expect_edit("bottom:", "environment:\n  salnity_ppt: 35\nbottom:",
                "3:3: error: unknown key 'salnity_ppt'; did you mean 'salinity_ppt'?  "
                "[environment]\n");
    expect_edit("bottom:", "Surface: {}\nbottom:",
                "2:1: error: unknown key 'Surface'; did you mean 'surface'?  [scene]\n");
    expect_edit("  receivers:", "  fan: {count: 3, sector_deg: 90}\n  receivers:",
                "5:3: error: unknown key 'fan' here; it belongs in sonar.receivers  [sonar]\n");
    expect_edit("mission:", "ping_rate_hz: 10\nmission:",
                "7:1: error: unknown key 'ping_rate_hz' here; it belongs in sonar  [scene]\n");
    expect_edit("mission:", "surface: {zzzzz: 1}\nmission:",
                "7:11: error: unknown key 'zzzzz'; the keys here are enabled, law  [surface]\n");
    expect_edit("- name: forward", "- {name: forward, gain_db: 3}",
                "6:23: error: unknown key 'gain_db'; the keys here are name, pitch_deg, yaw_deg, "
                "roll_deg, length_h_m, length_v_m  [sonar.receivers[0]]\n");
    expect_edit("{depth_m: 12}", "{mesh: {file: a.ply, rotation_deg: [0, 90, 0]}}",
                "2:30: error: unknown key 'rotation_deg' here; it belongs beside 'mesh'  "
                "[bottom.mesh]\n");
    /* A long one is cut between characters, also in the path. */
#define EIGHT "\u00f6\u00f6\u00f6\u00f6\u00f6\u00f6\u00f6\u00f6"
#define SHOWN "x" EIGHT EIGHT EIGHT "\u00f6\u00f6\u00f6\u00f6\u00f6\u00f6\u00f6"
    expect_edit("mission:", "surface: {x" EIGHT EIGHT EIGHT EIGHT ": 1}\nmission:",
                "7:11: error: unknown key '" SHOWN
                "'; the keys here are enabled, law  [surface]\n");
    expect_edit(
        "mission:", "x" EIGHT EIGHT EIGHT EIGHT ": {a: &b 1}\nmission:",
        "7:1: error: unknown key '" SHOWN "'; the keys here are version, environment, surface, "
        "bottom, objects, sonar, mission, sampling, model, detector, output, trial  [scene]\n"
        "7:40: error: anchors (&b) are not accepted; leave it out  [" SHOWN ".a]\n");
}

static void ranges_name_value_limit_and_unit(void **state) {
    (void)state;
    expect_edit("frequency_khz: 100", "frequency_khz: 9000",
                "4:18: error: 'frequency_khz' = 9000 is out of range [0.1, 3000] kHz  "
                "[sonar.frequency_khz]\n");
    expect_edit("version: 1", "version: 2",
                "1:10: error: 'version' = 2 is out of range [1, 1]  [version]\n");
    expect_edit("version: 1", "version: two",
                "1:10: error: 'version' = two is not a number; give 1  [version]\n");
    expect_edit("[0, 0, 7]", "[0, 1e9, 7]",
                "8:26: error: 'position_m' = 1e9 is out of range [-10000000, 10000000] m  "
                "[mission.pose.position_m[1]]\n");
}

static void numbers_are_plain_decimal(void **state) {
    (void)state;
#define GIVE "; give a number in [0.1, 3000] kHz"
    const struct {
        const char *value, *message;
    } cases[] = {
        {"abc", "'frequency_khz' = abc is not a number" GIVE},
        {".nan", "'frequency_khz' = .nan is not a finite number" GIVE},
        {"-.INF", "'frequency_khz' = -.INF is not a finite number" GIVE},
        {"nan", "'frequency_khz' = nan is not a finite number" GIVE},
        {"1,5",
         "'frequency_khz' = 1,5 is not a number; the decimal separator is a point, digits are "
         "not grouped" GIVE},
        {"1_00", "'frequency_khz' = 1_00 is not a number; digits are not grouped" GIVE},
        {"0100", "'frequency_khz' = 0100 is not a decimal number; leave out leading zeros" GIVE},
        {"0x64", "'frequency_khz' = 0x64 is not a number" GIVE},
        {"1:40", "'frequency_khz' = 1:40 is not a number" GIVE},
        {"100 kHz", "'frequency_khz' = 100 kHz is not a number" GIVE},
        {"100kHz", "'frequency_khz' = 100kHz is not a number" GIVE},
        {"1e", "'frequency_khz' = 1e is not a number" GIVE},
        {"1e999", "'frequency_khz' = 1e999 is too large for a double" GIVE},
        {"'100'",
         "'frequency_khz' = \"100\" is text, not a number in [0.1, 3000] kHz; leave out the "
         "quotes"},
        {"'abc'", "'frequency_khz' = \"abc\" is text, not a number in [0.1, 3000] kHz"},
        {"[100]", "'frequency_khz' is a list, which must be a number in [0.1, 3000] kHz"},
        {"{a: 1}", "'frequency_khz' is a map, which must be a number in [0.1, 3000] kHz"},
        {"true", "'frequency_khz' = true is not a number" GIVE},
        {"1111111111111111111111111111111111111111111111",
         "'frequency_khz' = 1111111111111111111111111111111111111111... is out of range "
         "[0.1, 3000] kHz"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char to[96], expected[256];
        snprintf(to, sizeof to, "frequency_khz: %s", cases[i].value);
        snprintf(expected, sizeof expected, "4:18: error: %s  [sonar.frequency_khz]\n",
                 cases[i].message);
        expect_edit("frequency_khz: 100", to, expected);
    }
    expect_edit("frequency_khz: 100", "frequency_khz:",
                "4:3: error: 'frequency_khz' has no value; it must be a number in [0.1, 3000] kHz  "
                "[sonar.frequency_khz]\n");
    expect_edit("mission:\n", "mission:\n  pings: 1.5\n",
                "8:10: error: 'pings' = 1.5 is not a whole number; give a whole number in "
                "[1, 1000000000]  [mission.pings]\n");
    expect_edit("mission:\n", "mission:\n  pings: 0\n",
                "8:10: error: 'pings' = 0 is out of range [1, 1000000000]  [mission.pings]\n");
    expect_edit("mission:\n", "mission:\n  pings: 2e1\n", "");
}

/* A whole number, or a word in its place. */
static void rays_or_auto(void **state) {
    (void)state;
    expect_edit("mission:", "sampling: {rays: auto}\nmission:", "");
    expect_edit("mission:", "sampling: {rays: 30000}\nmission:", "");
    expect_edit("mission:", "sampling: {rays: atuo}\nmission:",
                "7:18: error: 'rays' = atuo is not one of auto or a whole number in "
                "[64, 268435456]; did you mean 'auto'?  [sampling.rays]\n");
    expect_edit("mission:", "sampling: {rays: 12}\nmission:",
                "7:18: error: 'rays' = 12 is out of range [64, 268435456]  [sampling.rays]\n");
    expect_edit("mission:", "sampling: {rays: 100.5}\nmission:",
                "7:18: error: 'rays' = 100.5 is not one of auto or a whole number in "
                "[64, 268435456]  [sampling.rays]\n");
}

static void words_and_booleans(void **state) {
    (void)state;
    expect_edit("depth_m: 12}", "depth_m: 12, type: sandd}",
                "2:29: error: 'type' = sandd is not one of mud, sand, gravel, rock or a number in "
                "[1, 4]; did you mean 'sand'?  [bottom.type]\n");
    expect_edit("depth_m: 12}", "depth_m: 12, type: 5}",
                "2:29: error: 'type' = 5 is out of range [1, 4]  [bottom.type]\n");
    expect_edit("depth_m: 12}", "depth_m: 12, type: 2.5}", "");
    expect_edit("mission:", "model: {variant: Printed}\nmission:",
                "7:18: error: 'variant' = Printed is not one of corrected, printed; did you mean "
                "'printed'?  [model.variant]\n");
    expect_edit(
        "mission:", "output: {images: [waterfall, fann, 3]}\nmission:",
        "7:30: error: 'images' = fann is not one of waterfall, ascope, fan, overview, plan; "
        "did you mean 'fan'?  [output.images[1]]\n"
        "7:36: error: 'images' = 3 is not one of waterfall, ascope, fan, overview, plan  "
        "[output.images[2]]\n");
    expect_edit(
        "mission:", "output: {images: fan}\nmission:",
        "7:18: error: 'images' = fan is not a list of waterfall, ascope, fan, overview, plan  "
        "[output.images]\n");
    expect_edit("mission:", "surface: {enabled: maybe}\nmission:",
                "7:20: error: 'enabled' = maybe is not true or false  [surface.enabled]\n");
    expect_edit("mission:", "surface: {enabled: 'true'}\nmission:",
                "7:20: error: 'enabled' = \"true\" is text, not true or false; leave out the "
                "quotes  [surface.enabled]\n");
    expect_edit("mission:", "surface: {enabled: \"no\"}\nmission:",
                "7:20: error: 'enabled' = \"no\" is text, not true or false; leave out the quotes  "
                "[surface.enabled]\n");
    expect_edit("mission:", "surface: {enabled: 'maybe'}\nmission:",
                "7:20: error: 'enabled' = \"maybe\" is text, not true or false  "
                "[surface.enabled]\n");
    const char *fine[] = {"yes", "No", "ON", "off", "n", "Y", "TRUE", "False"};
    for (size_t i = 0; i < sizeof fine / sizeof *fine; i++) {
        char to[64];
        snprintf(to, sizeof to, "surface: {enabled: %s}\nmission:", fine[i]);
        expect_edit("mission:", to, "");
    }
    /* A plain off is the boolean false in YAML 1.1, and what a converter makes of it. */
    expect_edit("mission:", "sampling: {multipath: off}\nmission:", "");
    expect_edit("mission:", "sampling: {multipath: false}\nmission:", "");
}

static void maps_and_lists_have_their_form(void **state) {
    (void)state;
    expect_edit("{depth_m: 12}", "12",
                "2:9: error: this must be a map, that is 'key: value' lines  [bottom]\n");
    expect_edit("mission:", "environment:\nmission:",
                "7:1: error: this must be a map, that is 'key: value' lines; leave the key out for "
                "its defaults  [environment]\n");
    expect_edit(
        "{depth_m: 12}", "~",
        "2:9: error: this must be a map, that is 'key: value' lines, or 'none'  [bottom]\n");
    expect_edit("mission:\n  pose: {position_m: [0, 0, 7]}", "mission: null",
                "7:10: error: this must be a map, that is 'key: value' lines  [mission]\n");
    expect_edit("    - name: forward", "    {name: forward}",
                "6:5: error: 'receivers' must be a list, or a map with 'fan'  [sonar.receivers]\n");
    expect_edit("{depth_m: 12}", "[depth_m, 12]",
                "2:9: error: this must be a map, that is 'key: value' lines  [bottom]\n");
    expect_edit("    - name: forward", "    forward",
                "6:5: error: 'receivers' must be a list, or a map with 'fan'  [sonar.receivers]\n");
    expect_edit("    - name: forward", "    []",
                "6:5: error: 'receivers' has 0 entries, which is out of range [1, 4096]  "
                "[sonar.receivers]\n");
    expect_edit("- name: forward", "- forward",
                "6:7: error: each entry must be a map, that is 'key: value' lines  "
                "[sonar.receivers[0]]\n");
    expect_edit("[0, 0, 7]", "[0, 0]",
                "8:22: error: 'position_m' has 2 entries; it must be a list of 3 numbers in m  "
                "[mission.pose.position_m]\n");
    expect_errors("just text\n",
                  "1:1: error: this must be a map, that is 'key: value' lines  [scene]\n");
    expect_errors("- 1\n", "1:1: error: this must be a map, that is 'key: value' lines  [scene]\n");
}

/* YAML's words for nothing are as nothing at all. */
static void null_is_no_value(void **state) {
    (void)state;
    static const char *const words[] = {"null", "~", "Null", "NULL"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char to[96];
        snprintf(to, sizeof to, "environment: {ph: %s}\nmission:", words[i]);
        expect_edit("mission:", to,
                    "7:19: error: 'ph' has no value; it must be a number in [7, 8.5]  "
                    "[environment.ph]\n");
    }
    expect_edit("  pose: {position_m: [0, 0, 7]}", "  track: null",
                "8:10: error: 'track' has no value; it must be the name of a file  "
                "[mission.track]\n");
    expect_edit("depth_m: 12", "mesh: {file: null}",
                "2:23: error: 'file' has no value; it must be the name of a file  "
                "[bottom.mesh.file]\n");
    expect_edit("name: forward", "name: 'null'", "");
}

/* A slip makes one error, whatever it leaves missing. */
static void slips_make_one_error(void **state) {
    (void)state;
    expect_edit("frequency_khz", "frequncy_khz",
                "4:3: error: unknown key 'frequncy_khz'; did you mean 'frequency_khz'?  [sonar]\n");
    expect_edit("depth_m", "dpeth_m",
                "2:10: error: unknown key 'dpeth_m'; did you mean 'depth_m'?  [bottom]\n");
    expect_edit(
        "pose:", "psoe:", "8:3: error: unknown key 'psoe'; did you mean 'pose'?  [mission]\n");
    expect_edit("{depth_m: 12}", "nonne",
                "2:9: error: this must be a map, that is 'key: value' lines; did you mean 'none'?  "
                "[bottom]\n");
}

static void missing_keys_are_all_named(void **state) {
    (void)state;
    expect_errors(
        "sonar: {}\n",
        "1:1: error: missing key 'version' (version of this format)  [scene]\n"
        "1:1: error: missing key 'bottom' (the sea floor: depth_m, mesh, grid or none)  [scene]\n"
        "1:1: error: missing key 'mission' (where the vehicle is: pose, track or waypoints)  "
        "[scene]\n"
        "1:8: error: missing key 'frequency_khz', in kHz (centre frequency)  [sonar]\n"
        "1:8: error: missing key 'receivers' (the receiving apertures: a list, or fan: {count, "
        "sector_deg, ...})  [sonar]\n");
}

static void alternatives_exclude_each_other(void **state) {
    (void)state;
    expect_edit("{depth_m: 12}", "{type: sand}",
                "2:9: error: none of 'depth_m', 'mesh', 'grid', 'none' is given; give one of them  "
                "[bottom]\n");
    expect_edit("{depth_m: 12}", "{depth_m: 12, mesh: a.ply}",
                "2:23: error: 'depth_m' and 'mesh' exclude each other; give only one of 'depth_m', "
                "'mesh', 'grid', 'none'  [bottom]\n");
    /* It is not known which of the two is meant, and so not that the position has no effect. */
    expect_edit("{depth_m: 12}", "{depth_m: 12, position_m: [0, 0, 1], mesh: a.ply}",
                "2:46: error: 'depth_m' and 'mesh' exclude each other; give only one of 'depth_m', "
                "'mesh', 'grid', 'none'  [bottom]\n");
    expect_edit("mission:\n", "mission:\n  track: a.csv\n",
                "9:3: error: 'track' and 'pose' exclude each other; give only one of 'pose', "
                "'track', 'waypoints'  [mission]\n");
    /* A key of another place is not told of as one that has no effect, too. */
    expect_edit(
        "{depth_m: 12}", "{depth_m: 12, lambert_db: -27, impedance_mrayl: 3}",
        "2:40: error: unknown key 'impedance_mrayl' here; it belongs in objects[].material  "
        "[bottom]\n");
    expect_edit(
        "  pose: {position_m: [0, 0, 7]}", "  pings: 3",
        "8:3: error: none of 'pose', 'track', 'waypoints' is given; give one of them  [mission]\n");
    expect_edit("mission:",
                "objects:\n"
                "  - {position_m: [1, 2, 3]}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], type: sand, material: {}}\n"
                "mission:",
                "8:5: error: none of 'box', 'sphere', 'cylinder', 'plate', 'mesh', 'point' is "
                "given; give one of them  [objects[0]]\n"
                "9:64: error: 'type' and 'material' exclude each other; give only one of "
                "'material', 'type'  [objects[1]]\n");
    expect_edit("{depth_m: 12}", "{depth_m: 12, type: sand, type: rock}",
                "2:35: error: duplicate key 'type'; it is given at line 2 already  [bottom]\n");
}

#define PRESETS                                                                                    \
    "acrylic, air, aluminium, brass, concrete, copper, glass, ice, iron, lead, pine, rubber, "     \
    "steel, wood"

static void points_and_presets_are_checked(void **state) {
    (void)state;
    expect_edit("mission:",
                "objects:\n"
                "  - {point: {target_strength_db: -42.3}, position_m: [1, 2, 3]}\n"
                "  - {point: -42.3, position_m: [1, 2, 4]}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: {preset: steel}}\n"
                "mission:",
                "");
    expect_edit("mission:",
                "objects:\n"
                "  - {point: {target_strength_db: 400}, position_m: [1, 2, 3]}\n"
                "  - {point: -20, position_m: [1, 2, 4], type: sand}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3],\n"
                "     material: {preset: steal}}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3],\n"
                "     material: {preset: steel, impedance_mrayl: 3}}\n"
                "mission:",
                "8:34: error: 'target_strength_db' = 400 is out of range [-200, 100] dB re 1 m2  "
                "[objects[0].point.target_strength_db]\n"
                "9:41: error: 'type' has no effect on a point; leave it out  [objects[1]]\n"
                "11:25: error: 'preset' = steal is not one of " PRESETS "; did you mean 'steel'?  "
                "[objects[2].material.preset]\n"
                "13:32: error: 'preset' and 'impedance_mrayl' exclude each other; give only one of "
                "'preset', 'impedance_mrayl'  [objects[3].material]\n");
    expect_edit("mission:", /* a word alone is of the key that it is next to */
                "objects:\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: steal}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: sandd}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: clai}\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: unobtainium}\n"
                "mission:",
                "8:62: error: 'preset' = steal is not one of " PRESETS "; did you mean 'steel'?  "
                "[objects[0].material.preset]\n"
                "9:62: error: 'type' = sandd is not one of mud, sand, gravel, rock or a number in "
                "[1, 4]; did you mean 'sand'?  [objects[1].material.type]\n"
                "10:62: error: 'sediment' = clai is not one of rough_rock, rock, cobble, "
                "sandy_gravel, very_coarse_sand, coarse_sand, medium_sand, fine_sand, "
                "very_fine_sand, clayey_sand, coarse_silt, sandy_silt, medium_silt, sandy_mud, "
                "fine_silt, sandy_clay, very_fine_silt, silty_clay, clay; did you mean 'clay'?  "
                "[objects[2].material.sediment]\n"
                "11:62: error: 'preset' = unobtainium is not one of " PRESETS "  "
                "[objects[3].material.preset]\n");
}

static void names_are_fit_for_files_and_differ(void **state) {
    (void)state;
    expect_edit("forward", "a/b",
                "6:13: error: 'name' = a/b is not fit for file names; use letters, digits, '_', "
                "'-' and '.', beginning with a letter, digit or '_'  [sonar.receivers[0].name]\n");
    expect_edit("forward", "..",
                "6:13: error: 'name' = .. is not fit for file names; use letters, digits, '_', "
                "'-' and '.', beginning with a letter, digit or '_'  [sonar.receivers[0].name]\n");
    expect_edit("forward", "''",
                "6:13: error: 'name' = \"\" is not a name  [sonar.receivers[0].name]\n");
    expect_edit("forward", "\"a\\0b\"",
                "6:13: error: 'name' holds a zero character  [sonar.receivers[0].name]\n");
    expect_edit("forward", "a123456789a123456789a123456789a123456789a123456789a123456789abcd",
                "6:13: error: 'name' = a123456789a123456789a123456789a123456789... has 64 "
                "characters, at most 63 are possible  [sonar.receivers[0].name]\n");
    expect_edit("forward", "a123456789a123456789a123456789a123456789a123456789a123456789abc", "");
    expect_edit("- name: forward", "- name: a\n    - name: b\n    - name: a",
                "8:13: error: 'name' = a is the name of the entry at line 6 already  "
                "[sonar.receivers[2].name]\n");
    expect_edit("- name: forward", "- name: '001'\n    - yaw_deg: 3",
                "7:7: error: 'name' = 001 is the name of the entry at line 6 already  "
                "[sonar.receivers[1]]\n");
    expect_edit(
        "mission:", "objects:\n  - {name: None, point: -20, position_m: [1, 2, 3]}\nmission:", "");
    expect_edit("mission:",
                "objects:\n"
                "  - {name: none, point: -20, position_m: [1, 2, 3]}\n"
                "  - {name: ghost, point: -20, position_m: [1, 2, 4]}\n"
                "  - {name: faint, point: -20, position_m: [1, 2, 5]}\n"
                "mission:",
                "8:12: error: 'name' = none is what detections that are no object's are called; "
                "give another  [objects[0].name]\n"
                "9:12: error: 'name' = ghost is what detections that are no object's are called; "
                "give another  [objects[1].name]\n"
                "10:12: error: 'name' = faint is what detections that are no object's are called; "
                "give another  [objects[2].name]\n");
}

static void keys_must_fit_together(void **state) {
    (void)state;
    expect_edit("100\n", "100\n  max_range_m: 74.5\n", "");
    expect_edit("100\n", "100\n  max_range_m: 75\n",
                "5:16: error: 'max_range_m' = 75 is more than the 74.505 m that echoes come from "
                "before the next ping, c / (2 ping_rate_hz); lower it or 'ping_rate_hz'  "
                "[sonar.max_range_m]\n");
    expect_edit("100\n", "100\n  max_range_m: 20\n  blanking_m: 30\n",
                "6:15: error: 'blanking_m' = 30 is not below the maximum range of 20 m; lower it "
                "or raise 'max_range_m'  [sonar.blanking_m]\n");
    expect_edit(
        "100\n", "100\n  max_range_m: 20.3\n  bin_length_m: 0.5\n  blanking_m: 20\n",
        "7:15: error: 'blanking_m' = 20 leaves no bin, as the last ends at 20 m; lower it or "
        "'bin_length_m'  [sonar.blanking_m]\n");
    expect_edit("100\n", "100\n  blanking_m: 80\n",
                "5:15: error: 'blanking_m' = 80 is not below the maximum range of 74.51 m, which "
                "is c / (2 ping_rate_hz); lower it or 'ping_rate_hz'  [sonar.blanking_m]\n");
    expect_edit("100\n", "100\n  bin_length_m: 0.001\n",
                "5:17: error: 'bin_length_m' = 0.001 makes 74505 bins of the maximum range of "
                "74.51 m, at most 65536 are possible; lengthen it or raise 'ping_rate_hz'  "
                "[sonar.bin_length_m]\n");
    expect_edit("100\n", "100\n  bin_length_m: 75\n",
                "5:17: error: 'bin_length_m' = 75 is more than the maximum range of 74.51 m, which "
                "is c / (2 ping_rate_hz); lower it or 'ping_rate_hz'  [sonar.bin_length_m]\n");
    /* What a wrong length has nothing to do with is said beside it. */
    expect_edit("100\n", "100\n  max_range_m: 20\n  bin_length_m: 1001\n  blanking_m: 30\n",
                "6:17: error: 'bin_length_m' = 1001 is out of range [0.001, 1000] m  "
                "[sonar.bin_length_m]\n"
                "7:15: error: 'blanking_m' = 30 is not below the maximum range of 20 m; lower it "
                "or raise 'max_range_m'  [sonar.blanking_m]\n");
    expect_edit("100\n", "100\n  max_range_m: 20\n  bin_length_m: 21\n  blanking_m: 10001\n",
                "6:17: error: 'bin_length_m' = 21 is more than the maximum range of 20 m; lower it "
                "or raise 'max_range_m'  [sonar.bin_length_m]\n"
                "7:15: error: 'blanking_m' = 10001 is out of range [0.01, 10000] m  "
                "[sonar.blanking_m]\n");
    expect_edit("100\n", "100\n  max_range_m: 1.4\n  bin_length_m: 1001\n  blanking_m: 1.2\n",
                "6:17: error: 'bin_length_m' = 1001 is out of range [0.001, 1000] m  "
                "[sonar.bin_length_m]\n");
    /* What hangs on a wrong value is not judged: ranges on the longest one and the sound speed. */
    expect_edit("100\n", "100\n  max_range_m: 0\n  blanking_m: 80\n",
                "5:16: error: 'max_range_m' = 0 is out of range [0.01, 100000] m  "
                "[sonar.max_range_m]\n");
    expect_edit(
        "bottom: {depth_m: 12}\nsonar:\n",
        "environment: {sound_speed_mps: 1}\nbottom: {depth_m: 12}\nsonar:\n  blanking_m: 80\n",
        "2:32: error: 'sound_speed_mps' = 1 is out of range [1300, 1700] m/s  "
        "[environment.sound_speed_mps]\n");
    expect_edit("bottom: {depth_m: 12}",
                "environment: {sound_speed_mps: 1500, sound_speed_gradient_per_s: -20}\n"
                "bottom: {depth_m: 12}",
                "2:66: error: 'sound_speed_gradient_per_s' = -20 takes the sound speed of 1500 "
                "m/s at the surface to 1300 m/s at a depth of 10 m; the bottom is at 12 m: give a "
                "'sound_speed_profile' that ends where the gradient does  "
                "[environment.sound_speed_gradient_per_s]\n");
    /* At 7 m sound is at 1430 m/s: 71 whole bins of 1 m before the next ping. */
    expect_edit("bottom: {depth_m: 12}\nsonar:\n",
                "environment: {sound_speed_mps: 1500, sound_speed_gradient_per_s: -10}\n"
                "bottom: none\nsonar:\n  bin_length_m: 1\n",
                "2:66: error: 'sound_speed_gradient_per_s' = -10 takes the sound speed of 1500 "
                "m/s at the surface to 1300 m/s at a depth of 20 m; without a bottom rays go down "
                "to 78 m: give a 'sound_speed_profile' that ends where the gradient does  "
                "[environment.sound_speed_gradient_per_s]\n");
    /* Bins are not counted of a range that is not known. */
    expect_edit("100\n", "100\n  ping_rate_hz: fast\n  bin_length_m: 0.001\n",
                "5:17: error: 'ping_rate_hz' = fast is not a number; give a number in "
                "[0.01, 1000] Hz  [sonar.ping_rate_hz]\n");
    expect_edit(
        "bottom: {depth_m: 12}\nsonar:\n",
        "environment: {sound_speed_mps: fast}\n"
        "bottom: {depth_m: 12}\nsonar:\n  bin_length_m: 0.001\n",
        "2:32: error: 'sound_speed_mps' = fast is not a number; give a number in [1300, 1700] m/s  "
        "[environment.sound_speed_mps]\n");
    expect_edit("100\n", "100\n  bandwidth_khz: 201\n",
                "5:18: error: 'bandwidth_khz' = 201 is more than twice 'frequency_khz' = 100; the "
                "band would begin below zero  [sonar.bandwidth_khz]\n");
    expect_edit("frequency_khz: 100\n", "frequency_khz: 4\n",
                "4:3: error: 'bandwidth_khz' = 10 is more than twice 'frequency_khz' = 4; the "
                "band would begin below zero  [sonar]\n");
    expect_edit("100\n", "100\n  speckle: k\n",
                "5:12: error: 'speckle' = k needs a 'speckle_shape': 0.5 is spiky, 50 nearly "
                "Rayleigh  [sonar.speckle]\n");
    expect_edit("100\n", "100\n  speckle: rayleigh\n  speckle_shape: 2\n",
                "6:3: error: 'speckle_shape' has no effect without 'speckle: k'; leave it out  "
                "[sonar]\n");
    expect_edit("100\n", "100\n  speckle: k\n  speckle_shape: 2\n  rear_floor_db: -30\n", "");
    expect_edit("[0, 0, 7]", "[0, 0, -2]",
                "8:29: error: the sonar is 2 m above the sea surface; z is positive down  "
                "[mission.pose.position_m[2]]\n");
    expect_edit("[0, 0, 7]", "[0, 0, 0]", "");
    expect_edit("{depth_m: 12}", "{none: false}",
                "2:16: error: 'none' = false does not say what the bottom is; give 'depth_m', "
                "'mesh' or 'grid'  [bottom.none]\n");
    expect_edit("{depth_m: 12}", "{depth_m: 12, position_m: [0, 0, 1]}",
                "2:23: error: 'position_m' has no effect on a flat bottom; leave it out  "
                "[bottom]\n");
    expect_edit("{depth_m: 12}", "{none: true, type: sand}",
                "2:22: error: 'type' has no effect without a bottom; leave it out  [bottom]\n");
    expect_edit("{depth_m: 12}", "none", "");
    expect_edit("mission:",
                "objects:\n"
                "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3],\n"
                "     material: {type: rock, slope_rms: 0.1}}\n"
                "mission:",
                "9:29: error: 'slope_rms' has no effect beside 'type'; give only one of them  "
                "[objects[0].material]\n");
}

/* How far a ping is heard before the next goes by the speed of sound at the sonar's depth. */
static void ranges_are_those_of_the_sonars_depth(void **state) {
    (void)state;
    static const struct {
        double depth_m, range_m;
    } sonars[] = {{0, 72.5}, {0.5, 75}, {1, 77.5}, {6, 76.25}, {11, 75}};
    for (size_t i = 0; i < sizeof sonars / sizeof *sonars; i++) {
        for (int side = -1; side <= 1; side += 2) {
            char text[512], error[256] = "";
            snprintf(text, sizeof text,
                     "version: 1\n"
                     "environment: {sound_speed_profile: [[0, 1450], [1, 1550], [11, 1500]]}\n"
                     "bottom: {depth_m: 12}\n"
                     "sonar:\n"
                     "  frequency_khz: 100\n"
                     "  max_range_m: %g\n"
                     "  receivers: [{name: forward}]\n"
                     "mission: {pose: {position_m: [0, 0, %g]}}\n",
                     sonars[i].range_m + side * 0.01, sonars[i].depth_m);
            if (side > 0) {
                snprintf(error, sizeof error,
                         "6:16: error: 'max_range_m' = %.15g is more than the %.5g m that echoes "
                         "come from before the next ping, c / (2 ping_rate_hz); lower it or "
                         "'ping_rate_hz'  [sonar.max_range_m]\n",
                         sonars[i].range_m + 0.01, sonars[i].range_m);
            }
            expect_errors(text, error);
        }
    }
}

/* All that is wrong with a profile is told at once, each value by what it is. */
static void profiles_are_told_whole(void **state) {
    (void)state;
    static const char bottom[] = "bottom: {depth_m: 12}";
#define PROFILE(points)                                                                            \
    "environment: {sound_speed_profile: " points "}\n"                                             \
    "bottom: {depth_m: 12}"
    expect_edit(
        bottom, PROFILE("[[0, 1500], [0, 1490], [5, x], [3, 99], [12000, 1500], [7, 1490]]"),
        "2:48: error: a depth of 0 m is not below the 0 m before; order the points from the "
        "surface down, each depth once  [environment.sound_speed_profile[1]]\n"
        "2:63: error: 'sound_speed_profile' = x is not a number; give a number in "
        "[1300, 1700] m/s  [environment.sound_speed_profile[2][1]]\n"
        "2:67: error: a depth of 3 m is not below the 5 m before; order the points from the "
        "surface down, each depth once  [environment.sound_speed_profile[3]]\n"
        "2:71: error: 'sound_speed_profile' = 99 is out of range [1300, 1700] m/s  "
        "[environment.sound_speed_profile[3][1]]\n"
        "2:77: error: 'sound_speed_profile' = 12000 is out of range [0, 11000] m  "
        "[environment.sound_speed_profile[4][0]]\n");
    expect_edit(bottom, PROFILE("[[0, 1500], [5], [3, 1490]], sound_speed_mps: 1490"),
                "2:48: error: 'sound_speed_profile' has 1 entry; it must be a list of 2 numbers in "
                "m and m/s  [environment.sound_speed_profile[1]]\n"
                "2:65: error: 'sound_speed_mps' has no effect beside 'sound_speed_profile'; give "
                "only one of them  [environment]\n");
#undef PROFILE
}

#define ARRAY "  array: {elements: 32, beams: {count: 64, sector_deg: 90}}\n"
#define RECEIVERS "  receivers:\n    - name: forward\n"

static void arrays_are_checked(void **state) {
    (void)state;
    expect_edit(RECEIVERS, ARRAY, "");
    expect_edit(RECEIVERS, "",
                "4:3: error: missing key 'receivers' (the receiving apertures: a list, or fan: "
                "{count, sector_deg, ...})  [sonar]\n");
    expect_edit(RECEIVERS, ARRAY RECEIVERS,
                "6:3: error: 'array' and 'receivers' exclude each other; give only one of "
                "'receivers', 'array'  [sonar]\n");
    expect_edit(RECEIVERS, "  array: {elements: 1025, beams: {count: 64, sector_deg: 90}}\n",
                "5:21: error: 'elements' = 1025 is out of range [2, 1024]  "
                "[sonar.array.elements]\n");
    expect_edit(RECEIVERS,
                "  array: {elements: 32, shading: tailor, beams: {count: 64, sector_deg: 90}}\n",
                "5:34: error: 'shading' = tailor is not one of none, hann, taylor, chebyshev; "
                "did you mean 'taylor'?  [sonar.array.shading]\n");
    expect_edit(RECEIVERS,
                "  array: {elements: 32, side_lobe_db: -30, beams: {count: 64, sector_deg: 90}}\n",
                "5:25: error: 'side_lobe_db' has no effect without 'shading: taylor' or 'shading: "
                "chebyshev'; leave it out  [sonar.array]\n");
}

#define COHERENT "sampling: {coherent: true}\nmission:"

static void coherent_pings_are_checked(void **state) {
    (void)state;
    expect_edit("mission:", COHERENT,
                "7:22: error: 'coherent' = true needs the elements of an array: give 'array' in "
                "'sonar' in place of 'receivers'  [sampling.coherent]\n");
    expect_edit(RECEIVERS "mission:", ARRAY COHERENT, "");
    expect_edit(RECEIVERS "mission:", ARRAY "  speckle: rayleigh\n" COHERENT,
                "6:3: error: 'speckle' has no effect on coherent pings, which have their own; "
                "leave it out  [sonar]\n");
    expect_edit(RECEIVERS "mission:", ARRAY "  speckle: none\n" COHERENT, "");
    static const char *const bent[] = {"sound_speed_gradient_per_s: 0.1",
                                       "sound_speed_gradient_per_s: -0.1",
                                       "sound_speed_profile: [[0, 1490], [20, 1480]]"};
    for (size_t i = 0; i < sizeof bent / sizeof *bent; i++) {
        char edit[400];
        snprintf(edit, sizeof edit, ARRAY "environment: {%s}\n" COHERENT, bent[i]);
        expect_edit(RECEIVERS "mission:", edit,
                    "7:22: error: 'coherent' = true needs one sound speed at all depths; add "
                    "'model: {refraction: off}' or leave the profile or gradient out  "
                    "[sampling.coherent]\n");
        snprintf(edit, sizeof edit, ARRAY "environment: {%s}\nmodel: {refraction: off}\n" COHERENT,
                 bent[i]);
        expect_edit(RECEIVERS "mission:", edit, "");
    }
    expect_edit(
        RECEIVERS "mission:", ARRAY "environment: {sound_speed_gradient_per_s: 0}\n" COHERENT, "");
}

static void elements_need_coherent_pings(void **state) {
    (void)state;
    expect_edit("mission:", "output: {elements: true}\nmission:",
                "7:20: error: 'elements' = true needs pressures: add 'sampling: {coherent: true}'  "
                "[output.elements]\n");
}

static void coherent_pings_have_no_truth(void **state) {
    (void)state;
    expect_edit(RECEIVERS "mission:", ARRAY "output: {truth: true}\n" COHERENT,
                "6:17: error: 'truth' = true is not known of coherent pings: leave 'truth' or "
                "'coherent' out  [output.truth]\n");
    expect_edit(RECEIVERS "mission:", ARRAY "output: {truth: false}\n" COHERENT, "");
}

/* A value that could not be read hides no more than what hangs on it. */
static void relations_are_judged_beside_other_errors(void **state) {
    (void)state;
    expect_edit("{depth_m: 12}", "{depth_m: 12, type: sandd, lambert_db: -27}",
                "2:23: error: 'type' has no effect beside 'lambert_db'; give only one of them  "
                "[bottom]\n"
                "2:29: error: 'type' = sandd is not one of mud, sand, gravel, rock or a number in "
                "[1, 4]; did you mean 'sand'?  [bottom.type]\n");
    expect_edit("{depth_m: 12}", "{none: true, type: sandd, position_m: [1, 2, 3]}",
                "2:22: error: 'type' has no effect without a bottom; leave it out  [bottom]\n"
                "2:28: error: 'type' = sandd is not one of mud, sand, gravel, rock or a number in "
                "[1, 4]; did you mean 'sand'?  [bottom.type]\n"
                "2:35: error: 'position_m' has no effect without a bottom; leave it out  "
                "[bottom]\n");
    expect_edit("  pose: {position_m: [0, 0, 7]}", "  pose: {position_m: [0, 0, -7], yaw_deg: x}",
                "8:29: error: the sonar is 7 m above the sea surface; z is positive down  "
                "[mission.pose.position_m[2]]\n"
                "8:43: error: 'yaw_deg' = x is not a number; give a number in [-360, 360] deg  "
                "[mission.pose.yaw_deg]\n");
    expect_edit("  pose: {position_m: [0, 0, 7]}",
                "  waypoints: {speed_mps: x, points_m: [[0, 0, 5], [1, 0, -5]]}",
                "8:26: error: 'speed_mps' = x is not a number; give a number in [0.05, 20] m/s  "
                "[mission.waypoints.speed_mps]\n"
                "8:58: error: the waypoint is 5 m above the sea surface; z is positive down  "
                "[mission.waypoints.points_m[1][2]]\n");
}

static void waypoints_can_be_flown(void **state) {
    (void)state;
    const char *pose = "  pose: {position_m: [0, 0, 7]}";
    expect_edit(pose, "  waypoints: [[0, 0, 7], [9, 0, 7]]", "");
    expect_edit(pose, "  waypoints: {points_m: [[0, 0, 7], [9, 0, 7]], speed_mps: 2}", "");
    expect_edit(pose, "  waypoints: [[4, 5, 7], [-4, 5, 7], [-4, -5, 7], [-4, -5.002, 7]]", "");
    expect_edit(pose, "  waypoints: [[4, 5, 7], [4, 5.0005, 7]]",
                "8:26: error: the waypoint is at the same place as the one before, or straight "
                "above or below it; the vehicle needs a way to fly  "
                "[mission.waypoints.points_m[1]]\n");
    expect_edit(pose, "  waypoints: [[0, 0, 7]]",
                "8:14: error: 'points_m' has 1 entries, which is out of range [2, 10000]  "
                "[mission.waypoints.points_m]\n");
    expect_edit(pose, "  waypoints: [[0, 0, 7], [1, 2], 3, [x, 1e9, 0]]",
                "8:26: error: 'points_m' has 2 entries; it must be a list of 3 numbers in m  "
                "[mission.waypoints.points_m[1]]\n"
                "8:34: error: 'points_m' = 3 is not a list of 3 numbers in m  "
                "[mission.waypoints.points_m[2]]\n"
                "8:38: error: 'points_m' = x is not a number; give a number in "
                "[-10000000, 10000000] m  "
                "[mission.waypoints.points_m[3][0]]\n"
                "8:41: error: 'points_m' = 1e9 is out of range [-10000000, 10000000] m  "
                "[mission.waypoints.points_m[3][1]]\n");
    expect_edit(pose,
                "  waypoints: {dive_rate_mps: 2, points_m: [[0, 0, 7], [0, 0, 9], [9, 0, -1]]}",
                "8:30: error: 'dive_rate_mps' = 2 is not below 'speed_mps' = 1.5  "
                "[mission.waypoints.dive_rate_mps]\n"
                "8:55: error: the waypoint is at the same place as the one before, or straight "
                "above or below it; the vehicle needs a way to fly  "
                "[mission.waypoints.points_m[1]]\n"
                "8:73: error: the waypoint is 1 m above the sea surface; z is positive down  "
                "[mission.waypoints.points_m[2][2]]\n");
    expect_edit(pose,
                "  waypoints: {points_m: [[0, 0, 7], [99, 0, 7]], vehicle: remus100, "
                "current_mps: [0.5, -0.5], altitude_m: 2}",
                "");
    expect_errors(
        "version: 1\nbottom: none\n"
        "mission: {waypoints: {points_m: [[0, 0, 7], [99, 0, 7]], altitude_m: 2}}\n"
        "sonar: {frequency_khz: 100, ping_rate_hz: 10, receivers: [{name: a}]}\n",
        "3:70: error: 'altitude_m' has no effect with 'bottom: none', below which there is "
        "nothing to keep above; leave it out or give a bottom  "
        "[mission.waypoints.altitude_m]\n");
    expect_edit(
        pose,
        "  waypoints: {points_m: [[0, 0, 7], [99, 0, 7]], vehicle: remus100, speed_mps: 3, "
        "response_s: 2, current_mps: [-4, 0]}",
        "8:80: error: 'speed_mps' = 3 is outside the 1 to 2.5 m/s for which 'vehicle: "
        "remus100' is valid; change it or give 'vehicle: nomoto'  "
        "[mission.waypoints.speed_mps]\n"
        "8:83: error: 'response_s' has no effect on 'vehicle: remus100', which has its own; "
        "leave it out  [mission.waypoints]\n"
        "8:111: error: 'current_mps' runs at 4 m/s against the line to point 1, which a vehicle of "
        "'speed_mps' = 3 makes no headway on; raise 'speed_mps', or give the way as 'track'  "
        "[mission.waypoints.current_mps]\n");
    /* North, then east. */
    static const char across[] = "8:90: error: 'current_mps' runs at %s m/s across the line to "
                                 "point %d, which a vehicle of 'speed_mps' = 4 cannot hold; raise "
                                 "'speed_mps', or give the way as 'track'  "
                                 "[mission.waypoints.current_mps]\n";
    static const struct {
        const char *current_mps, *across_mps;
        int point;
    } currents[] = {{"0, 2.57", "", 0}, {"3.9, 3.9", "", 0},   {"-2.8, -2.8", "", 0},
                    {"0, 4", "4", 1},   {"9, -4.2", "4.2", 1}, {"9, 0", "9", 2},
                    {"9, 3", "9", 2},   {"-9, -9", "9", 1}};
    for (size_t i = 0; i < sizeof currents / sizeof *currents; i++) {
        char edit[200], expected[300] = "";
        snprintf(edit, sizeof edit,
                 "  waypoints: {points_m: [[0, 0, 7], [99, 0, 7], [99, 99, 7]], speed_mps: 4, "
                 "current_mps: [%s]}",
                 currents[i].current_mps);
        if (currents[i].point) {
            snprintf(expected, sizeof expected, across, currents[i].across_mps, currents[i].point);
        }
        expect_edit(pose, edit, expected);
    }
}

static void all_errors_come_in_one_run_in_order(void **state) {
    (void)state;
    expect_errors("version: 1\n"
                  "environment: {ph: 3, salnity_ppt: 35, ph: 8}\n"
                  "bottom: {depth_m: -1, type: clay}\n"
                  "sonar:\n"
                  "  frequency_khz: 9000\n"
                  "  receivers: [{pitch_deg: 1e3}, {name: a b}]\n"
                  "mission: {pose: {position_m: [0, 0, 900]}, pings: 0}\n",
                  "2:19: error: 'ph' = 3 is out of range [7, 8.5]  [environment.ph]\n"
                  "2:22: error: unknown key 'salnity_ppt'; did you mean 'salinity_ppt'?  "
                  "[environment]\n"
                  "2:39: error: duplicate key 'ph'; it is given at line 2 already  "
                  "[environment]\n"
                  "3:19: error: 'depth_m' = -1 is out of range [0.01, 11000] m  "
                  "[bottom.depth_m]\n"
                  "3:29: error: 'type' = clay is not one of mud, sand, gravel, rock or a number "
                  "in [1, 4]  [bottom.type]\n"
                  "5:18: error: 'frequency_khz' = 9000 is out of range [0.1, 3000] kHz  "
                  "[sonar.frequency_khz]\n"
                  "6:27: error: 'pitch_deg' = 1e3 is out of range [-180, 180] deg  "
                  "[sonar.receivers[0].pitch_deg]\n"
                  "6:40: error: 'name' = a b is not fit for file names; use letters, digits, '_', "
                  "'-' and '.', beginning with a letter, digit or '_'  "
                  "[sonar.receivers[1].name]\n"
                  "7:51: error: 'pings' = 0 is out of range [1, 1000000000]  [mission.pings]\n");
}

static void only_a_hundred_errors_are_shown(void **state) {
    (void)state;
    asdic_text text = {0};
    asdic_text_add(&text, MINIMAL);
    asdic_text_add(&text, "surface:\n");
    for (int i = 0; i < 150; i++) {
        asdic_text_format(&text, "  zzzz%d: 1\n", i);
    }
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(text.data, text.length, &arena, &file);
    assert_non_null(strstr(errors, "zzzz99'"));
    assert_null(strstr(errors, "zzzz100'"));
    assert_non_null(strstr(errors, "scene.yaml: error: 50 more errors are not shown\n"));
    free(errors);
    asdic_text_finish(&text);
    asdic_arena_finish(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(minimal_scene_has_no_error),
        cmocka_unit_test(unknown_keys_are_answered),
        cmocka_unit_test(ranges_name_value_limit_and_unit),
        cmocka_unit_test(numbers_are_plain_decimal),
        cmocka_unit_test(rays_or_auto),
        cmocka_unit_test(words_and_booleans),
        cmocka_unit_test(maps_and_lists_have_their_form),
        cmocka_unit_test(null_is_no_value),
        cmocka_unit_test(slips_make_one_error),
        cmocka_unit_test(missing_keys_are_all_named),
        cmocka_unit_test(alternatives_exclude_each_other),
        cmocka_unit_test(points_and_presets_are_checked),
        cmocka_unit_test(names_are_fit_for_files_and_differ),
        cmocka_unit_test(keys_must_fit_together),
        cmocka_unit_test(ranges_are_those_of_the_sonars_depth),
        cmocka_unit_test(profiles_are_told_whole),
        cmocka_unit_test(arrays_are_checked),
        cmocka_unit_test(coherent_pings_are_checked),
        cmocka_unit_test(elements_need_coherent_pings),
        cmocka_unit_test(coherent_pings_have_no_truth),
        cmocka_unit_test(relations_are_judged_beside_other_errors),
        cmocka_unit_test(waypoints_can_be_flown),
        cmocka_unit_test(all_errors_come_in_one_run_in_order),
        cmocka_unit_test(only_a_hundred_errors_are_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
