/*
 * A tree of nodes as YAML in block style.
 */
#ifndef ASDIC_MISSION_YAML_PRINT_H
#define ASDIC_MISSION_YAML_PRINT_H

#include "base/text.h"
#include "yaml_tree.h"

/* What ROOT holds, appended to TEXT: the same values as it was read from, without comments. */
void asdic_yaml_print(const asdic_yaml_node *root, asdic_text *text);

#endif
