//! Snapshots and blocks that are not as they were.

use palpable::frame::FrameInput;
use palpable::memory::{Capacities, HEADER_BYTES};
use palpable::world::World;

use crate::cast::Cast;
use crate::draw::Draw;
use crate::invariants::{Broken, Checker};
use crate::memory::Block;
use crate::scene::{Style, build};

/// Damages a world's snapshot and its block's head by bits, bytes and length, and loads and attaches what
/// comes of it.
///
/// # Errors
/// When damage was taken for sound, or a refused snapshot changed the world.
pub fn damage(draw: &mut impl Draw) -> Result<(), Broken> {
    let style = Style::draw(draw);
    let capacities = style.capacities(draw);
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).expect("a block that fits");
    let mut cast = Cast::default();
    build(draw, &style, &mut world, &mut cast);
    let input = FrameInput::unlimited(1.0 / 90.0);
    world.step(&input);
    let mut snapshot = vec![0; world.snapshot_bytes()];
    let saved = world.save(&mut snapshot);
    saved.map_err(|error| Broken::new("a snapshot was not taken", error))?;
    world.step(&input);
    let sound = snapshot.clone();
    spoil(draw, &mut snapshot);
    load(&mut world, &cast, &snapshot, snapshot.starts_with(&sound))?;
    attach(draw, &mut block, &capacities)
}

/// A snapshot that is not whole is refused and changes nothing; a whole one steps on.
fn load(world: &mut World, cast: &Cast, snapshot: &[u8], whole: bool) -> Result<(), Broken> {
    let before = world.hash();
    let loaded = world.load(snapshot);
    if loaded.is_ok() != whole {
        return Err(Broken::new("a snapshot was judged wrongly", loaded));
    }
    if loaded.is_err() && world.hash() != before {
        return Err(Broken::new("a refused snapshot changed the world", loaded));
    }
    let input = FrameInput::unlimited(1.0 / 90.0);
    let frame = world.step(&input).frame;
    let mut checker = Checker::default();
    checker.start_from(world, cast, frame);
    checker.before(world, cast, &input);
    let report = world.step(&input);
    checker.after(world, cast, &input, &report)
}

/// A block whose head is not whole is refused.
fn attach(draw: &mut impl Draw, block: &mut Block, capacities: &Capacities) -> Result<(), Broken> {
    let sound = block.clone().bytes()[..HEADER_BYTES].to_vec();
    let mut head = sound.clone();
    spoil(draw, &mut head);
    let length = head.len().min(HEADER_BYTES);
    block.bytes()[..length].copy_from_slice(&head[..length]);
    let whole = block.bytes()[..HEADER_BYTES] == sound;
    let end = if draw.once_in(4) {
        draw.word() as usize % capacities.bytes()
    } else {
        capacities.bytes()
    };
    let fits = end == capacities.bytes();
    let taken = World::attach(&mut block.bytes()[..end]);
    match taken {
        Ok(_) if !(whole && fits) => Err(Broken::new("a damaged block was taken", end)),
        Err(error) if whole && fits => Err(Broken::new("a world was not taken up", error)),
        Ok(mut world) => {
            world.step(&FrameInput::unlimited(1.0 / 90.0));
            Ok(())
        }
        Err(_) => Ok(()),
    }
}

/// Flips bits, writes bytes, moves or cuts or lengthens; rarely nothing.
fn spoil(draw: &mut impl Draw, bytes: &mut Vec<u8>) {
    for _ in 0..draw.below(4) {
        let Some(last) = bytes.len().checked_sub(1) else {
            return;
        };
        let at = draw.word() as usize % (last + 1);
        match draw.below(6) {
            0 | 1 => bytes[at] ^= 1 << draw.below(8),
            2 => bytes[at] = draw.byte(),
            3 => bytes.truncate(at),
            4 => bytes.push(draw.byte()),
            _ => {
                let end = (at + 1 + draw.below(64) as usize).min(bytes.len());
                bytes[at..end].fill(draw.byte());
            }
        }
    }
}
