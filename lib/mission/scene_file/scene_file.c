#include "scene_file.h"

#include "base/number.h"
#include "scene_settings.h"

#include <string.h>

bool asdic_scene_node_good(const asdic_yaml_node *node) {
    return node && !node->bad;
}

bool asdic_scene_file_parse(const char *text, size_t size, asdic_arena *arena,
                            asdic_problems *problems, asdic_scene_file *file) {
    return asdic_scene_file_parse_with(text, size, NULL, 0, arena, problems, file);
}

bool asdic_scene_file_parse_with(const char *text, size_t size, const asdic_setting *settings,
                                 size_t count, asdic_arena *arena, asdic_problems *problems,
                                 asdic_scene_file *file) {
    memset(file, 0, sizeof *file);
    asdic_yaml_node *root = NULL;
    if (!asdic_yaml_read(text, size, arena, problems, &root)) {
        return false;
    }
    if (!root) {
        return true;
    }
    for (size_t i = 0; i < count; i++) {
        asdic_scene_set(root, &settings[i], arena, problems);
    }
    asdic_schema_read(asdic_scene_table(), asdic_scene_table(), root, arena, problems, file);
    asdic_scene_file_check(file, arena, problems);
    return !problems->out_of_memory;
}

char *asdic_mission_schema(void) {
    asdic_text text = {0};
    locale_t before = asdic_c_locale_enter();
    asdic_schema_print(asdic_scene_table(), &text);
    asdic_c_locale_leave(before);
    return asdic_text_take(&text);
}
