// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Prints a Parquet file as JSON, by npm's hyparquet: node read_parquet.mjs TOOLS FILE
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [tools, name] = process.argv.slice(2);
const require = createRequire(resolve(tools, "package.json"));
const { parquetMetadata, parquetReadObjects, parquetSchema } = await import(pathToFileURL(require.resolve("hyparquet")).href);

const bytes = readFileSync(name);
const file = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const metadata = parquetMetadata(file);
const plain = (_, value) =>
  typeof value === "bigint" ? value.toString() : Number.isNaN(value) ? "NaN" : ArrayBuffer.isView(value) ? Array.from(value) : value;
const notes = Object.fromEntries((metadata.key_value_metadata ?? []).map(({ key, value }) => [key, value]));
const columns = parquetSchema(metadata).children.map((child) => child.element.name);
const result = { columns, row_groups: metadata.row_groups.length, notes, rows: await parquetReadObjects({ file }) };
console.log(JSON.stringify(result, plain));
