//! The paper's scene: an art gallery of two rooms, fixed, 476 triangles; and the ball.
//!
//! Schmidl and Lin 2004, section 7. The paper gives the counts and no plan, so the plan is ours: floor
//! at y = 0, the door between the rooms at x = 2, the table in the first room around the origin.

use glam::Vec3;
use palpable::math::{Pose, quat_from_rotation_vector};

/// A convex piece of the scenery, in its object's frame, in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneryPiece {
    /// Corners; the piece is their hull.
    pub points: Vec<[f32; 3]>,
    /// Half extents when the piece is a box.
    pub half_extents: Option<[f32; 3]>,
    /// Pose in the object's frame.
    pub local: Pose,
}

/// A fixed object: a union of convex pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneryObject {
    /// What a visitor would call it.
    pub name: &'static str,
    /// Pose in the world.
    pub pose: Pose,
    /// Its pieces.
    pub pieces: Vec<SceneryPiece>,
}

/// Height of the table's top, in metres.
pub const TABLE_TOP_M: f32 = 0.75;

/// Where the ball lies at first, in metres: on the table.
pub const BALL_START: [f32; 3] = [-0.1, TABLE_TOP_M + BALL_RADIUS_M + 0.000_25, -0.72];

/// Radius of the ball, in metres.
pub const BALL_RADIUS_M: f32 = 0.06;

/// All fixed objects.
#[must_use]
pub fn gallery() -> Vec<SceneryObject> {
    let mut objects = vec![
        block("floor", [2.0, -0.1, 0.0], [4.2, 0.1, 2.2]),
        block("ceiling", [2.0, 3.1, 0.0], [4.2, 0.1, 2.2]),
        outer_walls(),
        door_wall(),
        table(),
        bench("bench", [0.0, 0.0, 1.4]),
        bench("console", [4.0, 0.0, -1.6]),
        block("square plinth", [3.2, 0.5, 1.0], [0.25, 0.5, 0.25]),
        prism("octagonal plinth", [4.6, 0.5, 0.8], 8, 0.3, 0.5),
        prism("hexagonal plinth", [5.3, 0.5, -0.6], 6, 0.3, 0.5),
        pyramid("pyramid", [3.2, 1.0, 1.0], 0.2, 0.4),
        octahedron("octahedron", [4.6, 1.25, 0.8], 0.25),
        icosahedron("icosahedron", [5.3, 1.25, -0.6], 0.24),
    ];
    for (name, x, z) in [
        ("painting of the sea", -1.0, -1.97),
        ("painting of a harbour", 0.4, -1.97),
        ("painting of a hill", 3.0, -1.97),
        ("portrait", 5.0, -1.97),
        ("still life", -0.6, 1.97),
        ("sketch", 4.4, 1.97),
    ] {
        objects.push(block(name, [x, 1.6, z], [0.35, 0.25, 0.02]));
    }
    objects.extend([
        prism("column", [-1.4, 1.5, -1.3], 8, 0.15, 1.5),
        stool(),
        wedge("ramp", [5.6, 0.0, 1.4]),
        pyramid("obelisk", [-1.4, 0.0, 1.4], 0.25, 1.2),
    ]);
    objects
}

/// Triangles of the whole scenery when every face is cut into triangles.
#[must_use]
pub fn triangles(objects: &[SceneryObject]) -> usize {
    use palpable::geometry::hull::HullBuilder;
    let mut builder = Box::new(HullBuilder::new());
    let mut count = 0;
    for piece in objects.iter().flat_map(|object| &object.pieces) {
        if let Ok(hull) = builder.build(&piece.points) {
            count += hull
                .faces
                .iter()
                .map(|face| usize::from(face.loop_count) - 2)
                .sum::<usize>();
        }
    }
    count
}

/// Whether a point is inside the building's walls, floor and ceiling.
#[must_use]
pub fn is_inside(point: [f64; 3]) -> bool {
    let [x, y, z] = point;
    (-2.1..=6.1).contains(&x) && (0.0..=3.0).contains(&y) && (-2.0..=2.0).contains(&z)
}

/// The ball of the paper: 482 vertices and 960 triangles on a sphere about the origin.
#[must_use]
pub fn ball_points() -> Vec<[f32; 3]> {
    const SLICES: usize = 32;
    const RINGS: usize = 15;
    let mut points = vec![[0.0, BALL_RADIUS_M, 0.0], [0.0, -BALL_RADIUS_M, 0.0]];
    for ring in 1..=RINGS {
        let polar = std::f64::consts::PI * ring as f64 / (RINGS + 1) as f64;
        for slice in 0..SLICES {
            let turn = std::f64::consts::TAU * slice as f64 / SLICES as f64;
            let unit = [
                polar.sin() * turn.cos(),
                polar.cos(),
                polar.sin() * turn.sin(),
            ];
            points.push(unit.map(|x| (x * f64::from(BALL_RADIUS_M)) as f32));
        }
    }
    points
}

fn object(name: &'static str, at: [f32; 3], pieces: Vec<SceneryPiece>) -> SceneryObject {
    SceneryObject {
        name,
        pose: Pose::at(at[0], at[1], at[2]),
        pieces,
    }
}

