/*
 * The geometry of a mission: surface, bottom, objects.
 */
#include "mission_build.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "laws/scatterer.h"
#include "scene/mesh_build.h"
#include "scene/moving.h"
#include "scene/scene.h"
#include "scene/triangles.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The node of a map's key "file". */
static asdic_yaml_node *file_node(const asdic_yaml_node *map) {
    return asdic_yaml_child(map, "file");
}

/* The mesh in memory that the scene calls NAME; NULL where it means a file. */
static const asdic_mesh *mesh_in_memory(const mission_builder *b, const char *name) {
    for (size_t i = 0; b->memory && i < b->memory->mesh_count; i++) {
        if (strcmp(b->memory->meshes[i].name, name) == 0) {
            return b->memory->meshes[i].mesh;
        }
    }
    return NULL;
}

static asdic_status load_mesh(mission_builder *b, const file_mesh *m, asdic_mesh **out) {
    const asdic_mesh *given = mesh_in_memory(b, m->file);
    if (given) {
        return asdic_mesh_from_triangles(b->ctx, given->vertices_m, given->vertex_count,
                                         given->indices, given->triangle_count, out);
    }
    const char *path = asdic_mission_resolve(b, m->file);
    if (!path) {
        return asdic_fail_memory(b->ctx, "a path");
    }
    asdic_status status = asdic_mesh_load(b->ctx, path, m->scale, m->z_up, out);
    return asdic_mission_file_problem(b, file_node(m->node), status);
}

/* As load_mesh, of an object: a mesh from a file is the mission's, others are *OWN, which is to be destroyed. */
static asdic_status load_object(mission_builder *b, const file_mesh *m, asdic_mesh **own,
                                const asdic_mesh **out) {
    if (mesh_in_memory(b, m->file)) {
        asdic_status status = load_mesh(b, m, own);
        *out = *own;
        return status;
    }
    const char *path = asdic_mission_resolve(b, m->file);
    if (!path) {
        return asdic_fail_memory(b->ctx, "a path");
    }
    asdic_status status = asdic_mission_need_mesh(b, path, m->scale, m->z_up, out);
    return asdic_mission_file_problem(b, file_node(m->node), status);
}

static asdic_status load_grid(mission_builder *b, const file_grid *g, asdic_mesh **out) {
    const char *path = asdic_mission_resolve(b, g->file);
    if (!path) {
        return asdic_fail_memory(b->ctx, "a path");
    }
    asdic_status status = asdic_mesh_load_grid(b->ctx, path, g->values == FILE_GRID_DEPTHS, out);
    return asdic_mission_file_problem(b, file_node(g->node), status);
}

/* The primitive that O is, if it is one. */
static asdic_status make_primitive(mission_builder *b, const file_object *o, asdic_mesh **out) {
    if (asdic_scene_node_good(o->box.node)) {
        const double *s = o->box.size_m;
        return asdic_mesh_box(b->ctx, (asdic_vec3){s[0], s[1], s[2]}, out);
    }
    if (asdic_scene_node_good(o->sphere.node)) {
        return asdic_mesh_sphere(b->ctx, o->sphere.radius_m, (unsigned)o->sphere.segments, out);
    }
    if (asdic_scene_node_good(o->cylinder.node)) {
        return asdic_mesh_cylinder(b->ctx, o->cylinder.radius_m, o->cylinder.length_m,
                                   (unsigned)o->cylinder.segments, out);
    }
    if (asdic_scene_node_good(o->plate.node)) {
        return asdic_mesh_plate(b->ctx, o->plate.size_m[0], o->plate.size_m[1], out);
    }
    return ASDIC_OK;
}

/* The shape of O, of which *OWN is to be destroyed; *OUT stays NULL when the file is wrong about it. */
static asdic_status make_shape(mission_builder *b, const file_object *o, asdic_mesh **own,
                               const asdic_mesh **out) {
    if (asdic_scene_node_good(o->mesh.node)) {
        return load_object(b, &o->mesh, own, out);
    }
    asdic_status status = make_primitive(b, o, own);
    *out = *own;
    return status;
}

/* The numbers of the file that MATERIAL's law wants; the mission keeps them. */
static asdic_status read_rows(mission_builder *b, const asdic_material_file *file,
                              asdic_material *material) {
    asdic_mission *m = b->mission;
    if (!file->path || !asdic_scene_node_good(file->node)) {
        return ASDIC_OK;
    }
    const char *path = asdic_mission_resolve(b, file->path);
    const double **grown = realloc(m->rows, (m->row_files + 1) * sizeof *grown);
    m->rows = grown ? grown : m->rows;
    if (!path || !grown) {
        return asdic_fail_memory(b->ctx, "the numbers of a material");
    }
    size_t before = b->problems->total;
    asdic_status status = asdic_material_read_table(b->ctx, material, path, b->problems);
    if (material->rows) {
        m->rows[m->row_files++] = material->rows;
    }
    return asdic_mission_file_read(b, file->node, before, status);
}

