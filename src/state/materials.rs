//! Surfaces: restitution and friction of each pair of materials.

use bytemuck::{Pod, Zeroable};

use crate::memory::columns::columns;

/// A surface. The first three are built in; further ones are added by the host.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Material(pub u32);

impl Material {
    /// Wood.
    pub const WOOD: Self = Self(0);
    /// Skin.
    pub const HUMAN: Self = Self(1);
    /// Metal.
    pub const METAL: Self = Self(2);
}

/// Materials that every world has.
pub const BUILT_IN_MATERIALS: u32 = 3;

/// How two surfaces meet.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Surface {
    /// Speed after an impact over speed before, 0 to 1.
    pub restitution: f32,
    /// Coulomb's coefficient, 0 to [`crate::limits::FRICTION_MAX`].
    pub friction: f32,
}

/// The paper's table (Schmidl and Lin 2004, section 6): rows and columns wood, human, metal.
pub(crate) const BUILT_IN: [[Surface; 3]; 3] = [
    [surface(0.3, 0.3), surface(0.2, 0.2), surface(0.2, 0.1)],
    [surface(0.2, 0.2), surface(0.1, 0.1), surface(0.2, 0.1)],
    [surface(0.2, 0.1), surface(0.2, 0.1), surface(0.3, 0.3)],
];

const fn surface(restitution: f32, friction: f32) -> Surface {
    Surface {
        restitution,
        friction,
    }
}

columns! {
    pub(crate) struct Materials(capacities) {
        /// Row by row, one entry for every ordered pair; both orders are kept equal.
        surfaces: [Surface; (capacities.materials + BUILT_IN_MATERIALS)
            * (capacities.materials + BUILT_IN_MATERIALS)],
    }
}

impl Materials<'_> {
    /// Writes the built-in pairs; `stride` is the number of materials there is room for.
    pub(crate) fn fill_built_in(&mut self, stride: usize) {
        for (row, columns) in BUILT_IN.iter().enumerate() {
            for (column, surface) in columns.iter().enumerate() {
                self.surfaces[row * stride + column] = *surface;
            }
        }
    }

    /// How materials `a` and `b`, both in use, meet.
    pub(crate) fn pair(&self, stride: usize, a: u32, b: u32) -> Surface {
        self.surfaces[a as usize * stride + b as usize]
    }

    /// Sets how `a` and `b`, both in use, meet.
    pub(crate) fn set_pair(&mut self, stride: usize, a: u32, b: u32, surface: Surface) {
        self.surfaces[a as usize * stride + b as usize] = surface;
        self.surfaces[b as usize * stride + a as usize] = surface;
    }
}
