//! Figures with joints in a terminal.

use super::data::is_beyond;
use super::figures::{
    ArmSlaps, BEYOND_LIMITS_RAD_MAX, FigureScene, FirstContact, WRIST_OFF_MM_MAX,
};
use super::format::{NOTHING, count, length_mm, mean, time_us};
use super::table::{INDENT, aligned, mark, marked, table_with};
use super::{BALL_OVERLAP_MM_MAX, HAND_FIXED_OVERLAP_MM_MAX};

/// Two tables with a row for each scene under its figure, what the solvers did when contact began, how
/// figures came to rest, and the arm's slaps. Empty without scenes.
pub fn tables(scenes: &[FigureScene], slaps: Option<&ArmSlaps>) -> String {
    if scenes.is_empty() {
        return String::new();
    }
    let sections = [
        format!("Figures: frame time and work\n{}", work_table(scenes)),
        format!(
            "Figures: overlap, limits and jumps (! beyond the promised limit)\n{}",
            promise_table(scenes)
        ),
        lines(REST_HEADING, scenes, rest_sentence),
        lines(WRIST_HEADING, scenes, wrist_sentence),
        lines(ONSET_HEADING, scenes, onset_sentence),
        slaps.map(slaps_sentence).unwrap_or_default(),
    ];
    let sections: Vec<String> = sections.into_iter().filter(|s| !s.is_empty()).collect();
    sections.join("\n\n")
}

/// Over what [`rest_sentence`] says.
pub(super) const REST_HEADING: &str = "Targets that are still in contact";

/// Over what [`wrist_sentence`] says.
pub(super) const WRIST_HEADING: &str = "Tracker at the wrist";

/// Over what [`onset_sentence`] says.
pub(super) const ONSET_HEADING: &str = "Mean solver steps a frame in the first 20 frames of contact, \
                                        in the next 100, and in all after the first 20";

fn lines(
    heading: &str,
    scenes: &[FigureScene],
    of: impl Fn(&FigureScene) -> Option<String>,
) -> String {
    let found: Vec<String> = scenes.iter().filter_map(of).collect();
    if found.is_empty() {
        return String::new();
    }
    format!("{heading}\n{INDENT}{}", found.join(&format!("\n{INDENT}")))
}

fn work_table(scenes: &[FigureScene]) -> String {
    let header = [
        "figure and scene",
        "frames",
        "median\nµs",
        "p99\nµs",
        "max\nµs",
        "contacts\nmax",
        "steps\nsum",
        "steps\nmax",
        "untouched\n(= 0)",
        "joints\nadjusted",
    ];
    scene_table(&header, scenes, |scene| {
        let time = &scene.frame_time_us;
        vec![
            scene.frames.to_string(),
            time_us(time.median),
            time_us(time.p99),
            time_us(time.max),
            scene.contacts_max.to_string(),
            count(scene.steps_total),
            scene.steps_max.to_string(),
            mark(scene.steps_untouched.to_string(), scene.steps_untouched > 0),
            scene.adjusted_max.to_string(),
        ]
    })
}

fn promise_table(scenes: &[FigureScene]) -> String {
    let fixed = format!("in fixed\nmm (≤ {HAND_FIXED_OVERLAP_MM_MAX})");
    let loose = format!("in loose\nmm (≤ {BALL_OVERLAP_MM_MAX})");
    let own = format!("own\nmm (≤ {BALL_OVERLAP_MM_MAX})");
    let limits = format!("past limits\nrad (≤ {BEYOND_LIMITS_RAD_MAX:e})");
    let header = [
        "figure and scene",
        &fixed,
        &loose,
        &own,
        &limits,
        "jump\n°",
        "wanted\n°",
        "root off\nmm",
    ];
    scene_table(&header, scenes, |scene| {
        vec![
            marked(scene.overlap_fixed_mm_max, HAND_FIXED_OVERLAP_MM_MAX),
            marked(scene.overlap_loose_mm_max, BALL_OVERLAP_MM_MAX),
            marked(scene.overlap_own_mm_max, scene.own_limit_mm()),
            mark(
                radians(scene.beyond_limits_rad_max),
                is_beyond(scene.beyond_limits_rad_max, BEYOND_LIMITS_RAD_MAX),
            ),
            format!("{:.2}", scene.jump_deg_max),
            format!("{:.2}", scene.wanted_jump_deg_max),
            format!("{:.2}", scene.root_off_mm_max),
        ]
    })
}