/* The box round the triangles of MESH at OBJECT's pose: files hold vertices that none has. */
static void find_box(const asdic_mesh *mesh, asdic_mission_object *object) {
    const asdic_pose *pose = &object->pose;
    asdic_mat3 turn = asdic_mat3_of(pose);
    object->min_m = (asdic_vec3){INFINITY, INFINITY, INFINITY};
    object->max_m = (asdic_vec3){-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const double *v = &mesh->vertices_m[3 * (size_t)mesh->indices[i]];
        asdic_vec3 at = asdic_vec3_add(pose->position_m,
                                       asdic_mat3_apply(turn, (asdic_vec3){v[0], v[1], v[2]}));
        object->min_m.x = fmin(object->min_m.x, at.x);
        object->min_m.y = fmin(object->min_m.y, at.y);
        object->min_m.z = fmin(object->min_m.z, at.z);
        object->max_m.x = fmax(object->max_m.x, at.x);
        object->max_m.y = fmax(object->max_m.y, at.y);
        object->max_m.z = fmax(object->max_m.z, at.z);
    }
}

static asdic_status add_to_scene(const asdic_mission *m, const asdic_mesh *mesh,
                                 const asdic_mission_object *o) {
    asdic_scene *scene = m->scene;
    const asdic_track *track = o->moves ? asdic_mission_track_of(m, o->name) : NULL;
    if (o->name[0] && m->stands_anywhere) {
        /* The same scene, whatever places were drawn for the first run that needed it. */
        return asdic_scene_add_moving_object(scene, o->name, mesh, (asdic_pose){0}, o->material);
    }
    if (track) {
        TRY(asdic_scene_add_moving_object(scene, o->name, mesh, o->pose, o->material));
        /* The same origin, and so the same roundings, whenever a mission or a recording of it begins. */
        scene->movables[scene->movable_count - 1].anchor =
            asdic_track_pose(track, asdic_track_start_s(track));
        return ASDIC_OK;
    }
    return o->name[0] ? asdic_scene_add_object(scene, o->name, mesh, o->pose, o->material)
                      : asdic_scene_add_bottom(scene, mesh, o->pose, o->material);
}

/* Adds MESH (NULL: nothing) to the scene as OBJECT, whose name, pose and material are set,
 * and lists it in the mission. What the scene refuses becomes a problem at NODE. */
static asdic_status place(mission_builder *b, asdic_yaml_node *node, const asdic_mesh *mesh,
                          bool is_file, asdic_mission_object object) {
    asdic_mission *m = b->mission;
    asdic_status status = ASDIC_OK;
    if (mesh && asdic_mission_is_sound(b)) {
        object.mesh = asdic_mesh_get_info(mesh);
        find_box(mesh, &object);
        asdic_mesh_hint_at_units(&object.mesh, object.name[0] != '\0', object.name[0] == '\0');
        if (!is_file) {
            object.mesh.hint[0] = '\0'; /* sizes in the scene file are in metres */
        }
        m->objects[m->object_count++] = object;
        status = add_to_scene(m, mesh, &object);
        if (!status) {
            m->scene->parts[m->scene->part_count - 1].is_primitive = !is_file;
        }
    }
    return asdic_mission_file_problem(b, node, status);
}

static asdic_status build_bottom(mission_builder *b) {
    const file_bottom *bottom = &b->file->bottom;
    asdic_mesh *mesh = NULL;
    asdic_status status = ASDIC_OK;
    if (asdic_scene_node_good(bottom->mesh.node)) {
        status = load_mesh(b, &bottom->mesh, &mesh);
    } else if (asdic_scene_node_good(bottom->grid.node)) {
        status = load_grid(b, &bottom->grid, &mesh);
    }
    if (status || !asdic_scene_node_good(bottom->node) || bottom->none) {
        asdic_mesh_destroy(&mesh);
        return status;
    }
    asdic_material_file rows;
    asdic_material material = asdic_scene_file_bottom(b->file, &rows);
    status = read_rows(b, &rows, &material);
    if (status != ASDIC_OK || !asdic_mission_is_sound(b)) {
        asdic_mesh_destroy(&mesh);
        return status;
    }
    b->mission->bottom = material;
    if (!isnan(bottom->depth_m)) {
        return asdic_scene_set_bottom_plane(b->mission->scene, bottom->depth_m, material);
    }
    asdic_mission_object object = {
        .pose = asdic_scene_file_place(bottom->position_m, bottom->rotation_deg),
        .material = material};
    status = place(b, bottom->node, mesh, true, object);
    asdic_mesh_destroy(&mesh);
    return status;
}

