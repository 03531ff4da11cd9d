//! `mpjr fit`: identification on data whose answer is known, and what it says of data that cannot be used.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output};

use mpjr::rheology::fit::{Fit, Residuals, Samples, Stop, auto, identify, quality};
use mpjr::rheology::{Arm, Band, Fractional, Prony};

fn prony(arms: &[(f64, f64)]) -> Prony {
    Prony { arms: arms.iter().map(|&(weight, time)| Arm { weight, time }).collect() }
}

/// Relaxation moduli of a series at `count` times of a band.
fn relaxation(modulus: f64, series: &Prony, (from, to, count): (f64, f64, usize)) -> Samples {
    let time = Band::new(from, to).unwrap().samples(count);
    let values = time.iter().map(|&t| modulus * series.relaxation(t)).collect();
    Samples::relaxation(time, values)
}

fn dynamic(modulus: f64, series: &Prony, (from, to, count): (f64, f64, usize)) -> Samples {
    let frequency = Band::new(from, to).unwrap().samples(count);
    let part = |pick: fn(nalgebra::Complex<f64>) -> f64| {
        frequency.iter().map(|&w| modulus * pick(series.complex_modulus(w))).collect::<Vec<_>>()
    };
    Samples::dynamic(frequency.clone(), part(|m| m.re), part(|m| m.im))
}

/// Multiplies every value by 1 + amplitude times a reproducible number in (-1, 1).
fn noisy(mut samples: Samples, amplitude: f64) -> Samples {
    let mut state = 12345u64;
    for value in &mut samples.values {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *value *= 1.0 + amplitude * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
    }
    samples
}

fn assert_recovers(fit: &Fit, modulus: f64, series: &Prony, tolerance: f64) {
    assert_eq!(fit.series.arms.len(), series.arms.len(), "{fit:?}");
    assert!((fit.instantaneous / modulus - 1.0).abs() < tolerance, "{fit:?}");
    for (found, exact) in fit.series.arms.iter().zip(&series.arms) {
        assert!((found.weight / exact.weight - 1.0).abs() < tolerance, "{found:?} {exact:?}");
        assert!((found.time / exact.time - 1.0).abs() < tolerance, "{found:?} {exact:?}");
    }
}

/// Bonari and Paggi (2020), Table 1: the power law with 814.7 Pa s^0.226 and order 0.226, G = E/2, fifty times from
/// 0.1 s to 10 s, least squares on G, 1, 2 and 3 arms. Modulus to 1e-3 Pa, weights and times to 1e-3: all as printed but the
/// first weight of three arms, which is 0.3095 where the table, whose weights are made to sum to 1, has 0.310.
#[test]
fn table_1_of_the_paper_to_every_printed_digit_but_one() {
    type Row<'a> = (&'a str, &'a [&'a str], &'a [&'a str]);
    let rows: [Row; 3] = [
        ("568.498", &["0.579"], &["0.817"]),
        ("674.606", &["0.398", "0.296"], &["0.212", "2.458"]),
        ("749.386", &["0.309", "0.226", "0.210"], &["0.102", "0.545", "4.104"]),
    ];
    let law = Fractional::new(814.7 / 2.0, 0.226).unwrap();
    let time = Band::new(0.1, 10.0).unwrap().samples(50);
    let samples = Samples::relaxation(time.clone(), time.iter().map(|&t| law.relaxation(t)).collect());
    for (arms, (modulus, weights, times)) in (1..).zip(rows) {
        let fit = identify(&samples, arms, Residuals::Linear, None).unwrap();
        assert_eq!(format!("{:.3}", fit.instantaneous), modulus);
        let found: Vec<_> = fit.series.arms.iter().map(|arm| format!("{:.3}", arm.weight)).collect();
        assert_eq!(found, weights);
        let found: Vec<_> = fit.series.arms.iter().map(|arm| format!("{:.3}", arm.time)).collect();
        assert_eq!(found, times);
        assert_ne!(fit.stop, Stop::EvaluationLimit);
    }
}

