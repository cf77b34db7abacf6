//! How well the union of the parts stands for the mesh.

use std::fmt;

use glam::DVec3;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

use super::HandError;
use super::hull::Hull;

/// A sample this far outside every part, in metres, counts as uncovered: ten times the rounding of the parts' vertices.
const COVERED_SLOP_M: f64 = 1e-6;

/// The union of the parts against the mesh, both in the bind pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Distance between samples on surfaces and in space, in metres.
    pub spacing_m: f64,
    /// Samples taken on the mesh.
    pub mesh_samples: usize,
    /// Share of them outside every part, 0 to 1.
    pub uncovered_share: f64,
    /// Largest distance from one of them to the nearest part, in metres.
    pub uncovered_m_max: f64,
    /// Samples taken on the parts that are outside the mesh.
    pub outside_samples: usize,
    /// Their mean distance to the mesh, in metres.
    pub outside_m_mean: f64,
    /// Their largest distance to the mesh, in metres.
    pub outside_m_max: f64,
    /// Volume of the mesh, in cubic metres.
    pub mesh_volume_m3: f64,
    /// Volume inside a part and outside the mesh over the mesh's volume.
    pub phantom_share: f64,
    /// Volume inside the mesh and outside every part over the mesh's volume.
    pub missed_share: f64,
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "mesh outside the parts: {:.3} % of {} samples, at most {:.4} mm",
            100.0 * self.uncovered_share,
            self.mesh_samples,
            1e3 * self.uncovered_m_max
        )?;
        writeln!(
            f,
            "parts outside the mesh: mean {:.2} mm, at most {:.2} mm ({} samples)",
            1e3 * self.outside_m_mean,
            1e3 * self.outside_m_max,
            self.outside_samples
        )?;
        write!(
            f,
            "mesh {:.1} cm3, phantom volume {:.1} %, missed volume {:.1} %",
            1e6 * self.mesh_volume_m3,
            100.0 * self.phantom_share,
            100.0 * self.missed_share
        )
    }
}

/// Measures with one sample per `spacing_m` in each direction.
pub(super) fn measure(
    positions: &[DVec3],
    triangles: &[[usize; 3]],
    hulls: &[Hull],
    spacing_m: f64,
) -> Result<Coverage, HandError> {
    let parts: Vec<Part> = hulls.iter().map(Part::new).collect::<Result<_, _>>()?;
    let mesh = solid(positions, triangles)?;
    let on_mesh = surface_samples(positions, triangles, spacing_m);
    let gap: Vec<f64> = on_mesh
        .iter()
        .map(|&point| gap_to_union_m(&parts, point))
        .collect();
    let outside: Vec<f64> = hulls
        .iter()
        .flat_map(|hull| surface_samples(&hull.vertices, &hull.faces, spacing_m))
        .map(|point| -depth_m(&mesh, point))
        .filter(|&distance| distance > 0.0)
        .collect();
    let mesh_volume_m3 = volume_m3(positions, triangles);
    let part_corners = parts.iter().flat_map(|part| [part.low, part.high]);
    let corners: Vec<DVec3> = part_corners.chain(positions.iter().copied()).collect();
    let (phantom_m3, missed_m3) = volume_errors_m3(&mesh, &parts, bounds(&corners), spacing_m);
    Ok(Coverage {
        spacing_m,
        mesh_samples: on_mesh.len(),
        uncovered_share: share(gap.iter().filter(|&&gap| gap > 0.0).count(), gap.len()),
        uncovered_m_max: gap.iter().copied().fold(0.0, f64::max),
        outside_samples: outside.len(),
        outside_m_mean: outside.iter().sum::<f64>() / outside.len().max(1) as f64,
        outside_m_max: outside.iter().copied().fold(0.0, f64::max),
        mesh_volume_m3,
        phantom_share: phantom_m3 / mesh_volume_m3,
        missed_share: missed_m3 / mesh_volume_m3,
    })
}

struct Part<'a> {
    hull: &'a Hull,
    low: DVec3,
    high: DVec3,
    surface: TriMesh,
}

impl<'a> Part<'a> {
    fn new(hull: &'a Hull) -> Result<Self, HandError> {
        let (low, high) = bounds(&hull.vertices);
        let surface = solid(&hull.vertices, &hull.faces)?;
        Ok(Self {
            hull,
            low,
            high,
            surface,
        })
    }

    fn contains(&self, point: DVec3, slop_m: f64) -> bool {
        let near = point.cmpge(self.low - slop_m).all() && point.cmple(self.high + slop_m).all();
        near && self.hull.excess_m(point) <= slop_m
    }
}

fn gap_to_union_m(parts: &[Part], point: DVec3) -> f64 {
    if parts
        .iter()
        .any(|part| part.contains(point, COVERED_SLOP_M))
    {
        return 0.0;
    }
    parts
        .iter()
        .map(|part| -depth_m(&part.surface, point))
        .fold(f64::INFINITY, f64::min)
}

