"""A reader of MCAP files (https://mcap.dev/spec) and of ROS 2's messages in CDR, which shares nothing with
the library: it checks what the specification asks, and knows of types what the file's own schemas say."""
import collections
import re
import struct
import zlib

import tap

MAGIC = b"\x89MCAP0\r\n"
(HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, _, _, STATISTICS, METADATA,
 METADATA_INDEX, SUMMARY_OFFSET, DATA_END) = range(1, 16)
NUMBERS = {"bool": "?", "uint8": "B", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}
Message = collections.namedtuple("Message", "topic type time sequence value")


class Cursor:
    def __init__(self, data, at=0):
        self.data, self.at = data, at

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else values

    def text(self):
        return self.bytes(self.take("I")).decode()

    def bytes(self, size):
        tap.equal(self.at + size <= len(self.data), True, "bytes enough")
        self.at += size
        return self.data[self.at - size:self.at]

    def pairs(self, *forms):
        end = self.take("I") + self.at
        found = []
        while self.at < end:
            found.append(tuple(self.text() if form == "s" else self.take(form) for form in forms))
        tap.equal(self.at, end, "a list's length")
        return found


def records(data, at, end):
    """(where, code, content) of each."""
    while at < end:
        code, length = struct.unpack_from("<BQ", data, at)
        yield at, code, data[at + 9:at + 9 + length]
        at += 9 + length
    tap.equal(at, end, "the end of the last record")


# --- messages ---------------------------------------------------------------------------------------


def definitions(name, schema):
    """Fields (type, is a list, fixed count, name) by type, from a ros2msg schema."""
    found, parts = {}, schema.split("=" * 80 + "\n")
    for part in parts:
        lines = part.splitlines()
        own = lines.pop(0)[5:] if lines[0].startswith("MSG: ") else name.replace("/msg/", "/")
        fields = []
        for line in lines:
            match = re.fullmatch(r"([\w/]+)(\[(\d*)\])? (\w+)", line)
            if "=" not in line:
                fields.append((match[1], match[2] is not None, int(match[3] or 0), match[4]))
        found[own] = fields
    return found


class Cdr(Cursor):
    """Version 1, little-endian: numbers stand at multiples of their size, counted behind the head."""

    def __init__(self, data):
        tap.equal(data[:4], b"\0\1\0\0", "the encapsulation")
        super().__init__(data[4:])

    def numbers(self, form, count):
        size = struct.calcsize("<" + form)
        if count:
            self.at += -self.at % size
        values = struct.unpack_from(f"<{count}{form}", self.data, self.at)
        self.at += count * size
        return values

    def item(self, kind, types):
        if kind in NUMBERS:
            return self.numbers(NUMBERS[kind], 1)[0]
        if kind == "string":
            text = self.bytes(self.numbers("I", 1)[0])
            tap.equal(text[-1:], b"\0", "a string's end")
            return text[:-1].decode()
        return self.message(kind, types)

    def message(self, kind, types):
        value = {}
        for field, is_list, count, name in types[kind]:
            if not is_list:
                value[name] = self.item(field, types)
                continue
            count = count or self.numbers("I", 1)[0]
            if field == "uint8":
                value[name] = self.bytes(count)
            elif field in NUMBERS:
                value[name] = self.numbers(NUMBERS[field], count)
            else:
                value[name] = [self.item(field, types) for _ in range(count)]
        return value


def decode(type_name, schema, data):
    cdr = Cdr(data)
    value = cdr.message(type_name.replace("/msg/", "/"), definitions(type_name, schema))
    tap.equal(cdr.at, len(cdr.data), f"bytes of a {type_name}")
    return value


# --- files ------------------------------------------------------------------------------------------


