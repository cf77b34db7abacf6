//! Programs in other languages run the library, and come to the same state as the same calls in Rust.

#[path = "common/arm.rs"]
mod arm;
mod common;
#[path = "common/deadline.rs"]
mod deadline;
#[path = "common/engine.rs"]
mod engine;
#[path = "common/hold.rs"]
mod hold;
#[path = "common/scene.rs"]
mod scene;

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use common::{Compiler, Run, is_installed, library, package, scratch, skip};
use palpable_kernel::memory::BLOCK_ALIGNMENT;
use palpable_kernel::recording::Replay;
use palpable_kernel::state::bodies::Coupling;

fn hash_line(hash: u64) -> String {
    format!("hash {hash:016x}\n")
}

#[test]
fn the_table_in_c_linked_statically() {
    let program = library().link_static(Compiler::C99, "c/table.c");
    let printed = Command::new(program).run_clean();
    assert_eq!(printed, hash_line(scene::table()));
}

#[test]
fn the_table_in_c_against_the_shared_library() {
    let program = library().link_shared(Compiler::C99, "c/table.c");
    let printed = Command::new(program).run_clean();
    assert_eq!(printed, hash_line(scene::table()));
}

#[test]
fn a_push_in_cpp_linked_either_way() {
    let expected = hash_line(scene::push());
    let linked = library().link_static(Compiler::Cpp11, "cpp/push.cpp");
    assert_eq!(Command::new(linked).run_clean(), expected);
    let linked = library().link_shared(Compiler::Cpp11, "cpp/push.cpp");
    assert_eq!(Command::new(linked).run_clean(), expected);
}

#[test]
fn the_arm_in_c_linked_either_way() {
    let expected = hash_line(arm::arm());
    let linked = library().link_static(Compiler::C99, "c/arm.c");
    assert_eq!(Command::new(linked).run_clean(), expected);
    let linked = library().link_shared(Compiler::C99, "c/arm.c");
    assert_eq!(Command::new(linked).run_clean(), expected);
}

/// A program of `hosts/c` linked in every way that a host may choose.
fn linked_in_every_way(source: &str) -> [std::path::PathBuf; 3] {
    [
        library().link_static(Compiler::C99, source),
        library().link_shared(Compiler::C99, source),
        library().link_static(Compiler::Cpp11, source),
    ]
}

#[test]
fn two_palms_hold_a_box_in_c_and_cpp() {
    let ways = [Coupling::PUSH_WITHOUT_LAG, Coupling::PUSH_WITH_MASS];
    let expected = ways.map(|push| hash_line(hold::hold(push)));
    for program in linked_in_every_way("c/hold.c") {
        let printed = Command::new(program).run_clean();
        eprint!("{printed}");
        let lines: Vec<_> = printed.split_inclusive('\n').collect();
        assert_eq!(lines.len(), ways.len());
        for (line, hash) in lines.iter().zip(&expected) {
            assert!(line.contains(": kept, "), "{line}");
            assert!(line.ends_with(hash), "{line}{hash}");
        }
    }
}

#[test]
fn a_hand_far_from_its_tracker_in_c_and_cpp() {
    let mut told = Vec::new();
    for program in linked_in_every_way("c/detached.c") {
        let printed = Command::new(program).run_clean();
        eprint!("{printed}");
        for line in ["never: held", "when free: held", "near: snapped, 30."] {
            assert!(printed.contains(line), "{printed}");
        }
        told.push(printed);
    }
    assert!(told.iter().all(|printed| *printed == told[0]));
}

#[test]
fn an_engine_of_the_hosts_own_in_c_and_cpp() {
    let expected = hash_line(engine::engine());
    for program in linked_in_every_way("c/engine.c") {
        let printed = Command::new(program).run_clean();
        eprint!("{printed}");
        assert!(printed.ends_with(&expected), "{printed}{expected}");
    }
}

/// The state that the calls of a log come to when the kernel makes them, each as it was recorded.
fn replayed(log: &[u8]) -> u64 {
    let mut replay = Replay::open(log).unwrap();
    let capacities = replay.capacities();
    let mut memory = vec![0_u8; capacities.bytes() + BLOCK_ALIGNMENT];
    let start = memory.as_ptr().align_offset(BLOCK_ALIGNMENT);
    let mut world = replay.start(&mut memory[start..]).unwrap();
    while replay.next_call(&mut world).unwrap().is_some() {}
    world.hash()
}

#[test]
fn a_log_of_a_host_in_c_and_cpp_is_replayed_there_and_here() {
    let mut logs = Vec::new();
    for (way, program) in linked_in_every_way("c/record.c").into_iter().enumerate() {
        let file = scratch(&format!("record_{way}.palplog"));
        let printed = Command::new(program).arg(&file).run_clean();
        eprint!("{printed}");
        let log = fs::read(file).unwrap();
        let expected = hash_line(replayed(&log));
        assert!(printed.ends_with(&expected), "{printed}{expected}");
        logs.push(log);
    }
    assert!(logs.iter().all(|log| *log == logs[0]));
}

#[test]
fn frames_that_are_cut_in_c_and_cpp() {
    let expected = hash_line(deadline::deadline());
    for program in linked_in_every_way("c/deadline.c") {
        let printed = Command::new(program).run_clean();
        eprint!("{printed}");
        assert!(printed.ends_with(&expected), "{printed}{expected}");
    }
}

#[test]
fn an_elbow_in_cpp() {
    let linked = library().link_static(Compiler::Cpp11, "cpp/elbow.cpp");
    assert_eq!(Command::new(linked).run_clean(), hash_line(arm::elbow()));
}

