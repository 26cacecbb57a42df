// Reads an MCAP of `perception-export --format ros2` with other people's decoders and counts its messages, by hand:
//   npm i @mcap/core @mcap/nodejs @foxglove/rosmsg @foxglove/rosmsg2-serialization && node tests/interop/check_ros2.mjs FILE.mcap
import { open } from "fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const file = await open(process.argv[2], "r");
const mcap = await McapIndexedReader.Initialize({ readable: new FileHandleReadable(file) });
const decoders = new Map(), count = {};
for await (const message of mcap.readMessages({ validateCrcs: true })) {
  const channel = mcap.channelsById.get(message.channelId), schema = mcap.schemasById.get(channel.schemaId);
  if (!decoders.has(schema.id))
    decoders.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  decoders.get(schema.id).readMessage(message.data);  // throws if the definition and the bytes disagree
  const key = `${channel.topic} ${schema.name}`;
  count[key] = (count[key] ?? 0) + 1;
}
console.log(count);
