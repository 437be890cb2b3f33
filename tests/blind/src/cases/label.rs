//! What a case is called.

/// Family, name and size of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Family.
    pub family: &'static str,
    /// What it is.
    pub name: String,
    /// Share of the noise variance, where the family has sizes.
    pub share: Option<f64>,
}

impl Label {
    /// `family/name@share`.
    pub fn id(&self) -> String {
        match self.share {
            Some(share) => format!("{}/{}@{share}", self.family, self.name),
            None => format!("{}/{}", self.family, self.name),
        }
    }

    /// Its name as a folder.
    pub fn folder(&self, seed: u64) -> String {
        format!(
            "{}-{seed}",
            self.id().replace(['/', '@', '~', '+', ':'], "_")
        )
    }
}
