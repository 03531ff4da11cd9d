//! The text of a profilometer file: two columns, x and elevation.

use super::sampled::Point;

/// The sampling points of a file, by ascending x.
///
/// Two numbers to a line, x and elevation in m, separated by blanks, tabs, a comma or a semicolon; `#` begins a
/// comment; empty lines count for nothing.
///
/// # Errors
/// The first line that is wrong, as "line 7: ...", or that there are fewer than two points.
pub fn parse(text: &str) -> Result<Vec<Point>, String> {
    // Instruments under Windows like to begin a file with a byte order mark.
    let text = text.trim_start_matches('\u{feff}');
    let mut points: Vec<Point> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let wrong = |reason: String| format!("line {}: {reason}", index + 1);
        let point = point(content).map_err(wrong)?;
        match points.last() {
            Some(before) if point.x == before.x => {
                return Err(wrong(format!("x = {:?} m is there already; give each x once", point.x)));
            }
            Some(before) if point.x < before.x => {
                let reason = format!("x = {:?} m comes after {:?} m; sort the lines by x", point.x, before.x);
                return Err(wrong(reason));
            }
            _ => points.push(point),
        }
    }
    match points.len() {
        0 => Err("has no points; give lines of x and elevation in m".to_owned()),
        1 => Err("has a single point; give at least two".to_owned()),
        _ => Ok(points),
    }
}

fn point(line: &str) -> Result<Point, String> {
    let mut values = [0.0; 2];
    let mut count = 0;
    let separates = |letter: char| letter.is_whitespace() || matches!(letter, ',' | ';');
    for word in line.split(separates).filter(|word| !word.is_empty()) {
        if let Some(value) = values.get_mut(count) {
            *value = number(word)?;
        }
        count += 1;
    }
    match (count, values) {
        (2, [x, height]) => Ok(Point { x, height }),
        (1, _) => Err("has one number; give two, x and elevation in m".to_owned()),
        (count, _) => Err(format!("has {count} columns; give two, x and elevation in m (decimals with a point)")),
    }
}

fn number(word: &str) -> Result<f64, String> {
    const LONGEST: usize = 30;
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("{word} is not finite; remove the line, or give a number")),
        Err(_) => {
            let shown: String = word.chars().take(LONGEST).collect();
            Err(format!("{shown:?} is not a number; begin comments with #"))
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_separates_and_what_is_skipped() {
        let text = "\u{feff}# x in m, z in m\r\n\r\n0 1\r\n 1e-3,\t-2 # a pit\n  \n0.25;3.5\n+.5  ,  1E0\n";
        let points = parse(text).unwrap();
        let pairs: Vec<(f64, f64)> = points.iter().map(|point| (point.x, point.height)).collect();
        assert_eq!(pairs, [(0.0, 1.0), (1e-3, -2.0), (0.25, 3.5), (0.5, 1.0)]);
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        for (text, message) in [
            ("", "has no points; give lines of x and elevation in m"),
            ("# only\n\n", "has no points; give lines of x and elevation in m"),
            ("0 1\n", "has a single point; give at least two"),
            ("0 1\n\n1 2\n1 3\n", "line 4: x = 1.0 m is there already; give each x once"),
            ("0 1\n1 2\n0.5 3\n", "line 3: x = 0.5 m comes after 1.0 m; sort the lines by x"),
            ("0 1\n2\n", "line 2: has one number; give two, x and elevation in m"),
            ("0,5;1,5\n", "line 1: has 4 columns; give two, x and elevation in m (decimals with a point)"),
            ("0 1\n1 nan\n", "line 2: nan is not finite; remove the line, or give a number"),
            ("0 1\n1 -inf\n", "line 2: -inf is not finite; remove the line, or give a number"),
            ("0 1\n1 1e999\n", "line 2: 1e999 is not finite; remove the line, or give a number"),
            ("x z\n0 1\n", "line 1: \"x\" is not a number; begin comments with #"),
        ] {
            assert_eq!(parse(text).unwrap_err(), message, "{text:?}");
        }
    }
}
