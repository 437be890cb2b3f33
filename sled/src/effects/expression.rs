//! A formula of named columns, for effects that a person adds.
//!
//! Grammar: numbers, names (in brackets where they are no plain words, a closing bracket of a name
//! twice), `+ - * / ^`, parentheses, unary minus, and the functions
//! `abs sqrt exp log sin cos tan atan sign step min max`.
//! `^` binds to the right and tighter than unary minus: `-x^2` is `-(x^2)`.

/// A parsed formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    nodes: Vec<Node>,
    names: Vec<String>,
    /// Values that wait at a time, at most.
    deepest: usize,
}

/// Postfix operations.
#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Name(usize),
    Negate,
    Binary(u8),
    /// By its place in [`FUNCTIONS`].
    Function(usize),
    /// By its place in [`PAIRS`].
    Pair(usize),
}

/// A function of one argument with its name.
type Function = (&'static str, fn(f64) -> f64);
/// A function of two arguments with its name.
type Pair = (&'static str, fn(f64, f64) -> f64);

/// Functions of one argument.
const FUNCTIONS: [Function; 10] = [
    ("abs", f64::abs),
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("log", f64::ln),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("atan", f64::atan),
    ("sign", f64::signum),
    ("step", |a| f64::from(u8::from(a > 0.0))),
];

/// Functions of two arguments.
const PAIRS: [Pair; 2] = [("min", f64::min), ("max", f64::max)];

impl Expression {
    /// From postfix operations, each of which finds its operands.
    fn new(nodes: Vec<Node>, names: Vec<String>) -> Self {
        let (mut waiting, mut deepest) = (0_usize, 0);
        for node in &nodes {
            match node {
                Node::Number(_) | Node::Name(_) => waiting += 1,
                Node::Binary(_) | Node::Pair(_) => waiting -= 1,
                Node::Negate | Node::Function(_) => {}
            }
            deepest = deepest.max(waiting);
        }
        Self {
            nodes,
            names,
            deepest,
        }
    }

    /// A column's name as a formula has it: in brackets where it is no plain word, with its own
    /// closing brackets twice.
    ///
    /// ```
    /// use kufe_sled::effects::Expression;
    /// assert_eq!(Expression::quoted("runner_c"), "runner_c");
    /// let formula = Expression::parse(&format!("2 * {}", Expression::quoted("runner (left)"))).unwrap();
    /// assert_eq!(formula.names(), ["runner (left)"]);
    /// ```
    pub fn quoted(name: &str) -> String {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let first = name.chars().next().is_some_and(|c| !c.is_ascii_digit());
        if first && name.chars().all(plain) {
            name.to_owned()
        } else {
            format!("[{}]", name.replace(']', "]]"))
        }
    }

    /// The names that the formula refers to, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The formula's value, `value_of` giving that of a name by its place in [`Expression::names`];
    /// NaN for an unknown one.
    pub fn evaluate(&self, value_of: impl Fn(usize) -> f64) -> f64 {
        // Nearly every formula fits the small stack, which costs no allocation a sample.
        let mut small = [0.0; 16];
        if self.deepest <= small.len() {
            return self.run(&mut small, value_of);
        }
        self.run(&mut vec![0.0; self.deepest], value_of)
    }

    fn run(&self, stack: &mut [f64], value_of: impl Fn(usize) -> f64) -> f64 {
        let mut top = 0;
        for node in &self.nodes {
            let value = match node {
                Node::Number(value) => *value,
                Node::Name(index) => value_of(*index),
                Node::Negate | Node::Function(_) => {
                    top -= 1;
                    match node {
                        Node::Function(function) => FUNCTIONS[*function].1(stack[top]),
                        _ => -stack[top],
                    }
                }
                Node::Binary(_) | Node::Pair(_) => {
                    top -= 2;
                    let (a, b) = (stack[top], stack[top + 1]);
                    match node {
                        Node::Binary(b'+') => a + b,
                        Node::Binary(b'-') => a - b,
                        Node::Binary(b'*') => a * b,
                        Node::Binary(b'/') => a / b,
                        Node::Pair(pair) => PAIRS[*pair].1(a, b),
                        _ if b == 2.0 => a * a,
                        _ => a.powf(b),
                    }
                }
            };
            stack[top] = value;
            top += 1;
        }
        stack[0]
    }
}

/// Why a formula cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("at character {at} of {text:?}: found {found}, expected {expected}")]
pub struct ExpressionError {
    /// The whole formula.
    pub text: String,
    /// Position of the trouble, from 1.
    pub at: usize,
    /// What was found.
    pub found: String,
    /// What is expected.
    pub expected: &'static str,
}

impl Expression {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`ExpressionError`] with the place where the formula stops making sense.
    ///
    /// ```
    /// use kufe_sled::effects::Expression;
    /// let formula = Expression::parse("2 * v_mps^2 - abs(alpha_rad)").unwrap();
    /// assert_eq!(formula.names(), ["v_mps", "alpha_rad"]);
    /// assert_eq!(formula.evaluate(|name| [3.0, -1.0][name]), 17.0);
    /// ```
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        let mut parser = Parser {
            text,
            bytes: text.as_bytes(),
            at: 0,
            depth: 0,
            nodes: Vec::new(),
            names: Vec::new(),
        };
        parser.sum()?;
        parser.space();
        if parser.at < parser.bytes.len() {
            return Err(parser.error("an operator or the end"));
        }
        Ok(Expression::new(parser.nodes, parser.names))
    }
}