/// Another sample count gives other digits.
#[test]
fn a_hundred_samples_give_other_digits() {
    let law = Fractional::new(814.7 / 2.0, 0.226).unwrap();
    let time = Band::new(0.1, 10.0).unwrap().samples(100);
    let samples = Samples::relaxation(time.clone(), time.iter().map(|&t| law.relaxation(t)).collect());
    let moduli: Vec<_> = (1..=3)
        .map(|arms| format!("{:.3}", identify(&samples, arms, Residuals::Linear, None).unwrap().instantaneous))
        .collect();
    assert_eq!(moduli, ["566.830", "672.717", "747.378"]);
}

#[test]
fn exact_data_return_their_series() {
    let series = prony(&[(0.3, 0.01), (0.25, 0.4), (0.2, 12.0)]);
    for residuals in [Residuals::Linear, Residuals::Relative] {
        let fit = identify(&relaxation(3.2e6, &series, (1e-3, 1e2, 60)), 3, residuals, None).unwrap();
        assert_recovers(&fit, 3.2e6, &series, 1e-8);
        assert!(fit.max_deviation() < 1e-9);
        let fit = identify(&dynamic(3.2e6, &series, (1e-3, 1e3, 60)), 3, residuals, None).unwrap();
        assert_recovers(&fit, 3.2e6, &series, 1e-8);
    }
}

/// Units must not matter: nanoseconds or years, Pa or TPa.
#[test]
fn scales_of_time_and_modulus_do_not_matter() {
    for (time, modulus) in [(1e-12, 1e-6), (1.0, 1.0), (1e12, 1e15)] {
        let series = prony(&[(0.5, 0.1 * time), (0.2, 3.0 * time)]);
        let samples = relaxation(modulus, &series, (0.01 * time, 30.0 * time, 40));
        let fit = identify(&samples, 2, Residuals::Linear, None).unwrap();
        assert_recovers(&fit, modulus, &series, 1e-8);
    }
}

/// A liquid has no long-term modulus: its logarithm runs off, the answer must not.
#[test]
fn a_liquid_has_no_long_term_modulus() {
    let series = prony(&[(0.6, 0.1), (0.4, 2.0)]);
    for residuals in [Residuals::Linear, Residuals::Relative] {
        let fit = identify(&relaxation(100.0, &series, (0.01, 8.0, 40)), 2, residuals, None).unwrap();
        assert_recovers(&fit, 100.0, &series, 1e-6);
        assert!(fit.series.long_term() < 1e-9);
        assert!(fit.series.arms.iter().map(|arm| arm.weight).sum::<f64>() <= 1.0);
    }
}

/// More arms than the data hold: nothing breaks, the sum stays right, and the surplus is named.
#[test]
fn surplus_arms_are_dropped_or_declared_ill_conditioned() {
    let series = prony(&[(0.5, 0.3)]);
    let fit = identify(&relaxation(10.0, &series, (0.01, 10.0, 40)), 6, Residuals::Linear, None).unwrap();
    assert!(fit.dropped > 0 || fit.uncertainty.condition > quality::ILL_CONDITIONED, "{fit:?}");
    assert!(fit.max_deviation() < 1e-6);
    // Data that do not relax, and data that rise, have no arms to find: an elastic solid.
    let flat = Samples::relaxation(vec![0.1, 1.0, 10.0, 100.0], vec![5.0; 4]);
    let fit = identify(&flat, 1, Residuals::Linear, None).unwrap();
    assert!((fit.instantaneous * fit.series.relaxation(10.0) / 5.0 - 1.0).abs() < 1e-6, "{fit:?}");
    let rising = Samples::relaxation(vec![0.1, 1.0, 10.0, 100.0], vec![4.0, 4.5, 5.5, 6.0]);
    let fit = identify(&rising, 1, Residuals::Linear, None).unwrap();
    assert!((fit.instantaneous * fit.series.relaxation(10.0) / 5.0 - 1.0).abs() < 1e-6, "{fit:?}");
}

