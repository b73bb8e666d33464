/* `asdic bench rays`: goals and ratios; table, JSON, CSV. */
#include "bench_rays.h"
#include "json.h"

#include <math.h>
#include <string.h>

/* What each set is compared with: the mode that its rays ask for, or the best of all. */
typedef enum rival { RIVAL_SINGLE, RIVAL_COHERENT, RIVAL_BEST } rival;

static const struct {
    rival rival;
    double goal[BENCH_RAY_SCENES]; /* terrain, object, small; 0: none */
} goals[BENCH_RAY_SETS] = {
    [BENCH_CONE_DENSE] = {RIVAL_COHERENT, {1.5, 1.5, 1.5}},
    [BENCH_MIRRORED_DENSE] = {RIVAL_COHERENT, {0.8, 0.8, 0.8}},
    [BENCH_CONE] = {RIVAL_COHERENT, {0.95, 0.95, 0.95}},
    [BENCH_SPHERE_DENSE] = {RIVAL_COHERENT, {1.0, 1.0, 1.0}},
    [BENCH_SPHERE] = {RIVAL_BEST, {0.85, 0.85, 0.85}},
    [BENCH_SPHERE_RANDOM] = {RIVAL_SINGLE, {0.9, 1.25, 1.25}},
    [BENCH_MIRRORED_RANDOM] = {RIVAL_SINGLE, {0.95, 0.95, 0.95}},
    [BENCH_VERTICES] = {RIVAL_SINGLE, {0.0, 0.0, 0.0}},
};

double bench_ray_goal(const char *scene, bench_ray_set set) {
    static const char *const names[BENCH_RAY_SCENES] = {"terrain", "object", "small"};
    for (int i = 0; i < BENCH_RAY_SCENES; i++) {
        if (strcmp(scene, names[i]) == 0 && goals[set].goal[i] > 0.0) {
            return goals[set].goal[i];
        }
    }
    return NAN;
}

const char *bench_ray_rival(bench_ray_set set) {
    static const char *const names[] = {"rtcIntersect1", "rtcIntersect16 coherent", "best"};
    return names[goals[set].rival];
}

double bench_ray_ratio(const bench_ray_row *row) {
    const double *t = row->embree_s;
    double theirs = goals[row->set].rival == RIVAL_SINGLE     ? t[BENCH_EMBREE_SINGLE]
                    : goals[row->set].rival == RIVAL_COHERENT ? t[BENCH_EMBREE_COHERENT]
                                                              : fmin(fmin(t[0], t[1]), t[2]);
    return theirs / row->ours_s;
}

static double rate(const bench_ray_row *row, double seconds) {
    return (double)row->rays / seconds;
}

void bench_rays_head(const bench_ray_frame *f) {
    const char *embree = bench_embree_version();
    printf("%s, %u thread%s, %s time, %s%s\n", f->device->name, f->threads,
           f->threads == 1 ? "" : "s", f->clock, embree ? "against Embree " : "without Embree",
           embree ? embree : "");
}

static void print_row(const bench_ray_row *row) {
    printf("  %-16s %7zu  %-9s %8.2f", bench_ray_set_name(row->set), row->rays, row->kernel,
           1e-6 * rate(row, row->ours_s));
    if (!isnan(row->embree_s[0])) {
        double goal = row->goal, ratio = bench_ray_ratio(row);
        printf(" %8.2f %8.2f %8.2f", 1e-6 * rate(row, row->embree_s[0]),
               1e-6 * rate(row, row->embree_s[1]), 1e-6 * rate(row, row->embree_s[2]));
        printf("  %6.2f", ratio);
        if (isnan(goal)) {
            printf("         ");
        } else {
            printf(" %5.2f %-2s", goal, ratio >= goal ? "ok" : "no");
        }
        printf(" %9zu", row->disagree);
    }
    if (row->set == BENCH_VERTICES) {
        const bench_vertex_rays *ours = &row->at_vertices, *theirs = &row->embree_at_vertices;
        printf("  missed %zu; at a silhouette: grazed %zu, passed %zu", ours->missed, ours->grazed,
               ours->passed);
        if (!isnan(row->embree_s[0])) {
            printf("; Embree robust missed %zu, grazed %zu", theirs->missed, theirs->grazed);
        }
    }
    printf("\n");
}

void bench_rays_print(const bench_ray_result *r) {
    bool embree = bench_embree_version() != NULL;
    printf("%s: %zu triangles, %zu nodes, %.1f MB, built in %.3f s", r->scene, r->triangles,
           r->nodes, 1e-6 * (double)r->bytes, r->build_s);
    if (embree) {
        printf("; Embree %.3f s, %.2f of its time", r->embree_build_s,
               r->build_s / r->embree_build_s);
    }
    printf("\n  %-16s %7s  %-9s %8s%s\n", "set", "rays", "kernel", "Mrays/s",
           embree ? "   single  packet  coherent ratio  goal      disagree" : "");
    for (size_t i = 0; i < r->count; i++) {
        print_row(&r->rows[i]);
    }
    fflush(stdout);
}

