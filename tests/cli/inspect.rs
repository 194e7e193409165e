//! `faceoff inspect`: what it says of meshes as they come.

use super::Folder;
use bevy_faceoff::asset::to_obj;
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::Vec3;
use serde_json::Value;

/// The report about a mesh in a file.
fn inspected(folder: &Folder, mesh: &TriMesh) -> Value {
    folder.write("mesh.obj", to_obj(mesh));
    serde_json::from_str(&folder.good(&["inspect", "mesh.obj", "--json"])).unwrap()
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap()
}

fn count(report: &Value, kind: &str) -> u64 {
    let defects = report["defects"].as_array().unwrap();
    let found = defects.iter().find(|defect| defect["kind"] == kind);
    found.map_or(0, |defect| defect["count"].as_u64().unwrap())
}

/// Several meshes as one; faces for which `flip` holds are wound the other way.
fn joined(parts: &[(TriMesh, Vec3)], flip: impl Fn(usize, usize) -> bool) -> TriMesh {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (part, (mesh, at)) in parts.iter().enumerate() {
        let first = vertices.len() as u32;
        vertices.extend(mesh.vertices().iter().map(|v| *v + *at));
        for (t, face) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = face.map(|v| v + first);
            faces.push(if flip(part, t) { [a, c, b] } else { [a, b, c] });
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

#[test]
fn a_cad_file_of_separate_faces_is_closed() {
    let folder = Folder::new();
    let knot = shapes::knot_1120();
    let clean = inspected(&folder, &knot);
    let shift = |i: usize| ((i * 7919) % 1000) as f32 / 1000.0 - 0.5;
    let corners = (0..knot.triangles().len()).flat_map(|t| knot.corners(t)).enumerate();
    // Up to a ten-millionth of its size of 1.7.
    let moved = corners.map(|(i, p)| p + Vec3::new(shift(i), shift(i + 1), shift(i + 2)) * 3.4e-7);
    let vertices: Vec<Vec3> = moved.collect();
    let faces = (0..vertices.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let report = inspected(&folder, &TriMesh::new(vertices, faces).unwrap());
    assert!(report["closed"] == true && report["mass_basis"] == "Solid" && report["mass_is_approximate"] == false);
    assert_eq!(
        (&report["warnings"], &report["defects"]),
        (&Value::Array(vec![]), &Value::Array(vec![]))
    );
    let ratio = number(&report, "volume") / number(&clean, "volume");
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
}

#[test]
fn two_shells_of_any_winding_weigh_their_sum_or_difference() {
    let folder = Folder::new();
    let (large, small) = (shapes::ball(1.0, 3), shapes::ball(0.4, 2));
    let [volume, inner] = [&large, &small].map(|mesh| number(&inspected(&folder, mesh), "volume"));
    let random = |part: usize, t: usize| (t * 7919 + part * 31) % 5 < 2;
    let windings: [&dyn Fn(usize, usize) -> bool; 5] = [
        &|_, _| false,
        &|part, _| part == 0,
        &|part, _| part == 1,
        &|_, _| true,
        &random,
    ];
    for (i, flip) in windings.iter().enumerate() {
        let beside = [(large.clone(), Vec3::ZERO), (small.clone(), Vec3::X * 3.0)];
        let report = inspected(&folder, &joined(&beside, flip));
        let found = number(&report, "volume") / (volume + inner);
        assert!((found - 1.0).abs() < 1e-5, "winding {i} beside: {found}");
        assert!(
            report["closed"] == true && report["orientation"] != "Mixed",
            "winding {i}"
        );

        let nested = [(large.clone(), Vec3::ZERO), (small.clone(), Vec3::X * 0.3)];
        let report = inspected(&folder, &joined(&nested, flip));
        // Wound alike both are solids, which is told.
        let alike = i == 0 || i == 3;
        let expected = if alike { volume + inner } else { volume - inner };
        let found = number(&report, "volume") / expected;
        assert!((found - 1.0).abs() < 1e-5, "winding {i} nested: {found}");
        assert_eq!(count(&report, "SolidInSolid"), u64::from(alike), "winding {i}");
        let told = report["warnings"].to_string();
        assert_eq!(told.contains("solids inside a solid"), alike, "{told}");
        assert_eq!(told.contains("were turned"), count(&report, "TurnedFace") > 0, "{told}");
    }
}

#[test]
fn a_ball_without_a_twentieth_of_its_faces_weighs_what_a_whole_one_does() {
    let folder = Folder::new();
    let ball = shapes::ball(1.0, 3);
    let volume = number(&inspected(&folder, &ball), "volume");
    let missing = |t: usize| (t * 7919 + 13) % 100 < 5;
    let faces = (0..ball.triangles().len()).filter(|&t| !missing(t));
    let mesh = TriMesh::new(ball.vertices().to_vec(), faces.map(|t| ball.triangles()[t]).collect()).unwrap();
    let report = inspected(&folder, &mesh);
    assert!(report["closed"] == false && report["nearly_closed"] == true && report["solid"] == true);
    assert!((number(&report, "volume") / volume - 1.0).abs() < 0.03);
    let error = number(&report, "mass_error");
    assert!(error > 0.0 && error < 0.03, "{error}");
    for x in report["center_of_mass"].as_array().unwrap() {
        assert!(x.as_f64().unwrap().abs() < 0.01, "{x}");
    }
    let openings = count(&report, "Opening");
    assert!((30..=64).contains(&openings), "{openings}");
    assert!(count(&report, "BoundaryEdge") >= 3 * openings);
    let text = folder.good(&["inspect", "mesh.obj"]);
    assert!(text.contains("nearly closed") && text.contains("openings"), "{text}");
}

#[test]
fn defects_are_named_with_places() {
    let folder = Folder::new();
    let cube = shapes::cube(2.0);
    let mut faces = cube.triangles().to_vec();
    // Face 12 is face 3 again, and face 13 has no area.
    faces.extend([cube.triangles()[3], [0, 0, 1]]);
    let mesh = TriMesh::new(cube.vertices().to_vec(), faces).unwrap();
    let report = inspected(&folder, &mesh);
    assert_eq!((count(&report, "Duplicate"), count(&report, "ZeroArea")), (1, 1));
    let duplicate = report["defects"]
        .as_array()
        .unwrap()
        .iter()
        .find(|defect| defect["kind"] == "Duplicate")
        .unwrap();
    let place = &duplicate["places"][0];
    assert_eq!(place["face"], 12);
    let middle = cube.corners(3).iter().sum::<Vec3>() / 3.0;
    for (axis, x) in middle.to_array().into_iter().enumerate() {
        assert!((place["position"][axis].as_f64().unwrap() - f64::from(x)).abs() < 1e-6);
    }
    let text = folder.good(&["inspect", "mesh.obj"]);
    assert!(text.contains("duplicate faces") && text.contains("face 12 ("), "{text}");
}
