#include "check.h"

#include <math.h>

int check_digits(double x, int least) {
    int whole = x == 0.0 ? 0 : (int)floor(log10(fabs(x))) + 1;
    return whole + 2 > least ? whole + 2 : least;
}

void check_span(const char *axis, double low, double high, int least) {
    printf("%s%.*g .. %.*g", axis, check_digits(low, least), low, check_digits(high, least), high);
}

void check_json_vec(json *j, const char *key, asdic_vec3 v) {
    json_open(j, key, '[');
    json_number(j, NULL, v.x);
    json_number(j, NULL, v.y);
    json_number(j, NULL, v.z);
    json_close(j);
}

static void print_json(const char *path, bool is_grid, const asdic_mesh_info *info, json *j) {
    json_open(j, NULL, '{');
    json_text(j, "file", path);
    json_bool(j, "valid", true);
    json_text(j, "kind", is_grid ? "grid" : "mesh");
    json_integer(j, "triangles", info->triangles);
    json_integer(j, "vertices", info->vertices);
    json_integer(j, "dropped_facets", info->dropped);
    json_integer(j, "copied_facets", info->copies);
    json_integer(j, "open_edges", info->open_edges);
    check_json_vec(j, "min", info->min_m);
    check_json_vec(j, "max", info->max_m);
    json_text(j, "hint", info->hint[0] ? info->hint : NULL);
    json_close(j);
}

static void print_text(const char *path, bool is_grid, const asdic_mesh_info *info) {
    const asdic_vec3 *low = &info->min_m, *high = &info->max_m;
    printf("%s: %s, in its own axes%s\n", path, is_grid ? "grid" : "mesh",
           is_grid ? "" : " and units");
    printf("  extent    %.4g x %.4g x %.4g\n", high->x - low->x, high->y - low->y,
           high->z - low->z);
    check_span("            x ", low->x, high->x, 6);
    check_span(", y ", low->y, high->y, 6);
    check_span(", z ", low->z, high->z, 6);
    printf("\n");
    printf("  facets    %zu triangles, %zu vertices, %zu degenerate dropped\n", info->triangles,
           info->vertices, info->dropped);
    if (info->copies > 0) {
        printf("            %zu copies of others dropped\n", info->copies);
    }
    if (info->open_edges == 0) {
        printf("  edges     closed\n");
    } else {
        printf("  edges     %zu open\n", info->open_edges);
    }
    if (info->hint[0]) {
        printf("  hint      %s\n", info->hint);
    }
}

asdic_status check_mesh(cli *c, const char *path, bool is_grid, json *j) {
    asdic_mesh *mesh = NULL;
    TRY(is_grid ? asdic_mesh_load_grid(cli_context(c), path, true, &mesh)
                : asdic_mesh_load(cli_context(c), path, 1.0, false, &mesh));
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    if (is_grid) { /* its x is east, the scene's y */
        info.min_m = (asdic_vec3){info.min_m.y, info.min_m.x, info.min_m.z};
        info.max_m = (asdic_vec3){info.max_m.y, info.max_m.x, info.max_m.z};
    }
    if (j) {
        print_json(path, is_grid, &info, j);
    } else if (!cli_quiet(c)) {
        print_text(path, is_grid, &info);
    }
    asdic_mesh_destroy(&mesh);
    return ASDIC_OK;
}
