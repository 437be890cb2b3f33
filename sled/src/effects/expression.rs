//! A formula of named columns, for user-defined effects.
//!
//! Grammar: numbers, names (in brackets if they are not plain words, with closing brackets inside a
//! name doubled), `+ - * / ^`, parentheses, unary minus, and the functions
//! `abs sqrt exp log sin cos tan atan sign step min max`. `^` binds to the right and tighter than
//! unary minus: `-x^2` is `-(x^2)`.

/// A parsed formula.
#[derive(Clone, Debug)]
pub struct Expression {
    nodes: Vec<Node>,
    names: Vec<String>,
    /// Largest number of values on the stack.
    max_depth: usize,
}

/// Postfix operations.
#[derive(Clone, Copy, Debug)]
enum Node {
    Number(f64),
    Name(usize),
    Unary(Unary),
    Binary(Binary),
}

/// A function and its derivative.
type Unary = (fn(f64) -> f64, fn(f64) -> f64);
/// A function and its derivatives with respect to both arguments.
type Binary = (fn(f64, f64) -> f64, fn(f64, f64) -> [f64; 2]);

const FUNCTIONS: [(&str, Node); 12] = [
    ("abs", Node::Unary((f64::abs, f64::signum))),
    ("sqrt", Node::Unary((f64::sqrt, |a| 0.5 / a.sqrt()))),
    ("exp", Node::Unary((f64::exp, f64::exp))),
    ("log", Node::Unary((f64::ln, f64::recip))),
    ("sin", Node::Unary((f64::sin, f64::cos))),
    ("cos", Node::Unary((f64::cos, |a| -a.sin()))),
    ("tan", Node::Unary((f64::tan, |a| 1.0 + a.tan().powi(2)))),
    ("atan", Node::Unary((f64::atan, |a| 1.0 / (1.0 + a * a)))),
    ("sign", Node::Unary((f64::signum, |_| 0.0))),
    (
        "step",
        Node::Unary((|a| f64::from(u8::from(a > 0.0)), |_| 0.0)),
    ),
    ("min", Node::Binary((f64::min, |a, b| choice(a <= b)))),
    ("max", Node::Binary((f64::max, |a, b| choice(a >= b)))),
];

const NEGATE: Node = Node::Unary((|a| -a, |_| -1.0));
const POWER: Node = Node::Binary((
    |a, b| if b == 2.0 { a * a } else { a.powf(b) },
    |a, b| [b * a.powf(b - 1.0), a.powf(b) * a.ln()],
));

/// Binary operators in order of rising precedence.
const OPERATORS: [[(u8, Node); 2]; 2] = [
    [
        (b'+', Node::Binary((|a, b| a + b, |_, _| [1.0, 1.0]))),
        (b'-', Node::Binary((|a, b| a - b, |_, _| [1.0, -1.0]))),
    ],
    [
        (b'*', Node::Binary((|a, b| a * b, |a, b| [b, a]))),
        (
            b'/',
            Node::Binary((|a, b| a / b, |a, b| [1.0 / b, -a / (b * b)])),
        ),
    ],
];

/// Derivatives of `min` and `max`: of the function that is one of its two arguments.
fn choice(first: bool) -> [f64; 2] {
    let share = f64::from(u8::from(first));
    [share, 1.0 - share]
}

impl Expression {
    /// The name of a column as written in a formula: in brackets if it is not a plain word, with
    /// closing brackets doubled.
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

    /// Value of the formula. `value_of` gives the value of a name by its index in
    /// [`Expression::names`], NaN for an unknown one.
    pub fn evaluate(&self, value_of: impl Fn(usize) -> f64) -> f64 {
        self.run(
            |number| number,
            value_of,
            |(function, _), a| function(a),
            |(function, _), a, b| function(a, b),
        )
    }

    /// Value of the formula and its directional derivative; `value_of` gives value and derivative
    /// of a name.
    ///
    /// By forward-mode differentiation; at a kink of a function, the derivative of one side.
    ///
    /// ```
    /// use kufe_sled::effects::Expression;
    /// let formula = Expression::parse("v_mps^3 * s_m").unwrap();
    /// let [v, s] = [[2.0, 1.0], [5.0, 0.0]];
    /// assert_eq!(formula.derivative(|name| [v, s][name]), [40.0, 60.0]);
    /// ```
    pub fn derivative(&self, value_of: impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
        // A derivative that does not exist must not matter if the argument does not change.
        let product = |slope: f64, change: f64| if change == 0.0 { 0.0 } else { slope * change };
        self.run(
            |number| [number, 0.0],
            value_of,
            |(function, derivative), [a, da]| [function(a), product(derivative(a), da)],
            |(function, derivatives), [a, da], [b, db]| {
                let [by_a, by_b] = derivatives(a, b);
                [function(a, b), product(by_a, da) + product(by_b, db)]
            },
        )
    }