/* Where O is at the first ping. */
static asdic_pose first_pose(const mission_builder *b, const file_object *o) {
    const asdic_mission *m = b->mission;
    const asdic_track *track = o->track && o->name ? asdic_mission_track_of(m, o->name) : NULL;
    return track ? asdic_track_pose(track, m->track ? asdic_track_start_s(m->track) : 0.0)
                 : asdic_scene_file_place(o->position_m, o->rotation_deg);
}

static asdic_status build_point(mission_builder *b, const file_object *o) {
    asdic_mission *m = b->mission;
    if (!asdic_mission_is_sound(b)) {
        return ASDIC_OK;
    }
    asdic_vec3 at = first_pose(b, o).position_m;
    asdic_mission_object object = {
        .pose.position_m = at, .min_m = at, .max_m = at, .moves = o->track != NULL};
    snprintf(object.name, sizeof object.name, "%s", o->name);
    m->objects[m->object_count++] = object;
    asdic_status status =
        asdic_scene_add_point(m->scene, object.name, at, o->point.target_strength_db);
    if (!status) {
        m->scene->points[m->scene->point_count - 1].moves = object.moves;
    }
    return asdic_mission_file_problem(b, o->node, status);
}

/* Reserves room for the MESH of object I as often as the objects from I on use its file, so that
 * ten thousand copies are refused at the first one. Once for a row of objects of one file. */
static asdic_status reserve_copies(const mission_builder *b, size_t i, const asdic_mesh *mesh) {
    const file_object *objects = b->file->objects.items;
    const char *file = objects[i].mesh.file;
    size_t copies = 0;
    if (i > 0 && objects[i - 1].mesh.file && strcmp(objects[i - 1].mesh.file, file) == 0) {
        return ASDIC_OK;
    }
    for (size_t k = i; k < b->file->objects.count; k++) {
        copies += objects[k].mesh.file && strcmp(objects[k].mesh.file, file) == 0;
    }
    return asdic_scene_reserve(b->mission->scene, copies * mesh->triangle_count);
}

static asdic_status build_object(mission_builder *b, size_t number) {
    const file_object *o = (const file_object *)b->file->objects.items + number;
    if (o->point.node) {
        return build_point(b, o);
    }
    asdic_mesh *own = NULL;
    const asdic_mesh *mesh = NULL;
    asdic_material_file rows;
    asdic_mission_object object = {.pose = first_pose(b, o),
                                   .material = asdic_scene_file_material(o, &rows),
                                   .moves = o->track != NULL};
    snprintf(object.name, sizeof object.name, "%s", o->name ? o->name : "");
    asdic_status status = read_rows(b, &rows, &object.material);
    status = status ? status : make_shape(b, o, &own, &mesh);
    if (!status && mesh && o->mesh.node) {
        status = reserve_copies(b, number, mesh);
    }
    if (!status) { /* what is out of range has been told */
        double crease_deg = fmin(fmax(o->crease_deg, 0.0), 90.0);
        status = asdic_scene_set_crease(b->mission->scene, crease_deg * ASDIC_PI / 180.0);
    }
    status = status ? asdic_mission_file_problem(b, o->node, status)
                    : place(b, o->node, mesh, o->mesh.node != NULL, object);
    asdic_mesh_destroy(&own);
    return status;
}

/* Triangles of all spheres and cylinders; boxes and plates are small. */
static size_t count_primitives(const asdic_scene_file *file) {
    const file_object *objects = file->objects.items;
    size_t count = 0;
    for (size_t i = 0; i < file->objects.count; i++) {
        if (asdic_scene_node_good(objects[i].sphere.node)) {
            count += asdic_sphere_triangles((unsigned)objects[i].sphere.segments);
        } else if (asdic_scene_node_good(objects[i].cylinder.node)) {
            count += asdic_cylinder_triangles((unsigned)objects[i].cylinder.segments);
        }
    }
    return count;
}

/* Whether the donor's scene is what the file describes. Meshes that change on the disk meanwhile are
 * not looked for; numbers from files and objects on tracks are read anew. */
static bool can_take(const mission_builder *b) {
    const asdic_mission *donor = b->donor;
    return donor && donor->scene && donor->geometry && b->mission->geometry &&
           donor->row_files == 0 && donor->motion_count == 0 && b->problems->total == 0 &&
           strcmp(donor->geometry, b->mission->geometry) == 0;
}

