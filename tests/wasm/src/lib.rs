//! The table of the goldens for a host that loads WebAssembly and gives the module nothing.
//!
//! `.ci/wasm` builds it, and `.ci/wasm.mjs` compares what it says with `tests/golden.txt`.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../common/scenes.rs"]
mod scenes;
#[path = "../../common/table.rs"]
mod table;
#[path = "../../common/watched.rs"]
mod watched;

use std::sync::OnceLock;

static TABLE: OnceLock<String> = OnceLock::new();

fn text() -> &'static str {
    TABLE.get_or_init(table::table)
}

/// Where the table's bytes begin in the module's memory.
#[unsafe(no_mangle)]
pub extern "C" fn table_start() -> *const u8 {
    text().as_ptr()
}

/// How many bytes the table has, as UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn table_bytes() -> usize {
    text().len()
}
