//! Expressions that a user types, such as `5e-4*(1-cos(2*pi*x))`: read once, evaluated with their derivative.
//!
//! The usual conventions: `^` (or `**`) binds tightest and to the right, and tighter than a sign before it, so that
//! `-x^2` is -(x^2) and `2^3^2` is 2^(3^2); `2^-x` is allowed; products before sums; nothing is implied between `2`
//! and `x`. Numbers may have an exponent. Constants: `pi`, `e`. Where tables are to be had, `table("file.csv", x)` is the curve
//! through the points of one.

mod dual;

use std::fmt;
use std::sync::Arc;

pub use dual::Dual;

use crate::table::Curve;

use dual::{BINARY, Binary, UNARY, Unary, power};

/// An expression of given variables.
#[derive(Debug, Clone)]
pub struct Expression {
    root: Node,
}

/// Why a text is not an expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Where, in characters from 1.
    pub column: usize,
    /// What is wrong.
    pub reason: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {}: {}", self.column, self.reason)
    }
}

#[derive(Debug, Clone)]
enum Node {
    Constant(f64),
    /// Index into the variables.
    Variable(usize),
    Unary(Unary, Box<Node>),
    Binary(Binary, Box<[Node; 2]>),
    Table(Arc<Curve>, Box<Node>),
}

/// How the curve of a table is come by; what is wrong where there is none.
pub type Tables<'a> = &'a dyn Fn(&str) -> Result<Arc<Curve>, String>;

/// Longer than any formula by hand, and a tree that no stack minds.
const LONGEST: usize = 2000;

/// How deep parentheses and powers may be nested, for the same reason.
const DEEPEST: usize = 100;

impl Expression {
    /// Reads an expression of the variables with these names.
    ///
    /// # Errors
    /// The first thing that is wrong, and where.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, Fault> {
        Self::read(text, variables, None)
    }

    /// Reads one that may have tables in it.
    ///
    /// # Errors
    /// As for [`Self::parse`], and what is wrong with a table.
    pub fn with_tables(text: &str, variables: &[&str], tables: Tables<'_>) -> Result<Self, Fault> {
        Self::read(text, variables, Some(tables))
    }

    fn read(text: &str, variables: &[&str], tables: Option<Tables<'_>>) -> Result<Self, Fault> {
        let mut reader = Reader { letters: text.chars().collect(), at: 0, variables, tables, depth: 0 };
        if reader.letters.len() > LONGEST {
            return Err(Fault { column: LONGEST, reason: format!("is longer than {LONGEST} characters") });
        }
        let root = reader.sum()?;
        match reader.peek() {
            None => Ok(Self { root }),
            Some(')') => Err(reader.fault("there is no \"(\" for this \")\"")),
            Some(letter) if starts_operand(letter) => {
                Err(reader.fault(format!("an operator is missing before {letter:?}")))
            }
            Some(letter) => Err(reader.fault(format!("{letter:?} has no meaning here"))),
        }
    }

    /// Its value, and its derivative along the slopes of the variables, which stand in the order of their names.
    pub fn at(&self, variables: &[Dual]) -> Dual {
        self.root.at(variables)
    }

    /// Whether the variable of this index is in it.
    pub fn has(&self, variable: usize) -> bool {
        self.root.has(variable)
    }
}

impl Node {
    fn at(&self, variables: &[Dual]) -> Dual {
        match self {
            Self::Constant(value) => Dual::constant(*value),
            Self::Variable(index) => variables[*index],
            Self::Unary(function, a) => function(a.at(variables)),
            Self::Binary(function, pair) => function(pair[0].at(variables), pair[1].at(variables)),
            Self::Table(curve, a) => {
                let a = a.at(variables);
                let [value, slope] = curve.at(a.value);
                a.chain(value, slope)
            }
        }
    }

    fn has(&self, variable: usize) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Variable(index) => *index == variable,
            Self::Unary(_, a) | Self::Table(_, a) => a.has(variable),
            Self::Binary(_, pair) => pair.iter().any(|a| a.has(variable)),
        }
    }
}

/// A text on its way through the grammar, one method per rule.
struct Reader<'a> {
    letters: Vec<char>,
    at: usize,
    variables: &'a [&'a str],
    tables: Option<Tables<'a>>,
    depth: usize,
}

