//! Plots of speed against error, as SVG: logarithmic axes, colours that colour-blind readers tell apart (Okabe and
//! Ito 2008), and a marker of its own for each method.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// The points of one method.
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Abscissa, ordinate, label.
    pub points: Vec<(f64, f64, String)>,
}

const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(60, 60, 60),
];

/// What an error of zero and an infinite one are drawn as: off the scale of what a plot shows.
const LEAST: f64 = 1e-2;
const GREATEST: f64 = 1e17;

/// What drawing can fail with.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A scatter plot with logarithmic axes.
pub fn scatter(path: &Path, title: &str, x_label: &str, y_label: &str, series: &[Series]) -> Drawn {
    draw(path, title, x_label, y_label, series, false)
}

/// The same with the points of each series joined, in the order given.
pub fn lines(path: &Path, title: &str, x_label: &str, y_label: &str, series: &[Series]) -> Drawn {
    draw(path, title, x_label, y_label, series, true)
}

fn draw(path: &Path, title: &str, x_label: &str, y_label: &str, series: &[Series], joined: bool) -> Drawn {
    let clamp = |y: f64| match y {
        y if !y.is_finite() => GREATEST,
        0.0 => LEAST,
        y => y.min(GREATEST),
    };
    let all = || series.iter().flat_map(|s| &s.points);
    let around = |values: Vec<f64>| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        // Room for labels below the lowest point: a part of the length of the axis.
        let room = 1.4 * (high / low).powf(0.06);
        if low <= high { low / room..high * 2.5 } else { 0.1..10.0 }
    };
    let x_range = around(all().map(|p| p.0).collect());
    let y_range = around(all().map(|p| clamp(p.1)).collect());
    let root = SVGBackend::new(path, (960, 600)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 26))
        .margin(16)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d(x_range.log_scale(), y_range.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.06))
        .bold_line_style(BLACK.mix(0.18))
        .x_desc(x_label)
        .y_desc(y_label)
        .axis_desc_style(("sans-serif", 17))
        .label_style(("sans-serif", 15))
        .x_label_formatter(&|x| tick(*x))
        .y_label_formatter(&|y| tick(*y))
        .draw()?;
    let mut labels = Labels::default();
    // The legend goes into the upper corner that holds fewer points.
    let (mut left, mut right) = (0, 0);
    for (x, y, _) in all() {
        let (x, y) = chart.backend_coord(&(*x, clamp(*y)));
        left += u32::from(y < 180 && x < 400);
        right += u32::from(y < 180 && x > 660);
        labels.keep_free((x, y));
    }
    let corner = if left < right { SeriesLabelPosition::UpperLeft } else { SeriesLabelPosition::UpperRight };
    for (index, one) in series.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let marker = move |at: (i32, i32)| marker(index, at, colour);
        if joined {
            chart.draw_series(LineSeries::new(
                one.points.iter().map(|p| (p.0, clamp(p.1))),
                colour.stroke_width(2),
            ))?;
        }
        for (x, y, label) in &one.points {
            let at = chart.backend_coord(&(*x, clamp(*y)));
            let text =
                ("sans-serif", 14, &colour).into_text_style(&root).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(label.clone(), labels.place(at, label), text))?;
        }
        chart
            .draw_series(
                one.points.iter().map(|(x, y, _)| EmptyElement::at((*x, clamp(*y))) + marker((0, 0))),
            )?
            .label(one.name.clone())
            .legend(move |(x, y)| marker((x + 10, y)));
    }
    chart
        .configure_series_labels()
        .position(corner)
        .label_font(("sans-serif", 16))
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

/// A number on an axis: plain where it is short, else as a power of ten.
fn tick(x: f64) -> String {
    let exponent = x.log10().round() as i32;
    match x {
        x if (1e-3..1e4).contains(&x) => format!("{}", (x * 1e6).round() / 1e6),
        x if (x / 10f64.powi(exponent) - 1.0).abs() < 1e-9 => {
            let superscript = |c: char| match c {
                '-' => '\u{207b}',
                '1' => '\u{b9}',
                '2' => '\u{b2}',
                '3' => '\u{b3}',
                digit => char::from_u32(0x2070 + digit as u32 - '0' as u32).unwrap_or(digit),
            };
            format!("10{}", exponent.to_string().chars().map(superscript).collect::<String>())
        }
        x => crate::quantile::brief(x),
    }
}

/// Where labels and points stand already: each new label moves up or down until it is free.
#[derive(Default)]
struct Labels(Vec<(i32, i32, i32)>);

impl Labels {
    fn keep_free(&mut self, (x, y): (i32, i32)) {
        self.0.push((x - 7, y, 14));
    }

    fn place(&mut self, (x, y): (i32, i32), label: &str) -> (i32, i32) {
        // Letters of this size are about 7 pixels wide, lines 13 high.
        let (left, width) = (x + 9, 7 * label.chars().count() as i32);
        let free =
            |y: i32| self.0.iter().all(|(l, t, w)| left + width < *l || l + w < left || (y - t).abs() >= 13);
        let steps = (0..12).flat_map(|k| [y - 13 * k, y + 13 * k]);
        let y = steps.into_iter().find(|y| free(*y)).unwrap_or(y);
        self.0.push((left, y, width));
        (left, y)
    }
}

/// Circle, square, triangle, diamond, in turn.
fn marker(index: usize, (x, y): (i32, i32), colour: RGBColor) -> Polygon<(i32, i32)> {
    let corners: &[(i32, i32)] = match index % 5 {
        0 => &[(-5, -2), (-2, -5), (2, -5), (5, -2), (5, 2), (2, 5), (-2, 5), (-5, 2)],
        1 => &[(-5, -5), (5, -5), (5, 5), (-5, 5)],
        2 => &[(0, -6), (6, 5), (-6, 5)],
        3 => &[(0, -7), (7, 0), (0, 7), (-7, 0)],
        _ => &[(-6, -5), (6, -5), (0, 6)],
    };
    let points: Vec<(i32, i32)> = corners.iter().map(|(a, b)| (x + a, y + b)).collect();
    Polygon::new(points, colour.filled())
}
