// Every message of an MCAP file as a line of JSON, by the packages that Foxglove's viewer reads them with:
// once from the index, once as a stream whose sums are checked. Long lists are given as their length and a sum.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";

const require = createRequire(process.argv[2] + "/");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

function short(key, value) {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) value = [...value];
  if (Array.isArray(value) && value.length > 64 && typeof value[0] === "number") {
    return { length: value.length, sum: value.reduce((sum, x) => sum + (x === x ? x : 0), 0) };
  }
  return value;
}

const data = readFileSync(process.argv[3]);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(data.length),
    read: async (offset, length) => new Uint8Array(data.subarray(Number(offset), Number(offset + length))),
  },
});
const readers = new Map();
let indexed = 0, streamed = 0, record;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(channel.id)) {
    const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
    readers.set(channel.id, new MessageReader(definition));
  }
  const value = readers.get(channel.id).readMessage(message.data);
  console.log(JSON.stringify({ topic: channel.topic, type: schema.name, time: message.logTime, value }, short));
  indexed++;
}
const stream = new McapStreamReader({ validateCrcs: true });
stream.append(data);
while ((record = stream.nextRecord())) streamed += record.type === "Message" ? 1 : 0;
if (!stream.done() || streamed !== indexed || Number(reader.statistics.messageCount) !== indexed) {
  throw new Error(`${streamed} messages in the stream, ${indexed} by the index, ${reader.statistics.messageCount} stated`);
}
