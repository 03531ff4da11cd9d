//! Conventions, derivatives and faults of expressions.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::*;

fn at(text: &str, x: f64) -> Dual {
    Expression::parse(text, &["x"]).unwrap_or_else(|fault| panic!("{text}: {fault}")).at(&[Dual::variable(x)])
}

#[test]
fn conventions_are_the_usual_ones() {
    for (text, value) in [
        ("-x^2", -4.0),
        ("exp(-x^2)", (-4.0f64).exp()),
        ("3*-x^2", -12.0),
        ("-x**2", -4.0),
        ("2^3^x", 512.0),
        ("2^-x", 0.25),
        ("2^-x^2", 0.0625),
        ("(-x)^2", 4.0),
        ("--x", 2.0),
        ("8/x/2", 2.0),
        ("8/x*2", 8.0),
        ("1-x+1", 0.0),
        ("5e-4*x", 1e-3),
        ("1.5E+1 + .5", 15.5),
        ("2*e", 2.0 * std::f64::consts::E),
        ("max(max(1, x), min(x, 7))", 2.0),
        ("mod(-1, 3) + mod(7, 3)", 3.0),
        ("cos(pi)", -1.0),
        ("hypot(3, x*2)", 5.0),
        ("atan2(x, x)*4/pi", 1.0),
        ("sign(-x)+floor(x/3)+ceil(x/3)+round(x/3)", 1.0),
        ("step(x, 2) + step(1, x)*7", 1.0),
    ] {
        assert_eq!(at(text, 2.0).value, value, "{text}");
    }
}

/// The slope of every function against a central difference.
#[test]
fn slopes_are_derivatives() {
    let one = UNARY.iter().map(|(name, _)| format!("{name}(0.3*x+0.1)"));
    let two = BINARY.iter().map(|(name, _)| format!("{name}(x^2+0.3, 1.7-0.3*x)"));
    let more = ["x^x", "2^x", "(x-3)^3", "x/(1+x^2)", "(x-3)^2*sin(5*x)"].map(str::to_owned);
    for text in one.chain(two).chain(more) {
        for x in [0.37, 1.21] {
            let h = 1e-6;
            let numeric = (at(&text, x + h).value - at(&text, x - h).value) / (2.0 * h);
            assert!((at(&text, x).slope - numeric).abs() < 1e-8 * numeric.abs().max(1.0), "{text} at {x}");
        }
    }
}

/// A kink has the mean slope; a constant has the slope 0 even where its function has none.
#[test]
fn slopes_at_kinks() {
    assert_eq!(at("abs(x)", 0.0), Dual { value: 0.0, slope: 0.0 });
    assert_eq!(at("max(x, 3*x)", 0.0), Dual { value: 0.0, slope: 2.0 });
    assert_eq!(at("sqrt(0)*x + x", 1.0), Dual { value: 1.0, slope: 1.0 });
    assert_eq!(at("x^2", 0.0), Dual { value: 0.0, slope: 0.0 });
    assert_eq!(at("(x-1)^1", 1.0), Dual { value: 0.0, slope: 1.0 });
    assert!(at("max(sqrt(-1), x)", 1.0).value.is_nan());
}

/// A table is a curve with its slope; without tables there is no such function, and what is wrong with one is said.
#[test]
fn tables_are_curves() {
    let curve = Arc::new(Curve::new(vec![[0.0, 1.0], [2.0, 5.0]]).unwrap());
    let tables = |name: &str| if name == "a b.csv" { Ok(curve.clone()) } else { Err(format!("no {name}")) };
    let read = |text: &str| Expression::with_tables(text, &["x", "y"], &tables);
    let expression = read("2*table(\"a b.csv\", x^2)").unwrap();
    assert_eq!(expression.at(&[Dual::variable(0.5), Dual::constant(0.0)]), Dual { value: 3.0, slope: 4.0 });
    assert!(expression.has(0) && !expression.has(1));
    for (text, message) in [
        ("table(\"c\", x)", "column 8: no c"),
        ("table(x, 1)", "column 7: a table is written table(\"FILE\", v), its file in double quotes"),
        ("table(\"c, x)", "column 8: a '\"' is missing after the name of the table's file"),
        ("table(\"a b.csv\")", "column 16: a \",\" and what the table is looked up at are missing"),
    ] {
        assert_eq!(read(text).unwrap_err().to_string(), message, "{text}");
    }
    assert!(Expression::parse("table(\"c\", x)", &["x"]).is_err());
}

#[test]
fn faults_say_what_and_where() {
    for (text, message) in [
        ("", "column 1: ends where a number, x or a function is expected"),
        ("1 +", "column 4: ends where a number, x or a function is expected"),
        ("2x", "column 2: an operator is missing before 'x'"),
        ("sin(2 x)", "column 7: an operator is missing before 'x'"),
        ("(1+x", "column 5: a \")\" is missing"),
        ("1+x)", "column 4: there is no \"(\" for this \")\""),
        ("sin x", "column 1: the function sin needs its arguments in parentheses"),
        ("max(x)", "column 1: the function max takes two arguments, got 1"),
        ("max(x, 1, 2)", "column 1: the function max takes two arguments, got 3"),
        ("sin(x, 1)", "column 1: the function sin takes one argument, got 2"),
        ("1.2.3", "column 1: \"1.2.3\" is not a number"),
        ("2*PI*x", "column 3: \"PI\" is not known; write pi"),
        ("arcsin(x)", "column 1: \"arcsin\" is not known; write asin"),
        ("log(x)", "column 1: log is ambiguous: write ln or log10"),
        ("3e*x", "column 2: an operator is missing before 'e'"),
        ("x = 2", "column 3: '=' has no meaning here"),
        ("*x", "column 1: '*' stands where a number, a variable or a function is expected"),
    ] {
        assert_eq!(Expression::parse(text, &["x"]).unwrap_err().to_string(), message, "{text}");
    }
    for deep in ["(", "sin(", "x^", "x+"] {
        assert!(Expression::parse(&(deep.repeat(100_000) + "x"), &["x"]).is_err());
    }
    assert!(Expression::parse(&("(".repeat(101) + "x"), &["x"]).is_err_and(|fault| fault.column == 101));
}

/// Whatever is typed is an expression or a fault, never a panic, and whatever is read can be evaluated.
#[test]
fn no_text_panics() {
    let pieces =
        ["x", "2", ".", "e", "(", ")", "+", "-", "*", "/", "^", ",", "sin", "max(", "é", " ", "\0", "{", "1e", "mod"];
    let mut state = 7u64;
    let mut read = 0;
    for _ in 0..20_000 {
        let mut text = String::new();
        for _ in 0..1 + (state >> 40) % 8 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            text += pieces[(state >> 33) as usize % pieces.len()];
        }
        if let Ok(expression) = Expression::parse(&text, &["x"]) {
            expression.at(&[Dual::variable(0.3)]);
            read += 1;
        }
    }
    assert!(read > 100);
}
