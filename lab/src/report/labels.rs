//! Where the phases' labels go: in rows above the plot, so that they cover no data, and never over
//! one another.

/// Text widths are bounded from above, since the reader's font is not known: no sans-serif in
/// common use averages more than this many ems per character.
const EMS_PER_CHARACTER: f64 = 0.64;
const EMS_PER_BOLD_CHARACTER: f64 = 0.70;

/// Least horizontal distance between labels, in pixels.
const GAP_PX: f64 = 10.0;

/// Distance from a leader to the text that it carries, in pixels.
pub(super) const LEADER_GAP_PX: f64 = 5.0;

/// Upper bound of a text's width, in the unit of the font size.
pub(super) fn text_width(text: &str, font_size: f64, is_bold: bool) -> f64 {
    let ems = if is_bold {
        EMS_PER_BOLD_CHARACTER
    } else {
        EMS_PER_CHARACTER
    };
    text.chars().count() as f64 * ems * font_size
}

/// `text`, or its beginning and an ellipsis if it has more than `characters_max` characters.
pub(super) fn shortened(text: &str, characters_max: usize) -> String {
    if text.chars().count() <= characters_max {
        return text.to_owned();
    }
    text.chars().take(characters_max - 1).chain(['…']).collect()
}

/// A label that wants to stand over a stretch of the x axis; all in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    pub(super) band_left: f64,
    pub(super) band_right: f64,
    pub(super) width: f64,
}

impl Wish {
    fn centre(&self) -> f64 {
        0.5 * (self.band_left + self.band_right)
    }

    fn fits(&self) -> bool {
        self.width + GAP_PX <= self.band_right - self.band_left
    }
}

/// Rows of labels, row 0 next to the plot.
#[derive(Debug, PartialEq)]
pub(super) enum Layout {
    /// Every label fits over its band: one row, each label centred.
    Centred,
    /// Each label is a flag: it stands right of a leader that goes down from its row to the centre
    /// of its band.
    Flags(Vec<usize>),
}

impl Layout {
    /// Places labels whose bands come in ascending order.
    ///
    /// A flag's text must not be crossed by the leader of a later flag, so it stands in a higher
    /// row than every later flag that starts before the text ends.
    pub(super) fn new(wishes: &[Wish]) -> Self {
        if wishes.iter().all(Wish::fits) {
            return Self::Centred;
        }
        let mut rows = vec![0; wishes.len()];
        for index in (0..wishes.len()).rev() {
            let text_right = wishes[index].centre() + LEADER_GAP_PX + wishes[index].width + GAP_PX;
            let later = (index + 1)..wishes.len();
            let crossing = later.filter(|&other| wishes[other].centre() < text_right);
            rows[index] = crossing.map(|other| rows[other] + 1).max().unwrap_or(0);
        }
        Self::Flags(rows)
    }

    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Centred => 1,
            Self::Flags(rows) => rows.iter().max().map_or(1, |row| row + 1),
        }
    }
}

/// How far flags would reach beyond `right`, in pixels.
pub(super) fn overhang(wishes: &[Wish], right: f64) -> f64 {
    if wishes.iter().all(Wish::fits) {
        return 0.0;
    }
    let ends = wishes
        .iter()
        .map(|wish| wish.centre() + LEADER_GAP_PX + wish.width);
    ends.fold(0.0, |most, end| f64::max(most, end - right))
}
