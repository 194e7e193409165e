//! The oracle: rays through pixel centres, in f64, from the documentation alone.

use bevy_faceoff::geometry::TriMesh;
use glam::DVec3;

pub struct Oracle {
    /// Corners in pixels, height last.
    triangles: Vec<[DVec3; 3]>,
    size: usize,
}

/// Margin in pixels within which `f32` may decide either way.
pub const MARGIN: f64 = 2.0e-3;

#[derive(Default, Debug)]
pub struct Tally {
    pub directions: usize,
    pub visible: usize,
    pub undecided: usize,
    pub slivers: usize,
    pub slivers_seen: usize,
    pub slivers_missed: usize,
    pub extra: usize,
}

impl Oracle {
    pub fn new(mesh: &TriMesh, (a, b): (f64, f64), size: usize) -> Self {
        let (sa, ca, sb, cb) = (a.sin(), a.cos(), b.sin(), b.cos());
        let bounds = mesh.aabb();
        let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
        let used: Vec<DVec3> = mesh.used_positions().map(|p| p.as_dvec3() - center).collect();
        let radius = used.iter().map(|p| p.length()).fold(0.0, f64::max);
        let scale = (size as f64 / 2.0 - 1.5) / radius;
        let middle = size as f64 / 2.0 - 0.5;
        let place = |p: DVec3| {
            // About y first, then about x.
            let (x, z) = (cb * p.x + sb * p.z, -sb * p.x + cb * p.z);
            let (y, z) = (ca * p.y - sa * z, sa * p.y + ca * z);
            DVec3::new(scale * x + middle, scale * y + middle, scale * z)
        };
        let triangles = used
            .chunks(3)
            .map(|t| [place(t[0]), place(t[1]), place(t[2])])
            .collect();
        Self { triangles, size }
    }

    /// Distance in pixels of (x, y) from the border of `t`, positive inside, and the height there.
    pub fn probe(t: &[DVec3; 3], x: f64, y: f64) -> Option<(f64, f64)> {
        let area = (t[1] - t[0]).cross(t[2] - t[0]).z;
        if area.abs() < 1.0e-9 {
            return None;
        }
        let point = DVec3::new(x, y, 0.0);
        let (mut inside, mut height) = (f64::INFINITY, 0.0);
        for k in 0..3 {
            let (p, q) = (t[(k + 1) % 3], t[(k + 2) % 3]);
            let weight = (q - p).cross(point - p).z / area;
            let edge = (q - p).truncate().length();
            inside = inside.min(weight * area.abs() / edge);
            height += weight * t[k].z;
        }
        Some((inside, height))
    }

    /// Highest point of all triangles but `except` that surely (`margin > 0`) or possibly (`< 0`) hold (x, y).
    pub fn highest(&self, x: f64, y: f64, except: usize, margin: f64) -> f64 {
        (0..self.triangles.len())
            .filter(|&k| k != except)
            .filter_map(|k| Self::probe(&self.triangles[k], x, y))
            .filter(|p| p.0 > margin)
            .map(|p| p.1)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    pub fn check(&self, visible: &[u32], tally: &mut Tally) {
        let n = self.size;
        // Per pixel the two highest triangles that possibly cover it, and the highest that surely does.
        let mut possible = vec![[(f64::NEG_INFINITY, usize::MAX); 2]; n * n];
        let mut sure = vec![f64::NEG_INFINITY; n * n];
        let mut hits = vec![Vec::new(); self.triangles.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            let [low, high] = [DVec3::min, DVec3::max].map(|f| corners.iter().copied().reduce(f).unwrap());
            for y in (low.y - MARGIN).ceil() as usize..=(high.y + MARGIN) as usize {
                for x in (low.x - MARGIN).ceil() as usize..=(high.x + MARGIN) as usize {
                    let Some((inside, height)) = Self::probe(corners, x as f64, y as f64) else {
                        continue;
                    };
                    if inside < -MARGIN {
                        continue;
                    }
                    // Near its border a steep triangle's height is as uncertain as its slope is large.
                    let height = height.clamp(low.z, high.z);
                    let at = y * n + x;
                    hits[t].push((at, inside, height));
                    let pair = &mut possible[at];
                    if height > pair[0].0 {
                        *pair = [(height, t), pair[0]];
                    } else if height > pair[1].0 {
                        pair[1] = (height, t);
                    }
                    if inside > MARGIN {
                        sure[at] = sure[at].max(height);
                    }
                }
            }
        }
        tally.directions += 1;
        tally.visible += visible.len();
        for (t, hits) in hits.iter().enumerate() {
            let seen = visible.binary_search(&(t as u32)).is_ok();
            if hits.is_empty() {
                let corners = self.triangles[t];
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                if normal.z.abs() < 1.0e-5 * normal.length() {
                    assert!(
                        !seen || normal.z.abs() > 1.0e-7 * normal.length(),
                        "edge-on, but visible"
                    );
                    continue;
                }
                // A sliver: judged by what is really seen at points inside it.
                let mut top = false;
                for w in [[1.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]] {
                    let p = (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]) / (w[0] + w[1] + w[2]);
                    top |= p.z > self.highest(p.x, p.y, t, 0.0) + MARGIN;
                }
                tally.slivers += 1;
                tally.slivers_seen += usize::from(seen);
                tally.slivers_missed += usize::from(top && !seen);
                tally.extra += usize::from(seen && !top);
                continue;
            }
            let must = hits.iter().any(|&(at, inside, height)| {
                let other = possible[at].iter().find(|o| o.1 != t).expect("two of them");
                inside > MARGIN && height > other.0 + MARGIN
            });
            let may = hits.iter().any(|&(at, _, height)| height >= sure[at] - MARGIN);
            // Possibly covered, but not surely: the product may treat it as a sliver.
            let border = hits.iter().all(|h| h.1 <= MARGIN);
            assert!(seen || !must, "triangle {t} is visible but not found");
            if seen && !may && !border {
                // Steep triangles: their height at the border varies by more than the margin.
                tally.undecided += 1;
            }
        }
    }
}