static void json_row(json *j, const bench_ray_row *row) {
    json_open(j, NULL, '{');
    json_text(j, "set", bench_ray_set_name(row->set));
    json_integer(j, "rays", row->rays);
    json_integer(j, "hits", row->hits);
    json_text(j, "kernel", row->kernel);
    json_number(j, "rays_per_s", rate(row, row->ours_s));
    if (!isnan(row->embree_s[0])) {
        json_number(j, "embree_single_rays_per_s", rate(row, row->embree_s[0]));
        json_number(j, "embree_packet_rays_per_s", rate(row, row->embree_s[1]));
        json_number(j, "embree_coherent_rays_per_s", rate(row, row->embree_s[2]));
        json_text(j, "against", bench_ray_rival(row->set));
        json_number(j, "ratio", bench_ray_ratio(row));
        json_number(j, "goal", row->goal);
        json_integer(j, "disagree", row->disagree);
    }
    if (row->set == BENCH_VERTICES) {
        json_integer(j, "missed", row->at_vertices.missed);
        json_integer(j, "grazed_silhouette", row->at_vertices.grazed);
        json_integer(j, "past_silhouette", row->at_vertices.passed);
        if (!isnan(row->embree_s[0])) {
            json_integer(j, "embree_robust_missed", row->embree_at_vertices.missed);
        }
    }
    json_close(j);
}

void bench_rays_json(const bench_ray_frame *f, const bench_ray_result *results, size_t count) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", f->device->name);
    json_integer(&j, "threads", f->threads);
    json_text(&j, "clock", f->clock);
    json_text(&j, "embree", bench_embree_version());
    json_open(&j, "scenes", '[');
    for (size_t i = 0; i < count; i++) {
        const bench_ray_result *r = &results[i];
        json_open(&j, NULL, '{');
        json_text(&j, "scene", r->scene);
        json_integer(&j, "triangles", r->triangles);
        json_integer(&j, "nodes", r->nodes);
        json_integer(&j, "bytes", r->bytes);
        json_number(&j, "build_s", r->build_s);
        if (bench_embree_version()) {
            json_number(&j, "embree_build_s", r->embree_build_s);
        }
        json_open(&j, "rows", '[');
        for (size_t k = 0; k < r->count; k++) {
            json_row(&j, &r->rows[k]);
        }
        json_close(&j);
        json_close(&j);
    }
    json_close(&j);
    json_close(&j);
}

/* An empty field where there is nothing to say. */
static void put_number(FILE *file, double value) {
    if (isfinite(value)) {
        fprintf(file, ",%.6g", value);
    } else {
        fprintf(file, ",");
    }
}

int bench_rays_csv(const cli *c, const char *path, const bench_ray_frame *f,
                   const bench_ray_result *results, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(file, "scene,triangles,threads,build_s,embree_build_s,set,rays,hits,kernel,rays_per_s,"
                  "embree_single_rays_per_s,embree_packet_rays_per_s,embree_coherent_rays_per_s,"
                  "ratio,goal,disagree,missed,embree_robust_missed\n");
    for (size_t i = 0; i < count; i++) {
        const bench_ray_result *r = &results[i];
        for (size_t k = 0; k < r->count; k++) {
            const bench_ray_row *row = &r->rows[k];
            bool vertices = row->set == BENCH_VERTICES, embree = !isnan(row->embree_s[0]);
            fprintf(file, "%s,%zu,%u,%.6g", r->scene, r->triangles, f->threads, r->build_s);
            put_number(file, r->embree_build_s);
            fprintf(file, ",%s,%zu,%zu,%s", bench_ray_set_name(row->set), row->rays, row->hits,
                    row->kernel);
            put_number(file, rate(row, row->ours_s));
            for (int mode = 0; mode < BENCH_EMBREE_MODES; mode++) {
                put_number(file, rate(row, row->embree_s[mode]));
            }
            put_number(file, bench_ray_ratio(row));
            put_number(file, embree ? row->goal : NAN);
            put_number(file, embree ? (double)row->disagree : NAN);
            put_number(file, vertices ? (double)row->at_vertices.missed : NAN);
            put_number(file, vertices && embree ? (double)row->embree_at_vertices.missed : NAN);
            fprintf(file, "\n");
        }
    }
    return bench_end_file(c, file, path);
}
