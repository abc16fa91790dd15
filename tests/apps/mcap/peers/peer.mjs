// Reads and writes MCAP files with @mcap/core, for peers_test.cpp.
//   node peer.mjs read FILE                                 prints what the indexed and the streaming reader found, as JSON
//   node peer.mjs beginning FILE                            the same of a file that is cut off, without an index
//   node peer.mjs write FILE none|lz4|zstd|unchunked COUNT  writes COUNT messages, as message() computes them
import { readFile, writeFile } from "node:fs/promises";

import zstd from "@foxglove/wasm-zstd";
import { McapIndexedReader, McapStreamReader, McapWriter, TempBuffer } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import lz4 from "lz4js";

const hex = (bytes) => Buffer.from(bytes).toString("hex");

function messageJson(message, channels) {
  const channel = channels.get(message.channelId);
  return [channel.topic, message.sequence, String(message.logTime), String(message.publishTime), hex(message.data)];
}

async function readIndexed(buffer, decompressHandlers) {
  const reader = await McapIndexedReader.Initialize({ readable: new TempBuffer(buffer), decompressHandlers });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(messageJson(message, reader.channelsById));
  const metadata = [];
  for await (const record of reader.readMetadata()) metadata.push([record.name, Object.fromEntries(record.metadata)]);
  const counts = {};
  for (const [id, count] of reader.statistics.channelMessageCounts) {
    counts[reader.channelsById.get(id).topic] = Number(count);
  }
  const channels = [...reader.channelsById.values()].map((channel) => {
    const schema = reader.schemasById.get(channel.schemaId);
    return [channel.topic, channel.messageEncoding, Object.fromEntries(channel.metadata), schema?.name ?? "",
      schema?.encoding ?? "", schema ? hex(schema.data) : ""];
  });
  return { profile: reader.header.profile, chunks: reader.chunkIndexes.length, messages, metadata, counts, channels };
}

function readStream(buffer, decompressHandlers) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(buffer);
  const channels = new Map();
  const messages = [];
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") messages.push(messageJson(record, channels));
  }
  return { done: reader.done(), messages };
}

function message(i) {
  return {
    channelId: undefined,
    sequence: i,
    logTime: 1_700_000_000_000_000_000n + BigInt(i) * 1_000_000n,
    publishTime: 1_600_000_000_000_000_000n + BigInt(i),
    data: new TextEncoder().encode(`message ${i} `.repeat(i % 17)),
  };
}

const compressors = {
  none: undefined,
  unchunked: undefined,
  lz4: (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) }),
  zstd: (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes, 3) }),
};

async function write(kind, count) {
  await zstd.isLoaded;
  const buffer = new TempBuffer();
  const writer = new McapWriter({
    writable: buffer, useChunks: kind !== "unchunked", chunkSize: 4096, compressChunk: compressors[kind] });
  await writer.start({ profile: "peer", library: "" });
  const schemaId = await writer.registerSchema({ name: "S", encoding: "text", data: new Uint8Array([1, 2, 3]) });
  const channels = [];
  for (const topic of ["/a", "/b", "/c"]) {
    channels.push(await writer.registerChannel({
      topic, schemaId: topic === "/c" ? 0 : schemaId, messageEncoding: "text", metadata: new Map([["topic", topic]]) }));
  }
  for (let i = 0; i < count; ++i) await writer.addMessage({ ...message(i), channelId: channels[i % 3] });
  await writer.addMetadata({ name: "M", metadata: new Map([["key", "value"]]) });
  await writer.addAttachment({
    name: "a.bin", mediaType: "application/octet-stream", logTime: 1n, createTime: 2n, data: new Uint8Array(100) });
  await writer.end();
  return buffer.get();
}

const [command, file, kind, count] = process.argv.slice(2);
if (command === "write") {
  await writeFile(file, await write(kind, Number(count)));
} else {
  const buffer = await readFile(file);
  const handlers = await loadDecompressHandlers();
  const indexed = command === "read" ? await readIndexed(buffer, handlers) : undefined;
  console.log(JSON.stringify({ indexed, stream: readStream(buffer, handlers) }));
}
