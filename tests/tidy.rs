//! The law as a test over the text of `src/`. Its tables only ever get shorter.

use std::fs;
use std::path::{Path, PathBuf};

/// The stages of a frame, in their order.
const STAGES: [&str; 7] = [
    "couple", "pairs", "contacts", "reach", "advance", "impulses", "publish",
];

/// Stages that still take something from another one or from the frame above them: who, from whom,
/// what, and why. Each line is a debt; the aim is none.
const BETWEEN_STAGES: &[(&str, &str, &str)] = &[
    // Flags and sums of a frame are the frame's.
    ("impulses", "frame", "sets flags of the report"),
];

/// Longest function, in lines.
const FUNCTION_LINES_MAX: usize = 60;

/// Functions that are longer: file, name, lines.
const LONG_FUNCTIONS: &[(&str, &str, usize)] = &[];

/// Largest file, in bytes.
const FILE_BYTES_MAX: u64 = 40_000;

/// Calls that give other bits on other processors, or that belong to `math.rs`.
const FLOAT_CALLS: [&str; 27] = [
    ".sin(",
    ".cos(",
    ".tan(",
    ".sin_cos(",
    ".asin(",
    ".acos(",
    ".atan(",
    ".atan2(",
    ".sinh(",
    ".cosh(",
    ".tanh(",
    ".sqrt(",
    ".cbrt(",
    ".hypot(",
    ".exp(",
    ".exp2(",
    ".exp_m1(",
    ".ln(",
    ".ln_1p(",
    ".log2(",
    ".log10(",
    ".powf(",
    ".powi(",
    ".mul_add(",
    ".length()",
    ".normalize",
    "libm::",
];

struct Source {
    /// Path below `src/`, with slashes.
    name: String,
    text: String,
    /// The text without comments and without what stands in string literals.
    code: String,
}

fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push(path);
        }
    }
}

fn files_below(folder: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    rust_files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join(folder),
        &mut files,
    );
    files.sort();
    assert!(!files.is_empty());
    files
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    files_below("src")
        .iter()
        .map(|path| {
            let text = fs::read_to_string(path).unwrap();
            let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
            Source {
                name: name.replace('\\', "/"),
                code: text.lines().map(code_of).collect::<Vec<_>>().join("\n"),
                text,
            }
        })
        .collect()
}

/// A line without its comment and without the insides of its string literals.
fn code_of(line: &str) -> String {
    let (mut code, mut quoted, mut before) = (String::new(), false, ' ');
    for (at, c) in line.char_indices() {
        if !quoted && line[at..].starts_with("//") {
            break;
        }
        if c == '"' && before != '\\' {
            quoted = !quoted;
        }
        if !quoted || c == '"' {
            code.push(c);
        }
        before = c;
    }
    code
}

/// Whether `start` stands in `text` with no letter, digit or underscore before it.
fn starts_a_word(text: &str, start: &str) -> bool {
    let joins = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(start)
        .any(|(at, _)| !text[..at].chars().next_back().is_some_and(joins))
}

/// The modules of the crate that a file names by their full path, `use crate::{..}` included.
fn modules_named(source: &Source) -> Vec<String> {
    let mut named = Vec::new();
    for (at, found) in source.code.match_indices("crate::") {
        let rest = &source.code[at + found.len()..];
        let (list, braced) = match rest.strip_prefix('{') {
            Some(inner) => (inner.split('}').next().unwrap_or(""), true),
            None => (rest, false),
        };
        for part in list.split(',') {
            let name: String = part
                .trim_start()
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            named.push(name);
            if !braced {
                break;
            }
        }
    }
    named
}

/// The first folder or file of a path below `src/`, without its ending.
fn module_of(source: &Source) -> &str {
    let first = source.name.split('/').next().unwrap();
    first.trim_end_matches(".rs")
}

#[test]
fn float_functions_live_in_math() {
    for source in sources() {
        if source.name == "math.rs" {
            continue;
        }
        for (index, line) in source.code.lines().enumerate() {
            for call in FLOAT_CALLS {
                assert!(
                    !line.contains(call),
                    "src/{}:{}: {call} belongs to math.rs",
                    source.name,
                    index + 1
                );
            }
        }
    }
}

/// What needs an allocator, the standard library, or trust. `ArrayVec` and heapless are bounded.
const FORBIDDEN: [&str; 13] = [
    "unsafe ",
    "static mut ",
    "std::",
    "alloc::",
    "extern crate",
    "Vec<",
    "Vec::",
    "Box<",
    "Box::new",
    "Rc<",
    "Arc<",
    "String",
    "vec!",
];

#[test]
fn the_kernel_neither_allocates_nor_trusts() {
    for source in sources() {
        let code = source.code.replace("heapless::Vec", "heapless::Bounded");
        for start in FORBIDDEN {
            assert!(
                !starts_a_word(&code, start),
                "src/{} has {start}",
                source.name
            );
        }
    }
    let lib = sources().into_iter().find(|source| source.name == "lib.rs");
    let lib = lib.unwrap().text;
    assert!(lib.contains("#![no_std]") && lib.contains("#![forbid(unsafe_code)]"));
}

