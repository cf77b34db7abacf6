use std::path::PathBuf;

use roxmltree::{Document, Node, ParsingOptions};

use super::labels::text_width;
use super::sample::{PAPER_PHASES, report, report_with_figures, run};
use super::*;

const ONE_FRAME: (&str, u32, f64, f64) = ("x", 1, 2.0, 0.0);

fn quantiles(mut samples: Vec<f64>) -> [f64; 4] {
    let Quantiles {
        median,
        p99,
        p999,
        max,
    } = Quantiles::from_samples(&mut samples).unwrap();
    [median, p99, p999, max]
}

#[test]
fn quantiles_are_nearest_ranks() {
    assert_eq!(quantiles(vec![7.0]), [7.0; 4]);
    assert_eq!(quantiles(vec![3.0, 1.0, 2.0]), [2.0, 3.0, 3.0, 3.0]);
    assert_eq!(quantiles(vec![4.0, 1.0, 3.0, 2.0]), [2.0, 4.0, 4.0, 4.0]);
    assert_eq!(
        quantiles((1..=100).map(f64::from).collect()),
        [50.0, 99.0, 100.0, 100.0]
    );
    assert_eq!(
        quantiles((1..=1000).rev().map(f64::from).collect()),
        [500.0, 990.0, 999.0, 1000.0]
    );
    assert_eq!(
        quantiles((1..=3653).map(f64::from).collect()),
        [1827.0, 3617.0, 3650.0, 3653.0]
    );
    assert!(Quantiles::from_samples(&mut []).is_none());
    assert!(
        Quantiles::from_samples(&mut [1.0, f64::NAN])
            .unwrap()
            .max
            .is_nan()
    );
}

#[test]
fn json_reads_back_as_the_same_report() {
    let report = report_with_figures();
    let json = to_json(&report).unwrap();
    assert_eq!(serde_json::from_str::<Report>(&json).unwrap(), report);
    let frames: u32 = report.runs.iter().map(|run| run.frames).sum();
    let frames = frames + report.figures.iter().map(|scene| scene.frames).sum::<u32>();
    let frame_lines = json
        .lines()
        .filter(|line| line.trim_start().starts_with("{\"frame\": "));
    assert_eq!(frame_lines.count(), frames as usize);
    assert!(json.contains("\"ball\": \"hull\""));
}

#[test]
fn json_with_a_number_that_is_not_finite_is_refused() {
    let mut report = report();
    report.runs[1].phases[2].jitter_mm_max = Some(f64::NAN);
    assert_eq!(
        to_json(&report).unwrap_err().kind(),
        io::ErrorKind::InvalidData
    );
    report.runs[1].phases[2].jitter_mm_max = None;
    report.runs[1].samples[5].time_us = f64::INFINITY;
    assert_eq!(
        to_json(&report).unwrap_err().kind(),
        io::ErrorKind::InvalidData
    );
}

#[test]
fn slugs_are_file_names_and_differ() {
    let mut report = report();
    for (run, name) in report.runs.iter_mut().zip([
        "Ball, as  sphere",
        "ball as sphere",
        "ball-as-sphere-2",
        "../µ",
    ]) {
        run.name = name.to_owned();
    }
    assert_eq!(
        report.slugs(),
        [
            "ball-as-sphere",
            "ball-as-sphere-2",
            "ball-as-sphere-2-2",
            "run"
        ]
    );
}

#[test]
fn table_has_a_row_per_phase_and_120_columns() {
    let mut report = report_with_figures();
    report.runs[0].name = "ball as sphere, with noise..".to_owned();
    report.runs[0].phases[1].frame_time_us.max = 1234.5;
    report.runs[0].phases[1].units_total = 12_345_678;
    let table = table(&report);
    let rows = table
        .lines()
        .filter(|line| line.contains("slide back"))
        .count();
    assert_eq!(rows, 2 * report.runs.len());
    for line in table.lines() {
        assert!(
            line.chars().count() <= 120,
            "{}: {line}",
            line.chars().count()
        );
    }
}

#[test]
fn table_and_page_mark_broken_promises_only() {
    let mut report = report();
    for phase in report.runs.iter_mut().flat_map(|run| &mut run.phases) {
        phase.overlap_hand_fixed_mm_max = HAND_FIXED_OVERLAP_MM_MAX;
        phase.overlap_hand_ball_mm_max = BALL_OVERLAP_MM_MAX;
    }
    assert!(!table(&report).contains("!0"));
    assert!(!index_html(&report).contains("class=\"broken\""));
    report.runs[2].phases[0].overlap_ball_fixed_mm_max = f64::NAN;
    report.runs[1].phases[0].overlap_hand_fixed_mm_max = 0.101;
    report.runs[1].phases[0].free_lag_mm_max = Some(1e-9);
    assert!(table(&report).contains("!NaN"));
    assert!(table(&report).contains("!0.101"));
    assert!(table(&report).contains("!<0.001"));
    assert_eq!(
        index_html(&report).matches("<td class=\"broken\"").count(),
        3
    );
}

