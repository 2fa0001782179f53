//! Figures: letters, coordinates, and the three kinds of files.

use coronet::draw::canvas::{Anchor, Canvas, INK, WHITE};
use coronet::draw::plot::{Curve, Line, Plot};
use coronet::draw::readable::Readable;
use coronet::draw::scale::{Plain, Scale};
use coronet::draw::sheet::{POINT, Sheet, Text, Weight};
use coronet::scene::FigureStyle;

const COLOUR: [u8; 3] = [9, 8, 7];

fn plot(line: Line, points: Vec<[f64; 2]>) -> Plot {
    Plot {
        title: "Crater depth".into(),
        x: "time after contact (ms)".into(),
        y: "energy (µJ)".into(),
        curves: vec![Curve {
            label: "depth & co".into(),
            points,
            line,
            colour: COLOUR,
        }],
        from_zero: true,
    }
}

/// Points of the lines of that colour, in the order in which they are drawn.
fn drawn(svg: &str) -> Vec<Vec<[f64; 2]>> {
    let own = svg
        .lines()
        .filter(|line| line.contains("stroke=\"#090807\""));
    let path = |line: &str| {
        let path = line.split('"').nth(1).unwrap();
        let points = path[1..].split('L');
        let number = |text: &str| text.parse().unwrap();
        let point = |text: &str| {
            let (x, y) = text.split_once(' ').unwrap();
            [number(x), number(y)]
        };
        points.map(point).collect()
    };
    own.map(path).collect()
}

#[test]
fn a_plot_breaks_at_blanks_and_names_its_axes() {
    let points = vec![
        [0.0, 1.0],
        [1.0, f64::NAN],
        [2.0, 3.0],
        [3.0, 2.0],
        [4.0, 5.0],
    ];
    let style = FigureStyle::default();
    let plot = plot(Line::Solid, points);
    let sheet = plot.sheet(&style).unwrap();
    let svg = sheet.svg();
    for text in [
        "Crater depth",
        "time after contact (ms)",
        "energy (µJ)",
        "depth &amp; co",
    ] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text}");
    }
    // The sample in the legend, a dot before the blank and a line after it.
    let lines = drawn(&svg);
    assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
    let dot = svg.lines().find(|line| line.starts_with("<circle"));
    let cells: Vec<&str> = dot.unwrap().split('"').collect();
    assert_eq!((cells[5], cells[7]), ("1.5", "#090807"), "{cells:?}");
    // Values are where the axes say, to a hundredth of a point.
    let start = [cells[1], cells[3]].map(|text| text.parse::<f64>().unwrap());
    let after = lines[1][0];
    let [across, up] = [(after[0] - start[0]) / 2.0, (after[1] - start[1]) / 2.0];
    for (point, value) in lines[1].iter().zip([[2.0, 3.0], [3.0, 2.0], [4.0, 5.0]]) {
        let expected = [
            start[0] + across * value[0],
            start[1] + up * (value[1] - 1.0),
        ];
        let away = (point[0] - expected[0]).hypot(point[1] - expected[1]);
        assert!(away < 0.03, "{point:?} {expected:?}");
    }
    let whole = lines[1]
        .iter()
        .flatten()
        .filter(|c| c.fract() == 0.0)
        .count();
    assert!(whole < 6, "coordinates are not whole numbers: {lines:?}");
    let empty = self::plot(Line::Solid, vec![[f64::NAN, 1.0]]);
    assert!(!empty.has_points());
    assert_eq!(plot.file_name(), "crater-depth");
}

#[test]
fn a_style_sets_size_letters_and_pixels() {
    let style = FigureStyle {
        width: 0.085,
        height: 0.06,
        font_size: 7.0,
        dpi: 200.0,
    };
    let dashed = plot(Line::Dashed, vec![[0.0, 0.0], [1.0, 1.0]]);
    let sheet = dashed.sheet(&style).unwrap();
    assert!(
        sheet
            .svg()
            .contains("width=\"85mm\" height=\"60mm\" viewBox=\"0 0 240.94 170.08\"")
    );
    let canvas = sheet.canvas(style.dpi);
    assert_eq!((canvas.width, canvas.height), (669, 472));
    let texts: Vec<&Text> = sheet.texts().collect();
    assert!(
        texts
            .iter()
            .all(|text| text.size == 7.0 || (text.size - 8.4).abs() < 1e-9)
    );
    for text in &texts {
        let end = text.at[0] + if text.is_upright { 0.0 } else { text.length() };
        let size = sheet.size;
        assert!(text.at[0] > 0.0 && text.at[1] < size[1], "{text:?}");
        assert!(text.anchor != Anchor::Left || end < size[0], "{text:?}");
    }
    assert!(drawn(&sheet.svg()).len() > 20, "dashes");
}

