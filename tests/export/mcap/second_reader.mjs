// Reads an MCAP file with npm's @mcap/core, streamed with CRC checks and indexed, and compares both with the
// statistics in the file. usage: node second_reader.mjs NODE_MODULES FILE
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [modules, file] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(modules), "x.js"));
const { McapStreamReader, McapIndexedReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");

const decompressHandlers = await loadDecompressHandlers();
const bytes = fs.readFileSync(file);

const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
stream.append(bytes);
let streamed = 0;
let statistics;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") ++streamed;
  if (record.type === "Statistics") statistics = record;
}
if (!stream.done()) throw new Error("the stream reader did not reach the end");

const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
const indexed = await McapIndexedReader.Initialize({ readable, decompressHandlers });
let count = 0;
let last = 0n;
for await (const message of indexed.readMessages({ validateCrcs: true })) {
  if (message.logTime < last) throw new Error("messages are out of order");
  last = message.logTime;
  ++count;
}
const expected = Number(statistics.messageCount);
if (expected === 0 || streamed !== expected || count !== expected)
  throw new Error(`statistics ${expected}, streamed ${streamed}, indexed ${count}`);
console.log(`${expected} messages, ${indexed.channelsById.size} channels`);