#[test]
fn the_ladder_finds_the_number_of_arms_in_noise() {
    let series = prony(&[(0.3, 0.01), (0.25, 0.4), (0.2, 12.0)]);
    for (residuals, amplitude) in [(Residuals::Linear, 0.01), (Residuals::Relative, 0.01), (Residuals::Linear, 0.0)] {
        for samples in [relaxation(3.2e6, &series, (1e-3, 1e2, 80)), dynamic(3.2e6, &series, (1e-2, 1e3, 60))]
            .map(|samples| if amplitude > 0.0 { noisy(samples, amplitude) } else { samples })
        {
            let ladder = auto::climb(&samples, residuals).unwrap();
            assert_eq!(ladder.chosen, 2, "{residuals:?} {amplitude} {:?}", samples.test);
            let costs: Vec<f64> = ladder.rungs.iter().map(|rung| rung.fit.cost).collect();
            assert!(costs.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-9) + 1e-9), "{costs:?}");
        }
    }
}

/// In noise of known size the standard errors cover the truth: within three of them, for all seven unknowns.
#[test]
fn standard_errors_cover_the_truth() {
    let series = prony(&[(0.3, 0.01), (0.25, 0.4), (0.2, 12.0)]);
    let samples = noisy(relaxation(1.0, &series, (1e-3, 1e2, 400)), 0.01);
    let fit = identify(&samples, 3, Residuals::Relative, None).unwrap();
    let errors = fit.uncertainty.standard_errors.clone().unwrap();
    assert!((fit.instantaneous - 1.0).abs() < 3.0 * errors.instantaneous && errors.instantaneous < 0.01);
    for (i, (found, exact)) in fit.series.arms.iter().zip(&series.arms).enumerate() {
        assert!((found.weight - exact.weight).abs() < 3.0 * errors.weights[i] && errors.weights[i] < 0.02);
        assert!((found.time / exact.time).ln().abs() < 3.0 * errors.times[i] && errors.times[i] < 0.1);
    }
}

#[test]
fn the_band_of_trust_ends_where_the_series_leaves_the_data() {
    let law = Fractional::new(407.35, 0.226).unwrap();
    let time = Band::new(0.1, 10.0).unwrap().samples(50);
    let samples = Samples::relaxation(time.clone(), time.iter().map(|&t| law.relaxation(t)).collect());
    let fit = identify(&samples, 3, Residuals::Linear, None).unwrap();
    let inside = quality::trust(&samples, &fit, 0.05).unwrap();
    assert_eq!((inside.from, inside.to, inside.left_below, inside.left_above), (0.1, 10.0, false, false));
    let deviation = |t: f64| fit.instantaneous * fit.series.relaxation(t) / law.relaxation(t) - 1.0;
    let beyond = quality::trust_of_law(deviation, Band::new(1e-6, 1e6).unwrap(), 0.05).unwrap();
    assert!(beyond.left_below && beyond.left_above && beyond.from < 0.1 && beyond.to > 10.0);
    assert!((deviation(beyond.from).abs() - 0.05).abs() < 1e-5 && (deviation(beyond.to).abs() - 0.05).abs() < 1e-5);
}

/// Data of `count` points from five arms a decade apart, rounded to four digits, are met by five arms. Seven or twelve
/// are more than they carry: five come back, and the others are counted.
#[test]
fn more_arms_than_the_data_carry_come_back_as_those_they_carry() {
    let series = prony(&[(0.2, 0.01), (0.2, 0.1), (0.15, 1.0), (0.15, 10.0), (0.1, 100.0)]);
    let rounded = |mut samples: Samples| {
        samples.values.iter_mut().for_each(|value| *value = format!("{value:.3e}").parse().unwrap());
        samples
    };
    for samples in [
        rounded(relaxation(1e6, &series, (1e-3, 1e3, 60))),
        noisy(relaxation(1e6, &series, (1e-3, 1e3, 60)), 0.01),
        noisy(dynamic(1e6, &series, (1e-3, 1e3, 40)), 0.01),
    ] {
        for asked in [7, 12] {
            let fit = auto::at_most(&samples, asked, Residuals::Relative).unwrap();
            assert_eq!((fit.series.arms.len(), fit.dropped), (5, asked - 5));
            assert!((fit.instantaneous / 1e6 - 1.0).abs() < 0.02, "{}", fit.instantaneous);
            assert_eq!(quality::undetermined(&samples, &fit), None);
        }
    }
}

