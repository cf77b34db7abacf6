//! Adding, removing and reading pieces.

use palpable_kernel::limits::PIECE_VERTICES_MAX;
use palpable_kernel::state::materials::Material;
use palpable_kernel::state::pieces::Groups;
use palpable_kernel::world::{AddPieceError, PieceDef, Shape};

use crate::arguments::{judge, judge_optional, put, versioned};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_ENUM, PALP_BAD_NUMBER, PALP_BAD_POSE, PALP_BAD_STRIDE, PALP_DEGENERATE,
    PALP_FULL_PIECES, PALP_FULL_VERTICES, PALP_NOT_FINITE, PALP_OK, PALP_STALE_BODY,
    PALP_STALE_CHAIN, PALP_STALE_PIECE, PALP_TOO_FEW_POINTS, PALP_TOO_LARGE, PALP_TOO_MANY_POINTS,
    PALP_UNKNOWN_JOINT, PALP_UNKNOWN_MATERIAL, palp_status,
};
use crate::types::{
    PALP_SHAPE_BOX, PALP_SHAPE_HULL, PALP_SHAPE_POINT, PALP_SHAPE_SEGMENT, palp_body_id,
    palp_piece_def, palp_piece_id, palp_pose, palp_world,
};

pub(crate) const fn add_status(error: AddPieceError) -> palp_status {
    match error {
        AddPieceError::StaleBody => PALP_STALE_BODY,
        AddPieceError::StaleChain => PALP_STALE_CHAIN,
        AddPieceError::UnknownHinge => PALP_UNKNOWN_JOINT,
        AddPieceError::FullPieces => PALP_FULL_PIECES,
        AddPieceError::FullVertices => PALP_FULL_VERTICES,
        AddPieceError::TooFewPoints => PALP_TOO_FEW_POINTS,
        AddPieceError::TooManyPoints => PALP_TOO_MANY_POINTS,
        AddPieceError::NotFinite => PALP_NOT_FINITE,
        AddPieceError::TooLarge => PALP_TOO_LARGE,
        AddPieceError::Degenerate => PALP_DEGENERATE,
        AddPieceError::BadNumber => PALP_BAD_NUMBER,
        AddPieceError::BadPose => PALP_BAD_POSE,
        AddPieceError::UnknownMaterial => PALP_UNKNOWN_MATERIAL,
    }
}

const FLOAT: u32 = size_of::<f32>() as u32;
const POINT: u32 = 3 * FLOAT;

/// A hull's points, copied next to each other.
struct Points {
    list: [[f32; 3]; PIECE_VERTICES_MAX],
    count: usize,
}

impl Points {
    /// Gathers the points of a definition.
    ///
    /// # Safety
    /// The points are readable: `point_count` of them, `point_stride` bytes apart.
    unsafe fn gather(def: &palp_piece_def) -> Result<Self, palp_status> {
        let stride = if def.point_stride == 0 {
            POINT
        } else {
            def.point_stride
        };
        if stride < POINT || !stride.is_multiple_of(FLOAT) {
            return Err(PALP_BAD_STRIDE);
        }
        let count = def.point_count as usize;
        if count > PIECE_VERTICES_MAX {
            return Err(PALP_TOO_MANY_POINTS);
        }
        let mut list = [[0.0; 3]; PIECE_VERTICES_MAX];
        if count > 0 {
            judge(def.points)?;
        }
        for (index, point) in list[..count].iter_mut().enumerate() {
            // SAFETY: readable by contract, aligned because the first is and the stride is.
            *point = unsafe {
                def.points
                    .byte_add(index * stride as usize)
                    .cast::<[f32; 3]>()
                    .read()
            };
        }
        Ok(Self { list, count })
    }
}