/* Whether the donor's bottom and surface are what the file describes, and can be kept. */
static bool can_take_ground(const mission_builder *b) {
    const asdic_mission *donor = b->donor, *m = b->mission;
    return donor && donor->scene && donor->geometry && m->geometry && donor->row_files == 0 &&
           b->problems->total == 0 && donor->ground_length == m->ground_length &&
           strncmp(donor->geometry, m->geometry, m->ground_length) == 0 &&
           asdic_scene_can_reopen(donor->scene);
}

/* The donor's scene without its objects; the bottom is the first of what the mission lists. */
static asdic_status take_ground(mission_builder *b) {
    asdic_mission *m = b->mission, *donor = b->donor;
    m->scene = donor->scene;
    m->bottom = donor->bottom;
    m->objects[m->object_count++] = donor->objects[0];
    donor->scene = NULL;
    return asdic_scene_reopen(m->scene);
}

static void take_scene(mission_builder *b) {
    asdic_mission *m = b->mission, *donor = b->donor;
    m->scene = donor->scene;
    m->objects = donor->objects;
    m->object_count = donor->object_count;
    m->bottom = donor->bottom;
    donor->scene = NULL;
    donor->objects = NULL;
    donor->object_count = 0;
}

/* The box round an object of the base, which is moved to POSE: as large in all directions, when it is turned. */
static void move_box(asdic_mission_object *object, const asdic_pose *pose) {
    asdic_move move = asdic_move_between(&object->pose, pose);
    asdic_vec3 half = asdic_vec3_scale(asdic_vec3_sub(object->max_m, object->min_m), 0.5);
    asdic_vec3 at = asdic_move_point(&move, asdic_vec3_add(object->min_m, half));
    if (memcmp(&move.before, &move.after, sizeof move.before) != 0) {
        double most = asdic_vec3_length(half);
        half = (asdic_vec3){most, most, most};
    }
    object->min_m = asdic_vec3_sub(at, half);
    object->max_m = asdic_vec3_add(at, half);
    object->pose = *pose;
}

asdic_status asdic_mission_borrow_scene(mission_builder *b) {
    asdic_mission *m = b->mission;
    const asdic_mission *base = m->base;
    size_t first = base->object_count - b->file->objects.count; /* the bottom may be before them */
    m->objects = calloc(base->object_count + 1, sizeof *m->objects);
    if (!m->objects) {
        return asdic_fail_memory(b->ctx, "the objects");
    }
    memcpy(m->objects, base->objects, base->object_count * sizeof *m->objects);
    m->object_count = base->object_count;
    m->bottom = base->bottom;
    m->scene = base->scene;
    for (size_t i = 0; i < b->file->objects.count; i++) {
        asdic_pose pose = first_pose(b, (const file_object *)b->file->objects.items + i);
        move_box(&m->objects[first + i], &pose);
    }
    return ASDIC_OK;
}

/* Surface and bottom. */
static asdic_status build_ground(mission_builder *b) {
    const asdic_scene_file *file = b->file;
    TRY(asdic_scene_create(b->ctx, &b->mission->scene));
    if (b->mission->geometry) {
        TRY(asdic_scene_keep_ground(b->mission->scene));
        b->mission->scene->is_silent = b->mission->trial.is_ideal;
    }
    TRY(asdic_scene_set_surface(b->mission->scene, file->surface.enabled));
    asdic_material_file rows;
    asdic_material surface = asdic_scene_file_surface(file, &rows);
    TRY(read_rows(b, &rows, &surface));
    if (asdic_mission_is_sound(b)) {
        TRY(asdic_scene_set_surface_law(b->mission->scene, surface));
        TRY(asdic_scene_reserve(b->mission->scene, count_primitives(file)));
    }
    return build_bottom(b);
}

asdic_status asdic_mission_build_scene(mission_builder *b) {
    const asdic_scene_file *file = b->file;
    if (b->donor) {
        asdic_mission_take_meshes(b->mission, b->donor);
    }
    if (can_take(b)) {
        take_scene(b);
        return ASDIC_OK;
    }
    b->mission->objects = calloc(file->objects.count + 1, sizeof *b->mission->objects);
    if (!b->mission->objects) {
        return asdic_fail_memory(b->ctx, "the objects");
    }
    TRY(can_take_ground(b) ? take_ground(b) : build_ground(b));
    for (size_t i = 0; i < file->objects.count; i++) {
        TRY(build_object(b, i));
    }
    if (!b->mission->geometry) {
        asdic_mission_forget_meshes(b->mission);
    }
    return asdic_mission_is_sound(b) ? asdic_scene_commit(b->mission->scene) : ASDIC_OK;
}
