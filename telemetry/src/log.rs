//! What a recording holds.

use std::collections::BTreeMap;

use crate::error::Error;

/// Most names that an error lists.
const LISTED: usize = 60;

/// A named series of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// Its name, without the unit that may follow it in brackets.
    pub name: String,
    /// The unit that the file states.
    pub unit: Option<String>,
    /// Which of [`Log::clocks`] it was sampled by, where the file states it.
    pub clock: Option<usize>,
    /// Its values in that unit; NaN where there is none. Empty where it was not read.
    pub values: Vec<f64>,
}

/// One recording: channels, and the clocks that the file itself relates them to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Every channel of numbers in the file's order.
    pub channels: Vec<Channel>,
    /// Times that the format relates channels to [s].
    pub clocks: Vec<Vec<f64>>,
    /// What was odd.
    pub remarks: Vec<String>,
    /// Line of the first row, in a text file.
    pub first_row: u64,
}

/// Whether two names differ in capitals and in spaces at their ends alone.
pub(crate) fn alike(a: &str, b: &str) -> bool {
    a.trim().to_lowercase() == b.trim().to_lowercase()
}

impl Log {
    /// How many numbers it holds, those of its clocks included.
    pub fn numbers(&self) -> u64 {
        let channels = self.channels.iter().map(|channel| &channel.values);
        let lengths = channels.chain(&self.clocks).map(|list| list.len() as u64);
        lengths.sum()
    }

    /// Place of the channel of this name; capitals and spaces at its ends do not count where only
    /// one channel fits.
    ///
    /// # Errors
    /// [`Error::NoChannel`] with the names that are there.
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
        let mut found: Vec<&str> = names().take(LISTED).collect();
        if self.channels.len() > LISTED {
            found.push("...");
        }
        Err(Error::NoChannel {
            file: file.to_string(),
            channel: name.to_string(),
            found: found.join(", "),
        })
    }

    /// Places of the channels `wanted` by name, or of all.
    ///
    /// # Errors
    /// As [`Log::find`].
    pub(crate) fn places(&self, wanted: Option<&[&str]>, file: &str) -> Result<Vec<usize>, Error> {
        match wanted {
            Some(names) => names.iter().map(|name| self.find(name, file)).collect(),
            None => Ok((0..self.channels.len()).collect()),
        }
    }

    /// Puts a label after every name that several channels have: `speed (100: gps)`.
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
