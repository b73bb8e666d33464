#include "check.h"
#include "remarks.h"

#include <math.h>

/* Objects listed as text; a scene may have thousands. */
#define MOST_SHOWN 40

/* Values derived from a scene, not written in it. */
typedef struct scene_numbers {
    size_t pings, beams, bins;
    double depth_m; /* of the sonar at the first ping */
    double sound_speed_mps, absorption_db_per_km, range_m, duration_s;
    asdic_scene_info info;
    asdic_ray_forecast rays;
    asdic_coherent_forecast coherent; /* nought where pings are of intensities */
} scene_numbers;

static asdic_status find_numbers(cli *c, asdic_mission *m, scene_numbers *out) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    const asdic_environment *env = asdic_mission_environment(m);
    scene_numbers n = {.pings = asdic_mission_ping_count(m), .beams = sonar->receiver_count};
    double first_s = 0.0, last_s = 0.0;
    n.depth_m = asdic_mission_pose(m, 0, &first_s).position_m.z;
    asdic_mission_pose(m, n.pings - 1, &last_s);
    n.duration_s = last_s - first_s;
    n.sound_speed_mps = asdic_environment_sound_speed_mps(env, n.depth_m);
    n.absorption_db_per_km =
        asdic_environment_absorption_db_per_km(env, sonar->frequency_hz, n.depth_m);
    n.range_m = asdic_sonar_max_range_m(sonar, n.sound_speed_mps);
    n.bins = asdic_sonar_bin_count(sonar, n.sound_speed_mps);
    n.info = asdic_scene_get_info(asdic_mission_scene(m));
    n.rays = asdic_mission_ray_forecast(m);
    *out = n;
    return asdic_mission_sampling(m)->coherent
               ? asdic_mission_forecast_coherent(cli_context(c), m, &out->coherent)
               : ASDIC_OK;
}

static const char *bottom_kind(const asdic_mission *m, const scene_numbers *n) {
    const asdic_mission_object *first = asdic_mission_get_object(m, 0);
    return n->info.has_bottom_plane ? "flat" : first && !first->name[0] ? "mesh" : "none";
}

static void json_object(json *j, const asdic_mission_object *o) {
    json_open(j, NULL, '{');
    json_text(j, "name", o->name);
    json_integer(j, "triangles", o->mesh.triangles);
    json_integer(j, "dropped_facets", o->mesh.dropped);
    json_integer(j, "copied_facets", o->mesh.copies);
    json_integer(j, "open_edges", o->mesh.open_edges);
    json_bool(j, "moves", o->moves);
    check_json_vec(j, "min_m", o->min_m);
    check_json_vec(j, "max_m", o->max_m);
    json_text(j, "hint", o->mesh.hint[0] ? o->mesh.hint : NULL);
    json_close(j);
}

static void print_json(const char *path, const asdic_mission *m, const scene_numbers *n, json *j) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    json_open(j, NULL, '{');
    json_text(j, "file", path);
    json_bool(j, "valid", true);
    json_text(j, "kind", "scene");
    json_text(j, "sha256", asdic_mission_hash(m));
    json_integer(j, "pings", n->pings);
    json_number(j, "duration_s", n->duration_s);
    json_open(j, "beams", '[');
    for (size_t i = 0; i < n->beams; i++) {
        json_text(j, NULL, sonar->receivers[i].name);
    }
    json_close(j);
    cli_json_scan(j, m);
    json_integer(j, "bins", n->bins);
    json_number(j, "bin_length_m", sonar->bin_length_m);
    json_number(j, "blanking_m", sonar->blanking_m);
    json_number(j, "max_range_m", n->range_m);
    json_number(j, "sound_speed_mps", n->sound_speed_mps);
    json_number(j, "absorption_db_per_km", n->absorption_db_per_km);
    json_bool(j, "surface", n->info.has_surface);
    json_text(j, "bottom", bottom_kind(m, n));
    json_integer(j, "rays", n->rays.rays);
    json_bool(j, "rays_auto", n->rays.is_auto);
    json_number(j, "expected_stderr_db", n->rays.stderr_db);
    if (asdic_mission_sampling((asdic_mission *)m)->coherent) {
        json_open(j, "coherent", '{');
        json_integer(j, "scatterers", n->coherent.scatterers);
        json_integer(j, "bytes", n->coherent.bytes);
        json_bool(j, "fits", n->coherent.fits);
        json_number(j, "processor_s", n->coherent.processor_s);
        json_close(j);
    }
    cli_json_remarks(j, m);
    cli_json_size(j, m);
    json_integer(j, "triangles", n->info.triangles);
    json_open(j, "meshes", '[');
    for (size_t i = 0; i < asdic_mission_object_count(m); i++) {
        json_object(j, asdic_mission_get_object(m, i));
    }
    json_close(j);
    json_close(j);
}

/* Rounding residue of a quarter turn set to 0: cos(90 deg) gives 6e-17. */
static double tidy(double x_m) {
    return fabs(x_m) < 1e-9 ? 0.0 : x_m;
}