    /// Evaluates the formula on values, or on pairs of value and derivative.
    fn run<T: Copy + Default>(
        &self,
        number: impl Fn(f64) -> T,
        value_of: impl Fn(usize) -> T,
        unary: impl Fn(Unary, T) -> T,
        binary: impl Fn(Binary, T, T) -> T,
    ) -> T {
        // Nearly every formula fits the small stack, which avoids an allocation per sample.
        let (mut small, mut large) = ([T::default(); 16], Vec::new());
        let stack = if self.max_depth <= small.len() {
            &mut small[..]
        } else {
            large.resize(self.max_depth, T::default());
            &mut large
        };
        let mut top = 0;
        for node in &self.nodes {
            let value = match *node {
                Node::Number(value) => number(value),
                Node::Name(index) => value_of(index),
                Node::Unary(of) => {
                    top -= 1;
                    unary(of, stack[top])
                }
                Node::Binary(of) => {
                    top -= 2;
                    binary(of, stack[top], stack[top + 1])
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
    /// Position of the error, from 1.
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
        parser.expression()?;
        parser.skip_space();
        if parser.at < parser.bytes.len() {
            return Err(parser.error("an operator or the end"));
        }
        let (mut depth, mut max_depth) = (0_usize, 0);
        for node in &parser.nodes {
            match node {
                Node::Number(_) | Node::Name(_) => depth += 1,
                Node::Unary(_) => {}
                Node::Binary(_) => depth -= 1,
            }
            max_depth = max_depth.max(depth);
        }
        Ok(Expression {
            nodes: parser.nodes,
            names: parser.names,
            max_depth,
        })
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
        let rest = self.text.get(self.at..);
        let found = rest.and_then(|rest| rest.chars().next());
        ExpressionError {
            text: self.text.to_owned(),
            at: self.at + 1,
            found: found.map_or_else(|| "the end".to_owned(), |c| format!("{c:?}")),
            expected,
        }
    }

    fn skip_space(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    /// Skips the byte `wanted` if it is next, and returns whether it was.
    fn take(&mut self, wanted: u8) -> bool {
        self.skip_space();
        let is_next = self.bytes.get(self.at) == Some(&wanted);
        self.at += usize::from(is_next);
        is_next
    }

    fn expression(&mut self) -> Result<(), ExpressionError> {
        self.operation(&OPERATORS)
    }

    /// Reads operands with the operators of the first of these levels between them; operands
    /// consist of the tighter levels.
    fn operation(&mut self, levels: &[[(u8, Node); 2]]) -> Result<(), ExpressionError> {
        let Some((operators, tighter)) = levels.split_first() else {
            return self.factor();
        };
        self.operation(tighter)?;
        while let Some((_, operator)) = operators.iter().find(|(byte, _)| self.take(*byte)) {
            self.operation(tighter)?;
            self.nodes.push(*operator);
        }
        Ok(())
    }

    /// Skips the byte `wanted`, which must be next.
    fn close(&mut self, wanted: u8, expected: &'static str) -> Result<(), ExpressionError> {
        let is_next = self.take(wanted);
        is_next.then_some(()).ok_or_else(|| self.error(expected))
    }

    fn factor(&mut self) -> Result<(), ExpressionError> {
        // Deeply nested input must not exhaust the stack.
        self.depth += 1;
        if self.depth > 200 {
            return Err(self.error("at most 200 levels of nesting"));
        }
        if self.take(b'-') {
            self.factor()?;
            self.nodes.push(NEGATE);
        } else {
            self.atom()?;
            if self.take(b'^') {
                self.factor()?;
                self.nodes.push(POWER);
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        if self.take(b'(') {
            self.expression()?;
            return self.close(b')', "`)`");
        }
        self.skip_space();
        let start = self.at;
        match self.bytes.get(self.at) {
            Some(byte) if byte.is_ascii_digit() || *byte == b'.' => self.number(start),
            Some(byte) if byte.is_ascii_alphabetic() || *byte == b'_' => {
                let other = |b: &u8| !(b.is_ascii_alphanumeric() || *b == b'_');
                let length = self.bytes[start..].iter().position(other);
                self.at = length.map_or(self.bytes.len(), |length| start + length);
                let name = &self.text[start..self.at];
                if self.take(b'(') {
                    return self.call(name, start);
                }
                self.refer_to(name);
                Ok(())
            }
            Some(b'[') => {
                let mut end = start + 1;
                // A doubled bracket belongs to the name.
                while self.bytes.get(end) != Some(&b']') || self.bytes.get(end + 1) == Some(&b']') {
                    end += match self.bytes.get(end) {
                        None => {
                            self.at = self.bytes.len();
                            return Err(self.error("`]`"));
                        }
                        Some(b']') => 2,
                        Some(_) => 1,
                    };
                }
                self.at = end + 1;
                let name = self.text[start + 1..end].replace("]]", "]");
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
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            self.at = start;
            return Err(
                self.error("abs, sqrt, exp, log, sin, cos, tan, atan, sign, step, min or max")
            );
        };
        self.expression()?;
        if let Node::Binary(_) = function {
            self.close(b',', "`,` and a second argument")?;
            self.expression()?;
        }
        self.close(b')', "`)`")?;
        self.nodes.push(*function);
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
    fn derivatives_are_those_of_central_differences() {
        for text in [
            "x^2 - y^3 / x",
            "-(x * y)^2 + 2^x",
            "sqrt(x) * exp(y) - log(x) / 3",
            "sin(x) * cos(y) + tan(x * y) - atan(x / y)",
            "abs(y) + sign(y) * step(x) + min(x, y^2) * max(x, 2 * y)",
            "x^y",
        ] {
            let formula = Expression::parse(text).unwrap();
            let along = |h: f64| [0.7 + 2.0 * h, -0.4 + h];
            let at = |h: f64| {
                let [x, y] = along(h);
                formula.evaluate(|name| if formula.names()[name] == "x" { x } else { y })
            };
            let known = |name: usize| match formula.names()[name].as_str() {
                "x" => [0.7, 2.0],
                _ => [-0.4, 1.0],
            };
            let [value, derivative] = formula.derivative(known);
            let expected = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert_eq!(value, at(0.0), "{text}");
            assert!(
                (derivative - expected).abs() < 1e-8 * expected.abs().max(1.0),
                "{text}: {derivative}, {expected}"
            );
        }
        // A power of a negative number has a derivative by its base alone.
        let square = Expression::parse("x^2").unwrap();
        assert_eq!(square.derivative(|_| [-3.0, 1.0]), [9.0, -6.0]);
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
