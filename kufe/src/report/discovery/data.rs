//! Fields of a report, read from its JSON; a number that JSON could not hold is NaN, a text that is missing is empty.

use serde_json::Value;

/// One object of a report.
#[derive(Clone, Copy)]
pub struct Data<'a>(pub &'a Value);

impl<'a> Data<'a> {
    /// A text.
    pub fn text(self, key: &str) -> &'a str {
        self.0[key].as_str().unwrap_or_default()
    }

    /// A number.
    pub fn number(self, key: &str) -> f64 {
        self.0[key].as_f64().unwrap_or(f64::NAN)
    }

    /// A whole number.
    pub fn count(self, key: &str) -> usize {
        self.0[key].as_u64().unwrap_or_default() as usize
    }

    /// A truth.
    pub fn is(self, key: &str) -> bool {
        self.0[key].as_bool().unwrap_or_default()
    }

    /// An object in it.
    pub fn part(self, key: &str) -> Self {
        Self(&self.0[key])
    }

    /// The objects of a list.
    pub fn list(self, key: &str) -> Vec<Self> {
        let items = self.0[key].as_array().map_or(&[][..], Vec::as_slice);
        items.iter().map(Data).collect()
    }

    /// The texts of a list.
    pub fn texts(self, key: &str) -> Vec<&'a str> {
        let items = self.list(key).into_iter();
        items.map(|d| d.0.as_str().unwrap_or_default()).collect()
    }

    /// The numbers of a list.
    pub fn numbers(self, key: &str) -> Vec<f64> {
        let items = self.list(key).into_iter();
        items.map(|d| d.0.as_f64().unwrap_or(f64::NAN)).collect()
    }

    /// Whether there is such a field.
    pub fn has(self, key: &str) -> bool {
        !self.0[key].is_null()
    }
}