impl Reader<'_> {
    /// sum = product { ("+" | "-") product }
    fn sum(&mut self) -> Result<Node, Fault> {
        self.deeper()?;
        let mut left = self.product()?;
        loop {
            left = match self.peek() {
                Some('+') => self.operate(|a, b| a + b, left, Self::product)?,
                Some('-') => self.operate(|a, b| a - b, left, Self::product)?,
                _ => break,
            };
        }
        self.depth -= 1;
        Ok(left)
    }

    /// product = signed { ("*" | "/") signed }
    fn product(&mut self) -> Result<Node, Fault> {
        let mut left = self.signed()?;
        loop {
            left = match self.peek() {
                Some('*') => self.operate(|a, b| a * b, left, Self::signed)?,
                Some('/') => self.operate(|a, b| a / b, left, Self::signed)?,
                _ => return Ok(left),
            };
        }
    }

    /// signed = { "+" | "-" } power
    fn signed(&mut self) -> Result<Node, Fault> {
        let mut negative = false;
        while let Some(sign @ ('+' | '-')) = self.peek() {
            negative ^= sign == '-';
            self.at += 1;
        }
        let operand = self.power()?;
        Ok(if negative { Node::Unary(|a| -a, Box::new(operand)) } else { operand })
    }

    /// power = atom [ ("^" | "**") signed ], to the right: the exponent is a power itself.
    fn power(&mut self) -> Result<Node, Fault> {
        let base = self.atom()?;
        if self.peek() == Some('*') && self.letters.get(self.at + 1) == Some(&'*') {
            self.at += 1;
        } else if self.peek() != Some('^') {
            return Ok(base);
        }
        // A chain of powers goes one call deeper with every link.
        self.deeper()?;
        let node = self.operate(power, base, Self::signed)?;
        self.depth -= 1;
        Ok(node)
    }

    /// atom = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
    fn atom(&mut self) -> Result<Node, Fault> {
        match self.peek() {
            None => Err(self.fault("ends where a number, x or a function is expected")),
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.close()?;
                Ok(inner)
            }
            Some(letter) if letter.is_ascii_digit() || letter == '.' => self.number(),
            Some(letter) if letter.is_alphabetic() || letter == '_' => self.named(),
            Some(letter) => {
                Err(self.fault(format!("{letter:?} stands where a number, a variable or a function is expected")))
            }
        }
    }

    fn number(&mut self) -> Result<Node, Fault> {
        let start = self.at;
        let digits = |reader: &mut Self| {
            while reader.letters.get(reader.at).is_some_and(|letter| letter.is_ascii_digit() || *letter == '.') {
                reader.at += 1;
            }
        };
        digits(self);
        let exponent = self.at;
        if matches!(self.letters.get(self.at), Some('e' | 'E')) {
            self.at += 1;
            if matches!(self.letters.get(self.at), Some('+' | '-')) {
                self.at += 1;
            }
            // Without digits the "e" is no exponent; it is then found to lack an operator.
            match self.letters.get(self.at) {
                Some(letter) if letter.is_ascii_digit() => digits(self),
                _ => self.at = exponent,
            }
        }
        let text: String = self.letters[start..self.at].iter().collect();
        match text.parse() {
            Ok(value) => Ok(Node::Constant(value)),
            Err(_) => Err(Fault { column: start + 1, reason: format!("{text:?} is not a number") }),
        }
    }

    fn named(&mut self) -> Result<Node, Fault> {
        let start = self.at;
        // What stands in double quotes is part of a name.
        let mut quoted = false;
        while let Some(&letter) = self.letters.get(self.at) {
            quoted ^= letter == '"';
            if !(quoted || letter.is_alphanumeric() || matches!(letter, '_' | '.' | '"')) {
                break;
            }
            self.at += 1;
        }
        let name: String = self.letters[start..self.at].iter().collect();
        let fault = |reason: String| Err(Fault { column: start + 1, reason });
        if let Some(index) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Node::Variable(index));
        }
        match name.as_str() {
            "pi" => return Ok(Node::Constant(std::f64::consts::PI)),
            "e" => return Ok(Node::Constant(std::f64::consts::E)),
            _ => {}
        }
        if let (Some(tables), "table") = (self.tables, name.as_str()) {
            return self.table(tables);
        }
        let unary = UNARY.iter().find(|(known, _)| *known == name);
        let binary = BINARY.iter().find(|(known, _)| *known == name);
        if unary.is_none() && binary.is_none() {
            return fault(self.unknown(&name));
        }
        if self.peek() != Some('(') {
            return fault(format!("the function {name} needs its arguments in parentheses"));
        }
        let arguments = self.arguments()?;
        let given = arguments.len();
        let mut arguments = arguments.into_iter();
        match (unary, binary, arguments.next(), arguments.next()) {
            (Some((_, function)), _, Some(a), None) => Ok(Node::Unary(*function, Box::new(a))),
            (_, Some((_, function)), Some(a), Some(b)) if given == 2 => Ok(Node::Binary(*function, Box::new([a, b]))),
            _ => {
                let takes = if unary.is_some() { "one argument" } else { "two arguments" };
                fault(format!("the function {name} takes {takes}, got {given}"))
            }
        }
    }

    /// What follows `table`: ("FILE", sum)
    fn table(&mut self, tables: Tables<'_>) -> Result<Node, Fault> {
        for letter in ['(', '"'] {
            if self.peek() != Some(letter) {
                return Err(self.fault("a table is written table(\"FILE\", v), its file in double quotes"));
            }
            self.at += 1;
        }
        let rest = &self.letters[self.at..];
        let Some(length) = rest.iter().position(|letter| *letter == '"') else {
            return Err(self.fault("a '\"' is missing after the name of the table's file"));
        };
        let name: String = rest[..length].iter().collect();
        let curve = tables(&name).map_err(|reason| self.fault(reason))?;
        self.at += length + 1;
        if self.peek() != Some(',') {
            return Err(self.fault("a \",\" and what the table is looked up at are missing"));
        }
        self.at += 1;
        let argument = self.sum()?;
        self.close()?;
        Ok(Node::Table(curve, Box::new(argument)))
    }

    fn arguments(&mut self) -> Result<Vec<Node>, Fault> {
        self.at += 1;
        let mut list = vec![self.sum()?];
        while self.peek() == Some(',') {
            self.at += 1;
            list.push(self.sum()?);
        }
        self.close()?;
        Ok(list)
    }

    fn close(&mut self) -> Result<(), Fault> {
        match self.peek() {
            Some(')') => {
                self.at += 1;
                Ok(())
            }
            Some(letter) if starts_operand(letter) => {
                Err(self.fault(format!("an operator is missing before {letter:?}")))
            }
            _ => Err(self.fault("a \")\" is missing")),
        }
    }

    /// What an unknown name may have meant.
    fn unknown(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        let hint = match lower.as_str() {
            "log" => return "log is ambiguous: write ln or log10".to_owned(),
            "arcsin" | "arccos" | "arctan" => format!("write a{}", &lower[3..]),
            "pow" => "write a^b".to_owned(),
            "sgn" | "signum" => "write sign".to_owned(),
            "fmod" => "write mod".to_owned(),
            _ if self.is_known(&lower) => format!("write {lower}"),
            _ => format!(
                "known are {}, pi, e and the functions {}",
                self.variables.join(", "),
                UNARY
                    .iter()
                    .map(|(name, _)| *name)
                    .chain(BINARY.iter().map(|(name, _)| *name))
                    .collect::<Vec<_>>()
                    .join(" ")
            ),
        };
        format!("{name:?} is not known; {hint}")
    }

    fn is_known(&self, name: &str) -> bool {
        matches!(name, "pi" | "e")
            || self.variables.contains(&name)
            || UNARY.iter().any(|(known, _)| *known == name)
            || BINARY.iter().any(|(known, _)| *known == name)
    }

    fn deeper(&mut self) -> Result<(), Fault> {
        self.depth += 1;
        match self.depth > DEEPEST {
            true => Err(self.fault(format!("is nested more than {DEEPEST} deep"))),
            false => Ok(()),
        }
    }

    /// Takes the operator that is next, and its right operand.
    fn operate(
        &mut self,
        function: Binary,
        left: Node,
        operand: fn(&mut Self) -> Result<Node, Fault>,
    ) -> Result<Node, Fault> {
        self.at += 1;
        Ok(Node::Binary(function, Box::new([left, operand(self)?])))
    }

    /// The next letter that is not a blank.
    fn peek(&mut self) -> Option<char> {
        while self.letters.get(self.at).is_some_and(|letter| letter.is_whitespace()) {
            self.at += 1;
        }
        self.letters.get(self.at).copied()
    }

    fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { column: self.at + 1, reason: reason.into() }
    }
}

fn starts_operand(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '_' | '.' | '(')
}

#[cfg(test)]
mod tests;