/// Moduli that still rise where the data end, as below a glass transition: E' and E'' of a broad spectrum of which the
/// data see a part. Whatever the number of arms, times stay within a decade of the data (by construction), and neither
/// `auto` nor a given number goes on to an instantaneous modulus of which nothing is known: it stays within ten times
/// the largest modulus measured.
#[test]
fn a_series_does_not_run_away_beyond_the_data() {
    let law = Fractional::new(1e5, 0.55).unwrap();
    for (points, digits) in [(8, 3), (12, 4), (30, 3)] {
        let frequency = Band::new(0.006, 6000.0).unwrap().samples(points);
        let round = |value: f64| format!("{value:.*e}", digits).parse::<f64>().unwrap();
        let storage = frequency.iter().map(|&w| round(1e5 + law.complex_modulus(w).re)).collect();
        let loss = frequency.iter().map(|&w| round(law.complex_modulus(w).im)).collect();
        let samples = Samples::dynamic(frequency, storage, loss);
        let largest = samples.values.iter().copied().fold(0.0, f64::max);
        for residuals in [Residuals::Linear, Residuals::Relative] {
            let ladder = auto::climb(&samples, residuals).unwrap();
            let chosen = ladder.rungs[ladder.chosen].fit.clone();
            for fit in [chosen, auto::at_most(&samples, 7, residuals).unwrap()] {
                let times: Vec<f64> = fit.series.arms.iter().map(|arm| arm.time).collect();
                assert!(times[0] > 0.099 / 6000.0 && times[times.len() - 1] < 10.1 / 0.006, "{times:?}");
                assert!(fit.instantaneous < 10.0 * largest, "{points}: {:e} {largest:e}", fit.instantaneous);
            }
        }
    }
}

/// Relaxation over 28 decades, a stretched transition as of an interlayer of glass: more than twenty arms pay, and the
/// ladder takes 1.2 to a decade.
#[test]
fn a_broad_relaxation_gets_more_than_twenty_arms() {
    let time = Band::new(1e-2, 1e26).unwrap().samples(113);
    // G(t) = G_e + (G_g - G_e)/(1 + (t/t_0)^m), a smooth step in log t.
    let modulus = time.iter().map(|t| 5e7 + 9.45e8 / (1.0 + (t / 1e12).powf(0.14))).collect();
    let samples = Samples::relaxation(time, modulus);
    assert_eq!(auto::most(&samples), 34);
    let arms = 31;
    let fit = auto::at_most(&samples, arms, Residuals::Relative).unwrap();
    assert_eq!(fit.series.arms.len(), arms);
    assert!(fit.rms_deviation() < 2e-3, "{}", fit.rms_deviation());
}

/// A row at t = 0 belongs to the band of trust as the first time after it does.
#[test]
fn a_row_at_zero_does_not_stretch_the_band_of_trust() {
    let series = prony(&[(0.5, 0.3), (0.3, 20.0)]);
    let mut samples = relaxation(10.0, &series, (0.01, 1000.0, 60));
    samples.at.insert(0, 0.0);
    samples.values.insert(0, 10.0);
    // An outlier pair, which splits the band in two: the longer part is the one above it.
    samples.values[10] *= 1.2;
    samples.values[11] *= 1.2;
    let fit = identify(&samples, 2, Residuals::Relative, None).unwrap();
    let trust = quality::trust(&samples, &fit, 0.05).unwrap();
    assert!(trust.from > 0.05 && trust.to == 1000.0, "{trust:?}");
}

