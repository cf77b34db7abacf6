//! Materials and how they meet.

use palpable_kernel::state::materials::{Material, Surface};
use palpable_kernel::world::MaterialError;

use crate::arguments::{judge, put};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_SURFACE, PALP_FULL_MATERIALS, PALP_OK, PALP_UNKNOWN_MATERIAL, palp_status,
};
use crate::types::palp_world;

const fn material_status(error: MaterialError) -> palp_status {
    match error {
        MaterialError::Full => PALP_FULL_MATERIALS,
        MaterialError::Unknown => PALP_UNKNOWN_MATERIAL,
        MaterialError::BadSurface => PALP_BAD_SURFACE,
    }
}

/// Adds a material, without friction or restitution against any other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_material_add(
    world: *mut palp_world,
    material: *mut u32,
) -> palp_status {
    guarded(|| {
        judge(material)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let added =
                Block::of(world)?.change(|world| world.add_material().map_err(material_status))?;
            put(material, added.0);
        }
        Ok(PALP_OK)
    })
}

/// Sets how two materials meet, in either order: restitution is speed after an impact over speed
/// before, 0 to 1; friction is Coulomb's coefficient, 0 to 1e6.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_surface_set(
    world: *mut palp_world,
    material_a: u32,
    material_b: u32,
    restitution: f32,
    friction: f32,
) -> palp_status {
    let surface = Surface {
        restitution,
        friction,
    };
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            Block::of(world)?.change(|world| {
                world
                    .set_surface(Material(material_a), Material(material_b), surface)
                    .map_err(material_status)
            })?;
        }
        Ok(PALP_OK)
    })
}
