//! The scene of `hosts/c/engine.c` on the kernel's own interface, with the same inputs.

use palpable_kernel::frame::FrameInput;
use palpable_kernel::math::Pose;
use palpable_kernel::memory::BodyId;
use palpable_kernel::state::bodies::{BodyKind, HostedImpulse};
use palpable_kernel::state::materials::Material;
use palpable_kernel::world::{BodyDef, HostedInput, PieceDef, Shape, World};

use super::scene::with_world;

const FRAMES: u32 = 540;
const STEP_S: f32 = 1.0 / 90.0;
const PUSH_FROM: u32 = 60;
const PUSH_TO: u32 = 210;
const LIFT_FROM: u32 = 300;
const LIFT_TO: u32 = 420;
const CARRIED: u32 = 480;
const RADIUS: f32 = 0.05;
const MASS: f32 = 0.4;
const MOMENT: f32 = 0.4 * MASS * RADIUS * RADIUS;
const TABLE_TOP: f32 = 0.8;
const TABLE_END: f32 = 0.1;
const FRICTION: f32 = 0.3;

struct Ball {
    at: [f32; 3],
    velocity: [f32; 3],
    spin: [f32; 3],
}

fn at_most(x: f32, most: f32) -> f32 {
    x.min(most).max(-most)
}

impl Ball {
    fn told_as(&self, body: BodyId) -> HostedInput {
        let [x, y, z] = self.at;
        HostedInput {
            body,
            pose: Pose::at(x, y, z),
            velocity: self.velocity,
            spin: self.spin,
            mass_kg: MASS,
            centre: [0.0; 3],
            moments: [MOMENT; 3],
            axes: [0.0, 0.0, 0.0, 1.0],
        }
    }

    fn touch_ground(&mut self, ground: f32) {
        let (velocity, spin) = (&mut self.velocity, &mut self.spin);
        if self.at[1] - RADIUS > ground || velocity[1] > 0.0 {
            return;
        }
        let mut push = MASS * (0.0 - velocity[1]);
        if velocity[1] < -0.2 {
            push += push * 0.3;
        }
        let part = MASS * 2.0 / 7.0;
        let along_x = at_most((velocity[0] + spin[2] * RADIUS) * part, FRICTION * push);
        let along_z = at_most((velocity[2] - spin[0] * RADIUS) * part, FRICTION * push);
        velocity[0] -= along_x / MASS;
        velocity[1] += push / MASS;
        velocity[2] -= along_z / MASS;
        spin[2] -= along_x * RADIUS / MOMENT;
        spin[0] += along_z * RADIUS / MOMENT;
    }

    fn step(&mut self, felt: &HostedImpulse) {
        let ground = if self.at[0] < TABLE_END {
            TABLE_TOP
        } else {
            0.0
        };
        for axis in 0..3 {
            self.velocity[axis] += felt.impulse_n_s[axis] / MASS;
            self.spin[axis] += felt.angular_n_m_s[axis] / MOMENT;
        }
        self.velocity[1] -= 9.81 * STEP_S;
        self.touch_ground(ground);
        for axis in 0..3 {
            self.at[axis] += self.velocity[axis] * STEP_S;
        }
    }
}

fn share_of(frame: u32, from: u32, to: u32) -> f32 {
    if frame <= from {
        0.0
    } else if frame >= to {
        1.0
    } else {
        (frame - from) as f32 / (to - from) as f32
    }
}

fn pusher_at(frame: u32) -> Pose {
    let gone = share_of(frame, PUSH_FROM, PUSH_TO) - share_of(frame, PUSH_TO, LIFT_FROM);
    Pose::at(-0.25 + 0.4 * gone, TABLE_TOP + RADIUS, 0.0)
}

fn hollow_at(frame: u32) -> Pose {
    let x = 0.2 + 0.15 * share_of(frame, LIFT_TO, CARRIED);
    Pose::at(x, 0.6 + 0.3 * share_of(frame, LIFT_FROM, LIFT_TO), 0.0)
}

fn add_hand(world: &mut World, pose: Pose, boxes: &[([f32; 3], [f32; 3])]) -> BodyId {
    let hand = world
        .add_body(&BodyDef::new(BodyKind::Driven, pose))
        .unwrap();
    for &([x, y, z], half) in boxes {
        let mut piece = PieceDef::new(Shape::Box(half), 0.004);
        piece.material = Material::HUMAN;
        piece.local = Pose::at(x, y, z);
        world.add_piece(hand, &piece).unwrap();
    }
    hand
}

/// The hash after `hosts/c/engine.c`.
pub fn engine() -> u64 {
    with_world(|world| {
        let mut ball = Ball {
            at: [-0.1, TABLE_TOP + RADIUS, 0.0],
            velocity: [0.0; 3],
            spin: [0.0; 3],
        };
        let start = Pose::at(ball.at[0], ball.at[1], ball.at[2]);
        let body = world
            .add_body(&BodyDef::new(BodyKind::Hosted, start))
            .unwrap();
        world
            .add_piece(body, &PieceDef::new(Shape::Point, RADIUS))
            .unwrap();
        let palm = [([0.0; 3], [0.008, 0.04, 0.04])];
        let pusher = add_hand(world, pusher_at(0), &palm);
        let rim = [
            ([0.0, -0.01, 0.0], [0.08, 0.006, 0.08]),
            ([-0.08, 0.03, 0.0], [0.006, 0.03, 0.08]),
            ([0.08, 0.03, 0.0], [0.006, 0.03, 0.08]),
            ([0.0, 0.03, -0.08], [0.08, 0.03, 0.006]),
            ([0.0, 0.03, 0.08], [0.08, 0.03, 0.006]),
        ];
        let hollow = add_hand(world, hollow_at(0), &rim);
        for frame in 0..FRAMES {
            world.set_hosted([ball.told_as(body)]).unwrap();
            world.set_target(pusher, &pusher_at(frame)).unwrap();
            world.set_target(hollow, &hollow_at(frame)).unwrap();
            world.step(&FrameInput::unlimited(STEP_S));
            ball.step(&world.hosted_impulse(body).unwrap());
        }
        world.hash()
    })
}