#[test]
fn residuals_are_relative_where_the_data_span_a_decade() {
    let natural = |values: &[f64]| Residuals::natural(&Samples::relaxation(vec![1.0, 2.0], values.to_vec()));
    assert_eq!([natural(&[5.0, 1.0]), natural(&[11.0, 1.0])], [Residuals::Linear, Residuals::Relative]);
    let lossless = Samples::dynamic(vec![1.0], vec![5.0], vec![0.0]);
    assert_eq!(Residuals::natural(&lossless), Residuals::Linear);
}

fn mpjr(directory: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mpjr")).current_dir(directory).args(arguments.split(' ')).output().unwrap()
}

/// Every unusable file: exit code 2, nothing on standard output, and one message with file, line and reason.
#[test]
fn bad_data_are_refused_with_their_line() {
    let cases = [
        ("1\n2\n3\n", "line 1", "`1` is not two numbers"),
        ("t,G\n1,2\n3\n", "line 3", "1 column, but most lines have 2"),
        ("t,G\n1,2\n2,abc\n", "line 3", "`abc` is not a number"),
        ("1,2\n2,inf\n", "line 2", "`inf` is not a number"),
        ("1,2\n2,1e999\n", "line 2", "`1e999` is not a finite number"),
        ("1,9\n2,5\n", "line 2", "2 points; 3 arms have 7 unknowns and need at least 7"),
        ("1,9\n2,NaN\n3,5\n", "line 3", "2 points; 3 arms have 7 unknowns and need at least 7"),
        ("1,2\n2,-1\n", "line 2", "a relaxation modulus of -1 Pa; it must be > 0"),
        ("1,2\n2,0\n", "line 2", "a relaxation modulus of 0 Pa; it must be > 0"),
        ("-1,2\n2,1\n", "line 1", "a time of -1 s; it must be >= 0"),
        ("0,2,1\n1,2,1\n", "line 1", "a frequency of 0 rad/s; it must be > 0"),
        ("1,2,-1\n2,2,1\n", "line 1", "a loss modulus of -1 Pa; it must be >= 0"),
        ("t,G\ns,MPa\n1,-2\n2,1\n", "line 3", "a relaxation modulus of -2 MPa; it must be > 0"),
        ("1,2\n2,1\n3,1,1\n", "line 3", "3 columns, but most lines have 2"),
        ("", "line 1", "without any line of two numbers"),
        ("t,G\n# nothing\n", "line 2", "without any line of two numbers"),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (text, line, reason) in cases {
        std::fs::write(directory.path().join("data.csv"), text).unwrap();
        let output = mpjr(directory.path(), "fit data.csv --modulus shear --arms 3 --out material.toml");
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text:?}: {message}");
        assert!(
            message.starts_with(&format!("mpjr: data.csv: {line}: ")) && message.contains(reason),
            "{text:?}: {message}"
        );
        assert_eq!(message.lines().count(), 1);
        assert!(output.stdout.is_empty() && !directory.path().join("material.toml").exists());
    }
    std::fs::write(directory.path().join("data.csv"), format!("1,2\n2,{}\n", "x".repeat(1_000_000))).unwrap();
    let output = mpjr(directory.path(), "fit data.csv --modulus shear --arms 1");
    assert!(output.stderr.len() < 200 && output.status.code() == Some(2));
    assert_eq!(mpjr(directory.path(), "fit absent.csv --modulus shear --arms 1").status.code(), Some(4));
}

#[test]
fn bad_command_lines_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("data.csv"), "1,5\n2,4\n3,3.5\n4,3.2\n").unwrap();
    for arguments in [
        "fit",
        "fit data.csv",
        "fit data.csv --modulus young",
        "fit data.csv --modulus shear --arms 0",
        "fit data.csv --modulus shear --arms many",
        "fit data.csv --modulus shear --poisson 0.5",
        "fit data.csv --modulus shear --columns 1",
        "fit data.csv --modulus shear --columns 1,3",
        "fit data.csv --modulus shear --unit psi",
        "fit data.csv --fractional 814.7,0.226 --from 0.1 --to 10",
        "fit --fractional 814.7,0.226",
        "fit --fractional 814.7 --from 0.1 --to 10",
        "fit --fractional 814.7,1.2 --from 0.1 --to 10",
        "fit --fractional 814.7,0.226 --from 10 --to 0.1",
        "fit --fractional 814.7,0.226 --from 0.1 --to 10 --samples 4 --arms 2",
        "fit data.csv --modulus shear --hertz",
        "fit --fractional 814.7,0.226 --from 0.1 --to 10 --samples 1000000000",
    ] {
        let output = mpjr(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments}");
    }
}

