//! Sixty ways to damage a clean record, and the expected finding of each; none of the checker's code is used.

/// What is done to a file: text in, text out. None of the checker's code is used.
pub type Damage = Box<dyn Fn(&mut Table)>;

/// A file as columns.
#[derive(Clone)]
pub struct Table {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    fn column(&mut self, name: &str) -> &mut Vec<f64> {
        let at = self
            .names
            .iter()
            .position(|known| known == name)
            .expect("a column");
        &mut self.columns[at]
    }

    /// Every so manieth row of a file.
    pub fn read(text: &str, step: usize) -> Table {
        let mut lines = text.lines();
        let names: Vec<String> = lines
            .next()
            .expect("a header")
            .split(',')
            .map(str::to_owned)
            .collect();
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines.step_by(step) {
            for (column, cell) in columns.iter_mut().zip(line.split(',')) {
                column.push(cell.parse().expect("a number"));
            }
        }
        Table { names, columns }
    }

    /// With the distance `s_m`, the integral of the speed at 100 Hz.
    pub fn integrated(&mut self) {
        let mut s = 0.0;
        let along = self.column("v_mps").iter().map(|v| {
            s += 0.01 * v;
            s
        });
        let along = along.collect();
        self.names.push("s_m".to_owned());
        self.columns.push(along);
    }

    /// The same as a file.
    pub fn text(&self) -> String {
        let mut text = self.names.join(",") + "\n";
        for row in 0..self.columns[0].len() {
            let cells: Vec<String> = self
                .columns
                .iter()
                .map(|column| column[row].to_string())
                .collect();
            text += &(cells.join(",") + "\n");
        }
        text
    }
}

fn times(names: &'static [&'static str], factor: f64) -> Damage {
    Box::new(move |table| {
        for name in names {
            table.column(name).iter_mut().for_each(|x| *x *= factor);
        }
    })
}

fn exchanged(a: &'static str, b: &'static str) -> Damage {
    Box::new(move |table| {
        let first = std::mem::take(table.column(a));
        let second = std::mem::replace(table.column(b), first);
        *table.column(a) = second;
    })
}

fn each(name: &'static str, with: fn(usize, f64) -> f64) -> Damage {
    Box::new(move |table| {
        let column = table.column(name).iter_mut().enumerate();
        column.for_each(|(i, x)| *x = with(i, *x));
    })
}

fn repeated(name: &'static str, rows: usize) -> Damage {
    Box::new(move |table| {
        let column = table.column(name);
        for i in 0..column.len() {
            column[i] = column[i - i % rows];
        }
    })
}

fn late(name: &'static str, rows: usize) -> Damage {
    Box::new(move |table| {
        let column = table.column(name);
        column.rotate_right(rows);
        let first = column[rows];
        column[..rows].fill(first);
    })
}

fn without_rows(from: usize, to: usize) -> Damage {
    Box::new(move |table| {
        for column in &mut table.columns {
            column.drain(from..to);
        }
    })
}

fn both(one: Damage, other: Damage) -> Damage {
    Box::new(move |table| {
        one(table);
        other(table);
    })
}

