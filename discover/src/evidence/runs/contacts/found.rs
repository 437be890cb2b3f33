//! Contacts that a screen found.

use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::recordings::frame::Frame;

/// Contacts that are found, before anything is fitted with them.
#[derive(Clone)]
pub struct Found {
    /// The contacts.
    pub contacts: Contacts,
    /// All training runs with their own.
    pub frames: Vec<Frame>,
    /// p-value by the yaw balance.
    pub p_value: f64,
    /// What they explain of the side balance, in units of its variance.
    pub gain: f64,
}
