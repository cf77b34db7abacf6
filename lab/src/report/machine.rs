//! Names of the machine that are worth printing beside a measurement, and none that identify it.

use std::env::consts::{ARCH, OS};
use std::process::Command;

use super::Machine;

impl Machine {
    /// Reads the processor's and the system's names, and asks the `rustc` on the search path for
    /// its version.
    ///
    /// What cannot be found out is `unknown`, or `None` for the compiler.
    pub fn detect() -> Self {
        Self {
            cpu: cpu(),
            os: format!("{}, {ARCH}", os()),
            rustc: rustc(),
        }
    }
}

fn cpu() -> String {
    let linux = || {
        colon_value(
            &std::fs::read_to_string("/proc/cpuinfo").ok()?,
            "model name",
        )
    };
    let mac = || first_line(Command::new("sysctl").args(["-n", "machdep.cpu.brand_string"]));
    let windows = || std::env::var("PROCESSOR_IDENTIFIER").ok();
    linux()
        .or_else(mac)
        .or_else(windows)
        .unwrap_or_else(|| "unknown".to_owned())
}

fn os() -> String {
    let pretty_name = || {
        let release = std::fs::read_to_string("/etc/os-release").ok()?;
        let value = release
            .lines()
            .find_map(|line| line.strip_prefix("PRETTY_NAME="))?;
        Some(value.trim_matches('"').to_owned())
    };
    pretty_name().unwrap_or_else(|| OS.to_owned())
}

fn rustc() -> Option<String> {
    first_line(Command::new("rustc").arg("--version"))
}

fn colon_value(text: &str, key: &str) -> Option<String> {
    let line = text.lines().find(|line| line.starts_with(key))?;
    let (_, value) = line.split_once(':')?;
    Some(value.trim().to_owned())
}

fn first_line(command: &mut Command) -> Option<String> {
    let output = command
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.lines()
        .next()
        .map(|line| line.trim().to_owned())
        .filter(|line| !line.is_empty())
}