#[test]
fn letters_are_those_of_a_real_font() {
    for weight in [Weight::Regular, Weight::Bold] {
        for letter in "Qqß µ−²³°ρσ√≤é0123".chars().filter(|c| *c != ' ') {
            assert!(weight.has(letter), "{letter:?}");
        }
        // Proportional: the letters of different texts have different widths.
        assert!(weight.length("mm") > 2.5 * weight.length("ii"));
    }
    let mut canvas = Canvas::new(80, 30, WHITE);
    canvas.text([40.0, 20.0], 14.0, "10 ms", Anchor::Middle, INK);
    let is_dark = |x: usize, y: usize| canvas.get(x, y)[0] < 128;
    let dark: Vec<usize> = (0..80)
        .filter(|&x| (0..30).any(|y| is_dark(x, y)))
        .collect();
    let (left, right) = (dark[0], dark[dark.len() - 1]);
    assert!(
        left > 10 && right < 70 && (left + right).abs_diff(79) <= 6,
        "{left}..{right}"
    );
    assert!(
        (0..80).all(|x| (21..30).all(|y| !is_dark(x, y))),
        "no tails below the base line"
    );
}

#[test]
fn a_pdf_embeds_its_letters_and_has_a_valid_table_of_objects() {
    let mut sheet = Sheet::new([0.1 * POINT, 0.05 * POINT]);
    sheet.line(vec![[10.5, 20.25], [30.0, 40.0]], 1.25, COLOUR);
    sheet.circle([50.0, 50.0], 5.0, Some(1.0), COLOUR);
    sheet.text(Text::new([20.0, 30.0], 9.0, "µJ AV", Anchor::Left));
    sheet.image([60.0, 60.0], [80.0, 70.0], Canvas::new(2, 1, [255, 0, 9]));
    let bytes = sheet.pdf();
    let text = String::from_utf8_lossy(&bytes);
    assert!(bytes.starts_with(b"%PDF-1.") && text.trim_end().ends_with("%%EOF"));
    assert!(text.contains("/MediaBox [0 0 283.464"), "{}", &text[..600]);
    // y goes up: 141.73 - 20.25.
    assert!(
        text.contains("10.5 121.48") && text.contains("1.25 w"),
        "{}",
        &text[..2000]
    );
    assert!(text.contains("/FontFile2") && !text.contains("Helvetica"));
    // Each letter can be found again: the micro sign, J, the blank, A, V.
    for code in ["<00B5>", "<004A>", "<0020>", "<0041>", "<0056>"] {
        assert!(text.contains(code), "{code}");
    }
    // The subset is small beside the font.
    assert!(
        bytes.len() < 60_000 && Weight::Regular.data().len() > 500_000,
        "{}",
        bytes.len()
    );
    let find = |marker: &[u8], from: usize| {
        let places = bytes[from..].windows(marker.len());
        from + places.clone().position(|w| w == marker).expect("marker")
    };
    let table = find(b"\nxref\n", 0) + 1;
    let start: usize = text.lines().rev().nth(1).unwrap().parse().unwrap();
    assert_eq!(start, table);
    let entries = String::from_utf8_lossy(&bytes[table..find(b"trailer", table)]).into_owned();
    let mut objects = 0;
    for (number, entry) in entries.lines().skip(2).enumerate() {
        if let Some(offset) = entry.trim_end().strip_suffix(" 00000 n") {
            let at: usize = offset.parse().unwrap();
            let head = format!("{number} 0 obj");
            assert_eq!(&bytes[at..at + head.len()], head.as_bytes());
            objects += 1;
        }
    }
    assert_eq!(objects, 4 + 5 + 1);
}

