//! The report: tables and plots, written as one HTML file, CSV files, SVG files and one JSON file.

use crate::canvas::Canvas;
use crate::{Outcome, output};
use base64::Engine;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// Rows under named columns.
pub struct Table {
    /// The name of its CSV file, and its key in the JSON file.
    pub name: &'static str,
    pub columns: Vec<&'static str>,
    pub rows: Vec<Vec<Value>>,
}

impl Table {
    pub fn new(name: &'static str, columns: &[&'static str]) -> Self {
        Self {
            name,
            columns: columns.to_vec(),
            rows: Vec::new(),
        }
    }

    /// The number in a column of a row, if there is one.
    pub fn number(&self, row: &[Value], column: &str) -> Option<f64> {
        row[self.columns.iter().position(|c| *c == column)?].as_f64()
    }

    fn csv(&self) -> String {
        let mut text = self.columns.join(",") + "\n";
        for row in &self.rows {
            text += &row.iter().map(cell).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        text
    }

    fn html(&self) -> String {
        let mut text = String::from("<table><tr>");
        for column in &self.columns {
            let _ = write!(text, "<th>{}</th>", escape(&column.replace('_', " ")));
        }
        text += "</tr>\n";
        for row in &self.rows {
            text += "<tr>";
            for value in row {
                let _ = write!(text, "<td>{}</td>", escape(&cell(value)));
            }
            text += "</tr>\n";
        }
        text + "</table>\n"
    }
}

/// A number with at most four significant digits, or the text. Neither holds a comma.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.replace(',', ";"),
        Value::Number(number) if number.is_f64() => {
            let x = number.as_f64().unwrap_or_default();
            let whole = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
            format!("{x:.*}", (3 - whole).clamp(0, 6) as usize)
        }
        other => other.to_string(),
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Everything that was measured, in the order of the report.
#[derive(Default)]
pub struct Report {
    body: String,
    tables: Map<String, Value>,
    /// Name and content of each file beside the report.
    files: Vec<(String, Vec<u8>)>,
}

impl Report {
    pub fn heading(&mut self, text: &str) {
        let _ = writeln!(self.body, "<h2>{}</h2>", escape(text));
    }

    pub fn text(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escape(text));
    }

    pub fn table(&mut self, table: &Table) {
        self.body += &table.html();
        self.files
            .push((format!("{}.csv", table.name), table.csv().into_bytes()));
        let content = json!({ "columns": table.columns, "rows": table.rows });
        self.tables.insert(table.name.to_owned(), content);
    }

    /// Adds an SVG image.
    pub fn plot(&mut self, name: &str, svg: String) {
        self.body += &svg;
        self.files.push((format!("{name}.svg"), svg.into_bytes()));
    }

    /// Adds a picture, with a caption.
    pub fn picture(&mut self, canvas: &Canvas, caption: &str) -> Outcome {
        let data = base64::engine::general_purpose::STANDARD.encode(canvas.png()?);
        let _ = writeln!(
            self.body,
            "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{data}\"><figcaption>{0}</figcaption></figure>",
            escape(caption)
        );
        Ok(())
    }

    /// Writes all files.
    pub fn save(&self, folder: &Path, meta: &Table) -> Outcome {
        for (name, bytes) in &self.files {
            output::save(&folder.join(name), bytes)?;
        }
        let about: Map<String, Value> = meta.rows.iter().map(|row| (cell(&row[0]), row[1].clone())).collect();
        output::json(
            &folder.join("report.json"),
            &json!({ "meta": about, "tables": self.tables }),
        )?;
        let html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Aly &amp; Elawady 2010, reproduced</title>\n\
             <style>body{{font:15px/1.5 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}}table{{border-collapse:collapse;\
             font-size:13px;margin:1em 0}}td,th{{padding:2px 8px;border-bottom:1px solid #ddd;text-align:right}}img,svg{{max-width:100%;\
             height:auto}}figure{{margin:1em 0}}</style></head><body>\n\
             <h1>Aly &amp; Elawady 2010, reproduced</h1>\n{}{}</body></html>\n",
            meta.html(),
            self.body
        );
        output::save(&folder.join("report.html"), html.as_bytes())
    }
}
