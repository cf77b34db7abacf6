//! The checked-in header is what `src/` says, and every C and C++ compiler can read it.
//!
//! `PALPABLE_UPDATE_HEADER=1 cargo test -p palpable-ffi --test header` writes it anew.

mod common;

use std::path::{Path, PathBuf};
use std::{env, fs};

use common::{Compiler, Run, scratch};
use palpable_kernel::memory::Capacities;
use palpable_kernel::state::bodies::Coupling;
use palpable_kernel::state::chains::ChainOptions;
use palpable_kernel::world::{PieceDef, Shape};

fn package() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The sources of exports, in the order of the header.
const SOURCES: [&str; 16] = [
    "status.rs",
    "types.rs",
    "skeleton.rs",
    "world.rs",
    "materials.rs",
    "bodies.rs",
    "hosted.rs",
    "pieces.rs",
    "chains.rs",
    "human.rs",
    "hands.rs",
    "frame.rs",
    "contacts.rs",
    "query.rs",
    "state.rs",
    "recording.rs",
];

fn header_path() -> PathBuf {
    package().join("include/palpable.h")
}

/// A float as a C literal.
fn literal(x: f32) -> String {
    format!("{x:?}f")
}

/// Fills the kernel's own defaults into the initialisers of `cbindgen.toml`.
fn with_defaults(text: &str) -> String {
    let room = Capacities::ROOM;
    let coupling = Coupling::DEFAULT;
    let numbers = [
        room.bodies,
        room.pieces,
        room.vertices,
        room.pairs,
        room.contacts,
        room.materials,
        room.chains,
        room.joints,
    ];
    let spring = [
        literal(coupling.mass_kg),
        literal(coupling.stiffness_n_per_m),
        literal(coupling.damping_n_s_per_m),
        literal(coupling.divergence_m),
        coupling.snap.to_string(),
        literal(coupling.grace_s),
        coupling.push.to_string(),
    ];
    let options = ChainOptions::DEFAULT;
    let [x, y, z] = options.tip.map(literal);
    let chain = [
        options.method.to_string(),
        options.flags.to_string(),
        literal(options.attraction_s),
        format!("{{ {x}, {y}, {z} }}"),
    ];
    let density = PieceDef::new(Shape::Point, 1.0).density_kg_m3;
    text.replace("@ROOM@", &numbers.map(|n| n.to_string()).join(", "))
        .replace("@COUPLING@", &spring.join(", "))
        .replace("@CHAIN@", &chain.join(", "))
        .replace("@DENSITY@", &literal(density))
}

fn generated() -> String {
    let mut config = cbindgen::Config::from_file(package().join("cbindgen.toml")).unwrap();
    config.after_includes = config.after_includes.as_deref().map(with_defaults);
    let builder = cbindgen::Builder::new().with_config(config);
    let builder = SOURCES.iter().fold(builder, |builder, source| {
        builder.with_src(package().join("src").join(source))
    });
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

#[test]
fn the_checked_in_header_is_the_generated_one() {
    let text = generated();
    if env::var_os("PALPABLE_UPDATE_HEADER").is_some_and(|value| value == "1") {
        fs::write(header_path(), &text).unwrap();
    }
    let checked_in = fs::read_to_string(header_path()).unwrap_or_default();
    assert!(
        checked_in == text,
        "include/palpable.h is out of date: run PALPABLE_UPDATE_HEADER=1 cargo test -p palpable-ffi --test header"
    );
}

/// Names of the functions that `src/` exports.
fn exports() -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(package().join("src")).unwrap() {
        let text = fs::read_to_string(entry.unwrap().path()).unwrap();
        for after in text.split("#[unsafe(no_mangle)]").skip(1) {
            let name = after
                .split("fn ")
                .nth(1)
                .unwrap()
                .split('(')
                .next()
                .unwrap();
            names.push(name.to_string());
        }
    }
    names
}

#[test]
fn every_export_is_declared_once() {
    let header = generated();
    let names = exports();
    assert!(names.len() > 25);
    for name in names {
        assert!(name.starts_with("palp_"), "{name}");
        assert_eq!(header.matches(&format!("{name}(")).count(), 1, "{name}");
    }
}

/// Uses every initialiser, so that a field too many or too few is an error.
const USES_ALL: &str = r"
#include <palpable.h>
#include <palpable.h>

int use_all(void);
int use_all(void) {
    palp_pose pose = PALP_POSE_IDENTITY;
    palp_capacities room = PALP_CAPACITIES_ROOM;
    palp_coupling coupling = PALP_COUPLING_DEFAULT;
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_joint joint = PALP_JOINT_INIT;
    palp_chain_options options = PALP_CHAIN_OPTIONS_DEFAULT;
    palp_chain_def chain = PALP_CHAIN_DEF_INIT;
    palp_chain_state bent = PALP_CHAIN_STATE_INIT;
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_frame_report report = PALP_FRAME_REPORT_INIT;
    palp_driven_state state = PALP_DRIVEN_STATE_INIT;
    palp_hosted_input hosted = PALP_HOSTED_INPUT_INIT;
    palp_hosted_state pushed = PALP_HOSTED_STATE_INIT;
    palp_penetration_result result = PALP_PENETRATION_RESULT_INIT;
    palp_replay replay = PALP_REPLAY_INIT;
    palp_replayed call = PALP_REPLAYED_INIT;
    palp_body_id id = {0, 0};
    palp_world *world = NULL;
    void *memory = NULL;
    return (int)(pose.position.x + coupling.grace_s) + (int)(body.kind + piece.shape) +
           (int)(input.struct_size + report.flags + state.flags + id.index1 + result.contact_count) +
           (int)(joint.kind + options.method + chain.base.index1 + bent.flags) +
           (int)(hosted.body.index1 + pushed.contacts) +
           (int)(replay.calls + call.recorded_value) +
           palp_world_create(memory, 0, &room, &world);
}
";

fn compiles(compiler: Compiler, extension: &str) {
    let source = scratch(&format!("header_alone.{extension}"));
    fs::write(&source, USES_ALL).unwrap();
    let object = source.with_extension(format!("{extension}.o"));
    compiler
        .command()
        .arg("-c")
        .arg(&source)
        .arg("-o")
        .arg(object)
        .run_clean();
}

#[test]
fn the_header_is_clean_c99() {
    compiles(Compiler::C99, "c");
}

#[test]
fn the_header_is_clean_cpp11() {
    compiles(Compiler::Cpp11, "cpp");
}