/// The numbers of the material file are those of the fit, and another file is never replaced.
#[test]
fn the_material_file_reads_back() {
    let directory = tempfile::tempdir().unwrap();
    let law = "fit --fractional 814.7,0.226 --samples 50 --from 0.1 --to 10 --arms 2 --out material.toml";
    for _ in 0..2 {
        let output = mpjr(directory.path(), law);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8(output.stdout).unwrap().contains("674.606 Pa"));
    }
    let text = std::fs::read_to_string(directory.path().join("material.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let material = table["material"].as_table().unwrap();
    assert_eq!(format!("{:.3}", material["shear_modulus"].as_float().unwrap()), "674.606");
    assert_eq!(material["poisson_ratio"].as_float(), Some(0.0));
    assert_eq!(material["poisson_rule"].as_str(), Some("constant_ratio"));
    assert_eq!(format!("{:.3}", material["arms"][1]["time"].as_float().unwrap()), "2.458");
    std::fs::write(directory.path().join("material.toml"), "precious = true\n").unwrap();
    assert_eq!(mpjr(directory.path(), law).status.code(), Some(4));
    assert_eq!(std::fs::read_to_string(directory.path().join("material.toml")).unwrap(), "precious = true\n");
    assert_eq!(mpjr(directory.path(), &law.replace("material.toml", "absent/material.toml")).status.code(), Some(4));
}

/// Young's modulus over Hz is the same material as the shear modulus over rad/s.
#[test]
fn youngs_modulus_in_hertz_is_the_same_material() {
    let series = prony(&[(0.5, 0.1), (0.2, 3.0)]);
    let samples = dynamic(1000.0, &series, (0.01, 100.0, 30));
    let rows = |time: f64, modulus: f64| -> String {
        let row = |i: usize| {
            let value = |j: usize| modulus * samples.values[j];
            format!("{:?},{:?},{:?}\n", samples.at[i] * time, value(i), value(i + 30))
        };
        (0..30).map(row).collect()
    };
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("shear.csv"), rows(1.0, 1.0)).unwrap();
    std::fs::write(directory.path().join("young.csv"), rows(0.5 / std::f64::consts::PI, 2.6)).unwrap();
    let run = |arguments: &str| {
        let output = mpjr(directory.path(), &format!("{arguments} --poisson 0.3 --arms auto"));
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(0));
        text.lines().skip_while(|line| !line.starts_with("instantaneous")).take(6).map(str::to_owned).collect()
    };
    let (shear, young): (Vec<String>, Vec<String>) =
        (run("fit shear.csv --modulus shear"), run("fit young.csv --modulus young --hertz"));
    assert!(shear[0].contains("1000.000 Pa"), "{shear:?}");
    let value = |line: &str| line.split_whitespace().nth(1).map(str::to_owned);
    assert_eq!(value(&shear[4]), value(&young[4]));
    assert!(young[0].contains("1000.000 Pa"), "{young:?}");
}

