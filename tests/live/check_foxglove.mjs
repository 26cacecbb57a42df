// Connects to a running perception-track --serve as Foxglove does, by its own client (@foxglove/ws-protocol), subscribes to all channels and
// validates COUNT (100) messages of each against the published schema of its name (@foxglove/schemas) and the one that the channel has:
//   npm i @foxglove/ws-protocol ws @foxglove/schemas ajv
//   perception-track -c ini/demo.ini -i live:PLAY.ini -o OUT --serve 8765 --duration 40 --set weather.filter=trust &
//   node tests/live/check_foxglove.mjs FOLDER_WITH_node_modules ws://127.0.0.1:8765 [COUNT [SUBPROTOCOL]]
// SUBPROTOCOL is the client's own (foxglove.websocket.v1) unless another is given (foxglove.sdk.v1).
// PLAY.ini plays a log again and again: [LOG] driver = CRawlogSensor, process_rate = 100, rawlog = /PATH/demo.rawlog, repeats = 0.
// Events may be few, and may tell of an earlier instant. What came of each channel is printed, and it ends with 1 where a
// message was wrong or the run ended before each channel but those of events and weather had COUNT.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const require = createRequire(join(resolve(process.argv[2]), "package.json"));
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");
const schemas = require("@foxglove/schemas/jsonschema");
const Ajv = require("ajv").default;

const address = process.argv[3], wanted = Number(process.argv[4] ?? 100);
const ajv = new Ajv({ strict: false });
const protocols = [process.argv[5] ?? FoxgloveClient.SUPPORTED_SUBPROTOCOL];
const socket = new WebSocket(address, protocols);
const client = new FoxgloveClient({ ws: socket });
const channels = new Map();  // by subscription
let faults = 0;

function fault(text) {
  if (++faults <= 10) console.error(text);
}

function done() {
  for (const c of channels.values()) console.log(`${c.topic}: ${c.schemaName}, ${c.count} messages`);
  const few = [...channels.values()].filter((c) => c.count < wanted && !/^\/(events|weather)/.test(c.topic));
  for (const c of few) fault(`${c.topic}: ${c.count} of ${wanted} messages came`);
  if (!channels.size) fault("no channel was advertised");
  console.log(`${faults} faults`);
  process.exit(faults ? 1 : 0);
}

client.on("error", (error) => fault(`connection: ${error.message ?? error}`));
client.on("serverInfo", (info) => {
  if (socket.protocol !== protocols[0]) fault(`subprotocol ${socket.protocol} in place of ${protocols[0]}`);
  console.log(`${socket.protocol}: ${JSON.stringify(info)}`);
});
client.on("status", (status) => fault(`status: ${status.message}`));
client.on("close", done);
client.on("advertise", (list) => {
  for (const channel of list) {
    const own = ajv.compile(JSON.parse(channel.schema)), validators = [own];
    if (channel.encoding !== "json" || channel.schemaEncoding !== "jsonschema") fault(`${channel.topic}: encoding ${channel.encoding}`);
    const [maker, name] = channel.schemaName.split(".");
    if (maker === "foxglove") {
      if (schemas[name]) validators.push(ajv.compile(schemas[name]));
      else fault(`${channel.topic}: no schema ${channel.schemaName} is published`);
    }
    channels.set(client.subscribe(channel.id), { ...channel, validators, count: 0, last: 0n });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const channel = channels.get(subscriptionId);
  if (!channel) return fault(`a message of an unknown subscription ${subscriptionId}`);
  if (timestamp < channel.last && channel.topic !== "/events") fault(`${channel.topic}: a stamp went back`);
  channel.last = timestamp;
  if (++channel.count > wanted) return;
  const value = JSON.parse(new TextDecoder().decode(data));
  for (const validate of channel.validators) if (!validate(value)) fault(`${channel.topic}: ${ajv.errorsText(validate.errors)}`);
  if ([...channels.values()].every((c) => c.count >= wanted)) done();
});
