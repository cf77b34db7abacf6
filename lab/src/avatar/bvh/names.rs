//! Joints by the names that BVH files give them.

/// A joint that the retargeting needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Neck,
    Head,
    Arm,
    ForeArm,
    Hand,
    Thigh,
    Shank,
    Foot,
    Toe,
}

/// Names without side, in lower case, letters only; the first that is found counts.
const NAMES: [(Role, &[&str]); 9] = [
    (Role::Neck, &["neck", "neck1"]),
    (Role::Head, &["head", "face"]),
    (
        Role::Arm,
        &["arm", "upperarm", "uparm", "shoulder", "shldr"],
    ),
    (Role::ForeArm, &["forearm", "lowerarm", "lowarm", "elbow"]),
    (Role::Hand, &["hand", "wrist"]),
    (Role::Thigh, &["upleg", "thigh", "upperleg", "hip"]),
    (
        Role::Shank,
        &["leg", "shin", "lowerleg", "lowleg", "knee", "calf"],
    ),
    (Role::Foot, &["foot", "ankle"]),
    (Role::Toe, &["toe", "toebase"]),
];

/// `LeftArm`, `upper_arm.L`, `mixamorig:LeftArm` and `lArm` become `arm` with side `l`; joints in the
/// middle have no side.
pub(super) fn plain(name: &str) -> (String, Option<char>) {
    let name = name.rsplit(':').next().unwrap_or(name);
    let starts_small = name.chars().next().is_some_and(char::is_lowercase);
    let second_is_large = name.chars().nth(1).is_some_and(char::is_uppercase);
    let lower = name.to_lowercase();
    let letters =
        |text: &str| -> String { text.chars().filter(char::is_ascii_alphanumeric).collect() };
    for (word, side) in [("left", 'l'), ("right", 'r')] {
        if let Some(rest) = lower
            .strip_prefix(word)
            .or_else(|| lower.strip_suffix(word))
        {
            return (letters(rest), Some(side));
        }
    }
    for side in ['l', 'r'] {
        for separator in ['.', '_'] {
            let ends = [separator, side].iter().collect::<String>();
            let begins = [side, separator].iter().collect::<String>();
            let rest = lower
                .strip_suffix(&ends)
                .or_else(|| lower.strip_prefix(&begins));
            if let Some(rest) = rest {
                return (letters(rest), Some(side));
            }
        }
        if starts_small && second_is_large && lower.starts_with(side) {
            return (letters(&lower[1..]), Some(side));
        }
    }
    (letters(&lower), None)
}

/// The joint of a role on a side, by its index among names.
pub(super) fn find(names: &[String], role: Role, side: Option<char>) -> Option<usize> {
    let (_, known) = NAMES.iter().find(|(known, _)| *known == role)?;
    known.iter().find_map(|wanted| {
        names.iter().position(|name| {
            let (word, of) = plain(name);
            word == *wanted && of == side
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_several_exporters_are_understood() {
        for (name, word, side) in [
            ("LeftArm", "arm", Some('l')),
            ("mixamorig:RightForeArm", "forearm", Some('r')),
            ("upper_arm.L", "upperarm", Some('l')),
            ("lShldr", "shldr", Some('l')),
            ("Hips", "hips", None),
            ("neck", "neck", None),
            ("R_Hand", "hand", Some('r')),
        ] {
            assert_eq!(plain(name), (word.to_owned(), side), "{name}");
        }
    }

    #[test]
    fn an_arm_is_preferred_to_a_shoulder() {
        let names = ["LeftShoulder", "LeftArm"].map(String::from);
        assert_eq!(find(&names, Role::Arm, Some('l')), Some(1));
        assert_eq!(find(&names[..1], Role::Arm, Some('l')), Some(0));
        assert_eq!(find(&names, Role::Arm, Some('r')), None);
    }
}