struct Text {
    content: String,
    left: f64,
    right: f64,
    y: f64,
    is_upright: bool,
}

fn number(node: &Node, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

fn text_of(node: &Node) -> Text {
    let content = node.text().unwrap().trim().to_owned();
    let is_bold = node.attribute("font-weight") == Some("bold");
    let width = text_width(&content, number(node, "font-size"), is_bold);
    let left = match node.attribute("text-anchor") {
        Some("middle") => number(node, "x") - 0.5 * width,
        Some("end") => number(node, "x") - width,
        _ => number(node, "x"),
    };
    let is_upright = node.has_attribute("transform");
    Text {
        content,
        left,
        right: left + width,
        y: number(node, "y"),
        is_upright,
    }
}

fn texts(document: &Document) -> Vec<Text> {
    elements(document, "text").iter().map(text_of).collect()
}

fn view_box(document: &Document) -> [f64; 2] {
    let view_box = document.root_element().attribute("viewBox").unwrap();
    let sizes: Vec<f64> = view_box
        .split(' ')
        .map(|size| size.parse().unwrap())
        .collect();
    [sizes[2], sizes[3]]
}

/// Every phase has its label, no text leaves the figure, no text meets another.
fn assert_legible(run: &Run) {
    let svg = frame_time_svg(run);
    let document = Document::parse(&svg).unwrap();
    let [width, height] = view_box(&document);
    let texts = texts(&document);
    for phase in &run.phases {
        let is_label = |text: &&Text| text.content == super::labels::shortened(&phase.name, 32);
        let same_name = run
            .phases
            .iter()
            .filter(|other| other.name == phase.name)
            .count();
        assert_eq!(
            texts.iter().filter(is_label).count(),
            same_name,
            "{}",
            phase.name
        );
    }
    assert_apart(&texts, [width, height]);
}

/// No text leaves the figure, no text meets another.
fn assert_apart(texts: &[Text], [width, height]: [f64; 2]) {
    let font = 16.0 * 8.0;
    let level: Vec<&Text> = texts.iter().filter(|text| !text.is_upright).collect();
    for (index, text) in level.iter().enumerate() {
        assert!(
            text.left >= 0.0 && text.right <= width && text.y + font < height,
            "{} is clipped",
            text.content
        );
        for other in &level[index + 1..] {
            let apart = text.right <= other.left
                || other.right <= text.left
                || (text.y - other.y).abs() >= 0.9 * font;
            assert!(apart, "{} meets {}", text.content, other.content);
        }
    }
}

#[test]
fn figures_are_legible() {
    for run in &report().runs {
        assert_legible(run);
    }
}

#[test]
fn figures_of_joints_are_legible() {
    for scene in &report_with_figures().figures {
        let svg = joints_svg(scene);
        let document = Document::parse(&svg).unwrap();
        assert_apart(&texts(&document), view_box(&document));
        assert!(elements(&document, "polyline").len() > 10);
    }
}

#[test]
fn page_has_every_scene_of_the_figures() {
    let report = report_with_figures();
    let html = index_html(&report);
    let page = page(&html);
    let drawn = report.runs.len() + report.figures.len();
    assert_eq!(elements(&page, "svg").len(), drawn);
    let is_row = |node: &&Node, name: &str| {
        node.attribute("scope") == Some("row") && node.text() == Some(name)
    };
    for scene in &report.figures {
        let rows = elements(&page, "th");
        let rows = rows.iter().filter(|node| is_row(node, &scene.name));
        assert_eq!(rows.count(), 2, "{}", scene.name);
    }
}

#[test]
fn labels_stand_above_the_data() {
    let run = &report().runs[0];
    let svg = frame_time_svg(run);
    let document = Document::parse(&svg).unwrap();
    let highest = elements(&document, "polyline")
        .iter()
        .map(highest_y_of_curve)
        .fold(f64::MAX, f64::min);
    let labels = texts(&document)
        .into_iter()
        .filter(|text| run.phases.iter().any(|phase| phase.name == text.content));
    assert!(labels.map(|label| label.y).fold(0.0, f64::max) + 8.0 * 8.0 < highest);
}

/// Straight lines and frames have up to five points; curves have more.
fn highest_y_of_curve(polyline: &Node) -> f64 {
    let points: Vec<&str> = polyline
        .attribute("points")
        .unwrap()
        .split_whitespace()
        .collect();
    let y = |point: &&str| point.split_once(',').unwrap().1.parse::<f64>().unwrap();
    if points.len() > 5 {
        points.iter().map(y).fold(f64::MAX, f64::min)
    } else {
        f64::MAX
    }
}

#[test]
fn figures_of_crowded_phases_are_legible() {
    let crowd = [
        ("first of all", 3),
        ("then", 1),
        ("and", 2),
        ("a rather long name for a phase that ends", 400),
        ("z", 2),
    ];
    let crowd = crowd.map(|(name, frames)| (name, frames, 20.0, 12.0));
    assert_legible(&run("crowd", Ball::Hull, true, 3, &crowd));
    let mut reversed = crowd;
    reversed.reverse();
    assert_legible(&run("crowd", Ball::Hull, true, 3, &reversed));
}

#[test]
fn figures_of_next_to_nothing_are_legible() {
    assert_legible(&run("no frame", Ball::Hull, false, 1, &[]));
    assert_legible(&run("one frame", Ball::Hull, false, 1, &[ONE_FRAME]));
    let mut odd = run("odd", Ball::Hull, false, 1, &PAPER_PHASES);
    odd.samples[7].time_us = 0.0;
    odd.samples[8].time_us = f64::NAN;
    odd.samples[9].time_us = 1e12;
    odd.samples[10].time_us = -1.0;
    assert_legible(&odd);
}

#[test]
fn flags_are_not_crossed_by_later_leaders() {
    use super::labels::{Layout, Wish};
    let wish = |left: f64, right: f64| Wish {
        band_left: left,
        band_right: right,
        width: 100.0,
    };
    assert_eq!(
        Layout::new(&[wish(0.0, 110.0), wish(110.0, 400.0)]),
        Layout::Centred
    );
    let crowd = [wish(0.0, 20.0), wish(20.0, 60.0), wish(60.0, 300.0)];
    assert_eq!(Layout::new(&crowd), Layout::Flags(vec![1, 0, 0]));
    let tight = [wish(0.0, 20.0), wish(20.0, 30.0), wish(30.0, 40.0)];
    assert_eq!(Layout::new(&tight), Layout::Flags(vec![2, 1, 0]));
}

#[test]
fn names_with_markup_stay_text() {
    let mut report = report();
    report.title = "{{figures}}".to_owned();
    report.runs[0].name = "a < b & \"c\" </text>".to_owned();
    report.runs[0].phases[0].name = "<idle>".to_owned();
    let svg = frame_time_svg(&report.runs[0]);
    let drawn = Document::parse(&svg).unwrap();
    assert!(texts(&drawn).iter().any(|text| text.content == "<idle>"));
    let html = index_html(&report);
    let page = page(&html);
    assert_eq!(elements(&page, "h1")[0].text(), Some("{{figures}}"));
    assert_eq!(elements(&page, "svg").len(), report.runs.len());
}

fn page(html: &str) -> Document<'_> {
    Document::parse_with_options(
        html,
        ParsingOptions {
            allow_dtd: true,
            ..ParsingOptions::default()
        },
    )
    .unwrap()
}

