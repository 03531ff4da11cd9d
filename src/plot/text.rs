//! Subscripts and superscripts: `_{...}` and `^{...}` in a text.

/// A piece of a text that stands on one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its characters.
    pub text: String,
    /// Its size over that of the text.
    pub size: f64,
    /// By how much of the size of the text it stands lower.
    pub drop: f64,
}

/// The pieces of a text from left to right.
pub fn runs(text: &str) -> Vec<Run> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some((at, drop)) = next(rest) {
        let Some(end) = rest[at..].find('}') else { break };
        found.push(run(&rest[..at], 1.0, 0.0));
        found.push(run(&rest[at + 2..at + end], 0.7, drop));
        rest = &rest[at + end + 1..];
    }
    found.push(run(rest, 1.0, 0.0));
    found.retain(|run| !run.text.is_empty());
    found
}

/// Where the next mark is, and how far its text drops.
fn next(text: &str) -> Option<(usize, f64)> {
    let below = text.find("_{").map(|at| (at, 0.28));
    let above = text.find("^{").map(|at| (at, -0.35));
    below.into_iter().chain(above).min_by_key(|(at, _)| *at)
}

fn run(text: &str, size: f64, drop: f64) -> Run {
    // Viewers drop plain spaces at the ends of a piece.
    Run { text: text.replace(' ', "\u{a0}"), size, drop }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_make_runs_and_other_braces_are_left_alone() {
        let texts = |text| runs(text).into_iter().map(|run| (run.text, run.drop)).collect::<Vec<_>>();
        let plain = |text: &str| (text.to_owned(), 0.0);
        assert_eq!(texts("q/(f E_{f,0})"), [plain("q/(f\u{a0}E"), ("f,0".into(), 0.28), plain(")")]);
        assert_eq!(texts("w^{*}"), [plain("w"), ("*".into(), -0.35)]);
        assert_eq!(texts("a_b {c} _{d"), [plain("a_b\u{a0}{c}\u{a0}_{d")]);
        assert!(texts("").is_empty());
    }
}