static void print_object(const asdic_mission_object *o) {
    const char *moves = o->moves ? "; moves, this is at ping 0" : "";
    const asdic_vec3 *low = &o->min_m, *high = &o->max_m;
    if (o->mesh.triangles == 0) {
        printf("  %-11s a point at x %.*g, y %.*g, z %.*g m%s\n", o->name, check_digits(low->x, 4),
               low->x, check_digits(low->y, 4), low->y, check_digits(low->z, 4), low->z, moves);
        return;
    }
    printf("  %-11s %zu triangle%s, ", o->name[0] ? o->name : "bottom", o->mesh.triangles,
           cli_plural(o->mesh.triangles));
    check_span("x ", tidy(low->x), tidy(high->x), 4);
    check_span(", y ", tidy(low->y), tidy(high->y), 4);
    check_span(", z ", tidy(low->z), tidy(high->z), 4);
    printf(" m%s\n", moves);
    if (o->mesh.dropped > 0) {
        printf("  %-11s %zu degenerate facets dropped\n", "", o->mesh.dropped);
    }
    if (o->mesh.copies > 0) {
        printf("  %-11s %zu copies of other facets dropped\n", "", o->mesh.copies);
    }
    if (o->mesh.open_edges > 0) {
        printf("  %-11s %zu open edges\n", "", o->mesh.open_edges);
    }
    if (o->mesh.hint[0]) {
        printf("  %-11s %s\n", "", o->mesh.hint);
    }
}

/* Besides a bottom that is a mesh, which comes first. */
static bool has_objects(const asdic_mission *m) {
    size_t count = asdic_mission_object_count(m);
    return count > 0 && asdic_mission_get_object(m, count - 1)->name[0];
}

static void print_text(const char *path, asdic_mission *m, const scene_numbers *n) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    printf("%s: a valid scene\n", path);
    printf("  pings       %zu in %.6g s\n", n->pings, n->duration_s);
    if (n->beams == 1) {
        printf("  beams       1: %s\n", sonar->receivers[0].name);
    } else {
        printf("  beams       %zu: %s .. %s\n", n->beams, sonar->receivers[0].name,
               sonar->receivers[n->beams - 1].name);
    }
    char scan[CLI_SCAN_SIZE];
    cli_scan_words(m, scan);
    if (*scan) {
        printf("  scan        %s\n", scan);
    }
    printf("  bins        %zu of %.4g m, from %.4g to %.5g m\n", n->bins, sonar->bin_length_m,
           sonar->blanking_m, n->range_m);
    printf("  rays        %u a ping%s", n->rays.rays, n->rays.is_auto ? " (auto)" : "");
    if (asdic_mission_sampling(m)->coherent) {
        char bytes[ASDIC_BYTES_TEXT];
        printf(", as scatterers of coherent pings\n");
        printf(
            "  scatterers  %s%zu a ping, where cells and smooth bodies take what they need; %s of "
            "memory%s, about %.2g s of processor time\n",
            n->coherent.fits ? "" : "more than ", n->coherent.scatterers,
            asdic_bytes_text(n->coherent.bytes, bytes),
            n->coherent.fits ? "" : ", which there is not", n->coherent.processor_s);
    } else if (isnan(n->rays.stderr_db)) {
        printf(", for an error that 'asdic plan' measures\n");
    } else {
        printf(", for a stated error of about %.2g dB r.m.s.%s\n", n->rays.stderr_db,
               has_objects(m) ? ", more at objects' edges" : "");
    }
    printf("  water       %.6g m/s and %.4g dB/km at %.4g kHz, %.4g m deep\n", n->sound_speed_mps,
           n->absorption_db_per_km, 1e-3 * sonar->frequency_hz, n->depth_m);
    printf("  surface     %s\n", n->info.has_surface ? "at z = 0" : "none");
    if (n->info.has_bottom_plane) {
        printf("  bottom      flat at z = %.6g m\n", n->info.bottom_plane_depth_m);
    } else if (bottom_kind(m, n)[0] == 'n') {
        printf("  bottom      none\n");
    }
    char size[CLI_SIZE_TEXT];
    printf("  output      %s\n", cli_size(m, n->pings, ".", size));
    size_t count = asdic_mission_object_count(m), shown = count > MOST_SHOWN ? MOST_SHOWN : count;
    for (size_t i = 0; i < shown; i++) {
        print_object(asdic_mission_get_object(m, i));
    }
    if (count > shown) {
        printf("  ...         %zu more; --json lists all\n", count - shown);
    }
}

asdic_status check_scene(cli *c, const char *path, json *j) {
    asdic_mission *mission = NULL;
    TRY(asdic_mission_load(cli_context(c), path, &mission));
    scene_numbers numbers;
    asdic_status status = asdic_mission_check_draws(cli_context(c), mission);
    status = status ? status : find_numbers(c, mission, &numbers);
    if (status) {
        asdic_mission_destroy(&mission);
        return status;
    }
    if (j) {
        print_json(path, mission, &numbers, j);
    } else if (!cli_quiet(c)) {
        print_text(path, mission, &numbers);
        cli_remark(c, path, mission, false);
        cli_remark_csv(c, path, mission);
    }
    asdic_mission_destroy(&mission);
    return ASDIC_OK;
}
