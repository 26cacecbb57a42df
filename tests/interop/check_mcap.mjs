// Reads an MCAP file with @mcap/core, checksums included, and validates every message against the
// published schema of its name (@foxglove/schemas) and against the one in the file: node check_mcap.mjs FOLDER_WITH_node_modules FILE.mcap
import { createRequire } from "node:module";
import { open } from "node:fs/promises";
import { join, resolve } from "node:path";

const require = createRequire(join(resolve(process.argv[2]), "package.json"));
const { McapIndexedReader } = require("@mcap/core");
const { FileHandleReadable } = require("@mcap/nodejs");
const schemas = require("@foxglove/schemas/jsonschema");
const Ajv = require("ajv").default;

const ajv = new Ajv({ strict: false });
const reader = await McapIndexedReader.Initialize({
  readable: new FileHandleReadable(await open(process.argv[3])),
});
const validators = new Map();
for (const [id, schema] of reader.schemasById) {
  const published = schemas[schema.name.replace("foxglove.", "")];
  if (!published) throw new Error(`${schema.name}: no schema of that name is published`);
  const own = JSON.parse(new TextDecoder().decode(schema.data));
  validators.set(id, [published, own].map((s) => ajv.compile(s)));
}
const counts = {};
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const schema = reader.channelsById.get(message.channelId).schemaId;
  const value = JSON.parse(new TextDecoder().decode(message.data));
  for (const validate of validators.get(schema)) {
    if (!validate(value)) throw new Error(ajv.errorsText(validate.errors));
  }
  const name = reader.schemasById.get(schema).name;
  counts[name] = (counts[name] ?? 0) + 1;
}
const total = Object.values(counts).reduce((a, b) => a + b, 0);
if (BigInt(total) !== reader.statistics.messageCount) throw new Error("statistics disagree");
console.log(JSON.stringify(counts));