/// The G(0) line and what the report says of data and units; the command must succeed.
fn report(directory: &Path, arguments: &str) -> String {
    let output = mpjr(directory, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// One material as four instruments would write it: titles with units over rad/s and Pa; Hz and MPa in a line of their
/// own, falling; decimal commas with a temperature and tan delta; without titles, all said on the command line. And
/// sweeps that overlap. All have G(0) = 3 MPa.
#[test]
fn one_material_in_the_hands_of_many_instruments() {
    let series = prony(&[(0.5, 0.1), (0.2, 3.0)]);
    let samples = dynamic(3e6, &series, (0.01, 100.0, 20));
    let point = |i: usize| (samples.at[i], samples.values[i], samples.values[i + 20]);
    let comma = |value: f64| format!("{value}").replace('.', ",");
    let tau = std::f64::consts::TAU;
    let rows = |row: &dyn Fn((f64, f64, f64)) -> String| (0..20).map(|i| row(point(i))).collect::<String>();
    let falling: String =
        (0..20).rev().map(point).map(|(w, s, l)| format!("{},{},{}\n", w / tau, s / 1e6, l / 1e6)).collect();
    let files = [
        ("si.csv", format!("w (rad/s),G' (Pa),G'' (Pa)\n{}", rows(&|(w, s, l)| format!("{w},{s},{l}\n"))), ""),
        ("hz.csv", format!("f,G1,G2\nHz,MPa,MPa\n{falling}"), ""),
        (
            "tan.txt",
            format!(
                "Instrument;7\nT;f;G';tan delta\n°C;Hz;kPa;-\n{}",
                rows(&|(w, s, l)| format!("25,0;{};{};{}\n", comma(w / tau), comma(s / 1e3), comma(l / s)))
            ),
            " --columns f,3,4",
        ),
        ("bare.txt", rows(&|(w, s, l)| format!("{} {} {}\n", w / tau, s / 1e9, l / 1e9)), " --hertz --unit GPa"),
        ("twice.txt", rows(&|(w, s, l)| format!("{w} {s} {l}\n{w} {s} {l}\n")), ""),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (name, text, flags) in files {
        std::fs::write(directory.path().join(name), text).unwrap();
        let text = report(directory.path(), &format!("fit {name} --modulus shear --arms 2{flags}"));
        let line = text.lines().find(|line| line.contains("G(0) = ")).unwrap();
        assert!(line.contains("G(0) = 3.000000e6 Pa"), "{name}: {text}");
    }
    let refused = |arguments: &str| {
        let output = mpjr(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(refused("fit hz.csv --modulus shear --unit GPa").contains("--unit GPa, but the header says MPa"));
    assert!(refused("fit si.csv --modulus shear --hertz").contains("--hertz, but the header says rad/s"));
    assert!(refused("fit tan.txt --modulus shear").contains("has 4 columns; say which by --columns"));
    assert!(refused("fit hz.csv --modulus shear --columns 1,2").contains("column 1 is in Hz, not a time"));
}

/// A relaxation over eight decades, E(t) = sum of 17 arms two to a decade with weights of a bell in log time, read at
/// 120 times with noise of 0.5 %: as many arms as decades are no worse than a fit of the moduli alone at fixed times,
/// one to a decade, which is what pyvisco's default does.
#[test]
fn no_worse_than_fixed_times_one_to_a_decade() {
    let bell: Vec<(f64, f64)> =
        (-8..=8).map(|k| f64::from(k) / 2.0).map(|x| (0.9 * (-x * x / 6.0).exp() / 7.6, 10f64.powf(x))).collect();
    let samples = noisy(relaxation(1e9, &prony(&bell), (1e-4, 1e4, 120)), 0.005);
    // The moduli at fixed times, by the same linear least squares: one step of the identification with all times held.
    let fixed = Band::new(1e-4, 1e4).unwrap().samples(9);
    let columns = fixed.iter().map(|time| samples.at.iter().map(|t| (-t / time).exp()).collect::<Vec<f64>>());
    let ones = vec![1.0; samples.at.len()];
    let matrix: Vec<nalgebra::DVector<f64>> =
        std::iter::once(ones).chain(columns).map(nalgebra::DVector::from_vec).collect();
    let matrix = nalgebra::DMatrix::from_columns(&matrix);
    let right = nalgebra::DVector::from_vec(samples.values.clone());
    // Unconstrained: no worse than with non-negative moduli.
    let moduli = matrix.clone().svd(true, true).solve(&right, 1e-14).unwrap();
    let theirs = (matrix * moduli - right).norm_squared();
    let ours = auto::at_most(&samples, 9, Residuals::Linear).unwrap();
    assert!(ours.cost <= theirs, "{:e} {theirs:e}", ours.cost);
}
