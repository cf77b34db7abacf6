//! A hand with bending fingers: on a table, and closing around things. Each finger stops on its own.

use glam::{Quat, Vec3};
use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;

use super::judge::{at, solids_of};
use super::play::{Scene, Thing};
use super::scenes::corners;
use super::wrist::ease;
use super::{Figure, refused};
use crate::avatar::Target;
use crate::avatar::motions::RATE_HZ;
use crate::hand::{ArticulatedHand, FingerAngles, Hand, HandPose};
use crate::hand_scene::SceneError;
use crate::reference::{Placed, Solid, signed_distance};

/// How a hand's fingers answer: they may touch each other and the palm.
pub const HAND_OPTIONS: ChainOptions = ChainOptions::DEFAULT;

/// How far the hand is pressed into the table, in metres.
const PRESS_M: f32 = 0.1;

/// How far it slides, in metres.
const SLIDE_M: f32 = 0.3;

/// Room between the hand and what it will meet, in metres.
const ROOM_M: f64 = 0.001;

/// Radius of the ball, in metres.
pub const BALL_RADIUS_M: f32 = 0.035;

/// Height of the table's top, in metres.
const TABLE_M: f32 = 0.75;

/// Where the wrist is when the hand closes around something fixed.
const WRIST: Vec3 = Vec3::new(0.0, 1.2, 0.0);

/// A hand, its figure and the postures that the scenes use.
pub struct Grasps {
    figure: Figure,
    fingers: ArticulatedHand,
    flat: FingerAngles,
    relaxed: FingerAngles,
    fist: FingerAngles,
}

impl Grasps {
    /// From the lab's hand.
    #[must_use]
    pub fn new(hand: &Hand) -> Self {
        let fingers = ArticulatedHand::new(hand);
        let fit = |pose| fingers.fit(&hand.joints(pose, pose, 0.0)).angles;
        Self {
            figure: Figure::of_hand(hand, &fingers),
            flat: fit(HandPose::Flat),
            relaxed: fit(HandPose::Relaxed),
            fist: fingers.fist(hand),
            fingers,
        }
    }

    /// All scenes.
    ///
    /// # Errors
    /// [`SceneError`] names the piece that the reference refused.
    pub fn scenes(&self) -> Result<Vec<Scene<'_>>, SceneError> {
        Ok(vec![
            self.press("flat on a table", &self.flat),
            self.press("relaxed on a table", &self.relaxed),
            self.close_on_ball()?,
            self.close_on_handle()?,
            self.close_on_loose_ball()?,
        ])
    }

    /// Pressed 100 mm into a table, slid 0.3 m, held still, and lifted.
    fn press(&self, name: &str, angles: &FingerAngles) -> Scene<'_> {
        let low = self.lowest(angles);
        let start = Vec3::new(-0.5 * SLIDE_M, TABLE_M + 0.05 - low, 0.0);
        let target = target(start, angles);
        Scene {
            name: name.to_owned(),
            figure: &self.figure,
            things: vec![table(TABLE_M)],
            options: HAND_OPTIONS,
            frames: 540,
            rate_hz: RATE_HZ,
            target: Box::new(move |frame| {
                let down = ease(frame, 0, 120) - ease(frame, 440, 100);
                let aside = ease(frame, 140, 180);
                let by = Vec3::new(SLIDE_M * aside, -(0.05 + PRESS_M) * down, 0.0);
                Target {
                    root: Pose::new(Quat::IDENTITY, start + by),
                    angles: target.angles.clone(),
                }
            }),
            tip: None,
        }
    }

    fn close_on_ball(&self) -> Result<Scene<'_>, SceneError> {
        let place = self.seat(&[(Pose::IDENTITY, vec![[0.0; 3]], BALL_RADIUS_M)])?;
        Ok(self.closing(
            "closing on a fixed ball",
            WRIST,
            vec![ball(place, BodyKind::Fixed)],
        ))
    }

    fn close_on_handle(&self) -> Result<Scene<'_>, SceneError> {
        let pieces = mug();
        let place = self.seat(&pieces)?;
        let mug = Thing {
            name: "mug".to_owned(),
            kind: BodyKind::Fixed,
            pose: place,
            pieces,
        };
        Ok(self.closing("closing on a mug's handle", WRIST, vec![mug]))
    }

    fn close_on_loose_ball(&self) -> Result<Scene<'_>, SceneError> {
        let place = self.seat(&[(Pose::IDENTITY, vec![[0.0; 3]], BALL_RADIUS_M)])?;
        let top = place.translation().y - BALL_RADIUS_M;
        let things = vec![table(top), ball(place, BodyKind::Dynamic)];
        Ok(self.closing("closing on a loose ball", WRIST, things))
    }

    /// Closes from flat to fist, holds and opens.
    fn closing(&self, name: &str, wrist: Vec3, things: Vec<Thing>) -> Scene<'_> {
        Scene {
            name: name.to_owned(),
            figure: &self.figure,
            things,
            options: HAND_OPTIONS,
            frames: 420,
            rate_hz: RATE_HZ,
            target: Box::new(move |frame| {
                let weight = ease(frame, 20, 120) - ease(frame, 260, 120);
                target(wrist, &self.between(weight))
            }),
            tip: None,
        }
    }

    /// Between flat and fist.
    fn between(&self, weight: f32) -> FingerAngles {
        std::array::from_fn(|finger| {
            let pairs = self.flat[finger].iter().zip(&self.fist[finger]);
            pairs
                .map(|(flat, fist)| flat + weight * (fist - flat))
                .collect()
        })
    }

    /// Lowest point of the hand at the origin.
    fn lowest(&self, angles: &FingerAngles) -> f32 {
        let poses = self.fingers.part_poses(&Pose::IDENTITY, angles);
        let points = self
            .figure
            .pieces
            .iter()
            .zip(&poses)
            .flat_map(|(piece, pose)| {
                let all = piece.points.iter();
                all.map(|&point| pose.point(point.into()).y)
            });
        points.fold(f32::INFINITY, f32::min)
    }

    /// Where something lies under the flat hand's knuckles, 1 mm away: raised from below.
    fn seat(&self, pieces: &[(Pose, Vec<[f32; 3]>, f32)]) -> Result<Pose, SceneError> {
        let poses = self
            .fingers
            .part_poses(&Pose::at(WRIST.x, WRIST.y, WRIST.z), &self.flat);
        let hand = solids_of(&self.figure)?;
        let hand: Vec<Placed> = hand.iter().zip(&poses).map(at).collect();
        let parts = pieces.iter().map(|(_, points, radius_m)| {
            Solid::from_f32(points, *radius_m).map_err(|why| refused("seat", why))
        });
        let parts: Vec<Solid> = parts.collect::<Result<_, _>>()?;
        let under = self.under_knuckles();
        let place = |below: f32| Pose::at(under.x, under.y - below, under.z);
        let gap_m = |below: f32| {
            let mut least = f64::INFINITY;
            for (part, (local, ..)) in parts.iter().zip(pieces) {
                let pose = place(below).then(local);
                let part = at((part, &pose));
                for piece in &hand {
                    least = least.min(signed_distance(piece, &part).value);
                }
            }
            least
        };
        let (mut near, mut far) = (0.0, 0.5);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            if gap_m(middle) < ROOM_M {
                near = middle;
            } else {
                far = middle;
            }
        }
        Ok(place(far))
    }

    /// Between the knuckle and the middle joint of the middle finger, in the world.
    fn under_knuckles(&self) -> Vec3 {
        let wrist = Pose::at(WRIST.x, WRIST.y, WRIST.z);
        let links = self.fingers.postures(&wrist, &self.flat);
        let [knuckle, middle, _] = self.fingers.fingers[2].bones;
        let at = |hinge: usize| links[2][hinge].link.translation();
        0.5 * (at(knuckle) + at(middle))
    }
}