#[test]
fn stages_do_not_call_each_other() {
    let mut found: Vec<(String, String)> = Vec::new();
    for source in sources() {
        let stage = module_of(&source);
        if !STAGES.contains(&stage) {
            continue;
        }
        for other in modules_named(&source) {
            let reaches = STAGES.contains(&other.as_str()) || other == "frame" || other == "world";
            if reaches && other != stage {
                found.push((stage.to_owned(), other));
            }
        }
    }
    for (from, to) in &found {
        let excused = BETWEEN_STAGES.iter().any(|(a, b, _)| a == from && b == to);
        assert!(
            excused,
            "{from} takes from {to}: move it to geometry or state"
        );
    }
    for (from, to, why) in BETWEEN_STAGES {
        let needed = found.iter().any(|(a, b)| a == from && b == to);
        assert!(
            needed,
            "{from} no longer {why}: strike its line with {to} out"
        );
    }
}

#[test]
fn arrows_point_one_way() {
    for (module, allowed) in [
        ("math", &["math"][..]),
        ("limits", &["limits", "math"]),
        ("geometry", &["geometry", "limits", "math"]),
        ("memory", &["memory", "state", "limits", "math"]),
        ("state", &["state", "memory", "geometry", "limits", "math"]),
    ] {
        for source in sources() {
            if module_of(&source) != module {
                continue;
            }
            for other in modules_named(&source) {
                assert!(
                    allowed.contains(&other.as_str()),
                    "src/{} takes from {other}",
                    source.name
                );
            }
        }
    }
}

/// The functions of a file: name and number of lines, signature and closing brace included.
fn functions(source: &Source) -> Vec<(String, usize)> {
    let lines: Vec<&str> = source.code.lines().collect();
    let mut found = Vec::new();
    for (first, line) in lines.iter().enumerate() {
        let bare = line.trim_start();
        let indent = &line[..line.len() - bare.len()];
        let Some(name) = function_name(bare) else {
            continue;
        };
        let end = format!("{indent}}}");
        let last = lines[first..].iter().position(|l| l.trim_end() == end);
        found.push((name, last.map_or(1, |last| last + 1)));
    }
    found
}

fn function_name(line: &str) -> Option<String> {
    let (before, rest) = line.split_once("fn ")?;
    let qualifies = |word: &str| {
        word.starts_with("pub") || ["const", "unsafe", "extern", "async"].contains(&word)
    };
    if !before
        .split_whitespace()
        .all(|word| qualifies(word) || word.ends_with(')'))
    {
        return None;
    }
    let name = rest
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_');
    Some(name.collect()).filter(|name: &String| !name.is_empty())
}

#[test]
fn functions_are_short() {
    let mut long = Vec::new();
    let mut count = 0;
    for source in sources() {
        for (name, lines) in functions(&source) {
            count += 1;
            if lines > FUNCTION_LINES_MAX {
                long.push((source.name.clone(), name, lines));
            }
        }
    }
    assert!(count > 200, "only {count} functions were found");
    for (file, name, lines) in &long {
        let known = LONG_FUNCTIONS
            .iter()
            .any(|(f, n, most)| f == file && n == name && lines <= most);
        assert!(known, "src/{file}: {name} has {lines} lines");
    }
    for (file, name, most) in LONG_FUNCTIONS {
        let still = long
            .iter()
            .any(|(f, n, lines)| f == file && n == name && lines == most);
        assert!(still, "src/{file}: {name} got shorter, lower its line");
    }
}

#[test]
fn files_are_small() {
    for path in files_below("src") {
        let bytes = fs::metadata(&path).unwrap().len();
        assert!(
            bytes <= FILE_BYTES_MAX,
            "{} has {bytes} bytes",
            path.display()
        );
    }
}

#[test]
fn nothing_is_left_for_later() {
    for source in sources() {
        for word in [
            "TODO",
            "FIXME",
            "XXX",
            "HACK",
            "todo!",
            "unimplemented!",
            "dbg!",
            "println!",
        ] {
            assert!(
                !source.text.contains(word),
                "src/{} has {word}",
                source.name
            );
        }
    }
}

#[test]
fn no_test_is_skipped() {
    let skipped = concat!("#[", "ignore");
    for path in files_below("tests").iter().chain(&files_below("src")) {
        let text = fs::read_to_string(path).unwrap();
        assert!(!text.contains(skipped), "{} skips a test", path.display());
    }
}

#[test]
fn every_file_says_what_it_is() {
    for source in sources() {
        assert!(
            source.text.starts_with("//! "),
            "src/{} has no first line",
            source.name
        );
    }
}

#[test]
fn the_reader_of_the_text_reads_it_right() {
    assert_eq!(code_of("a(\"b // c\"); // d"), "a(\"\"); ");
    assert!(starts_a_word("let x: Vec<u8>", "Vec<"));
    assert!(!starts_a_word("let x: ArrayVec<u8, 3>", "Vec<"));
    let source = Source {
        name: "advance/x.rs".into(),
        text: String::new(),
        code: "use crate::{couple, math};\nuse crate::pairs::push;\nfn f() {\n}\n".into(),
    };
    assert_eq!(module_of(&source), "advance");
    assert_eq!(modules_named(&source), ["couple", "math", "pairs"]);
    assert_eq!(functions(&source), [("f".to_owned(), 2)]);
    assert_eq!(function_name("pub(crate) const fn g<T>("), Some("g".into()));
    assert_eq!(function_name("let h = |fn_| 1;"), None);
}
