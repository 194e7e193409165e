//! The report on the paper.

use crate::Folder;
use serde_json::Value;
use std::collections::BTreeSet;

#[test]
fn a_quick_report_is_complete() {
    let folder = Folder::new();
    let out = folder.good(&["reproduce", "--quick", "--backend", "cpu", "--out", "report"]);
    assert!(out.contains("report.html"), "{out}");

    let json: Value = serde_json::from_slice(&folder.read("report/report.json")).unwrap();
    assert_eq!(json["meta"]["seed"], "1");
    assert_eq!(json["meta"]["command"], "reproduce --backend cpu --quick --seed 1");
    assert_eq!(json["meta"]["GPU adapter"], "none was measured");
    let columns: Vec<&str> = strings(&json["tables"]["table1"]["columns"]);
    let at = |name: &str| columns.iter().position(|c| *c == name).unwrap();
    let rows = json["tables"]["table1"]["rows"].as_array().unwrap();
    let found: BTreeSet<(&str, u64, &str)> = rows
        .iter()
        .map(|row| {
            let text = |name| row[at(name)].as_str().unwrap();
            (text("shape"), row[at("bodies")].as_u64().unwrap(), text("culling"))
        })
        .collect();
    let mut expected = BTreeSet::new();
    for shape in ["torus", "knot"] {
        for bodies in (100..=2200).step_by(100) {
            expected.extend(["exact", "faces"].map(|culling| (shape, bodies, culling)));
        }
    }
    assert_eq!(found, expected);
    assert_eq!(rows.len(), expected.len());
    let largest = rows
        .iter()
        .find(|r| r[at("shape")] == "knot" && r[at("bodies")] == 2200)
        .unwrap();
    assert_eq!(largest[at("paper_pairs")], 1653);
    assert_eq!(largest[at("paper_ms")], 936.45);

    // Plain triangles and the exact mode agree on which bodies touch.
    let figure = json["tables"]["figure7"]["rows"].as_array().unwrap();
    assert_eq!(figure.len(), 9);
    for three in figure.chunks(3) {
        assert_eq!(three[0][2], "all triangles");
        assert_eq!(three[2][2], "exact");
        assert_eq!(three[0][6], three[2][6], "{three:?}");
        assert!(three[1][6].as_u64() <= three[2][6].as_u64(), "{three:?}");
    }
    assert_eq!(json["tables"]["recall"]["rows"].as_array().unwrap().len(), 16);

    for (name, table) in json["tables"].as_object().unwrap() {
        let csv = String::from_utf8(folder.read(&format!("report/{name}.csv"))).unwrap();
        let width = table["columns"].as_array().unwrap().len();
        assert_eq!(
            csv.lines().count(),
            1 + table["rows"].as_array().unwrap().len(),
            "{name}"
        );
        assert!(
            csv.lines().all(|line| line.split(',').count() == width),
            "{name}: {csv}"
        );
    }

    let html = String::from_utf8(folder.read("report/report.html")).unwrap();
    assert_eq!(html.matches("src=\"data:image/png;base64,").count(), 4);
    assert_eq!(html.matches("<svg").count(), 9);
    let outside = html.replace("http://www.w3.org/2000/svg", "");
    for reference in ["http:", "https:", "href=", "url(", "<script", "<link"] {
        assert!(
            !outside.contains(reference),
            "the report refers to something outside: {reference}"
        );
    }
    assert_eq!(outside.matches("src=").count(), 4);
}

#[test]
fn a_folder_that_cannot_be_made_is_named_at_once() {
    let folder = Folder::new();
    folder.write("file", "not a folder");
    folder.bad(&["reproduce", "--quick", "--out", "file/report"], &["file/report"]);
    folder.bad(&["reproduce", "--backend", "abacus"], &["abacus", "cpu"]);
}

fn strings(array: &Value) -> Vec<&str> {
    array.as_array().unwrap().iter().filter_map(Value::as_str).collect()
}
