//! Figures with joints in the page.

use super::data::is_beyond;
use super::figure::escaped;
use super::figures::{BEYOND_LIMITS_RAD_MAX, FigureScene};
use super::format::{count, time_us};
use super::html::Cell;
use super::joints::joints_svg;
use super::joints_table::{
    ONSET_HEADING, REST_HEADING, WRIST_HEADING, onset_sentence, radians, rest_sentence,
    slaps_sentence, wrist_sentence,
};
use super::{BALL_OVERLAP_MM_MAX, HAND_FIXED_OVERLAP_MM_MAX, Report, joints_file_name};

/// The page's section on figures with joints; empty without scenes.
pub(super) fn section(report: &Report) -> String {
    if report.figures.is_empty() {
        return String::new();
    }
    format!(
        "<section>\n<h2>Figures with joints</h2>\n{}{}{}</section>\n\
         <section>\n<h2>Solver steps and joints over the scenes</h2>\n{}</section>\n",
        work(&report.figures),
        promises(&report.figures),
        sentences(report),
        figures(report)
    )
}

fn work(scenes: &[FigureScene]) -> String {
    let caption = "CPU time of the thread per frame, telling the targets included; steps of the \
                   chains&#8217; solvers. Untouched: frames with steps and without contact.";
    let columns = [
        "Frames",
        "Frame time<br/>median [µs]",
        "p99 [µs]",
        "max [µs]",
        "Contacts<br/>max",
        "Steps<br/>sum",
        "Steps<br/>max",
        "Untouched<br/>(= 0)",
        "Joints adjusted<br/>max",
    ];
    table(caption, &columns, scenes, |scene| {
        let time = &scene.frame_time_us;
        vec![
            Cell::plain(count(scene.frames.into())),
            Cell::plain(time_us(time.median)),
            Cell::plain(time_us(time.p99)),
            Cell::plain(time_us(time.max)),
            Cell::plain(scene.contacts_max.to_string()),
            Cell::plain(count(scene.steps_total)),
            Cell::plain(scene.steps_max.to_string()),
            Cell::judged(scene.steps_untouched.to_string(), scene.steps_untouched > 0),
            Cell::plain(scene.adjusted_max.to_string()),
        ]
    })
}

fn promises(scenes: &[FigureScene]) -> String {
    let caption = "Deepest overlaps as judged by the double-precision reference from the published poses. \
                   Jumps are the largest change of one angle in a frame, published and wanted.";
    let fixed = format!("In fixed<br/>(≤ {HAND_FIXED_OVERLAP_MM_MAX}) [mm]");
    let loose = format!("In loose<br/>(≤ {BALL_OVERLAP_MM_MAX}) [mm]");
    let own = format!("In itself<br/>(≤ {BALL_OVERLAP_MM_MAX}) [mm]");
    let limits = format!("Past limits<br/>(≤ {BEYOND_LIMITS_RAD_MAX:e}) [rad]");
    let columns = [
        &fixed,
        &loose,
        &own,
        &limits,
        "Jump [°]",
        "Wanted [°]",
        "Root off [mm]",
        "State hash",
    ];
    table(caption, &columns, scenes, |scene| {
        vec![
            Cell::limited(scene.overlap_fixed_mm_max, HAND_FIXED_OVERLAP_MM_MAX),
            Cell::limited(scene.overlap_loose_mm_max, BALL_OVERLAP_MM_MAX),
            Cell::limited(scene.overlap_own_mm_max, scene.own_limit_mm()),
            Cell::judged(
                radians(scene.beyond_limits_rad_max),
                is_beyond(scene.beyond_limits_rad_max, BEYOND_LIMITS_RAD_MAX),
            ),
            Cell::plain(format!("{:.2}", scene.jump_deg_max)),
            Cell::plain(format!("{:.2}", scene.wanted_jump_deg_max)),
            Cell::plain(format!("{:.2}", scene.root_off_mm_max)),
            Cell::plain(scene.state_hash.clone()),
        ]
    })
}

/// One `tbody` per figure, whose name spans its rows.
fn table(
    caption: &str,
    columns: &[&str],
    scenes: &[FigureScene],
    cells: impl Fn(&FigureScene) -> Vec<Cell>,
) -> String {
    let columns: String = columns
        .iter()
        .map(|column| format!("<th scope=\"col\">{column}</th>"))
        .collect();
    let mut rows = String::new();
    for group in scenes.chunk_by(|a, b| a.figure == b.figure) {
        rows += "<tbody>\n";
        for (index, scene) in group.iter().enumerate() {
            let figure = if index == 0 {
                let (count, figure) = (group.len(), escaped(&scene.figure));
                format!("<th scope=\"rowgroup\" rowspan=\"{count}\">{figure}</th>")
            } else {
                String::new()
            };
            let name = escaped(&scene.name);
            let cells: String = cells(scene).iter().map(Cell::html).collect();
            rows += &format!("<tr>{figure}<th scope=\"row\">{name}</th>{cells}</tr>\n");
        }
        rows += "</tbody>\n";
    }
    format!(
        "<div class=\"wide\">\n<table class=\"phases\">\n<caption>{caption}</caption>\n<thead>\n<tr>\
         <th class=\"text\" scope=\"col\">Figure</th><th class=\"text\" scope=\"col\">Scene</th>\
         {columns}</tr>\n</thead>\n{rows}</table>\n</div>\n"
    )
}

/// What is to be said of a scene, if anything is.
type Sentence = fn(&FigureScene) -> Option<String>;

fn sentences(report: &Report) -> String {
    let slaps = report.arm_slaps.iter().map(slaps_sentence);
    let slaps: String = slaps
        .map(|text| format!("<p class=\"note\">{}.</p>\n", escaped(&text)))
        .collect();
    let groups: [(&str, Sentence); 3] = [
        (WRIST_HEADING, wrist_sentence),
        (REST_HEADING, rest_sentence),
        (ONSET_HEADING, onset_sentence),
    ];
    let lists = groups.map(|(heading, of)| list(heading, report.figures.iter().filter_map(of)));
    slaps + &lists.concat()
}

fn list(heading: &str, items: impl Iterator<Item = String>) -> String {
    let items: String = items
        .map(|text| format!("<li>{}</li>\n", escaped(&text)))
        .collect();
    if items.is_empty() {
        return items;
    }
    format!("<p class=\"note\">{heading}:</p>\n<ul class=\"note\">\n{items}</ul>\n")
}

/// Scenes whose figure the page shows: of the capsules' the files alone are left.
fn is_drawn(scene: &FigureScene) -> bool {
    !scene.figure.contains("capsules")
}

fn figures(report: &Report) -> String {
    let scenes = report.figures.iter().zip(report.figure_slugs());
    scenes
        .filter(|(scene, _)| is_drawn(scene))
        .map(|(scene, slug)| {
            let file = joints_file_name(&slug);
            let name = escaped(&format!("{}, {}", scene.figure, scene.name));
            format!(
                "<figure id=\"{slug}\">\n<div class=\"wide\">{}</div>\n<figcaption>{name}: \
                 <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
                joints_svg(scene)
            )
        })
        .collect()
}
