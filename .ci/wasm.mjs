// Compares the goldens' table as a WebAssembly module prints it with the checked-in one:
// `node wasm.mjs palpable_wasm_golden.wasm golden.txt`.

import { readFileSync } from "node:fs";

const [modulePath, goldenPath] = process.argv.slice(2);
// Nothing is imported: all that the table depends on is in the module.
const { instance } = await WebAssembly.instantiate(readFileSync(modulePath), {});
const { memory, table_start, table_bytes } = instance.exports;
const start = table_start();
const bytes = new Uint8Array(memory.buffer, start, table_bytes());
const found = new TextDecoder().decode(bytes).split("\n");
const expected = readFileSync(goldenPath, "utf8").split("\n");

const differing = expected.filter((line, index) => line !== found[index]).length;
if (expected.length < 100 || found.length !== expected.length || differing > 0) {
    const first = expected.findIndex((line, index) => line !== found[index]);
    console.log(`expected ${expected[first]}\nfound    ${found[first]}`);
    console.log(`${differing} of ${expected.length} lines differ, ${found.length} were found`);
    process.exit(1);
}
console.log(`${expected.length - 1} lines are the checked-in ones`);
