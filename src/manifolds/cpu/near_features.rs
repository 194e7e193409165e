//! Which features between nearest points count.
//!
//! Features of one-sided triangles count only where the bodies are nearest, and only if no other feature of the pair is
//! nearer: bodies that rest on each other have none. The rims of open meshes have no overlap that would push them apart
//! later, so all of their features count. Rounded bodies touch at all places where their cores are nearest.

use super::feature::{Feature, Origin, TrianglePair};

/// A feature must be nearer than others by this part.
pub(crate) const NEARER: f64 = 1.0 - 1.0e-6;
/// Features of solids count if they are farther apart than the nearest by no more than this part of the margin: both
/// ends of two edges that are all but parallel.
pub(crate) const BESIDE: f64 = 0.1;

/// Features between nearest points, and memory kept between pairs.
#[derive(Default)]
pub struct NearFeatures {
    /// Features of one-sided triangles without rounding.
    of_solids: Vec<Feature>,
    /// Features with a two-sided triangle, or of rounded bodies.
    all_count: Vec<Feature>,
    margin: f64,
    /// Whether all features count, those of one-sided triangles too: the bodies are rounded.
    is_rounded: bool,
    /// The least distance of other features.
    others: f64,
    /// The least distance of features of one-sided triangles so far.
    least: f64,
    /// The vertices that have a feature over a face, with its separation.
    vertices: Vec<((u8, u32), f64)>,
    /// The edges that have a feature, by their triangles.
    edges: Vec<([u32; 2], [u8; 2])>,
}

impl NearFeatures {
    /// Removes all.
    pub fn clear(&mut self) {
        self.of_solids.clear();
        self.all_count.clear();
    }

    /// Sets the largest distance of features, the least of other ones, and whether the bodies are rounded.
    pub fn set_limits(&mut self, margin: f64, others: f64, is_rounded: bool) {
        (self.margin, self.others, self.least) = (margin, others, f64::INFINITY);
        self.is_rounded = is_rounded;
    }

    /// The largest distance at which features of one-sided triangles can still count.
    pub fn most(&self) -> f64 {
        let beside = self.least + BESIDE * self.margin;
        beside.min(NEARER * self.others).min(self.margin)
    }

    /// Adds the features of two triangles.
    pub fn add(&mut self, pair: &TrianglePair) {
        let one_sided = (0..2).all(|i| {
            let one_sided = &pair.sides[i].features.one_sided;
            one_sided.is(pair.triangles[i].number as usize)
        });
        if one_sided && !self.is_rounded {
            pair.nearest_features(self.most(), |feature| {
                self.least = self.least.min(feature.separation);
                self.of_solids.push(feature);
            });
        } else {
            pair.nearest_features(self.margin, |feature| self.all_count.push(feature));
        }
    }

    /// Appends the features that count to the pair's other features.
    pub fn append_to(&mut self, features: &mut Vec<Feature>) {
        if !self.all_count.is_empty() {
            self.drop_known(features);
        }
        let most = self.least + BESIDE * self.margin;
        let counts = |feature: &&Feature| feature.separation <= most;
        features.extend(self.of_solids.iter().filter(counts));
        features.extend_from_slice(&self.all_count);
    }

    /// Drops features of edges that have one and, without rounding, of a vertex that is over a face of the other body
    /// and nearer to that. A rounded vertex may touch a face and an edge.
    fn drop_known(&mut self, features: &[Feature]) {
        self.vertices.clear();
        self.edges.clear();
        for feature in features {
            match feature.origin {
                Origin::Vertex { side, vertex } if !self.is_rounded => {
                    self.vertices.push(((side, vertex), feature.separation))
                }
                Origin::Edges(edges) if feature.separation >= 0.0 => self.edges.push((feature.triangles, edges)),
                _ => {}
            }
        }
        self.vertices
            .sort_unstable_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
        self.edges.sort_unstable();
        let (vertices, edges) = (&self.vertices, &self.edges);
        self.all_count.retain(|feature| match feature.origin {
            Origin::VertexEdge { side, vertex, .. } | Origin::Vertex { side, vertex } => {
                let first = vertices.partition_point(|(other, _)| *other < (side, vertex));
                let known = vertices.get(first).filter(|(other, _)| *other == (side, vertex));
                known.is_none_or(|(_, separation)| NEARER * separation > feature.separation)
            }
            Origin::Edges(places) => edges.binary_search(&(feature.triangles, places)).is_err(),
            _ => true,
        });
    }
}