/// The core that a definition describes; `points` are those of a hull.
fn shape<'a>(def: &palp_piece_def, points: &'a Option<Points>) -> Result<Shape<'a>, palp_status> {
    Ok(match (def.shape, points) {
        (PALP_SHAPE_POINT, _) => Shape::Point,
        (PALP_SHAPE_SEGMENT, _) => Shape::Segment(def.a.to_array(), def.b.to_array()),
        (PALP_SHAPE_BOX, _) => Shape::Box(def.a.to_array()),
        (PALP_SHAPE_HULL, Some(points)) => Shape::Hull(&points.list[..points.count]),
        _ => return Err(PALP_BAD_ENUM),
    })
}

fn piece_def<'a>(def: &palp_piece_def, shape: Shape<'a>) -> PieceDef<'a> {
    PieceDef {
        shape,
        radius_m: def.radius_m,
        local: def.local_pose.to_kernel(),
        material: Material(def.material),
        density_kg_m3: def.density_kg_m3,
    }
}

/// Reads a definition and lends it to a call, a hull's points gathered on the stack.
///
/// # Safety
/// The header's rules for pointers.
pub(crate) unsafe fn with_piece<R>(
    def: *const palp_piece_def,
    call: impl FnOnce(&PieceDef) -> Result<R, palp_status>,
) -> Result<R, palp_status> {
    // SAFETY: the caller vouches.
    let def = unsafe { versioned(def) }?;
    let points = match def.shape {
        // SAFETY: the caller vouches.
        PALP_SHAPE_HULL => Some(unsafe { Points::gather(&def) }?),
        _ => None,
    };
    call(&piece_def(&def, shape(&def, &points)?))
}

/// Adds a piece to a body, behind those it has. Builds its hull on the stack.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_piece_add(
    world: *mut palp_world,
    body: palp_body_id,
    def: *const palp_piece_def,
    piece: *mut palp_piece_id,
) -> palp_status {
    guarded(|| {
        judge(piece)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let id = with_piece(def, |def| {
                Block::of(world)?
                    .change(|world| world.add_piece(body.to_kernel(), def).map_err(add_status))
            })?;
            put(piece, palp_piece_id::new(id));
        }
        Ok(PALP_OK)
    })
}

/// Removes a piece. Costs one pass over all pieces' vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_piece_remove(
    world: *mut palp_world,
    piece: palp_piece_id,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            Block::of(world)?.change(|world| {
                world
                    .remove_piece(piece.to_kernel())
                    .map_err(|_| PALP_STALE_PIECE)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// Says which driven pieces pass through each other: of pieces of two driven bodies, or of two chains of
/// one, those pass of which one belongs to a group, a bit of `member_of`, that the other passes through,
/// a bit of `passes`. Fixed and dynamic bodies stop every piece. A new piece has zero for both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_piece_set_groups(
    world: *mut palp_world,
    piece: palp_piece_id,
    member_of: u32,
    passes: u32,
) -> palp_status {
    guarded(|| {
        let groups = Groups { member_of, passes };
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            Block::of(world)?.change(|world| {
                world
                    .set_groups(piece.to_kernel(), groups)
                    .map_err(|_| PALP_STALE_PIECE)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// The published pose of a piece in the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_piece_pose(
    world: *const palp_world,
    piece: palp_piece_id,
    pose: *mut palp_pose,
) -> palp_status {
    guarded(|| {
        judge(pose)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let found = Block::of(world)?.read(|world| {
                world
                    .piece_pose(piece.to_kernel())
                    .map_err(|_| PALP_STALE_PIECE)
            })?;
            put(pose, palp_pose::new(&found));
        }
        Ok(PALP_OK)
    })
}

/// The published poses of all piece slots in the world: entry `index1 - 1` is that of a piece's id;
/// slots not in use hold anything. The array lies in the world's block and is good until the next call
/// that changes the world. `count` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_piece_poses(
    world: *const palp_world,
    poses: *mut *const palp_pose,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        judge(poses)?;
        judge_optional(count)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let (first, number) = block.read(|world| {
                let column = world.piece_poses();
                Ok((block.column(column), column.len() as u32))
            })?;
            put(poses, first);
            put(count, number);
        }
        Ok(PALP_OK)
    })
}
