//! Colours of the figures: each has a light and a dark value, and the light values are all
//! different because the style sheet finds an element's role by its light colour.

use plotters::style::RGBColor;

#[derive(Clone, Copy)]
pub(super) struct Role {
    light: u32,
    dark: u32,
}

pub(super) const PAPER: Role = Role {
    light: 0xFFFFFF,
    dark: 0x16191D,
};
pub(super) const INK: Role = Role {
    light: 0x22272E,
    dark: 0xE4E7EB,
};
pub(super) const QUIET_INK: Role = Role {
    light: 0x5C6670,
    dark: 0xA3ACB6,
};
pub(super) const FRAME_LINE: Role = Role {
    light: 0x8A949E,
    dark: 0x6B7580,
};
pub(super) const GRID: Role = Role {
    light: 0xD3D8DD,
    dark: 0x3A424A,
};
pub(super) const FINE_GRID: Role = Role {
    light: 0xE4E7EA,
    dark: 0x2C3238,
};
pub(super) const EACH_FRAME: Role = Role {
    light: 0x8FABC4,
    dark: 0x4F718F,
};
pub(super) const WINDOW_MEDIAN: Role = Role {
    light: 0x1F4E79,
    dark: 0x9CC8F0,
};
pub(super) const SLOWEST: Role = Role {
    light: 0xB0413A,
    dark: 0xF08A80,
};
pub(super) const CONTACTS: Role = Role {
    light: 0x2B7A6B,
    dark: 0x62C2AF,
};
pub(super) const IMPULSES: Role = Role {
    light: 0xC0782A,
    dark: 0xE3A55F,
};

pub(super) const STEPS: Role = Role {
    light: 0x6A4C93,
    dark: 0xC0A2E8,
};
pub(super) const ADJUSTED: Role = Role {
    light: 0x8A5A1F,
    dark: 0xD9AC72,
};

/// Backgrounds of phases, in turn.
pub(super) const BANDS: [Role; 4] = [
    Role {
        light: 0xF1F3F5,
        dark: 0x1E2226,
    },
    Role {
        light: 0xE9F1EC,
        dark: 0x1B2721,
    },
    Role {
        light: 0xF2F0E4,
        dark: 0x28261B,
    },
    Role {
        light: 0xF4EBE7,
        dark: 0x2B211D,
    },
];

const ROLES: [Role; 13] = [
    PAPER,
    INK,
    QUIET_INK,
    FRAME_LINE,
    GRID,
    FINE_GRID,
    EACH_FRAME,
    WINDOW_MEDIAN,
    SLOWEST,
    CONTACTS,
    IMPULSES,
    STEPS,
    ADJUSTED,
];

impl Role {
    pub(super) fn colour(self) -> RGBColor {
        let [_, red, green, blue] = self.light.to_be_bytes();
        RGBColor(red, green, blue)
    }

    fn dark_rules(self) -> String {
        let Self { light, dark } = self;
        format!(
            "[fill=\"#{light:06X}\"]{{fill:#{dark:06X}}}[stroke=\"#{light:06X}\"]{{stroke:#{dark:06X}}}"
        )
    }
}

/// Rules that turn the light colours into the dark ones where the reader prefers a dark scheme.
pub(super) fn style_sheet() -> String {
    let dark: String = ROLES
        .into_iter()
        .chain(BANDS)
        .map(Role::dark_rules)
        .collect();
    format!("polyline{{stroke-linejoin:round}}@media (prefers-color-scheme:dark){{{dark}}}")
}

#[cfg(test)]
mod tests {
    use super::{BANDS, ROLES};

    #[test]
    fn light_colours_are_all_different() {
        let mut light: Vec<u32> = ROLES
            .into_iter()
            .chain(BANDS)
            .map(|role| role.light)
            .collect();
        light.sort_unstable();
        light.dedup();
        assert_eq!(light.len(), ROLES.len() + BANDS.len());
    }
}
