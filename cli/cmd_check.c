/* Tells scenes from meshes and collects the results; check_scene.c and check_mesh.c report on
 * each. */
#include "check.h"
#include "commands.h"

#include <string.h>
#include <strings.h>

/* Whether PATH ends in one of WORDS, which end with NULL, upper or lower case. */
static bool has_suffix(const char *path, const char *const *words) {
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && !strchr(dot, '/') && words[i]; i++) {
        if (strcasecmp(dot + 1, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

static asdic_status check_file(cli *c, const char *path, json *j) {
    /* Formats behind "off" and "asc" cannot be read; the library has the better message for
     * them. */
    static const char *const meshes[] = {"obj", "ply", "stl", "off", "dae",  "gltf",  "glb", "fbx",
                                         "3ds", "x3d", "wrl", "stp", "step", "blend", NULL};
    static const char *const grids[] = {"asc", "nc", "tif", "tiff", NULL};
    if (has_suffix(path, meshes)) {
        return check_mesh(c, path, false, j);
    }
    if (has_suffix(path, grids)) {
        return check_mesh(c, path, true, j);
    }
    return check_scene(c, path, j);
}

/* The entry of a failed check in the array of --json. */
static void print_failure(cli *c, const char *path, json *j) {
    json_open(j, NULL, '{');
    json_text(j, "file", path);
    json_bool(j, "valid", false);
    json_text(j, "error", asdic_context_error(cli_context(c)));
    json_close(j);
}

/* The track of the one scene that was named. */
static int write_track(cli *c) {
    const char *path = cli_text(c, "track");
    if (cli_operand_count(c) != 1) {
        return cli_usage(c, "--track takes one scene");
    }
    if (cli_given(c, "json")) {
        return cli_usage(c, "--track writes a table of poses, not --json");
    }
    if (strcmp(path, "-") == 0) {
        path = "/dev/stdout";
    } else if (!cli_may_write(c, path)) {
        return CLI_FAILED;
    }
    asdic_mission *mission = NULL;
    asdic_status status = asdic_mission_load(cli_context(c), cli_operand(c, 0), &mission);
    status = status ? status : asdic_mission_write_track(cli_context(c), mission, path);
    asdic_mission_destroy(&mission);
    return cli_end(c, status);
}

static int run(cli *c) {
    if (cli_given(c, "track")) {
        return write_track(c);
    }
    bool as_json = cli_given(c, "json");
    json j = json_begin(stdout);
    int code = CLI_OK;
    if (as_json) {
        json_open(&j, NULL, '[');
    }
    for (size_t i = 0; i < cli_operand_count(c); i++) {
        const char *path = cli_operand(c, i);
        asdic_status status = check_file(c, path, as_json ? &j : NULL);
        if (status != ASDIC_OK) {
            int failed = cli_end(c, status);
            code = code == CLI_OK || failed == CLI_INPUT ? failed : code;
            if (as_json) {
                print_failure(c, path, &j);
            }
        }
    }
    if (as_json) {
        json_close(&j);
    }
    return code;
}

static const cli_option options[] = {
    {"track", 0, "FILE", "write the vehicle's pose at every ping as CSV, '-' to stdout"},
    {"force", 'f', NULL, "overwrite FILE"},
    {0},
};

const cli_command cli_check_command = {
    .name = "check",
    .operands = "SCENE.yaml|MESH ...",
    .min_operands = 1,
    .max_operands = CLI_ANY_NUMBER,
    .summary = "validate scene files and meshes, and say what is in them",
    .details =
        "Scenes are read as 'asdic run' reads them, with their meshes, grids and tracks, and "
        "the files that draws of a trial may bring; "
        "every error is named with line, column, key, value, limit and remedy; '-' is a "
        "scene on standard input. Meshes "
        "(.obj, .ply, .stl, .off) and grids (.asc) are described in their own axes and "
        "units. All files are looked at; the exit code is 3 when any of them is bad. With "
        "--quiet nothing else is told. With "
        "--track the way of one scene's vehicle is written instead, as a track that "
        "'mission: {track: FILE}' reads.",
    .examples = "asdic check scene.yaml wreck.ply depths.asc\n"
                "asdic check scene.yaml --track track.csv",
    .options = options,
    .traits = CLI_HAS_JSON,
    .run = run,
};
