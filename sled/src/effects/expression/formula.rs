//! A formula of named columns, for effects that a person adds.
//!
//! Grammar: numbers, names (in brackets where they are no plain words), `+ - * / ^`, parentheses, unary minus, and `abs sqrt exp log sin cos tan atan sign step min max` as functions.
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
pub(super) enum Node {
    Number(f64),
    Name(usize),
    Negate,
    Binary(u8),
    Function(Function),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Abs,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Atan,
    Sign,
    Step,
    Min,
    Max,
}

impl Expression {
    /// From postfix operations, each of which finds its operands.
    pub(super) fn new(nodes: Vec<Node>, names: Vec<String>) -> Self {
        let (mut waiting, mut deepest) = (0_usize, 0);
        for node in &nodes {
            match node {
                Node::Number(_) | Node::Name(_) => waiting += 1,
                Node::Binary(_) | Node::Function(Function::Min | Function::Max) => waiting -= 1,
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

    /// A column's name as it stands in a formula: in brackets where it is no plain word.
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
        match first && name.chars().all(plain) {
            true => name.to_owned(),
            false => format!("[{name}]"),
        }
    }

    /// The names that the formula refers to, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The formula's value, `value_of` giving that of a name by its place in [`Expression::names`]; NaN for an unknown one.
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
            match node {
                Node::Number(value) => {
                    stack[top] = *value;
                    top += 1;
                }
                Node::Name(index) => {
                    stack[top] = value_of(*index);
                    top += 1;
                }
                Node::Negate => stack[top - 1] = -stack[top - 1],
                Node::Binary(operator) => {
                    top -= 1;
                    stack[top - 1] = binary(*operator, stack[top - 1], stack[top]);
                }
                Node::Function(function @ (Function::Min | Function::Max)) => {
                    top -= 1;
                    let (a, b) = (stack[top - 1], stack[top]);
                    stack[top - 1] = match function {
                        Function::Min => a.min(b),
                        _ => a.max(b),
                    };
                }
                Node::Function(function) => stack[top - 1] = function.of(stack[top - 1]),
            }
        }
        stack[0]
    }
}

fn binary(operator: u8, a: f64, b: f64) -> f64 {
    match operator {
        b'+' => a + b,
        b'-' => a - b,
        b'*' => a * b,
        b'/' => a / b,
        _ if b == 2.0 => a * a,
        _ => a.powf(b),
    }
}

impl Function {
    /// The function of this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "abs" => Function::Abs,
            "sqrt" => Function::Sqrt,
            "exp" => Function::Exp,
            "log" => Function::Log,
            "sin" => Function::Sin,
            "cos" => Function::Cos,
            "tan" => Function::Tan,
            "atan" => Function::Atan,
            "sign" => Function::Sign,
            "step" => Function::Step,
            "min" => Function::Min,
            "max" => Function::Max,
            _ => return None,
        })
    }

    /// Its value, of functions with one argument.
    fn of(self, a: f64) -> f64 {
        match self {
            Function::Abs => a.abs(),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Log => a.ln(),
            Function::Sin => a.sin(),
            Function::Cos => a.cos(),
            Function::Tan => a.tan(),
            Function::Atan => a.atan(),
            Function::Sign => a.signum(),
            _ => f64::from(u8::from(a > 0.0)),
        }
    }
}
