//! Warnings about a baked mesh, for its author.

use super::collision_mesh::BakedMesh;
use crate::geometry::{DefectKind, Defects, MassBasis, Orientation};

impl BakedMesh {
    /// Warnings for the author of the mesh, one sentence each: dropped and turned faces, an open surface, and the like.
    /// Empty for a sound mesh. Code that loads a mesh should log them once, with the name of the file.
    pub fn warnings(&self) -> Vec<String> {
        if self.mesh.is_thin() {
            return Vec::new();
        }
        let defects = self.mesh.defects();
        let mut warnings = Vec::new();
        let all = self.mesh.triangles().len() as u64 + u64::from(self.mesh.dropped());
        let mut count = |kind: DefectKind, text: &str| {
            let count = defects.count(kind);
            if count > 0 {
                warnings.push(format!("{count} of {all} faces {text}"));
            }
        };
        count(
            DefectKind::ZeroArea,
            "have zero area and were dropped; the others keep their indices",
        );
        count(
            DefectKind::Duplicate,
            if self.mesh.twins().is_empty() {
                "have the same corners as an earlier one; remove doubled faces"
            } else {
                "have the same corners as an earlier one and count once for the mass; remove doubled faces"
            },
        );
        let turned = self.mesh.turned().iter().filter(|turned| **turned).count() as u64;
        // All faces are turned only if the settings say so.
        if turned > 0 && turned < all {
            warnings.push(format!(
                "{turned} of {all} faces were turned, so that neighbours agree and solids point outward; the file is unchanged"
            ));
        }
        let inside = defects.count(DefectKind::SolidInSolid);
        if inside > 0 {
            warnings.push(format!(
                "{inside} closed shells lie inside another one and point the same way, so they are solids inside a solid, \
                 and their mass counts twice; if they are cavities, flip their faces, else remove them"
            ));
        }
        match self.mesh.orientation() {
            Orientation::Open if self.mesh.caps().is_empty() => warnings.push(self.open_warning(&defects)),
            Orientation::Open => warnings.extend(self.nearly_closed_warning(&defects)),
            Orientation::Mixed => warnings.push(format!(
                "the faces at {} edges disagree about the winding and cannot be made to agree, so they push to both sides, \
                 {}; recalculate the normals or set the mass yourself",
                defects.count(DefectKind::Disagreement),
                self.mass_text()
            )),
            Orientation::Outward | Orientation::Inward => {}
        }
        if self.mesh.is_room() {
            warnings.push(
                "its faces point inward, so it is a room: bodies inside are free, its walls push inward, and its mass is \
                 that of a solid that fills it; if it is meant to be solid, flip its faces or bake it with `inward: Solid`"
                    .into(),
            );
        } else if self.mesh.is_closed() && self.mass.basis == MassBasis::Box {
            warnings.push(
                "the mesh encloses almost no volume, so its mass is that of its bounding box; set the mass yourself"
                    .into(),
            );
        } else if self.mass.approximate && self.settings.rounding == 0.0 && self.mass.basis == MassBasis::Solid {
            warnings.push(
                "its size does not fit single precision, so its mass is approximate; set the mass yourself".into(),
            );
        }
        warnings
    }

    /// What the mass was computed from, as the end of a sentence.
    fn mass_text(&self) -> String {
        let error = self.mass.error * 100.0;
        match self.mass.basis {
            MassBasis::Solid | MassBasis::Capped | MassBasis::Room => {
                format!("its mass is that of what it encloses, within {error:.1} %")
            }
            MassBasis::Winding => format!("its mass is that of what it mostly encloses, within about {error:.0} %"),
            MassBasis::Shell if self.settings.rounding > 0.0 => {
                format!("its mass is that of a sheet {} thick", 2.0 * self.settings.rounding)
            }
            MassBasis::Shell => format!(
                "its mass is that of a shell {} of its size thick",
                self.settings.shell_thickness
            ),
            MassBasis::Box => "its mass is that of its bounding box".into(),
        }
    }

    /// The warning about an open mesh that is nearly closed, if there is a reason for one.
    fn nearly_closed_warning(&self, defects: &Defects) -> Option<String> {
        let openings = defects.count(DefectKind::Opening);
        (openings > 0).then(|| {
            format!(
                "the mesh has {openings} small openings, the largest {:.2} % of its area. For what is inside they count as \
                 closed; {}",
                defects.largest_opening * 100.0,
                self.mass_text()
            )
        })
    }

    /// The warning about an open mesh.
    fn open_warning(&self, defects: &Defects) -> String {
        let mut text = "the mesh is open".to_owned();
        if let Some(gaps) = self.mesh.gaps() {
            let edges = if gaps.edges == 1 { "edge has" } else { "edges have" };
            text += &format!(" ({} {edges} no partner", gaps.edges);
            if let (Some(nearest), Some(relative)) = (gaps.nearest, gaps.relative) {
                text += &format!(
                    "; the nearest corners of these that no such edge joins are {nearest:.2e} apart, {relative:.1e} of \
                     its size, and `weld_tolerance` is {:.1e}",
                    self.settings.weld_tolerance
                );
            }
            let cracks = defects.count(DefectKind::Crack);
            if cracks > 0 {
                text += &format!("; {cracks} lie beside another one, as the sides of cracks do");
            }
            let largest = defects.largest_opening * 100.0;
            text += &format!("; the largest opening takes {largest:.1} % of its area)");
        }
        text + ": bodies inside it are not found, and "
            + &self.mass_text()
            + "; close the holes, bake it with a larger `weld_tolerance` if they are cracks, or set the mass yourself"
    }
}
