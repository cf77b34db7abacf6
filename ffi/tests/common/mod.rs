//! Compilers, the library as built for these tests, and programs run against it.

#![allow(dead_code, reason = "each test binary uses a part")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::{env, fs};

/// The package's own directory.
pub fn package() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A path for a file of these tests, under the target directory.
pub fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("palpable-ffi");
    fs::create_dir_all(&directory).unwrap();
    directory.join(name)
}

/// Whether a tool that is not there must fail the tests: on a machine that is set up for them.
pub fn skip(what: &str) {
    let strict = env::var_os("CI").is_some_and(|value| value == "true");
    assert!(!strict, "{what} is missing, and CI=true allows no skipping");
    eprintln!("SKIPPED: {what} is missing");
}

/// Whether a program can be started.
pub fn is_installed(program: &str, version: &str) -> bool {
    Command::new(program)
        .arg(version)
        .output()
        .is_ok_and(|output| output.status.success())
}

/// A language and its strictness.
#[derive(Clone, Copy)]
pub enum Compiler {
    C99,
    Cpp11,
}

impl Compiler {
    /// A command that finds the header and treats every warning as an error.
    pub fn command(self) -> Command {
        let (variable, usual, standard) = match self {
            Self::C99 => ("CC", "cc", "-std=c99"),
            Self::Cpp11 => ("CXX", "c++", "-std=c++11"),
        };
        let mut command = Command::new(env::var_os(variable).unwrap_or_else(|| usual.into()));
        command
            .args([standard, "-pedantic", "-Wall", "-Wextra", "-Werror"])
            .args(["-O1", "-ffp-contract=off", "-I"])
            .arg(package().join("include"));
        command
    }
}

/// Running to a good end, or failing with what was printed.
pub trait Run {
    /// Runs; what it printed to its standard output.
    fn run_clean(&mut self) -> String;
}

impl Run for Command {
    fn run_clean(&mut self) -> String {
        let shown = format!("{self:?}");
        let output = self
            .output()
            .unwrap_or_else(|error| panic!("{shown}: {error}"));
        judge(&shown, &output);
        String::from_utf8(output.stdout).unwrap()
    }
}

fn judge(shown: &str, output: &Output) {
    assert!(
        output.status.success(),
        "{shown}: {}\n{}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
}

/// The built library.
pub struct Library {
    /// Where `libpalpable.a` and the shared library lie.
    pub directory: PathBuf,
}

/// The library in the profile of this test, built once for each test binary.
pub fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(build)
}

fn build() -> Library {
    // target/PROFILE/deps/this-test
    let test = env::current_exe().unwrap();
    let directory = test.ancestors().nth(2).unwrap().to_path_buf();
    let target = directory.parent().unwrap();
    let profile = match directory.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => "dev",
        Some(name) => name,
    };
    Command::new(env!("CARGO"))
        .current_dir(package())
        .args(["build", "--package", "palpable-ffi", "--profile", profile])
        .arg("--target-dir")
        .arg(target)
        .run_clean();
    Library { directory }
}

/// Libraries that a program needs beside the static library.
fn system_libraries() -> &'static [&'static str] {
    if cfg!(target_os = "linux") {
        &["-lpthread", "-ldl", "-lm"]
    } else {
        &["-lm"]
    }
}

impl Library {
    /// Compiles a program of `hosts/` and links the static library into it.
    pub fn link_static(&self, compiler: Compiler, source: &str) -> PathBuf {
        let program = self.program(source, "static");
        compiler
            .command()
            .arg(package().join("hosts").join(source))
            .arg(self.directory.join("libpalpable.a"))
            .args(system_libraries())
            .arg("-o")
            .arg(&program)
            .run_clean();
        program
    }

    /// Compiles a program of `hosts/` against the shared library.
    pub fn link_shared(&self, compiler: Compiler, source: &str) -> PathBuf {
        let program = self.program(source, "shared");
        compiler
            .command()
            .arg(package().join("hosts").join(source))
            .arg("-L")
            .arg(&self.directory)
            .args(["-lpalpable", "-lm"])
            .arg(format!("-Wl,-rpath,{}", self.directory.display()))
            .arg("-o")
            .arg(&program)
            .run_clean();
        program
    }

    fn program(&self, source: &str, how: &str) -> PathBuf {
        scratch(&format!("{}.{how}", source.replace(['/', '.'], "_")))
    }

    /// The shared library's file.
    pub fn shared(&self) -> PathBuf {
        let name = if cfg!(target_os = "macos") {
            "libpalpable.dylib"
        } else {
            "libpalpable.so"
        };
        self.directory.join(name)
    }
}