/// What a program of `hosts/luajit` prints.
fn printed_by_luajit(program: &str) -> String {
    let header = package().join("include/palpable.h");
    let text = Compiler::C99
        .command()
        .args(["-E", "-P"])
        .arg(&header)
        .run_clean();
    let declarations = scratch(&format!("{program}_preprocessed.h"));
    fs::write(&declarations, only_ours(&text)).unwrap();
    Command::new("luajit")
        .arg(package().join("hosts/luajit").join(program))
        .args([library().shared(), declarations, header])
        .run_clean()
}

#[test]
fn the_table_in_luajit() {
    if !is_installed("luajit", "-v") {
        return skip("luajit");
    }
    let printed = printed_by_luajit("table.lua");
    assert_eq!(printed, hash_line(scene::table()));
}

#[test]
fn an_elbow_in_luajit() {
    if !is_installed("luajit", "-v") {
        return skip("luajit");
    }
    let printed = printed_by_luajit("elbow.lua");
    assert_eq!(printed, hash_line(arm::elbow()));
}

/// The header's own declarations, without those of the C library before them.
fn only_ours(preprocessed: &str) -> &str {
    let ours = preprocessed.find("palp_").unwrap();
    &preprocessed[preprocessed[..ours].rfind("typedef").unwrap()..]
}

#[test]
fn bad_input_is_refused() {
    let sources = ["c/refusals.c", "c/loose_refusals.c"];
    for (source, compiler) in sources
        .iter()
        .flat_map(|source| [Compiler::C99, Compiler::Cpp11].map(|compiler| (source, compiler)))
    {
        let program = library().link_static(compiler, source);
        let printed = Command::new(program).run_clean();
        assert!(
            printed.ends_with(" refusals as they should be\n"),
            "{printed}"
        );
    }
}

#[test]
fn the_example_of_the_readme_runs() {
    let program = library().link_static(Compiler::C99, "c/readme.c");
    assert_eq!(
        Command::new(program).run_clean(),
        "tracked 0.000 m, drawn 0.200 m\n"
    );
}

/// The README shows a part of the host that is compiled and run here, word for word.
#[test]
fn the_readme_shows_the_example() {
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let readme = read(&package().join("../README.md"));
    let shown = readme
        .split("```c\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let shown = shown.expect("the README has a C example");
    assert!(shown.lines().count() >= 10);
    assert!(read(&package().join("hosts/c/readme.c")).contains(shown));
}

#[test]
fn calls_are_cheap_enough_to_make() {
    let program = library().link_static(Compiler::C99, "c/cost.c");
    let printed = Command::new(program).run_clean();
    eprint!("{printed}");
    assert!(printed.contains("palp_body_pose"));
}

/// Where pkg-config and CMake find the library as the tests build it.
fn built() -> [(&'static str, std::path::PathBuf); 2] {
    [
        ("PALPABLE_INCLUDE", package().join("include")),
        ("PALPABLE_LIB", library().directory.clone()),
    ]
}

#[test]
fn pkg_config_finds_the_library() {
    if !is_installed("pkg-config", "--version") {
        return skip("pkg-config");
    }
    let [(_, include), (_, lib)] = built();
    let flags = Command::new("pkg-config")
        .env("PKG_CONFIG_PATH", package())
        .arg(format!(
            "--define-variable=includedir={}",
            include.display()
        ))
        .arg(format!("--define-variable=libdir={}", lib.display()))
        .args(["--cflags", "--libs", "palpable"])
        .run_clean();
    let program = scratch("readme_pkg_config");
    Compiler::C99
        .command()
        .arg(package().join("hosts/c/readme.c"))
        .args(flags.split_whitespace())
        .arg(format!("-Wl,-rpath,{}", lib.display()))
        .arg("-o")
        .arg(&program)
        .run_clean();
    Command::new(program).run_clean();
    let version = Command::new("pkg-config")
        .env("PKG_CONFIG_PATH", package())
        .args(["--modversion", "palpable"])
        .run_clean();
    assert_eq!(version.trim(), env!("CARGO_PKG_VERSION"));
}

#[test]
fn cmake_finds_the_library() {
    if !is_installed("cmake", "--version") {
        return skip("cmake");
    }
    let directory = scratch("cmake-host");
    fs::create_dir_all(&directory).unwrap();
    let source = package().join("hosts/c/readme.c");
    let project = format!(
        "cmake_minimum_required(VERSION 3.16)\n\
         project(host C)\n\
         find_package(palpable {} CONFIG REQUIRED)\n\
         foreach(kind static shared)\n\
           add_executable(host_${{kind}} \"{}\")\n\
           target_link_libraries(host_${{kind}} PRIVATE palpable::${{kind}})\n\
         endforeach()\n",
        env!("CARGO_PKG_VERSION"),
        source.display(),
    );
    fs::write(directory.join("CMakeLists.txt"), project).unwrap();
    let [(_, include), (_, lib)] = built();
    let build = directory.join("build");
    let _ = fs::remove_dir_all(&build);
    Command::new("cmake")
        .arg("-S")
        .arg(&directory)
        .arg("-B")
        .arg(&build)
        .arg(format!(
            "-Dpalpable_DIR={}",
            package().join("cmake").display()
        ))
        .arg(format!("-DPALPABLE_INCLUDE_DIR={}", include.display()))
        .arg(format!("-DPALPABLE_LIB_DIR={}", lib.display()))
        .run_clean();
    Command::new("cmake").arg("--build").arg(&build).run_clean();
    Command::new(build.join("host_static")).run_clean();
    Command::new(build.join("host_shared")).run_clean();
}