fn target(wrist: Vec3, angles: &FingerAngles) -> Target {
    Target {
        root: Pose::new(Quat::IDENTITY, wrist),
        angles: angles.to_vec(),
    }
}

fn table(top_m: f32) -> Thing {
    Thing {
        name: "table".to_owned(),
        kind: BodyKind::Fixed,
        pose: Pose::at(0.0, top_m - 0.1, 0.0),
        pieces: vec![(Pose::IDENTITY, corners([0.8, 0.1, 0.6]), 0.0)],
    }
}

fn ball(pose: Pose, kind: BodyKind) -> Thing {
    Thing {
        name: "ball".to_owned(),
        kind,
        pose,
        pieces: vec![(Pose::IDENTITY, vec![[0.0; 3]], BALL_RADIUS_M)],
    }
}

/// Capsules of the handle.
const HANDLE_PIECES: usize = 10;

/// Half width and height of the handle's middle line, and its radius, in metres.
const HANDLE_M: [f32; 3] = [0.05, 0.045, 0.007];

/// Half height and radius of the mug, in metres.
const MUG_M: [f32; 2] = [0.055, 0.04];

/// A mug that lies along X with its handle up. The origin is the handle's top.
fn mug() -> Vec<(Pose, Vec<[f32; 3]>, f32)> {
    let [half, height, radius] = HANDLE_M;
    let on = |index: usize| {
        let angle = std::f32::consts::PI * index as f32 / HANDLE_PIECES as f32;
        // Steeper at the sides than an ellipse, as handles are.
        let bulge = |x: f32| x.signum() * x.abs().sqrt();
        [
            half * bulge(angle.cos()),
            height * (bulge(angle.sin()) - 1.0),
            0.0,
        ]
    };
    let mut pieces: Vec<_> = (0..HANDLE_PIECES)
        .map(|index| (Pose::IDENTITY, vec![on(index), on(index + 1)], radius))
        .collect();
    let [half, radius] = MUG_M;
    let ring = (0..16).flat_map(|side| {
        let (sin, cos) = (std::f32::consts::TAU * side as f32 / 16.0).sin_cos();
        [-half, half].map(|x| [x, radius * sin, radius * cos])
    });
    // The handle's ends are on the mug's surface.
    pieces.push((Pose::at(0.0, -height - radius, 0.0), ring.collect(), 0.0));
    pieces
}
