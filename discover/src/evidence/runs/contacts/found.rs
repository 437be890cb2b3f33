//! Contacts that a screen found.

use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::recordings::frame::Frame;

/// Contacts found by a screen, before a fit.
#[derive(Clone)]
pub struct FoundContacts {
    pub contacts: Contacts,
    /// All training runs with their own contacts.
    pub frames: Vec<Frame>,
    /// p-value by the yaw residual.
    pub p_value: f64,
    /// Reduction of the lateral sum of squares, in units of its variance.
    pub gain: f64,
}
