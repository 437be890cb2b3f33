//! The content of a recording: channels and clocks.

use std::collections::BTreeMap;

use crate::error::Error;

/// Largest number of names that an error lists.
const MAX_LISTED: usize = 60;

/// A named series of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// Name, without a unit in brackets after it.
    pub name: String,
    /// The unit that the file states.
    pub unit: Option<String>,
    /// Index of its clock in [`Log::clocks`], if the file states one.
    pub clock: Option<usize>,
    /// Values in that unit; NaN for missing values. Empty for a channel that was not read.
    pub values: Vec<f64>,
}

/// One recording: channels, and the clocks that the file relates them to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Numeric channels in the order of the file.
    pub channels: Vec<Channel>,
    /// Sample times of each clock [s].
    pub clocks: Vec<Vec<f64>>,
    /// Anomalies of the file.
    pub remarks: Vec<String>,
    /// Line of each row in a text file; empty for other files.
    pub lines: Vec<u64>,
}

/// Whether two names are equal except for capitals and for spaces at their ends.
pub(crate) fn alike(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}

impl Log {
    /// Line of a row in a text file; in other files the number of the sample, from 1.
    pub(crate) fn line(&self, row: usize) -> u64 {
        self.lines.get(row).copied().unwrap_or(row as u64 + 1)
    }

    /// Number of values, including those of clocks.
    pub fn numbers(&self) -> u64 {
        let channels = self.channels.iter().map(|channel| &channel.values);
        let lengths = channels.chain(&self.clocks).map(|list| list.len() as u64);
        lengths.sum()
    }

    /// Index of the channel of this name. Capitals and spaces at its ends are ignored if only one
    /// channel matches then.
    ///
    /// # Errors
    /// [`Error::NoChannel`] with the names in the recording.
    pub fn find(&self, name: &str, file: &str) -> Result<usize, Error> {
        let names = || self.channels.iter().map(|channel| channel.name.as_str());
        if let Some(place) = names().position(|known| known == name) {
            return Ok(place);
        }
        let fits = |i: &usize| alike(&self.channels[*i].name, name);
        let mut fitting = (0..self.channels.len()).filter(fits);
        if let (Some(place), None) = (fitting.next(), fitting.next()) {
            return Ok(place);
        }
        let mut found: Vec<&str> = names().take(MAX_LISTED).collect();
        if self.channels.len() > MAX_LISTED {
            found.push("...");
        }
        Err(Error::NoChannel {
            file: file.to_string(),
            channel: name.to_string(),
            found: found.join(", "),
        })
    }

    /// Indices of the channels with the names `wanted`, or of all.
    ///
    /// # Errors
    /// As [`Log::find`].
    pub(crate) fn places(&self, wanted: Option<&[&str]>, file: &str) -> Result<Vec<usize>, Error> {
        match wanted {
            Some(names) => names.iter().map(|name| self.find(name, file)).collect(),
            None => Ok((0..self.channels.len()).collect()),
        }
    }

    /// Appends a label to every name that several channels have, as `speed (100: gps)`.
    pub(crate) fn distinguish(&mut self, label: impl Fn(usize) -> String) {
        let mut places: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (place, channel) in self.channels.iter().enumerate() {
            if !channel.name.is_empty() {
                places.entry(channel.name.clone()).or_default().push(place);
            }
        }
        for (name, places) in places.iter().filter(|(_, places)| places.len() > 1) {
            for place in places {
                self.channels[*place].name = format!("{name} ({})", label(*place));
            }
            let quoted = |place: &usize| format!("{:?}", self.channels[*place].name);
            let names: Vec<String> = places.iter().map(quoted).collect();
            self.remarks.push(format!(
                "{} channels are called {name:?}; here they are {}",
                places.len(),
                names.join(", ")
            ));
        }
    }

    /// Refuses a recording without channels, with the reason.
    ///
    /// # Errors
    /// [`Error::File`].
    pub(crate) fn with_channels(self, file: &str, reason: &str) -> Result<Log, Error> {
        if self.channels.is_empty() {
            let remarks = self.remarks.iter().map(|remark| format!("; {remark}"));
            let remarks: String = remarks.collect();
            let reason = format!("no channel of numbers: {reason}{remarks}");
            return Err(Error::file(file, reason));
        }
        Ok(self)
    }
}
