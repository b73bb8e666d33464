#include "chart.h"
#include "scene.h"

#include <math.h>

/* A triangle in cells: x columns from the west edge, y rows from the north edge, z depth. */
typedef struct flat_triangle {
    double x[3], y[3], z[3];
} flat_triangle;

static flat_triangle flatten(const asdic_scene *scene, const dev_triangle *t,
                             const asdic_relief *r) {
    const float *corners[3] = {t->v0, t->v1, t->v2};
    double north_m = r->south_m + (double)r->rows * r->cell_m;
    flat_triangle f;
    for (int i = 0; i < 3; i++) {
        f.x[i] = (scene->origin_m.y + (double)corners[i][1] - r->west_m) / r->cell_m;
        f.y[i] = (north_m - scene->origin_m.x - (double)corners[i][0]) / r->cell_m;
        f.z[i] = scene->origin_m.z + (double)corners[i][2];
    }
    return f;
}

static double least(const double v[3]) {
    return fmin(v[0], fmin(v[1], v[2]));
}

static double most(const double v[3]) {
    return fmax(v[0], fmax(v[1], v[2]));
}

/* Indices of the cells whose centres lie in [LOW, HIGH], of COUNT: *FIRST to *END - 1. */
static void cells_in(double low, double high, size_t count, size_t *first, size_t *end) {
    double a = fmax(ceil(low - 0.5), 0.0), b = fmin(floor(high - 0.5) + 1.0, (double)count);
    *first = a < b ? (size_t)a : 0;
    *end = a < b ? (size_t)b : 0;
}

static void draw(const flat_triangle *f, bool is_object, asdic_relief *r) {
    size_t first_x, end_x, first_y, end_y;
    double ax = f->x[1] - f->x[0], ay = f->y[1] - f->y[0];
    double bx = f->x[2] - f->x[0], by = f->y[2] - f->y[0];
    double area = ax * by - ay * bx;
    if (area == 0.0) {
        return; /* stands upright */
    }
    cells_in(least(f->x), most(f->x), r->columns, &first_x, &end_x);
    cells_in(least(f->y), most(f->y), r->rows, &first_y, &end_y);
    for (size_t row = first_y; row < end_y; row++) {
        for (size_t column = first_x; column < end_x; column++) {
            double x = (double)column + 0.5 - f->x[0], y = (double)row + 0.5 - f->y[0];
            double u = (x * by - y * bx) / area, v = (ax * y - ay * x) / area;
            float *depth_m = &r->depth_m[row * r->columns + column];
            double z = f->z[0] + u * (f->z[1] - f->z[0]) + v * (f->z[2] - f->z[0]);
            bool is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
            if (is_inside && !((double)*depth_m <= z)) { /* NAN is replaced */
                *depth_m = (float)z;
                if (r->is_object) {
                    r->is_object[row * r->columns + column] = is_object;
                }
            }
        }
    }
}

void asdic_chart_relief(const asdic_scene *scene, asdic_relief *relief) {
    float plane_m = scene->has_bottom_plane ? (float)scene->bottom_plane_depth_m : NAN;
    for (size_t i = 0; i < relief->rows * relief->columns; i++) {
        relief->depth_m[i] = plane_m;
        if (relief->is_object) {
            relief->is_object[i] = false;
        }
    }
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        const asdic_part *part = &scene->parts[t->part];
        bool is_object = part->kind == DEV_KIND_OBJECT;
        if (!is_object || (relief->is_object && !part->moves)) {
            flat_triangle flat = flatten(scene, t, relief);
            draw(&flat, is_object, relief);
        }
    }
}
