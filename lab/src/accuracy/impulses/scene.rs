//! Scenes of simple bodies, told once for all engines, with their masses in f64.

use glam::{DMat3, DQuat, DVec3};

/// What a body looks like; sizes in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A ball of this radius.
    Ball(f64),
    /// A box with these half extents.
    Box([f64; 3]),
    /// A capsule along y: half the length of its straight part, and its radius.
    Capsule(f64, f64),
}

impl Form {
    /// Volume in m3 and principal moments of a body of 1 kg/m3 about its centre, in m5.
    fn moments(self) -> (f64, DVec3) {
        use std::f64::consts::PI;
        match self {
            Self::Ball(radius) => {
                let volume = 4.0 / 3.0 * PI * radius.powi(3);
                (volume, DVec3::splat(0.4 * volume * radius * radius))
            }
            Self::Box(half) => {
                let volume = 8.0 * half[0] * half[1] * half[2];
                let [x, y, z] = half.map(|h| h * h);
                (volume, volume / 3.0 * DVec3::new(y + z, x + z, x + y))
            }
            Self::Capsule(half, radius) => {
                let square = radius * radius;
                let (tube, caps) = (2.0 * PI * square * half, 4.0 / 3.0 * PI * square * radius);
                let along = tube * square / 2.0 + caps * 0.4 * square;
                let across = tube * (square / 4.0 + half * half / 3.0)
                    + caps * (0.4 * square + half * half + 0.75 * half * radius);
                (tube + caps, DVec3::new(across, along, across))
            }
        }
    }

    /// Farthest that the surface is from the centre, in metres.
    pub fn reach_m(self) -> f64 {
        match self {
            Self::Ball(radius) => radius,
            Self::Box(half) => DVec3::from_array(half).length(),
            Self::Capsule(half, radius) => half + radius,
        }
    }
}

/// A body of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// What it looks like.
    pub form: Form,
    /// Its density in kg/m3; none for what is fixed.
    pub density_kg_m3: Option<f64>,
    /// Its centre in metres.
    pub position: DVec3,
    /// Its orientation.
    pub rotation: DQuat,
    /// Velocity at the start, in m/s.
    pub velocity: DVec3,
    /// Angular velocity at the start, in rad/s, in the world.
    pub spin: DVec3,
}

impl Body {
    /// A still body that moves freely.
    pub fn loose(form: Form, density_kg_m3: f64, position: DVec3) -> Self {
        Self {
            form,
            density_kg_m3: Some(density_kg_m3),
            position,
            rotation: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
        }
    }

    /// A body that never moves.
    pub fn fixed(form: Form, position: DVec3) -> Self {
        Self {
            density_kg_m3: None,
            ..Self::loose(form, 1.0, position)
        }
    }

    /// The top of this floor is y = 0; large, yet small enough for f32 to place its top to a nanometre.
    pub fn floor() -> Self {
        Self::fixed(Form::Box([20.0, 0.5, 20.0]), DVec3::new(0.0, -0.5, 0.0))
    }

    /// Mass in kg; zero for what is fixed.
    pub fn mass_kg(&self) -> f64 {
        self.density_kg_m3.unwrap_or(0.0) * self.form.moments().0
    }

    /// Principal moments of inertia in kg m2, along the body's axes.
    pub fn inertia(&self) -> DVec3 {
        self.density_kg_m3.unwrap_or(0.0) * self.form.moments().1
    }

    /// Kinetic energy in J of this body in a state of motion.
    pub fn kinetic_j(&self, state: &BodyState) -> f64 {
        let spin = state.rotation.inverse() * state.spin;
        let turning = (self.inertia() * spin).dot(spin);
        0.5 * (self.mass_kg() * state.velocity.length_squared() + turning)
    }

    /// Angular momentum about the centre in kg m2/s, in the world.
    pub fn angular_momentum(&self, state: &BodyState) -> DVec3 {
        let axes = DMat3::from_quat(state.rotation);
        axes * (self.inertia() * (axes.transpose() * state.spin))
    }
}

/// Bodies, how all of them meet, and what pulls them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Newton's restitution of every contact.
    pub restitution: f64,
    /// Coulomb's coefficient of every contact.
    pub friction: f64,
    /// Acceleration of free fall in m/s2.
    pub gravity: DVec3,
    /// Whether engines that can be told may put bodies to sleep: what creeps slowly is not to be stopped by
    /// it where creeping is measured.
    pub may_sleep: bool,
}

/// Acceleration of free fall of the cases, in m/s2.
pub const GRAVITY: f64 = 9.81;

impl Scene {
    /// Bodies under gravity.
    pub fn new(restitution: f64, friction: f64, bodies: Vec<Body>) -> Self {
        Self {
            bodies,
            restitution,
            friction,
            gravity: DVec3::new(0.0, -GRAVITY, 0.0),
            may_sleep: false,
        }
    }
}

/// Where a body is and how it moves, as an engine published it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass in metres.
    pub position: DVec3,
    /// Orientation.
    pub rotation: DQuat,
    /// Velocity of the centre of mass in m/s.
    pub velocity: DVec3,
    /// Angular velocity in rad/s, in the world.
    pub spin: DVec3,
}

impl BodyState {
    /// Whether no number is infinite or missing.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.rotation.is_finite()
            && self.velocity.is_finite()
            && self.spin.is_finite()
    }
}
