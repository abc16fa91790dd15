// Writes an MCAP file with @mcap/core, as rosbag2 does, for rosbag_test.cpp.
//   node rosbag.mjs FILE none|lz4|zstd MESSAGES
// MESSAGES is a file with a JSON list of [topic, type, encoding, log time in ns, bytes in hex].
import { readFileSync, writeFileSync } from "node:fs";

import zstd from "@foxglove/wasm-zstd";
import { McapWriter, TempBuffer } from "@mcap/core";
import lz4 from "lz4js";

const compressors = {
  none: undefined,
  lz4: (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) }),
  zstd: (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes, 3) }),
};

const [file, kind, messages] = process.argv.slice(2);
await zstd.isLoaded;
const buffer = new TempBuffer();
const writer = new McapWriter({ writable: buffer, chunkSize: 2048, compressChunk: compressors[kind] });
await writer.start({ profile: "ros2", library: "" });
const channels = new Map();
let sequence = 0;
for (const [topic, type, encoding, logTime, hex] of JSON.parse(readFileSync(messages, "utf8"))) {
  if (!channels.has(topic)) {
    const schemaId = await writer.registerSchema({
      name: type, encoding: encoding === "cdr" ? "ros2msg" : "jsonschema", data: new Uint8Array() });
    channels.set(topic, await writer.registerChannel({ topic, schemaId, messageEncoding: encoding, metadata: new Map() }));
  }
  const time = BigInt(logTime);
  await writer.addMessage({
    channelId: channels.get(topic), sequence: ++sequence, logTime: time, publishTime: time, data: Buffer.from(hex, "hex") });
}
await writer.end();
writeFileSync(file, buffer.get());
