#!/usr/bin/env python3
"""Makes of ros_messages.txt what the library and the program hold of ROS 2's messages:

    ros_types.h     a C struct a message, as it lies in memory
    ros_types.c     its fields, by which ros_cdr.c writes and reads it, and its schema as MCAP files hold it:
                    the definition, then those that it needs, each after a line of '='
    asdic_ros.idl   the same types as a DDS knows them, pkg::msg::dds_::Type_
"""
import re
import sys

SCALARS = {  # C type, kind in ros_cdr.h, IDL type
    "bool": ("bool", "BOOL", "boolean"),
    "uint8": ("uint8_t", "U8", "octet"),
    "int32": ("int32_t", "I32", "long"),
    "uint32": ("uint32_t", "U32", "unsigned long"),
    "float32": ("float", "F32", "float"),
    "float64": ("double", "F64", "double"),
    "string": ("const char *", "STRING", "string"),
}
FIELD = re.compile(r"([\w/]+?)(\[(\d*)\])? +(\w+)(=(\d+))?$")
HEAD = "/* Made by ros_messages.py of ros_messages.txt. */\n"


class Field:
    def __init__(self, line):
        match = FIELD.match(line)
        if not match:
            raise SystemExit(f"ros_messages.txt: cannot read '{line}'")
        self.line = line
        self.type, _, _, self.name, _, self.value = match.groups()
        self.is_array = match.group(2) is not None
        self.count = int(match.group(3) or 0)


class Message:
    def __init__(self, name):
        self.package, self.type = name.split("/")
        self.name = name
        self.full_name = f"{self.package}/msg/{self.type}"
        self.fields, self.constants = [], []
        self.text = ""  # the definition

    @property
    def c_name(self):
        return "asdic_ros_" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", self.type).lower()

    def needs(self, messages):
        """The messages in it, each once, in the order in which they are met."""
        found = []
        for field in self.fields:
            if field.type not in SCALARS:
                inner = messages[field.type]
                for one in [inner, *inner.needs(messages)]:
                    if one not in found:
                        found.append(one)
        return found


def parse(text):
    messages, current = {}, None
    for line in text.splitlines():
        if line.startswith("== "):
            current = messages[line[3:]] = Message(line[3:])
        elif line and not line.startswith("#"):
            field = Field(line)
            (current.constants if field.value else current.fields).append(field)
            current.text += line + "\n"
    return messages


def schema(message, messages):
    parts = [message.text]
    parts += [f"MSG: {inner.package}/{inner.type}\n{inner.text}" for inner in message.needs(messages)]
    return ("=" * 80 + "\n").join(parts)


def c_type(field, messages):
    scalar = SCALARS.get(field.type)
    return scalar[0] if scalar else messages[field.type].c_name


def c_member(field, messages):
    kind = c_type(field, messages)
    space = "" if kind.endswith("*") else " "
    if field.is_array and field.count:
        return f"{kind}{space}{field.name}[{field.count}];"
    if field.is_array:
        return f"struct {{ const {kind} *items; size_t count; }} {field.name};"
    return f"{kind}{space}{field.name};"


def header(messages):
    out = [HEAD, "#ifndef ASDIC_OUT_ROS_TYPES_H\n#define ASDIC_OUT_ROS_TYPES_H\n",
           '#include "out/ros_cdr.h"\n']
    for m in messages.values():
        for constant in m.constants:
            out.append(f"#define {m.c_name.upper()}_{constant.name} {constant.value}u")
        members = "\n".join("    " + c_member(f, messages) for f in m.fields)
        out.append(f"typedef struct {m.c_name} {{\n{members}\n}} {m.c_name};\n"
                   f"extern const asdic_ros_type {m.c_name}_type;\n")
    return "\n".join(out + ["#endif\n"])


def c_field(message, field, messages):
    scalar = SCALARS.get(field.type)
    nested = "NULL" if scalar else f"&{messages[field.type].c_name}_type"
    kind = scalar[1] if scalar else "MESSAGE"
    form = "ONE" if not field.is_array else "ARRAY" if field.count else "SEQUENCE"
    return (f"    {{offsetof({message.c_name}, {field.name}), {max(field.count, 1)}, ASDIC_ROS_{kind}, "
            f"ASDIC_ROS_{form}, {nested}}},")


def quoted(text):
    return "\n".join(f'    "{line}\\n"' for line in text.splitlines())


def source(messages):
    out = [HEAD, '#include "out/ros_types.h"\n']
    for m in messages.values():
        fields = "\n".join(c_field(m, f, messages) for f in m.fields)
        out.append(f"static const asdic_ros_field {m.c_name}_fields[] = {{\n{fields}\n}};\n"
                   f"const asdic_ros_type {m.c_name}_type = {{\n    \"{m.full_name}\",\n"
                   f"    {m.c_name}_fields, {len(m.fields)}, sizeof({m.c_name}),\n"
                   f"{quoted(schema(m, messages))}\n}};\n")
    return "\n".join(out)


def idl_type(field):
    scalar = SCALARS.get(field.type)
    package, _, name = field.type.partition("/")
    return scalar[2] if scalar else f"{package}::msg::dds_::{name}_"


def idl(messages):
    out = []
    for m in messages.values():
        members, arrays = [], []
        for f in m.fields:
            kind = idl_type(f)
            if f.is_array and f.count:
                arrays.append(f"typedef {kind} {m.type}_{f.name}_array[{f.count}];")
                kind = f"{m.type}_{f.name}_array"
            elif f.is_array:
                kind = f"sequence<{kind}>"
            members.append(f"  {kind} {f.name}_;")
        out.append(f"module {m.package} {{ module msg {{ module dds_ {{\n" +
                   "".join(line + "\n" for line in arrays) +
                   f"struct {m.type}_ {{\n" + "\n".join(members) + "\n};\n}; }; };\n")
    return "\n".join(out)


def main():
    path, *targets = sys.argv[1:]
    with open(path, encoding="utf-8") as file:
        messages = parse(file.read())
    makers = {".h": header, ".c": source, ".idl": idl}
    for target in targets:
        with open(target, "w", encoding="utf-8") as file:
            file.write(makers[target[target.rindex("."):]](messages))


main()