/// A small angle; a bare `0` is exactly zero.
pub(super) fn radians(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        format!("{value:.0e}")
    }
}

fn scene_table(
    header: &[&str],
    scenes: &[FigureScene],
    cells: impl Fn(&FigureScene) -> Vec<String>,
) -> String {
    let mut table = table_with(header);
    for group in scenes.chunk_by(|a, b| a.figure == b.figure) {
        table.add_row([&group[0].figure]);
        for scene in group {
            let mut row = vec![format!("{INDENT}{}", scene.name)];
            row.extend(cells(scene));
            let row = row.iter().enumerate();
            table.add_row(row.map(|(column, text)| aligned(column, text)));
        }
    }
    table.trim_fmt()
}

/// How a figure came to rest.
pub(super) fn rest_sentence(scene: &FigureScene) -> Option<String> {
    let rest = scene.rest?;
    let settled = if rest.moving_frames < rest.frames {
        format!("still to the bit after {} of them", rest.moving_frames)
    } else {
        "!not still to the bit at their end".to_owned()
    };
    Some(format!(
        "{}, {}: {} frames from {} on, {settled}",
        scene.figure, scene.name, rest.frames, rest.first_frame
    ))
}

/// How near a tracked wrist stayed.
pub(super) fn wrist_sentence(scene: &FigureScene) -> Option<String> {
    let wrist = scene.wrist?;
    let is_broken = is_beyond(wrist.off_mm_max, WRIST_OFF_MM_MAX);
    Some(format!(
        "{}, {}: {} mm (≤ {WRIST_OFF_MM_MAX}) from the nearest place, arm {} mm from the wall",
        scene.figure,
        scene.name,
        mark(length_mm(wrist.off_mm_max), is_broken),
        length_mm(wrist.gap_mm_max),
    ))
}

/// The effect of the paper's figure 7: whether the solvers do more when contact begins than after.
pub(super) fn onset_sentence(scene: &FigureScene) -> Option<String> {
    let first = scene.first_contacts.first()?;
    let contacts = scene.first_contacts.len();
    let average = |value: fn(&FirstContact) -> f64| {
        let sum: f64 = scene.first_contacts.iter().map(value).sum();
        sum / contacts as f64
    };
    let onset = average(|c| c.steps_onset_mean);
    let sustained = average(|c| c.steps_sustained_mean);
    let after = average(|c| c.steps_after_mean);
    Some(format!(
        "{}, {}: {}, {}, {}: {} ({contacts} from frame {} on)",
        scene.figure,
        scene.name,
        mean(onset),
        mean(sustained),
        mean(after),
        if sustained < onset {
            "falls"
        } else {
            "does not fall"
        },
        first.first_frame
    ))
}

/// What the arm's slaps showed.
pub(super) fn slaps_sentence(slaps: &ArmSlaps) -> String {
    let speeds: Vec<String> = slaps
        .tunnelled_speeds
        .iter()
        .map(|speed| format!("{speed:.1}"))
        .collect();
    let speeds = if speeds.is_empty() {
        String::new()
    } else {
        format!(" (at {} m/s)", speeds.join(", "))
    };
    let time = slaps.frame_time_us.map_or_else(
        || NOTHING.to_owned(),
        |time| {
            format!(
                "{} / {} / {}",
                time_us(time.median),
                time_us(time.p99),
                time_us(time.max)
            )
        },
    );
    format!(
        "{} slaps of the arm at a plate of 20 mm, {:.1} to {:.1} m/s: {}{speeds} went through;\n\
         {INDENT}{} touched it, {} ended behind it, round its edge where none went through;\n\
         {INDENT}overlap at most {} mm, {} mm on the straight way between frames;\n\
         {INDENT}own {} mm ({} swings begin in the body), past limits {} rad;\n\
         {INDENT}frame time median / p99 / max {time} µs",
        slaps.slaps,
        slaps.speed_min,
        slaps.speed_max,
        mark(
            slaps.tunnelled_speeds.len().to_string(),
            !slaps.tunnelled_speeds.is_empty()
        ),
        slaps.touched,
        slaps.behind,
        marked(slaps.overlap_mm_max, HAND_FIXED_OVERLAP_MM_MAX),
        length_mm(slaps.overlap_between_mm_max),
        marked(slaps.overlap_own_mm_max, BALL_OVERLAP_MM_MAX),
        slaps.began_in_itself,
        radians(slaps.beyond_limits_rad_max),
    )
}