struct Parser<'a> {
    text: &'a str,
    bytes: &'a [u8],
    at: usize,
    depth: usize,
    nodes: Vec<Node>,
    names: Vec<String>,
}

impl Parser<'_> {
    fn error(&self, expected: &'static str) -> ExpressionError {
        let found = self
            .text
            .get(self.at..)
            .and_then(|rest| rest.chars().next());
        ExpressionError {
            text: self.text.to_owned(),
            at: self.at + 1,
            found: found.map_or_else(|| "the end".to_owned(), |c| format!("{c:?}")),
            expected,
        }
    }

    fn space(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    fn take(&mut self, wanted: &[u8]) -> Option<u8> {
        self.space();
        let byte = *self.bytes.get(self.at)?;
        wanted.contains(&byte).then(|| {
            self.at += 1;
            byte
        })
    }

    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        while let Some(operator) = self.take(b"+-") {
            self.product()?;
            self.nodes.push(Node::Binary(operator));
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.signed()?;
        while let Some(operator) = self.take(b"*/") {
            self.signed()?;
            self.nodes.push(Node::Binary(operator));
        }
        Ok(())
    }

    fn signed(&mut self) -> Result<(), ExpressionError> {
        // Deeply nested input must not exhaust the stack.
        self.depth += 1;
        if self.depth > 200 {
            return Err(self.error("at most 200 levels of nesting"));
        }
        if self.take(b"-").is_some() {
            self.signed()?;
            self.nodes.push(Node::Negate);
        } else {
            self.atom()?;
            if self.take(b"^").is_some() {
                self.signed()?;
                self.nodes.push(Node::Binary(b'^'));
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        if self.take(b"(").is_some() {
            self.sum()?;
            return self.take(b")").map(|_| ()).ok_or_else(|| self.error("`)`"));
        }
        self.space();
        let start = self.at;
        match self.bytes.get(self.at) {
            Some(byte) if byte.is_ascii_digit() || *byte == b'.' => self.number(start),
            Some(byte) if byte.is_ascii_alphabetic() || *byte == b'_' => {
                while self
                    .bytes
                    .get(self.at)
                    .is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_')
                {
                    self.at += 1;
                }
                let name = &self.text[start..self.at];
                if self.take(b"(").is_some() {
                    return self.call(name, start);
                }
                self.refer_to(name);
                Ok(())
            }
            Some(b'[') => {
                let mut name = String::new();
                let mut rest = &self.text[start + 1..];
                loop {
                    let Some((before, after)) = rest.split_once(']') else {
                        self.at = self.bytes.len();
                        return Err(self.error("`]`"));
                    };
                    name += before;
                    rest = after;
                    match after.strip_prefix(']') {
                        Some(after) => rest = after,
                        None => break,
                    }
                    name.push(']');
                }
                self.at = self.bytes.len() - rest.len();
                self.refer_to(&name);
                Ok(())
            }
            _ => Err(self.error("a number, a column or `(`")),
        }
    }

    fn refer_to(&mut self, name: &str) {
        let known = self.names.iter().position(|n| n == name);
        let index = known.unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        });
        self.nodes.push(Node::Name(index));
    }

    fn number(&mut self, start: usize) -> Result<(), ExpressionError> {
        let mut previous = 0;
        while let Some(&byte) = self.bytes.get(self.at) {
            let exponent_sign = (byte == b'-' || byte == b'+') && matches!(previous, b'e' | b'E');
            if !(byte.is_ascii_digit() || matches!(byte, b'.' | b'e' | b'E') || exponent_sign) {
                break;
            }
            previous = byte;
            self.at += 1;
        }
        let value = self.text[start..self.at].parse().map_err(|_| {
            self.at = start;
            self.error("a number")
        })?;
        self.nodes.push(Node::Number(value));
        Ok(())
    }

    fn call(&mut self, name: &str, start: usize) -> Result<(), ExpressionError> {
        let one = FUNCTIONS.iter().position(|(known, _)| *known == name);
        let pair = PAIRS.iter().position(|(known, _)| *known == name);
        let function = one.map(Node::Function).or(pair.map(Node::Pair));
        let Some(function) = function else {
            self.at = start;
            return Err(
                self.error("abs, sqrt, exp, log, sin, cos, tan, atan, sign, step, min or max")
            );
        };
        self.sum()?;
        if pair.is_some() {
            if self.take(b",").is_none() {
                return Err(self.error("`,` and a second argument"));
            }
            self.sum()?;
        }
        if self.take(b")").is_none() {
            return Err(self.error("`)`"));
        }
        self.nodes.push(function);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let formula = Expression::parse(text).unwrap();
        formula.evaluate(|name| match formula.names()[name].as_str() {
            "x" => 3.0,
            "y_m" => -2.0,
            _ => f64::NAN,
        })
    }

    #[test]
    fn precedence_and_association_are_those_of_algebra() {
        assert_eq!(value("1 + 2 * x"), 7.0);
        assert_eq!(value("-x^2"), -9.0);
        assert_eq!(value("2^3^2"), 512.0);
        assert_eq!(value("8 / 4 / 2"), 1.0);
        assert_eq!(value("(1 - x) * -y_m"), -4.0);
        assert_eq!(value("max(x, y_m) - min(x, y_m)"), 5.0);
        assert_eq!(value("sqrt(x*x) + abs(y_m) + 1e-1"), 5.1);
        assert_eq!(value("step(x) + sign(y_m)"), 0.0);
    }

    #[test]
    fn any_name_can_be_quoted() {
        for name in [
            "x",
            "2x",
            "runner (left)",
            "a]",
            "]",
            "]]",
            "[a]b]]c",
            "v [m/s]",
            "é",
            "a^b",
        ] {
            let quoted = Expression::quoted(name);
            let formula = Expression::parse(&format!("2 * {quoted} - {quoted}")).unwrap();
            assert_eq!(formula.names(), [name], "{quoted}");
            assert_eq!(formula.evaluate(|_| 1.5), 1.5, "{quoted}");
        }
    }

    #[test]
    fn unknown_names_give_nan() {
        assert!(value("x + q").is_nan());
    }

    #[test]
    fn mistakes_are_placed() {
        for (text, at) in [
            ("1 +", 4),
            ("foo(x)", 1),
            ("(x", 3),
            ("x y_m", 3),
            ("1.2.3", 1),
            ("max(x)", 6),
            ("1 + [x", 7),
            ("1 + [x]]", 9),
        ] {
            assert_eq!(Expression::parse(text).unwrap_err().at, at, "{text}");
        }
        assert!(Expression::parse(&"(".repeat(10_000)).is_err());
        assert!(Expression::parse(&"-".repeat(10_000)).is_err());
    }
}