#[test]
fn pixels_of_a_figure_are_where_its_points_are() {
    let mut sheet = Sheet::new([72.0, 36.0]);
    sheet.rectangle([10.0, 10.0], [20.0, 30.0], [200, 0, 0]);
    sheet.circle([50.0, 18.0], 8.0, None, [0, 0, 200]);
    let mut picture = Canvas::new(2, 1, WHITE);
    picture.set(1, 0, [0, 200, 0]);
    sheet.image([60.0, 4.0], [70.0, 10.0], picture);
    let canvas = sheet.canvas(144.0);
    assert_eq!((canvas.width, canvas.height), (144, 72));
    let count = |colour: [u8; 3]| canvas.pixels().iter().filter(|c| **c == colour).count();
    assert_eq!(count([200, 0, 0]), 20 * 40);
    assert_eq!(canvas.get(20, 20), [200, 0, 0]);
    assert_eq!(count([0, 200, 0]), 10 * 12);
    assert_eq!(
        (canvas.get(129, 10), canvas.get(131, 10)),
        (WHITE, [0, 200, 0])
    );
    let disc = std::f64::consts::PI * 16.0 * 16.0;
    assert!((count([0, 0, 200]) as f64 / disc - 1.0).abs() < 0.08);
}

#[test]
fn what_has_a_sign_is_grey_at_zero() {
    let signed = Scale::new([-200.0, 1000.0], Plain::Pale);
    assert_eq!(signed.range, [-200.0, 1000.0]);
    assert_eq!(signed.colour(0.0), [221, 221, 221]);
    let [cold, warm] = [-200.0, 200.0].map(|value| signed.colour(value));
    assert!(cold[2] > cold[0] && warm[0] > warm[2], "{cold:?} {warm:?}");
    // Equal strength on both sides, although the range is not even.
    let grey = |c: [u8; 3]| i32::from(c[0].max(c[2])) - i32::from(c[0].min(c[2]));
    assert!((grey(cold) - grey(warm)).abs() < 40, "{cold:?} {warm:?}");
    assert_eq!(signed.colour(1e6), [180, 4, 38]);
    // Noise below zero does not make a sign.
    let plain = Scale::new([-20.0, 1000.0], Plain::Pale);
    assert_eq!(plain.range, [0.0, 1000.0]);
    assert_eq!(plain.colour(-5.0), plain.colour(0.0));
    let negative = Scale::new([-5.0, -1.0], Plain::Viridis);
    assert!(negative.colour(-5.0)[2] > negative.colour(-5.0)[0]);
    assert_eq!(Scale::new([0.0, 0.0], Plain::Viridis).range, [0.0, 1.0]);
}

#[test]
fn columns_have_units_for_readers() {
    for (column, most, words, unit, factor) in [
        ("crater_depth_m", 8e-3, "crater depth", "mm", 1e3),
        ("front_m", 2.0, "front", "m", 1.0),
        ("speed_max_m_s", 3.0, "speed max", "m/s", 1.0),
        ("speed_max_m_s", 1e-3, "speed max", "mm/s", 1e3),
        ("pressure_max_Pa", 4e3, "pressure max", "kPa", 1e-3),
        ("kinetic_energy_J", 1.8e-4, "kinetic energy", "µJ", 1e6),
        ("mass_kg", 3e-6, "mass", "mg", 1e6),
        ("contact_angle_deg", 60.0, "contact angle", "°", 1.0),
        ("spread_factor", 3.0, "spread factor", "", 1.0),
        ("time_step_s", 2e-5, "time step", "µs", 1e6),
        ("momentum_z_kg_m_s", 1e-3, "momentum z", "mg m/s", 1e6),
        ("wall_force_z_N", 2e-3, "wall force z", "mN", 1e3),
    ] {
        let found = Readable::of(column, most);
        let expected = (words, unit, factor);
        assert_eq!(
            (found.words.as_str(), found.unit, found.factor),
            expected,
            "{column}"
        );
    }
    assert_eq!(
        Readable::of("crater_depth_m", 8e-3).label(),
        "crater depth (mm)"
    );
    assert_eq!(Readable::of("aspect_ratio", 1.0).label(), "aspect ratio");
    let in_two = |column| Readable::of(column, 1.0).in_two().label();
    assert_eq!(in_two("kinetic_energy_J"), "kinetic energy (J/m)");
    assert_eq!(in_two("speed_max_m_s"), "speed max (m/s)");
}
