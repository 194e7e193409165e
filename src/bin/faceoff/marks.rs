//! Marks of defects on a height image, and their legend.

use crate::canvas::{CHARACTER, Canvas, INK, PAPER};
use bevy_faceoff::geometry::{DefectKind, TriMesh};
use bevy_faceoff::projection::{HeightImage, ImagePlaces};
use glam::Vec3;

/// The height of a line of the legend, in pixels.
const LINE: u32 = CHARACTER + 6;
/// The width of a mark in the legend with the space behind it, in pixels.
const SAMPLE: u32 = 20;
/// A defect is on the near side if it is no farther below the surface than this part of the mesh's height: the surface
/// beside an edge or a vertex may be above it within a pixel.
const SLACK: f32 = 0.02;
/// How much of the colour of a mark is seen on the far side.
const PALE: f32 = 0.3;
/// With more marks than this on the near side they are smaller.
const MANY: usize = 300;

/// The defects of a mesh, as seen from a direction.
pub struct Marks {
    kinds: Vec<Kind>,
    radius: f32,
    size: u32,
}

/// The defects of a kind.
struct Kind {
    kind: DefectKind,
    near: Vec<[f32; 2]>,
    far: Vec<[f32; 2]>,
}

impl Marks {
    /// The defects of a mesh and where they are on a picture of it, drawn along this direction.
    pub fn new(mesh: &TriMesh, direction: Vec3, picture: &HeightImage) -> Self {
        let defects = mesh.defects();
        let places = ImagePlaces::new(mesh, direction, picture.size);
        let slack = SLACK * picture.heights.iter().copied().fold(0.0, f32::max);
        let of_kind = |kind: DefectKind| {
            let at = defects.of(kind).map(|defect| places.of(defect.position));
            let (near, far): (Vec<_>, Vec<_>) = at.partition(|at| at[2] + slack >= lowest_around(picture, *at));
            let flat = |at: Vec<[f32; 3]>| at.into_iter().map(|[x, y, _]| [x, y]).collect();
            Kind {
                kind,
                near: flat(near),
                far: flat(far),
            }
        };
        let kinds: Vec<Kind> = DefectKind::ALL
            .into_iter()
            .map(of_kind)
            .filter(|of| of.count() > 0)
            .collect();
        let near: usize = kinds.iter().map(|of| of.near.len()).sum();
        Self {
            kinds,
            radius: if near > MANY { 2.0 } else { 2.5 },
            size: picture.size,
        }
    }

    /// Marks the defects on the picture, whose upper left corner is given. Marks on the near side hide those on the far
    /// side, and marks of rare kinds hide others.
    pub fn paint(&self, canvas: &mut Canvas, [left, top]: [u32; 2]) {
        let mut kinds: Vec<&Kind> = self.kinds.iter().collect();
        kinds.sort_by_key(|of| std::cmp::Reverse(of.count()));
        let at = |[x, y]: [f32; 2]| [left as f32 + x, (top + self.size - 1) as f32 - y];
        for of in &kinds {
            for &place in &of.far {
                canvas.disc(at(place), self.radius, colour(of.kind), PALE);
            }
        }
        for of in &kinds {
            for &place in &of.near {
                mark(canvas, at(place), self.radius, colour(of.kind));
            }
        }
    }

    /// Width and height of the legend, in pixels.
    pub fn legend_size(&self) -> [u32; 2] {
        let lines = self.lines();
        let longest = lines.iter().map(|line| line.len()).max().unwrap_or_default();
        [SAMPLE + CHARACTER * longest as u32, LINE * (lines.len() as u32 + 1)]
    }

    /// Writes the legend, whose upper left corner is given.
    pub fn write_legend(&self, canvas: &mut Canvas, [left, top]: [u32; 2]) {
        for (y, line) in (top..).step_by(LINE as usize).zip(self.lines()) {
            canvas.text(left + SAMPLE, y, &line);
        }
        for (y, of) in (top..).step_by(LINE as usize).zip(&self.kinds) {
            let middle = [left as f32 + 5.5, y as f32 + CHARACTER as f32 / 2.0 - 0.5];
            mark(canvas, middle, 3.5, colour(of.kind));
        }
    }

    fn lines(&self) -> Vec<String> {
        if self.kinds.is_empty() {
            return vec!["no defects".into()];
        }
        let line = |of: &Kind| format!("{} {}, {} on this side", of.count(), of.kind.name(), of.near.len());
        let has_far = self.kinds.iter().any(|of| !of.far.is_empty());
        let pale = has_far.then(|| "pale: on the far side".into());
        self.kinds.iter().map(line).chain(pale).collect()
    }
}

impl Kind {
    fn count(&self) -> usize {
        self.near.len() + self.far.len()
    }
}

/// A disc with a light rim, so that it is seen on any ground.
fn mark(canvas: &mut Canvas, at: [f32; 2], radius: f32, colour: [u8; 3]) {
    canvas.disc(at, radius + 1.0, PAPER, 1.0);
    canvas.disc(at, radius, colour, 1.0);
}

/// The lowest surface at the nine pixels about a place; that of the background is 0.
fn lowest_around(picture: &HeightImage, [x, y, _]: [f32; 3]) -> f32 {
    let last = picture.size as f32 - 1.0;
    let steps = [-1.0, 0.0, 1.0];
    let pixels = steps.iter().flat_map(|dy| steps.map(|dx| [x + dx, y + dy]));
    let heights = pixels.map(|at| {
        let [x, y] = at.map(|at| at.round().clamp(0.0, last) as usize);
        picture.heights[y * picture.size as usize + x]
    });
    heights.fold(f32::INFINITY, f32::min)
}

fn colour(kind: DefectKind) -> [u8; 3] {
    let number = match kind {
        DefectKind::TurnedFace => 0,
        DefectKind::Disagreement => 1,
        DefectKind::BoundaryEdge => 2,
        DefectKind::CrowdedEdge => 3,
        DefectKind::TJunction => 4,
        DefectKind::Duplicate => 5,
        DefectKind::Opening => 6,
        DefectKind::Crack => 7,
        DefectKind::ZeroArea => 8,
        // The tenth colour is grey, as heights are.
        DefectKind::SolidInSolid => return INK,
    };
    let colour = colorous::TABLEAU10[number];
    [colour.r, colour.g, colour.b]
}