/// Phantom and missed volume, counted on a grid in the box.
fn volume_errors_m3(
    mesh: &TriMesh,
    parts: &[Part],
    (low, high): (DVec3, DVec3),
    spacing_m: f64,
) -> (f64, f64) {
    let (mut phantom, mut missed) = (0_usize, 0_usize);
    for point in grid(low, high, spacing_m) {
        let in_union = parts.iter().any(|part| part.contains(point, 0.0));
        let in_mesh = depth_m(mesh, point) > 0.0;
        phantom += usize::from(in_union && !in_mesh);
        missed += usize::from(in_mesh && !in_union);
    }
    let cell_m3 = spacing_m.powi(3);
    (phantom as f64 * cell_m3, missed as f64 * cell_m3)
}

fn grid(low: DVec3, high: DVec3, spacing_m: f64) -> impl Iterator<Item = DVec3> {
    let [x, y, z] = ((high - low) / spacing_m)
        .to_array()
        .map(|cells| cells.ceil() as usize);
    (0..x).flat_map(move |i| {
        (0..y).flat_map(move |j| {
            (0..z).map(move |k| low + spacing_m * (DVec3::new(i as f64, j as f64, k as f64) + 0.5))
        })
    })
}

/// Points spread over the triangles by the additive recurrence of the plastic number, one or more for each triangle.
fn surface_samples(positions: &[DVec3], triangles: &[[usize; 3]], spacing_m: f64) -> Vec<DVec3> {
    const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let mut samples = Vec::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| positions[vertex]);
        let area_m2 = 0.5 * (b - a).cross(c - a).length();
        let count = (area_m2 / (spacing_m * spacing_m)).ceil().max(1.0) as usize;
        for sample in 0..count {
            let [u, v] = STEP.map(|step| (0.5 + step * (sample + 1) as f64).fract());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            samples.push(a + u * (b - a) + v * (c - a));
        }
    }
    samples
}

/// Distance to the surface, in metres, positive inside.
fn depth_m(solid: &TriMesh, point: DVec3) -> f64 {
    let point = Vector::from_array(point.to_array());
    let projection = solid.project_local_point(point, false);
    let distance_m = (projection.point - point).length();
    if projection.is_inside {
        distance_m
    } else {
        -distance_m
    }
}

fn solid(positions: &[DVec3], triangles: &[[usize; 3]]) -> Result<TriMesh, HandError> {
    let vertices = positions
        .iter()
        .map(|point| Vector::from_array(point.to_array()))
        .collect();
    let indices = triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| vertex as u32))
        .collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES;
    TriMesh::with_flags(vertices, indices, flags)
        .map_err(|error| HandError::Hull(error.to_string()))
}

fn volume_m3(positions: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
    let volume = |triangle: &[usize; 3]| {
        let [a, b, c] = triangle.map(|vertex| positions[vertex]);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(volume).sum()
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    points.iter().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), &point| (low.min(point), high.max(point)),
    )
}

fn share(count: usize, of: usize) -> f64 {
    count as f64 / of.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(length_m: f64) -> Hull {
        let side = [0.0, 0.1];
        let corner = |index: usize| {
            DVec3::new(
                [0.0, length_m][index & 1],
                side[index >> 1 & 1],
                side[index >> 2 & 1],
            )
        };
        Hull::new(&(0..8).map(corner).collect::<Vec<_>>()).unwrap()
    }

    fn against_a_cube(length_m: f64) -> Coverage {
        let cube = bar(0.1);
        measure(&cube.vertices, &cube.faces, &[bar(length_m)], 0.005).unwrap()
    }

    #[test]
    fn a_part_equal_to_the_mesh_is_perfect() {
        let same = against_a_cube(0.1);
        assert_eq!(same.uncovered_share, 0.0);
        assert!(same.outside_m_max < 1e-9);
        assert_eq!((same.phantom_share, same.missed_share), (0.0, 0.0));
        assert!((same.mesh_volume_m3 - 1e-3).abs() < 1e-12);
    }

    #[test]
    fn a_part_of_half_the_length_misses_half() {
        let half = against_a_cube(0.05);
        assert!((half.uncovered_share - 0.5).abs() < 0.03);
        assert!((half.uncovered_m_max - 0.05).abs() < 0.001);
        assert!((half.missed_share - 0.5).abs() < 0.01);
        assert_eq!(half.phantom_share, 0.0);
    }

    #[test]
    fn a_part_of_double_length_sticks_out() {
        let double = against_a_cube(0.2);
        assert_eq!(double.uncovered_share, 0.0);
        assert!((double.outside_m_max - 0.1).abs() < 0.001);
        assert!((double.phantom_share - 1.0).abs() < 0.03);
        assert_eq!(double.missed_share, 0.0);
    }
}