class File:
    """messages in their order in the file; metadata; chunks: how many there are."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        tap.equal((self.data[:8], self.data[-8:]), (MAGIC, MAGIC), "magic")
        self.schemas, self.channels, self.messages, self.metadata = {}, {}, [], {}
        self.where = {}  # of a message: (chunk, offset)
        self.indexes = []  # (chunk, where, channel, entries)
        self.chunks = {}
        self.read_data()
        self.read_summary()

    def define(self, code, content):
        c = Cursor(content)
        if code == SCHEMA:
            number, name, encoding, text = c.take("H"), c.text(), c.text(), c.text()
            tap.equal(encoding, "ros2msg")
            tap.equal(self.schemas.setdefault(number, (name, text)), (name, text), "a schema again")
        else:
            number, schema, topic, encoding = *c.take("HH"), c.text(), c.text()
            tap.equal((encoding, c.pairs("s", "s")), ("cdr", []))
            channel = (topic, schema)
            tap.equal(self.channels.setdefault(number, channel), channel, "a channel again")
        tap.equal(c.at, len(content), "a record's length")

    def take_message(self, content, chunk, offset):
        number, sequence, log_time, publish_time = struct.unpack_from("<HIQQ", content)
        tap.equal(log_time, publish_time)
        topic, schema = self.channels[number]
        name, text = self.schemas[schema]
        tap.equal(sequence, sum(m.topic == topic for m in self.messages), "sequence")
        self.where[chunk, offset] = (number, log_time)
        self.messages.append(Message(topic, name, log_time, sequence, decode(name, text, content[22:])))

    def take_chunk(self, where, content):
        c = Cursor(content)
        start, end, size, crc, compression, length = *c.take("QQQI"), c.text(), c.take("Q")
        inside = c.bytes(length)
        tap.equal((compression, size, zlib.crc32(inside)), ("", length, crc), "a chunk")
        before = len(self.messages)
        for offset, code, inner in records(inside, 0, len(inside)):
            if code == MESSAGE:
                self.take_message(inner, where, offset)
            else:
                self.define(code, inner)
        times = [m.time for m in self.messages[before:]] or [0]
        tap.equal((start, end), (min(times), max(times)), "a chunk's times")
        self.chunks[where] = (start, end, 9 + len(content), size)

    def read_data(self):
        chunk = None
        for where, code, content in records(self.data, 8, len(self.data) - 8):
            c = Cursor(content)
            if code == HEADER:
                tap.equal((where, c.text()), (8, "ros2"))
                self.library = c.text()
            elif code == METADATA:
                name = c.text()
                self.metadata[name] = (where, 9 + len(content), dict(c.pairs("s", "s")))
            elif code == CHUNK:
                chunk = where
                self.take_chunk(where, content)
            elif code == MESSAGE_INDEX:
                self.indexes.append((chunk, where, c.take("H"), c.pairs("Q", "Q")))
            elif code == DATA_END:
                tap.equal(c.take("I"), zlib.crc32(self.data[:where]), "the data's sum")
                self.summary_at = where + 13
                break
            else:
                raise AssertionError(f"a record {code:#x} among the data")
        indexed = {(chunk, offset): (number, time) for chunk, _, number, entries in self.indexes
                   for time, offset in entries}
        tap.equal(indexed, self.where, "the messages' index")

    def read_summary(self):
        end = len(self.data) - 8
        footer = end - 29
        summary, offsets, crc = struct.unpack_from("<QQI", self.data, footer + 9)
        tap.equal((self.data[footer], summary), (FOOTER, self.summary_at), "the footer")
        tap.equal(crc, zlib.crc32(self.data[summary:end - 4]), "the summary's sum")
        groups = {}
        for where, code, content in records(self.data, summary, offsets):
            first, last = groups.get(code, (where, None))
            groups[code] = (first, where + 9 + len(content))
            self.check_summary(code, content)
        stated = {}
        for _, code, content in records(self.data, offsets, footer):
            tap.equal(code, SUMMARY_OFFSET)
            group, start, length = struct.unpack("<BQQ", content)
            stated[group] = (start, start + length)
        tap.equal(stated, groups, "the summary's offsets")
        tap.equal(set(groups) >= {SCHEMA, CHANNEL, STATISTICS, CHUNK_INDEX, METADATA_INDEX}, True, "groups")

    def check_summary(self, code, content):
        c = Cursor(content)
        if code in (SCHEMA, CHANNEL):
            self.define(code, content)
            return
        if code == STATISTICS:
            times = [m.time for m in self.messages] or [0]
            tap.equal(c.take("QHIIIIQQ"), (len(self.messages), len(self.schemas), len(self.channels), 0,
                                           len(self.metadata), len(self.chunks), min(times), max(times)))
            tap.equal(dict(c.pairs("H", "Q")), {n: sum(m.topic == topic for m in self.messages)
                                               for n, (topic, _) in self.channels.items()}, "counts")
        elif code == CHUNK_INDEX:
            start, end, where, length = c.take("QQQQ")
            indexes = dict(c.pairs("H", "Q"))
            index_bytes, compression, packed, size = c.take("Q"), c.text(), *c.take("QQ")
            tap.equal((start, end, length, size), self.chunks[where], "a chunk's index")
            tap.equal(indexes, {n: at for chunk, at, n, _ in self.indexes if chunk == where})
            lengths = [9 + struct.unpack_from("<Q", self.data, at + 1)[0] for at in indexes.values()]
            tap.equal((index_bytes, compression, packed), (sum(lengths), "", size))
        elif code == METADATA_INDEX:
            where, length, name = *c.take("QQ"), c.text()
            tap.equal(self.metadata[name][:2], (where, length), "the metadata's index")
        tap.equal(c.at, len(content), f"the length of a record {code:#x}")

    def of(self, topic):
        return [m for m in self.messages if m.topic == topic]
