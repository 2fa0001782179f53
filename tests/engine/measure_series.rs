//! The table of a run, its file, and the comparison with a reference.

use coronet::measure::norm::compare;
use coronet::measure::series::{Reference, Series, SeriesError};
use coronet::measure::summary::mean;
use coronet::scene::Clock;

fn row(values: &[(&str, f64)]) -> Vec<(String, f64)> {
    values
        .iter()
        .map(|(name, value)| (name.to_string(), *value))
        .collect()
}

fn parabola(shift: f64, factor: f64) -> Series {
    let mut series = Series::default();
    for i in 0..=20 {
        let t = i as f64 * 1e-3 + shift;
        let depth = if i < 2 {
            f64::NAN
        } else {
            factor * (t - shift) * (0.02 - t + shift)
        };
        series.push(&row(&[("time_s", t), ("crater_depth_m", depth)]));
    }
    series
}

#[test]
fn a_table_reads_back_as_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("measures.csv");
    let mut series = parabola(1e-4, 1.0 / 3.0);
    series.push(&row(&[("time_s", 1.0), ("late_m", 2.5e-9)]));
    series.write(&path).unwrap();
    let back = Series::read(&path).unwrap();
    assert_eq!(back.names, ["time_s", "crater_depth_m", "late_m"]);
    for (a, b) in series
        .columns
        .iter()
        .flatten()
        .zip(back.columns.iter().flatten())
    {
        assert!(
            a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()),
            "{a} became {b}"
        );
    }
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.lines().last().unwrap().ends_with("1,,2.5e-9"),
        "{text}"
    );
}

#[test]
fn a_run_three_percent_off_has_norms_of_three_percent() {
    let (run, reference) = (parabola(2e-4, 1.03), parabola(0.0, 1.0));
    let norms = compare(&run, &reference, "ref", 2e-4);
    assert_eq!(norms.len(), 1);
    let norm = &norms[0];
    assert!(
        (norm.l2 - 0.03).abs() < 1e-9 && (norm.max - 0.03).abs() < 1e-9,
        "{norm:?}"
    );
    assert!(
        (norm.from - 2e-3).abs() < 1e-12 && norm.points == 19,
        "{norm:?}"
    );
    let unshifted = compare(&run, &reference, "ref", 0.0);
    assert!(unshifted[0].max > 0.04, "{unshifted:?}");
}

#[test]
fn maxima_crossings_and_interpolation() {
    let series = parabola(0.0, 1.0);
    let (depth, time) = series.maximum("crater_depth_m").unwrap();
    assert!((depth - 1e-4).abs() < 1e-12 && (time - 0.01).abs() < 1e-12);
    assert_eq!(series.at("crater_depth_m", 0.5e-3), None);
    let between = series.at("crater_depth_m", 4.5e-3).unwrap();
    assert!((between - 0.5 * (4e-3 * 16e-3 + 5e-3 * 15e-3)).abs() < 1e-12);
    let up = series.rises_through("crater_depth_m", 70e-6, 0.0).unwrap();
    assert!(up > 4e-3 && up < 5e-3, "{up}");
    assert_eq!(series.rises_through("crater_depth_m", 70e-6, 0.01), None);
}

#[test]
fn a_bad_reference_is_named_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    let message = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Series::read(&path).unwrap_err().to_string()
    };
    assert!(message("t,depth\n0,1\n").contains("`time_s`"));
    let bad = message("time_s,crater_depth_m\n0,1\n1,deep\n");
    assert!(bad.contains("line 3") && bad.contains("crater_depth_m") && bad.contains("deep"));
    assert!(message("time_s,a\n1,1\n0,1\n").contains("does not increase"));
    assert!(message("time_s,a,a\n0,1,1\n").contains("two columns are named `a`"));
    for wrong in ["inf", "1e300"] {
        let text = message(&format!("time_s,a\n0,{wrong}\n"));
        assert!(text.contains("line 2") && text.contains(wrong), "{text}");
    }
    let missing = Series::read(&folder.path().join("none.csv")).unwrap_err();
    assert!(matches!(missing, SeriesError::File(_)) && missing.to_string().contains("none"));
}

#[test]
fn a_reference_counts_as_its_column_or_its_clock_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    for (column, clock, shift) in [
        ("time_s", None, 0.0),
        ("time_after_contact_s", None, 0.25),
        ("time_s", Some(Clock::Contact), 0.25),
        ("time_after_contact_s", Some(Clock::Start), 0.0),
    ] {
        std::fs::write(&path, format!("# source\na,{column}\n1,0\n2,1\n")).unwrap();
        let reference = Reference::read(&path, clock).unwrap();
        assert_eq!(reference.shift(0.25), shift, "{column} {clock:?}");
        assert_eq!(reference.table.names, ["time_s", "a"]);
        assert_eq!(reference.table.time(), [0.0, 1.0]);
    }
}

#[test]
fn a_table_of_a_spreadsheet_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    std::fs::write(&path, "\u{feff}time_s,a\r\n0,1\r\n1,2\r\n").unwrap();
    let table = Series::read(&path).unwrap();
    assert_eq!(table.time(), [0.0, 1.0]);
    assert_eq!(table.column("a"), Some(&[1.0, 2.0][..]));
}

/// As `measures.csv`: both clocks, no time before contact.
#[test]
fn a_table_with_both_clocks_is_read_by_either() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("measures.csv");
    let text = "time_s,time_after_contact_s,a\n0,,1\n0.25,0,2\n1,0.75,3\n";
    std::fs::write(&path, text).unwrap();
    let start = Reference::read(&path, None).unwrap();
    assert_eq!(
        (start.shift(0.25), start.table.time()),
        (0.0, &[0.0, 0.25, 1.0][..])
    );
    let contact = Reference::read(&path, Some(Clock::Contact)).unwrap();
    assert_eq!(
        (contact.shift(0.25), contact.table.time()),
        (0.25, &[0.0, 0.75][..])
    );
    assert_eq!(contact.table.names, ["time_s", "a"]);
    assert_eq!(contact.table.column("a"), Some(&[2.0, 3.0][..]));
    for reference in [start, contact] {
        let norms = compare(&Series::read(&path).unwrap(), &reference.table, "r", 0.0);
        assert_eq!(norms.len(), 1, "a clock is not a measure: {norms:?}");
    }
}

#[test]
fn a_mean_is_over_time_however_rows_lie() {
    let of = |times: &[f64], blank: usize| {
        let mut series = Series::default();
        for (k, t) in times.iter().enumerate() {
            let value = if k == blank { f64::NAN } else { 2.0 * t + 1.0 };
            series.push(&row(&[("time_s", *t), ("depth_m", value)]));
        }
        mean(&series, "depth_m")
    };
    // Of equal rows it is their mean.
    assert_eq!(of(&[0.0, 0.25, 0.5, 0.75, 1.0], 9), Some(2.0));
    assert_eq!(of(&[0.0, 0.25, 0.5, 0.75, 1.0], 0), Some(2.25));
    // Rows that lie dense early do not count for more: by rows it would be 1.51.
    let dense = [0.0, 0.01, 0.02, 0.03, 0.05, 0.1, 0.4, 0.7, 1.0];
    let found = of(&dense, 9).unwrap();
    assert!((found - 2.0).abs() < 0.2, "{found}");
    assert_eq!(of(&[0.5], 9), Some(2.0));
    assert_eq!(of(&[0.5], 0), None);
}