fn elements<'a>(page: &'a Document, name: &str) -> Vec<Node<'a, 'a>> {
    page.descendants()
        .filter(|node| node.tag_name().name() == name)
        .collect()
}

#[test]
fn page_has_every_run_and_no_request() {
    let report = report();
    let html = index_html(&report);
    let page = page(&html);
    let row_groups = elements(&page, "th");
    for run in &report.runs {
        let is_name = |node: &&Node| {
            node.attribute("scope") == Some("rowgroup") && node.text() == Some(&*run.name)
        };
        assert_eq!(row_groups.iter().filter(is_name).count(), 2, "{}", run.name);
        assert!(html.contains(&run.state_hash));
    }
    assert_eq!(elements(&page, "svg").len(), report.runs.len());
    assert!(!html.contains("src="));
    assert!(!html.contains("{{"));
    let is_outside = |node: &Node| {
        node.attribute("href")
            .is_some_and(|href| href.contains("//"))
    };
    assert!(!page.descendants().any(|node| is_outside(&node)));
}

#[test]
fn writing_leaves_a_page_a_json_and_a_figure_per_run() {
    let report = report();
    let out_dir = Scratch::new();
    write(&report, &out_dir.0.join("deep/er")).unwrap();
    let mut names: Vec<String> = std::fs::read_dir(out_dir.0.join("deep/er"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "frame-time-ball-as-hull-no-noise.svg",
            "frame-time-ball-as-hull-noise.svg",
            "frame-time-ball-as-sphere-no-noise.svg",
            "frame-time-ball-as-sphere-noise.svg",
            "index.html",
            "report.json",
        ]
    );
    let json = std::fs::read_to_string(out_dir.0.join("deep/er/report.json")).unwrap();
    assert!(!json.contains(out_dir.0.to_str().unwrap()));
    assert!(!json.contains("\"/"));
}

struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Self {
        Self(std::env::temp_dir().join(format!("palpable-report-{}", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