/// The column and its finding: a kind of fault with its remedy, or a part of a note.
pub type Expected = (&'static str, &'static str, &'static str);

const G: f64 = 9.81;
const DEGREE: f64 = std::f64::consts::PI / 180.0;
const ACCELERATIONS: [&str; 3] = ["ax_mps2", "ay_mps2", "az_mps2"];
const RATES: [&str; 3] = ["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"];

/// Sixty damages, each alone and eight pairs, with their expected findings.
pub fn corpus() -> Vec<(Damage, Vec<Expected>)> {
    let mut all: Vec<(Damage, Vec<Expected>)> = Vec::new();
    let mut add = |damage: Damage, expected: &[Expected]| all.push((damage, expected.to_vec()));
    // Units.
    add(
        times(&["ax_mps2"], 1.0 / G),
        &[("ax_mps2", "unit", "\"g\"")],
    );
    add(
        times(&["ay_mps2"], 1.0 / G),
        &[("ay_mps2", "unit", "\"g\"")],
    );
    add(
        times(&["az_mps2"], 1.0 / G),
        &[("az_mps2", "unit", "\"g\"")],
    );
    add(
        times(&["ax_mps2", "ay_mps2", "az_mps2"], 1.0 / G),
        &ACCELERATIONS.map(|c| (c, "unit", "\"g\"")),
    );
    add(
        each("az_mps2", |_, x| x - G),
        &[("az_mps2", "gravity", "9.81")],
    );
    add(
        times(&["roll_rate_radps"], 1.0 / DEGREE),
        &[("roll_rate_radps", "unit", "deg/s")],
    );
    add(
        times(&["pitch_rate_radps"], 1.0 / DEGREE),
        &[("pitch_rate_radps", "unit", "deg/s")],
    );
    add(
        times(&["yaw_rate_radps"], 1.0 / DEGREE),
        &[("yaw_rate_radps", "unit", "deg/s")],
    );
    add(
        times(
            &["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"],
            1.0 / DEGREE,
        ),
        &RATES.map(|c| (c, "unit", "deg/s")),
    );
    add(times(&["v_mps"], 3.6), &[("v_mps", "unit", "km/h")]);
    add(
        times(&["v_mps"], 1.0 / 0.44704),
        &[("v_mps", "unit", "mph")],
    );
    add(
        times(&["v_mps"], 3600.0 / 1852.0),
        &[("v_mps", "unit", "kn")],
    );
    add(
        times(&["alpha_rad"], 1.0 / DEGREE),
        &[("alpha_rad", "unit", "deg")],
    );
    add(
        times(&["delta_rad"], 1.0 / DEGREE),
        &[("delta_rad", "unit", "deg")],
    );
    add(
        times(&["gamma_rad"], 1.0 / DEGREE),
        &[("gamma_rad", "unit", "deg")],
    );
    add(times(&["t_s"], 1e3), &[("t_s", "clock", "ms")]);
    add(times(&["s_m"], 1e-3), &[("s_m", "distance", "km")]);
    add(times(&["s_m"], 1.0 / 0.3048), &[("s_m", "distance", "ft")]);
    add(each("s_m", |_, s| -s), &[("s_m", "distance", "sign")]);
    // Signs.
    for name in [
        "ax_mps2",
        "ay_mps2",
        "az_mps2",
        "roll_rate_radps",
        "pitch_rate_radps",
        "yaw_rate_radps",
        "alpha_rad",
        "delta_rad",
        "gamma_rad",
    ] {
        add(each(name, |_, x| -x), &[(name, "sign", "-1")]);
    }
    // Names.
    for (a, b) in [
        ("ax_mps2", "ay_mps2"),
        ("ay_mps2", "az_mps2"),
        ("roll_rate_radps", "pitch_rate_radps"),
        ("pitch_rate_radps", "yaw_rate_radps"),
        ("roll_rate_radps", "yaw_rate_radps"),
        ("alpha_rad", "delta_rad"),
    ] {
        add(exchanged(a, b), &[(a, "swapped", b), (b, "swapped", a)]);
    }
    // Channels that do not measure, or too seldom.
    for name in [
        "ax_mps2",
        "ay_mps2",
        "az_mps2",
        "roll_rate_radps",
        "pitch_rate_radps",
        "yaw_rate_radps",
        "alpha_rad",
    ] {
        add(
            each(name, |_, _| 0.0),
            &[(name, "constant", "another source")],
        );
    }
    add(
        each("v_mps", |_, _| 12.0),
        &[("v_mps", "constant", "another source")],
    );
    for name in ["v_mps", "yaw_rate_radps", "alpha_rad"] {
        add(repeated(name, 10), &[(name, "held", "clock (10")]);
    }
    // What is odd but usable.
    add(
        without_rows(1000, 1200),
        &[("", "note", "200 rows missing")],
    );
    add(
        each("ay_mps2", |i, x| {
            if (700..760).contains(&i) { f64::NAN } else { x }
        }),
        &[("", "note", "60 values missing")],
    );
    add(
        each("t_s", |i, t| t + if i % 3 == 1 { 0.002 } else { 0.0 }),
        &[("t_s", "note", "of a step off")],
    );
    add(
        each("yaw_rate_radps", |i, x| {
            if (1500..1600).contains(&i) { 0.125 } else { x }
        }),
        &[("yaw_rate_radps", "note", "one value for")],
    );
    add(
        each("az_mps2", |i, x| if i % 900 == 450 { 0.0 } else { x }),
        &[("az_mps2", "note", "leap")],
    );
    add(
        late("pitch_rate_radps", 10),
        &[("pitch_rate_radps", "note", "late")],
    );
    add(
        each("az_mps2", |_, x| x.min(18.0)),
        &[("az_mps2", "note", "saturated")],
    );
    // Pairs.
    let pairs: [(Damage, Damage, [Expected; 2]); 8] = [
        (
            times(&["v_mps"], 3.6),
            each("yaw_rate_radps", |_, x| -x),
            [("v_mps", "unit", "km/h"), ("yaw_rate_radps", "sign", "-1")],
        ),
        (
            times(&["az_mps2"], 1.0 / G),
            each("roll_rate_radps", |_, x| -x),
            [
                ("az_mps2", "unit", "\"g\""),
                ("roll_rate_radps", "sign", "-1"),
            ],
        ),
        (
            times(&["alpha_rad"], 1.0 / DEGREE),
            each("pitch_rate_radps", |_, x| -x),
            [
                ("alpha_rad", "unit", "deg"),
                ("pitch_rate_radps", "sign", "-1"),
            ],
        ),
        (
            exchanged("roll_rate_radps", "pitch_rate_radps"),
            times(&["v_mps"], 3600.0 / 1852.0),
            [
                ("roll_rate_radps", "swapped", "pitch"),
                ("v_mps", "unit", "kn"),
            ],
        ),
        (
            each("ay_mps2", |_, x| -x),
            times(&["s_m"], 1e-3),
            [("ay_mps2", "sign", "-1"), ("s_m", "distance", "km")],
        ),
        (
            times(&["ax_mps2"], 1.0 / G),
            each("gamma_rad", |_, x| -x),
            [("ax_mps2", "unit", "\"g\""), ("gamma_rad", "sign", "-1")],
        ),
        (
            times(&["yaw_rate_radps"], 1.0 / DEGREE),
            without_rows(1200, 1300),
            [
                ("yaw_rate_radps", "unit", "deg/s"),
                ("", "note", "100 rows missing"),
            ],
        ),
        (
            repeated("v_mps", 10),
            times(&["delta_rad"], 1.0 / DEGREE),
            [("v_mps", "held", "clock (10"), ("delta_rad", "unit", "deg")],
        ),
    ];
    for (one, other, expected) in pairs {
        add(both(one, other), &expected);
    }
    all
}