fn cuboid(at: [f32; 3], half: [f32; 3]) -> SceneryPiece {
    let mut points = Vec::with_capacity(8);
    for corner in 0..8 {
        let sign = |bit: usize| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        points.push([sign(0) * half[0], sign(1) * half[1], sign(2) * half[2]]);
    }
    SceneryPiece {
        points,
        half_extents: Some(half),
        local: Pose::at(at[0], at[1], at[2]),
    }
}

fn hull(at: [f32; 3], points: Vec<[f32; 3]>) -> SceneryPiece {
    SceneryPiece {
        points,
        half_extents: None,
        local: Pose::at(at[0], at[1], at[2]),
    }
}

fn block(name: &'static str, at: [f32; 3], half: [f32; 3]) -> SceneryObject {
    object(name, at, vec![cuboid([0.0; 3], half)])
}

fn outer_walls() -> SceneryObject {
    object(
        "outer walls",
        [2.0, 1.5, 0.0],
        vec![
            cuboid([0.0, 0.0, -2.1], [4.2, 1.5, 0.1]),
            cuboid([0.0, 0.0, 2.1], [4.2, 1.5, 0.1]),
            cuboid([-4.1, 0.0, 0.0], [0.1, 1.5, 2.0]),
            cuboid([4.1, 0.0, 0.0], [0.1, 1.5, 2.0]),
        ],
    )
}

fn door_wall() -> SceneryObject {
    object(
        "wall with a door",
        [2.0, 1.5, 0.0],
        vec![
            cuboid([0.0, 0.0, -1.25], [0.1, 1.5, 0.75]),
            cuboid([0.0, 0.0, 1.25], [0.1, 1.5, 0.75]),
            cuboid([0.0, 1.05, 0.0], [0.1, 0.45, 0.5]),
        ],
    )
}

fn table() -> SceneryObject {
    let leg = |x: f32, z: f32| cuboid([x, 0.355, z], [0.03, 0.355, 0.03]);
    object(
        "table",
        [0.0, 0.0, -0.5],
        vec![
            cuboid([0.0, TABLE_TOP_M - 0.02, 0.0], [0.8, 0.02, 0.4]),
            leg(-0.75, -0.35),
            leg(0.75, -0.35),
            leg(-0.75, 0.35),
            leg(0.75, 0.35),
        ],
    )
}

fn bench(name: &'static str, at: [f32; 3]) -> SceneryObject {
    object(
        name,
        at,
        vec![
            cuboid([0.0, 0.43, 0.0], [0.6, 0.03, 0.2]),
            cuboid([-0.5, 0.2, 0.0], [0.04, 0.2, 0.18]),
            cuboid([0.5, 0.2, 0.0], [0.04, 0.2, 0.18]),
        ],
    )
}

fn prism_points(sides: usize, radius: f32, half_height: f32) -> Vec<[f32; 3]> {
    let mut points = Vec::with_capacity(2 * sides);
    for y in [-half_height, half_height] {
        for side in 0..sides {
            let turn = std::f32::consts::TAU * side as f32 / sides as f32;
            points.push([radius * turn.cos(), y, radius * turn.sin()]);
        }
    }
    points
}

fn prism(name: &'static str, at: [f32; 3], sides: usize, radius: f32, half: f32) -> SceneryObject {
    object(
        name,
        at,
        vec![hull([0.0; 3], prism_points(sides, radius, half))],
    )
}

fn pyramid(name: &'static str, at: [f32; 3], half: f32, height: f32) -> SceneryObject {
    let points = vec![
        [-half, 0.0, -half],
        [half, 0.0, -half],
        [half, 0.0, half],
        [-half, 0.0, half],
        [0.0, height, 0.0],
    ];
    object(name, at, vec![hull([0.0; 3], points)])
}

fn octahedron(name: &'static str, at: [f32; 3], radius: f32) -> SceneryObject {
    let mut points = Vec::new();
    for axis in 0..3 {
        for sign in [-radius, radius] {
            let mut point = [0.0; 3];
            point[axis] = sign;
            points.push(point);
        }
    }
    object(name, at, vec![hull([0.0; 3], points)])
}

fn icosahedron(name: &'static str, at: [f32; 3], radius: f32) -> SceneryObject {
    let golden = (1.0 + 5.0f32.sqrt()) / 2.0;
    let scale = radius / (1.0 + golden * golden).sqrt();
    let mut points = Vec::new();
    for a in [-scale, scale] {
        for b in [-scale * golden, scale * golden] {
            points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
    }
    object(name, at, vec![hull([0.0; 3], points)])
}

fn stool() -> SceneryObject {
    object(
        "stool",
        [1.2, 0.0, 0.6],
        vec![
            hull([0.0, 0.43, 0.0], prism_points(6, 0.18, 0.03)),
            hull([0.0, 0.2, 0.0], prism_points(3, 0.12, 0.2)),
        ],
    )
}

fn wedge(name: &'static str, at: [f32; 3]) -> SceneryObject {
    let mut points = Vec::new();
    for z in [-0.3, 0.3] {
        points.extend([[-0.4, 0.0, z], [0.4, 0.0, z], [0.4, 0.25, z]]);
    }
    let mut ramp = object(name, at, vec![hull([0.0; 3], points)]);
    let turn = quat_from_rotation_vector(Vec3::new(0.0, 0.4, 0.0));
    ramp.pose = Pose::new(turn, Vec3::from_array(at));
    ramp
}
