//! Plots with logarithmic axes, as SVG.

use crate::Outcome;
use plotters::coord::combinators::LogCoord;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;

/// Named points, joined by a line.
pub struct Series {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

/// Colours that people with any colour vision can tell apart: Okabe & Ito 2008, "Color Universal Design", without
/// yellow.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
];

/// Width and height in pixels.
const SIZE: (u32, u32) = (900, 460);

/// Draws the series with a legend. Only positive points can be drawn; others are left out.
pub fn svg(title: &str, x: &str, y: &str, series: &[Series]) -> Outcome<String> {
    let mut svg = String::new();
    draw(&mut svg, title, x, y, series).map_err(|e| format!("cannot draw the plot \"{title}\": {e}"))?;
    Ok(svg)
}

fn draw(svg: &mut String, title: &str, x: &str, y: &str, series: &[Series]) -> Result<(), Box<dyn Error>> {
    let points = || series.iter().flat_map(|s| &s.points).filter(|p| p.0 > 0.0 && p.1 > 0.0);
    let range = |pick: fn(&(f64, f64)) -> f64| {
        let low = points().map(pick).fold(f64::INFINITY, f64::min);
        let high = points().map(pick).fold(0.0, f64::max);
        if low <= high {
            (low / 1.15, high * 1.15)
        } else {
            (1.0, 10.0)
        }
    };
    let (across, up) = (range(|p| p.0), range(|p| p.1));
    // The legend stands where the lines are low.
    let falls = (series.iter().flat_map(|s| s.points.first().zip(s.points.last()))).any(|(first, last)| {
        let (left, right) = if first.0 < last.0 { (first, last) } else { (last, first) };
        left.1 > 2.0 * right.1
    });
    // Whole decades, so that the axis has labels, and one more above as room for the legend.
    let decade = |x: f64| 10f64.powf(x);
    let up = (decade(up.0.log10().floor()), decade(up.1.log10().ceil() + 1.0));
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(46)
        .y_label_area_size(76)
        .build_cartesian_2d(Decades::new(across), Decades::new(up))?;
    chart
        .configure_mesh()
        .x_desc(x)
        .y_desc(y)
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .light_line_style(BLACK.mix(0.06))
        .bold_line_style(BLACK.mix(0.2))
        .draw()?;
    for (i, line) in series.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let there: Vec<_> = line.points.iter().copied().filter(|p| p.0 > 0.0 && p.1 > 0.0).collect();
        let style = colour.stroke_width(2);
        // Every other line is dashed, so that the one below it is seen.
        let dashed = i > 0 && i % 2 == 0;
        let (dash, gap) = (7, 6);
        let drawn = if dashed {
            chart.draw_series(DashedLineSeries::new(there.clone(), dash, gap, style))?
        } else {
            chart.draw_series(LineSeries::new(there.clone(), style))?
        };
        drawn.label(&line.name).legend(move |(x, y)| {
            let line = [(x, y), (x + 20, y)];
            if dashed {
                DashedPathElement::new(line, dash, gap, style).into_dyn()
            } else {
                PathElement::new(line, style).into_dyn()
            }
        });
        chart.draw_series(there.into_iter().map(|p| Circle::new(p, 3, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(if falls {
            SeriesLabelPosition::UpperRight
        } else {
            SeriesLabelPosition::UpperLeft
        })
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

/// A logarithmic axis. That of plotters has a mark where one decade ends, and another where the next one begins.
struct Decades(LogCoord<f64>);

impl Decades {
    fn new(range: (f64, f64)) -> Self {
        Self((range.0..range.1).log_scale().into())
    }
}

impl Ranged for Decades {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.0.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let mut points = self.0.key_points(hint);
        points.sort_by(f64::total_cmp);
        points.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * *b);
        points
    }

    fn range(&self) -> Range<f64> {
        self.0.range()
    }
}

/// A number as short as it can be.
fn label(x: &f64) -> String {
    if *x >= 1.0e4 {
        format!("{x:.0e}")
    } else {
        let text = format!("{x:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}
